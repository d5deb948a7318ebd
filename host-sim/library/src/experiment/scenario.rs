//! What is done in a run: the rig, how long, what happens to it, what the user does meanwhile. Data, from TOML.

use std::path::Path;

use anyhow::{Context, ensure};
use fdi_core::supervisor::FASTEST_FAN;
use fdi_core::{Celsius, Command, Percent};
use serde::{Deserialize, Serialize};

use pt326_rig::fault::Fault;

use super::paper_sequence;
use pt326_rig::{Disturbance, RigConfig};

/// A run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Scenario {
    /// Length, s.
    pub duration: f64,
    /// The instrument is armed at this time, s: until then it sees the rig cold.
    pub arm_at: f64,
    /// How much the surroundings move.
    pub disturbance: Disturbance,
    /// Constants of the rig.
    pub rig: RigConfig,
    /// What happens to the rig.
    #[serde(rename = "fault")]
    pub faults: Vec<Fault>,
    /// What the user does.
    #[serde(rename = "action")]
    pub actions: Vec<Action>,
}

/// Something that the user does at a time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Action {
    /// When, s.
    pub at: f64,
    /// New set-point, degC.
    pub setpoint: Option<f32>,
    /// With `setpoint`: it is reached in a ramp of so many s, from the set-point before.
    pub over: Option<f64>,
    /// Excitation on or off.
    pub excite: Option<bool>,
    /// New level of the fan, % of the nominal one, which is announced. A change that nobody announces is a fault, `air-flow`.
    pub fan: Option<f32>,
    /// Learn anew what is normal, as after an announced change of the rig.
    #[serde(default)]
    pub relearn: bool,
    /// Heater off.
    #[serde(default)]
    pub stop: bool,
    /// Acknowledge what has tripped.
    #[serde(default)]
    pub acknowledge: bool,
    /// Arm again.
    #[serde(default)]
    pub arm: bool,
}

impl Action {
    /// The commands that it stands for, with their times, if the set-point is `before` until then.
    fn commands(&self, before: f32) -> Vec<(f64, Command)> {
        let mut commands = Vec::new();
        if let Some(setpoint) = self.setpoint {
            let steps = (self.over.unwrap_or(0.0) / RAMP_STEP).ceil().max(1.0) as u32;
            let wait = if self.over.is_some() { RAMP_STEP } else { 0.0 };
            commands.extend((1..=steps).map(|i| {
                let share = i as f32 / steps as f32;
                let now = if i == steps { setpoint } else { before + share * (setpoint - before) };
                (self.at + f64::from(i) * wait, Command::SetPoint(Celsius(now)))
            }));
        }
        commands.extend(self.excite.map(|on| (self.at, Command::Excite(on))));
        commands.extend(self.fan.map(|level| (self.at, Command::Fan(Percent(level)))));
        for (given, command) in [
            (self.relearn, Command::Relearn),
            (self.stop, Command::Stop),
            (self.acknowledge, Command::Acknowledge),
            (self.arm, Command::Arm),
        ] {
            commands.extend(given.then_some((self.at, command)));
        }
        commands
    }
}

/// A ramp is made of steps of so many s.
const RAMP_STEP: f64 = 1.0;

/// All commands of some actions, in the order of time; `setpoint` is the one at the start.
pub fn commands(actions: &[Action], setpoint: f32) -> Vec<(f64, Command)> {
    let mut sorted: Vec<&Action> = actions.iter().collect();
    sorted.sort_by(|a, b| a.at.total_cmp(&b.at));
    let mut before = setpoint;
    let mut commands = Vec::new();
    for action in sorted {
        commands.extend(action.commands(before));
        before = action.setpoint.unwrap_or(before);
    }
    commands.sort_by(|a, b| a.0.total_cmp(&b.0));
    commands
}

impl Default for Scenario {
    /// The paper's experiment (section 4, figures 4 to 6).
    fn default() -> Self {
        Self {
            duration: 850.0,
            arm_at: 0.0,
            disturbance: Disturbance::default(),
            rig: RigConfig::default(),
            faults: paper_sequence(),
            actions: Vec::new(),
        }
    }
}

