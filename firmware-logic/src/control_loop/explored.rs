//! All that orders, samples and the chip can do to the loop, one after the other, in every order that leads to something new: whatever comes,
//! nothing heats that is locked out, that no check has passed for, or that nobody has armed.
//!
//! The loop is the real one, its times shortened. What is compared of two of them is all that decides (modes, latches, permission, the check,
//! what is dangerous, the last sample), without the filters' decimals: of those that are equal in it the first stands for all.

use std::collections::{BTreeSet, HashSet, VecDeque};
use std::format;
use std::string::String;
use std::vec::Vec;

use fdi_core::diagnosis::baseline::Normal;
use fdi_core::sense::thermistor::{Thermistor, ThermistorConfig};
use fdi_core::{Celsius, Config, Seconds};

use super::tests::Output;
use super::*;
use crate::self_test::{LONGEST, News};

/// What happens, a tick each.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Happens {
    /// A tick with these samples, and an order.
    Tick(Seen, Option<Asked>),
    /// The check goes on to its next stage.
    Pass,
    /// The interlock opens, the tick comes late, somebody stops before the tick: the chip switches off.
    Opens,
    Closes,
    Deadline,
    StopsAtOnce,
    /// The clock is wrong; a kept setting has changed; no tick; a look at a T1 that is too hot.
    LocksOut,
    Damage,
    Missed,
    Look,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Seen {
    Rig,
    Broken,
    Hot,
    Nothing,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Asked {
    Check,
    Arm,
    Tune,
    Stop,
    Acknowledge,
    Relearn,
}

impl Asked {
    fn order(self) -> Order {
        match self {
            Self::Check => Order::Check,
            Self::Arm => Order::Command(Command::Arm),
            Self::Tune => Order::Command(Command::Tune),
            Self::Stop => Order::Command(Command::Stop),
            Self::Acknowledge => Order::Command(Command::Acknowledge),
            Self::Relearn => Order::Command(Command::Relearn),
        }
    }
}

const ALL: [Happens; 24] = {
    use Asked::*;
    use Happens::*;
    use Seen::*;
    [
        Tick(Rig, None),
        Tick(Broken, None),
        Tick(Hot, None),
        Tick(Nothing, None),
        Tick(Rig, Some(Check)),
        Tick(Rig, Some(Arm)),
        Tick(Rig, Some(Tune)),
        Tick(Rig, Some(Stop)),
        Tick(Rig, Some(Acknowledge)),
        Tick(Rig, Some(Relearn)),
        Tick(Broken, Some(Arm)),
        Tick(Hot, Some(Arm)),
        Tick(Nothing, Some(Arm)),
        Tick(Broken, Some(Acknowledge)),
        Tick(Hot, Some(Check)),
        Pass,
        Opens,
        Closes,
        Deadline,
        StopsAtOnce,
        LocksOut,
        Damage,
        Missed,
        Look,
    ]
};

/// What is true, as far as it can be told without the loop.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Truth {
    /// Somebody has armed it, or begun a check, and nothing has ended that since.
    armed: bool,
    checking: bool,
    passed: bool,
    /// Something has cut, and nobody has acknowledged; for good where memory is damaged.
    locked: bool,
    damaged: bool,
}

/// A board with a rig of two lags behind it.
#[derive(Clone)]
struct Bench {
    control: ControlLoop,
    output: Output,
    truth: Truth,
    rises: [f32; 3],
    ticks: u32,
    /// The last sample, and the ticks since it was armed, up to those that can matter.
    seen: Seen,
    since: u32,
    /// All that has happened.
    before: Vec<Happens>,
}

impl Bench {
    fn new(config: &Config) -> Self {
        let controller = Controller::new(config).expect("valid");
        let mut control = ControlLoop::new(controller, config.setpoint, Interlock::default());
        // Until it is told to learn anew, it monitors as soon as it has settled.
        let normal = Normal { mean: [0.0; 7], sigma: [1.0; 7] };
        control.restored(&Baseline { samples: 1000, raw: normal, filtered: normal });
        Self {
            control,
            output: Output::default(),
            truth: Truth::default(),
            rises: [0.0; 3],
            ticks: 0,
            seen: Seen::Rig,
            since: 0,
            before: Vec::new(),
        }
    }

