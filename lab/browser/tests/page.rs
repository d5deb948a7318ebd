//! lab.html, as a user has it, in Chromium. `LAB_PAGE` names the file, which `cargo lab` writes; without it, lab.html of the workspace.

use std::path::{Path, PathBuf};

use host_sim::commands::replay::{ReplayArgs, run as replay};
use host_sim::commands::run::carry_out as run_experiment;
use host_sim::experiment::scenario::read_scenario;
use host_sim::settings::read as read_settings;
use pt326_lab::scene::Scene;
use pt326_lab::session::Session;
use pt326_lab_browser::Browser;
use serde_json::{Value, json};

/// What scripts use: a session that stands still where monitoring begins, and the user's hand.
const HELPERS: &str = r##"
const $ = (selector) => document.querySelector(selector);
const frame = () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
const until = async (what) => { while (!what()) await frame(); };
const click = (selector) => $(selector).dispatchEvent(new MouseEvent("click", { bubbles: true }));
const step = async (ticks) => { await lab.ask({ command: "step", ticks }); await frame(); };
const SCENE = { seed: 1, preset: "paper", disturbance: "calm", orders: [[0, { order: "arm" }]] };
const monitoring = async () => {
  await until(() => lab.lab.store?.end > 0);
  lab.send({ command: "run", speed: 0 });
  lab.send({ command: "open", scene: SCENE, skip: true });
  await step(1);
};
const said = async () => { const before = $("#clock").textContent; await step(3); await until(() => $("#clock").textContent !== before); return $("#head").innerText; };
"##;

fn page() -> PathBuf {
    let default = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../lab.html");
    let page = std::env::var_os("LAB_PAGE").map_or(default, PathBuf::from);
    page.canonicalize()
        .unwrap_or_else(|error| panic!("{}: {error}; write it with `cargo lab`", page.display()))
}

fn address() -> String {
    format!("file://{}", page().display())
}

/// Opens the page, runs a script on it, and sees that the console stays empty and that no request leaves the page.
fn on_page(script: &str, arguments: &[Value]) -> Value {
    let browser = Browser::start().expect("a browser");
    browser.open(&address()).expect("lab.html");
    let value = script_on(&browser, script, arguments);
    assert_untroubled(&browser);
    value
}

fn script_on(browser: &Browser, script: &str, arguments: &[Value]) -> Value {
    browser.run(&format!("{HELPERS}{script}"), arguments).unwrap_or_else(|error| panic!("{error:#}"))
}

fn assert_untroubled(browser: &Browser) {
    assert_eq!(browser.complaints().expect("the console"), Vec::<String>::new());
    let asked = "return performance.getEntriesByType('resource').map((e) => e.name).filter((n) => !/^(data|blob):/.test(n))";
    assert_eq!(browser.run(asked, &[]).expect("entries"), json!([]));
}

#[test]
fn it_opens_from_a_file_trained_and_at_the_point_of_monitoring() {
    assert!(std::fs::metadata(page()).expect("the page").len() < 1_500_000);
    let said = on_page(
        "await monitoring(); return [await said(), lab.row().mode, lab.row().readiness, document.title]",
        &[],
    );
    assert_eq!(said, json!(["All is as learnt.", 3, 3, "PT-326 lab"]));
}

