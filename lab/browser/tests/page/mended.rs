//! Each fault that the page offers, mended, is over a minute later; where it has tripped, the page's own buttons lead back to monitoring.

use serde_json::json;

use crate::on_page;

/// Every kind of every part, with the size that its sheet begins with and for as long, then mended by the page's button, and after a trip
/// acknowledged, armed and trained by its buttons. Then a minute of simulated time; a contact that was named loose has the 270 s for which
/// it must hold before. All is over where nothing is called a fault, advice included, and the rig monitors.
#[test]
fn a_minute_after_it_was_mended_no_fault_is_called_one() {
    let [loud, tripped] = serde_json::from_value::<[Vec<String>; 2]>(on_page(
        r##"
        const { FOREVER, PARTS } = await import("lab/faults.js");
        const [loud, tripped] = [[], []];
        await monitoring();
        const name = () => lab.lab.hello.classes.find(({ number }) => number === lab.row().class)?.name ?? "no name";
        const press = async (act) => { await said(); const button = $(`#more [data-act=${act}]`) ?? $(`#hint [data-act=${act}]`); button?.click(); await step(1); return !!button; };
        for (const preset of ["paper", "trainer"]) for (const [part, kinds] of Object.entries(PARTS)) for (const [kind, { fault, size, last }] of Object.entries(kinds)) {
          lab.send({ command: "open", scene: { ...SCENE, preset }, skip: true }); await step(1);
          const seconds = (s) => step(Math.round(s / lab.lab.store.ts));
          lab.send({ command: "order", order: { order: "break", fault: { ...fault(size?.value), at: 0, for: FOREVER } } });
          await seconds(last ?? 25);
          const which = `${preset} ${part} ${kind}`;
          const loose = name().endsWith("_loose");
          if (!(await press("mend"))) loud.push(`${which}: no button mends it`);
          await seconds(5);
          if (lab.row().mode === 4) {
            tripped.push(which);
            for (const act of ["ack", "arm", "skip"]) if (!(await press(act))) loud.push(`${which}: no button says ${act}`);
          }
          await seconds(60 + (loose ? 270 : 0));
          if (lab.row().alarm > 0 || lab.row().mode !== 3) loud.push(`${which}: ${name()}, mode ${lab.row().mode}`);
          if (part.startsWith("T") && kind === "loose" && !loose) loud.push(`${which}: never named`);
        }
        return [loud, tripped];"##,
        &[],
    ))
    .expect("two lists");
    assert_eq!(json!(loud), json!([]));
    assert!(tripped.iter().any(|which| which == "paper T1 open"), "none has tripped: {tripped:?}");
}
