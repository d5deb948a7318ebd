//! Settings must survive: a round trip, an update of the firmware, damage, and a power cut after any single step.

mod flash;

use core::future::Future;
use core::pin::pin;
use core::task::{Context, Poll, Waker};

use fdi_core::diagnosis::baseline::{Baseline, Normal};
use fdi_core::diagnosis::signature::{MAX_ROWS, Signature};
use fdi_core::identify::Adaptation;
use fdi_core::likelihood::Commissioned;
use fdi_core::likelihood::taught::Response;
use fdi_core::name::Name as Called;
use fdi_core::settings::{Kind, Value};
use fdi_core::{Celsius, Config, Seconds, Setting};
use firmware_logic::crc::CRC32;
use firmware_logic::settings::commissioning::Commissioning;
use firmware_logic::settings::store::{Origin, SaveError, Store};
use firmware_logic::settings::stored::{MAX_BYTES, Stored, StoredError, VERSION};
use flash::Flash;
use proptest::prelude::*;

/// The mock never waits, so one poll is all it takes.
fn now<T>(future: impl Future<Output = T>) -> T {
    match pin!(future).poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(value) => value,
        Poll::Pending => panic!("the mock flash never waits"),
    }
}

fn load(flash: &Flash) -> (Stored, Origin) {
    now(Store::new(flash.clone()).load())
}

/// Something that is nowhere at its default.
fn unusual(setpoint: f32) -> Stored {
    let mut config = Config { setpoint: Celsius(setpoint), ..Config::default() };
    config.sensors.t1.offset = Celsius(-0.25);
    config.prbs.start = 77;
    config.identification.adaptation = Adaptation::RandomWalk { r1: 1e-4, r2: 0.01 };
    let rows = &mut config.diagnosis.isolation;
    rows.clear();
    for number in 1..=3u8 {
        let pattern = ["0 -1 0 +1 x", "+1 x -1 0 -1", "+1 0 -1 x +1"][usize::from(number - 1)];
        rows.push(Signature { number, pattern: pattern.parse().expect("a pattern"), name: Called::NONE })
            .expect("room");
    }
    let effects = core::array::from_fn(|i| 300 - 77 * i as i16);
    config.likelihood.taught.push(Response { name: "cap".parse().expect("a name"), effects }).expect("room");
    let numbers = |k: usize| core::array::from_fn(|i| (7 * k + i) as f32 * 0.125);
    let normal = |k| Normal { mean: numbers(k), sigma: numbers(k + 1) };
    Stored { config, baseline: Some(Baseline { samples: 1637, raw: normal(0), filtered: normal(2) }) }
}

fn encoded(stored: &Stored) -> Vec<u8> {
    let mut buffer = [0; MAX_BYTES];
    stored.encode(&mut buffer).expect("fits").to_vec()
}

fn with_crc(mut content: Vec<u8>) -> Vec<u8> {
    content.extend(CRC32.checksum(&content).to_le_bytes());
    content
}

#[test]
fn comes_back_as_it_was() {
    for stored in [Stored::default(), unusual(41.5)] {
        assert_eq!(Stored::decode(&encoded(&stored)), Ok(stored));
    }
}

/// A value near the default, so that it does not contradict other settings.
fn neighbour(setting: &Setting) -> Value {
    match (setting.kind, Config::default().get(setting)) {
        (_, Value::Number(0.0)) => Value::Number(0.01),
        (_, Value::Number(x)) => {
            let (_, max) = setting.kind.bounds().expect("a number");
            Value::Number(if 1.01 * x > max { 0.99 * x } else { 1.01 * x })
        }
        (_, Value::Whole(x)) => Value::Whole(x + 1),
        (_, Value::Switch(on)) => Value::Switch(!on),
        (Kind::Choice(forms), Value::Choice { .. }) => {
            let mut numbers = [0.0; 2];
            for (place, number) in numbers.iter_mut().zip(forms[1].numbers) {
                *place = number.max;
            }
            Value::Choice { form: 1, numbers }
        }
        (kind, value) => panic!("{}: {value:?} is no {kind:?}", setting.name),
    }
}

#[test]
fn every_setting_is_kept() {
    for setting in Config::settings().filter(|setting| setting.name != "sample_time") {
        let mut stored = Stored::default();
        assert!(stored.config.set(setting, neighbour(setting)));
        assert_ne!(stored, Stored::default(), "{}", setting.name);
        assert_eq!(Stored::decode(&encoded(&stored)), Ok(stored), "{}", setting.name);
    }
}

#[test]
fn the_longest_record_fits() {
    let mut stored = unusual(30.0);
    for rows in [&mut stored.config.diagnosis.detection, &mut stored.config.diagnosis.isolation] {
        rows.iter_mut().for_each(|row| row.name = "twelve-bytes".parse().expect("a name"));
        let row = rows[0];
        while rows.push(row).is_ok() {}
        assert_eq!(rows.len(), MAX_ROWS);
    }
    let taught = &mut stored.config.likelihood.taught;
    let response = taught[0];
    while taught.push(response).is_ok() {}
    assert!(encoded(&stored).len() <= MAX_BYTES);
}

