//! Settings, mark and commissioning over lives of a board that end in a power cut at any step, in the start that follows as
//! well: what is found is what was there before the step or after it.

#[allow(dead_code, reason = "its garbage is for the store's own tests")]
mod flash;

use core::future::Future;
use core::pin::pin;
use core::task::{Context, Poll, Waker};

use fdi_core::diagnosis::baseline::{Baseline, Normal};
use fdi_core::likelihood::Commissioned;
use fdi_core::{Celsius, Config};
use firmware_logic::settings::commissioning::Commissioning;
use firmware_logic::settings::store::{Origin, SaveError, Store};
use firmware_logic::settings::stored::Stored;
use flash::Sectors;

/// The mock never waits, so one poll is all it takes.
fn now<T>(future: impl Future<Output = T>) -> T {
    match pin!(future).poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(value) => value,
        Poll::Pending => panic!("the mock flash never waits"),
    }
}

struct Random(u64);

impl Random {
    fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    fn below(&mut self, limit: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 16) as usize % limit
    }
}

/// All that the flash holds.
#[derive(Clone, Debug, PartialEq)]
struct Kept {
    settings: Option<Stored>,
    mark: bool,
    commissioning: Option<Commissioning>,
}

enum Step {
    Save(Box<Stored>),
    Mark(bool),
    Keep(Option<Commissioning>),
}

impl Step {
    fn random(random: &mut Random) -> Self {
        match random.below(10) {
            0..5 => Self::Save(Box::new(settings(random))),
            5..9 => Self::Mark(random.below(2) == 0),
            _ => Self::Keep((random.below(3) > 0).then(|| commissioning(random))),
        }
    }

    fn take<const SECTOR: usize>(&self, store: &mut Store<Sectors<SECTOR>>) -> Result<(), SaveError> {
        match self {
            Self::Save(stored) => now(store.save(stored)),
            Self::Mark(stands) => now(store.mark(*stands)),
            Self::Keep(commissioning) => now(store.keep(commissioning.as_ref())),
        }
    }

    fn apply(&self, mut kept: Kept) -> Kept {
        match self {
            Self::Save(stored) => kept.settings = Some(Stored::clone(stored)),
            Self::Mark(stands) => kept.mark = *stands,
            Self::Keep(commissioning) => kept.commissioning = *commissioning,
        }
        kept
    }
}

/// Of different lengths.
fn settings(random: &mut Random) -> Stored {
    let mut config = Config { setpoint: Celsius(20.0 + random.below(400) as f32 * 0.1), ..Config::default() };
    if random.below(2) == 0 {
        config.diagnosis.isolation.clear();
    }
    let normal = Normal { mean: [0.5; 7], sigma: [0.25; 7] };
    let baseline =
        (random.below(2) == 0).then_some(Baseline { samples: 1637, raw: normal, filtered: normal });
    Stored { config, baseline }
}

fn commissioning(random: &mut Random) -> Commissioning {
    let parameters = core::array::from_fn(|i| 0.3 + i as f32);
    Commissioning { number: random.below(1000) as u32, models: Commissioned { parameters } }
}

/// A board from its start to its end: what it found, how many steps it took, and the flash then.
fn live<const SECTOR: usize>(
    flash: Sectors<SECTOR>,
    steps: &[Step],
) -> (Kept, Origin, usize, Sectors<SECTOR>) {
    let mut store = Store::new(flash);
    let (settings, origin) = now(store.load());
    let settings = (origin == Origin::Flash).then_some(settings);
    let found = Kept { settings, mark: now(store.is_marked()), commissioning: now(store.commissioning()) };
    let taken = steps.iter().take_while(|step| step.take(&mut store).is_ok()).count();
    (found, origin, taken, store.into_flash())
}

/// Several lives with the same flash; how many of them ended in a power cut amid an erasure. Each is lived twice: without a
/// cut, to see what is found and where a cut can be, and with it; most cuts are in or beside an erasure, where there is one.
fn lives<const SECTOR: usize>(
    seed: u64,
    count: usize,
    longest: usize,
    mut flash: Sectors<SECTOR>,
    kept: Kept,
) -> usize {
    let (mut random, mut in_erase) = (Random::new(seed), 0);
    let mut possible = vec![kept];
    for life in 0..count {
        let steps: Vec<Step> = (0..random.below(longest)).map(|_| Step::random(&mut random)).collect();
        (flash.steps, flash.cut_in_erase) = (0, false);
        flash.erased_at.clear();
        let (found, origin, taken, after) = live(flash.clone(), &steps);
        assert!(possible.contains(&found), "seed {seed}, life {life}: {}", told(&found, origin, &possible));
        assert_eq!(taken, steps.len(), "seed {seed}, life {life}: a step failed");
        let mut states = vec![found];
        states.extend(steps.iter().scan(states[0].clone(), |kept, step| {
            *kept = step.apply(kept.clone());
            Some(kept.clone())
        }));
        let at = match (after.steps, after.erased_at.as_slice()) {
            (0, _) => None,
            (_, erasures) if !erasures.is_empty() && random.below(4) > 0 => {
                let erasure = erasures[random.below(erasures.len())];
                Some((erasure + [2, 2, 2, 0, 1, 3, 4][random.below(7)]).saturating_sub(2))
            }
            (all, _) => (random.below(4) > 0).then(|| random.below(all)),
        };
        let Some(at) = at.filter(|at| *at < after.steps) else {
            flash = after;
            possible = states.split_off(states.len() - 1);
            continue;
        };
        flash.cut_at(at);
        let (.., taken, mut after) = live(flash, &steps);
        in_erase += usize::from(after.cut_in_erase);
        after.power_up();
        flash = after;
        possible = states.into_iter().skip(taken).take(2).collect();
    }
    in_erase
}

fn told(found: &Kept, origin: Origin, possible: &[Kept]) -> String {
    let short = |kept: &Kept| {
        let settings =
            kept.settings.as_ref().map(|stored| (stored.config.setpoint, stored.baseline.is_some()));
        format!("{settings:?}, mark {}, {:?}", kept.mark, kept.commissioning.as_ref().map(|kept| kept.number))
    };
    let possible: Vec<String> = possible.iter().map(short).collect();
    format!("{} ({origin}), not {}", short(found), possible.join(" or "))
}

const NOTHING: Kept = Kept { settings: None, mark: false, commissioning: None };

/// Sectors so small that most lives change them.
#[test]
fn whatever_is_cut_the_old_is_there_or_the_new() {
    let in_erase: usize = (0..100).map(|seed| lives(seed, 40, 30, Sectors::<4096>::new(), NOTHING)).sum();
    assert!(in_erase > 500, "{in_erase}");
}

/// With the sectors of the board, full but for the last record.
#[test]
fn full_sectors_of_the_board_are_changed_over_any_cut() {
    let mut random = Random::new(1);
    let mut kept = NOTHING;
    let mut store = Store::new(Sectors::<{ 128 * 1024 }>::new());
    let full = loop {
        let step = Step::Save(Box::new(settings(&mut random)));
        let before = store.into_flash();
        store = Store::new(before.clone());
        assert_eq!(step.take(&mut store), Ok(()));
        let after = store.into_flash();
        if after.erases > 0 {
            break before;
        }
        kept = step.apply(kept);
        store = Store::new(after);
    };
    let in_erase: usize = (0..30).map(|seed| lives(seed, 5, 8, full.clone(), kept.clone())).sum();
    assert!(in_erase > 10, "{in_erase}");
}
