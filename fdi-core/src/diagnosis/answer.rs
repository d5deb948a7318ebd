//! What a table of signatures answers from tick to tick. The paper's rows answer on the tick on which they match. Rows of a
//! user's own, which have a name, were made from a few repetitions and ask for little: they answer when they have matched for
//! a while, since five residuals that wander meet by chance, but seldom for long.
//!
//! ```
//! use fdi_core::diagnosis::answer::{Answers, Standing};
//! use fdi_core::diagnosis::signature::{PAPER_ISOLATION, Signature, Symptom};
//!
//! let own = Signature { number: 4, pattern: "0 +1 0 -1 0".parse().unwrap(), name: "hand".parse().unwrap() };
//! let rows: Vec<Signature> = PAPER_ISOLATION.into_iter().chain([own]).collect();
//! let (answers, mut standing) = (Answers::new(&rows, 3), Standing::default());
//! let low_t2 = [Symptom::Normal, Symptom::High, Symptom::Normal, Symptom::Low, Symptom::Normal];
//! assert_eq!([(); 4].map(|()| answers.step(&mut standing, &low_t2)), [0, 0, 4, 4]);
//! ```

use super::signature::{Signature, Symptoms, Table};

/// The answers of one table.
#[derive(Clone, Debug)]
pub struct Answers {
    table: Table,
    /// Ticks that a row of the user's own must have matched, less those since on which it did not.
    needed: u32,
}

/// Which row of the user's own has matched, and for how many ticks more than not. It stays where the rows change: one that has a number
/// which was another's must match, too, and answers early at worst.
#[derive(Clone, Copy, Debug, Default)]
pub struct Standing {
    number: u8,
    ticks: u32,
}

impl Answers {
    /// Those of these rows, if one with a name must match for `needed` ticks.
    pub fn new(rows: &[Signature], needed: u32) -> Self {
        Self { table: Table::new(rows), needed }
    }

    /// The number of a row that has matched for long enough, else of one that needs not; 0 where there is none.
    #[inline]
    pub fn step(&self, standing: &mut Standing, symptoms: &Symptoms) -> u8 {
        let [at_once, own] = self.table.look_up(symptoms);
        if own == standing.number {
            standing.ticks = standing.ticks.saturating_add(1).min(self.needed);
        } else if standing.number != 0 && standing.ticks > 0 {
            standing.ticks -= 1;
        } else {
            *standing = Standing { number: own, ticks: 1 };
        }
        let stands = own != 0 && own == standing.number && standing.ticks >= self.needed;
        if stands { own } else { at_once }
    }
}
