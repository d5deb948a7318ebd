//! The documents: every relative link leads to a file, every anchor to a heading, and the book lists every page; every class of fault has its entry.

mod blocks;
mod followed;
mod numbers;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use fdi_core::FaultClass;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().unwrap()
}

/// The documents at the top and all of docs/, by their paths from the top.
fn documents() -> BTreeMap<PathBuf, String> {
    let root = root();
    let (mut pages, mut folders) = (Vec::new(), vec![root.join("docs")]);
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()) {
            if entry.is_dir() { folders.push(entry) } else { pages.push(entry) }
        }
    }
    pages.extend(std::fs::read_dir(&root).unwrap().map(|entry| entry.unwrap().path()));
    pages.retain(|page| page.extension().is_some_and(|ending| ending == "md"));
    let text = |page: PathBuf| {
        let text = std::fs::read_to_string(&page).unwrap();
        (page.strip_prefix(&root).unwrap().into(), text)
    };
    pages.into_iter().map(text).collect()
}

/// The lines outside of code blocks, with their numbers from 1.
fn outside_code(text: &str) -> Vec<(usize, &str)> {
    let mut code = false;
    let outside = |(_, line): &(usize, &str)| {
        let fence = line.trim_start().starts_with("```");
        code ^= fence;
        !code && !fence
    };
    (1..).zip(text.lines()).filter(outside).collect()
}

/// Targets of `[text](target)`, `![text](target)` and `[name]: target`, each with its line.
fn links(text: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    for (number, line) in outside_code(text) {
        let line: String = line.split('`').step_by(2).collect(); // without code
        let inline = line.split("](").skip(1).filter_map(|rest| rest.split([')', ' ']).next());
        let defined = line.strip_prefix('[').and_then(|rest| rest.split_once("]: "));
        found.extend(
            inline.chain(defined.map(|(_, target)| target)).map(|target| (number, target.to_owned())),
        );
    }
    found
}

/// Anchors of a page as GitHub and mdBook make them of its headings, and those that are written as `<a id="...">`.
fn anchors(text: &str) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for (_, line) in outside_code(text) {
        found.extend(
            line.split("<a id=\"").skip(1).filter_map(|rest| rest.split('"').next()).map(str::to_owned),
        );
        let title = line.trim_start_matches('#');
        if title.len() == line.len() || !title.starts_with(' ') {
            continue;
        }
        let slug: String = title.trim().to_lowercase().replace(' ', "-");
        let slug: String = slug.chars().filter(|c| c.is_alphanumeric() || "-_".contains(*c)).collect();
        let again = found.iter().filter(|other| **other == slug).count();
        found.push(if again > 0 { format!("{slug}-{again}") } else { slug });
    }
    found
}

/// What is wrong with the links of these documents; `exists` knows other files, by their paths from the top.
fn dead_links(documents: &BTreeMap<PathBuf, String>, exists: impl Fn(&Path) -> bool) -> Vec<String> {
    let mut dead = Vec::new();
    for (page, text) in documents {
        for (line, link) in links(text) {
            if link.contains("://") || link.starts_with("mailto:") {
                continue;
            }
            let (path, anchor) = link.split_once('#').unwrap_or((&link, ""));
            let target = if path.is_empty() { Some(page.clone()) } else { resolved(page, path) };
            let why = match target {
                None => "leads out of the repository",
                Some(target) if page.starts_with("docs") && !target.starts_with("docs") => {
                    "leads out of docs/, where the book has no page"
                }
                Some(target) => match documents.get(&target) {
                    Some(text) if !anchor.is_empty() && !anchors(text).iter().any(|a| a == anchor) => {
                        "names no heading"
                    }
                    Some(_) => continue,
                    None if exists(&target) => continue,
                    None => "leads to no file",
                },
            };
            dead.push(format!("{}:{line}: {link} {why}", page.display()));
        }
    }
    dead
}

/// A path beside `page`, from the top; `None` where it leaves the repository.
fn resolved(page: &Path, path: &str) -> Option<PathBuf> {
    let mut parts: Vec<&str> = page.parent()?.iter().filter_map(|part| part.to_str()).collect();
    for part in path.split('/') {
        match part {
            "." => {}
            ".." => drop(parts.pop()?),
            part => parts.push(part),
        }
    }
    Some(parts.iter().collect())
}

#[test]
fn every_link_of_the_documents_leads_somewhere() {
    let documents = documents();
    assert!(documents.len() > 20 && documents.contains_key(Path::new("README.md")), "{documents:?}");
    let dead = dead_links(&documents, |path| root().join(path).exists());
    assert!(dead.is_empty(), "{}", dead.join("\n"));
}

