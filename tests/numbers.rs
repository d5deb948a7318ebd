//! What stands in two places is the same in both: results that a page repeats, and names of settings that a page mentions.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::documents;

/// A sentence of a page, with `{}` for each number; the page that the numbers come from, and where in it each stands. A name behind the page's is
/// that of a block between `<!-- NAME -->` and `<!-- end NAME -->`.
struct Repeated(&'static str, &'static str, &'static str, &'static [&'static str]);

const REPEATED: [Repeated; 12] = [
    Repeated(
        "README.md",
        "before the paper's method in {}, {} and {} of the runs",
        "docs/experiment.md",
        &["names it first  AFS2 {}, MFS1 {}, MFP {} of 200 runs"],
    ),
    Repeated(
        "README.md",
        "{} of {} targets met",
        "docs/evidence/results.md#physics",
        &["Targets: {} of {} met"],
    ),
    Repeated(
        "README.md",
        "none in {} h where disturbances are moderate, {} an hour where they are strong",
        "docs/evidence/results.md#physics",
        &[
            "hours/* @ trainer | hours (likelihood) | at least 2000 | {} |",
            "hours/* @ harsh | alarms-per-hour (likelihood) | at most 0.02 | {} |",
        ],
    ),
    Repeated(
        "docs/evidence/diagnosis-results.md",
        "| 0.21 / 0.57 / 0.42 s | {} / {} / {} s |",
        "docs/evidence/results.md#physics",
        &[
            "nominal/afs2 @ paper | detection-p95 (likelihood) | at most 0.21 | {} |",
            "nominal/mfs1 @ paper | detection-p95 (likelihood) | at most 0.57 | {} |",
            "nominal/mfp @ paper | detection-p95 (likelihood) | at most 0.42 | {} |",
        ],
    ),
    Repeated(
        "docs/evidence/diagnosis-results.md",
        "| 0.25 / 0.9 / 0.6; 5 s | {} / {} / {}; {} s |",
        "docs/evidence/results.md#physics",
        &[
            "nominal/afs2 @ paper | right-p95 (likelihood) | at most 0.25 | {} |",
            "nominal/mfs1 @ paper | right-p95 (likelihood) | at most 0.9 | {} |",
            "nominal/mfp @ paper | right-p95 (likelihood) | at most 0.6 | {} |",
            "nominal/mfp @ paper | isolation-p95 (likelihood) | at most 5 | {} |",
        ],
    ),
    Repeated(
        "docs/evidence/diagnosis-results.md",
        "| 0.28 / 0.74 / 0.55 s; 99 % | {} / {} / {} s; {} % |",
        "docs/evidence/results.md#physics",
        &[
            "nominal/afs2 @ trainer | detection-p95 (likelihood) | at most 0.28 | {} |",
            "nominal/mfs1 @ trainer | detection-p95 (likelihood) | at most 0.74 | {} |",
            "nominal/mfp @ trainer | detection-p95 (likelihood) | at most 0.55 | {} |",
            "nominal/* @ trainer | end-right (likelihood) | at least 99 | {} |",
        ],
    ),
    Repeated(
        "docs/evidence/diagnosis-results.md",
        "| 0.42 / 1.14 / 0.84 s; 97 % | {} / {} / {} s; {} % |",
        "docs/evidence/results.md#physics",
        &[
            "nominal/afs2 @ harsh | detection-p95 (likelihood) | at most 0.42 | {} |",
            "nominal/mfs1 @ harsh | detection-p95 (likelihood) | at most 1.14 | {} |",
            "nominal/mfp @ harsh | detection-p95 (likelihood) | at most 0.84 | {} |",
            "nominal/* @ harsh | end-right (likelihood) | at least 97 | {} |",
        ],
    ),
    Repeated(
        "docs/evidence/diagnosis-results.md",
        "| 240 / 380 / 340 / 640 s | {} / {} / {} / {} s |",
        "docs/evidence/results.md#physics",
        &[
            "slow/air flow -25 % in 10 min @ trainer | detection-median (likelihood) | at most 240 | {} |",
            "slow/air flow -40 % in 30 min @ trainer | detection-median (likelihood) | at most 380 | {} |",
            "slow/heater power -20 % in 10 min @ trainer | detection-median (likelihood) | at most 340 | {} |",
            "slow/heater power -30 % in 30 min @ trainer | detection-median (likelihood) | at most 640 | {} |",
        ],
    ),
    Repeated(
        "docs/evidence/diagnosis-results.md",
        "with a sag of 4 % in it, 99 % | 5 s | {} s |",
        "docs/evidence/results.md#physics",
        &["sag/*, worst: sag/t1, power +4 % @ paper | tail-p99 (likelihood) | at most 5 | {} |"],
    ),
    Repeated(
        "docs/evidence/diagnosis-results.md",
        "| 0.005; 0.02; 0.02 | {} ({} in {} h); {}; {} |",
        "docs/evidence/results.md#physics",
        &[
            "hours/* @ trainer | alarms-per-hour (likelihood) | at most 0.005 | {} |",
            "hours/* @ trainer | alarms-per-hour (likelihood) | at most 0.005 | {} |",
            "hours/* @ trainer | hours (likelihood) | at least 2000 | {} |",
            "hours/* @ harsh | alarms-per-hour (likelihood) | at most 0.02 | {} |",
            "hours/mains* | alarms-per-hour (likelihood) | at most 0.02 | {} |",
        ],
    ),
    Repeated(
        "docs/evidence/diagnosis-results.md",
        "| 97 %, 100 % | {} %, {} % (",
        "docs/evidence/results.md#physics",
        &[
            "slow/air flow -40 % in 30 min @ trainer | end-right (likelihood) | at least 97 | {} |",
            "slow/air flow -40 % in 30 min @ trainer | lasted (likelihood) | at least 100 | {} |",
        ],
    ),
    Repeated(
        "docs/evidence/diagnosis-results.md",
        "| 95 % intervals at the end of a fault hold the truth | 90 % | {} %;",
        "docs/evidence/results.md#physics",
        &["| * | end-coverage (likelihood) | at least 90 | {} |"],
    ),
];

/// A page, or a block of it.
fn part<'a>(documents: &'a BTreeMap<PathBuf, String>, place: &str) -> &'a str {
    let (page, block) = place.split_once('#').unwrap_or((place, ""));
    let text = documents[Path::new(page)].as_str();
    let block =
        text.split(&format!("<!-- {block} -->")).nth(1).and_then(|rest| rest.split("<!-- end ").next());
    block.unwrap_or(text)
}

