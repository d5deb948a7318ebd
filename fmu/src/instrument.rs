//! The model of the instrument: codes go in; power and findings come out.

use std::sync::LazyLock;

use anyhow::Context;
use fdi_core::schema::{self, COLUMNS, Entry, FIELDS, Moment};
use fdi_core::supervisor::FASTEST_FAN;
use fdi_core::{AdcCode, Celsius, Command, Config, Instrument, Percent, RawSample};
use firmware_logic::finding::Sentence;
use pt326_host::experiment::{as_written, tick_time, with_prbs_phase};
use pt326_host::record::summary::with_degree_sign;
use pt326_host::settings;
use toml::Table;

use crate::model::{Model, Running, text_or_file};
use crate::variable::Value::{Flag, Real, Text, Whole};
use crate::variable::{Role, Value, Values, Variable};

/// The model.
pub static MODEL: LazyLock<Model> = LazyLock::new(|| Model {
    identifier: "pt326_instrument",
    title: "PT-326 instrument",
    about: "Controller and both diagnoses: the codes of three thermistors go in; the heater's power comes out, and what is wrong with the rig",
    variables: variables(),
    begin,
});

/// An output that is a number of a tick: its name, that in trace.csv or in a row of the page, its type, what it is.
type Source = (&'static str, &'static str, Value, &'static str);

const NUMBER: Value = Real(f64::NAN);
const WORD: Value = Text(String::new());
const COUNT: Value = Whole(0);
const UNJUDGED: Value = Whole(-1);
const SWITCH: Value = Flag(false);

/// Outputs that are numbers of a tick.
#[rustfmt::skip]
const SOURCES: [Source; 31] = [
    ("power", "pa_pct", Real(0.0), "Power to drive the heater with over the next step"),
    ("t0", "t0_c", NUMBER, "What T0 reads; NaN where it reads nothing"),
    ("t1", "t1_c", NUMBER, "What T1 reads; NaN where it reads nothing"),
    ("t2", "t2_c", NUMBER, "What T2 reads; NaN where it reads nothing"),
    ("t1_expected", "t1_expected", NUMBER, "What T1 should read by the models"),
    ("t2_expected", "t2_expected", NUMBER, "What T2 should read by the models"),
    ("setpoint_in_force", "setpoint_c", NUMBER, "Set-point of T1"),
    ("mode", "mode", WORD, "Mode: off, settle, learn, monitor, tripped or tune"),
    ("mode_number", "mode", COUNT, "Mode: 0 off, 1 settle, 2 learn, 3 monitor, 4 tripped, 5 tune"),
    ("trip", "trip", WORD, "Why it has tripped; empty where it has not"),
    ("readiness", "readiness", WORD, "Whether the likelihood diagnosis watches: untrained, training, armed and so on"),
    ("alarm", "alarm", SWITCH, "The likelihood diagnosis says that something is wrong"),
    ("advice", "advice", SWITCH, "That alarm is no urgent one: it creeps, has stood for an hour, or is known to the user"),
    ("finding", "verdict", WORD, "What is wrong; empty where nothing is, or that cannot be told yet"),
    ("finding_number", "class", COUNT, "What is wrong, as a number of the log; 0 for nothing"),
    ("confidence", "confidence", NUMBER, "Probability of the finding, 0 to 1; NaN without one"),
    ("size", "magnitude", NUMBER, "How large the fault is, in size_unit; NaN where that cannot be told"),
    ("half_width", "half_width", NUMBER, "Half of the 95 % interval of size; NaN without one"),
    ("size_unit", "magnitude_unit", WORD, "Unit of size and half_width"),
    ("onset", "onset_s", NUMBER, "When the fault began, counted from the start of the simulation"),
    ("taught", "taught", COUNT, "Place of the user's own fault that it is, from 1; 0 for none"),
    ("taught_size", "taught_size", NUMBER, "Size of the user's own fault, of what was taught"),
    ("fdv", "fdv", UNJUDGED, "The paper's detection vector; -1 while it does not monitor"),
    ("fiv", "fiv", UNJUDGED, "The paper's isolation vector; -1 while it does not monitor"),
    ("rap", "rap_f", NUMBER, "The paper's residual of the power, low-passed"),
    ("ry12", "ry12_f", NUMBER, "The paper's residual between T1 and T2, low-passed"),
    ("rsg1", "rsg1_f", NUMBER, "The paper's residual of the static gain to T1, low-passed"),
    ("rsg2", "rsg2_f", NUMBER, "The paper's residual of the static gain to T2, low-passed"),
    ("rbw1", "rbw1_f", NUMBER, "The paper's residual of the bandwidth to T1, low-passed"),
    ("sg1", "sg1", NUMBER, "Static gain to T1, as identified"),
    ("sg2", "sg2", NUMBER, "Static gain to T2, as identified"),
];

fn entry(source: &str) -> &'static Entry {
    let all = COLUMNS.iter().chain(&FIELDS);
    all.into_iter().find(|entry| entry.name == source).expect("a number of the schema")
}

