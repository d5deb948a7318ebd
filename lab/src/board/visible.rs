//! What a board says, made fit for a terminal. A board speaks printable ASCII; whatever else comes, from a board that is broken or not a
//! board at all, is shown and not sent on: a terminal would obey it.

/// The text with every character that is not printable ASCII, a line feed or a tab in its escaped form, such as `\u{1b}` for ESC.
pub fn visible(text: &str) -> String {
    text.chars().fold(String::with_capacity(text.len()), |mut out, c| {
        match c {
            '\n' | '\t' | ' '..='~' => out.push(c),
            other => out.extend(other.escape_default()),
        }
        out
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn printable_text_stays_and_every_control_character_is_shown() {
        let plain: String = (' '..='~').chain(['\n', '\t']).collect();
        assert_eq!(visible(&plain), plain);
        assert_eq!(visible("\x1b]52;c;cm0=\x07"), "\\u{1b}]52;c;cm0=\\u{7}");
        let all: String = ('\0'..='\u{2fff}').collect();
        let shown = visible(&all);
        assert!(
            shown.chars().all(|c| matches!(c, '\n' | '\t' | ' '..='~')),
            "C0, C1, overrides of direction"
        );
    }
}
