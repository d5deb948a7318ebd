//! The record of all settings: what is written is read again, by other programs too, and damage is noticed.

use fdi_core::diagnosis::signature::MAX_ROWS;
use fdi_core::name::Name as Called;
use fdi_core::settings::{Kind, Value};
use fdi_core::{Celsius, Config, Seconds, Setting};
use firmware_logic::crc::CRC32;
use firmware_logic::settings::stored::{MAX_BYTES, Stored, StoredError, VERSION};
use proptest::prelude::*;

use crate::unusual;

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

/// What a later release puts behind all else, with its length, is passed over; so is what there is no room for.
#[test]
fn what_is_not_known_is_passed_over() {
    let stored = unusual(40.0);
    let mut content = encoded(&stored);
    content.truncate(content.len() - 4); // the CRC
    let with = |more: &[u8]| Stored::decode(&with_crc([&content[..], more].concat()));
    assert_eq!(with(&[3, 5, 1, 2, 3, 4, 5]), Ok(stored.clone()));
    assert_eq!(with(&[3, 5, 1, 2, 3, 4]), Err(StoredError::Short));
    let response = [&[2, 34][..], b"cap-2\0\0\0\0\0\0\0", &[1; 22]].concat();
    let taught = |times: usize| with(&response.repeat(times)).expect("known").config.likelihood.taught;
    assert_eq!((taught(1).len(), taught(1)[1].effects), (2, [257; 11]));
    assert_eq!(taught(12).len(), 10);
}

proptest! {
    #[test]
    fn no_bytes_panic(bytes in proptest::collection::vec(any::<u8>(), 0..MAX_BYTES)) {
        prop_assert!(Stored::decode(&bytes).is_err());
        let _ = Stored::decode(&with_crc(bytes));
    }
}
