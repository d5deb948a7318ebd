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
