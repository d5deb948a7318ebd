//! What the flash keeps, whatever stood in it and however often it was written.

use firmware_logic::settings::store::{Origin, Store};
use firmware_logic::settings::stored::Stored;

use crate::flash::Flash;
use crate::{commissioning, load, now, unusual};

#[test]
fn an_empty_flash_gives_the_defaults_and_a_full_one_still_saves() {
    let mut flash = Flash::new();
    assert_eq!(load(&flash), (Stored::default(), Origin::Default));
    let mut erases = 0;
    for i in 0..200 {
        let stored = unusual(21.0 + i as f32 * 0.2);
        let mut store = Store::new(flash.clone());
        assert_eq!(now(store.save(&stored)), Ok(()), "save {i}");
        flash = store.into_flash();
        erases = flash.erases;
        assert_eq!(load(&flash), (stored, Origin::Flash));
    }
    assert!(erases > 2, "both sectors have been used up: {erases}");
}

#[test]
fn garbage_in_flash_falls_back_and_can_be_saved_over() {
    let mut flash = Flash::new();
    flash.fill_with_garbage(3);
    let (stored, origin) = load(&flash);
    assert_eq!(stored, Stored::default());
    assert!(!matches!(origin, Origin::Flash), "{origin}");
    let mut store = Store::new(flash);
    assert_eq!(now(store.save(&unusual(40.0))), Ok(()));
    assert_eq!(load(&store.into_flash()), (unusual(40.0), Origin::Flash));
}

/// Noise with every combination of the page marks by which the storage tells sectors apart.
fn garbage() -> impl Iterator<Item = Flash> {
    (1..=4u32).flat_map(|seed| {
        (0..=u8::MAX).map(move |marks| {
            let mut flash = Flash::new();
            flash.fill_with_garbage(seed + 4 * u32::from(marks));
            flash.set_page_marks(marks);
            flash
        })
    })
}

#[test]
fn the_first_save_over_any_garbage_succeeds() {
    for (i, flash) in garbage().enumerate() {
        let mut store = Store::new(flash);
        now(store.load());
        assert_eq!(now(store.save(&unusual(40.0))), Ok(()), "pattern {i}");
        assert_eq!(load(&store.into_flash()), (unusual(40.0), Origin::Flash), "pattern {i}");
    }
}

#[test]
fn a_mark_is_kept_beside_the_settings_and_wears_little() {
    let mut store = Store::new(Flash::new());
    assert!(!now(store.is_marked()));
    assert_eq!(now(store.save(&unusual(40.0))), Ok(()));
    let arms = 1000;
    for _ in 0..arms {
        for stands in [true, false] {
            assert_eq!(now(store.mark(stands)), Ok(()));
            assert_eq!(now(store.is_marked()), stands);
        }
    }
    let flash = store.into_flash();
    assert_eq!(load(&flash), (unusual(40.0), Origin::Flash));
    // 12 bytes a mark, in sectors of 8 KiB that carry the settings along: docs/evidence/safety-evidence.md scales it to 128 KiB.
    assert!((2..=5).contains(&flash.erases), "{} erases for {arms} arms", flash.erases);
}

#[test]
fn a_commissioning_outlives_settings_that_fill_the_flash_and_a_save_over_garbage_loses_only_it() {
    let mut store = Store::new(Flash::new());
    assert_eq!(now(store.commissioning()), None);
    assert_eq!(now(store.keep(Some(&commissioning(1)))), Ok(()));
    for _ in 0..200 {
        assert_eq!(now(store.save(&unusual(40.0))), Ok(()));
    }
    let mut flash = store.into_flash();
    assert!(flash.erases > 2);
    assert_eq!(now(Store::new(flash.clone()).commissioning()), Some(commissioning(1)));
    flash.fill_with_garbage(3);
    let mut store = Store::new(flash);
    assert_eq!(now(store.commissioning()), None);
    assert_eq!(now(store.save(&unusual(40.0))), Ok(()));
    assert_eq!(now(store.commissioning()), None);
}
