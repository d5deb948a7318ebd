//! `pt326 console`: the examples of its help.

use crate::{pt326, pt326_reading, text};

/// A rig that was checked and has learnt names the fault that the user makes, and no other comes before.
#[test]
fn the_example_of_the_help_ends_with_the_name_of_the_fault() {
    let script = r"check\narm\nwait 370\nfault offset t2 1.5 25\nwait 5\nstatus\n";
    let help = text(&pt326(&["console", "--help"]).stdout);
    assert!(help.contains(script), "{help}");
    let said = text(&pt326_reading(&["console"], &script.replace(r"\n", "\n")).stdout);
    let (learnt, named) = said.split_once("> fault offset").expect("a fault");
    assert!(learnt.contains("check passed") && learnt.contains("learn -> monitor"), "{said}");
    assert!(!learnt.contains("T2 reads") && named.contains("T2 reads 1."), "{said}");
}
