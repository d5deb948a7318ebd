//! Several sources find, one finding is reported: which of them, by a table.

use super::alarm::Said;
use super::class::{Channel, FaultClass};
use super::tuning::Tuned;
use super::verdict::Finding;
use Source::{Commissioning, Contact, Models, Motion, Response, Rises, Room, Sensors};

/// Who finds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Source {
    /// The plausibility checks of the readings.
    Sensors,
    /// The banks: that since an onset, where it has a name, else that since training.
    Models,
    /// The rises of T1 and T2 held against those that the models expect: who sees too little.
    Rises,
    /// A thermistor's motion, where the models say that it is stuck: what moves, if late, is slowed by dirt.
    Motion,
    /// The count of how often a thermistor's error came back.
    Contact,
    /// The thermistors' responses to the power.
    Response,
    /// The room that T0 reads.
    Room,
    /// The models in force held against those of the commissioning.
    Commissioning,
}

/// All that was found on a tick.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(test, derive(Default))]
pub(super) struct Evidence<'a> {
    pub(super) sensors: Option<Finding>,
    pub(super) said: &'a Said,
    pub(super) contact: Option<Finding>,
    pub(super) response: Option<Finding>,
    pub(super) room: Option<Finding>,
    pub(super) commissioning: Option<Finding>,
}

/// A source is reported where it has found something and this holds.
struct Rule {
    source: Source,
    holds: fn(&Evidence, Tuned) -> bool,
}

const fn rule(source: Source, holds: fn(&Evidence, Tuned) -> bool) -> Rule {
    Rule { source, holds }
}

/// The first that holds is reported.
static RULES: [Rule; 12] = [
    // A broken wire needs no second opinion; a thermistor that is only lost may be part of something larger.
    rule(Sensors, |e, _| !matches!(e.sensors, Some(Finding { class: FaultClass::Lost(_), .. }))),
    // A T2 that slides out resembles a T1 that sees too much; but that reads as it should.
    rule(Rises, |e, t| {
        let t2_out = e.said.by_rises.is_some_and(|found| found.class == FaultClass::T2Detached);
        t2_out && e.rises_say_so(t) && e.models_say(&[FaultClass::T1Clogged, FaultClass::T1Offset])
    }),
    // What slips out slowly looks like a drift at first.
    rule(Rises, |e, t| e.rises_say_so(t) && e.models_say(&[FaultClass::Drift])),
    // What slips out a little fits no signature, and looks stuck while the controller holds it.
    rule(Rises, |e, _| e.models_say(&[FaultClass::Unknown]) || e.is_stuck_but_moves()),
    // An error that comes and goes is one alarm, also while it is gone; what has another name meanwhile is another fault.
    rule(Contact, |e, _| e.said.by_models().is_none_or(|named| named.class.sensor() == e.contact_of())),
    // The models see more than a contradiction does.
    rule(Models, |e, _| e.models_tell()),
    // That says more than a thermistor that is lost, or than that nothing fits.
    rule(Response, |_, _| true),
    rule(Room, |_, _| true),
    rule(Sensors, |_, _| true),
    rule(Motion, |_, _| true),
    rule(Models, |_, _| true),
    // What was so before it was learnt, where nothing has happened since.
    rule(Commissioning, |e, _| !e.said.alarm()),
];

/// What is reported. On most ticks nothing is wrong, and no rule is asked.
pub(super) fn decide(evidence: &Evidence, tuning: Tuned) -> Option<Finding> {
    let found = |rule: &Rule| evidence.of(rule.source).filter(|_| (rule.holds)(evidence, tuning));
    evidence.alarm().then(|| RULES.iter().find_map(found)).flatten()
}

