//! Settings of the instrument.

use fdi_core::settings::Kind;
use pt326_host::settings;
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use toml::{Table, Value};

use crate::convert::{error, python, to_python, to_table, to_toml};

/// What there is to know of a setting.
#[pyclass(frozen, get_all, module = "pt326")]
pub(crate) struct Setting {
    /// Its name, as in `config["pid.kp"]`.
    name: &'static str,
    /// Its unit; empty for plain numbers and words.
    unit: &'static str,
    /// Its least value; None where it is no number.
    min: Option<f32>,
    /// Its largest value; None where it is no number.
    max: Option<f32>,
    /// The words of which it is one; empty for numbers and switches.
    words: Vec<&'static str>,
    /// What it is.
    doc: String,
}

#[pymethods]
impl Setting {
    fn __repr__(&self) -> String {
        format!("<pt326.Setting {}: {}>", self.name, self.doc)
    }
}

/// The settings of an instrument: those of a preset (`oven`, `hotend`, `tclab`; any other rig has the defaults), then changed.
///
/// `config["pid.kp"] = 3` sets one and checks it; `Config.settings()` says what each is, in which unit, and its bounds.
#[pyclass(eq, module = "pt326")]
#[derive(Clone, PartialEq)]
pub(crate) struct Config(pub(crate) fdi_core::Config);

#[pymethods]
impl Config {
    #[new]
    #[pyo3(signature = (preset: "str" = "paper"))]
    fn new(preset: &str) -> PyResult<Self> {
        python(pt326_rig::RigConfig::preset(preset))?;
        Ok(Self(python(settings::preset(preset).and_then(settings::from_table))?))
    }

    /// From TOML; keys that it leaves out have their defaults.
    #[staticmethod]
    fn from_toml(text: &str) -> PyResult<Self> {
        let table = text.parse::<Table>().map_err(error)?;
        Self::over(Table::new(), table)
    }

    /// From a dict; keys that it leaves out have their defaults.
    #[staticmethod]
    #[pyo3(signature = (settings: "dict[str, object]"))]
    fn from_dict(settings: &Bound<'_, PyAny>) -> PyResult<Self> {
        Self::over(Table::new(), to_table(settings)?)
    }

    /// As commented TOML, which `pt326 --config` reads, too.
    fn to_toml(&self) -> String {
        settings::commented_toml_of(&self.0)
    }

    /// As nested dicts.
    #[pyo3(signature = () -> "dict[str, object]")]
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.0)
    }

    /// What each setting is.
    #[staticmethod]
    fn settings() -> Vec<Setting> {
        let all = fdi_core::Config::documented();
        all.flat_map(|group| {
            group.settings.iter().zip(group.settings_about).map(|(setting, about)| Setting {
                name: setting.name,
                unit: setting.unit,
                min: setting.kind.bounds().map(|(min, _)| min),
                max: setting.kind.bounds().map(|(_, max)| max),
                words: match setting.kind {
                    Kind::Choice(forms) => forms.iter().map(|form| form.word).collect(),
                    _ => Vec::new(),
                },
                doc: about.text.lines().map(str::trim).collect::<Vec<_>>().join(" "),
            })
        })
        .collect()
    }

    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let mut value = Value::try_from(&self.0).map_err(error)?;
        for key in name.split('.') {
            let inner = value.as_table_mut().and_then(|table| table.remove(key));
            value = inner.ok_or_else(|| PyKeyError::new_err(name.to_owned()))?;
        }
        to_python(py, &value)
    }

    fn __setitem__(&mut self, name: &str, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let wrap = |inner, key: &str| Value::Table(Table::from_iter([(key.to_owned(), inner)]));
        let table = name.rsplit('.').fold(to_toml(value)?, wrap);
        let Value::Table(table) = table else { return Err(PyKeyError::new_err(name.to_owned())) };
        let now = Table::try_from(&self.0).map_err(error)?;
        let changed = Self::over(now, table)?.0;
        let setting = fdi_core::Config::settings().find(|setting| setting.name == name);
        setting.map_or(Ok(()), |setting| setting.check(changed.get(setting))).map_err(error)?;
        self.0 = changed;
        Ok(())
    }

    /// Refuses settings that make no instrument: that are out of bounds, or do not go together.
    fn check(&self) -> PyResult<()> {
        fdi_core::Instrument::new(&self.0).map(drop).map_err(error)
    }

    /// A copy, to be changed.
    fn copy(&self) -> Self {
        self.clone()
    }

    fn __copy__(&self) -> Self {
        self.clone()
    }

    fn __deepcopy__(&self, _memo: &Bound<'_, PyAny>) -> Self {
        self.clone()
    }

    /// Pickled as TOML.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        Ok((py.get_type::<Self>().getattr("from_toml")?, (self.to_toml(),)))
    }

    fn __repr__(&self) -> String {
        let (now, default) = (&self.0, fdi_core::Config::default());
        let changed = fdi_core::Config::settings().filter(|s| now.get(s) != default.get(s)).map(|s| s.name);
        format!("<pt326.Config, not as by default: {}>", changed.collect::<Vec<_>>().join(", "))
    }
}

impl Config {
    fn over(mut table: Table, changes: Table) -> PyResult<Self> {
        settings::merge(&mut table, &changes);
        Ok(Self(python(settings::from_table(table))?))
    }
}

/// The settings that were given, or the defaults.
pub(crate) fn or_default(config: Option<&Bound<'_, Config>>) -> fdi_core::Config {
    config.map_or_else(fdi_core::Config::default, |config| config.borrow().0.clone())
}