#[test]
fn the_book_lists_every_page_once() {
    let documents = documents();
    let summary = &documents[Path::new("docs/SUMMARY.md")];
    let listed: Vec<PathBuf> =
        links(summary).into_iter().map(|(_, link)| Path::new("docs").join(link)).collect();
    let missing: Vec<_> =
        documents.keys().filter(|page| page.starts_with("docs") && !listed.contains(page)).collect();
    assert_eq!(missing, [Path::new("docs/SUMMARY.md")], "pages that docs/SUMMARY.md does not list");
    let distinct: BTreeSet<_> = listed.iter().collect();
    assert_eq!(distinct.len(), listed.len(), "mdBook refuses a page that is listed twice: {listed:?}");
}

/// What a page of evidence says of its origin.
#[test]
fn each_page_of_evidence_names_its_command_and_commit() {
    for (page, text) in documents() {
        let index = page.ends_with("index.md");
        if !page.starts_with("docs/evidence") || index {
            continue;
        }
        // Numbers that are made from the code, and compared with it by a test, are of every commit.
        let made_here = text.contains("This file is written from");
        let commit = text.to_lowercase().contains("commit ");
        assert!(
            text.contains('`') && (commit || made_here),
            "{} names no command and commit",
            page.display()
        );
    }
}

#[test]
fn the_readme_has_a_hundred_lines_at_most() {
    let lines = std::fs::read_to_string(root().join("README.md")).unwrap().lines().count();
    assert!(lines <= 100, "README.md has {lines} lines, expected 100 at most: the rest belongs to docs/");
}

#[test]
fn every_class_of_fault_has_its_entry() {
    let faults = std::fs::read_to_string(root().join("docs/faults.md")).unwrap();
    let headings: Vec<&str> = faults.lines().filter(|line| line.starts_with('#')).collect();
    for class in FaultClass::ALL {
        let name = format!("`{}`", class.name());
        assert!(
            headings.iter().any(|line| line.contains(&name)),
            "docs/faults.md has no heading with {name}"
        );
    }
}

/// deny.toml without cargo-deny: what must not come back is not in Cargo.lock, and what is excused still is.
#[test]
fn what_nobody_maintains_is_gone_or_excused() {
    let lock = std::fs::read_to_string(root().join("Cargo.lock")).unwrap();
    let deny: toml::Table = std::fs::read_to_string(root().join("deny.toml")).unwrap().parse().unwrap();
    let is_locked = |name: &str| lock.contains(&format!("\nname = \"{name}\"\n"));
    let listed = |table: &str, list: &str, key: &str| -> Vec<String> {
        let entries = deny[table][list].as_array().unwrap().iter();
        entries.map(|entry| entry[key].as_str().unwrap().to_owned()).collect()
    };
    for name in listed("bans", "deny", "crate") {
        assert!(!is_locked(&name), "{name} is back: cargo tree --workspace --target all -i {name}");
    }
    for reason in listed("advisories", "ignore", "reason") {
        let name = reason.split(':').next().unwrap();
        assert!(is_locked(name), "deny.toml excuses {name}, which has gone from Cargo.lock");
    }
}

/// THIRD-PARTY.txt without cargo-about: what it lists is in Cargo.lock in that version, and what the packages that ship ask for is listed.
#[test]
fn the_licences_of_others_are_those_of_what_ships() {
    let read = |file: &str| std::fs::read_to_string(root().join(file)).unwrap();
    let lock: toml::Table = read("Cargo.lock").parse().unwrap();
    let locked: Vec<String> = lock["package"]
        .as_array()
        .unwrap()
        .iter()
        .map(|package| {
            format!("{} {}", package["name"].as_str().unwrap(), package["version"].as_str().unwrap())
        })
        .collect();
    let (text, rule) = (read("THIRD-PARTY.txt"), "\n===\n");
    // Behind each rule: the licence, an empty line, the crates, an empty line, the text.
    let crates = text.split(rule).skip(1).flat_map(|part| part.split("\n\n").nth(1).unwrap().lines());
    let listed: Vec<String> = crates
        .filter(|line| !line.starts_with("the standard library"))
        .map(|line| line.split(' ').take(2).collect::<Vec<_>>().join(" "))
        .collect();
    let stale: Vec<_> = listed.iter().filter(|each| !locked.contains(each)).collect();
    assert!(stale.is_empty(), "stale: tools/licences; not in Cargo.lock: {stale:?}");
    let ours: Vec<String> = [
        "fdi-core",
        "firmware",
        "firmware-logic",
        "fit",
        "fmu",
        "host-sim",
        "host-sim/library",
        "lab",
        "lab/live",
        "lab/wasm",
        "python",
        "rig",
    ]
    .map(|folder| read(&format!("{folder}/Cargo.toml")))
    .into();
    let mut asked = 0;
    for manifest in ours {
        let manifest: toml::Table = manifest.parse().unwrap();
        for (name, _) in manifest["dependencies"].as_table().unwrap().iter().filter(|(name, of)| {
            !name.starts_with("pt326") && *name != "fdi-core" && of.get("workspace").is_none()
        }) {
            asked += 1;
            assert!(
                listed.iter().any(|each| each.starts_with(&format!("{name} "))),
                "tools/licences: {name} ships, and is not in THIRD-PARTY.txt"
            );
        }
    }
    assert!(asked > 40, "{asked}");
}

