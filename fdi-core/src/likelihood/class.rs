//! The classes of fault, a row each: name, unit, thermistor, number in a record, and the sentences in which it is reported.
//!
//! To add a class: a variant, its row below, and where residuals tell it its hypothesis (`hypothesis.rs`, `regressor.rs`).

mod channel;

pub use channel::{Channel, Pair};

/// What is faulty.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum FaultClass {
    /// T1 reads too high or too low by a constant.
    T1Offset,
    /// T2 reads too high or too low by a constant.
    T2Offset,
    /// T1 sees only a part of the rise, or sees it late, or both.
    T1Clogged,
    /// The air flow is not what it was.
    AirFlow,
    /// The heater gives another power than the one asked for.
    HeaterPower,
    /// The air flow or the heater's power is not what it was: they look alike at first.
    AirFlowOrHeaterPower,
    /// The ambient thermistor reads wrong.
    T0Fault,
    /// The same power warms otherwise than when the rig was commissioned: heater or air flow has aged, or was changed.
    SinceCommissioning,
    /// A thermistor's error grows slowly.
    Drift,
    /// T1's error comes and goes: its contact is loose.
    T1Loose,
    /// T2's error comes and goes: its contact is loose.
    T2Loose,
    /// A thermistor repeats itself although it should move.
    Stuck(Channel),
    /// A thermistor's wire is broken.
    Open(Channel),
    /// A thermistor's wires touch.
    Short(Channel),
    /// A thermistor gives nothing that can be true: no code, impossible temperatures or jumps.
    Lost(Channel),
    /// T1 is out of the tube, or half out: it sees little of the rise or none.
    T1Detached,
    /// T2 is out of the tube.
    T2Detached,
    /// Two thermistors are exchanged, as when their wires are swapped.
    Swapped(Pair),
    /// None of these explains what is seen, or several at once would be needed.
    Unknown,
}

/// What the magnitude of a class is: its unit, its scale and the smallest one that is a fault follow from that.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Quantity {
    /// It has none.
    Nothing,
    /// A reading is off by so much, degC.
    Offset,
    /// A reading drifts, degC a minute.
    Ramp,
    /// A thermistor sees more or less of the rise, %.
    Rise,
    /// The air flow is other, %; the hypotheses free `1/f - 1`.
    Flow,
    /// The power is other, %.
    Power,
}

impl Quantity {
    const fn unit(self) -> &'static str {
        match self {
            Self::Nothing => "",
            Self::Offset => "degC",
            Self::Ramp => "degC/min",
            Self::Rise => "% of gain",
            Self::Flow => "% of air flow",
            Self::Power => "% of power",
        }
    }
}

/// Inputs that a class cannot be told without.
#[derive(Clone, Copy, Debug)]
pub(super) struct Needs {
    pub(super) t0: bool,
    pub(super) t2: bool,
    pub(super) fan: bool,
}

/// What is known of a class.
struct Facts {
    name: &'static str,
    quantity: Quantity,
    needs: Needs,
    sensor: Option<Channel>,
    number: u32,
    sized: &'static str,
    plain: &'static str,
    short: &'static str,
    axis: &'static str,
    share: Option<Share>,
}

/// Where a page finds which share of an alarm a class explains by itself.
#[derive(Clone, Copy)]
pub(crate) struct Share {
    /// Place among the fields of a row, which is never given twice.
    pub(crate) place: usize,
    /// Name of the field: `x_` and the name of the class.
    pub(crate) field: &'static str,
}

const NOTHING: Needs = Needs { t0: false, t2: false, fan: false };
const BOTH: Needs = Needs { t0: true, t2: true, fan: false };
const FAN: Needs = Needs { fan: true, ..NOTHING };

/// A class whose hypothesis says which share of an alarm it explains.
const fn explains(place: usize, field: &'static str, facts: Facts) -> Facts {
    Facts { share: Some(Share { place, field }), ..facts }
}

