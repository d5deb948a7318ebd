//! Code blocks of the pages: the programs that they call exist, what they show is TOML that is read, and no block is there that nothing checks
//! unless it is listed here with the reason. What `pt326` takes and prints is compared by `host-sim/tests/cli/samples.rs`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use pt326_host::experiment::scenario::Scenario;
use toml::Table;

use super::{documents, root, sources};

/// What is shown and not made by a command: the page, how the block begins, why.
const UNCHECKED: [(&str, &str, &str); 9] = [
    ("CONTRIBUTING.md", "   stale: cargo run", "what a test says that fails"),
    ("docs/architecture.md", "            ┌─", "a drawing"),
    ("docs/dashboards.md", "scrape_configs:", "read by Prometheus; tools/try-dashboard has another"),
    ("docs/dashboards.md", "    metric_relabel_configs:", "read by Prometheus"),
    ("docs/diagnosis.md", "power ─▶", "a drawing"),
    ("docs/exercises.md", "{", "lab/src/exercise.rs reads it"),
    ("docs/exercises.md", "lab: exercises", "lab/src/exercise.rs compares it"),
    ("docs/exercises.md", "\"scene\": {", "lab/src/exercise.rs reads it"),
    ("docs/fmi.md", "the step is 0.1 s", "tools/try-fmu compares it"),
];

/// Programs of others that blocks call, and what a shell does itself.
const FOREIGN: &str = "apt-get brew cd curl dfu-util echo git jupyter maturin mkdir mosquitto_pub mosquitto_sub my-logger my-plant parallel pip \
    printf promtool python rustup sbatch seq set sha256sum srun stm32flash sudo tee winget xcode-select";

/// Commands of cargo itself, and those that a page says how to install.
const OF_CARGO: [&str; 11] =
    ["bench", "binstall", "build", "clippy", "doc", "fmt", "install", "mutants", "run", "test", "tree"];

/// A block: its page, the line where it begins from 1, its language, the line above it, its lines.
struct Block<'a> {
    page: &'a Path,
    line: usize,
    language: &'a str,
    above: &'a str,
    text: Vec<&'a str>,
}

impl Block<'_> {
    fn place(&self) -> String {
        format!("{}:{}", self.page.display(), self.line)
    }
}

/// The documents but for the history, and what is told beside the sources.
fn pages() -> BTreeMap<PathBuf, String> {
    let mut pages = documents();
    pages.remove(Path::new("CHANGELOG.md"));
    for page in ["python/README.md", "tools/README.md", "tools/virtual-board/README.md"] {
        pages.insert(page.into(), std::fs::read_to_string(root().join(page)).unwrap());
    }
    pages
}

fn blocks(pages: &BTreeMap<PathBuf, String>) -> Vec<Block<'_>> {
    let mut found: Vec<Block> = Vec::new();
    for (page, text) in pages {
        let (mut open, mut above) = (false, "");
        for (line, full) in (1..).zip(text.lines()) {
            match full.trim_start().strip_prefix("```") {
                Some(language) => {
                    open = !open;
                    if open {
                        found.push(Block { page, line, language, above, text: Vec::new() });
                    }
                }
                None if open => found.last_mut().unwrap().text.push(full),
                None => {}
            }
            above = full;
        }
    }
    found
}

/// The commands of a line of a shell, each as its words; without comments, and without variables that are set before a command.
fn commands(line: &str) -> Vec<Vec<String>> {
    let (mut parts, mut word, mut quote, mut before) = (vec![Vec::new()], String::new(), None, ' ');
    for c in line.chars().chain([' ']) {
        match (c, quote) {
            (c, Some(open)) if c == open => quote = None,
            (c, Some(_)) => word.push(c),
            ('\'' | '"', None) => quote = Some(c),
            ('#', None) if before == ' ' => break,
            (' ' | '|' | '&' | ';', None) => {
                if !word.is_empty() {
                    parts.last_mut().unwrap().push(std::mem::take(&mut word));
                }
                if c != ' ' {
                    parts.push(Vec::new());
                }
            }
            (c, None) => word.push(c),
        }
        before = c;
    }
    for words in &mut parts {
        let set = words.iter().take_while(|word| word.split('=').next().is_some_and(is_variable)).count();
        words.drain(..set);
    }
    parts.retain(|words: &Vec<String>| !words.is_empty());
    parts
}