/// Each fault by its part's button: chosen, broken, named.
#[test]
fn each_fault_that_can_be_put_in_is_named_by_its_own_name() {
    let found = on_page(
        r##"
        const found = [];
        await monitoring();
        for (const part of ["T0", "T1", "T2", "fan", "heater", "mains", "door"]) {
          click(`[data-part=${part}]`);
          const kinds = [...document.querySelectorAll("#sheet [name=kind]")].map((input) => input.value);
          click("#sheet .x");
          for (const kind of kinds) {
            await monitoring();
            click(`[data-part=${part}]`);
            const radio = $(`#sheet [value=${kind}]`);
            radio.checked = true;
            radio.dispatchEvent(new Event("input", { bubbles: true }));
            $("#sheet .primary").click();
            await step(kind === "drifts" ? 220 : 90);
            found.push([part, kind, lab.events().last?.named ?? "", await said()]);
          }
        }
        return found;"##,
        &[],
    );
    let expected = [
        ("T0", "wrong", "t0_fault", "T0 reads"),
        ("T0", "drifts", "", ""),
        ("T0", "open", "t0_open", "Wire of T0 broken."),
        ("T1", "wrong", "t1_offset", "T1 reads"),
        ("T1", "clogged", "t1_clogged", "of the rise too little."),
        ("T1", "drifts", "drift", "drifts up"),
        ("T1", "sticks", "t1_stuck", "T1 did not move"),
        ("T1", "falls", "t1_detached", "T2 is far hotter than T1."),
        ("T1", "open", "t1_open", "broken wire"),
        ("T1", "short", "t1_short", "short circuit"),
        ("T1", "swap", "t1_t2_swapped", "T1 and T2 swapped?"),
        ("T2", "wrong", "t2_offset", "T2 reads"),
        ("T2", "drifts", "drift", "drifts up"),
        ("T2", "sticks", "t2_stuck", "T2 stands still."),
        ("T2", "falls", "t2_detached", "Is T2 out of the tube?"),
        ("T2", "open", "t2_open", "Wire of T2 broken."),
        ("T2", "short", "t2_short", ""),
        ("fan", "more", "air_flow", "stronger than learnt."),
        ("heater", "weak", "heater_power", "less power than asked for."),
        ("heater", "stuck", "air_flow_or_heater_power", ""),
        ("mains", "sags", "heater_power", "less power than asked for."),
        ("door", "opens", "", "All is as learnt."),
    ];
    let found: Vec<(String, String, String, String)> = serde_json::from_value(found).expect("texts");
    assert_eq!(found.len(), expected.len());
    for ((part, kind, named, head), (p, k, name, words)) in found.iter().zip(expected) {
        assert_eq!((part.as_str(), kind.as_str()), (p, k));
        assert!(named == name && head.contains(words), "{part} {kind}: \"{named}\", \"{head}\"");
    }
}

#[test]
fn the_quiz_hides_the_name_until_it_is_answered_and_keeps_the_score() {
    let [hidden, told] = serde_json::from_value::<[Value; 2]>(on_page(
        r##"
        await monitoring();
        click("[data-mode=quiz]");
        await until(() => $("[data-act=quiz-start]"));
        const before = { ...lab.quiz.score };
        click("[data-act=quiz-start]");
        lab.send({ command: "run", speed: 0 });
        while (lab.quiz.phase !== "ask") await step(5);
        await step(60);
        await until(() => $(".answers"));
        click("[data-part=T1]");
        const hidden = [$("#head").innerText, $("#why").hidden, $("#events").innerText, !!$(".part.blamed"), $("#hint").innerText, document.body.innerText.includes(lab.quiz.event.label()), $("#sheet").hidden, lab.quiz.score.it - before.it];
        click(`[data-name=${lab.quiz.right}]`);
        await until(() => !$(".answers"));
        return [hidden, [$("#head").innerText.slice(0, 6), lab.quiz.score.you - before.you, lab.quiz.score.it - before.it, $("#why").hidden]];"##,
        &[],
    ))
    .expect("two lists");
    let head = hidden[0].as_str().expect("text");
    assert!(head.starts_with("Something broke"), "{head}");
    assert_eq!(
        hidden.as_array().map(|all| &all[1..]),
        json!([true, "\tNothing has happened yet.", false, "", false, true, 1])
            .as_array()
            .map(|all| &all[..])
    );
    assert_eq!(told, json!(["Right:", 1, 1, false]));
}

#[test]
fn the_heater_is_stopped_and_armed_by_one_button_and_a_trip_is_acknowledged() {
    let said = on_page(
        r##"
        await monitoring();
        const all = [];
        const note = async () => all.push([await said(), lab.row().drive > 0]);
        click("#stop"); await note();
        click("#stop"); await note();
        click("#stop"); await step(1);
        lab.send({ command: "order", order: { order: "tune" } }); await step(20); await note();
        click("#stop"); await step(1);
        click("#stop"); await step(1);
        lab.send({ command: "skip" }); await step(1); await note();
        lab.send({ command: "order", order: { order: "break", fault: { do: "open", sensor: "t1", at: 0, for: 2 } } });
        await step(20); await note();
        await step(20);
        click("[data-act=ack]"); await note();
        return all;"##,
        &[],
    );
    let expected = json!([
        ["The heater is off.", false],
        ["Warming up to 35.0 °C.", true],
        ["Measuring how the rig answers.", false],
        ["All is as learnt.", true],
        ["T1 reads as a broken wire.", false],
        ["The heater is off.", false]
    ]);
    assert_eq!(said.to_string().replace('\u{a0}', " "), expected.to_string());
}