/// The numbers that stand in a text where a template has `{}`.
fn numbers<'a>(text: &'a str, template: &str) -> Option<Vec<&'a str>> {
    let parts: Vec<&str> = template.split("{}").collect();
    text.match_indices(parts[0]).find_map(|(at, first)| {
        let mut rest = &text[at + first.len()..];
        let mut found = Vec::new();
        for part in &parts[1..] {
            let end = rest.find(|c: char| !c.is_ascii_digit() && c != '.')?;
            let (number, after) = rest.split_at(end);
            number.parse::<f64>().ok()?;
            found.push(number);
            rest = after.strip_prefix(part)?;
        }
        Some(found)
    })
}

/// A number with as many decimals as another has.
fn rounded_like(number: &str, other: &str) -> String {
    let decimals = other.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    format!("{:.decimals$}", number.parse::<f64>().unwrap())
}

/// Why a page does not repeat what another says.
fn differs(says: &str, page: &str, from: &[&str], source: &str) -> Option<String> {
    let mut real = Vec::new();
    for template in from {
        match numbers(source, template) {
            Some(found) => real.extend(found),
            None => return Some(format!("not found: {template}")),
        }
    }
    let Some(repeated) = numbers(page, says) else { return Some(format!("not found: {says}")) };
    assert_eq!(repeated.len(), real.len(), "{says}");
    let expected: Vec<String> = repeated.iter().zip(&real).map(|(told, is)| rounded_like(is, told)).collect();
    (repeated != expected).then(|| format!("{says}: {repeated:?}, expected {expected:?}"))
}

