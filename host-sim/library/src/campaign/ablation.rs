//! Each number of the likelihood diagnosis at half and at twice its value, one at a time.

use fdi_core::likelihood::Tuning;
use fdi_core::likelihood::tuning::Entry;
use toml::Value;

/// What `vary` of a campaign becomes. Whole numbers of ticks stay whole, halves are rounded up; a value that is the default is left out.
pub fn vary() -> impl Iterator<Item = (String, Vec<Value>)> {
    let entries = Tuning::PARTS.iter().flat_map(|part| part.entries);
    entries.map(|entry| (entry.name.to_owned(), values(entry)))
}

fn values(entry: &Entry) -> Vec<Value> {
    let default = (entry.value)(&Tuning::DEFAULT);
    let is_count = entry.unit == "ticks" && default.fract() == 0.0;
    let whole = |x: f32| if is_count { x.ceil() } else { x };
    let others = [0.5, 2.0].map(|factor| whole(factor * default)).into_iter().filter(|&x| x != default);
    others.map(|x| Value::Float(crate::experiment::as_written(x))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_number_has_half_and_twice_and_counts_stay_whole() {
        let all: Vec<(String, Vec<Value>)> = vary().collect();
        let of = |name: &str| &all.iter().find(|(key, _)| key == name).unwrap().1[..];
        assert_eq!(of("tuning.charts.clip"), [Value::Float(3.0), Value::Float(12.0)]);
        assert_eq!(of("tuning.whitening.least_sigma"), [Value::Float(0.01), Value::Float(0.04)]);
        assert_eq!(of("tuning.model.inlet_slope"), [Value::Float(3.0), Value::Float(10.0)], "5 ticks");
        assert_eq!(of("tuning.contradiction.after"), [Value::Float(2.0)], "1 tick");
        assert_eq!(all.len(), Tuning::PARTS.iter().map(|part| part.entries.len()).sum::<usize>());
    }
}
