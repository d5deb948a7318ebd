//! modelDescription.xml and the terminals of a model, from its list of variables.

use std::io::Cursor;

use quick_xml::Writer;
use quick_xml::writer::ElementWriter;

use crate::model::{Model, TERMINALS};
use crate::variable::{Role, Value, Variable};

/// An XML text in the making.
type Xml = Writer<Cursor<Vec<u8>>>;

/// Units by their base units: name, factor, offset, exponents of kelvin and second.
const UNITS: [(&str, f64, f64, i32, i32); 5] = [
    ("%", 0.01, 0.0, 0, 0),
    ("degC", 1.0, 273.15, 1, 0),
    ("degC/%", 100.0, 0.0, 1, 0),
    ("s", 1.0, 0.0, 0, 1),
    ("1/s", 1.0, 0.0, 0, -1),
];

/// What the paper's experiment takes: its length and its sample time, s.
const EXPERIMENT: (f64, f64) = (850.0, 0.11);

/// modelDescription.xml.
///
/// # Errors
/// None: it is written to memory.
pub fn model_description(model: &Model) -> std::io::Result<String> {
    let mut xml = begun();
    let token = model.token();
    let root = [
        ("fmiVersion", "3.0"),
        ("modelName", model.title),
        ("instantiationToken", &token),
        ("description", model.about),
        ("version", env!("CARGO_PKG_VERSION")),
        ("license", env!("CARGO_PKG_LICENSE")),
        ("generationTool", "pt326-fmu"),
        ("variableNamingConvention", "structured"),
    ];
    let root = xml.create_element("fmiModelDescription").with_attributes(root);
    root.write_inner_content(|xml| {
        co_simulation(xml, model)?;
        units(xml, model)?;
        xml.create_element("LogCategories").write_inner_content(|xml| {
            for name in ["logStatusWarning", "logStatusError", "logStatusFatal"] {
                xml.create_element("Category").with_attribute(("name", name)).write_empty()?;
            }
            Ok(())
        })?;
        let (stop, step) = (EXPERIMENT.0.to_string(), EXPERIMENT.1.to_string());
        let experiment = [("startTime", "0"), ("stopTime", &*stop), ("stepSize", &*step)];
        xml.create_element("DefaultExperiment").with_attributes(experiment).write_empty()?;
        xml.create_element("ModelVariables").write_inner_content(|xml| {
            model.variables.iter().enumerate().try_for_each(|(place, each)| variable(xml, place, each))
        })?;
        structure(xml, model)
    })?;
    Ok(text(xml))
}

/// terminalsAndIcons/terminalsAndIcons.xml.
///
/// # Errors
/// None: it is written to memory.
pub fn terminals() -> std::io::Result<String> {
    let mut xml = begun();
    let root = xml.create_element("fmiTerminalsAndIcons").with_attribute(("fmiVersion", "3.0"));
    root.write_inner_content(|xml| {
        xml.create_element("Terminals").write_inner_content(|xml| {
            for terminal in &TERMINALS {
                let about =
                    [("name", terminal.name), ("matchingRule", "plug"), ("description", terminal.about)];
                xml.create_element("Terminal").with_attributes(about).write_inner_content(|xml| {
                    for member in terminal.members {
                        let of =
                            [("variableKind", "signal"), ("memberName", member), ("variableName", member)];
                        xml.create_element("TerminalMemberVariable").with_attributes(of).write_empty()?;
                    }
                    Ok(())
                })?;
            }
            Ok(())
        })?;
        Ok(())
    })?;
    Ok(text(xml))
}

fn begun() -> Xml {
    Writer::new_with_indent(Cursor::new(Vec::new()), b' ', 2)
}

fn text(xml: Xml) -> String {
    let written = String::from_utf8_lossy(&xml.into_inner().into_inner()).into_owned();
    format!("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n{written}\n")
}

fn co_simulation(xml: &mut Xml, model: &Model) -> std::io::Result<()> {
    let step = EXPERIMENT.1.to_string();
    let about = [
        ("modelIdentifier", model.identifier),
        ("canHandleVariableCommunicationStepSize", "false"),
        ("fixedInternalStepSize", &*step),
        ("canGetAndSetFMUState", "false"),
        ("canBeInstantiatedOnlyOncePerProcess", "false"),
        ("hasEventMode", "false"),
    ];
    xml.create_element("CoSimulation").with_attributes(about).write_empty().map(drop)
}