fn is_variable(name: &str) -> bool {
    !name.is_empty() && name.chars().all(|c| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_')
}

/// What cargo knows of this workspace: manifests by the names of packages, and aliases.
struct Workspace {
    packages: BTreeMap<String, (PathBuf, Table)>,
    aliases: Table,
    sources: String,
}

impl Workspace {
    fn new() -> Self {
        let table = |file: PathBuf| -> Table { std::fs::read_to_string(file).unwrap().parse().unwrap() };
        let members = table(root().join("Cargo.toml"))["workspace"]["members"].as_array().unwrap().clone();
        let packages = members.iter().map(|member| {
            let folder = root().join(member.as_str().unwrap());
            let manifest = table(folder.join("Cargo.toml"));
            (manifest["package"]["name"].as_str().unwrap().to_owned(), (folder, manifest))
        });
        let packages = packages.collect();
        let aliases = table(root().join(".cargo/config.toml"))["alias"].as_table().unwrap().clone();
        Self { packages, aliases, sources: sources() }
    }

    /// Whether one of these packages, or any if none is named, is so.
    fn any(&self, packages: &[&str], is_so: impl Fn(&Path, &Table) -> bool) -> bool {
        let mut named =
            self.packages.iter().filter(|(own, _)| packages.is_empty() || packages.contains(&own.as_str()));
        named.any(|(_, (folder, manifest))| is_so(folder, manifest))
    }

    /// Whether a package has a target of this kind: `test`, `bin`, `example`.
    fn has_target(&self, packages: &[&str], kind: &str, name: &str) -> bool {
        let place = if kind == "bin" { "src/bin".to_owned() } else { format!("{kind}s") };
        self.any(packages, |folder, manifest| {
            let listed = manifest.get(kind).and_then(|targets| targets.as_array()).into_iter().flatten();
            let named = listed.filter_map(|target| target["name"].as_str()).any(|own| own == name);
            let found = folder.join(&place);
            named || found.join(format!("{name}.rs")).exists() || found.join(name).join("main.rs").exists()
        })
    }

    fn has_feature(&self, packages: &[&str], feature: &str) -> bool {
        let has = |_: &Path, manifest: &Table| {
            let name = feature.rsplit('/').next().unwrap_or(feature);
            manifest.get("features").is_some_and(|features| features.get(name).is_some())
        };
        match feature.split_once('/') {
            Some((package, _)) => self.any(&[package], has),
            None => self.any(packages, has),
        }
    }

    /// Whether a module has this name, or a test's holds it: the last part of a path.
    fn has_test(&self, filter: &str) -> bool {
        let last = filter.split("::").filter(|part| !part.is_empty()).last().unwrap_or_default();
        let name = |line: &str, word: &str| {
            let end = |c: char| !c.is_alphanumeric() && c != '_';
            line.split_once(word).and_then(|(_, rest)| rest.split(end).next().map(str::to_owned))
        };
        self.sources.lines().any(|line| {
            name(line, "fn ").is_some_and(|name| name.contains(last))
                || name(line, "mod ").is_some_and(|name| name == last)
        })
    }

    /// What a command of cargo names that is not there.
    fn missing_of_cargo(&self, words: &[String]) -> Option<String> {
        let verb = words.get(1)?;
        if verb.starts_with('-') || verb.chars().any(|c| c.is_uppercase()) {
            return None; // `cargo --version`; `cargo X`, any
        }
        let is_alias = self.aliases.contains_key(verb);
        if !is_alias && !OF_CARGO.contains(&verb.as_str()) {
            return Some(format!("cargo {verb}"));
        }
        let values = |names: &[&str]| -> Vec<&str> {
            let pairs = words.windows(2).filter(|pair| names.contains(&pair[0].as_str()));
            pairs.map(|pair| pair[1].as_str()).collect()
        };
        let mut packages = values(&["-p", "--package"]);
        if let Some(package) = packages.iter().find(|package| !self.packages.contains_key(**package)) {
            return Some(format!("package {package}"));
        }
        for path in values(&["--path"]) {
            match self.packages.iter().find(|(_, (folder, _))| folder.ends_with(path)) {
                Some((package, _)) => packages.push(package),
                None => return Some(path.to_owned()),
            }
        }
        for kind in ["test", "bin", "example"] {
            let named = values(&[&format!("--{kind}")]);
            if let Some(name) = named.iter().find(|name| !self.has_target(&packages, kind, name)) {
                return Some(format!("{kind} {name}"));
            }
        }
        let features = values(&["--features"]);
        let mut features = features.iter().flat_map(|list| list.split(','));
        if let Some(feature) = features.find(|feature| !self.has_feature(&packages, feature)) {
            return Some(format!("feature {feature}"));
        }
        let with_value = ["-p", "--package", "--test", "--features"];
        let filters = words.windows(2).skip(1).filter(|pair| {
            verb == "test" && !pair[1].starts_with('-') && !with_value.contains(&pair[0].as_str())
        });
        let mut filters = filters.map(|pair| &pair[1]);
        filters.find(|filter| !self.has_test(filter)).map(|filter| format!("test {filter}"))
    }

    /// What a command names that is not there.
    fn missing(&self, words: &[String]) -> Option<String> {
        let program = words[0].as_str();
        match program {
            "cargo" => self.missing_of_cargo(words),
            "pt326" => None,
            _ if program.contains('/') => (!root().join(program).exists()).then(|| program.to_owned()),
            _ => (!FOREIGN.split_whitespace().any(|known| known == program)).then(|| program.to_owned()),
        }
    }
}

/// The lines of a script; one that ends with a backslash goes on.
fn joined(lines: &[&str]) -> Vec<String> {
    let mut whole = vec![String::new()];
    for line in lines {
        let (line, goes_on) = line.strip_suffix('\\').map_or((*line, false), |line| (line, true));
        whole.last_mut().unwrap().push_str(line.trim());
        if !goes_on {
            whole.push(String::new());
        }
    }
    whole
}

#[test]
fn what_shell_blocks_and_code_in_sentences_call_exists() {
    let (pages, workspace) = (pages(), Workspace::new());
    let (mut missing, mut checked) = (Vec::new(), 0);
    let mut check = |place: String, line: &str| {
        for words in commands(line) {
            checked += 1;
            missing.extend(
                workspace.missing(&words).map(|what| format!("{place}: {what} is not there: {line}")),
            );
        }
    };
    for block in blocks(&pages).iter().filter(|block| block.language == "sh") {
        joined(&block.text).iter().for_each(|line| check(block.place(), line));
    }
    for (page, text) in &pages {
        for (number, line) in super::outside_code(text) {
            let code = line.split('`').skip(1).step_by(2);
            let ours = code
                .filter(|code| ["cargo ", "tools/", "./check"].iter().any(|start| code.starts_with(start)));
            ours.for_each(|code| check(format!("{}:{number}", page.display()), code));
        }
    }
    assert!(missing.is_empty(), "{}", missing.join("\n"));
    assert!(checked > 250, "{checked} commands");
}

#[test]
fn toml_blocks_are_read_by_what_they_are_for() {
    let pages = pages();
    let all = blocks(&pages);
    let mut scenarios = 0;
    for block in all.iter().filter(|block| block.language == "toml") {
        let text = block.text.join("\n");
        let table: Table = text.parse().unwrap_or_else(|why| panic!("{}: {why}", block.place()));
        if table.contains_key("fault") || table.contains_key("rig") {
            scenarios += 1;
            let scenario: Scenario =
                toml::from_str(&text).unwrap_or_else(|why| panic!("{}: {why}", block.place()));
            scenario.validate().unwrap_or_else(|why| panic!("{}: {why}", block.place()));
        }
        for dependency in table.values().filter_map(|value| value.get("path")) {
            let path = dependency.as_str().unwrap().trim_start_matches("pt326/");
            assert!(root().join(path).join("Cargo.toml").exists(), "{}: {path}", block.place());
        }
    }
    assert!(scenarios > 0);
}

/// What checks a block; `None` if nothing does.
fn checked_by(block: &Block, page: &str) -> Option<&'static str> {
    let marks = page.lines().take(block.line).filter(|line| line.starts_with("<!-- ") && !line.contains(':'));
    let within = marks.last().is_some_and(|mark| !mark.starts_with("<!-- end "));
    match block.language {
        "sh" => Some("the programs that it calls exist"),
        "toml" => Some("it is read"),
        "python" => Some("tools/try-python and tools/try-fmu run it"),
        _ if block.above.trim_start().starts_with("<!-- made by: ") => Some("made by the command above it"),
        _ if within => Some("made by cargo xtask results"),
        _ => None,
    }
}

