//! The sign of a chart over some samples, and names by a table of them, as the paper's signatures are.

use super::settings::Plant;

/// A row of a table, or what is seen: a sign for each chart.
pub(super) type Signs = Vec<Sign>;

/// How a chart stands, or what a row of the table asks of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sign {
    /// Above the threshold nearly always.
    Above,
    /// Below its negative nearly always.
    Below,
    /// Beyond neither but for a few samples.
    Quiet,
    /// Beyond it often, and on no side nearly always.
    Restless,
    /// In a table: anything but quiet.
    Loud,
    /// In a table: anything.
    Any,
}

/// Share of the samples that is nearly always. Chosen with the files of docs/scores.md in sight.
const NEARLY_ALWAYS: f32 = 0.9;
/// Share of the samples that is a few. Chosen the same way.
const FEW: f32 = 0.3;

impl Sign {
    /// Reads a letter of a table.
    pub(super) fn parse(letter: char) -> Option<Self> {
        Some(match letter {
            '+' => Self::Above,
            '-' => Self::Below,
            '0' => Self::Quiet,
            '~' => Self::Restless,
            '!' => Self::Loud,
            '.' => Self::Any,
            _ => return None,
        })
    }

    /// Of a chart over some samples.
    pub(super) fn of(chart: &[f32], threshold: f32) -> Self {
        let share = |beyond: &dyn Fn(f32) -> bool| {
            chart.iter().filter(|x| beyond(**x)).count() as f32 / chart.len() as f32
        };
        match (share(&|x| x > threshold), share(&|x| x < -threshold)) {
            (above, _) if above > NEARLY_ALWAYS => Self::Above,
            (_, below) if below > NEARLY_ALWAYS => Self::Below,
            (above, below) if above + below < FEW => Self::Quiet,
            _ => Self::Restless,
        }
    }

    /// Whether what is seen is what the table asks for.
    fn fits(self, seen: Self) -> bool {
        match self {
            Self::Any => true,
            Self::Loud => seen != Self::Quiet,
            _ => self == seen,
        }
    }
}

/// The only row of the table that fits; none: no row does, or several do.
pub(super) fn name_of(plant: &Plant, seen: &[Sign]) -> Option<usize> {
    let mut fitting = (0..plant.names.len())
        .filter(|name| plant.names[*name].rows.iter().zip(seen).all(|(row, seen)| row.fits(*seen)));
    fitting.next().filter(|_| fitting.next().is_none())
}