/// All sources of the folders with tests, one after the other.
fn sources() -> String {
    let folders = ["fdi-core", "firmware-logic", "host-sim", "lab", "tests", "tools/virtual-board"];
    let (mut text, mut folders) = (String::new(), folders.map(|folder| root().join(folder)).to_vec());
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()) {
            if entry.is_dir() {
                folders.push(entry);
            } else if entry.extension().is_some_and(|ending| ending == "rs") {
                text += &std::fs::read_to_string(entry).unwrap();
            }
        }
    }
    text
}

/// From a hazard to the code and to the tests: a file or a test that was renamed is missed here.
#[test]
fn the_hazards_name_files_and_tests_that_are_there() {
    let text = std::fs::read_to_string(root().join("docs/evidence/hazards.md")).unwrap();
    let sources = sources();
    let named = |start: &'static str| {
        let lines = text.lines().filter(move |line| line.starts_with(start));
        lines.flat_map(|line| line.split('`').skip(1).step_by(2)).filter(|name| !name.contains(' '))
    };
    let (mut files, mut tests) = (0, 0);
    for name in named("* **Code.**").chain(named("* **Evidence.**")) {
        if name.contains('/') || name.contains('.') {
            files += 1;
            assert!(root().join(name).exists(), "docs/evidence/hazards.md names {name}, which is not there");
        } else if name.contains('_') {
            tests += 1;
            let there = ["(", "<"].iter().any(|end| sources.contains(&format!("fn {name}{end}")));
            assert!(there, "docs/evidence/hazards.md names the test {name}, which is not there");
        }
    }
    assert!(files > 100 && tests > 100, "{files} files, {tests} tests");
}

/// A message that the page of troubles quotes is one of the program's: searched by its words.
#[test]
fn the_messages_that_the_page_of_troubles_quotes_are_in_the_code() {
    let page = std::fs::read_to_string(root().join("docs/trouble.md")).unwrap();
    let words = std::fs::read_to_string(root().join("lab/page/words_en.js")).unwrap();
    let code = sources() + &words;
    let quoted: Vec<&str> = page
        .lines()
        .filter_map(|line| line.strip_prefix("| **")?.split_once("**").map(|(it, _)| it))
        .collect();
    assert!(quoted.len() > 40, "{quoted:?}");
    let gone: Vec<_> = quoted.iter().filter(|message| !code.contains(**message)).collect();
    assert!(gone.is_empty(), "docs/trouble.md quotes what no program says: {gone:#?}");
}

#[test]
fn a_dead_link_is_told_with_its_line() {
    let page = "# A page\n[b](b.md#two-words) [b](b.md#none) `[c](c.md)`\n```\n[d](d.md)\n```\n![e](e.png)\n\n[f]: f/\n[g](../../g.md)\n[h](#a-page)";
    let documents = [("docs/a.md", page), ("docs/b.md", "## Two words\n")];
    let documents = documents.map(|(path, text)| (path.into(), text.to_owned())).into();
    let dead = dead_links(&documents, |path| path == Path::new("docs/f"));
    let expected = [
        "docs/a.md:2: b.md#none names no heading",
        "docs/a.md:6: e.png leads to no file",
        "docs/a.md:9: ../../g.md leads out of the repository",
    ];
    assert_eq!(dead, expected);
    let readme = [("docs/a.md".into(), "[r](../README.md)".to_owned())].into();
    assert_eq!(dead_links(&readme, |_| true).len(), 1, "the book has no such page");
}

#[test]
fn anchors_are_those_of_the_headings() {
    let text = "# 8. Naming, unknown, ending\n```sh\n# a comment\n```\n## `check`: what\n## Same\n## Same\n<a id=\"h\"></a>";
    assert_eq!(anchors(text), ["8-naming-unknown-ending", "check-what", "same", "same-1", "h"]);
}
