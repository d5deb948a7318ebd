//! A power cut after any single step of a write leaves what was there before or after it.

use firmware_logic::settings::store::{Origin, SaveError, Store};

use crate::flash::{Flash, Sectors};
use crate::{commissioning, load, now, unusual};

/// Wherever the power goes while the mark is set or taken away, it stands or it does not, and the settings are there.
#[test]
fn a_power_cut_while_marking_leaves_the_mark_or_not_and_the_settings() {
    let mut store = Store::new(Flash::new());
    now(store.save(&unusual(40.0))).expect("no cut");
    let mut flash = store.into_flash();
    let (mut cuts, mut in_erase) = (0, 0);
    for i in 0..1400 {
        let stands = i % 2 == 0;
        for step in 0.. {
            let mut cut = flash.clone();
            cut.cut_at(step);
            let mut store = Store::new(cut);
            let result = now(store.mark(stands));
            let mut after = store.into_flash();
            if !after.was_cut() {
                assert_eq!(result, Ok(()));
                flash = after;
                break;
            }
            assert_eq!(result, Err(SaveError::Flash));
            (cuts, in_erase) = (cuts + 1, in_erase + u32::from(after.cut_in_erase));
            after.power_up();
            assert_eq!(load(&after), (unusual(40.0), Origin::Flash), "mark {i}, step {step}");
            let mut store = Store::new(after);
            now(store.load());
            assert_eq!(now(store.mark(stands)), Ok(()), "mark {i}, step {step}");
            assert_eq!(now(store.is_marked()), stands, "mark {i}, step {step}");
        }
    }
    assert!(in_erase > 0, "{cuts} cuts, none in an erase");
}

/// Wherever the power goes while one is written or cleared, the old one is there or the new, and the settings.
#[test]
fn a_power_cut_while_commissioning_leaves_the_old_one_or_the_new() {
    let mut store = Store::new(Flash::new());
    now(store.save(&unusual(40.0))).expect("no cut");
    let mut flash = store.into_flash();
    let mut in_erase = 0;
    for i in 0..300 {
        let at = |i: u32| (!i.is_multiple_of(3)).then(|| commissioning(i));
        let (old, new) = (at(i), at(i + 1));
        for step in 0.. {
            let mut cut = flash.clone();
            cut.cut_at(step);
            let mut store = Store::new(cut);
            let result = now(store.keep(new.as_ref()));
            let mut after = store.into_flash();
            if !after.was_cut() {
                assert_eq!(result, Ok(()));
                flash = after;
                break;
            }
            in_erase += u32::from(after.cut_in_erase);
            after.power_up();
            assert_eq!(load(&after), (unusual(40.0), Origin::Flash), "write {i}, step {step}");
            let mut store = Store::new(after);
            let left = now(store.commissioning());
            assert!(left == old || left == new, "write {i}, step {step}: {left:?}");
            assert_eq!(now(store.keep(new.as_ref())), Ok(()), "write {i}, step {step}");
            assert_eq!(now(store.commissioning()), new, "write {i}, step {step}");
        }
    }
    assert!(in_erase > 0, "none in an erase");
}

/// Saves until both sectors have filled up and been erased; before each save, for every write and every erase of it,
/// tries what a power cut in the middle of that step leaves behind.
#[test]
fn a_power_cut_at_any_step_leaves_the_old_settings_or_the_new() {
    let mut flash = Flash::new();
    let (mut cuts, mut in_erase, mut old_kept, mut new_kept) = (0, 0, 0, 0);
    for round in 0..25 {
        let (old, new) = (unusual(21.0 + round as f32 * 0.5), unusual(21.25 + round as f32 * 0.5));
        let mut store = Store::new(flash.clone());
        now(store.save(&old)).expect("no cut");
        flash = store.into_flash();
        for step in 0.. {
            let mut cut = flash.clone();
            cut.cut_at(step);
            let mut store = Store::new(cut);
            let result = now(store.save(&new));
            let mut after = store.into_flash();
            if !after.was_cut() {
                assert_eq!(result, Ok(()));
                break;
            }
            assert_eq!(result, Err(SaveError::Flash));
            cuts += 1;
            in_erase += u32::from(after.cut_in_erase);
            after.power_up();
            let (stored, origin) = load(&after);
            assert_eq!(origin, Origin::Flash, "round {round}, step {step}: {origin}");
            match stored {
                s if s == old => old_kept += 1,
                s if s == new => new_kept += 1,
                s => panic!("round {round}, step {step}: neither old nor new: {s:?}"),
            }
            let mut store = Store::new(after);
            assert_eq!(now(store.save(&new)), Ok(()), "round {round}, step {step}: cannot save any more");
            assert_eq!(load(&store.into_flash()).0, new);
        }
    }
    assert!(
        cuts > 1000 && in_erase > 0 && old_kept > 0,
        "{cuts} cuts, {in_erase} in an erase, {old_kept} old"
    );
    println!("{cuts} cuts, {in_erase} in an erase: {old_kept} times the old settings, {new_kept} the new");
}

