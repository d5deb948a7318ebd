//! The page as one file: style, modules, worker and data lie within it, so that it needs no network and opens from anywhere.

use std::collections::BTreeMap;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use fdi_core::likelihood::{Channel, FaultClass};
use fdi_core::schema::FIELDS;
use serde_json::json;

use crate::exercise;

const INDEX: &str = include_str!("../page/index.html");
const STYLE: &str = include_str!("../page/lab.css");
const WORKER: &str = include_str!("../page/worker.js");
const BEGIN: &str = include_str!("../page/begin.js");
const REPORT: &str = "<!-- report -->";
/// Of others, within the session; `tools/licences` makes it.
const LICENCES: &str = include_str!("../page/licences.txt");
/// What the session in a page begins with.
const WASM: &str = "<script type=\"text/plain\" id=\"wasm\">";
/// The module that [`classes`] makes.
const CLASSES: &str = "lab/classes.js";
const PLACE: &str = "<!-- bundle: style, modules, worker, data -->";

/// What stands in the page's place for a browser that has not brought the token: it fetches the page with the token that this tab has kept,
/// or says where the link is.
pub const DOOR: &str = include_str!("../page/door.html");

/// What stands in a rig's place that is not there yet; it looks again by itself.
pub const ABSENT: &str = include_str!("../page/absent.html");

/// The wall of several rigs: a page of its own, which reads a tile with the modules of the other.
const WALL: &str = include_str!("../page/wall.html");
const OF_WALL: [(&str, &str); 2] = [
    ("lab/wall.js", include_str!("../page/wall.js")),
    ("lab/wall_words.js", include_str!("../page/wall_words.js")),
];
const WALL_STYLE: &str = include_str!("../page/wall.css");

macro_rules! modules {
    ($($name:literal),+ $(,)?) => {
        /// The modules, by the names under which they import each other.
        const MODULES: [(&str, &str); [$($name),+].len()] =
            [$((concat!("lab/", $name, ".js"), include_str!(concat!("../page/", $name, ".js")))),+];
    };
}
modules!(
    "acts",
    "board",
    "canvas",
    "charts",
    "closeup",
    "commissioning",
    "course",
    "csv",
    "events",
    "exam",
    "exam_text",
    "export",
    "faults",
    "files",
    "hand",
    "hear",
    "judge",
    "main",
    "measure",
    "overview",
    "panel",
    "panels",
    "parts",
    "plan",
    "plants",
    "quiz",
    "review",
    "ribbons",
    "rig",
    "say",
    "scene",
    "serial",
    "sheet",
    "show",
    "sources",
    "state",
    "store",
    "strings",
    "talk",
    "verdict",
    "view",
    "words_en",
    "words_pt",
    "write",
);

/// The module of the classes of fault, from their rows: their short names in English as words of the page, and which explain a share of an alarm.
fn classes() -> String {
    let word = |class: &FaultClass| {
        let t = class.sensor().map_or("", Channel::name);
        format!("c_{}:'{}',", class.name(), class.short().replace("{t}", t))
    };
    let shares: Vec<&str> = FIELDS.iter().filter_map(|field| field.name.strip_prefix("x_")).collect();
    let words: String = FaultClass::ALL.iter().map(word).collect();
    format!("export const SHORT={{{words}}};\nexport const SHARES='{}'.split(' ');\n", shares.join(" "))
}

/// The module of the exercises. A file that is none leaves the page without them: `cargo lab` and a test look first.
const EXERCISES: &str = "lab/exercises.js";

