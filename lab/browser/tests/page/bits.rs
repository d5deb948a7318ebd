//! The page comes to the bits of this machine, and its traces are replayed to the same.

use pt326::commands::replay::{ReplayArgs, run as replay};
use pt326_lab::scene::Scene;
use pt326_lab::session::Session;
use pt326_lab_browser::Browser;
use serde_json::json;

use crate::{address, on_page, script_on};

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
           return [$("#toast").textContent.slice(0, 36), Number.isFinite(lab.row().t1), Number.isFinite(lab.row().t1_expected)]"##,
        &[],
    );
    assert_eq!(shown_as_recorded, json!(["Opened: other.csv. Shown as recorded", true, false]));
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
    let paper = include_str!("../../../tests/paper.json");
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
