//! What is seen, as a picture; what was recorded, as a file; two runs in one chart.

use serde_json::json;

use crate::on_page;

/// What the page saves, by the names of the files, in place of a download.
const SAVED: &str = r##"
const files = {};
HTMLAnchorElement.prototype.click = function () { files[this.download] = fetch(this.href).then((answer) => answer.blob()); };
const saved = async (selector, name) => { click(selector); await until(() => files[name]); return files[name]; };
await monitoring();
lab.send({ command: "order", order: { order: "break", fault: { do: "offset", sensor: "t2", size: 1.5, at: 0, for: 30 } } }); await step(240); await said();
"##;

#[test]
fn the_charts_are_saved_as_a_picture_and_the_run_as_data() {
    let script = r##"
        const stack = $("#stack").getBoundingClientRect();
        const png = await createImageBitmap(await saved("#save-png", "charts.png"));
        const canvas = new OffscreenCanvas(png.width, png.height), c = canvas.getContext("2d"); c.drawImage(png, 0, 0);
        const colours = new Set(new Uint32Array(c.getImageData(0, 0, png.width, png.height).data.buffer));
        const lines = (await (await saved("#download", "trace.csv")).text()).trim().split("\n");
        return [png.width === 2 * stack.width, png.height === 2 * stack.height, colours.size > 50, [...colours].every((rgba) => rgba >>> 24 === 255), lines.length - 1 === lab.lab.store.end, lines[0].startsWith("t_s,")];"##;
    let seen = on_page(&format!("{SAVED}{script}"), &[]);
    assert_eq!(seen, json!([true, true, true, true, true, true]));
}

/// One run with other gains, all else the same, beside the first; then no more.
#[test]
fn a_run_with_other_gains_is_drawn_beside_the_one_before() {
    let script = r##"
        const { store, settings } = lab.lab;
        const first = Array.from({ length: store.end }, (_, tick) => store.get(tick, "t1"));
        const kp = $("[data-set='pid.kp']"); kp.value = 1; kp.dispatchEvent(new Event("change", { bubbles: true })); await step(1);
        const end = store.end;
        click("#again"); await until(() => lab.charts.kept && store.end >= end); lab.send({ command: "run", speed: 0 }); await step(1); await said();
        const t1 = lab.charts.panels[0].series.find((series) => series.id === "t1");
        const same = first.every((value, tick) => t1.kept.value(tick) === value);
        const differs = first.filter((value, tick) => store.get(tick, "t1") !== value).length > 1000;
        const { scene } = await lab.ask({ command: "scene" });
        const drawn = async () => { const seen = []; const { fillText } = CanvasRenderingContext2D.prototype;
          CanvasRenderingContext2D.prototype.fillText = function (text, ...place) { seen.push(text); fillText.call(this, text, ...place); };
          $("#stack").scrollIntoView({ behavior: "instant" }); await until(() => !lab.charts.unseen.has($("#stack"))); lab.charts.changed(); await frame(); CanvasRenderingContext2D.prototype.fillText = fillText; return seen.some((text) => text.includes("the run that was kept")); };
        const with_it = await drawn();
        lab.charts.show(Infinity, 7200); await frame(); lab.charts.moment();
        const blocks = t1.kept.low(20) <= first[325] && t1.kept.high(20) >= first[325];
        click("#compare"); await frame();
        return [same, differs, blocks, with_it, await drawn(), lab.lab.settings["pid.kp"], scene.orders.map(([, { order }]) => order), lab.events().list.length, t1.kept];"##;
    let seen = on_page(&format!("{SAVED}{script}"), &[]);
    let orders = ["set", "set", "set", "arm", "break"];
    assert_eq!(seen, json!([true, true, true, true, false, 1, orders, 1, null]));
}

/// The same scene anew, without the excitation, beside the run with it.
#[test]
fn a_run_without_excitation_is_drawn_beside_the_one_with_it() {
    let script = r##"
        const { store } = lab.lab;
        const [end, first] = [store.end, Array.from({ length: store.end }, (_, tick) => store.get(tick, "drive"))];
        click("#compare"); lab.send({ command: "open", scene: { ...SCENE, orders: [] }, at: 1 }); await step(1);
        click("#excite"); lab.send({ command: "order", order: { order: "arm" } }); await step(end - 2); await said();
        const drive = lab.charts.panels.flatMap(({ series }) => series).find(({ id }) => id === "drive");
        const rough = (value) => { let sum = 0; for (let tick = 2500; tick < 3200; tick++) sum += Math.abs(value(tick) - value(tick - 1)); return sum / 700; };
        return [first.every((value, tick) => drive.kept.value(tick) === value), rough(drive.kept.value) > 2 * rough((tick) => store.get(tick, "drive")), $("#excite").checked];"##;
    let seen = on_page(&format!("{SAVED}{script}"), &[]);
    assert_eq!(seen, json!([true, true, false]));
}
