//! Whatever the thermistors say during a check, it heats little, ends, and leaves output and contactor off; and nothing is
//! armed before one has passed.

#[path = "../output/mod.rs"]
mod output;
mod wirings;

use fdi_core::control::Controller;
use fdi_core::likelihood::Channel;
use fdi_core::sense::thermistor::{Thermistor, ThermistorConfig};
use fdi_core::{
    AdcCode, Celsius, Command, Config, Feedback, Mode, Percent, RawSample, Refusal, TripReason, Validity,
};
use firmware_logic::cadence::Arrival;
use firmware_logic::control_loop::{ControlLoop, Denial, Order, OrderKind, Outcome, TickRecord};
use firmware_logic::interlock::{Interlock, Lockout};
use firmware_logic::self_test::{CheckFinding, Ending, LEVELS, LONGEST, MAX_RISE, News, Progress};
use output::Output;
use proptest::prelude::*;

/// Where a thermistor may be; nowhere it stands still, in a draught it swings to and fro.
#[derive(Clone, Copy, Debug)]
enum Place {
    Room,
    Outlet,
    Behind,
    Nowhere,
    Draught,
}

const RIGHT: [Place; 3] = [Place::Room, Place::Outlet, Place::Behind];

/// A board with a rig of two lags behind it.
struct Bench {
    control: ControlLoop,
    output: Output,
    progress: Progress,
    thermistor: Thermistor,
    /// degC per %.
    gain: f32,
    /// What reaches the heater, %.
    heats: fn(&Output) -> f32,
    /// The place that each thermistor is at.
    places: [Place; 3],
    /// Rises of the air, T1 and T2, degC; ticks so far.
    rises: [f32; 3],
    ticks: u32,
}

impl Bench {
    fn new(config: &Config) -> Self {
        let controller = Controller::new(config).expect("valid");
        Self {
            control: ControlLoop::new(controller, config.setpoint, Interlock::default()),
            output: Output::default(),
            progress: Progress::default(),
            thermistor: Thermistor::new(&ThermistorConfig::default(), 0).expect("valid"),
            gain: 0.3,
            heats: Output::given,
            places: RIGHT,
            rises: [0.0; 3],
            ticks: 0,
        }
    }

    /// The codes of the rig, with a little noise.
    fn codes(&mut self) -> RawSample {
        self.ticks += 1;
        let power = (self.heats)(&self.output);
        let [air, t1, t2] = &mut self.rises;
        *air += (self.gain * power - *air) / 4.0;
        *t1 += (*air - *t1) / 2.0;
        *t2 += (0.9 * *t1 - *t2) / 4.0;
        let noise = [0.01, -0.02, 0.03, 0.0, -0.03, 0.02, -0.01][self.ticks as usize % 7];
        let [t0, t1, t2] = self.places.map(|place| {
            let above = match place {
                Place::Room => noise,
                Place::Outlet => self.rises[1] + noise,
                Place::Behind => self.rises[2] + noise,
                Place::Nowhere => 0.0,
                Place::Draught if (self.ticks / 13).is_multiple_of(2) => 0.3,
                Place::Draught => -0.3,
            };
            self.thermistor.code(Celsius(22.5 + above))
        });
        RawSample { t0, t1, t2, ..RawSample::default() }
    }

    fn step(&mut self, raw: RawSample, order: Option<Order>) -> TickRecord {
        let record = self.control.tick(raw, Arrival::default(), order, Feedback::default(), &mut self.output);
        assert_eq!(record.applied.0, self.output.given());
        self.progress_of(&record);
        record
    }

    fn progress_of(&mut self, record: &TickRecord) {
        if let Some(news) = record.news {
            self.progress.note(news);
        }
    }

    fn tick(&mut self) -> TickRecord {
        let raw = self.codes();
        self.step(raw, None)
    }