    fn codes(&mut self, thermistor: &Thermistor, seen: Seen) -> RawSample {
        self.ticks += 1;
        self.seen = seen;
        let [air, t1, t2] = &mut self.rises;
        *air += (0.3 * self.output.given() - *air) / 4.0;
        *t1 += (*air - *t1) / 2.0;
        *t2 += (0.9 * *t1 - *t2) / 4.0;
        let noise = [0.01, -0.02, 0.03, 0.0, -0.03, 0.02, -0.01][self.ticks as usize % 7];
        let [t0, t1, t2] =
            [0.0, self.rises[1], self.rises[2]].map(|rise| thermistor.code(Celsius(22.5 + rise + noise)));
        let raw = RawSample { t0, t1, t2, ..RawSample::default() };
        match seen {
            Seen::Rig => raw,
            Seen::Broken => RawSample { t1: AdcCode(4095.0), ..raw },
            Seen::Hot => RawSample { t1: thermistor.code(Celsius(100.0)), ..raw },
            Seen::Nothing => NO_SAMPLE,
        }
    }

    /// What happens next, and what is true then.
    fn happens(&mut self, thermistor: &Thermistor, what: Happens) {
        self.before.push(what);
        match what {
            Happens::Tick(seen, asked) => self.tick(thermistor, seen, asked),
            Happens::Pass => {
                let stage = |bench: &Self| bench.control.check.as_ref().map(SelfTest::stage);
                let before = stage(self);
                for _ in 0..LONGEST {
                    self.tick(thermistor, Seen::Rig, None);
                    if stage(self) != before {
                        break;
                    }
                }
            }
            Happens::Opens => {
                self.output.open = true;
                self.cut();
                self.tick(thermistor, Seen::Rig, None);
            }
            Happens::Closes => self.output.open = false,
            Happens::Deadline => {
                self.cut();
                self.tick(thermistor, Seen::Rig, None);
            }
            Happens::StopsAtOnce => {
                self.output.enabled = false;
                self.tick(thermistor, Seen::Rig, Some(Asked::Stop));
            }
            Happens::LocksOut => {
                self.control.lock_out(Lockout::WrongClock, &mut self.output);
                self.truth.locked = true;
                self.truth.ends();
                self.tick(thermistor, Seen::Rig, None);
            }
            Happens::Damage => {
                (self.truth.locked, self.truth.damaged) = (true, true);
                self.truth.ends();
                self.tick(thermistor, Seen::Rig, None);
            }
            Happens::Missed => {
                let record = self.control.missed(Arrival::default(), &mut self.output);
                self.truth.checking = false;
                self.follow(&record);
            }
            Happens::Look => {
                let raw = self.codes(thermistor, Seen::Hot);
                self.control.look(raw, &mut self.output);
                assert!(self.output.given() == 0.0, "hot, and seen");
            }
        }
    }

    /// The chip switches off what is on.
    fn cut(&mut self) {
        if std::mem::take(&mut self.output.enabled) {
            self.truth.locked = true;
            self.truth.ends();
        }
    }

    fn tick(&mut self, thermistor: &Thermistor, seen: Seen, asked: Option<Asked>) {
        let raw = self.codes(thermistor, seen);
        let damaged = self.truth.damaged; // for good: a reset alone mends it
        let feedback = Feedback { settings_damaged: damaged, ..Feedback::default() };
        // What is asked for before is true before the tick.
        match asked {
            Some(Asked::Stop) => self.truth.ends(),
            Some(Asked::Acknowledge) => self.truth.locked = damaged,
            _ => {}
        }
        let order = asked.map(Asked::order);
        let record = self.control.tick(raw, Arrival::default(), order, feedback, &mut self.output);
        let carried_out = record.outcome.is_some_and(|outcome| outcome.result.is_ok());
        match asked.filter(|_| carried_out) {
            Some(Asked::Check) => (self.truth.checking, self.truth.passed) = (true, false),
            Some(Asked::Arm | Asked::Tune) => (self.truth.armed, self.since) = (true, 0),
            _ => {}
        }
        if seen == Seen::Broken {
            self.truth.armed = false;
        }
        self.follow(&record);
    }

