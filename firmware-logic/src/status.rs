//! How the instrument is, in a few lines for people.

use core::fmt;

use fdi_core::likelihood::{Readiness, RejectReason, SinceCommissioning};
use fdi_core::name::Name;
use fdi_core::tune::Standing;
use fdi_core::{KnownInputs, Mode, Percent, Reading, Report, Validity};

use crate::cadence::Jitter;
use crate::control_loop::TickRecord;
use crate::decimal::Fixed;
use crate::history::Called;
use crate::interlock::Lockout;
use crate::led::Sign;
use crate::self_test::Progress;

/// Health of the board.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Health {
    /// Jitter of the control tick.
    pub jitter: Jitter,
    /// Ticks that the diagnosis never saw.
    pub records_lost: u32,
    /// Frames of the log that did not fit.
    pub log_dropped: u32,
    /// Lines of the stream that did not fit.
    pub stream_dropped: u32,
    /// Most bytes of stack ever used.
    pub stack_used: u32,
    /// Bytes of stack.
    pub stack_size: u32,
}

/// What the last tick said.
#[derive(Clone, Debug, Default)]
pub struct Status {
    /// TickRecord and report of the last tick; `None` before the first.
    pub last: Option<(TickRecord, Report)>,
    /// Health of the board.
    pub health: Health,
    /// What the self-test has told so far.
    pub check: Progress,
    /// How far the experiment of `tune` has come, or how the last one ended.
    pub tuning: Option<Standing>,
    /// What a user calls the fault that fdv and fiv give.
    pub named: Name,
    /// What a user calls the fault that was taught to the likelihood diagnosis and that it sees.
    pub taught: Name,
    /// The commissioning, where there was one.
    pub commissioned: Option<Since>,
    /// Codes come from the port, and the outputs are locked off.
    pub simulated: bool,
}

/// A commissioning, and what has become of the rig since.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Since {
    /// Its number.
    pub number: u32,
    /// What has changed, where anything is trained now.
    pub change: Option<SinceCommissioning>,
}

impl fmt::Display for Since {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "commissioning {}", self.number)?;
        let Some(SinceCommissioning { rise }) = self.change else { return Ok(()) };
        let (percent, word) = if rise < 0.0 { (-100.0 * rise, "less") } else { (100.0 * rise, "more") };
        write!(f, ": since then the same power warms by {} % {word}", Fixed(percent, 1))
    }
}

impl Status {
    /// Whether a self-test has passed since the start.
    pub fn is_checked(&self) -> bool {
        self.last.as_ref().is_some_and(|(record, _)| record.checked)
    }

    /// Whether a trip or a lockout keeps the heater off.
    pub fn is_latched(&self) -> bool {
        let tripped = |(record, _): &(TickRecord, Report)| matches!(record.tick.mode, Mode::Tripped(_));
        self.lockout().is_some() || self.last.as_ref().is_some_and(tripped)
    }

    /// Whether the heater may be on, or a self-test be under way, which is off only between its pulses.
    pub fn may_heat(&self) -> bool {
        self.is_heating() || self.check.stage.is_some()
    }

    /// What the LED should say.
    pub fn sign(&self) -> Sign {
        let Some((_, report)) = &self.last else { return Sign::Off };
        let alarm = report.likelihood.alarm && !report.likelihood.advice;
        let faulty = alarm || report.filtered.is_some_and(|verdict| verdict.fdv != 0);
        match (self.is_latched(), self.may_heat()) {
            (true, _) => Sign::Latched,
            (false, true) if faulty => Sign::Alarm,
            (false, true) => Sign::Heating,
            (false, false) => Sign::Off,
        }
    }

    /// What holds the heater off.
    pub fn lockout(&self) -> Option<Lockout> {
        self.last.as_ref().and_then(|(record, _)| record.lockout)
    }

    /// Whether the heater may be on.
    pub fn is_heating(&self) -> bool {
        self.last.as_ref().is_some_and(|(record, _)| record.tick.mode.is_heating())
    }
}

/// How it is, in one line: what the log says each second.
pub struct StatusLine<'a>(pub &'a Status);

