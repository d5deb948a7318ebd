//! The configuration as plain data; the paper's values are the default. It becomes something that steps only through a
//! constructor that checks it, such as [`crate::Instrument::new`].

use crate::bounds::larger;
pub use crate::control::pid::PidConfig;
pub use crate::control::prbs::PrbsConfig;
pub use crate::diagnosis::config::DiagnosisConfig;
use crate::error::{ConfigError, above, in_range, within_scale};
pub use crate::identify::config::IdentificationConfig;
use crate::likelihood::Tuned;
pub use crate::likelihood::config::LikelihoodConfig;
pub use crate::sense::SensorsConfig;
pub use crate::sense::plausibility::PlausibilityConfig;
pub use crate::sense::supply::SupplyConfig;
pub use crate::sense::thermistor::ThermistorConfig;
use crate::settings::{About, Fields, Group, Limit, Setting, Value, check, settings};
pub use crate::supervisor::config::SupervisorConfig;
use crate::units::{Celsius, Seconds};

settings! {
    /// Everything that a user can set.
    pub struct Config: General "" {
        /// Sample time Ts: a 4th to a 500th of `identification.answer_time`. A board takes 0.05 to 5 s, from its next start on.
        sample_time: Seconds = 0.11, 0.001..=10.0, limit above;
        /// Set-point of T1, from `supervisor.setpoint_min` to `supervisor.setpoint_max`.
        setpoint: Celsius = 35.0, 0.0..=300.0;
    } and {
        /// Thermistor constants and calibration.
        sensors: SensorsConfig = SensorsConfig::default();
        /// Supply voltage of the heater.
        supply: SupplyConfig = SupplyConfig::default();
        /// Limits of what a thermistor can truly read.
        plausibility: PlausibilityConfig = PlausibilityConfig::default();
        /// Temperature controller.
        pid: PidConfig = PidConfig::default();
        /// Excitation.
        prbs: PrbsConfig = PrbsConfig::default();
        /// ARX models.
        identification: IdentificationConfig = IdentificationConfig::default();
        /// Residuals, thresholds, signatures.
        diagnosis: DiagnosisConfig = DiagnosisConfig::default();
        /// The second opinion.
        likelihood: LikelihoodConfig = LikelihoodConfig::default();
        /// Numbers of the likelihood diagnosis.
        tuning: Tuned = Tuned::default();
        /// Modes and trips.
        supervisor: SupervisorConfig = SupervisorConfig::default();
    }
}

/// Samples that an answer of the rig may take, and its dead time at most.
const LEAST_SAMPLES: f32 = 4.0;
const MOST_SAMPLES: f32 = 500.0;
const MOST_DEAD_SAMPLES: f32 = 60.0;

/// Temperatures are bounded by how far others are above a room, degC; by so much at least, so that a narrow range leaves a choice.
const ROOM: f32 = 20.0;
const LEAST_RISE: f32 = 20.0;
/// The rig may become so many times as much warmer than a room as the highest set-point is. Of the presets `tclab` needs most, 1.7 times.
const HOTTEST: f32 = 2.0;
/// T2 may read above T1 by this share of what the rig may become warmer than a room. Of the presets `tclab` needs most, 0.2: its T2 sees half of
/// the rise.
const MOST_DISAGREEMENT: f32 = 0.25;

/// The settings of all groups, in the order in which they are listed.
static GROUPS: [&[Setting]; 12] = {
    let [t0, t1, t2] = ThermistorConfig::SETTINGS;
    [
        Config::SETTINGS[0],
        t0,
        t1,
        t2,
        SupplyConfig::SETTINGS[0],
        PlausibilityConfig::SETTINGS[0],
        PidConfig::SETTINGS[0],
        PrbsConfig::SETTINGS[0],
        IdentificationConfig::SETTINGS[0],
        DiagnosisConfig::SETTINGS[0],
        LikelihoodConfig::SETTINGS[0],
        SupervisorConfig::SETTINGS[0],
    ]
};