    /// Trips and ends that the loop reports end what was armed; what it drives then must be allowed.
    fn follow(&mut self, record: &TickRecord) {
        self.since = (self.since + 1).min(MATTERS);
        match record.news {
            Some(News::Ended(Ending::Passed)) => (self.truth.checking, self.truth.passed) = (false, true),
            Some(News::Ended(_)) => self.truth.checking = false,
            _ => {}
        }
        if !record.tick.mode.is_heating() {
            self.truth.armed = false;
        }
        let Truth { armed, checking, passed, locked, damaged } = self.truth;
        let heats = self.output.given() > 0.0;
        let must = |holds: bool, why: &str| assert!(holds, "{why}: {:?}", self.before);
        must(record.checked == passed, "the check that has passed");
        must(!heats || !self.output.open, "the interlock is open");
        must(!heats || !(locked || damaged), "locked out");
        must(!heats || (armed && passed) || checking, "not armed, or unchecked");
        must(!self.output.enabled || armed || checking, "enabled, and nobody has asked for it");
    }

    /// All that decides what comes.
    fn key(&self) -> String {
        let ControlLoop {
            controller,
            state,
            interlock,
            permit,
            driving,
            check,
            checked,
            seen_to_cut,
            hazard,
            ..
        } = &self.control;
        let mode = match controller.mode(state) {
            Mode::Tripped(trip) => (trip.reason.name(), 0),
            Mode::Settle { steady } => ("settle", (*steady).min(MATTERS)),
            mode => (mode.name(), 0),
        };
        let check = check.as_ref().map(|check| (check.stage(), check.ending(), check.is_reported()));
        format!(
            "{mode:?} {:?} {interlock:?} {permit:?} {driving} {check:?} {checked:?} {seen_to_cut} {} {:?} {:?} {:?} {} {:?}",
            controller.hazard(state),
            hazard.is_some(),
            self.truth,
            self.seen,
            (self.output.enabled, self.output.contactor, self.output.power > 0.0, self.output.open),
            self.since,
            self.rises.iter().any(|rise| *rise > 0.1),
        )
    }
}

impl Truth {
    fn ends(&mut self) {
        (self.armed, self.checking) = (false, false);
    }
}

/// Ticks after arming until every time of the settings below is over.
const MATTERS: u32 = 4;

fn shortened() -> Config {
    // So near to the room that it is regulated at once.
    let mut config = Config { setpoint: Celsius(23.5), ..Config::default() };
    let s = &mut config.supervisor;
    (s.learn_start, s.regulation_time, s.signal_timeout) = (Seconds(0.2), Seconds(0.2), Seconds(0.2));
    config
}

#[test]
fn no_sequence_heats_that_is_locked_out_unchecked_or_not_armed() {
    let thermistor = Thermistor::new(&ThermistorConfig::default(), 0).expect("valid");
    let begin = Bench::new(&shortened());
    let (mut known, mut waiting) = (HashSet::from([begin.key()]), VecDeque::from([begin]));
    let (mut modes, mut steps, mut heat) = (BTreeSet::new(), 0, 0);
    while let Some(bench) = waiting.pop_front() {
        for what in ALL {
            let mut next = bench.clone();
            next.happens(&thermistor, what);
            steps += 1;
            heat += usize::from(next.output.given() > 0.0);
            modes.insert(next.control.controller.mode(&next.control.state).name());
            if known.insert(next.key()) {
                waiting.push_back(next);
            }
        }
    }
    std::println!("{} states, {steps} steps, {heat} end with heat", known.len());
    assert!(known.len() > 1000 && heat > 100);
    assert_eq!(modes, BTreeSet::from(Mode::NAMES), "all were reached");
}
