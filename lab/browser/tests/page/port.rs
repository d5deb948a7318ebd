//! A port of the computer at whose other end is no board, or one that lies.

use std::io::{Read, Write};
use std::time::Duration;

use pt326_lab_browser::bridge::{SERIAL, serve};
use pt326_lab_browser::port::PORT;
use serde_json::json;
use serialport::{SerialPort, TTYPort};

use crate::on_page;

/// Each way in which there is no board is told in a sentence, and the rig goes on.
#[test]
fn where_there_is_no_board_that_is_said_with_what_to_do() {
    let script = r##"await monitoring();
        serial(undefined); click("#connect"); const none = await toast(/Chrome or Edge/);
        const asked = [];
        serial({ requestPort: async (what) => { asked.push(Object.keys(what)); throw new DOMException("No port selected by the user.", "NotFoundError"); } });
        click("#connect"); const chosen = await toast(/No port was chosen/);
        $("#toast").textContent = ""; click("#connect"); await toast(/No port was chosen/);
        const busy = new Port(BOARD); busy.open = async () => { throw new DOMException("Failed to open serial port.", "NetworkError"); };
        offer(busy); click("#connect"); const used = await toast(/close the other tab or program/);
        const mute = new Port({}); let closed = 0; mute.close = async () => void closed++;
        offer(mute); click("#connect"); const nobody = await toast(/is this the board's port/);
        const other = new Port({ ...BOARD, get: "get\r\nwarp.factor = 9\r\n> " });
        offer(other); click("#connect"); const release = await toast(/warp.factor/);
        await step(1); await until(() => closed);
        if (JSON.stringify(asked) !== '[["filters"],[]]') return asked;
        return [none, chosen, used, nobody, release].every((text) => text.length < 300) && lab.lab.hello.kind === "simulated" && lab.row().mode === 3"##;
    assert_eq!(on_page(&format!("{PORT}{script}"), &[]), json!(true));
}

/// Whatever it says is text, and a stop still goes out.
#[test]
fn a_board_that_lies_can_do_nothing() {
    let script = r##"await monitoring();
        const port = new Port(BOARD); offer(port); click("#connect");
        await until(() => lab.lab.hello.kind === "board" && lab.lab.settings["pid.kp"] === 2.5);
        const html = '<img src=x onerror="window.harmed = 1"><script>window.harmed = 1</' + "script>";
        port.says(`${html}\n\x1b]52;c;cm0=\x07\n`);
        port.says(`\x02tick 0 ${html}*00000000\r\n\x02${"x".repeat(5000)}\r\n\x02log format 5*00000000\r\n`);
        await until(() => $("#console").textContent.includes("<img"));
        for (let i = 0; i < 300; i++) { port.says("z".repeat(8192)); if (i % 50 === 0) await frame(); }
        port.says(Array.from({ length: 65536 }, (_, i) => String.fromCharCode((i * 7919) % 256)).join(""));
        await until(() => $("#console").textContent.includes("\\u{"));
        port.heard = ""; click("#stop"); await until(() => port.heard.includes("\x03"));
        for (let i = 0; i < 10; i++) await frame();
        return [document.querySelectorAll("main img, main script").length, window.harmed ?? 0, $("#console").textContent.length < 4e6, /\x03(\x15stream on\r)*$/.test(port.heard)]"##;
    assert_eq!(on_page(&format!("{PORT}{script}"), &[]), json!([0, 0, true, true]));
}

/// A tab that slept hears all at once what came meanwhile; where that was too much, there is a gap, and it goes on.
#[test]
fn what_came_while_a_tab_slept_is_caught_up_with() {
    let script = r##"await monitoring();
        const port = new Port(BOARD); offer(port); click("#connect");
        await until(() => lab.lab.hello.kind === "board" && lab.lab.settings["pid.kp"] === 2.5);
        const tick = (n) => framed(`tick ${n.toString(16)}${" 45000000".repeat(31)}`);
        const ticks = (from, to) => Array.from({ length: to - from }, (_, i) => tick(from + i)).join("");
        port.says(tick(500)); await until(() => lab.lab.store?.end === 1);
        port.says(ticks(501, 5500)); await until(() => lab.lab.store.end === 5000);
        const all = lab.lab.store.get(2000, "tick");
        port.overruns(); port.says(ticks(5600, 5610)); await until(() => lab.lab.store.end === 5110);
        const { parts } = await lab.ask({ command: "log" }); const log = await new Blob(parts).text();
        return [all, Number.isFinite(lab.lab.store.get(5050, "t1")), Number.isFinite(lab.lab.store.get(5105, "t1")), /# ticks 5500 to 5599 are missing/.test(log), log.split("\n").length - 1]"##;
    assert_eq!(on_page(&format!("{PORT}{script}"), &[]), json!([2000, false, true, true, 5011]));
}

/// Which image a board runs, whether it fits this page, and what to do where it does not; what it says of itself is text.
#[test]
fn an_image_that_does_not_fit_is_told_with_what_to_do() {
    let script = r##"await monitoring();
        const port = new Port(BOARD); offer(port); click("#connect");
        await until(() => lab.lab.hello.kind === "board" && lab.lab.settings["pid.kp"] === 2.5);
        const seen = async (line, pattern) => { port.says(framed(line)); await until(() => (tick(), pattern.test($("#image").textContent))); return $("#image").textContent; };
        let n = 0; const tick = () => port.says(framed(`tick ${(n++).toString(16)}${" 45000000".repeat(31)}`));
        const old = await seen("mode 1 off", /older than this page/);
        const fits = await seen("image 0.1.0 (1a2b3c4) on NUCLEO-F411RE, format 5", /fits/);
        const other = await seen("image 0.2.0 (<i>) on NUCLEO-F446RE, format 6", /Drag/);
        return [fits.includes("image 0.1.0 (1a2b3c4)"), other.replace(lab.lab.hello.version, "RELEASE"), $("#toast").textContent === other, document.querySelectorAll("main i i, #image i").length]"##;
    let update = "The board runs image 0.2.0 (<i>), log format 6; this page, RELEASE, reads 5. Drag pt326-nucleo-f446re.bin, which came \
        with this page, onto the drive NODE_F446RE, or open the page that came with the image.";
    assert_eq!(on_page(&format!("{PORT}{script}"), &[]), json!([true, update, true, 0]));
}

/// What was done and said becomes a page of its own: each step with how it ended, the board's own settings, and nothing of it as HTML.
#[test]
fn a_commissioning_is_written_down_as_a_page() {
    let script = r##"await monitoring();
        const answer = (line, text) => ({ [line]: `${line}\r\n${text}\r\n> ` });
        const port = new Port({ ...BOARD, ...answer("calibrate apply", "in force; `save` keeps it"), ...answer("check", "ok, see below for about 2 min"), ...answer("save", "ok"), ...answer("tune", "no result <i>") });
        offer(port); click("#connect");
        await until(() => lab.lab.hello.kind === "board" && lab.lab.settings["pid.kp"] === 2.5);
        const type = async (line) => { $("#line").value = line; $("#typed").requestSubmit(); await until(() => $("#console").textContent.includes(`> ${line}\n`)); };
        await type("calibrate apply"); await type("check");
        port.says("check: T1 and T2 are swapped\r\ncheck failed\r\n"); await until(() => $("#console").textContent.includes("check failed"));
        await type("tune"); await type("save");
        const { report } = await import("lab/commissioning.js");
        const page = () => new DOMParser().parseFromString(report("Ana <b>, rig 3", "today"), "text/html");
        const english = page(); click("#language"); const other = page(); click("#language");
        const rows = (of) => [...of.querySelectorAll("tr")].map((row) => row.lastElementChild.textContent.trim());
        const parts = [...english.querySelectorAll("pre")].map((part) => part.textContent.trim());
        const files = []; HTMLAnchorElement.prototype.click = function () { files.push(this.download); };
        click("#report-save");
        return [rows(english), rows(other), english.querySelectorAll("b, i").length, english.querySelector("p").textContent.startsWith("Ana <b>, rig 3today"), parts[1], parts.at(-2), english.documentElement.lang + other.documentElement.lang, files]"##;
    let seen = on_page(&format!("{PORT}{script}"), &[]);
    let check = "> check\nok, see below for about 2 min\ncheck: T1 and T2 are swapped\ncheck failed";
    assert_eq!(
        seen,
        json!([
            ["done", "FAILED", "left out", "left out", "done"],
            ["feito", "FALHOU", "não feito", "não feito", "feito"],
            0,
            true,
            check,
            "pid.kp = 2.5 %/°C\nsetpoint = 36 °C",
            "enpt",
            ["commissioning.html"]
        ])
    );
}

/// A write that fails ends its stream. The stop goes out by the port's next one, however the first was lost: its own, or a line's before it.
#[test]
fn a_stop_goes_out_after_a_write_has_failed() {
    let script = r##"await monitoring();
        const port = new Port(BOARD); offer(port); click("#connect");
        await until(() => lab.lab.hello.kind === "board" && lab.lab.settings["pid.kp"] === 2.5);
        const stops = async (fails) => {
          Object.assign(port, { fails, heard: "" }); $("#toast").textContent = ""; click("#stop");
          await until(() => port.heard.includes("\x03") || /NOT/.test($("#toast").textContent));
          return port.heard.includes("\x03");
        };
        port.fails = 1; port.heard = ""; $("#line").value = "arm"; $("#typed").requestSubmit(); await until(() => port.fails < 1);
        const typed = port.heard;
        const failed = await stops(2); port.answers = {}; lab.send({ command: "order", order: { order: "nonsense" } }); for (let i = 0; i < 20; i++) await frame();
        const stands = /NOT/.test($("#toast").textContent);
        return [typed, failed, stands, await stops(0), await stops(1), await stops(0)]"##;
    assert_eq!(on_page(&format!("{PORT}{script}"), &[]), json!(["", false, true, true, true, true]));
}

/// A pulled cable is told in the sentence and in the bar, which stands over whatever is in view; when it is in again, both say so.
#[test]
fn a_pulled_cable_is_said_where_one_looks() {
    let script = r##"await monitoring();
        const port = new Port(BOARD); offer(port); click("#connect");
        await until(() => lab.lab.hello.kind === "board" && lab.lab.settings["pid.kp"] === 2.5);
        const tick = (n) => port.says(framed(`tick ${n.toString(16)}${" 45000000".repeat(31)}`));
        tick(1); await until(() => lab.lab.store?.end === 1);
        port.unplug(); $("#console").scrollIntoView(); await until(() => document.body.dataset.state === "lost");
        const { top, height } = $("#source span").getBoundingClientRect();
        const lost = [$("#head").innerText, $("#source").textContent.trim(), top >= 0 && height > 0, $("#toast").textContent];
        port.plug(); await until(() => port.readable); tick(2); await until(() => document.body.dataset.state !== "lost");
        return [...lost, $("#source").textContent.trim()]"##;
    let head = "The board is not heard: is its cable in?";
    assert_eq!(
        on_page(&format!("{PORT}{script}"), &[]),
        json!([head, "No connection", true, head, "Real board:"])
    );
}

/// Whoever leaves the page of a board is asked, and whoever goes back to the rig has to press twice; else nobody.
#[test]
fn a_board_is_not_left_by_one_press() {
    let script = r##"await monitoring();
        const asks = () => { const event = new Event("beforeunload", { cancelable: true }); dispatchEvent(event); return event.defaultPrevented; };
        const before = asks();
        const port = new Port(BOARD); offer(port); click("#connect");
        await until(() => lab.lab.hello.kind === "board" && lab.lab.settings["pid.kp"] === 2.5);
        const data = new DataTransfer(); data.items.add(new File(["t_s\n"], "trace.csv")); document.body.dispatchEvent(new DragEvent("drop", { dataTransfer: data, bubbles: true, cancelable: true }));
        await toast(/board is connected/); const there = asks(); click("#back"); const stays = lab.lab.hello.kind;
        click("#back"); await until(() => lab.lab.hello.kind === "simulated" && lab.lab.store?.end > 0);
        return [before, there, stays, asks()]"##;
    assert_eq!(on_page(&format!("{PORT}{script}"), &[]), json!([false, true, "board", false]));
}

/// The port that tests with a board bring: bytes go both ways, and it closes.
#[test]
fn a_port_behind_a_socket_carries_every_byte_both_ways() {
    let (mut board, mut behind) = TTYPort::pair().expect("a pseudo-terminal");
    behind.set_exclusive(false).expect("others may open it");
    board.set_timeout(Duration::from_secs(20)).expect("a timeout");
    let address = serve(behind.name().expect("its path")).expect("a bridge");
    let all: Vec<u8> = (0..=255).collect();
    let (told, heard) = (all.clone(), all.clone());
    let other = std::thread::spawn(move || {
        let mut bytes = [0; 256];
        board.read_exact(&mut bytes).expect("what the page has written");
        board.write_all(&told).expect("an answer");
        (bytes == *heard, board) // open until the page has read
    });
    let script = r##"
        const port = await navigator.serial.requestPort(); await port.open({ baudRate: 115200 });
        const bytes = Uint8Array.from({ length: 256 }, (_, i) => i);
        const writer = port.writable.getWriter(); await writer.write(bytes); writer.releaseLock();
        const reader = port.readable.getReader(), read = [];
        while (read.length < 256) read.push(...(await reader.read()).value);
        await reader.cancel(); reader.releaseLock(); await port.close();
        return read.every((byte, i) => byte === i)"##;
    assert_eq!(on_page(&format!("{{ {SERIAL} }}{script}"), &[json!(address)]), json!(true));
    let (same, _board) = other.join().expect("the other end");
    assert!(same, "the board's end has heard something else");
}