#[test]
fn results_that_a_page_repeats_are_those_of_their_page() {
    let documents = documents();
    let text = |place: &str| part(&documents, place);
    let wrong = REPEATED.iter().filter_map(|Repeated(page, says, source, from)| {
        Some(format!("{page}, of {source}: {}", differs(says, text(page), from, text(source))?))
    });
    let wrong: Vec<String> = wrong.collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The faults that were made on purpose in a real TCLab: limits of its definitions are a sample for thermistors, 60 s for the heater.
#[test]
fn the_readme_counts_the_faults_of_the_real_heaters_as_their_page_does() {
    let documents = documents();
    let page = documents[Path::new("docs/evidence/records.md")].as_str();
    let tables = page.split("### tclab/faults_0").skip(1).map(|part| part.split("\n### ").next().unwrap());
    let rows: Vec<Vec<&str>> =
        tables.flat_map(str::lines).map(|line| line.split_whitespace().collect()).collect();
    let [offsets, powers] = ["T1", "heater-power"].map(|of| {
        let rows = rows.iter().filter(|row| row.first() == Some(&of));
        rows.map(|row| row[row.iter().position(|word| *word == "s").unwrap() + 1]).collect::<Vec<_>>()
    });
    let named = offsets.iter().filter(|alarm| **alarm == "1").count();
    let (seen, missed): (Vec<&str>, Vec<&str>) = powers.into_iter().partition(|alarm| *alarm != "never");
    let in_time = seen.iter().filter(|alarm| alarm.parse::<u32>().unwrap() <= 60).count();
    let expected = format!(
        "{named} of {} thermistor faults named at the second sample; of {} heater faults {in_time} in time, {} late, {} missed",
        offsets.len(),
        seen.len() + missed.len(),
        seen.len() - in_time,
        missed.len()
    );
    let readme = &documents[Path::new("README.md")];
    assert!(readme.contains(&expected), "README.md does not say: {expected}");
}

#[test]
fn a_stale_number_is_told_and_rounding_is_not() {
    let source = "Targets: 32 of 62 met\n| hours | 487.2134 |\n";
    let from = ["Targets: {} of", "| hours | {} |"];
    assert_eq!(differs("{} met in {} h", "x; 32 met in 487 h", &from, source), None);
    let stale = differs("{} met in {} h", "x; 31 met in 487.3 h", &from, source).unwrap();
    assert!(stale.ends_with(r#"["31", "487.3"], expected ["32", "487.2"]"#), "{stale}");
    assert!(differs("{} met", "32 missed", &["Targets: {} of"], source).unwrap().contains("{} met"));
}

/// Names of a table's first column with code.
fn names(page: &str) -> impl Iterator<Item = &str> {
    page.lines().filter(|line| line.starts_with('|')).filter_map(|line| line.split('`').nth(1))
}

/// docs/settings.md and docs/evidence/tuning.md are compared with the code; so what they list is what exists.
#[test]
fn settings_that_a_page_names_exist() {
    let documents = documents();
    let made = [Path::new("docs/settings.md"), Path::new("docs/evidence/tuning.md")];
    let exist: BTreeSet<&str> = made.iter().flat_map(|page| names(&documents[*page])).collect();
    let group = |name: &str| name.rsplit_once('.').map(|(group, _)| group.to_owned());
    let groups: BTreeSet<String> = exist.iter().filter_map(|name| group(name)).collect();
    let (mut gone, mut named) = (Vec::new(), 0);
    let history = Path::new("CHANGELOG.md");
    let asked = |page: &Path| page != history && !made.contains(&page);
    for (page, text) in documents.iter().filter(|(page, _)| asked(page)) {
        for (number, line) in (1..).zip(text.lines()) {
            for code in line.split('`').skip(1).step_by(2) {
                let name = code.split([' ', '=']).next().unwrap_or(code);
                if group(name).is_some_and(|group| groups.contains(&group)) {
                    named += 1;
                    let is_other = [".rs", ".1", ".*"].iter().any(|end| name.ends_with(end)); // a file, a row of many, a group
                    if !is_other && !exist.contains(name) {
                        gone.push(format!("{}:{number}: {name}", page.display()));
                    }
                }
            }
        }
    }
    assert!(gone.is_empty(), "no setting and no number has these names:\n{}", gone.join("\n"));
    assert!(named > 500, "{named} names");
}