/// What people read of each group: what it is about, and of each of its settings.
const ABOUT: [(&str, &[About]); GROUPS.len()] = [
    (Config::GROUP_ABOUT, Config::ABOUT),
    (ThermistorConfig::GROUP_ABOUT, ThermistorConfig::ABOUT),
    (ThermistorConfig::GROUP_ABOUT, ThermistorConfig::ABOUT),
    (ThermistorConfig::GROUP_ABOUT, ThermistorConfig::ABOUT),
    (SupplyConfig::GROUP_ABOUT, SupplyConfig::ABOUT),
    (PlausibilityConfig::GROUP_ABOUT, PlausibilityConfig::ABOUT),
    (PidConfig::GROUP_ABOUT, PidConfig::ABOUT),
    (PrbsConfig::GROUP_ABOUT, PrbsConfig::ABOUT),
    (IdentificationConfig::GROUP_ABOUT, IdentificationConfig::ABOUT),
    (DiagnosisConfig::GROUP_ABOUT, DiagnosisConfig::ABOUT),
    (LikelihoodConfig::GROUP_ABOUT, LikelihoodConfig::ABOUT),
    (SupervisorConfig::GROUP_ABOUT, SupervisorConfig::ABOUT),
];

/// A group of settings with what people read of it.
#[derive(Clone, Copy, Debug)]
pub struct DocumentedGroup {
    /// What it is about.
    pub about: &'static str,
    /// Its settings.
    pub settings: &'static [Setting],
    /// What each of them is.
    pub settings_about: &'static [About],
}

impl Config {
    /// All settings that have one value; the rows of the signature tables come on top.
    pub fn settings() -> impl Iterator<Item = &'static Setting> + Clone {
        (0..).map_while(Self::setting)
    }

    /// The setting at a place of the list. Not inlined: it is walked through in many places, which would cost flash.
    #[inline(never)]
    fn setting(mut place: usize) -> Option<&'static Setting> {
        for group in &GROUPS {
            if let Some(setting) = group.get(place) {
                return Some(setting);
            }
            place -= group.len();
        }
        None
    }

    /// All groups of settings with their documentation, in the same order.
    pub fn documented() -> impl Iterator<Item = DocumentedGroup> {
        GROUPS.into_iter().zip(ABOUT).map(|(settings, (about, settings_about))| DocumentedGroup {
            about,
            settings,
            settings_about,
        })
    }

    /// The value of a setting.
    pub fn get(&self, setting: &Setting) -> Value {
        let field = self.group(setting.group).field(setting.index.into());
        field.map_or(Value::Switch(false), |field| field.value()) // there is one: only `settings!` makes a setting
    }

    /// Takes over a value, which the constructors check; `false` where it is of another kind.
    pub fn set(&mut self, setting: &Setting, value: Value) -> bool {
        let field = self.group_mut(setting.group).field_mut(setting.index.into());
        field.is_some_and(|field| field.set(value))
    }

    fn group(&self, group: Group) -> &dyn Fields {
        match group {
            Group::General => self,
            Group::T0 => &self.sensors.t0,
            Group::T1 => &self.sensors.t1,
            Group::T2 => &self.sensors.t2,
            Group::Supply => &self.supply,
            Group::Plausibility => &self.plausibility,
            Group::Pid => &self.pid,
            Group::Prbs => &self.prbs,
            Group::Identification => &self.identification,
            Group::Diagnosis => &self.diagnosis,
            Group::Likelihood => &self.likelihood,
            Group::Supervisor => &self.supervisor,
        }
    }

    fn group_mut(&mut self, group: Group) -> &mut dyn Fields {
        match group {
            Group::General => self,
            Group::T0 => &mut self.sensors.t0,
            Group::T1 => &mut self.sensors.t1,
            Group::T2 => &mut self.sensors.t2,
            Group::Supply => &mut self.supply,
            Group::Plausibility => &mut self.plausibility,
            Group::Pid => &mut self.pid,
            Group::Prbs => &mut self.prbs,
            Group::Identification => &mut self.identification,
            Group::Diagnosis => &mut self.diagnosis,
            Group::Likelihood => &mut self.likelihood,
            Group::Supervisor => &mut self.supervisor,
        }
    }

    /// Checks what belongs to no part alone, before any part is built.
    pub(crate) fn validate_general(&self) -> Result<(), ConfigError> {
        check(Self::SETTINGS[0], self)
    }

    /// The settings that are wider than their defaults, of those on which a protection rests.
    pub fn wider_than_default(&self) -> impl Iterator<Item = &'static Setting> {
        Self::settings().filter(|setting| {
            setting.limit.is_some_and(|limit| limit.is_widened(limit.default, self.get(setting).number()))
        })
    }

    /// Checks what one part asks of another, once each has been checked by itself.
    pub(crate) fn validate_limits(&self) -> Result<(), ConfigError> {
        let SupervisorConfig { over_temperature, setpoint_min, setpoint_max, .. } = self.supervisor;
        // A reading beyond what is plausible is no temperature any more: the limit must be reached before.
        let limit = over_temperature.0;
        above("plausibility.max", self.plausibility.max.0, "supervisor.over_temperature", limit)?;
        in_range("setpoint", self.setpoint.0, setpoint_min.0, setpoint_max.0)?;
        self.validate_scales()
    }

    /// Checks limits against the scale of the plant: times against its answer, temperatures against its set-points.
    fn validate_scales(&self) -> Result<(), ConfigError> {
        check(IdentificationConfig::SETTINGS[0], &self.identification)?;
        let answer = self.identification.answer_time.0;
        for setting in Self::settings() {
            let answers = setting.limit.map_or(0, |limit| limit.answers);
            if answers > 0 {
                let value = self.get(setting).number();
                within_scale(setting.name, value, 0.0, answers.into(), "identification.answer_time", answer)?;
            }
        }
        let SupervisorConfig { over_temperature, setpoint_max, max_disagreement, .. } = self.supervisor;
        let rise = |t: Celsius| larger(LEAST_RISE, t.0 - ROOM);
        let (of, scale) = ("supervisor.setpoint_max above a room of 20 degC", rise(setpoint_max));
        within_scale("supervisor.over_temperature", over_temperature.0, ROOM, HOTTEST, of, scale)?;
        let (of, scale) = ("supervisor.over_temperature above a room of 20 degC", rise(over_temperature));
        within_scale("supervisor.max_disagreement", max_disagreement.0, 0.0, MOST_DISAGREEMENT, of, scale)
    }

    /// Checks that the sample time suits the rig. Both halves run with any; what they learn is worth nothing then.
    ///
    /// # Errors
    /// The time that is too short or too long.
    pub fn validate_times(&self) -> Result<(), ConfigError> {
        // Fewer samples see no answer, more than these no end of it.
        let (ts, answer) = (self.sample_time.0, self.identification.answer_time.0);
        in_range("sample_time", ts, answer / MOST_SAMPLES, answer / LEAST_SAMPLES)?;
        in_range("identification.dead_time", self.identification.dead_time.0, 0.0, MOST_DEAD_SAMPLES * ts)
    }
}

