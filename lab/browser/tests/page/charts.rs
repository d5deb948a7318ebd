//! Charts: moved by hand, with every tick in them, and drawn no more often than there is something new.

use serde_json::json;

use crate::on_page;

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

/// Two cursors read what the store holds, by the keyboard's own sliders, and of a step its levels and when it has done its shares; folded they go.
#[test]
fn two_cursors_read_the_charts_and_a_step() {
    let seen = on_page(
        r##"await monitoring();
           const step63 = { do: "heater-power", size: 1.5, at: 0, for: 1e6 };
           const orders = [[0, { order: "arm" }], [0, { order: "excite", on: false }], [300, { order: "set", name: "pid.kp", value: 0 }], [500, { order: "break", fault: step63 }]];
           lab.send({ command: "open", scene: { ...SCENE, preset: "oven", disturbance: "none", orders }, at: 800 });
           await lab.ask({ command: "scene" }); await until(() => lab.lab.store.end === 800); await frame();
           lab.charts.show(1600, 1600); await frame();
           for (const [name, tick] of [["a", 500], ["b", 798]]) { const cursor = $(`#cursor-${name}`); cursor.focus(); cursor.value = tick; cursor.dispatchEvent(new Event("input", { bubbles: true })); }
           await frame();
           const cells = [...document.querySelectorAll("#readings tr")].map((row) => [...row.cells].map((cell) => cell.textContent));
           const { store } = lab.lab;
           const same = cells[1][3] === store.get(500, "t1").toFixed(2) && cells[2][5] === store.get(798, "drive").toFixed(2);
           const [early, late] = $("#readings p").textContent.match(/\d+\.\d+(?=\ss)/g).map(Number);
           const tau = 1.5 * (late - early);
           const read = [Math.abs(tau / 60 - 1) < 0.05, Math.abs(late - tau - 9) < 2];
           const named = [$("#cursor-a").type, $("#cursor-a").step, $("#cursor-a").getAttribute("aria-valuetext"), lab.charts.cursors.length, lab.charts.levels.length];
           click("[data-fold=measure]"); await frame();
           return [same, read, cells[3][1], named, $("#measure").hidden, lab.charts.cursors]"##,
        &[],
    );
    let named = json!(["range", "", "1000.00 s", 2, 4]);
    assert_eq!(seen, json!([true, [true, true], "596.00", named, true, null]));
}