impl Scenario {
    /// Whether it is the paper's experiment, in whatever surroundings.
    pub fn is_papers(&self) -> bool {
        *self == Self { disturbance: self.disturbance, ..Self::default() }
    }

    /// The same on a plant that is `factor` times slower: all times are longer by it.
    pub fn slowed(mut self, factor: f64) -> Self {
        self.duration *= factor;
        self.arm_at *= factor;
        for fault in &mut self.faults {
            *fault = fault.slowed(factor);
        }
        for action in &mut self.actions {
            action.at *= factor;
            action.over = action.over.map(|over| over * factor);
        }
        self
    }

    /// Checks everything.
    ///
    /// # Errors
    /// The key that is out of bounds.
    pub fn validate(&self) -> anyhow::Result<()> {
        let d = self.duration;
        ensure!((1.0..=1e7).contains(&d), "duration is {d}, expected 1 to 10000000 s");
        let at = self.arm_at;
        ensure!((0.0..=1e5).contains(&at), "arm_at is {at}, expected 0 to 100000 s");
        self.rig.validate()?;
        for (i, fault) in self.faults.iter().enumerate() {
            fault.validate(&format!("fault {}", i + 1))?;
        }
        for (i, action) in self.actions.iter().enumerate() {
            ensure!(action.at >= 0.0, "action {}: at is {}, expected 0 s or more", i + 1, action.at);
            ensure!(
                action.setpoint.is_some()
                    || action.excite.is_some()
                    || action.fan.is_some()
                    || action.relearn
                    || action.stop
                    || action.acknowledge
                    || action.arm,
                "action {}: expected `setpoint`, `excite`, `fan`, `relearn`, `stop`, `acknowledge` or `arm`",
                i + 1
            );
            let fan = action.fan.unwrap_or(100.0);
            ensure!(
                (0.0..=FASTEST_FAN).contains(&fan),
                "action {}: fan is {fan}, expected 0 to {FASTEST_FAN} %",
                i + 1
            );
            let over = action.over.unwrap_or(1.0);
            ensure!(
                (0.0..=1e5).contains(&over) && (action.over.is_none() || action.setpoint.is_some()),
                "action {}: over is {over}, expected 0 to 100000 s, and a `setpoint`",
                i + 1
            );
        }
        Ok(())
    }
}

/// Defaults of rig and faults as commented TOML. What is said of the rig's constants comes from their declaration.
pub fn commented_toml() -> String {
    const FRAME: &str = include_str!("../../defaults/scenario.toml");
    let tidy = |about: &str| about.trim().trim_end_matches('.').to_owned();
    let sections = RigConfig::SECTIONS.iter().map(|section| {
        let lines = section.constants.iter().map(|constant| {
            let pair = format!("{} = {}", constant.name, constant.default);
            let [min, max] = constant.bounds;
            format!("{pair:<27} # {}; {min} to {max}\n", tidy(constant.about))
        });
        let head =
            if section.name == "rig" { String::new() } else { format!("\n# {}\n", tidy(section.about)) };
        format!("{head}[{}]\n{}", section.name, lines.collect::<String>())
    });
    FRAME.replacen("[rig]\n", &sections.collect::<String>(), 1)
}

/// Reads a scenario; keys that the file leaves out have their defaults. Without a path all have.
///
/// # Errors
/// The file, and the line and key that are wrong.
pub fn read_scenario(path: Option<&Path>) -> anyhow::Result<Scenario> {
    let Some(path) = path else { return Ok(Scenario::default()) };
    let place = || path.display().to_string();
    let text = std::fs::read_to_string(path).with_context(|| format!("can't read {}", place()))?;
    let scenario: Scenario = toml::from_str(&text).with_context(place)?;
    scenario.validate().with_context(place)?;
    Ok(scenario)
}

#[cfg(test)]
mod tests {
    use toml::Table;

    use super::*;

    /// Every key of `all` stands in `some`, at any depth.
    fn covers(some: &Table, all: &Table, path: &str) {
        for (key, value) in all {
            let place = format!("{path}{key}");
            let Some(other) = some.get(key) else { panic!("{place} is missing from the commented defaults") };
            if let (Some(other), Some(value)) = (other.as_table(), value.as_table()) {
                covers(other, value, &format!("{place}."));
            }
        }
    }

