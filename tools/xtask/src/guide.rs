//! What to read before power, wiring and the first day as one page to print: three documents with their pictures within it, for a folder
//! that is handed on without the rest of docs/.

use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use pulldown_cmark::{CowStr, Event, Options, Parser, Tag, TagEnd, html};

/// The documents, in the order of the page, each with its identity on it.
const DOCUMENTS: [(&str, &str); 3] =
    [("before-power.md", "before-power"), ("wiring.md", "wiring"), ("first-day.md", "first-day")];
const HEAD: &str = include_str!("guide.html");
const PLACE: &str = "<!-- documents -->";

/// The page, of the documents in the folder `docs`.
///
/// # Errors
/// A document or a picture that cannot be read, or a picture of another kind than SVG and PNG.
pub(crate) fn page(docs: &Path) -> Result<String, String> {
    let mut articles = String::new();
    for (file, id) in DOCUMENTS {
        articles.push_str(&format!("<article id=\"{id}\">\n{}</article>\n", article(docs, file)?));
    }
    Ok(HEAD.replacen(PLACE, &articles, 1))
}

fn article(docs: &Path, file: &str) -> Result<String, String> {
    let bytes = read(&docs.join(file))?;
    let text = String::from_utf8(bytes).map_err(|error| format!("{file}: {error}"))?;
    let mut left = Vec::new(); // where links that are open lead
    let mut events = Vec::new();
    for event in Parser::new_ext(&text, Options::ENABLE_TABLES) {
        match event {
            Event::Start(Tag::Image { link_type, dest_url, title, id }) => {
                let dest_url = picture(docs, &dest_url)?.into();
                events.push(Event::Start(Tag::Image { link_type, dest_url, title, id }));
            }
            Event::Start(Tag::Link { link_type, dest_url, title, id }) => {
                left.push(lead(&dest_url));
                if let Some(Lead::Here(dest_url)) = left.last() {
                    let dest_url = CowStr::from(dest_url.clone());
                    events.push(Event::Start(Tag::Link { link_type, dest_url, title, id }));
                }
            }
            Event::End(TagEnd::Link) => match left.pop() {
                // What is not on the page is named: on paper nobody can follow a link.
                Some(Lead::Away(file)) => events.push(Event::Text(format!(" (docs/{file})").into())),
                _ => events.push(Event::End(TagEnd::Link)),
            },
            other => events.push(other),
        }
    }
    let mut out = String::new();
    html::push_html(&mut out, events.into_iter());
    Ok(out)
}

/// Where a link of a document leads to.
enum Lead {
    /// On the page, or to an address.
    Here(String),
    /// To another document, of this name.
    Away(String),
}

fn lead(to: &str) -> Lead {
    let (file, _) = to.split_once('#').unwrap_or((to, ""));
    match DOCUMENTS.iter().find(|(known, _)| *known == file) {
        Some((_, id)) => Lead::Here(format!("#{id}")),
        None if to.contains("://") => Lead::Here(to.into()),
        None => Lead::Away(file.into()),
    }
}

/// A picture as an address that holds it.
fn picture(docs: &Path, file: &str) -> Result<String, String> {
    let kind = match Path::new(file).extension().and_then(|kind| kind.to_str()) {
        Some("svg") => "svg+xml",
        Some("png") => "png",
        _ => return Err(format!("{file}: expected a picture as .svg or .png")),
    };
    Ok(format!("data:image/{kind};base64,{}", STANDARD.encode(read(&docs.join(file))?)))
}

fn read(file: &Path) -> Result<Vec<u8>, String> {
    std::fs::read(file).map_err(|error| format!("{}: {error}", file.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn docs() -> std::path::PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs")
    }

    /// All documents whole, and nothing that lies elsewhere.
    #[test]
    fn the_page_needs_nothing_beside_it() {
        let page = page(&docs()).unwrap();
        for part in [
            "<h1>Before power</h1>",
            "<h1>Wiring</h1>",
            "<td>PA8</td>",
            "<h2>6. The first fault</h2>",
            "cargo fw-run",
        ] {
            assert!(page.contains(part), "{part}");
        }
        let targets = |name: &str| {
            let name = format!("{name}=\"");
            page.split(name.as_str())
                .skip(1)
                .map(|rest| rest.split('"').next().unwrap_or(""))
                .collect::<Vec<_>>()
        };
        let pictures = DOCUMENTS
            .map(|(file, _)| std::fs::read_to_string(docs().join(file)).unwrap().matches("![").count());
        assert_eq!(targets(" src").len(), pictures.iter().sum::<usize>());
        assert!(targets(" src").iter().all(|to| to.starts_with("data:image/")));
        let here = |to: &&str| {
            ["#before-power", "#wiring", "#first-day", "data:,"].contains(to) || to.starts_with("https://")
        };
        assert_eq!(targets(" href").into_iter().find(|to| !here(to)), None);
        assert!(page.contains("<a href=\"#wiring\">"));
        assert!(page.contains(" (docs/safety.md)"));
        assert!(!page.contains(PLACE));
    }

    #[test]
    fn a_picture_that_is_not_there_or_of_another_kind_is_named() {
        assert!(picture(&docs(), "wiring/none.svg").unwrap_err().contains("none.svg"));
        assert!(picture(&docs(), "a.gif").unwrap_err().contains("expected a picture as .svg or .png"));
    }
}