impl Evidence<'_> {
    /// Whether anything is wrong.
    pub(super) fn alarm(&self) -> bool {
        self.said.alarm() || self.commissioning.is_some() || self.sudden()
    }

    /// All that is wrong came little by little since training, or since the commissioning.
    pub(super) fn creeps(&self) -> bool {
        self.alarm() && self.said.since_onset.is_none() && !self.sudden()
    }

    /// Something is wrong by another source than the models.
    fn sudden(&self) -> bool {
        [self.sensors, self.contact, self.response, self.room].iter().any(Option::is_some)
    }

    /// The thermistor whose contact is loose.
    fn contact_of(&self) -> Option<Channel> {
        self.contact.and_then(|found| found.class.sensor())
    }

    fn of(&self, source: Source) -> Option<Finding> {
        match source {
            Sensors => self.sensors,
            Models => self.said.by_models(),
            Rises => self.said.by_rises,
            Motion => self.slowed(),
            Contact => self.contact,
            Response => self.response,
            Room => self.room,
            Commissioning => self.commissioning,
        }
    }

    fn models_say(&self, classes: &[FaultClass]) -> bool {
        self.said.by_models().is_some_and(|finding| classes.contains(&finding.class))
    }

    /// The rise that a thermistor lacks is as large as that of one that is out.
    fn rises_say_so(&self, tuning: Tuned) -> bool {
        let size = self.said.by_rises.and_then(|finding| finding.magnitude);
        size.is_some_and(|size| 1.0 + size.value / 100.0 < tuning.hypotheses.seen())
    }

    /// A thermistor is said to be stuck and follows the power.
    fn is_stuck_but_moves(&self) -> bool {
        self.slowed().is_some()
    }

    /// A thermistor that is said to be stuck and moves follows late. T1 is clogged, by how much is not known; such a T2 has no name.
    fn slowed(&self) -> Option<Finding> {
        let stuck = self.said.by_models()?;
        match (stuck.class, self.said.moves) {
            (FaultClass::Stuck(Channel::T1), [true, _]) => {
                Some(Finding { class: FaultClass::T1Clogged, ..stuck })
            }
            (FaultClass::Stuck(Channel::T2), [_, true]) => {
                Some(Finding { class: FaultClass::Unknown, confidence: 0.0, ..stuck })
            }
            _ => None,
        }
    }

    /// The models have a name that tells: a sure one. Over a T0 that is known to be wrong they say nothing of heater and air: a wrong "heater power" would keep a
    /// loss of air from tripping.
    fn models_tell(&self) -> bool {
        let misled = self.response.or(self.room).is_some_and(|finding| finding.class == FaultClass::T0Fault);
        let unsure = self.said.by_models().is_some_and(|finding| !finding.is_sure());
        let vague =
            unsure || self.models_say(&[FaultClass::Unknown, FaultClass::Drift]) || self.is_stuck_but_moves();
        let process = [FaultClass::AirFlow, FaultClass::HeaterPower, FaultClass::AirFlowOrHeaterPower];
        !(vague || misled && self.models_say(&process))
    }
}