/// `cargo test -p pt326-tests --test docs blocks -- --nocapture` counts them.
#[test]
fn each_block_is_checked_by_something_or_listed() {
    let pages = pages();
    let (mut unknown, mut counts, mut excused) = (Vec::new(), BTreeMap::new(), Vec::new());
    for block in blocks(&pages) {
        let first = block.text.first().copied().unwrap_or_default();
        let excuse = UNCHECKED
            .iter()
            .find(|(page, begin, _)| block.page == Path::new(page) && first.starts_with(begin));
        match (checked_by(&block, &pages[block.page]), excuse) {
            (Some(how), None) => *counts.entry(how).or_insert(0) += 1,
            (Some(how), Some(_)) => {
                unknown.push(format!("{}: listed as unchecked, but {how}", block.place()))
            }
            (None, Some(excuse)) => excused.push(*excuse),
            (None, None) => unknown.push(format!("{}: nothing checks what is shown: {first}", block.place())),
        }
    }
    println!("{counts:#?}\nunchecked: {excused:#?}");
    assert!(unknown.is_empty(), "{}", unknown.join("\n"));
    let gone: Vec<_> = UNCHECKED.iter().filter(|excuse| !excused.contains(excuse)).collect();
    assert!(gone.is_empty(), "listed as unchecked, but no longer there: {gone:?}");
}

#[test]
fn a_command_that_is_not_there_is_told() {
    let workspace = Workspace::new();
    let missing = |line: &str| commands(line).iter().find_map(|words| workspace.missing(words));
    for (line, what) in [
        ("cd dist && cargo flash", "cargo flash"),
        ("cargo test -p pt326-nothing", "package pt326-nothing"),
        ("A=1 cargo test -p pt326 --test gone", "test gone"),
        ("cargo test -p pt326 --features gone", "feature gone"),
        ("cargo install --path gone", "gone"),
        ("echo \"a; b\" | tools/gone   # or tools/other", "tools/gone"),
        ("gone --help", "gone"),
    ] {
        assert_eq!(missing(line).as_deref(), Some(what), "{line}");
    }
    let here = ["cargo test no", "such", "test"].join("_"); // this file is searched, too
    assert_eq!(missing(&here).as_deref(), Some("test no_such_test"));
    assert_eq!(missing("PT326=x cargo test -p pt326 --test cli samples # comment; gone"), None);
}