impl fmt::Display for StatusLine<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some((record, report)) = &self.0.last else { return f.write_str("no tick yet") };
        let (tick, sample) = (&record.tick, &record.tick.sample);
        let [t0, t1, t2] = [sample.t0, sample.t1, sample.t2].map(|reading| Fixed(reading.celsius.0, 2));
        let (setpoint, heater) = (Fixed(tick.setpoint.0, 1), Fixed(record.applied.0, 2));
        write!(
            f,
            "{} T0 {t0} T1 {t1} T2 {t2} of {setpoint} degC, heater {heater} %, gain",
            tick.mode.name()
        )?;
        number(f, report.ms1.static_gain, 3)?;
        f.write_str(" bandwidth")?;
        number(f, report.ms1.bandwidth, 2)?;
        let (fdv, fiv): (u32, u32) =
            report.filtered.map_or((0, 0), |verdict| (verdict.fdv.into(), verdict.fiv.into()));
        write!(f, ", fdv {fdv} fiv {fiv}")?;
        f.write_str(if self.0.simulated { ", simulated" } else { "" })
    }
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.simulated {
            writeln!(f, "SIMULATED: codes come from the port, both outputs are locked off until a reset")?;
        }
        let Some((record, report)) = &self.last else { return f.write_str("no tick yet") };
        let tick = &record.tick;
        write!(f, "mode {}", tick.mode.name())?;
        if let Mode::Tripped(trip) = tick.mode {
            write!(f, " ({}), `ack` when its cause has gone", trip.reason.words())?;
        }
        if let Some(lockout) = record.lockout {
            write!(f, ", heater locked out: {lockout}; `ack` to release")?;
        }
        if let Some(stage) = self.check.stage {
            let wrong = self.check.findings.iter().filter(|finding| !finding.is_note()).count();
            write!(f, ", check under way: {}, found wrong: {wrong}", stage.name())?;
        }
        if let Some(standing) = tick.tuning {
            write!(f, ": {}", standing.words())?;
        }
        if let Some(blocker) = tick.blocked {
            write!(f, ", not learning: {}", blocker.words())?;
        }
        let sample = &tick.sample;
        let [t0, t1, t2] = [sample.t0, sample.t1, sample.t2].map(ReadingText);
        let Percent(drive) = record.applied;
        write!(
            f,
            "\nT0 {t0}, T1 {t1} of {} degC, T2 {t2}, heater {} %",
            Fixed(tick.setpoint.0, 1),
            Fixed(drive, 1)
        )?;
        known(f, &tick.known)?;
        f.write_str("\ngain")?;
        number(f, report.ms1.static_gain, 3)?;
        number(f, report.ms2.static_gain, 3)?;
        f.write_str(" degC/%, bandwidth")?;
        number(f, report.ms1.bandwidth, 2)?;
        write!(f, " rad/s, learnt from {} samples", report.learned)?;
        if let Some(verdict) = &report.filtered {
            let (fdv, fiv) = (u32::from(verdict.fdv), u32::from(verdict.fiv));
            write!(f, "\nfdv {fdv} fiv {fiv}{}", Called(self.named))?;
        }
        f.write_str("\nlikelihood diagnosis ")?;
        f.write_str(readiness(report.likelihood.readiness))?;
        if report.likelihood.restarts > 0 {
            write!(f, ", begun anew {} times", report.likelihood.restarts)?;
        }
        if report.likelihood.alarm {
            let class = report.likelihood.finding.map_or("alarm", |finding| finding.class.name());
            let advice = if report.likelihood.advice { ", advice" } else { "" };
            write!(f, "{advice}: {class}{}", Called(self.taught))?;
        }
        if let Some(since) = self.commissioned {
            write!(f, "\n{since}")?;
        }
        write!(f, "\n{}", self.health)
    }
}

impl Health {
    /// Whether it is worth a line of the log: something was lost, or about a minute has passed since the last.
    pub fn is_worth_a_line(&self) -> bool {
        let Jitter { ticks, missed, .. } = self.jitter;
        ticks.is_multiple_of(600) || missed > 0 || self.records_lost > 0 || self.log_dropped > 0
    }
}

impl fmt::Display for Health {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let p = &self.jitter;
        write!(
            f,
            "ticks {} missed {} worst {} us late, diagnosis lost {}, log dropped {}, stream dropped {}, stack {} of {} bytes",
            p.ticks,
            p.missed,
            p.worst_us,
            self.records_lost,
            self.log_dropped,
            self.stream_dropped,
            self.stack_used,
            self.stack_size
        )
    }
}

