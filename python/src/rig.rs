//! The simulated rig.

use fdi_core::RawSample;
use pt326_host::experiment::{as_written, sample, truth};
use pt326_rig::fault::Fault;
use pt326_rig::{Disturbance, RigConfig};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use pyo3::types::PyIterator;

use crate::convert::{Seed, error, from_table, python, refused, to_table};

/// What the inputs of the board read on a tick: codes of a converter of 12 bits. NaN where a sample went missing.
#[pyclass(frozen, eq, module = "pt326")]
#[derive(Clone, Copy, PartialEq)]
pub(crate) struct Codes(pub(crate) RawSample);

#[pymethods]
impl Codes {
    /// Codes of the three thermistors and of the heater's supply, which is 0 where it is not measured.
    #[new]
    #[pyo3(signature = (t0, t1, t2, supply = 0.0))]
    fn new(t0: f32, t1: f32, t2: f32, supply: f32) -> Self {
        Self(raw([t0, t1, t2, supply]))
    }

    /// Thermistor of the ambient air.
    #[getter]
    fn t0(&self) -> f32 {
        self.0.t0.0
    }

    /// Thermistor at the heater's outlet.
    #[getter]
    fn t1(&self) -> f32 {
        self.0.t1.0
    }

    /// Thermistor behind T1.
    #[getter]
    fn t2(&self) -> f32 {
        self.0.t2.0
    }

    /// Supply of the heater; 0 where it is not measured.
    #[getter]
    fn supply(&self) -> f32 {
        self.0.supply.0
    }

    fn __getnewargs__(&self) -> (f32, f32, f32, f32) {
        (self.t0(), self.t1(), self.t2(), self.supply())
    }

    fn __len__(&self) -> usize {
        4
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyIterator>> {
        self.__getnewargs__().into_pyobject(py)?.try_iter()
    }

    fn __getitem__(&self, index: usize) -> PyResult<f32> {
        let all = [self.t0(), self.t1(), self.t2(), self.supply()];
        all.get(index).copied().ok_or_else(|| PyIndexError::new_err("codes are t0, t1, t2 and supply"))
    }

    fn __repr__(&self) -> String {
        format!("Codes(t0={}, t1={}, t2={}, supply={})", self.t0(), self.t1(), self.t2(), self.supply())
    }
}

pub(crate) fn raw([t0, t1, t2, supply]: [f32; 4]) -> RawSample {
    let [t0, t1, t2, supply] = [t0, t1, t2, supply].map(fdi_core::AdcCode);
    RawSample { t0, t1, t2, supply }
}

/// The simulated rig in motion: power goes in, codes come out. It knows nothing of any instrument.
///
/// `preset` is one of `Rig.presets()`; `constants` changes some of its constants, with the keys of `[rig]` in `pt326 scenario`; `faults` are
/// dicts with the keys of `[[fault]]`. The sample time is that of the preset's instrument unless it is given, s.
#[pyclass(subclass, module = "pt326")]
pub(crate) struct Rig {
    rig: pt326_rig::Rig,
    sample_time: f64,
    tick: u32,
    faults: Vec<Fault>,
    codes: RawSample,
}

#[pymethods]
impl Rig {
    #[new]
    #[pyo3(signature = (preset: "str" = "trainer", seed: "int" = Seed(1), disturbance: "str" = "calm", *, sample_time = None, faults: "list[dict[str, object]] | None" = None, constants: "dict[str, object] | None" = None))]
    fn new(
        preset: &str,
        seed: Seed,
        disturbance: &str,
        sample_time: Option<f64>,
        faults: Option<Vec<Bound<'_, PyAny>>>,
        constants: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let mut table = constants.map(to_table).transpose()?.unwrap_or_default();
        table.insert("preset".into(), preset.into());
        let config: RigConfig = from_table(table)?;
        python(config.validate())?;
        let faults: Vec<Fault> = faults.unwrap_or_default().iter().map(fault).collect::<PyResult<_>>()?;
        let usual = python(pt326_host::settings::preset(preset).and_then(pt326_host::settings::from_table))?;
        let sample_time = sample_time.unwrap_or(as_written(usual.sample_time.0));
        if !(0.001..=10.0).contains(&sample_time) {
            return Err(refused(format!("sample_time is {sample_time}, expected 0.001 to 10 s")));
        }
        let mut rig =
            pt326_rig::Rig::new(&config, self::disturbance(disturbance)?, sample_time, seed.0, &faults);
        let codes = sample(&mut rig);
        Ok(Self { rig, sample_time, tick: 0, faults, codes })
    }

    /// Names of the rigs that there are.
    #[staticmethod]
    fn presets() -> Vec<&'static str> {
        RigConfig::presets().collect()
    }

    /// The codes of this tick.
    #[getter]
    fn codes(&self) -> Codes {
        Codes(self.codes)
    }

    /// Drives the heater with `power`, %, until the next tick, and gives the codes of that.
    fn step(&mut self, power: f64) -> PyResult<Codes> {
        if !(0.0..=100.0).contains(&power) {
            return Err(refused(format!("power is {power}, expected 0 to 100 %")));
        }
        self.rig.advance(power);
        self.tick += 1;
        self.codes = sample(&mut self.rig);
        Ok(Codes(self.codes))
    }

    /// Lets something happen that a dict describes, with the keys of `[[fault]]`; `at` counts from now, s. The next codes are the first that show it.
    #[pyo3(signature = (fault: "dict[str, object]"))]
    fn inject(&mut self, fault: &Bound<'_, PyAny>) -> PyResult<()> {
        let fault = self::fault(fault)?;
        self.faults.push(Fault { at: self.t() + fault.at, ..fault.clone() });
        self.rig.inject(fault);
        Ok(())
    }

    /// Ends all that happens, and forgets what was still to come.
    fn mend(&mut self) {
        self.faults.clear();
        self.rig.clear();
    }

    /// Sets the fan, % of its nominal level.
    fn fan(&mut self, level: f64) -> PyResult<()> {
        let most = fdi_core::supervisor::FASTEST_FAN;
        if !(0.0..=f64::from(most)).contains(&level) {
            return Err(refused(format!("fan is {level}, expected 0 to {most} %")));
        }
        self.rig.set_fan(level / 100.0);
        Ok(())
    }

    /// Time of this tick, s.
    #[getter]
    fn t(&self) -> f64 {
        f64::from(self.tick) * self.sample_time
    }

    /// Ts, s.
    #[getter]
    fn sample_time(&self) -> f64 {
        self.sample_time
    }

    /// Number of the fault that acts now, as in the column `truth` of a trace; 0 for none.
    #[getter]
    fn truth(&self) -> u8 {
        truth(&self.faults, self.t())
    }

    /// The true temperature of the air at T1 and at T2, without turbulence, degC.
    #[getter]
    fn air(&self) -> (f64, f64) {
        self.rig.air().into()
    }

    /// How far the input that is worst off reads from what it would read without any fault of a sensor, degC.
    #[getter]
    fn sensor_error(&self) -> f64 {
        self.rig.sensor_error()
    }

    fn __repr__(&self) -> String {
        format!("<pt326.Rig at {:.2} s>", self.t())
    }
}

fn fault(of: &Bound<'_, PyAny>) -> PyResult<Fault> {
    let fault: Fault = from_table(to_table(of)?)?;
    python(fault.validate("fault"))?;
    Ok(fault)
}

/// How much the surroundings move, by its name.
pub(crate) fn disturbance(name: &str) -> PyResult<Disturbance> {
    name.parse().map_err(|why| error(anyhow::anyhow!("disturbance {name:?}: {why}")))
}