    #[test]
    fn commented_defaults_are_the_defaults_and_complete() {
        let mut scenario: Scenario = toml::from_str(&commented_toml()).unwrap();
        assert_eq!(scenario, Scenario::default());
        scenario.actions.clear();
        let mut all = Table::try_from(Scenario::default()).unwrap();
        all.remove("action");
        covers(&toml::from_str(&commented_toml()).unwrap(), &all, "");
    }

    #[test]
    fn wrong_keys_and_values_are_named_with_their_line() {
        let error = toml::from_str::<Scenario>("[[fault]]\ndo = \"ofset\"\nat = 1\nfor = 1\n")
            .unwrap_err()
            .to_string();
        assert!(error.contains("line 2") && error.contains("ofset") && error.contains("offset"), "{error}");
        for (text, words) in [
            ("[[fault]]\ndo = \"offset\"\nsize = 1\nat = 1\nfor = 1", ["sensor", "t0, t1 or t2"]),
            ("[[fault]]\ndo = \"air-flow\"\nat = 1\nfor = 1", ["size", "times the nominal flow"]),
            ("[[fault]]\ndo = \"open\"\nsensor = \"t1\"\nat = 1\nfor = 0", ["for is 0", "more than 0 s"]),
            (
                "[[fault]]\ndo = \"detach\"\nsensor = \"t0\"\nsize = 1\nat = 1\nfor = 1",
                ["sensor is t0", "t1 or t2"],
            ),
            (
                "[[fault]]\ndo = \"detach\"\nsensor = \"t1\"\nsize = 1.5\nat = 1\nfor = 1",
                ["size is 1.5", "0 to 1"],
            ),
            ("[[fault]]\ndo = \"swap\"\nsensor = \"t1\"\nat = 1\nfor = 1", ["`with`", "the other sensor"]),
            (
                "[[fault]]\ndo = \"swap\"\nsensor = \"t1\"\nwith = \"t1\"\nat = 1\nfor = 1",
                ["the same", "two sensors"],
            ),
            ("[[fault]]\ndo = \"stuck\"\nsensor = \"t1\"\nover = 3\nat = 1\nfor = 1", ["over = 3", "detach"]),
            ("arm_at = -1", ["arm_at is -1", "0 to 100000 s"]),
            ("[rig]\ngain = -1", ["rig.gain is -1", "0.001 to 100"]),
            ("[rig.wall]\nt1_share = 2", ["rig.wall.t1_share is 2", "0 to 0.5"]),
            ("[[action]]\nat = 3", ["action 1", "setpoint"]),
            ("[[action]]\nat = 3\nexcite = true\nover = 5", ["action 1", "over is 5"]),
        ] {
            let error = toml::from_str::<Scenario>(text).unwrap().validate().unwrap_err().to_string();
            assert!(words.iter().all(|w| error.contains(w)), "{text}: {error}");
        }
    }

    #[test]
    fn a_rig_starts_from_a_preset_and_changes_it() {
        let text = "[rig]\npreset = \"trainer\"\ngain = 0.4\n[rig.wall]\ntime = 12";
        let scenario: Scenario = toml::from_str(text).unwrap();
        let mut expected = RigConfig::preset("trainer").unwrap();
        expected.gain = 0.4;
        expected.wall.time = 12.0;
        assert_eq!(scenario.rig, expected);
        let error = toml::from_str::<Scenario>("[rig]\npreset = \"kettle\"").unwrap_err().to_string();
        assert!(error.contains("kettle") && error.contains("paper, trainer, harsh, recorded"), "{error}");
    }

    #[test]
    fn a_ramp_goes_from_the_set_point_before_to_the_new_one() {
        let action = |at, setpoint, over| Action { at, setpoint: Some(setpoint), over, ..Action::default() };
        let commands = commands(&[action(10.0, 40.0, Some(4.0)), action(2.0, 36.0, None)], 35.0);
        let setpoint = |celsius| Command::SetPoint(Celsius(celsius));
        let expected = [(2.0, 36.0), (11.0, 37.0), (12.0, 38.0), (13.0, 39.0), (14.0, 40.0)];
        assert_eq!(commands, expected.map(|(t, celsius)| (t, setpoint(celsius))));
    }
}
