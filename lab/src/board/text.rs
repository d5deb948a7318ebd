//! What stands in the text of a board's console: its prompts, its lines, and what some of them mean.

use fdi_core::TripReason;
use firmware_logic::console::ANSWER;

/// What ends an answer.
pub const PROMPT: &str = "> ";

/// Takes the whole lines of a console's text, without its prompts and what is empty; the rest stays. No line is longer than an answer:
/// what is goes out in pieces, which say so.
pub fn take_lines(text: &mut String) -> Vec<String> {
    if text.len() > ANSWER && !text.contains('\n') {
        *text += " [cut: no board says a line as long]\n";
    }
    let end = text.rfind('\n').map_or(0, |at| at + 1);
    let whole: String = text.drain(..end).collect();
    without_prompts(&whole).lines().map(str::to_owned).collect()
}

/// The lines of a text without prompts and what is empty: a board shows its prompt again after whatever it tells by itself.
pub fn without_prompts(text: &str) -> String {
    let lines = text.lines().map(|line| line.trim_end().trim_start_matches(PROMPT));
    lines.filter(|line| !matches!(*line, "" | ">")).fold(String::new(), |out, line| out + line + "\n")
}

/// A text before an echo, from there to the next prompt, and behind that. Without an echo the prompt is the one that ends it all.
pub fn between<'a>(text: &'a str, echo: &str) -> Option<(&'a str, &'a str, &'a str)> {
    if echo.is_empty() {
        let answer = text.strip_suffix(PROMPT).filter(|text| text.is_empty() || text.ends_with('\n'));
        return answer.map(|answer| ("", answer, ""));
    }
    let at = text.find(&format!("{echo}\n"))?;
    let (before, behind) = text.split_at(at);
    // The line feed of the echo may be the one before the prompt.
    let (answer, after) = behind.split_at(echo.len()).1.split_once("\n> ")?;
    Some((before, answer, after))
}

/// Whether a line tells the end of a self-test, and then whether it has passed.
pub fn check_ended(line: &str) -> Option<bool> {
    let has = |words| line.starts_with(words);
    has("check passed").then_some(true).or((has("check failed") || has("check ended")).then_some(false))
}

/// Why a board has refused something, if its answer says so.
pub fn refusal(answer: &str) -> Option<&str> {
    answer.lines().find_map(|line| line.strip_prefix("error: "))
}

/// Name of the trip whose cause persists, where that is why.
pub fn persists(why: &str) -> Option<&'static str> {
    let number: usize = why.split_once("persists (trip ")?.1.split_once(')')?.0.parse().ok()?;
    TripReason::NAMES.get(number.checked_sub(1)?).copied()
}

#[cfg(test)]
mod tests {
    use fdi_core::Refusal;

    use super::*;

    #[test]
    fn a_trip_that_persists_is_told_by_its_number() {
        let text = Refusal::CausePersists(TripReason::T2OverTemperature).to_string();
        assert_eq!(persists(&text), Some("t2_over_temperature"));
        for other in [
            "not possible in mode off",
            "it persists (trip 0): ",
            "it persists (trip 99): ",
            "persists (trip 1",
        ] {
            assert_eq!(persists(other), None, "{other}");
        }
    }

    #[test]
    fn lines_come_without_prompts_and_the_rest_waits() {
        let mut text = "> ok\n> \n\ncheck: at rest\n> stat".to_owned();
        assert_eq!(take_lines(&mut text), ["ok", "check: at rest"]);
        assert_eq!(text, "> stat");
    }

    #[test]
    fn a_line_without_end_is_cut_and_told() {
        let mut text = "x".repeat(ANSWER);
        assert!(take_lines(&mut text).is_empty());
        text.push('x');
        let lines = take_lines(&mut text);
        assert!(lines.len() == 1 && lines[0].contains("[cut: "), "{lines:?}");
        assert!(text.is_empty());
    }

    #[test]
    fn an_answer_is_told_from_what_is_told_beside_it() {
        let text = "\ncheck: at rest\n> stat\ncheck: pulses\n> status\nmode off\n> \ncheck passed\n> ";
        let (before, answer, after) = between(text, "status").expect("an answer");
        assert_eq!(without_prompts(answer), "mode off\n");
        assert!(before.contains("pulses") && after.contains("check passed"));
        assert_eq!(between("\ncheck: at rest\n> ", "status"), None, "that is no answer");
        assert_eq!(between("> arm\n> ", "arm"), Some(("> ", "", "")));
    }
}