#[rustfmt::skip]
fn variables() -> Vec<Variable> {
    let word = |name: &str, about| Variable::new(Role::Parameter, name, WORD, about);
    let input = |name: &str, start, about| Variable::new(Role::Input, name, start, about);
    let mut all = vec![
        Variable::time(),
        word("preset", "Name of a rig, for its settings: oven, hotend or tclab; any other has the defaults"),
        word("configuration", "Settings over those of the preset: TOML of `pt326 config`, or the path of such a file, *.toml"),
        Variable::new(Role::Parameter, "seed", Whole(1), "Moves the start of the excitation; 1: as the configuration says")
            .within(0.0, f64::from(i32::MAX)),
        Variable::new(Role::Calculated, "step_size", Real(0.0), "The step that it takes: the sample time").unit("s"),
        input("code_t0", Real(0.0), "Code of the thermistor in the room, on the scale of 12 bits; NaN where the sample is missing"),
        input("code_t1", Real(0.0), "Code of the thermistor behind the heater; NaN where the sample is missing"),
        input("code_t2", Real(0.0), "Code of the thermistor further down; NaN where the sample is missing"),
        input("code_supply", Real(0.0), "Code of the heater's supply; 0 where it is not measured"),
        input("arm", SWITCH, "True begins to regulate, false switches the heater off"),
        input("acknowledge", SWITCH, "From false to true: leaves a trip whose cause has gone"),
        input("relearn", SWITCH, "From false to true: forgets what is normal and learns it anew"),
        input("setpoint", Real(0.0), "Set-point of T1; 0: that of the configuration").unit("degC"),
        input("fan", Real(100.0), "Announced level of the fan").unit("%").within(0.0, f64::from(FASTEST_FAN)),
    ];
    all.extend(SOURCES.into_iter().map(|(name, source, start, about)| {
        Variable::new(Role::Output, name, start, about).unit(entry(source).number.unit)
    }));
    all.push(Variable::new(Role::Output, "sentence", WORD, "The finding in words: how much, measured and expected, since when"));
    all
}

/// A number of a tick in the type of its output.
fn converted(value: schema::Value, like: &Value, sample_time: f64) -> Value {
    use schema::Value::{Choice, Judged, Named, Reading, Tick};
    match (like, value) {
        (Real(_), Tick(tick)) => Real(tick.map_or(f64::NAN, |tick| tick_time(tick, sample_time))),
        (Real(_), Reading(reading)) => Real(f64::from(reading.celsius.0)),
        (Real(_), other) => Real(f64::from(other.number())),
        (Text(_), Named((_, name)) | Choice(Some((_, name)))) => Text(name.to_owned()),
        (Text(_), _) => WORD,
        (Whole(_), Judged(None)) => UNJUDGED,
        (Whole(_), other) => Whole(other.number() as i32), // 0 of NaN
        (Flag(_), other) => Flag(other.number() == 1.0),
    }
}