/// The class of `number` that belongs to no thermistor and has no magnitude.
const fn plain(number: u32, name: &'static str, [short, plain]: [&'static str; 2]) -> Facts {
    Facts {
        name,
        quantity: Quantity::Nothing,
        needs: NOTHING,
        sensor: None,
        number,
        sized: "",
        plain,
        short,
        axis: name,
        share: None,
    }
}

/// The same of a thermistor.
const fn of(sensor: Channel, number: u32, name: &'static str, said: [&'static str; 2]) -> Facts {
    let needs = Needs { t2: matches!(sensor, Channel::T2), ..NOTHING };
    Facts { sensor: Some(sensor), needs, ..plain(number, name, said) }
}

const fn offset(sensor: Channel, number: u32, name: &'static str, sentence: &'static str) -> Facts {
    Facts {
        quantity: Quantity::Offset,
        sized: "{t} reads {size} degC too {high|low}: {measured} degC measured, {corrected} expected",
        axis: "reads too high or too low (\u{b0}C)",
        ..of(sensor, number, name, ["{t} reads wrong", sentence])
    }
}

const fn detached(sensor: Channel, number: u32, name: &'static str) -> Facts {
    Facts {
        quantity: Quantity::Rise,
        sized: "{t} sees {seen} % of the rise: is it out of the tube? {measured} degC measured, {expected}",
        ..of(
            sensor,
            number,
            name,
            [
                "{t} out of the tube",
                "{t} does not see the rise that {other} sees: is it out of the tube? {measured} degC measured, {expected}",
            ],
        )
    }
}

const READS_WRONG: &str = "{t} reads wrong: {measured} degC measured, {expected}";
const NOT_THE_ROOM: &str = "T0 reads {t0} degC, and that cannot be the room: {t1} measured at T1, {t2} at T2, a room's temperature expected";
const STUCK: [&str; 2] = ["{t} stuck", "{t} stands still: {measured} degC measured, movement expected"];
/// A reading that jumps to and fro; its size is the last one's.
const fn loose(sensor: Channel, number: u32, name: &'static str) -> Facts {
    Facts {
        short: "{t}: loose contact",
        sized: "{t} reads {size} degC too {high|low} again and again: is its contact loose? {measured} degC measured, {expected}",
        ..offset(
            sensor,
            number,
            name,
            "{t} reads wrong again and again: is its contact loose? {measured} degC measured, {expected}",
        )
    }
}

const OPEN: [&str; 2] = ["{t} wire broken", "wire of {t} broken: no temperature measured, one expected"];
const SHORT: [&str; 2] = ["{t} wires touch", "wires of {t} touch: no temperature measured, one expected"];
const LOST: [&str; 2] = ["{t} lost", "{t} gives no plausible reading: no temperature measured, one expected"];

macro_rules! rows {
    ($($class:ident $(($which:ident))? => $row:expr;)*) => {
        impl FaultClass {
            /// Every class, in the order of the table.
            pub const ALL: [Self; [$(stringify!($class)),*].len()] = [$(Self::$class $(($which))?),*];

            #[inline(always)]
            const fn row(self) -> Facts {
                match self {
                    $(Self::$class $(($which))? => $row,)*
                }
            }
        }
    };
}

use Channel::{T0, T1, T2};
use Pair::{T0T1, T0T2, T1T2};