    fn pass(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.tick();
        }
    }

    /// Until that is seen, which a check of any length brings about.
    fn pass_until(&mut self, seen: impl Fn(&Self) -> bool) {
        for _ in 0..LONGEST + 20 {
            if seen(self) {
                return;
            }
            self.tick();
        }
        panic!("endless: {:?}", self.progress);
    }

    fn order(&mut self, order: Order) -> Result<(), Denial> {
        let raw = self.codes();
        self.step(raw, Some(order)).outcome.expect("an order has an outcome").result
    }

    fn arm(&mut self) -> Result<(), Denial> {
        self.order(Order::Command(Command::Arm))
    }

    /// Lets a check run to its end.
    fn check(&mut self) -> Ending {
        assert_eq!(self.order(Order::Check), Ok(()));
        self.pass_until(|bench| bench.progress.ending.is_some() && bench.progress.stage.is_none());
        self.progress.ending.expect("it has ended")
    }
}

#[test]
fn arms_only_after_a_check_has_passed_and_not_after_one_that_has_not() {
    let mut bench = Bench::new(&Config::default());
    assert_eq!(bench.arm(), Err(Denial::Unchecked));
    assert_eq!(bench.order(Order::Command(Command::Tune)), Err(Denial::Unchecked));
    assert!(bench.output.is_off());
    assert_eq!(bench.check(), Ending::Passed, "{:?}", bench.progress);
    assert_eq!(bench.arm(), Ok(()));
    assert!(bench.tick().checked);
    assert_eq!(bench.order(Order::Command(Command::Stop)), Ok(()));
    bench.pass(200); // cools
    assert_eq!(bench.order(Order::Check), Ok(()));
    assert_eq!(bench.arm(), Err(Denial::Checking));
    assert_eq!(bench.order(Order::Check), Err(Denial::Checking), "not begun anew");
    assert_eq!(bench.order(Order::Command(Command::Tune)), Err(Denial::Checking));
    assert_eq!(bench.order(Order::Command(Command::Stop)), Ok(()));
    bench.pass(10);
    assert_eq!(bench.arm(), Err(Denial::Unchecked), "a check that was stopped has not passed");
}

#[test]
fn the_waiver_arms_without_a_check_and_the_beat_says_so() {
    let mut config = Config::default();
    config.supervisor.check_before_arming = false;
    let mut bench = Bench::new(&config);
    assert_eq!(bench.arm(), Ok(()));
    assert!(!bench.tick().checked);
}

#[test]
fn a_check_begins_only_at_rest() {
    let mut config = Config::default();
    config.supervisor.check_before_arming = false;
    let mut bench = Bench::new(&config);
    assert_eq!(bench.arm(), Ok(()));
    assert_eq!(bench.order(Order::Check), Err(Denial::Refused(Refusal::NotInMode("settle"))));
    assert!(bench.tick().tick.mode.is_heating(), "a refused order changes nothing");
}

#[test]
fn the_contact_of_the_interlock_is_proved_when_it_is_seen_open() {
    let mut bench = Bench::new(&Config::default());
    for _ in 0..2 {
        assert_eq!(bench.check(), Ending::Passed);
        assert_eq!(bench.progress.findings, [CheckFinding::CutNotSeen], "said, as nobody has opened it");
    }
    bench.output.open = true;
    assert_eq!(bench.check(), Ending::Failed(1));
    assert_eq!(bench.progress.findings, [CheckFinding::InterlockOpen]);
    bench.output.open = false;
    assert_eq!(bench.check(), Ending::Passed);
    assert_eq!(bench.progress.findings, []);
}

/// Opened while it heats, and then acknowledged; a deadline that was missed proves nothing of the contact.
#[test]
fn the_contact_of_the_interlock_is_proved_when_it_has_cut_while_heating() {
    let mut config = Config::default();
    config.supervisor.check_before_arming = false;
    for (missed_deadline, said) in [(false, None), (true, Some(CheckFinding::CutNotSeen))] {
        let mut bench = Bench::new(&config);
        assert_eq!(bench.arm(), Ok(()));
        (bench.output.missed_deadline, bench.output.enabled) = (missed_deadline, false);
        assert!(bench.tick().lockout.is_some());
        assert_eq!(bench.order(Order::Command(Command::Acknowledge)), Ok(()));
        assert_eq!(bench.check(), Ending::Passed);
        assert_eq!(bench.progress.findings.first().copied(), said);
    }
}

