//! The model of the rig: power goes in, codes and the truth come out.

use std::sync::LazyLock;

use anyhow::{Context, ensure};
use fdi_core::supervisor::FASTEST_FAN;
use pt326_host::experiment::scenario::Scenario;
use pt326_host::experiment::{FaultSize, as_written, on_rig, sample, truth};
use pt326_host::settings;
use pt326_rig::Rig;
use pt326_rig::fault::{Fault, Sensor, Verb};
use toml::Value as Toml;

use crate::model::{Model, Running, text_or_file};
use crate::variable::Value::{Real, Text, Whole};
use crate::variable::{Role, Values, Variable};

/// How many faults have parameters of their own; a scenario may have any number.
const SLOTS: usize = 3;
/// A fault that nobody ends, s.
const FOR_EVER: f64 = 1e9;
const ANY_SIZE: f64 = 1000.0;

/// The model.
pub static MODEL: LazyLock<Model> = LazyLock::new(|| Model {
    identifier: "pt326_rig",
    title: "PT-326 rig",
    about: "A simulated PT-326 process trainer: the heater's power goes in; the codes of three thermistors come out, and the truth",
    variables: variables(),
    begin,
});

#[rustfmt::skip]
fn variables() -> Vec<Variable> {
    let word = |name: &str, about| Variable::new(Role::Parameter, name, Text(String::new()), about);
    let number = |role, name: &str, about| Variable::new(role, name, Real(0.0), about);
    let mut all = vec![
        Variable::time(),
        word("preset", "Name of a rig: paper, trainer, harsh, recorded, oven, hotend or tclab; empty: the scenario's"),
        word("disturbance", "How much the surroundings move: none, calm or lively; empty: as the scenario says, which is calm"),
        word("scenario", "The word paper for its three faults, TOML of `pt326 scenario`, or the path of such a file, *.toml; empty: no fault"),
        Variable::new(Role::Parameter, "seed", Whole(1), "Seed of the noise: the same seed gives the same run")
            .within(0.0, f64::from(i32::MAX)),
        number(Role::Parameter, "sample_time", "Sample time; 0: that of the preset's instrument, by default 0.11 s")
            .unit("s")
            .within(0.0, 10.0),
    ];
    all.extend((1..=SLOTS).flat_map(fault_variables));
    all.extend(moving_variables());
    all
}

/// What moves, and the step in which it does.
#[rustfmt::skip]
fn moving_variables() -> [Variable; 11] {
    let number = |role, name: &str, about| Variable::new(role, name, Real(0.0), about);
    [
        number(Role::Calculated, "step_size", "The step that it takes: the sample time").unit("s"),
        number(Role::Input, "power", "Power of the heater over the next step").unit("%").within(0.0, 100.0),
        Variable::new(Role::Input, "fan", Real(100.0), "Level of the fan, of the nominal one")
            .unit("%")
            .within(0.0, f64::from(FASTEST_FAN)),
        number(Role::Output, "code_t0", "Code of the thermistor in the room, on the scale of 12 bits; NaN where the sample is missing"),
        number(Role::Output, "code_t1", "Code of the thermistor behind the heater; NaN where the sample is missing"),
        number(Role::Output, "code_t2", "Code of the thermistor further down; NaN where the sample is missing"),
        number(Role::Output, "code_supply", "Code of the heater's supply; 0 where it is not measured"),
        number(Role::Output, "air_t1", "Truth: the air at T1, without turbulence").unit("degC"),
        number(Role::Output, "air_t2", "Truth: the air at T2, without turbulence").unit("degC"),
        number(Role::Output, "sensor_error", "Truth: error of the thermistor that is worst off").unit("degC"),
        Variable::new(Role::Output, "truth", Whole(0), "Truth: number of the fault that acts, as in trace.csv; 0: none"),
    ]
}

/// The parameters of a fault.
#[rustfmt::skip]
fn fault_variables(slot: usize) -> [Variable; 8] {
    let named =
        |key: &str, start, about| Variable::new(Role::Parameter, format!("fault{slot}.{key}"), start, about);
    let word = |key, about| named(key, Text(String::new()), about);
    let time = |key, start, about| named(key, Real(start), about).unit("s").within(0.0, FOR_EVER);
    [
        word("kind", "What happens: offset, drift, clog, open, short, stuck, air-flow, heater-power and so on; empty: nothing"),
        word("sensor", "To which thermistor: t0, t1 or t2; empty where it happens to none"),
        named("size", Real(0.0), "How much, in the unit of its kind").within(-ANY_SIZE, ANY_SIZE),
        time("start", 0.0, "Onset, counted from the start of the simulation"),
        time("duration", FOR_EVER, "How long it lasts"),
        time("over", 0.0, "How long it takes until it has its size; 0: it has it at once"),
        time("lag", 0.0, "Time constant of a thermistor that is clogged or slides out; 0: as in the tube"),
        word("with", "For the kind swap: with which thermistor it is exchanged"),
    ]
}

