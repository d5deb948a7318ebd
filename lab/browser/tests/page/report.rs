//! The report of an experiment, which is the page with its run.

use pt326::commands::run::carry_out as run_experiment;
use pt326_lab_browser::Browser;
use serde_json::json;

use crate::{assert_untroubled, script_on};

/// A report tells of each fault first, in a sentence, and walks through the run.
#[test]
fn a_report_is_the_page_with_the_run_within_it() {
    let folder = std::env::temp_dir().join(format!("pt326-report-{}", std::process::id()));
    let (config, scenario) = Default::default();
    run_experiment(&config, &scenario, 1, &folder).expect("the paper's run");
    let file = folder.join("report.html");
    assert!(std::fs::metadata(&file).expect("the report").len() < 3_000_000);
    let browser = Browser::start().expect("a browser");
    browser.open(&format!("file://{}", file.display())).expect("the report");
    let told = script_on(
        &browser,
        r##"await until(() => document.querySelectorAll(".review article").length === 3);
           const heads = [...document.querySelectorAll(".review .head")].map((n) => n.innerText.replace(/\d+(\.\d+)?/g, "#").replaceAll("\u00a0", " "));
           const [width, orders] = [document.documentElement.scrollWidth <= innerWidth, $("#stop").hidden];
           const rests = lab.lab.paused && lab.charts.span > 800;
           $("#seek").value = 3530; $("#seek").dispatchEvent(new Event("input", { bubbles: true }));
           await until(() => /T2/.test($("#head").innerText) && $("#bars .best"));
           const near = rests && lab.charts.span === 40 && !$("#hint button");
           lab.send({ command: "seek", tick: 1e6 }); await frame();
           $("#speed").value = 100; $("#speed").dispatchEvent(new Event("change"));
           await until(() => lab.lab.store.end < 3000);
           return [heads, width, orders, document.querySelectorAll(".report table").length > 3, near];"##,
        &[],
    );
    browser.resize(2560, 1300).expect("a size");
    let edges = r##"const left = (selector) => $(selector).getBoundingClientRect().left; return left("main") - left(".report")"##;
    assert_eq!(script_on(&browser, edges, &[]), json!(0));
    let heads = [
        "T# reads # °C too high.",
        "T# sees # % less of the rise than it should.",
        "The air flow is # % stronger than learnt.",
    ];
    assert_eq!(told, json!([heads, true, true, true, true]));
    assert_untroubled(&browser);
    let _ = std::fs::remove_dir_all(folder);
}