// A class without a row does not compile. Numbers are kept in recordings: a new class takes a new one.
rows! {
    T1Offset => explains(29, "x_t1_offset", offset(T1, 1, "t1_offset", READS_WRONG));
    T2Offset => explains(30, "x_t2_offset", offset(T2, 2, "t2_offset", READS_WRONG));
    // Over a T0 that is too low T1 and T2 rise too much alike: from rises the two are the same.
    T0Fault => explains(31, "x_t0_fault", Facts {
        needs: BOTH,
        sized: "T0 reads {size} degC too {high|low}, or T1 and T2 too {low|high} alike: {measured} degC measured at T0, {corrected} expected",
        ..offset(T0, 6, "t0_fault", NOT_THE_ROOM)
    });
    T1Clogged => explains(32, "x_t1_clogged", Facts {
        quantity: Quantity::Rise,
        needs: FAN,
        sized: "T1 sees {size} % {more|less} of the rise than it should: {measured} degC measured, {expected}",
        axis: "is clogged: loss of gain (%), lag below (s)",
        ..of(T1, 3, "t1_clogged", ["{t} clogged", "T1 is clogged: {measured} degC measured, {expected}"])
    });
    T1Detached => explains(38, "x_t1_detached", detached(T1, 13, "t1_detached"));
    T2Detached => explains(39, "x_t2_detached", detached(T2, 14, "t2_detached"));
    AirFlow => explains(33, "x_air_flow", Facts {
        quantity: Quantity::Flow,
        needs: FAN,
        sized: "the air flow is {size} % {stronger|weaker} than learnt: {share} % of normal estimated, 100 expected",
        axis: "Air flow changes (%)",
        ..plain(4, "air_flow", ["Air flow", "the air flow differs from the learnt value"])
    });
    HeaterPower => explains(34, "x_heater_power", Facts {
        quantity: Quantity::Power,
        sized: "the heater gives {size} % {more|less} power than asked for: {share} % of it estimated, 100 expected",
        axis: "Heater power changes (%)",
        ..plain(5, "heater_power", ["Heater power", "the heater does not follow the command: it gives the same power whatever is asked for"])
    });
    AirFlowOrHeaterPower => plain(18, "air_flow_or_heater_power", ["Air or power",
        "the air flow or the heater's power differs from the learnt value"]);
    SinceCommissioning => Facts {
        quantity: Quantity::Rise,
        sized: "the same power warms by {size} % {more|less} than when the rig was commissioned: {share} % of it learnt, 100 expected",
        ..plain(20, "since_commissioning", ["Other than commissioned", "the same power warms more or less than when the rig was commissioned: no change expected"])
    };
    Drift => explains(35, "x_drift", Facts {
        quantity: Quantity::Ramp,
        sized: "a thermistor drifts {upwards|downwards} by {size} degC a minute, 0 expected",
        axis: "drifts (\u{b0}C a minute)",
        ..plain(7, "drift", ["Drift", "a thermistor drifts: none expected"])
    });
    T1Loose => loose(T1, 29, "t1_loose");
    T2Loose => loose(T2, 45, "t2_loose");
    Stuck(T0) => of(T0, 9, "t0_stuck", STUCK);
    Stuck(T1) => explains(36, "x_t1_stuck", of(T1, 25, "t1_stuck", STUCK));
    Stuck(T2) => explains(37, "x_t2_stuck", of(T2, 41, "t2_stuck", STUCK));
    Open(T0) => of(T0, 10, "t0_open", OPEN);
    Open(T1) => of(T1, 26, "t1_open", OPEN);
    Open(T2) => of(T2, 42, "t2_open", OPEN);
    Short(T0) => of(T0, 11, "t0_short", SHORT);
    Short(T1) => of(T1, 27, "t1_short", SHORT);
    Short(T2) => of(T2, 43, "t2_short", SHORT);
    Lost(T0) => of(T0, 12, "t0_lost", LOST);
    Lost(T1) => of(T1, 28, "t1_lost", LOST);
    Lost(T2) => of(T2, 44, "t2_lost", LOST);
    Swapped(T1T2) => explains(40, "x_t1_t2_swapped", Facts { needs: BOTH, ..plain(15, "t1_t2_swapped", ["T1, T2 swapped",
        "T2 answers to the heater before T1, T1 expected first: are their wires swapped?"]) });
    Swapped(T0T1) => explains(41, "x_t0_t1_swapped", Facts { needs: BOTH, ..plain(16, "t0_t1_swapped", ["T0, T1 swapped",
        "T0 answers to the heater and T1 does not, the reverse expected: are their wires swapped?"]) });
    Swapped(T0T2) => explains(42, "x_t0_t2_swapped", Facts { needs: BOTH, ..plain(17, "t0_t2_swapped", ["T0, T2 swapped",
        "T0 answers to the heater and T2 does not, the reverse expected: are their wires swapped?"]) });
    Unknown => plain(8, "unknown", ["Unknown",
        "temperatures are not as expected, and no single known fault explains what was measured"]);
}