/// How far the likelihood diagnosis has come.
pub const fn readiness(readiness: Readiness) -> &'static str {
    match readiness {
        Readiness::Untrained => "not trained",
        Readiness::Training => "in training",
        Readiness::Refused(RejectReason::Unstable) => "refused: a model is unstable",
        Readiness::Refused(RejectReason::Gain) => "refused: a gain is not positive",
        Readiness::Refused(RejectReason::PoorFit) => "refused: the models fit badly",
        Readiness::Refused(RejectReason::DeadTime) => {
            "refused: the dead time is too long for this sample time"
        }
        Readiness::Armed => "armed",
        Readiness::Restarted => "begun anew: its memory held what is no number",
    }
}

fn number(f: &mut fmt::Formatter<'_>, x: Option<f32>, decimals: u8) -> fmt::Result {
    match x {
        Some(x) => write!(f, " {}", Fixed(x, decimals)),
        None => f.write_str(" ?"),
    }
}

/// What is known of the rig's other inputs, where anything is.
fn known(f: &mut fmt::Formatter<'_>, known: &KnownInputs) -> fmt::Result {
    if let Some(share) = known.supply {
        write!(f, "\nsupply {} % of nominal", Fixed(100.0 * share, 1))?;
    }
    if known.supply_lost > 0 {
        write!(f, "\nsupply not read on {} ticks", known.supply_lost)?;
    }
    known.fan.map_or(Ok(()), |level| write!(f, "\nfan at {} %, as announced", Fixed(level.0, 1)))
}

/// A reading, with its doubts.
struct ReadingText(Reading);

impl fmt::Display for ReadingText {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Fixed(self.0.celsius.0, 2).fmt(f)?;
        match self.0.validity {
            Validity::Good => Ok(()),
            doubt => write!(f, " ({doubt:?})"),
        }
    }
}

#[cfg(test)]
mod tests {
    use fdi_core::{Config, Instrument, RawSample};

    use super::*;

    /// A board that has just been told to simulate says so from its first word on.
    #[test]
    fn a_simulation_is_told_before_its_first_tick() {
        let status = Status { simulated: true, ..Status::default() };
        let said = status.to_string();
        assert!(said.starts_with("SIMULATED: ") && said.ends_with("no tick yet"), "{said}");
    }

    #[test]
    fn one_line_says_how_it_is() {
        assert_eq!(StatusLine(&Status::default()).to_string(), "no tick yet");
        let mut instrument = Instrument::new(&Config::default()).expect("valid");
        let tick = instrument.control(RawSample::default());
        let report = instrument.diagnose(&tick, tick.drive);
        let record = TickRecord::new(RawSample::default(), tick, Percent(38.625));
        let status = Status { last: Some((record, report)), ..Status::default() };
        let line = StatusLine(&status).to_string();
        assert!(
            line.starts_with("off T0 ") && line.contains(" of 35.0 degC, heater 38.63 %, gain ?"),
            "{line}"
        );
        assert!(line.ends_with(" bandwidth ?, fdv 0 fiv 0"), "{line}");
    }

    #[test]
    fn what_has_become_of_the_rig_is_said_in_words() {
        let text = |change| Since { number: 2, change }.to_string();
        assert_eq!(text(None), "commissioning 2");
        let changed = |rise| text(Some(SinceCommissioning { rise }));
        assert_eq!(changed(-0.12), "commissioning 2: since then the same power warms by 12.0 % less");
        assert_eq!(changed(0.031), "commissioning 2: since then the same power warms by 3.1 % more");
    }

    #[test]
    fn known_inputs_are_shown_where_there_are_any() {
        let text = |inputs| fmt::from_fn(move |f| known(f, &inputs)).to_string();
        assert_eq!(text(KnownInputs::default()), "");
        let inputs =
            KnownInputs { supply: Some(0.9512), supply_lost: 3, fan: Some(Percent(80.0)), beside: None };
        let expected = "\nsupply 95.1 % of nominal\nsupply not read on 3 ticks\nfan at 80.0 %, as announced";
        assert_eq!(text(inputs), expected);
    }

    #[test]
    fn health_has_a_line_now_and_then_and_whenever_something_is_lost() {
        let at = |ticks| Health { jitter: Jitter { ticks, ..Jitter::default() }, ..Health::default() };
        assert!(at(1200).is_worth_a_line() && !at(1201).is_worth_a_line());
        assert!(Health { log_dropped: 1, ..at(1201) }.is_worth_a_line());
        assert!(Health { records_lost: 1, ..at(1201) }.is_worth_a_line());
        assert!(Health { jitter: Jitter { missed: 1, ..at(1201).jitter }, ..at(1201) }.is_worth_a_line());
    }
}