/// How many settings are limits.
const LIMITS: usize = {
    let (mut count, mut g) = (0, 0);
    while g < GROUPS.len() {
        let mut i = 0;
        while i < GROUPS[g].len() {
            count += GROUPS[g][i].limit.is_some() as usize;
            i += 1;
        }
        g += 1;
    }
    count
};

/// The values of all settings that are limits, in the order of the list.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Limits([f32; LIMITS]);

impl Limits {
    /// Those of a configuration.
    pub(crate) fn of(config: &Config) -> Self {
        let mut values = [0.0; LIMITS];
        for (value, (setting, _)) in values.iter_mut().zip(Self::settings()) {
            *value = config.get(setting).number();
        }
        Self(values)
    }

    /// The first limit that `new` widens.
    pub(crate) fn widened(&self, new: &Self) -> Option<&'static str> {
        let mut limits = Self::settings().zip(self.0.iter().zip(&new.0));
        limits.find_map(|((setting, limit), (now, new))| limit.is_widened(*now, *new).then_some(setting.name))
    }

    fn settings() -> impl Iterator<Item = (&'static Setting, Limit)> {
        Config::settings().filter_map(|setting| Some((setting, setting.limit?)))
    }
}

const _: () = assert!(ids_differ(), "two settings have the same id: rename one");

/// Whether no two settings have the same id.
const fn ids_differ() -> bool {
    let mut seen = [false; 1 << 16];
    let mut g = 0;
    while g < GROUPS.len() {
        let mut i = 0;
        while i < GROUPS[g].len() {
            let id = GROUPS[g][i].id as usize;
            if seen[id] {
                return false;
            }
            seen[id] = true;
            i += 1;
        }
        g += 1;
    }
    true
}
