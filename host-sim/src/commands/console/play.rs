//! What a board's console does not have: time that passes, wires that are wrong, faults of the rig.

use anyhow::{Context, bail, ensure};

use super::output_stage::Defect;
use pt326_rig::fault::{Fault, Sensor, Verb};

/// Added to the board's own help.
pub(super) const HELP: &str = "Of the simulated rig alone:
wait SECONDS\tlets time pass
wire WRONG\twires the rig wrongly, WRONG being one of: swap tA tB; detached t1|t2; stuck tN; open tN; short tN;
\tunheated; backwards; mosfet shorted; contactor welded; interlock open; break ignored
wire ok\tmends all wires and ends all faults, those to come included
fault VERB [tN] [SIZE] [SECONDS]\tsomething happens to the rig, such as: fault offset t2 1.5 25, fault air-flow 0.7
";

/// One of these requests.
#[derive(Debug)]
pub enum Play {
    /// Time passes, s.
    Wait(f64),
    /// Something happens to the rig.
    Rig(Vec<Fault>),
    /// Something is wrong with the output stage.
    Power(Defect),
    /// All is well again.
    Mend,
}

impl Play {
    /// Reads a line; `None` where it is for the board.
    ///
    /// # Errors
    /// The word that is wrong, and what was expected.
    pub fn parse(line: &str) -> anyhow::Result<Option<Self>> {
        let words: Vec<&str> = line.split_whitespace().collect();
        Ok(Some(match words[..] {
            ["wait", seconds] => match seconds.parse() {
                Ok(seconds) if (0.0..=1e6).contains(&seconds) => Self::Wait(seconds),
                _ => bail!("wait: \"{seconds}\", expected seconds, 0 to 1000000"),
            },
            ["wire", ref wrong @ ..] => wire(wrong)?,
            ["fault", verb, ref rest @ ..] => Self::Rig(vec![fault(verb, rest)?]),
            _ => return Ok(None),
        }))
    }
}

fn wire(words: &[&str]) -> anyhow::Result<Play> {
    use Sensor::{T0, T1, T2};
    let lasting = |verb, sensor, size| Fault::new(verb, Some(sensor), size, 0.0, f64::INFINITY);
    let swapped = |a, b| Fault { with: Some(b), ..lasting(Verb::Swap, a, None) };
    let faults = match *words {
        ["ok"] => return Ok(Play::Mend),
        ["mosfet", "shorted"] => return Ok(Play::Power(Defect::MosfetShorted)),
        ["contactor", "welded"] => return Ok(Play::Power(Defect::ContactorWelded)),
        ["interlock", "open"] => return Ok(Play::Power(Defect::InterlockOpen)),
        ["break", "ignored"] => return Ok(Play::Power(Defect::BreakIgnored)),
        ["unheated"] => return Ok(Play::Power(Defect::NoHeater)),
        ["swap", a, b] => vec![swapped(sensor(a)?, sensor(b)?)],
        ["detached", name] => vec![lasting(Verb::Detach, sensor(name)?, Some(1.0))],
        ["stuck", name] => vec![lasting(Verb::Stuck, sensor(name)?, None)],
        ["open", name] => vec![lasting(Verb::Open, sensor(name)?, None)],
        ["short", name] => vec![lasting(Verb::Short, sensor(name)?, None)],
        // The warm air leaves where the room's comes in: T0 hangs in it, T1 and T2 do not.
        ["backwards"] => vec![swapped(T0, T1), lasting(Verb::Detach, T2, Some(1.0))],
        _ => bail!("wire: \"{}\" given, expected one of those that `help` lists", words.join(" ")),
    };
    faults.iter().try_for_each(|fault| fault.validate("wire"))?;
    Ok(Play::Rig(faults))
}

fn sensor(name: &str) -> anyhow::Result<Sensor> {
    Ok(match name {
        "t0" => Sensor::T0,
        "t1" => Sensor::T1,
        "t2" => Sensor::T2,
        _ => bail!("\"{name}\" given, expected t0, t1 or t2"),
    })
}

/// `VERB [tN] [SIZE] [SECONDS]`: a verb without a size takes the first number for its duration.
fn fault(verb: &str, words: &[&str]) -> anyhow::Result<Fault> {
    let known: Verb = serde_json::from_value(verb.into())
        .map_err(|_| anyhow::anyhow!("fault: no verb \"{verb}\", see `pt326 scenario`"))?;
    let (sensor, numbers) = match words {
        [name, rest @ ..] if name.starts_with('t') => (Some(sensor(name)?), rest),
        rest => (None, rest),
    };
    let numbers: Vec<f64> = numbers
        .iter()
        .map(|word| word.parse().with_context(|| format!("fault: \"{word}\" given, expected a number")))
        .collect::<anyhow::Result<_>>()?;
    ensure!(numbers.len() <= 2, "fault: {} numbers given, expected SIZE and SECONDS at most", numbers.len());
    let make = |size: Option<f64>, seconds: Option<&f64>| {
        Fault::new(known, sensor, size, 0.0, seconds.copied().unwrap_or(f64::INFINITY))
    };
    let sized = make(numbers.first().copied(), numbers.get(1));
    let unsized_one = make(None, numbers.first());
    if numbers.len() < 2 && unsized_one.validate("fault").is_ok() {
        return Ok(unsized_one);
    }
    sized.validate("fault")?;
    Ok(sized)
}
