//! The exercises of the page: a file each in `exercises/`, checked before they go into the page. docs/exercises.md says how one is written.

use std::collections::BTreeMap;

use anyhow::{Context, bail, ensure};
use pt326_rig::RigConfig;
use serde::Deserialize;
use serde_json::{Value, json};

use crate::protocol;
use crate::scene::{Order, Scene};
use crate::session::Session;

/// Name and text of every file, in the order of the names.
const FILES: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/exercises.rs"));

/// What the page can do by a name; see `page/acts.js`.
const ACTS: [&str; 2] = ["mend", "surprise"];
/// What of the page can be looked at, as a selector, and what can be unfolded.
const PLACES: [&str; 5] = [".rig", ".charts", ".say", "aside", "#modes"];
const FOLDS: [&str; 5] = ["charts", "residuals", "why", "measure", "desk"];

/// A text in the languages of the page.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Words {
    en: String,
    pt: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Exercise {
    title: Words,
    text: Words,
    look: Option<String>,
    opens: Option<String>,
    button: Option<Words>,
    #[serde(default)]
    does: Vec<Value>,
    scene: Option<Scene>,
    at: Option<u32>,
    show: Option<[f64; 2]>,
    #[serde(default)]
    ask: Vec<Ask>,
    after: Option<Words>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Ask {
    ask: Words,
    #[serde(default)]
    unit: String,
    answer: Option<String>,
    within: Option<String>,
    #[serde(default)]
    wrong: Vec<Wrong>,
    #[serde(default)]
    choices: Vec<Choice>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Wrong {
    answer: String,
    say: Words,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Choice {
    is: Words,
    say: Words,
    #[serde(default)]
    right: bool,
}

impl Words {
    fn check(&self, what: &str) -> anyhow::Result<()> {
        for (language, text) in [("en", &self.en), ("pt", &self.pt)] {
            ensure!(!text.trim().is_empty(), "{what}: {language} is empty, expected a text");
        }
        Ok(())
    }
}

impl Exercise {
    fn check(&self) -> anyhow::Result<()> {
        self.title.check("title")?;
        self.text.check("text")?;
        one_of("look", self.look.as_deref(), &PLACES)?;
        one_of("opens", self.opens.as_deref(), &FOLDS)?;
        let acts = !self.does.is_empty() || self.scene.is_some();
        ensure!(
            acts == self.button.is_some(),
            "button: expected where there is scene or does, and nowhere else"
        );
        ensure!(
            self.scene.is_some() == self.at.is_some(),
            "at: expected with scene: how many ticks it runs at once"
        );
        ensure!(
            self.ask.is_empty() == self.after.is_none(),
            "after: expected with ask: what is told once all is right"
        );
        for (i, does) in self.does.iter().enumerate() {
            let order =
                || serde_json::from_value::<Order>(does.clone()).map_err(anyhow::Error::from)?.validate();
            let checked = does.as_str().map_or_else(order, |act| one_of("act", Some(act), &ACTS));
            checked.with_context(|| format!("does {}", i + 1))?;
        }
        if let Some(scene) = &self.scene {
            Session::new(scene.clone()).map(drop).context("scene")?;
        }
        if let (Some([from, to]), Some(at)) = (self.show, self.at) {
            ensure!(
                0.0 <= from && from < to,
                "show: [{from}, {to}], expected two times in s, the first one less"
            );
            ensure!(at > 0, "at: 0, expected at least one tick");
        }
        let rig = self.scene.clone().unwrap_or_default().rig()?;
        for (i, ask) in self.ask.iter().enumerate() {
            ask.check(&rig).with_context(|| format!("ask {}", i + 1))?;
        }
        Ok(())
    }
}

impl Ask {
    fn check(&self, rig: &RigConfig) -> anyhow::Result<()> {
        self.ask.check("ask")?;
        for say in self.wrong.iter().map(|one| &one.say).chain(self.choices.iter().map(|one| &one.say)) {
            say.check("say")?;
        }
        if !self.choices.is_empty() {
            ensure!(
                self.answer.is_none() && self.within.is_none() && self.unit.is_empty(),
                "answer, within, unit: expected only without choices"
            );
            let right = self.choices.iter().filter(|choice| choice.right).count();
            ensure!(
                right > 0 && right < self.choices.len(),
                "choices: {right} are right, expected one and a wrong one"
            );
            return self.choices.iter().try_for_each(|choice| choice.is.check("is"));
        }
        let answer = self.answer.as_deref().context("expected answer, or choices")?;
        let within =
            self.within.as_deref().context("within: expected as \"5 %\" or, in the unit, \"0.1\"")?;
        let number = within.strip_suffix(" %").unwrap_or(within).parse::<f64>();
        ensure!(
            number.is_ok_and(|x| x > 0.0),
            "within: {within:?}, expected as \"5 %\" or, in the unit, \"0.1\""
        );
        for expression in self.wrong.iter().map(|one| one.answer.as_str()).chain([answer]) {
            value(expression, rig).with_context(|| format!("answer {expression:?}"))?;
        }
        Ok(())
    }
}

fn one_of(what: &str, value: Option<&str>, all: &[&str]) -> anyhow::Result<()> {
    match value {
        Some(value) if !all.contains(&value) => {
            bail!("{what}: {value:?}, expected one of {}", all.join(", "))
        }
        _ => Ok(()),
    }
}

/// What an answer is: numbers and constants of the rig with + - * / and brackets.
fn value(expression: &str, rig: &RigConfig) -> anyhow::Result<f64> {
    let known = constants(rig)?;
    let spaced = "+-*/()".chars().fold(expression.to_owned(), |text, c| text.replace(c, &format!(" {c} ")));
    let words: Vec<_> = spaced.split_whitespace().collect();
    let mut rest = words.as_slice();
    let value = sum(&mut rest, &known)?;
    ensure!(
        rest.is_empty() && value.is_finite(),
        "expected numbers, constants of the rig, + - * / and brackets"
    );
    Ok(value)
}

fn sum(rest: &mut &[&str], known: &BTreeMap<String, Value>) -> anyhow::Result<f64> {
    let mut value = product(rest, known)?;
    while let [sign @ ("+" | "-"), after @ ..] = *rest {
        *rest = after;
        let next = product(rest, known)?;
        value = if *sign == "+" { value + next } else { value - next };
    }
    Ok(value)
}

fn product(rest: &mut &[&str], known: &BTreeMap<String, Value>) -> anyhow::Result<f64> {
    let mut value = one(rest, known)?;
    while let [sign @ ("*" | "/"), after @ ..] = *rest {
        *rest = after;
        let next = one(rest, known)?;
        value = if *sign == "*" { value * next } else { value / next };
    }
    Ok(value)
}

fn one(rest: &mut &[&str], known: &BTreeMap<String, Value>) -> anyhow::Result<f64> {
    let [word, after @ ..] = *rest else { bail!("it ends where a number or a constant was expected") };
    *rest = after;
    match *word {
        "-" => return Ok(-one(rest, known)?),
        "(" => {
            let value = sum(rest, known)?;
            ensure!(rest.first() == Some(&")"), "a bracket is not closed");
            *rest = &rest[1..];
            return Ok(value);
        }
        _ => {}
    }
    let names = || known.keys().map(String::as_str).collect::<Vec<_>>().join(", ");
    let value = word.parse().ok().or_else(|| known.get(*word)?.as_f64());
    value.with_context(|| {
        format!("{word} is no number and no constant of the rig, expected one of {}", names())
    })
}

/// The numbers of a rig by name.
fn constants(rig: &RigConfig) -> anyhow::Result<BTreeMap<String, Value>> {
    let Value::Object(all) = serde_json::to_value(rig)? else { bail!("a rig is no table") };
    Ok(all.into_iter().filter(|(_, value)| value.is_number()).collect())
}

/// What stands under a key; nothing where the key is not there.
fn list<'a>(of: &'a mut Value, key: &str) -> impl Iterator<Item = &'a mut Value> {
    of.get_mut(key).and_then(Value::as_array_mut).into_iter().flatten()
}

/// The number in place of an answer's expression, where there is one.
fn calculate(of: &mut Value, rig: &RigConfig) -> anyhow::Result<()> {
    if let Some(answer) = of.get_mut("answer") {
        *answer = json!(value(answer.as_str().unwrap_or_default(), rig)?);
    }
    Ok(())
}

/// An exercise for the page: its answers are calculated.
fn read(text: &str) -> anyhow::Result<Value> {
    let exercise: Exercise = protocol::read(text.as_bytes())?;
    exercise.check()?;
    let rig = exercise.scene.unwrap_or_default().rig()?;
    let mut told: Value = serde_json::from_str(text)?;
    for ask in list(&mut told, "ask") {
        calculate(ask, &rig)?;
        for wrong in list(ask, "wrong") {
            calculate(wrong, &rig)?;
        }
    }
    Ok(told)
}

/// The module of the page: all exercises, each with its `id`.
///
/// # Errors
/// A file that is none: which, where in it, and what was expected.
pub fn module() -> anyhow::Result<String> {
    let mut exercises = Vec::new();
    for (name, text) in FILES {
        let mut exercise = read(text).with_context(|| format!("exercises/{name}.json"))?;
        exercise["id"] = json!(name);
        exercises.push(exercise);
    }
    Ok(format!("export const EXERCISES={};\n", json!(exercises)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_is_an_exercise() {
        let module = module().unwrap_or_else(|error| panic!("{error:#}"));
        assert!(!module.contains("null"), "what a file leaves out stays out: the page has defaults for it");
        assert!(FILES.len() > 20, "{}", FILES.len());
    }

    #[test]
    fn an_answer_is_calculated_as_it_is_read() {
        let rig = RigConfig::preset("oven").unwrap();
        assert_eq!(value("-2 + 3 * (dead_time - 1) / gain", &rig).unwrap(), 8.0);
        assert!(["", "2 3", "gain gain", "1 / 0"].iter().all(|text| value(text, &rig).is_err()));
    }

    /// The example of the book is an exercise, and what it says of a wrong one is what is said.
    #[test]
    fn the_books_example_is_an_exercise() {
        let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/exercises.md");
        let page = std::fs::read_to_string(page).unwrap();
        let block =
            |kind: &str| page.split_once(kind).and_then(|(_, rest)| rest.split_once("```")).unwrap().0;
        let example = block("```json\n");
        read(example).unwrap();
        let error = read(&example.replace("100 * (1 - 0.9 * 0.9)", "1 / gian")).unwrap_err();
        let scene = page.split("```json\n").nth(2).and_then(|rest| rest.split_once("```")).unwrap().0;
        let scene: Value = serde_json::from_str(&format!("{{{scene}}}")).unwrap();
        Session::new(serde_json::from_value(scene["scene"].clone()).unwrap()).map(drop).unwrap();
        let told = format!("lab: exercises/50-mains.json: {error:#}");
        assert!(told.starts_with(block("```text\n").trim_end().trim_end_matches("...")), "{told}");
    }

    /// What is wrong, where, and what was expected.
    #[test]
    fn a_file_that_is_none_says_why() {
        let words = json!({ "en": "a", "pt": "a" });
        let ask = json!({ "ask": words, "answer": "1 / gain", "within": "5 %" });
        let good = json!({ "title": words, "text": words, "after": words, "ask": [ask] });
        read(&good.to_string()).unwrap();
        let told = |place: &str, value: Value| {
            let mut file = good.clone();
            match place.rsplit_once('/') {
                Some(("", key)) => file[key] = value,
                Some((at, key)) => file.pointer_mut(at).unwrap()[key] = value,
                None => unreachable!("a pointer"),
            }
            format!("{:#}", read(&file.to_string()).unwrap_err())
        };
        for (place, value, expected) in [
            ("/titel", json!(1), "unknown field `titel`, expected one of `title`, `text`"),
            ("/title/pt", json!(" "), "title: pt is empty"),
            ("/look", json!("nose"), "look: \"nose\", expected one of .rig, .charts"),
            ("/does", json!(["mend"]), "button: expected where there is scene or does"),
            (
                "/ask/0/answer",
                json!("1 / gian"),
                "ask 1: answer \"1 / gian\": gian is no number and no constant of the rig, expected one of adc_bits, ambient",
            ),
            (
                "/ask/0/answer",
                json!("2 * (1 + gain"),
                "ask 1: answer \"2 * (1 + gain\": a bracket is not closed",
            ),
            ("/ask/0/within", json!("much"), "ask 1: within: \"much\", expected as \"5 %\""),
            (
                "/ask/0/choices",
                json!([{ "is": words, "say": words }]),
                "ask 1: answer, within, unit: expected only without choices",
            ),
        ] {
            let error = told(place, value);
            assert!(error.contains(expected), "{place}: {error}");
        }
        let mut scene = good.clone();
        scene["button"] = words.clone();
        scene["scene"] = json!({ "preset": "kettle" });
        scene["at"] = json!(10);
        let error = format!("{:#}", read(&scene.to_string()).unwrap_err());
        assert!(error.contains("scene: no preset \"kettle\", expected paper"), "{error}");
        let mut orders = good;
        orders["button"] = words;
        orders["does"] = json!([{ "order": "setpoint", "celsius": 40 }, { "order": "brek" }]);
        let error = format!("{:#}", read(&orders.to_string()).unwrap_err());
        assert!(error.contains("does 2: unknown variant `brek`, expected one of `arm`"), "{error}");
    }
}