#[test]
fn a_rig_that_is_too_strong_is_left_alone_before_it_is_hot() {
    let mut bench = Bench { gain: 4.0, ..Bench::new(&Config::default()) };
    assert_eq!(bench.check(), Ending::Failed(1));
    let found = bench.progress.findings.last();
    assert!(
        matches!(found, Some(CheckFinding::TooHot(Channel::T1, by)) if *by < MAX_RISE + 2.0),
        "{found:?}"
    );
}

/// What can end a check early, and what it is then said to be.
type WayOut = (&'static str, fn(&mut Bench), Option<Ending>);

const WAYS_OUT: [WayOut; 6] = [
    ("stop", |bench| assert_eq!(bench.order(Order::Command(Command::Stop)), Ok(())), Some(Ending::Stopped)),
    (
        "break",
        |bench| {
            (bench.output.open, bench.output.enabled) = (true, false);
            bench.tick();
        },
        None, // seen only while the output should be on
    ),
    (
        "missed tick",
        |bench| {
            let record = bench.control.missed(Arrival::default(), &mut bench.output);
            bench.progress_of(&record);
        },
        Some(Ending::MissedTick),
    ),
    (
        "settings",
        |bench| {
            let controller = Controller::new(&Config::default()).expect("valid");
            assert_eq!(bench.order(Order::Retune(controller)), Ok(()));
        },
        Some(Ending::Settings),
    ),
    (
        "T1 broken",
        |bench| {
            let raw = RawSample { t1: AdcCode(4090.0), ..bench.codes() };
            for _ in 0..60 {
                bench.step(raw, None);
            }
        },
        Some(Ending::Failed(1)),
    ),
    (
        "T2 hot",
        |bench| {
            let raw = RawSample { t2: bench.thermistor.code(Celsius(95.0)), ..bench.codes() };
            for _ in 0..300 {
                bench.step(raw, None);
            }
        },
        None, // before it heats a jump and a thermistor that is far off, then a rise
    ),
];

#[test]
fn every_way_out_leaves_output_and_contactor_off_whenever_it_is_taken() {
    for (name, leave, expected) in WAYS_OUT {
        for after in (0..700).step_by(13) {
            let mut bench = Bench::new(&Config::default());
            assert_eq!(bench.order(Order::Check), Ok(()));
            bench.pass(after);
            if bench.progress.stage.is_none() {
                continue;
            }
            let heated = bench.output.enabled;
            leave(&mut bench);
            if name == "break" && !heated {
                continue;
            }
            assert!(bench.output.is_off(), "{name} after {after} ticks: {:?}", bench.output);
            bench.pass(10);
            assert!(bench.output.is_off(), "{name} after {after} ticks, later");
            let ending = bench.progress.ending;
            assert!(
                ending.is_some() && ending != Some(Ending::Passed),
                "{name} after {after} ticks: {ending:?}"
            );
            assert!(expected.is_none() || ending == expected, "{name} after {after} ticks: {ending:?}");
            bench.output.open = false;
            assert!(bench.arm().is_err(), "{name} after {after} ticks: armed");
        }
    }
}

#[test]
fn an_open_interlock_while_checking_is_a_hold() {
    let mut bench = Bench::new(&Config::default());
    assert_eq!(bench.order(Order::Check), Ok(()));
    bench.pass_until(|bench| bench.output.enabled);
    (bench.output.open, bench.output.enabled) = (true, false);
    assert_eq!(bench.tick().lockout, Some(Lockout::BreakInput));
    bench.output.open = false;
    assert_eq!(bench.order(Order::Check), Err(Denial::LockedOut(Lockout::BreakInput)));
}

/// Lets a check run until it heats.
fn checking_and_heating() -> Bench {
    let mut bench = Bench::new(&Config::default());
    assert_eq!(bench.order(Order::Check), Ok(()));
    bench.pass_until(|bench| bench.output.given() > 0.0);
    bench
}

/// A fan that is announced to stand still would trip at any set-point.
#[test]
fn what_would_trip_ends_a_check_in_its_tick() {
    let mut bench = checking_and_heating();
    assert_eq!(bench.order(Order::Command(Command::Fan(Percent(0.0)))), Ok(()));
    assert!(bench.output.is_off());
    bench.pass(10);
    assert_eq!(bench.progress.ending, Some(Ending::Failed(1)));
    let found = bench.progress.findings.last();
    assert_eq!(found, Some(&CheckFinding::Hazard(TripReason::AirFlowLost)));

    let mut bench = Bench::new(&Config::default());
    assert_eq!(bench.order(Order::Command(Command::Fan(Percent(0.0)))), Ok(()));
    assert_eq!(bench.order(Order::Check), Ok(()));
    bench.pass_until(|bench| {
        assert!(bench.output.is_off(), "nor does it begin to heat where that was announced before");
        bench.progress.ending.is_some()
    });
    assert_eq!(bench.progress.findings.last(), Some(&CheckFinding::Hazard(TripReason::AirFlowLost)));
}

/// Five ticks without a code may be, a sixth is one too many, whichever thermistor it is.
#[test]
fn a_thermistor_that_is_lost_ends_a_check() {
    type Lose = fn(&mut RawSample);
    let channels: [(Channel, Lose); 2] = [
        (Channel::T0, |raw| raw.t0 = AdcCode(f32::NAN)),
        (Channel::T2, |raw| raw.t2 = AdcCode(f32::NAN)), // without T1 the supervisor would trip
    ];
    for (channel, lose) in channels {
        let mut bench = checking_and_heating();
        let mut lost_for = |ticks| {
            for _ in 0..ticks {
                let mut raw = bench.codes();
                lose(&mut raw);
                bench.step(raw, None);
            }
            let off = bench.output.is_off();
            bench.tick();
            off
        };
        assert!(!lost_for(5) && !lost_for(5) && lost_for(6), "{channel:?}");
        bench.pass(10);
        let broken = CheckFinding::Broken(channel, Validity::Missing);
        assert_eq!(bench.progress.findings.last(), Some(&broken));
        assert_eq!(bench.progress.ending, Some(Ending::Failed(1)));
    }
}

/// Codes as they should be, a little off, or anything at all.
fn any_code() -> impl Strategy<Value = f32> {
    prop_oneof![8 => 2150.0f32..2170.0, 3 => 1500.0f32..2600.0, 1 => any::<f32>(), 1 => Just(f32::NAN), 1 => Just(4095.0f32)]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    /// Any codes: little power, an end in bounded time, and everything off then.
    #[test]
    fn any_codes_are_heated_little_and_not_for_long(
        wild in prop::collection::vec((any_code(), any_code(), any_code()), 1..80),
        from in 0u32..1200, rarely in 1u32..300,
    ) {
        let mut bench = Bench::new(&Config::default());
        prop_assert_eq!(bench.order(Order::Check), Ok(()));
        let mut ended = false;
        for tick in 0..LONGEST + 20 {
            let calm = bench.codes();
            let (t0, t1, t2) = wild[tick as usize % wild.len()];
            let raw = RawSample { t0: AdcCode(t0), t1: AdcCode(t1), t2: AdcCode(t2), ..RawSample::default() };
            let record = bench.step(if tick >= from && tick % rarely == 0 { raw } else { calm }, None);
            let Output { power, enabled, .. } = bench.output;
            prop_assert!((0.0..=LEVELS[3]).contains(&power), "{} %", power);
            prop_assert!(record.applied.0 <= LEVELS[3]);
            prop_assert!(!ended || (!enabled && bench.output.is_off()), "heats after its end");
            ended |= matches!(record.news, Some(News::Ended(_)));
            prop_assert!(matches!(record.tick.mode, Mode::Off | Mode::Tripped(_)));
        }
        prop_assert!(ended, "{:?}", bench.progress);
    }
}

/// Whatever the times of the rig are, the controller is told its gain, once, before anybody can have armed it by the check's end.
#[test]
fn the_gain_that_the_check_has_measured_reaches_the_controller() {
    let mut bench = Bench::new(&Config::default());
    assert_eq!(bench.order(Order::Check), Ok(()));
    let told: Vec<_> = (0..2 * LONGEST).filter_map(|_| bench.tick().outcome).collect();
    let [Outcome { order: OrderKind::Command(Command::Gain(gain)), result: Ok(()) }] = told[..] else {
        panic!("{told:?}")
    };
    assert!((gain / 0.3 - 1.0).abs() < 0.25, "{gain}");
}