#[test]
fn charts_zoom_move_and_follow_again_by_wheel_and_keys() {
    let spans = on_page(
        r##"
        await monitoring();
        const key = (key) => $("#stack").dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
        const all = [[lab.charts.span, lab.charts.following]];
        $("#stack").dispatchEvent(new WheelEvent("wheel", { deltaY: 400, bubbles: true, cancelable: true }));
        all.push([lab.charts.span > 50, lab.charts.following]);
        key("ArrowLeft"); all.push([lab.charts.following, !$("#follow").hidden || (await frame(), !$("#follow").hidden)]);
        key("Home"); all.push([lab.charts.following]);
        key("+"); all.push([lab.charts.span < 60]);
        const box = $("#series [value=t0]");
        box.checked = true; box.dispatchEvent(new Event("change", { bubbles: true }));
        all.push([lab.charts.off.has("t0")]);
        return all;"##,
        &[],
    );
    assert_eq!(spans, json!([[40, true], [true, true], [false, true], [true], [true], [false]]));
}

/// Until the cause is mended that is what to press first; what is refused is said in the page's language.
#[test]
fn a_trip_shows_its_part_and_the_way_on() {
    let seen = on_page(
        r##"
        await monitoring();
        click("#language");
        lab.send({ command: "order", order: { order: "break", fault: { do: "open", sensor: "t1", at: 0, for: 100 } } });
        await said(); await step(20); await said();
        const all = [[$("#stop").hidden, $("#more .primary").dataset.act, $(".part.blamed").dataset.part]];
        click("[data-act=ack]"); await until(() => $("#toast").textContent);
        all.push($("#toast").textContent);
        click("[data-act=mend]"); await step(20); await said();
        all.push($("#more .primary").dataset.act);
        click("[data-act=ack]"); await said();
        all.push(!$("#stop").hidden && lab.row().mode);
        return all;"##,
        &[],
    );
    let refused = "Persiste: T1 lê como fio partido.";
    assert_eq!(seen, json!([[true, "mend", "T1"], refused, "ack", 0]));
}

/// What is refused is said in the page's language, and what was typed gives way to what is in force.
#[test]
fn a_refusal_is_said_in_the_pages_language() {
    let said = on_page(
        r##"
        await monitoring();
        click("#language");
        const all = [];
        const refused = async (order) => {
          $("#toast").textContent = "";
          lab.send({ command: "order", order });
          await until(() => $("#toast").textContent);
          all.push($("#toast").textContent.replaceAll("\u00a0", " "));
        };
        await refused({ order: "setpoint", celsius: 500 });
        await refused({ order: "arm" });
        await refused({ order: "set", name: "supervisor.over_temperature", value: 90 });
        const kp = $("[data-set='pid.kp']");
        kp.value = 1e6; $("#toast").textContent = "";
        kp.dispatchEvent(new Event("change", { bubbles: true }));
        await until(() => $("#toast").textContent);
        all.push(/^Recusado: pid.kp é 1000000; são possíveis/.test($("#toast").textContent), kp.value);
        return all;"##,
        &[],
    );
    let expected = json!([
        "Recusado: referência de 500 °C; são possíveis 20 a 65 °C.",
        "Recusado: não é possível agora (a vigiar).",
        "Recusado: supervisor.over_temperature só pode ser alargado com o aquecedor desligado.",
        true,
        "2.4"
    ]);
    assert_eq!(said, expected);
}

/// Air and power look alike at first: both are shown, and when they were told apart.
#[test]
fn two_that_look_alike_are_shown_together_and_then_told_apart() {
    let seen = on_page(
        r##"
        await monitoring(); await step(100);
        lab.send({ command: "order", order: { order: "break", fault: { do: "air-flow", size: 1.26, at: 0, for: 20 } } });
        while (lab.events().last?.named !== "air_flow_or_heater_power") await step(1);
        await said();
        const marked = () => [[...document.querySelectorAll(".part.blamed")].map((p) => p.dataset.part), document.querySelectorAll(".bars .best").length];
        const all = [marked()];
        while (lab.events().last.named !== "air_flow") await step(1);
        await said();
        all.push(marked(), /Told apart after [2-9]/.test($("#sub").innerText), /Air or power 0\.\d+ s\s+\d/.test($("#events").innerText.replaceAll("\u00a0", " ")));
        click("[data-act=mend]"); await step(5);
        all.push(await said());
        return all;"##,
        &[],
    );
    assert_eq!(seen, json!([[["fan", "heater"], 2], [["fan"], 1], true, true, "What was wrong is ending."]));
}