impl FaultClass {
    /// Its name in traces, logs and tables.
    pub const fn name(self) -> &'static str {
        self.row().name
    }

    /// Unit of the estimated magnitude; empty where there is none.
    pub const fn unit(self) -> &'static str {
        self.quantity().unit()
    }

    /// What its magnitude is.
    pub(super) const fn quantity(self) -> Quantity {
        self.row().quantity
    }

    /// What it cannot be told without.
    pub(super) const fn needs(self) -> Needs {
        self.row().needs
    }

    /// The thermistor that reads wrong; `None` where it is not one, or not known which.
    pub const fn sensor(self) -> Option<Channel> {
        self.row().sensor
    }

    /// What it is called where it comes again and again. T0's error has no such name: what moves T1 and T2 alike has its name as well.
    pub const fn again(self) -> Option<Self> {
        match self {
            Self::T1Offset => Some(Self::T1Loose),
            Self::T2Offset => Some(Self::T2Loose),
            _ => None,
        }
    }

    /// Whether an alarm of it may be shelved: what has a size, while both thermistors are in the tube. What may trip may not.
    pub const fn may_be_shelved(self) -> bool {
        !matches!(self.quantity(), Quantity::Nothing) && !matches!(self, Self::T1Detached | Self::T2Detached)
    }

    /// Whether it may be taken for normal: what may be shelved may, but the air flow, since whether it is lost (a trip) is held against what was
    /// learnt as normal.
    pub const fn may_be_accepted(self) -> bool {
        self.may_be_shelved() && !matches!(self, Self::AirFlow | Self::AirFlowOrHeaterPower)
    }

    /// Whether T1 does not see what the heater does, so that a loop by it heats without end.
    pub(super) fn leaves_t1_blind(self) -> bool {
        matches!(self, Self::T1Detached | Self::Stuck(Channel::T1) | Self::Swapped(Pair::T0T1))
    }

    /// Its number in recordings, above 0. It never changes.
    pub const fn number(self) -> u32 {
        self.row().number
    }

    /// The sentence that reports it; `sized` with its magnitude. What stands in braces is to be filled in:
    ///
    /// | | |
    /// |---|---|
    /// | `{t}`, `{other}` | name of its thermistor, and of the other one in the air |
    /// | `{size}` | the magnitude without its sign, with its interval |
    /// | `{high\|low}` | the first where the magnitude is positive, else the second |
    /// | `{share}`, `{seen}` | what is left of 100 %; the same as a whole number, not below zero |
    /// | `{measured}`, `{t0}`, `{t1}`, `{t2}` | what its thermistor, or this one, reads, degC |
    /// | `{corrected}` | what it reads less the magnitude, degC |
    /// | `{expected}` | "49.6 expected" by the models; where they expect nothing "about 33.1 expected, as T2 reads" |
    pub const fn sentence(self, sized: bool) -> &'static str {
        let row = self.row();
        if sized && !row.sized.is_empty() { row.sized } else { row.plain }
    }

    /// Its short name in English; `{t}` is to be filled in as in [`sentence`](Self::sentence).
    pub const fn short(self) -> &'static str {
        self.row().short
    }

    /// Where a page finds which share of an alarm it explains; `None` where no hypothesis is of this class.
    pub(crate) const fn share(self) -> Option<Share> {
        self.row().share
    }

    /// What the axis of a figure over its magnitude is called, behind the name of the thermistor where it is of one.
    pub const fn axis(self) -> &'static str {
        self.row().axis
    }
}

#[cfg(test)]
mod tests;