/// What the page gets its numbers from.
#[derive(Clone, Copy, Debug)]
pub enum Source<'a> {
    /// The session as WebAssembly, packed by gzip.
    InPage(&'a [u8]),
    /// The server that sent the page, with the token for its commands.
    Server(&'a str),
    /// A recording.
    Recording {
        /// `hello`, `name`, `values` and `orders` of PROTOCOL.md, as JSON.
        json: &'a str,
        /// What is told of it beside, as HTML.
        report: &'a str,
    },
}

/// The page.
pub fn html(source: Source) -> String {
    let data = match source {
        Source::InPage(wasm) => {
            let worker = lean(WORKER).replace("</script", "<\\/script");
            format!(
                "<script type=\"text/plain\" id=\"licences\">{}</script>\n\
                 <script type=\"text/plain\" id=\"worker\">{worker}</script>\n\
                 {WASM}{}</script>",
                lean(LICENCES),
                STANDARD.encode(wasm)
            )
        }
        Source::Server(token) => of_token(token),
        Source::Recording { json, .. } => of_json("recording", json),
    };
    let head = head(STYLE, &MODULES, &data, "lab/main.js");
    let report = match source {
        Source::Recording { report, .. } if !report.is_empty() => {
            format!("<section class=\"report\">\n{report}</section>")
        }
        _ => String::new(),
    };
    INDEX.replacen(REPORT, &report, 1).replacen(PLACE, &head, 1)
}

/// lab.html with a server's token in it: it begins at the server, and has all that lies in the file, such as a board at a port of its computer.
/// `None` where `page` is no lab.html.
pub fn with_token(page: &str, token: &str) -> Option<String> {
    let (before, wasm) = page.split_once(WASM)?;
    Some(format!("{before}{}\n{WASM}{wasm}", of_token(token)))
}

/// Without lines that are only a comment, and without what stands before a line: for a browser, not for people.
fn lean(text: &str) -> String {
    let lines = text.lines().map(str::trim_start).filter(|line| !line.is_empty() && !line.starts_with("//"));
    lines.map(|line| format!("{line}\n")).collect()
}

/// The page of several rigs, with the token for their stop, and what must be known to read a tile, as JSON.
pub fn wall(token: &str, key: &str) -> String {
    let modules: Vec<_> = MODULES.into_iter().chain(OF_WALL).collect();
    let data = of_token(token) + &of_json("key", key);
    WALL.replacen(PLACE, &head(&format!("{STYLE}{WALL_STYLE}"), &modules, &data, "lab/wall.js"), 1)
}

fn of_token(token: &str) -> String {
    format!("<script type=\"text/plain\" id=\"token\">{token}</script>")
}

fn of_json(id: &str, json: &str) -> String {
    format!("<script type=\"application/json\" id=\"{id}\">{}</script>", json.replace('<', "\\u003c"))
}

/// Style, modules and data; `main` is the module that begins. The modules stand in an import map of data once the page has made it of their JSON: a file
/// has no siblings that it may load.
fn head(style: &str, modules: &[(&str, &str)], data: &str, main: &str) -> String {
    let classes = classes();
    let exercises = exercise::module().unwrap_or_else(|_| "export const EXERCISES=[];\n".into());
    let sources: BTreeMap<&str, String> = modules
        .iter()
        .chain(&[(CLASSES, classes.as_str()), (EXERCISES, exercises.as_str())])
        .map(|(name, text)| (*name, lean(text)))
        .collect();
    let modules = of_json("modules", &json!(sources).to_string());
    format!(
        "<style>{style}</style>\n{modules}\n{data}\n<script>{}</script>",
        lean(BEGIN).replace("MAIN", main)
    )
}

/// The page with its modules packed by gzip, which is a third of their size; `None` where `page` is none of these.
pub fn packed(page: &str, gzip: fn(&[u8]) -> Vec<u8>) -> Option<String> {
    let (before, rest) = page.split_once("<script type=\"application/json\" id=\"modules\">")?;
    let (modules, after) = rest.split_once("</script>")?;
    let text = STANDARD.encode(gzip(modules.as_bytes()));
    Some(format!("{before}<script type=\"text/plain\" id=\"modules\">{text}</script>{after}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a module imports is in the page; none asks for anything else, and none is there for nothing.
    #[test]
    fn every_import_is_a_module_of_the_page() {
        let mut imported = vec!["lab/main.js", "lab/wall.js"];
        let all: Vec<_> = MODULES.into_iter().chain(OF_WALL).collect();
        for (name, text) in &all {
            let from = text
                .lines()
                .filter_map(|line| line.strip_prefix("import ")?.strip_suffix("\";")?.rsplit_once('"'))
                .map(|(_, of)| of);
            for of in from {
                assert!(
                    [CLASSES, EXERCISES].contains(&of) || all.iter().any(|(known, _)| *known == of),
                    "{name} imports {of}"
                );
                imported.push(of);
            }
        }
        assert!(all.iter().all(|(name, _)| imported.contains(name)));
    }

    /// Others' terms go with a copy of what is theirs, and nothing in them ends the element that holds them.
    #[test]
    fn the_page_brings_the_licences_of_what_is_within() {
        let page = html(Source::InPage(&[]));
        let (_, from) = page.split_once("id=\"licences\">").unwrap();
        let (licences, _) = from.split_once("</script>").unwrap();
        assert_eq!(licences, lean(LICENCES));
        assert!(
            ["serde_json", "libm", "Apache License", "WITHOUT WARRANTY OF ANY KIND"]
                .iter()
                .all(|word| licences.contains(word))
        );
    }

    #[test]
    fn what_is_packed_is_the_json_of_the_modules() {
        let page = packed(&html(Source::Server("token")), |json| {
            assert!(
                serde_json::from_slice::<BTreeMap<String, String>>(json).unwrap().contains_key("lab/main.js")
            );
            b"packed".to_vec()
        });
        assert!(page.unwrap().contains("id=\"modules\">cGFja2Vk</script>"));
        assert!(packed("<!doctype html>", |_| Vec::new()).is_none());
    }

    #[test]
    fn a_module_is_without_its_comments_and_indentation() {
        let text = "// What it is.\nlet a = 1; // one\n\n  // More.\n  b(`x\n    y`);\n";
        assert_eq!(lean(text), "let a = 1; // one\nb(`x\ny`);\n");
    }

    #[test]
    fn every_class_has_a_short_name_for_the_page() {
        let module = classes();
        assert!(
            module.contains("c_t1_offset:'T1 reads wrong',") && module.contains("c_t2_stuck:'T2 stuck',")
        );
        assert!(module.contains("SHARES='t1_offset t2_offset t0_fault "), "{module}");
        assert!(
            FaultClass::ALL.iter().all(|class| !class.short().is_empty() && !class.short().contains('\''))
        );
    }

    #[test]
    fn nothing_of_the_page_lies_elsewhere() {
        let page = html(Source::InPage(b"\0asm"));
        let texts = MODULES.iter().chain(&OF_WALL).map(|(_, text)| *text);
        let texts = texts.chain([INDEX, STYLE, WORKER, BEGIN, WALL, WALL_STYLE, ABSENT]);
        for text in texts {
            let links =
                text.match_indices("http").map(|(i, _)| &text[i..]).filter(|link| link.contains("://"));
            let foreign = links.filter(|link| link.starts_with("http://") || link.starts_with("https://"));
            assert!(
                foreign.clone().all(|link| link.starts_with("http://www.w3.org/2000/svg")),
                "{:?}",
                foreign.last()
            );
        }
        assert!(page.contains("AGFzbQ==") && !page.contains(PLACE));
    }
}