/// The paper's fiv flickers while its models adapt: only what stands is a name, dated to its start.
#[test]
fn a_flicker_of_the_papers_scheme_is_no_name() {
    let isolated = on_page(
        r##"
        const { Events } = await import("lab/events.js");
        const events = new Events({ ts: 0.11, classes: [] });
        const fiv = [0, 3, 3, 0, 3, 3, 3, 3, 3];
        return fiv.map((number, k) => (events.row(k / 2, 3, 1, NaN, 2, number, NaN, NaN), events.last.isolated ?? null));"##,
        &[],
    );
    assert_eq!(isolated, json!([null, null, null, null, null, null, null, null, 2]));
}

/// A new session begins as every session does, whatever the last one was set to.
#[test]
fn a_new_seed_resets_the_desk_and_draws_no_residual_before_its_time() {
    let seen = on_page(
        r##"
        await monitoring();
        lab.send({ command: "order", order: { order: "excite", on: false } });
        lab.send({ command: "order", order: { order: "set", name: "pid.kp", value: 2 } });
        await step(1);
        const desk = () => [$("#excite").checked, $("[data-set='pid.kp']").value];
        const before = desk();
        $("#seed").value = 2;
        $("#seed").dispatchEvent(new Event("change", { bubbles: true }));
        lab.send({ command: "run", speed: 0 });
        await step(1);
        const { store } = lab.lab;
        const first = (what) => { for (let k = store.first; k < store.end; k++) if (what(k)) return k * store.ts; };
        const swings = first((k) => Number.isFinite(store.get(k, "t1_left"))) - first((k) => store.get(k, "readiness") === 3);
        return [before, desk(), swings > 1.9 && swings < 3, first((k) => Number.isFinite(store.get(k, "t1_expected") - store.get(k, "t1_left"))) > 0];"##,
        &[],
    );
    assert_eq!(seen, json!([[false, "2"], [true, "2.4"], true, true]));
}

