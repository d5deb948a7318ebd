//! Samples as the model wants them.

use fdi_core::{KnownInputs, Percent};

use crate::Question;
use crate::plant::{Row, Stretch};
use crate::stretches::stretches;

/// A shorter stretch says nothing but how it began.
const SHORTEST: usize = 20;
/// A heater beside that moves by less, %, shows nothing.
const STILL: f64 = 0.1;
/// Temperatures beyond are none, degC: see [`fdi_core::Monitor`].
const HOTTEST: f64 = 1e5;
/// Nothing is learnt where the fan is further from its usual level.
const USUAL_FAN: f32 = 0.05;

/// Them.
pub(super) struct Prepared {
    /// Those that are long enough.
    pub(super) stretches: Vec<Stretch>,
    /// The sample that each of them begins with.
    pub(super) begins: Vec<usize>,
    /// The T1 over which rises count where there is no T0, degC.
    pub(super) base: f64,
    /// The heater beside moves.
    pub(super) beside: bool,
}

impl Prepared {
    /// Standard deviation of T1; none where it never moves.
    pub(super) fn spread(&self) -> Option<f64> {
        let y: Vec<f64> =
            self.stretches.iter().flatten().map(|row| row.y[0]).filter(|y| y.is_finite()).collect();
        let mean = y.iter().sum::<f64>() / y.len() as f64;
        let spread = (y.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / y.len() as f64).sqrt();
        (spread > 0.0).then_some(spread)
    }
}

impl Question<'_> {
    /// The samples in degC and %, cut at gaps.
    pub(super) fn prepared(&self) -> Prepared {
        let celsius = f64::from(self.units.celsius);
        let percent = 100.0 / self.units.full_power;
        let first = self.samples.iter().find_map(|sample| sample.t[1]).map_or(0.0, f64::from);
        let base = first * celsius;
        let (mut power, mut beside) = (0.0, 0.0);
        let rows: Vec<Option<Row>> = self
            .samples
            .iter()
            .map(|sample| {
                let known = KnownInputs {
                    supply: sample.supply,
                    fan: sample.fan.map(Percent),
                    ..KnownInputs::default()
                };
                let asked = sample.power.map(|u| (u * percent).clamp(0.0, 100.0));
                power = asked.map_or(power, |u| f64::from(known.effective(u)));
                beside = sample.beside.map_or(beside, |u| f64::from(u * percent));
                let [t0, t1, t2] = sample.t.map(|t| t.map_or(f64::NAN, |t| f64::from(t) * celsius));
                let t0 = if self.inputs.t0 { t0 } else { base };
                let usual = (known.fan_share() - 1.0).abs() <= USUAL_FAN;
                let y = [t1 - t0, t2 - t0].map(|y| if usual && y.abs() < HOTTEST { y } else { f64::NAN });
                let there = sample.power.is_some() || !y[0].is_nan();
                there.then_some(Row { power, beside, y })
            })
            .collect();
        let beside = rows.iter().flatten().map(|row| row.beside);
        let (low, high) = beside.fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(x), high.max(x)));
        let parts = stretches(rows.iter().map(Option::is_some)).into_iter();
        let parts = parts.map(|part| (part.start, self.averaged(&filled(&rows[part]))));
        let (begins, stretches) = parts.filter(|(_, part)| part.len() >= SHORTEST).unzip();
        Prepared { stretches, begins, base, beside: high - low > STILL }
    }

    /// Means, and what has driven the rig since the row before.
    fn averaged(&self, part: &[Row]) -> Stretch {
        if self.every > 1 {
            return part.chunks_exact(self.every).map(mean).collect();
        }
        let before = std::iter::once(&part[0]).chain(part);
        let pairs = part.iter().zip(before);
        pairs.map(|(row, before)| Row { power: before.power, beside: before.beside, ..*row }).collect()
    }
}

/// Rows without a gap; what is missing for a moment has the power of before, and no temperature.
fn filled(rows: &[Option<Row>]) -> Stretch {
    let mut last = Row { power: 0.0, beside: 0.0, y: [f64::NAN; 2] };
    let row = |row: &Option<Row>| {
        let row = row.unwrap_or(last);
        last = Row { y: [f64::NAN; 2], ..row };
        row
    };
    rows.iter().map(row).collect()
}

/// The mean of some rows, as one.
fn mean(rows: &[Row]) -> Row {
    let over = |of: &dyn Fn(&Row) -> f64| {
        let known: Vec<f64> = rows.iter().map(of).filter(|x| x.is_finite()).collect();
        known.iter().sum::<f64>() / known.len() as f64
    };
    Row {
        power: over(&|row| row.power),
        beside: over(&|row| row.beside),
        y: [over(&|row| row.y[0]), over(&|row| row.y[1])],
    }
}