/// Of one rig looked at sample by sample and at means of several: of thermistors the first is reported, of the process the second.
pub(crate) fn of_two_rates(samples: Option<Finding>, means: Option<Finding>) -> Option<Finding> {
    samples.filter(|finding| finding.class.sensor().is_some()).or(means).or(samples)
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::boxed::Box;
    use std::vec::Vec;

    use super::super::verdict::Magnitude;
    use super::*;
    use FaultClass::{
        AirFlow, Drift, HeaterPower, Lost, Open, SinceCommissioning, Stuck, T0Fault, T1Clogged, T1Detached,
        T1Loose, T1Offset, T2Detached, T2Offset, Unknown,
    };

    impl Default for &Said {
        fn default() -> Self {
            said(None, None, false)
        }
    }

    fn named(class: FaultClass) -> Option<Finding> {
        Some(Finding { class, confidence: 1.0, magnitude: None, onset: 0 })
    }

    /// Models, rises with what share is missing, and whether T1 and T2 follow the power.
    fn said(models: Option<FaultClass>, rises: Option<(FaultClass, f32)>, follow: bool) -> &'static Said {
        let lacks = |value| Some(Magnitude { value, half_width: 5.0 });
        Box::leak(Box::new(Said {
            since_onset: models.map(named),
            since_training: None,
            by_rises: rises
                .map(|(class, share)| Finding { magnitude: lacks(-share), ..named(class).unwrap() }),
            moves: [follow; 2],
        }))
    }

    fn models(class: FaultClass) -> Evidence<'static> {
        Evidence { said: said(Some(class), None, false), ..Evidence::default() }
    }

    /// One case or more for each rule, in their order: which one decides, and what.
    fn cases() -> Vec<(usize, Evidence<'static>, FaultClass)> {
        let (open, lost) = (named(Open(Channel::T1)), named(Lost(Channel::T2)));
        let (out, t0, loose) = (named(T1Detached), named(T0Fault), named(T1Loose));
        let commissioning = named(SinceCommissioning);
        let slips = |class, rises, share, moves| Evidence {
            said: said(Some(class), Some((rises, share)), moves),
            ..Evidence::default()
        };
        let stuck = Stuck(Channel::T1);
        // A name that lasts, though it is no longer sure.
        let since_onset = Some(Some(Finding { confidence: 0.76, ..named(T1Clogged).unwrap() }));
        let lapsed: &Said = Box::leak(Box::new(Said { since_onset, ..Said::default() }));
        std::vec![
            (0, Evidence { sensors: open, response: out, ..models(T2Offset) }, Open(Channel::T1)),
            (1, slips(T1Clogged, T2Detached, 60.0, false), T2Detached),
            (1, slips(T1Offset, T2Detached, 60.0, false), T2Detached),
            (2, slips(Drift, T1Detached, 60.0, false), T1Detached),
            (3, slips(Unknown, T1Detached, 20.0, false), T1Detached),
            (3, slips(stuck, T1Detached, 20.0, true), T1Detached),
            (4, Evidence { contact: loose, ..models(T1Offset) }, T1Loose),
            (4, Evidence { contact: loose, response: out, ..Evidence::default() }, T1Loose),
            (5, Evidence { contact: loose, ..models(HeaterPower) }, HeaterPower),
            (5, Evidence { sensors: lost, response: out, ..models(T2Offset) }, T2Offset),
            (5, slips(T1Clogged, T1Detached, 60.0, false), T1Clogged),
            (5, slips(T1Clogged, T2Detached, 20.0, false), T1Clogged),
            (5, slips(stuck, T1Detached, 20.0, false), stuck),
            (5, Evidence { response: out, ..models(HeaterPower) }, HeaterPower),
            (5, Evidence { room: t0, ..models(T2Offset) }, T2Offset),
            (6, Evidence { sensors: lost, response: out, ..models(Unknown) }, T1Detached),
            (6, Evidence { response: out, room: t0, ..models(Drift) }, T1Detached),
            (6, Evidence { response: named(stuck), said: lapsed, ..Evidence::default() }, stuck),
            (7, Evidence { room: t0, ..models(HeaterPower) }, T0Fault),
            (7, Evidence { room: t0, ..models(AirFlow) }, T0Fault),
            (8, Evidence { sensors: lost, ..models(Unknown) }, Lost(Channel::T2)),
            (9, Evidence { said: said(Some(stuck), None, true), ..Evidence::default() }, T1Clogged),
            (
                9,
                Evidence { said: said(Some(Stuck(Channel::T2)), None, true), ..Evidence::default() },
                Unknown
            ),
            (10, slips(Drift, T1Detached, 20.0, false), Drift),
            (10, Evidence { commissioning, ..models(Unknown) }, Unknown),
            (10, Evidence { said: lapsed, ..Evidence::default() }, T1Clogged),
            (11, Evidence { commissioning, ..Evidence::default() }, SinceCommissioning),
        ]
    }

    #[test]
    fn of_several_findings_the_most_telling_is_reported() {
        let cases = cases();
        for (decides, evidence, class) in &cases {
            let tuning = Tuned::default();
            let first = RULES
                .iter()
                .position(|rule| evidence.of(rule.source).is_some() && (rule.holds)(evidence, tuning));
            let reported = decide(evidence, tuning).map(|finding| finding.class);
            assert_eq!((first, reported), (Some(*decides), Some(*class)), "{evidence:?}");
        }
        let without_case = (0..RULES.len()).find(|rule| cases.iter().all(|(decides, ..)| decides != rule));
        assert_eq!(without_case, None, "each rule has a case that it decides");
    }

    /// The bank since an onset speaks first where it has a name, that since training where the other has none.
    #[test]
    fn the_bank_with_a_name_speaks() {
        let said = |since_onset, since_training| Said { since_onset, since_training, ..Said::default() };
        let class = |said: Said| said.by_models().map(|finding| finding.class);
        assert_eq!(class(said(Some(named(T1Offset)), Some(named(AirFlow)))), Some(T1Offset));
        assert_eq!(class(said(Some(None), Some(named(AirFlow)))), Some(AirFlow));
        assert_eq!(class(said(Some(None), None)), None);
    }

    #[test]
    fn of_two_rates_samples_tell_of_thermistors_and_means_of_the_process() {
        let [offset, flow, power] = [T1Offset, AirFlow, HeaterPower].map(named);
        assert_eq!(of_two_rates(offset, flow), offset);
        assert_eq!(of_two_rates(power, flow), flow);
        assert_eq!(of_two_rates(power, None), power);
    }
}