/// What is downloaded is replayed to the same bits, and can be opened again.
#[test]
fn a_trace_is_downloaded_replayed_and_opened() {
    let browser = Browser::start().expect("a browser");
    browser.open(&address()).expect("lab.html");
    let text = script_on(
        &browser,
        r##"
        await until(() => lab.lab.store?.end > 0);
        lab.send({ command: "run", speed: 0 });
        lab.send({ command: "open", scene: { ...SCENE, seed: 5 }, skip: true });
        const order = (order) => lab.send({ command: "order", order });
        order({ order: "break", fault: { do: "offset", sensor: "t2", size: 1.5, at: 0, for: 10 } }); await step(150);
        order({ order: "setpoint", celsius: 37 }); await step(100);
        const kp = $("[data-set='pid.kp']");
        kp.value = 2; kp.dispatchEvent(new Event("change", { bubbles: true })); await step(30);
        order({ order: "excite", on: false }); await step(50);
        order({ order: "excite", on: true }); await step(50);
        order({ order: "stop" }); await step(50);
        order({ order: "arm" }); await step(100);
        order({ order: "break", fault: { do: "open", sensor: "t1", at: 0, for: 2 } }); await step(50);
        order({ order: "acknowledge" }); await step(10);
        order({ order: "arm" }); await step(100);
        const { parts } = await lab.ask({ command: "trace" });
        let saved = null;
        HTMLAnchorElement.prototype.click = function () { saved = this; };
        click("#download");
        await until(() => saved);
        const blob = await (await fetch(saved.href)).text();
        return [parts.join(""), blob === parts.join("") && saved.download === "trace.csv"];"##,
        &[],
    );
    assert_eq!(text[1], json!(true));
    let folder = std::env::temp_dir().join(format!("pt326-lab-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let file = folder.join("trace.csv");
    std::fs::write(&file, text[0].as_str().expect("text")).expect("the trace");
    let args = ReplayArgs { file: file.clone(), config: None, seed: None, out: folder.join("replayed") };
    replay(&args).expect("the same bits");
    browser.choose("#file", &file).expect("the input");
    let shown = script_on(
        &browser,
        r##"await until(() => lab.lab.hello.kind === "recording" && lab.lab.store?.end > 3000); await frame();
           lab.send({ command: "seek", tick: lab.lab.store.tickAt(lab.events().list[0].from) + 60 }); await frame(); await frame();
           await until(() => /T2/.test($("#head").innerText));
           const shares = Number($("#bars .best output").textContent.replace("%", ""));
           const known = ["t1_expected", "rap", "x_t2_offset"].every((name) => Number.isFinite(lab.row()[name]));
           return [$("#head").innerText, $("#stop").hidden, $("#seek").hidden, $("#source").textContent.trim(), known && shares > 50, $("#toast").textContent]"##,
        &[],
    );
    let head = shown[0].as_str().expect("text");
    assert!(head.starts_with("T2 reads 1."), "{head}");
    // One that the code does not come to again is shown as it was recorded, and the page says so.
    let other = folder.join("other.csv");
    let changed = text[0].as_str().expect("text").replacen(",settle,", ",learn,", 1);
    std::fs::write(&other, changed).expect("a trace");
    browser.choose("#file", &other).expect("the input");
    let shown_as_recorded = script_on(
        &browser,
        r##"await until(() => lab.lab.hello.name === "other.csv" && lab.lab.store?.end > 3000);
           return [$("#toast").textContent.slice(0, 17), Number.isFinite(lab.row().t1), Number.isFinite(lab.row().t1_expected)]"##,
        &[],
    );
    assert_eq!(shown_as_recorded, json!(["Shown as recorded", true, false]));
    assert_eq!(
        [&shown[1], &shown[2], &shown[3], &shown[4]],
        [&json!(true), &json!(false), &json!("Recording: trace.csv"), &json!(true)]
    );
    let _ = std::fs::remove_dir_all(folder);
}

/// Each preset brings its settings: it monitors, names a fault, and its trace replays to the same bits without being told anything.
#[test]
fn every_preset_monitors_names_and_replays() {
    let found = on_page(
        r##"
        await until(() => lab.lab.store?.end > 0);
        lab.send({ command: "run", speed: 0 });
        const found = [];
        for (const { value: preset } of [...$("#preset").options]) {
          $("#preset").value = preset;
          $("#preset").dispatchEvent(new Event("change", { bubbles: true }));
          lab.send({ command: "run", speed: 0 });
          await step(1);
          const { mode, t } = lab.row();
          await until(() => $("[data-act=quick-t2]")); // degrees that suit its heat, for as many ticks
          click("[data-act=quick-t2]"); await step(30);
          const named = lab.events().last?.named ?? "";
          await step(300);
          const { parts } = await lab.ask({ command: "trace" });
          found.push([preset, mode, Math.round(t / lab.lab.store.ts) > 3000, named, parts.join("")]);
        }
        return found;"##,
        &[],
    );
    let found: Vec<(String, u8, bool, String, String)> = serde_json::from_value(found).expect("presets");
    let folder = std::env::temp_dir().join(format!("pt326-presets-{}", std::process::id()));
    for (preset, mode, after_learning, named, trace) in &found {
        assert_eq!((*mode, *after_learning, named.as_str()), (3, true, "t2_offset"), "{preset}");
        std::fs::create_dir_all(&folder).expect("a folder");
        let file = folder.join("trace.csv");
        std::fs::write(&file, trace).expect("the trace");
        let args = ReplayArgs { file, config: None, seed: None, out: folder.join("replayed") };
        replay(&args).unwrap_or_else(|error| panic!("{preset}: {error:#}"));
    }
    assert_eq!(found.len(), 7);
    let _ = std::fs::remove_dir_all(folder);
}

/// The paper's run (natively that of the golden record), and 30,000 ticks of a rig with everything that is random, bit for bit as here.
#[test]
fn the_browser_comes_to_the_bits_of_this_machine() {
    let paper = include_str!("../../tests/paper.json");
    let harsh = Scene { seed: 3, preset: "harsh".into(), ..Scene::default() };
    let scenes =
        [(pt326_lab::protocol::read(paper.as_bytes()).expect("the paper's scene"), 7727), (harsh, 30_000)];
    let arguments = scenes.clone().map(|(scene, ticks)| json!([scene, ticks]));
    let theirs = on_page(
        r##"await monitoring();
           const all = [];
           for (const [scene, ticks] of args) {
             lab.send({ command: "open", scene, at: ticks });
             all.push((await lab.ask({ command: "digest" })).digest);
           }
           return all;"##,
        &arguments,
    );
    let ours = scenes.map(|(scene, ticks)| {
        let mut session = Session::new(scene).expect("a scene");
        (0..ticks).for_each(|_| drop(session.step()));
        session.digest().expect("a digest")
    });
    assert_eq!(theirs, json!(ours));
}

/// A link holds the whole scene: who opens it comes to the same bits.
#[test]
fn a_link_leads_to_the_same_scene() {
    let browser = Browser::start().expect("a browser");
    browser.open(&address()).expect("lab.html");
    let link = script_on(
        &browser,
        r##"await monitoring();
           lab.send({ command: "order", order: { order: "break", fault: { do: "air-flow", size: 1.26, at: 0, for: 25 } } });
           await step(60);
           click("#link");
           await until(() => location.hash.length > 10);
           return [location.href, lab.lab.store.end, (await lab.ask({ command: "digest" })).digest];"##,
        &[],
    );
    browser.open("about:blank").expect("a blank page");
    browser.open(link[0].as_str().expect("a link")).expect("the link");
    let again = script_on(
        &browser,
        r##"lab.send({ command: "run", speed: 0 });
           await until(() => lab.lab.store?.end > 0);
           await frame();
           const more = lab.lab.store.end - args[1];
           const { scene } = await lab.ask({ command: "scene" });
           lab.send({ command: "open", scene, at: args[1] });
           return [more < 200, (await lab.ask({ command: "digest" })).digest, lab.events().last.label()];"##,
        &[Value::Null, link[1].clone()],
    );
    assert_eq!(again, json!([true, link[2], "Fan: more air, +26\u{a0}%"]));
    browser.open(&format!("{}#s=broken", address())).expect("the page");
    let toast = script_on(
        &browser,
        r##"await until(() => $("#toast").textContent); await monitoring(); return $("#toast").textContent"##,
        &[],
    );
    assert!(toast.as_str().is_some_and(|text| text.contains("no scene")), "{toast}");
}

/// A name that comes with a scene is text, whatever stands in it.
#[test]
fn a_name_from_a_link_is_no_html() {
    let found = on_page(
        r##"await monitoring();
           const fault = { do: "spike", sensor: "t2", size: 3, at: 0, for: 9, name: "<img src=x onerror=alert(1)>" };
           const scene = { ...SCENE, orders: [...SCENE.orders, [3310, { order: "break", fault }]] };
           lab.send({ command: "open", scene, at: 3330 });
           await until(() => /spike|img/.test($("#hint").textContent) && $("#events button"));
           return [document.querySelectorAll("main img").length, $("#hint span").textContent.startsWith("img src=x onerror=alert(1)")];"##,
        &[],
    );
    assert_eq!(found, json!([0, true]));
}

/// In both languages: nothing is wider than the screen, everything that can be pressed has a name, no word is missing.
#[test]
fn it_fits_400_px_and_every_control_has_a_name() {
    let browser = Browser::start().expect("a browser");
    browser.open(&address()).expect("lab.html");
    for width in [400, 768, 1000, 1400, 2560] {
        browser.resize(width, 900).expect("a size");
        let found = script_on(
            &browser,
            r##"await monitoring();
               lab.send({ command: "order", order: { order: "break", fault: { do: "clog", sensor: "t1", size: 0.85, lag: 0.4, at: 0, for: 60 } } });
               await step(60);
               const wide = [];
               for (const mode of ["explore", "quiz", "tour"]) {
                 for (let language = 0; language < 2; language++) {
                   click("#language"); click(`[data-mode=${mode}]`); click("[data-part=T1]"); await said();
                   if (document.documentElement.scrollWidth > innerWidth) wide.push(mode);
                   const rows = new Set([...$(".bar").children].filter((n) => n.offsetWidth).map((n) => Math.round((n.offsetTop + n.offsetHeight / 2) / 20)));
                   const edge = $(".bar").getBoundingClientRect().right - parseFloat(getComputedStyle($(".bar")).paddingRight);
                   if ($("#stop").getBoundingClientRect().right > edge + 0.5) wide.push("bar");
                   if (rows.size > 2) wide.push(`bar in ${rows.size} rows`);
                   click("#sheet .x");
                 }
               }
               const name = (n) => n.getAttribute("aria-label") || n.textContent.trim() || n.closest("label")?.textContent.trim();
               const nameless = [...document.querySelectorAll("button, input, select, [role=button], canvas, summary")].filter((n) => !name(n)).map((n) => n.outerHTML);
               const { languages } = await import("lab/strings.js");
               const lacking = Object.entries(languages()).filter(([, both]) => both.length !== 2 || both.some((text) => !text)).map(([key]) => key);
               const raw = document.body.innerText.match(/\b[a-z]+_[a-z0-9_]+\b|\{\w+\}/g);
               return [wide, nameless, lacking, raw];"##,
            &[],
        );
        assert_eq!(found, json!([[], [], [], null]), "at {width} px");
    }
    assert_untroubled(&browser);
}

/// WCAG's contrast of at least 4.5 of every ink on every ground.
#[test]
fn inks_can_be_read_on_their_grounds_light_and_dark() {
    let low = on_page(
        r##"await monitoring();
           const light = (hex) => { const [r, g, b] = [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255).map((v) => v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4); return 0.2126 * r + 0.7152 * g + 0.0722 * b; };
           const low = [];
           for (const theme of ["light", "dark"]) {
             document.documentElement.dataset.theme = theme;
             const css = getComputedStyle(document.documentElement);
             const value = (name) => css.getPropertyValue("--" + name).trim();
             for (const ink of ["ink", "soft", "faint", "t0", "t1", "t2", "flow", "power", "alarm", "ok"]) for (const ground of ["bg", "card"]) {
               const [a, b] = [light(value(ink)), light(value(ground))].sort((x, y) => y - x);
               const ratio = (a + 0.05) / (b + 0.05);
               if (ratio < 4.5) low.push(`${theme} ${ink} on ${ground}: ${ratio.toFixed(2)}`);
             }
           }
           return low;"##,
        &[],
    );
    assert_eq!(low, json!([]));
}

/// However long it runs, memory is bounded, and no tick is dropped.
#[test]
fn no_tick_is_dropped_and_old_ones_give_way() {
    let kept = on_page(
        r##"await monitoring();
           const { store } = lab.lab;
           const bytes = store.ring.length;
           await step(70000);
           let whole = true;
           for (let tick = store.first; tick < store.end; tick++) whole &&= store.get(tick, "tick") === tick;
           lab.charts.show(Infinity, 7200); await frame();
           return [whole, store.end - store.first <= 65536, store.end - store.first > 65000, store.ring.length === bytes];"##,
        &[],
    );
    assert_eq!(kept, json!([true, true, true, true]));
}

/// What stands still is not drawn again, nor what cannot be seen; and at 100x, with an hour in view, every tick is there.
#[test]
fn only_what_has_changed_is_drawn_and_no_tick_is_dropped_at_full_speed() {
    let seen = on_page(
        r##"await monitoring(); await step(32700);
           const { charts } = lab;
           const { store } = lab.lab;
           let drawn = 0;
           const stack = charts.drawStack;
           charts.drawStack = function (...all) { drawn++; return stack.apply(this, all); };
           const frames = async (count) => { drawn = 0; for (let i = 0; i < count; i++) await frame(); return drawn; };
           $("#stack").scrollIntoView(); charts.show(Infinity, 3600); await frames(5);
           const still = await frames(30);
           lab.send({ command: "run", speed: 100 });
           const first = store.end;
           await until(() => store.end > first + 2000);
           const moving = drawn;
           lab.send({ command: "run", speed: 0 });
           let whole = true;
           for (let tick = first; tick < store.end; tick++) whole &&= store.get(tick, "tick") === tick;
           $(".charts").style.display = "none"; await frames(5);
           await step(100);
           return [still, moving > 10, whole, await frames(20)];"##,
        &[],
    );
    assert_eq!(seen, json!([0, true, true, 0]));
}

/// A stop goes out before anything has been heard of the rig.
#[test]
fn stop_waits_for_nothing() {
    let mode = on_page(
        r##"await monitoring();
           const { store } = lab.lab;
           lab.lab.store = null;
           document.body.dispatchEvent(new KeyboardEvent("keydown", { key: "!", bubbles: true }));
           lab.lab.store = store;
           await step(2);
           return lab.row().mode;"##,
        &[],
    );
    assert_eq!(mode, json!(0));
}

/// Every step of the tour has its words in both languages, looks at something, and its button does something.
#[test]
fn the_tour_goes_to_its_end() {
    let steps = on_page(
        r##"await monitoring();
           click("[data-mode=tour]");
           const steps = [];
           for (;;) {
             const does = $("[data-do]");
             const before = lab.events().orders.length + lab.quiz.phase;
             if (does) { does.click(); await step(120); }
             const done = !does || lab.events().orders.length + lab.quiz.phase !== before || lab.events().list.length > 0;
             const english = $("#tour .text").textContent;
             const words = $("#tour h2").textContent.length > 5 && $("#tour .text").textContent.length > 100;
             click("#language");
             const other = lab.lab.mode !== "tour" || $("#tour .text").textContent.length > 100 && $("#tour .text").textContent !== english;
             click("#language");
             const looked = document.querySelector(".looked");
             await until(() => !looked || looked.getBoundingClientRect().top < innerHeight / 2);
             steps.push([!!looked || lab.lab.mode !== "tour", done, words, other]);
             if (lab.lab.mode !== "tour" || $("[data-step='1']").disabled) return steps;
             click("[data-step='1']");
           }"##,
        &[],
    );
    let steps: Vec<Vec<bool>> = serde_json::from_value(steps).expect("steps");
    assert!(steps.len() > 10 && steps.iter().flatten().all(|good| *good), "{steps:?}");
}

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
           click("[data-speed='100']");
           await until(() => lab.lab.store.end < 3000);
           return [heads, width, orders, document.querySelectorAll(".report table").length > 3, near];"##,
        &[],
    );
    browser.resize(2560, 1300).expect("a size");
    let edges = r##"const left = (selector) => $(selector).getBoundingClientRect().left; return left("main") - left(".report")"##;
    assert_eq!(script_on(&browser, edges, &[]), json!(0));
    let heads = [
        "T# reads # °C too high.",
        "T# sees # % of the rise too little.",
        "The air flow is # % stronger than learnt.",
    ];
    assert_eq!(told, json!([heads, true, true, true, true]));
    assert_untroubled(&browser);
    let _ = std::fs::remove_dir_all(folder);
}

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
           const told = (selector) => /(As it was taught: slipped|Como foi ensinada: slipped), \d+ % (of it|dela)\./.exec($(selector).innerText.replaceAll("\u00a0", " "))?.[1] ?? $(selector).innerText;
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
        const [{ HEAR }, { papers }, { verdict }, { drawRibbons }] = await Promise.all(["hear", "say", "verdict", "ribbons"].map((name) => import(`lab/${name}.js`)));
        const name = "<img src=x onerror=alert(1)>";
        HEAR.names({ own_names: [[4, name]], taught_names: ["low", name] });
        const hello = { classes: [{ number: 9, name: "unknown" }] };
        const sub = (number, taught, size = 96.2) => {
          const row = { t: 400, mode: 3, alarm: 1, class: number, taught, taught_size: size };
          const shown = document.createElement("p");
          shown.innerHTML = verdict({ row, hello, events: { last: undefined, slow: 1 }, since: 0, ts: 0.11, settings: {}, can: new Set(), checking: false, lost: 0 }).sub;
          return shown.textContent.replaceAll("\u00a0", " ") + shown.querySelectorAll("img").length;
        };
        const ribbon = (number, taught) => {
          const texts = [];
          const pen = { text: (text) => texts.push(text), box() {}, measure: () => 0 };
          const store = { get: (_, field) => ({ alarm: 1, class: number, taught })[field] };
          drawRibbons(pen, { list: [], names: new Map([[9, "unknown"]]) }, store, { y: 0, left: 0, edge: 99, a: 0, b: 5, X: (k) => 15 * k, T: (t) => t, t1: 9 });
          return texts[2];
        };
        return [sub(NaN, NaN), sub(NaN, 1), sub(9, NaN), sub(9, 2), sub(9, 3, NaN), ribbon(9, NaN), ribbon(9, 1), ribbon(NaN, 1), papers(2, 4)];"##,
        &[],
    );
    let expected = [
        "Too early to say what.0",
        "As it was taught: low, 96 % of it.0",
        "0",
        "As it was taught: <img src=x onerror=alert(1)>, 96 % of it.0",
        "As it was taught: 3.0",
        "Unknown",
        "Unknown, low",
        "alarm, low",
        "&#60;img src=x onerror=alert(1)&#62;",
    ];
    assert_eq!(said, json!(expected));
}