/// The fault of a slot, if it has one.
fn fault(values: &Values, slot: usize) -> anyhow::Result<Option<Fault>> {
    let key = |key: &str| format!("fault{slot}.{key}");
    let word = |name: &str| Some(values.text(&key(name))).filter(|text| !text.is_empty());
    let sensor = |name: &str| -> anyhow::Result<Option<Sensor>> {
        let read = word(name).map(|text| Toml::from(text).try_into());
        read.transpose().with_context(|| key(name))
    };
    let positive = |name: &str| Some(values.real(&key(name))).filter(|x| *x > 0.0);
    let Some(kind) = word("kind") else { return Ok(None) };
    let verb: Verb = Toml::from(kind).try_into().with_context(|| key("kind"))?;
    let size = values.real(&key("size"));
    let fault = Fault {
        name: String::new(),
        verb,
        sensor: sensor("sensor")?,
        size: (verb.size_bounds().is_some() || size != 0.0).then_some(size),
        lag: positive("lag"),
        with: sensor("with")?,
        over: positive("over"),
        at: values.real(&key("start")),
        duration: values.real(&key("duration")),
    };
    fault.validate(&format!("fault{slot}"))?;
    Ok(Some(fault))
}

/// What happens, as the parameters say.
fn scenario(values: &Values) -> anyhow::Result<Scenario> {
    Ok(match values.text("scenario") {
        "" => Scenario { faults: Vec::new(), ..Scenario::default() },
        "paper" => Scenario::default(),
        given => {
            let scenario: Scenario = toml::from_str(&text_or_file(given)?).context("scenario")?;
            scenario.validate().context("scenario")?;
            ensure!(
                scenario.actions.is_empty(),
                "scenario has an [[action]], expected none: what a user does comes by inputs (fan, set-point)"
            );
            scenario
        }
    })
}

fn begin(values: &mut Values) -> anyhow::Result<Box<dyn Running>> {
    let preset = Some(values.text("preset")).filter(|name| !name.is_empty());
    let config = settings::preset(preset.unwrap_or_default()).and_then(settings::from_table)?;
    let disturbance = match values.text("disturbance") {
        "" => None,
        word => Some(word.parse().map_err(|why| anyhow::anyhow!("disturbance is {word:?}: {why}"))?),
    };
    let scenario = on_rig(scenario(values)?, &config, preset, disturbance, FaultSize::Nominal)?;
    let mut faults = scenario.faults;
    for slot in 1..=SLOTS {
        faults.extend(fault(values, slot)?);
    }
    let given = values.real("sample_time");
    let sample_time = if given == 0.0 { as_written(config.sample_time.0) } else { given };
    ensure!(sample_time >= 0.001, "sample_time is {sample_time}, expected 0 or 0.001 to 10 s");
    let seed = values.real("seed") as u64;
    let rig = Rig::new(&scenario.rig, scenario.disturbance, sample_time, seed, &faults);
    let mut begun = Begun { rig, faults, fan: 100.0, sample_time, tick: 0 };
    begun.tell(values);
    Ok(Box::new(begun))
}

/// A rig in motion.
struct Begun {
    rig: Rig,
    faults: Vec<Fault>,
    /// Level of the fan as it was set last, %.
    fan: f64,
    sample_time: f64,
    tick: u32,
}

impl Begun {
    /// What is known on the present tick.
    fn tell(&mut self, values: &mut Values) {
        let codes = sample(&mut self.rig);
        let [air_t1, air_t2] = self.rig.air();
        for (name, number) in [
            ("step_size", self.sample_time),
            ("code_t0", f64::from(codes.t0.0)),
            ("code_t1", f64::from(codes.t1.0)),
            ("code_t2", f64::from(codes.t2.0)),
            ("code_supply", f64::from(codes.supply.0)),
            ("air_t1", air_t1),
            ("air_t2", air_t2),
            ("sensor_error", self.rig.sensor_error()),
        ] {
            values.tell(name, Real(number));
        }
        let now = f64::from(self.tick) * self.sample_time;
        values.tell("truth", Whole(i32::from(truth(&self.faults, now))));
    }
}

impl Running for Begun {
    fn sample_time(&self) -> f64 {
        self.sample_time
    }

    fn step(&mut self, values: &mut Values) -> Vec<String> {
        let fan = values.real("fan");
        if fan != self.fan {
            self.fan = fan;
            self.rig.set_fan(fan / 100.0);
        }
        self.rig.advance(values.real("power"));
        self.tick += 1;
        self.tell(values);
        Vec::new()
    }
}