/// The settings, as the parameters say.
fn config(values: &Values) -> anyhow::Result<Config> {
    let mut table = settings::preset(values.text("preset"))?;
    let given: Table = text_or_file(values.text("configuration"))?.parse().context("configuration")?;
    settings::merge(&mut table, &given);
    settings::from_table(table).context("configuration")
}

fn begin(values: &mut Values) -> anyhow::Result<Box<dyn Running>> {
    let preset = values.text("preset");
    if !preset.is_empty() {
        pt326_rig::RigConfig::preset(preset)?;
    }
    let config = config(values)?;
    let seeded = with_prbs_phase(&config, values.real("seed") as u64);
    let instrument = Instrument::new(&seeded).context("configuration")?;
    let sample_time = as_written(config.sample_time.0);
    values.tell("step_size", Real(sample_time));
    values.tell("setpoint_in_force", Real(f64::from(config.setpoint.0)));
    values.tell("mode", Text("off".into()));
    let ordered = Ordered { arm: false, acknowledge: false, relearn: false, setpoint: 0.0, fan: 100.0 };
    Ok(Box::new(Begun { instrument, usual: config.setpoint, sample_time, ordered }))
}

/// What its user wants, as the inputs said last.
#[derive(Clone, Copy, PartialEq)]
struct Ordered {
    arm: bool,
    acknowledge: bool,
    relearn: bool,
    setpoint: f64,
    fan: f64,
}

impl Ordered {
    fn read(values: &Values) -> Self {
        Self {
            arm: values.flag("arm"),
            acknowledge: values.flag("acknowledge"),
            relearn: values.flag("relearn"),
            setpoint: values.real("setpoint"),
            fan: values.real("fan"),
        }
    }

    /// The commands that lead here from what was wanted before; `usual` is the set-point of the configuration.
    fn since(self, before: Self, usual: Celsius) -> impl Iterator<Item = Command> {
        let setpoint = if self.setpoint == 0.0 { usual } else { Celsius(self.setpoint as f32) };
        let all = [
            (!self.arm && before.arm, Command::Stop),
            (self.acknowledge && !before.acknowledge, Command::Acknowledge),
            (self.arm && !before.arm, Command::Arm),
            (self.relearn && !before.relearn, Command::Relearn),
            (self.setpoint != before.setpoint, Command::SetPoint(setpoint)),
            (self.fan != before.fan, Command::Fan(Percent(self.fan as f32))),
        ];
        all.into_iter().filter(|(wanted, _)| *wanted).map(|(_, command)| command)
    }
}

/// An instrument at work.
struct Begun {
    instrument: Instrument,
    usual: Celsius,
    sample_time: f64,
    ordered: Ordered,
}

impl Running for Begun {
    fn sample_time(&self) -> f64 {
        self.sample_time
    }

    fn step(&mut self, values: &mut Values) -> Vec<String> {
        let wanted = Ordered::read(values);
        let commands = wanted.since(std::mem::replace(&mut self.ordered, wanted), self.usual);
        let refused = commands
            .filter_map(|command| {
                let refusal = self.instrument.command(command).err()?;
                Some(format!("{command:?} is refused: {refusal}"))
            })
            .collect();
        let [t0, t1, t2, supply] =
            ["code_t0", "code_t1", "code_t2", "code_supply"].map(|name| AdcCode(values.real(name) as f32));
        let tick = self.instrument.control(RawSample { t0, t1, t2, supply });
        let report = self.instrument.diagnose(&tick, tick.drive);
        let on = Moment::new(&tick, &report);
        for (name, source, like, _) in &SOURCES {
            let value = entry(source).number.value(&on);
            values.tell(name, converted(value, like, self.sample_time));
        }
        let sentence = report.likelihood.finding.map(|finding| {
            let sentence = Sentence {
                finding: &finding,
                sample: &tick.sample,
                expected: report.likelihood.expected,
                sample_time: self.sample_time as f32,
            };
            with_degree_sign(&sentence.to_string())
        });
        values.tell("sentence", Text(sentence.unwrap_or_default()));
        refused
    }
}