/// The first save of a board is cut between the two words of its header. Once in 65,536 the word that the next save puts behind the first
/// is taken for the end of that header, which then seems to reach over all that was saved: what is acknowledged is found all the same. The
/// first set-points are such; `SAVES` tries more.
#[test]
fn what_is_saved_behind_half_a_header_is_found_at_the_next_start() {
    const KNOWN: [f32; 3] = [30.20258, 43.309097, 28.62212];
    let count = std::env::var("SAVES").map_or(1000, |count| count.parse().expect("a number"));
    let mut flash = Sectors::<{ 128 * 1024 }>::new();
    flash.cut_between(2); // behind the mark of the sector and the first word
    let mut store = Store::new(flash);
    assert_eq!(now(store.save(&unusual(30.0))), Err(SaveError::Flash));
    let mut flash = store.into_flash();
    flash.power_up();
    for i in 0..count {
        let setpoint = KNOWN.get(i).copied().unwrap_or(20.0 + (i * 7919 % 500_009) as f32 * 6e-5);
        let mut store = Store::new(flash.clone());
        assert_eq!(now(store.save(&unusual(setpoint))), Ok(()));
        let (found, origin) = now(Store::new(store.into_flash()).load());
        assert!(found == unusual(setpoint), "set-point {setpoint}: {origin}, {}", found.config.setpoint.0);
    }
}

/// Whichever word the flash does not take though it says so: what is acknowledged is found at the next start.
#[test]
fn what_is_acknowledged_is_there_whatever_word_was_lost() {
    let mut store = Store::new(Flash::new());
    now(store.save(&unusual(40.0))).expect("no cut");
    let flash = store.into_flash();
    let mut store = Store::new(flash.clone());
    now(store.save(&unusual(41.0))).expect("no cut");
    let words = flash.steps..store.into_flash().steps;
    assert!(words.len() > 20, "{words:?}");
    for word in words {
        let lossy = || flash.losing(word);
        let mut store = Store::new(lossy());
        assert_eq!(now(store.save(&unusual(41.0))), Ok(()), "word {word}");
        assert!(load(&store.into_flash()).0 == unusual(41.0), "word {word}");
        let mut store = Store::new(lossy());
        if now(store.mark(true)) == Ok(()) {
            assert!(now(Store::new(store.into_flash()).is_marked()), "word {word}");
        }
        let mut store = Store::new(lossy());
        if now(store.keep(Some(&commissioning(1)))) == Ok(()) {
            let kept = now(Store::new(store.into_flash()).commissioning());
            assert_eq!(kept, Some(commissioning(1)), "word {word}");
        }
    }
}

/// A flash that refuses a word is not erased for it: the settings and the commissioning of before are there.
#[test]
fn a_word_that_is_refused_costs_nothing_that_was_kept() {
    let mut store = Store::new(Flash::new());
    now(store.save(&unusual(40.0))).expect("no cut");
    now(store.keep(Some(&commissioning(1)))).expect("no cut");
    let flash = store.into_flash();
    let mut store = Store::new(flash.clone());
    now(store.save(&unusual(41.0))).expect("no cut");
    for word in flash.steps..store.into_flash().steps {
        let mut store = Store::new(flash.refusing(word, 1));
        assert_eq!(now(store.save(&unusual(41.0))), Err(SaveError::Flash), "word {word}");
        let flash = store.into_flash();
        assert_eq!(flash.erases, 0, "word {word}");
        assert!(load(&flash).0 == unusual(40.0), "word {word}");
        assert_eq!(now(Store::new(flash).commissioning()), Some(commissioning(1)), "word {word}");
    }
}

/// Whichever step the flash refuses while the sectors change: the mark that the same start sets next is kept, and the settings are there.
#[test]
fn a_step_that_is_refused_while_the_sectors_change_is_mended_before_the_next_write() {
    let mut flash = Flash::new();
    let steps = loop {
        let mut store = Store::new(flash.clone());
        now(store.save(&unusual(40.0))).expect("no cut");
        let after = store.into_flash();
        if after.erases > 0 {
            break flash.steps..after.steps;
        }
        flash = after;
    };
    for (step, seed) in steps.flat_map(|step| (0..20).map(move |seed| (step, seed))) {
        let mut store = Store::new(flash.refusing(step, seed));
        let saved = now(store.save(&unusual(41.0)));
        assert_eq!(now(store.mark(true)), Ok(()), "step {step}, seed {seed}");
        let mut store = Store::new(store.into_flash());
        assert!(now(store.is_marked()), "step {step}, seed {seed}");
        let (found, _) = now(store.load());
        let is_old = saved.is_err() && found == unusual(40.0);
        assert!(found == unusual(41.0) || is_old, "step {step}, seed {seed}: {saved:?}");
    }
}
