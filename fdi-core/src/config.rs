//! The configuration as plain data; the paper's values are the default. It becomes something that steps only through a
//! constructor that checks it, such as [`crate::Instrument::new`].

use crate::control::pid::PidConfig;
use crate::control::prbs::PrbsConfig;
use crate::diagnosis::config::DiagnosisConfig;
use crate::error::{ConfigError, above, in_range};
use crate::identify::config::IdentificationConfig;
use crate::likelihood::config::LikelihoodConfig;
use crate::sense::SensorsConfig;
use crate::sense::plausibility::PlausibilityConfig;
use crate::sense::supply::SupplyConfig;
use crate::sense::thermistor::ThermistorConfig;
use crate::settings::{About, Fields, Group, Setting, Value, check, settings};
use crate::supervisor::config::SupervisorConfig;
use crate::units::{Celsius, Seconds};

settings! {
    /// Everything that a user can set.
    pub struct Config: General "" {
        /// Sample time Ts: a 4th to a 500th of `identification.answer_time`. A board takes 0.05 to 5 s, from its next start on.
        sample_time: Seconds = 0.11, 0.001..=10.0;
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
        /// Modes and trips.
        supervisor: SupervisorConfig = SupervisorConfig::default();
    }
}

/// Samples that an answer of the rig may take, and its dead time at most.
const LEAST_SAMPLES: f32 = 4.0;
const MOST_SAMPLES: f32 = 500.0;
const MOST_DEAD_SAMPLES: f32 = 60.0;

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

    /// Checks what one part asks of another, once each has been checked by itself.
    pub(crate) fn validate_limits(&self) -> Result<(), ConfigError> {
        let SupervisorConfig { over_temperature, setpoint_min, setpoint_max, .. } = self.supervisor;
        // A reading beyond what is plausible is no temperature any more: the limit must be reached before.
        let limit = over_temperature.0;
        above("plausibility.max", self.plausibility.max.0, "supervisor.over_temperature", limit)?;
        in_range("setpoint", self.setpoint.0, setpoint_min.0, setpoint_max.0)
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