/// The units that the variables have.
fn units(xml: &mut Xml, model: &Model) -> std::io::Result<()> {
    let used = |unit: &str| model.variables.iter().any(|variable| variable.unit == unit);
    xml.create_element("UnitDefinitions").write_inner_content(|xml| {
        for (name, factor, offset, kelvin, second) in UNITS.into_iter().filter(|unit| used(unit.0)) {
            xml.create_element("Unit").with_attribute(("name", name)).write_inner_content(|xml| {
                let all = [
                    ("K", f64::from(kelvin)),
                    ("s", f64::from(second)),
                    ("factor", factor),
                    ("offset", offset),
                ];
                let usual = |(name, value): &(&str, f64)| *value == f64::from(*name == "factor");
                let told =
                    all.iter().filter(|each| !usual(each)).map(|(name, value)| (*name, value.to_string()));
                with_all(xml.create_element("BaseUnit"), told).write_empty().map(drop)
            })?;
        }
        Ok(())
    })?;
    Ok(())
}

fn with_all<'a>(
    element: ElementWriter<'a, Cursor<Vec<u8>>>,
    attributes: impl Iterator<Item = (&'static str, String)>,
) -> ElementWriter<'a, Cursor<Vec<u8>>> {
    attributes.fold(element, |element, (name, value)| element.with_attribute((name, value.as_str())))
}

fn variable(xml: &mut Xml, place: usize, variable: &Variable) -> std::io::Result<()> {
    let real = matches!(variable.start, Value::Real(_));
    let moving = if real { "continuous" } else { "discrete" };
    let (causality, variability, initial) = match variable.role {
        Role::Time => ("independent", "continuous", None),
        Role::Parameter => ("parameter", "fixed", Some("exact")),
        Role::Calculated => ("calculatedParameter", "fixed", Some("calculated")),
        Role::Input => ("input", moving, None),
        Role::Output => ("output", moving, Some("calculated")),
    };
    let mut about = vec![
        ("name", variable.name.clone()),
        ("valueReference", place.to_string()),
        ("causality", causality.to_owned()),
        ("variability", variability.to_owned()),
    ];
    about.extend(initial.map(|initial| ("initial", initial.to_owned())));
    about.push(("description", variable.about.to_owned()));
    if !variable.unit.is_empty() {
        about.push(("unit", variable.unit.to_owned()));
    }
    if let Some((min, max)) = variable.bounds {
        about.extend([("min", min.to_string()), ("max", max.to_string())]);
    }
    let starts = matches!(variable.role, Role::Parameter | Role::Input);
    let start = match &variable.start {
        Value::Real(x) => x.to_string(),
        Value::Whole(n) => n.to_string(),
        Value::Flag(on) => on.to_string(),
        Value::Text(start) => {
            let element = with_all(xml.create_element("String"), about.into_iter());
            return match starts {
                true => element.write_inner_content(|xml| {
                    let start = [("value", start.as_str())];
                    xml.create_element("Start").with_attributes(start).write_empty().map(drop)
                }),
                false => element.write_empty(),
            }
            .map(drop);
        }
    };
    about.extend(starts.then_some(("start", start)));
    with_all(xml.create_element(variable.start.type_name()), about.into_iter()).write_empty().map(drop)
}

/// What depends on others: outputs, and of these and the calculated parameters what is known before the first step.
fn structure(xml: &mut Xml, model: &Model) -> std::io::Result<()> {
    xml.create_element("ModelStructure").write_inner_content(|xml| {
        let of = |role| move |(_, each): &(usize, &Variable)| each.role == role;
        let all = || model.variables.iter().enumerate();
        for (place, _) in all().filter(of(Role::Output)) {
            let place = place.to_string();
            xml.create_element("Output").with_attribute(("valueReference", &*place)).write_empty()?;
        }
        for (place, _) in all().filter(|each| of(Role::Calculated)(each) || of(Role::Output)(each)) {
            let place = place.to_string();
            xml.create_element("InitialUnknown").with_attribute(("valueReference", &*place)).write_empty()?;
        }
        Ok(())
    })?;
    Ok(())
}
