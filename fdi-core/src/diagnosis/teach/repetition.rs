//! One repetition of a fault, as it goes on: nobody knows yet when it ends, and its end is what counts, a quarter to a
//! half of it, in which the adapting models have followed.

use heapless::Vec;

use crate::diagnosis::signature::{Symptom, Symptoms, WIDTH};
use crate::likelihood::taught::{Changed, Effects, Mean};

/// A residual has a symptom if so many percent of the ticks have it; else it comes and goes.
const STEADY: u32 = 90;
/// Pieces that a repetition is counted in. When they are full, two become one.
const PIECES: usize = 8;

/// The symptom of each decisive residual at the end of a repetition; `None` where it came and went.
pub type Steady = [Option<Symptom>; WIDTH];

/// Ticks of a piece, and on how many of them each residual was low, and high.
#[derive(Clone, Copy, Debug, Default)]
struct Piece {
    ticks: u16,
    low: [u16; WIDTH],
    high: [u16; WIDTH],
}

/// A repetition that may still go on.
#[derive(Clone, Debug)]
pub struct Repetition {
    /// Ticks that fill a piece.
    length: u16,
    pieces: Vec<Piece, PIECES>,
    /// An alarm that began before this tick is of something else.
    earliest: u32,
    /// What the likelihood diagnosis says that it changes.
    changed: Mean,
}

impl Default for Repetition {
    fn default() -> Self {
        Self { length: 1, pieces: Vec::new(), earliest: 0, changed: Mean::default() }
    }
}

impl Repetition {
    /// One more tick. Beyond a quarter of a million of them nothing is counted.
    pub fn push(&mut self, symptoms: &Symptoms) {
        if self.pieces.last().is_none_or(|piece| piece.ticks >= self.length) {
            if self.pieces.is_full() {
                self.join();
            }
            let _ = self.pieces.push(Piece::default());
        }
        let length = self.length;
        if let Some(piece) = self.pieces.last_mut().filter(|piece| piece.ticks < length) {
            piece.count(symptoms);
        }
    }

    /// One that begins on tick `begin`, or so many ticks earlier: nobody says so on the tick.
    pub fn begin(begin: u32, earlier: u32) -> Self {
        Self { earliest: begin.saturating_sub(earlier), ..Self::default() }
    }

    /// What the likelihood diagnosis says on a tick that an alarm has changed.
    #[inline]
    pub fn add(&mut self, changed: &Changed) {
        if changed.onset >= self.earliest {
            self.changed.add(&changed.effects);
        }
    }

    /// What it changes in the mean; `None` where the likelihood diagnosis never saw it.
    #[inline]
    pub fn effects(&self) -> Option<Effects> {
        self.changed.value()
    }

    /// Ticks so far.
    #[inline]
    pub fn ticks(&self) -> u32 {
        self.pieces.iter().map(|piece| u32::from(piece.ticks)).sum()
    }

    /// What is steady at its end; `None` before there is one.
    #[inline]
    pub fn steady(&self) -> Option<Steady> {
        let later = self.pieces.get(self.pieces.len().div_ceil(2)..)?;
        let sum = |of: &dyn Fn(&Piece) -> u16| later.iter().map(|piece| u32::from(of(piece))).sum::<u32>();
        let ticks = sum(&|piece| piece.ticks);
        if ticks == 0 {
            return None;
        }
        Some(core::array::from_fn(|i| {
            let (low, high) = (sum(&|piece| piece.low[i]), sum(&|piece| piece.high[i]));
            let counts = [(Symptom::Low, low), (Symptom::Normal, ticks - low - high), (Symptom::High, high)];
            counts.into_iter().find(|(_, count)| 100 * count >= STEADY * ticks).map(|(symptom, _)| symptom)
        }))
    }

    /// Two pieces become one.
    fn join(&mut self) {
        let Some(length) = self.length.checked_mul(2) else { return };
        self.length = length;
        self.pieces = self.pieces.chunks(2).map(Piece::joined).collect();
    }
}

impl Piece {
    fn count(&mut self, symptoms: &Symptoms) {
        self.ticks += 1;
        for (i, symptom) in symptoms.iter().enumerate() {
            self.low[i] += u16::from(*symptom == Symptom::Low);
            self.high[i] += u16::from(*symptom == Symptom::High);
        }
    }

    fn joined(pieces: &[Self]) -> Self {
        pieces.iter().fold(Self::default(), |sum, piece| Self {
            ticks: sum.ticks + piece.ticks,
            low: core::array::from_fn(|i| sum.low[i] + piece.low[i]),
            high: core::array::from_fn(|i| sum.high[i] + piece.high[i]),
        })
    }
}
