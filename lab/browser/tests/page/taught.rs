//! Faults that were taught to the likelihood diagnosis, by their names.

use pt326::commands::run::carry_out as run_experiment;
use pt326_host::experiment::scenario::read_scenario;
use pt326_host::settings::read as read_settings;
use pt326_lab_browser::Browser;
use serde_json::json;

use crate::{assert_untroubled, on_page, script_on};

/// Two faults at once, which no class explains, and the settings to which they were taught as one, with another.
const SLIPPED: &str = r#"
duration = 430.0
fault = [
    { name = "slipped", do = "offset", sensor = "t2", size = 1.44, at = 400.0, for = 20.0 },
    { name = "slipped", do = "clog", sensor = "t1", size = 0.85, lag = 0.05, at = 400.0, for = 20.0 },
]
"#;
const TAUGHT: &str = r#"
[likelihood]
taught = [
    { name = "other", effects = [0, 0, 0, 0, 0, 0, -200, 0, 0, 0, 0] },
    { name = "slipped", effects = [0, 0, 0, 0, 150, -150, 0, 0, 0, 0, 0] },
]
"#;

#[test]
fn a_report_says_which_of_the_taught_faults_it_was_and_how_large() {
    let folder = std::env::temp_dir().join(format!("pt326-taught-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let written = |name: &str, text: &str| {
        let file = folder.join(name);
        std::fs::write(&file, text).expect(name);
        file
    };
    let config = read_settings(Some(&written("taught.toml", TAUGHT))).expect("settings");
    let scenario = read_scenario(Some(&written("slipped.toml", SLIPPED))).expect("a scenario");
    run_experiment(&config, &scenario, 1, &folder).expect("the run");
    let browser = Browser::start().expect("a browser");
    browser.open(&format!("file://{}", folder.join("report.html").display())).expect("the report");
    let told = script_on(
        &browser,
        r##"await until(() => document.querySelector(".review article"));
           const told = (selector) => /(As it was taught: slipped|Como foi ensinada: slipped), \d+ % (of what was taught|do que foi ensinado)\./.exec($(selector).innerText.replaceAll("\u00a0", " "))?.[1] ?? $(selector).innerText;
           const both = async () => {
             lab.send({ command: "seek", tick: 1e6 }); await frame();
             const card = told(".review article");
             lab.send({ command: "seek", tick: lab.lab.store.tickAt(415) });
             await until(() => /slipped/.test($("#sub").innerText));
             return [card, told("#sub")];
           };
           const english = await both();
           $("#language").click(); await frame();
           return [...english, ...(await both())];"##,
        &[],
    );
    let [english, portuguese] = ["As it was taught: slipped", "Como foi ensinada: slipped"];
    assert_eq!(told, json!([english, english, portuguese, portuguese]));
    assert_untroubled(&browser);
    let _ = std::fs::remove_dir_all(folder);
}

/// Where the class has no name yet the taught fault is all that there is to say; what it is called is text, whatever stands in it.
#[test]
fn a_taught_fault_is_said_without_a_class_and_its_name_is_no_html() {
    let said = on_page(
        r##"
        const [{ HEAR }, { papers }, { verdict }, { RIBBONS, drawRibbons }] = await Promise.all(["hear", "say", "verdict", "ribbons"].map((name) => import(`lab/${name}.js`)));
        const name = "<img src=x onerror=alert(1)>";
        HEAR.names({ own_names: [[4, name]], taught_names: ["low", name] });
        const hello = { classes: [{ number: 9, name: "unknown" }] };
        const sub = (number, taught, size = 96.2) => {
          const row = { t: 400, mode: 3, alarm: 1, class: number, taught, taught_size: size };
          const shown = document.createElement("p");
          shown.innerHTML = verdict({ row, hello, events: { last: undefined }, since: 0, ts: 0.11, settings: {}, can: new Set(), checking: false, lost: 0 }).sub;
          return shown.textContent.replaceAll("\u00a0", " ") + shown.querySelectorAll("img").length;
        };
        const ribbon = (number, taught) => {
          const texts = [];
          const pen = { text: (text) => texts.push(text), box() {}, measure: () => 0 };
          const store = { get: (_, field) => ({ alarm: 1, class: number, taught })[field] };
          drawRibbons(pen, [RIBBONS[1]], { list: [], names: new Map([[9, "unknown"]]) }, store, { y: 0, left: 0, edge: 99, a: 0, b: 5, X: (k) => 15 * k, T: (t) => t, t1: 9 });
          return texts[1];
        };
        return [sub(NaN, NaN), sub(NaN, 1), sub(9, NaN), sub(9, 2), sub(9, 3, NaN), ribbon(9, NaN), ribbon(9, 1), ribbon(NaN, 1), papers(2, 4)];"##,
        &[],
    );
    let expected = [
        "Too early to say what.0",
        "As it was taught: low, 96 % of what was taught.0",
        "0",
        "As it was taught: <img src=x onerror=alert(1)>, 96 % of what was taught.0",
        "As it was taught: 3.0",
        "Unknown",
        "Unknown, low",
        "alarm, low",
        "&#60;img src=x onerror=alert(1)&#62;",
    ];
    assert_eq!(said, json!(expected));
}

/// A served page has no core to run a trace again: place and names are those of the trace.
#[test]
fn a_trace_that_is_read_without_the_core_says_what_was_taught() {
    let read = on_page(
        r##"
        const { readTrace } = await import("lab/csv.js");
        const settings = "pid.kp=3;diagnosis.isolation.3=3 x 0 -1 x 0;diagnosis.isolation.4=4 0 +1 0 -1 x hand;likelihood.taught.1=low 0 0;likelihood.taught.2=cap 0 -1";
        const text = ["t_s,t1_c,t2_c,pa_pct,mode,taught,settings", `0,20,20,40,monitor,,${settings}`, "0.11,20,20,40,monitor,2,"].join("\n");
        const fields = ["tick", "t1", "t2", "drive", "mode", "class", "onset", "readiness", "taught"];
        const columns = ["t_s", "t1_c", "t2_c", null, "mode", "verdict", "onset_s", null, "taught"];
        const told = { fields, columns, modes: ["monitor"], readiness: ["armed"], classes: [], ts: 0.11 };
        const { hello, values } = readTrace(text, told);
        const bare = readTrace(text.replaceAll(/,[^,]*$/gm, ""), told).hello;
        return [hello.own_names, hello.taught_names, ...[8, 17].map((i) => String(values[i])), bare.own_names, bare.taught_names];"##,
        &[],
    );
    assert_eq!(read, json!([[[4, "hand"]], ["low", "cap"], "NaN", "2", [], []]));
}
