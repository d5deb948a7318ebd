//! Each fault that the page offers, mended, is quiet again.

use serde_json::json;

use crate::on_page;

/// Faults that trip and whose alarm still stands a minute after they were mended. Known; the heater is off then.
const STILL_ALARM: [&str; 6] = [
    "paper T1 sticks: t1_stuck",
    "paper T1 falls: t1_detached",
    "paper heater stuck: air_flow_or_heater_power",
    "trainer T1 sticks: t1_stuck",
    "trainer T1 falls: t1_detached",
    "trainer heater stuck: air_flow_or_heater_power",
];

/// Every kind of every part, with the size and the time that its sheet begins with, then 60 s of simulated time. An advice is an alarm, too.
#[test]
fn a_minute_after_it_was_mended_no_fault_is_called_one() {
    let loud = on_page(
        r##"
        const { FOREVER, PARTS } = await import("lab/faults.js");
        const loud = [];
        await monitoring();
        for (const preset of ["paper", "trainer"]) for (const [part, kinds] of Object.entries(PARTS)) for (const [kind, { fault, size, last }] of Object.entries(kinds)) {
          lab.send({ command: "open", scene: { ...SCENE, preset }, skip: true }); await step(1);
          const seconds = (s) => step(Math.round(s / lab.lab.store.ts));
          lab.send({ command: "order", order: { order: "break", fault: { ...fault(size?.value), at: 0, for: FOREVER } } });
          await seconds(last ?? 25);
          lab.send({ command: "order", order: { order: "mend" } });
          await seconds(60);
          const { alarm, class: number } = lab.row();
          if (alarm > 0) loud.push(`${preset} ${part} ${kind}: ${lab.lab.hello.classes.find((c) => c.number === number)?.name ?? "no name"}`);
        }
        return loud;"##,
        &[],
    );
    assert_eq!(loud, json!(STILL_ALARM));
}