#[test]
fn any_flipped_bit_and_any_cut_is_noticed() {
    let bytes = encoded(&unusual(41.5));
    for bit in 0..8 * bytes.len() {
        let mut damaged = bytes.clone();
        damaged[bit / 8] ^= 1 << (bit % 8);
        assert!(Stored::decode(&damaged).is_err(), "bit {bit}");
    }
    for length in 0..bytes.len() {
        assert!(Stored::decode(&bytes[..length]).is_err(), "{length} bytes");
    }
}

#[test]
fn what_another_program_saved_is_read_as_far_as_it_is_known() {
    // A newer program, which knew one setting that this one does not, and not the others.
    let id = Config::settings().find(|setting| setting.name == "setpoint").expect("a setting").id;
    let strange = (0..=u16::MAX).find(|id| Config::settings().all(|s| s.id != *id)).expect("ids are few");
    let mut content = vec![VERSION, 2];
    content.extend(strange.to_le_bytes());
    content.extend([9; 8]);
    content.extend(id.to_le_bytes());
    content.extend(50f32.to_le_bytes());
    content.extend([0xFF; 4]);
    content.extend([0, 0, 0]); // no rows, no rows, no baseline
    let stored = Stored::decode(&with_crc(content)).expect("readable");
    assert_eq!(stored.config.setpoint, Celsius(50.0));
    assert_eq!(stored.config.pid, Config::default().pid);
}

/// `likelihood.fit_time` was saved as `parity.fit_time`; its id is that of the former name.
#[test]
fn what_was_saved_under_a_former_name_is_read() {
    let mut content = vec![VERSION, 1];
    content.extend(0x6bd0_u16.to_le_bytes());
    content.extend(12.5f32.to_le_bytes());
    content.extend([0xFF; 4]);
    content.extend([0, 0, 0]); // no rows, no rows, no baseline
    let stored = Stored::decode(&with_crc(content)).expect("readable");
    assert_eq!(stored.config.likelihood.fit_time, Seconds(12.5));
}

/// What boards have in their flash must be read by every later release: version 1, no settings, two empty tables, no
/// baseline, and its checksum, computed elsewhere.
#[test]
fn a_record_that_was_saved_long_ago_is_read() {
    let saved = [1, 0, 0, 0, 0, 0xAD, 0xDE, 0x42, 0xFB];
    assert!(Stored::decode(&saved).is_ok_and(|stored| stored.baseline.is_none()));
}

#[test]
fn another_layout_is_refused_by_its_version() {
    let mut bytes = encoded(&Stored::default());
    bytes.truncate(bytes.len() - 4);
    bytes[0] = VERSION + 1;
    assert_eq!(Stored::decode(&with_crc(bytes)), Err(StoredError::Version(VERSION + 1)));
}

#[test]
fn settings_out_of_bounds_fall_back_and_say_so() {
    let mut stored = Stored::default();
    stored.config.setpoint = Celsius(f32::NAN);
    assert!(matches!(Stored::decode(&encoded(&stored)), Err(StoredError::Invalid(_))));
    stored.config = Config { sample_time: Seconds(0.02), ..Config::default() };
    let error = Stored::decode(&encoded(&stored)).expect_err("shorter than a board can keep");
    assert!(error.to_string().contains("sample_time is 0.02, expected 0.05 to 5"), "{error}");
    stored.config.sample_time.0 = 0.2;
    assert_eq!(Stored::decode(&encoded(&stored)), Ok(stored));
}

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
    // 12 bytes a mark, in sectors of 8 KiB that carry the settings along: docs/safety.md scales it to 128 KiB.
    assert!((2..=5).contains(&flash.erases), "{} erases for {arms} arms", flash.erases);
}

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

fn commissioning(number: u32) -> Commissioning {
    let parameters = core::array::from_fn(|i| 0.3 + (number as f32) * (i as f32));
    Commissioning { number, models: Commissioned { parameters } }
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

/// Of any row of both tables.
#[test]
fn names_of_rows_are_kept_behind_all_else() {
    let mut stored = unusual(40.0);
    stored.config.likelihood.taught.clear();
    let nameless = encoded(&stored);
    let called = |name: &str| name.parse::<Called>().expect(name);
    stored.config.diagnosis.detection[1].name = called("hand");
    stored.config.diagnosis.isolation[2].name = called("cap-on-T1_23");
    let bytes = encoded(&stored);
    let content = nameless.len() - 4; // the CRC
    assert_eq!((bytes.len(), &bytes[..content]), (nameless.len() + 2 * 14, &nameless[..content]));
    assert_eq!(Stored::decode(&bytes), Ok(stored));
}

proptest! {
    #[test]
    fn no_bytes_panic(bytes in proptest::collection::vec(any::<u8>(), 0..900)) {
        prop_assert!(Stored::decode(&bytes).is_err());
        let _ = Stored::decode(&with_crc(bytes));
    }
}
