//! A value as two words, as it is kept in flash and compared.

use fdi_core::Config;
use fdi_core::settings::{Form, Kind, Value};

use crate::crc::CRC32;

/// A value as it is kept.
pub(super) type Bits = [u32; 2];

/// In the second word where one is enough.
const UNUSED: u32 = u32::MAX;

/// CRC-32 over the values of all settings that have one.
pub(crate) fn checksum(config: &Config) -> u32 {
    let mut digest = CRC32.digest();
    for setting in Config::settings() {
        let words = bits(setting.kind, config.get(setting));
        words.iter().filter(|word| **word != UNUSED).for_each(|word| digest.update(&word.to_le_bytes()));
    }
    digest.finalize()
}

/// The value of a setting of this kind as it is kept. Forms that have numbers are told apart by how many they have.
pub(super) fn bits(kind: Kind, value: Value) -> Bits {
    match (value, kind) {
        (Value::Number(x), _) => [x.to_bits(), UNUSED],
        (Value::Whole(x), _) => [x.into(), UNUSED],
        (Value::Switch(x), _) => [x.into(), UNUSED],
        (Value::Choice { form, numbers: [first, second] }, Kind::Choice(forms)) => match count(forms, form) {
            0 => [form as u32, UNUSED],
            1 => [first.to_bits(), UNUSED],
            _ => [first.to_bits(), second.to_bits()],
        },
        (Value::Choice { .. }, _) => [UNUSED; 2],
    }
}

/// What was kept, as a value of a setting of this kind.
pub(super) fn value(kind: Kind, bits: Bits) -> Value {
    let [first, second] = bits.map(f32::from_bits);
    match kind {
        Kind::Number { .. } => Value::Number(first),
        Kind::Whole { .. } => Value::Whole(bits[0].try_into().unwrap_or(u16::MAX)),
        Kind::Switch => Value::Switch(bits[0] == 1),
        Kind::Choice(forms) if count(forms, 0) == 0 => {
            Value::Choice { form: bits[0] as usize, numbers: [0.0; 2] }
        }
        Kind::Choice(forms) => {
            let (numbers, kept) = if bits[1] == UNUSED { ([first, 0.0], 1) } else { ([first, second], 2) };
            let form = forms.iter().position(|form| form.numbers.len() == kept);
            Value::Choice { form: form.unwrap_or(forms.len()), numbers }
        }
    }
}

/// How many numbers a form has.
fn count(forms: &[Form], form: usize) -> usize {
    forms.get(form).map_or(0, |form| form.numbers.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forms_are_told_apart() {
        for setting in Config::settings() {
            let Kind::Choice(forms) = setting.kind else { continue };
            for (form, Form { word, .. }) in forms.iter().enumerate() {
                let mut numbers = [0.0; 2];
                numbers[..count(forms, form)].fill(0.25);
                let given = Value::Choice { form, numbers };
                assert_eq!(value(setting.kind, bits(setting.kind, given)), given, "{} {word}", setting.name);
            }
        }
    }
}
