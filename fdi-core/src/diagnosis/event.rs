//! From a flickering fault vector to one record of each fault: since when, which, until when.

use super::residual::DECISIVE;
use super::signature::{Symptom, Symptoms};

/// The record of one fault. Ticks count from the start of the instrument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Fault {
    /// Value of fdv when it was detected, or the largest since.
    pub detection_number: u8,
    /// Value of fiv, 0 until it is isolated; the last one given.
    pub isolation_number: u8,
    /// When the first of the symptoms appeared: the estimate of the onset.
    pub onset: u32,
    /// First tick with a value in fdv.
    pub detected: u32,
    /// First tick with a value in fiv.
    pub isolated: Option<u32>,
    /// Last tick with a value in fdv, so far.
    pub last_seen: u32,
}

impl Fault {
    /// From detection to the last tick seen, in ticks.
    pub fn duration(&self) -> u32 {
        self.last_seen.saturating_sub(self.detected) + 1
    }
}

/// What happened on a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Event {
    /// fdv left zero.
    Detected(Fault),
    /// fiv named the fault, or named another one.
    Isolated(Fault),
    /// fdv has been zero for long enough.
    Ended(Fault),
}

/// The events of one tick; a fault can be detected and isolated at once.
pub type Events = heapless::Vec<Event, 2>;

/// How far before the detection an onset is looked for, and how long fdv must stay zero for the end, in ticks.
#[derive(Clone, Copy, Debug)]
pub struct EventRules {
    /// Ticks before the detection beyond which a symptom is taken to be a disturbance of its own.
    pub onset_window: u32,
    /// Ticks that fdv must be zero: shorter gaps are flicker.
    pub clear_ticks: u32,
}

/// The memory of the event logic.
#[derive(Clone, Copy, Debug, Default)]
pub struct EventState {
    symptoms: Symptoms,
    since: [u32; DECISIVE.len()],
    current: Option<Fault>,
}

impl EventRules {
    /// What has happened, by the verdict of a tick.
    pub fn step(&self, state: &mut EventState, tick: u32, symptoms: &Symptoms, fdv: u8, fiv: u8) -> Events {
        if *symptoms != state.symptoms {
            for i in 0..symptoms.len() {
                if symptoms[i] != state.symptoms[i] {
                    state.since[i] = tick;
                }
            }
            state.symptoms = *symptoms;
        }
        if fdv == 0 && state.current.is_none() {
            return Events::new();
        }
        self.follow(state, tick, fdv, fiv)
    }

    /// Begins, continues or ends the record of a fault.
    fn follow(&self, state: &mut EventState, tick: u32, fdv: u8, fiv: u8) -> Events {
        let mut events = Events::new();
        state.current = match state.current {
            None if fdv != 0 => Some(self.detect(state, tick, fdv, &mut events)),
            Some(fault) if fdv == 0 && tick.saturating_sub(fault.last_seen) > self.clear_ticks => {
                push(&mut events, Event::Ended(fault));
                None
            }
            Some(fault) if fdv != 0 => {
                Some(Fault { detection_number: fault.detection_number.max(fdv), last_seen: tick, ..fault })
            }
            unchanged => unchanged,
        };
        if let Some(fault) = &mut state.current
            && fiv != 0
            && fiv != fault.isolation_number
        {
            fault.isolation_number = fiv;
            fault.isolated.get_or_insert(tick);
            push(&mut events, Event::Isolated(*fault));
        }
        events
    }

    fn detect(&self, state: &EventState, tick: u32, fdv: u8, events: &mut Events) -> Fault {
        let earliest = tick.saturating_sub(self.onset_window);
        let onset = core::iter::zip(&state.symptoms, &state.since)
            .filter(|&(&symptom, &since)| symptom != Symptom::Normal && since >= earliest)
            .map(|(_, &since)| since)
            .min();
        let fault = Fault {
            detection_number: fdv,
            isolation_number: 0,
            onset: onset.unwrap_or(tick),
            detected: tick,
            isolated: None,
            last_seen: tick,
        };
        push(events, Event::Detected(fault));
        fault
    }
}

/// One tick pushes at most two events, so there is always room.
fn push(events: &mut Events, event: Event) {
    let _ = events.push(event);
}
