//! A heating and a cooling coil in one stream of air, judged by what physics says without a model; docs/scores.md has the rules.
//!
//! Example: both valves are shut, and the air behind the coils is 7 °C warmer than before them, where the fan alone made it 0.4 °C warmer on the
//! day that was learnt from. So heat comes that nobody asks for, or a thermistor is wrong. With the cooling valve open the air before the coils
//! becomes colder, and it is 11 °C: an error would be the same for all air, the heat of warm water is not.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail, ensure};
use fdi_core::Observed;
use serde::Deserialize;

use crate::recording::table::Table;
use crate::recording::{Reading, Recording};

/// Rules, files and truth.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct AirHandler {
    /// What it is and where its files come from.
    about: String,
    /// The rules' numbers.
    coils: Rules,
    /// How a file is read: t0 before the coils, t1 behind them, power the heating valve, known the cooling valve.
    reading: Reading,
    /// The column that is 0 where nothing is wrong.
    faulted: Option<String>,
    /// The files that one training serves.
    #[serde(rename = "season")]
    seasons: Vec<Season>,
    /// What was wrong in which file, as far as it is known.
    #[serde(default)]
    truth: BTreeMap<String, String>,
}

/// Numbers of the rules; shares are of full scale.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Rules {
    /// Least level of the fan.
    still: f32,
    /// A valve below is shut.
    shut: f32,
    /// Least opening of a cooling valve that counts.
    cools: f32,
    /// The same of a heating valve.
    heats: f32,
    /// Samples that a state has lasted before it counts.
    settle: usize,
    /// Samples of a state before it is judged.
    least: usize,
    /// What is as good as nothing, degC.
    margin: f32,
    /// Share of the learnt heat that is as good as none.
    arrives: f32,
}

/// Files of one kind.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Season {
    /// How their names begin.
    begins: String,
    /// The one that is learnt from.
    training: String,
}

/// What is said.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Said {
    /// Heat comes that nobody asks for, or what is asked for does not come.
    Heater,
    /// The first, or T1 reads too high.
    HeaterOrT1,
    /// Something cools though it was not asked to, or T1 reads too low.
    CoolerOrT1,
}

impl Said {
    /// In words.
    fn words(self) -> &'static str {
        match self {
            Self::Heater => "the heater",
            Self::HeaterOrT1 => "the heater or T1",
            Self::CoolerOrT1 => "the cooling coil or T1",
        }
    }
}

/// Which valves are open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Shut,
    Cooling,
    Heating,
}

/// T1 less T0 when shut, and the heat of the whole valve, in degC.
#[derive(Clone, Copy, Debug)]
struct Usual {
    shut: f32,
    heat: Option<f32>,
}

/// What was seen of a part of a recording: of shut, cooling and heating the median beyond what is usual, degC, and the share of the heat that
/// arrived. None where a state did not last.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    shut: Option<f32>,
    cooling: Option<f32>,
    heating: Option<f32>,
    arrives: Option<f32>,
}

/// A sample that counts: T1 less T0 in degC and the opening of the heating valve.
struct Minute {
    state: State,
    rise: f32,
    valve: f32,
}

impl Rules {
    /// Which state a sample is in; none: no rule is about it, or something is missing.
    fn state(&self, sample: &Observed, full: f32) -> Option<State> {
        /// Levels of the fan are in %.
        const FAN: f32 = 100.0;
        let (heat, cool) = (sample.power? / full, sample.beside? / full);
        // A fan that never moves is at its usual level, and has none.
        if sample.fan.is_some_and(|fan| fan < self.still * FAN) {
            return None;
        }
        match () {
            () if heat < self.shut && cool < self.shut => Some(State::Shut),
            () if heat < self.shut && cool > self.cools => Some(State::Cooling),
            () if heat > self.heats && cool < self.shut => Some(State::Heating),
            () => None,
        }
    }

    /// The samples of states that have lasted for `settle`.
    fn minutes(&self, recording: &Recording, settle: usize) -> Vec<Option<Minute>> {
        let (full, celsius) = (recording.units.full_power, recording.units.celsius);
        let (mut lasted, mut last) = (0, None);
        let minute = |sample: &Observed| {
            let state = self.state(sample, full);
            lasted = if state == last { lasted + 1 } else { 0 };
            last = state;
            let rise = (sample.t[1]? - sample.t[0]?) * celsius;
            Some(Minute { state: state?, rise, valve: sample.power? / full }).filter(|_| lasted >= settle)
        };
        recording.heaters[0].samples.iter().map(minute).collect()
    }

    /// Learns what is usual.
    fn learn(&self, recording: &Recording) -> anyhow::Result<Usual> {
        let settled = self.minutes(recording, self.settle);
        let shut = self.median(settled.iter().flatten(), State::Shut, |minute| minute.rise);
        let shut = shut
            .context("both valves are hardly ever shut: expected a day without a fault on which they are")?;
        // Heating hardly ever lasts on a mild day, so each sample counts.
        let heating = self.minutes(recording, 0);
        let heating: Vec<&Minute> =
            heating.iter().flatten().filter(|minute| minute.state == State::Heating).collect();
        let along: f32 = heating.iter().map(|minute| minute.valve * (minute.rise - shut)).sum();
        let square: f32 = heating.iter().map(|minute| minute.valve * minute.valve).sum();
        let heat = along / square;
        Ok(Usual { shut, heat: (heating.len() >= self.least && heat > self.margin).then_some(heat) })
    }

    /// The median over the samples of a state; none if there are too few.
    fn median<'a>(
        &self,
        minutes: impl Iterator<Item = &'a Minute>,
        state: State,
        of: impl Fn(&Minute) -> f32,
    ) -> Option<f32> {
        let mut values: Vec<f32> = minutes.filter(|minute| minute.state == state).map(of).collect();
        values.sort_by(f32::total_cmp);
        values.get(values.len() / 2).copied().filter(|_| values.len() >= self.least)
    }

    fn see(&self, minutes: &[Option<Minute>], usual: Usual) -> Seen {
        let excess = |state| self.median(minutes.iter().flatten(), state, |minute| minute.rise - usual.shut);
        let arrives = usual.heat.and_then(|heat| {
            let share = |minute: &Minute| (minute.rise - usual.shut) / (heat * minute.valve);
            self.median(minutes.iter().flatten(), State::Heating, share)
        });
        Seen {
            shut: excess(State::Shut),
            cooling: excess(State::Cooling),
            heating: excess(State::Heating),
            arrives,
        }
    }

    /// What is said of it.
    fn say(&self, seen: &Seen) -> Option<Said> {
        let warm = |excess: f32| excess > self.margin;
        let cold = |excess: f32| excess < -self.margin;
        match *seen {
            // Colder air is warmed by more, which no error of a thermistor does.
            Seen { shut: Some(shut), cooling: Some(cooling), .. } if warm(shut) && warm(cooling - shut) => {
                Some(Said::Heater)
            }
            Seen { shut: Some(shut), .. } if warm(shut) => Some(Said::HeaterOrT1),
            Seen { shut, heating, .. } if shut.is_some_and(cold) || heating.is_some_and(cold) => {
                Some(Said::CoolerOrT1)
            }
            Seen { shut: None, cooling: Some(cooling), .. } if warm(cooling) => Some(Said::HeaterOrT1),
            Seen { shut: Some(_), arrives: Some(arrives), .. } if arrives < self.arrives => {
                Some(Said::Heater)
            }
            _ => None,
        }
    }
}

/// A file as it was judged.
struct Day {
    file: String,
    /// What is said at the end of each hour.
    hours: Vec<Option<Said>>,
    seen: Seen,
    is_sound: bool,
}

impl Day {
    fn said(&self) -> Option<Said> {
        self.hours.last().copied().flatten()
    }

    /// How often something is said that was not said an hour before.
    fn alarms(&self) -> usize {
        let mut last = None;
        self.hours
            .iter()
            .filter(|said| said.is_some() && std::mem::replace(&mut last, **said) != **said)
            .count()
    }

    fn row(&self, truth: Option<&str>) -> String {
        let Seen { shut, cooling, heating, arrives } = self.seen;
        let cells = [shut, cooling, heating].map(|x| x.map_or("-".into(), |x| format!("{x:+.1}")));
        let arrives = arrives.map_or("-".into(), |share| format!("{:.0} %", 100.0 * share));
        let is_judged = shut.is_some() || cooling.is_some() || heating.is_some();
        let said = self.said().map_or(if is_judged { "nothing" } else { "not judged" }, Said::words);
        let since = self.hours.iter().position(|said| said.is_some() && *said == self.said());
        let since = since.map_or("-".into(), |hour| format!("{} h", hour + 1));
        let truth = truth.unwrap_or(if self.is_sound { "nothing" } else { "not told" });
        format!("| {} | {truth} | {said} | {since} | {} | {arrives} |", self.file, cells.join(" | "))
    }
}

impl AirHandler {
    /// Reads settings.
    ///
    /// # Errors
    /// What is wrong in them.
    pub(super) fn parse(text: &str) -> anyhow::Result<Self> {
        let handler: Self = toml::from_str(text)?;
        ensure!(handler.coils.least > 0, "coils.least is 0, expected at least 1 sample");
        Ok(handler)
    }

    /// Judges each file of the folder that a season names; a table in Markdown.
    ///
    /// # Errors
    /// A file that is missing or wrong, or a training from which nothing can be learnt.
    pub(super) fn score(&self, dir: &Path) -> anyhow::Result<String> {
        let mut text = format!("{}\n\n", self.about);
        text += "| file | truth | said at its end | first said | shut, °C | cooling, °C | heating, °C | heat that arrives |\n|---|---|---|---|---|---|---|---|\n";
        let mut days = Vec::new();
        for season in &self.seasons {
            let training = Recording::read(&dir.join(&season.training), &self.reading)?;
            let usual = self.coils.learn(&training).with_context(|| season.training.clone())?;
            for path in files(dir, &season.begins)? {
                days.push(self.judge(&path, usual)?);
            }
        }
        for day in &days {
            let _ = writeln!(text, "{}", day.row(self.truth.get(&day.file).map(String::as_str)));
        }
        let sound: Vec<&Day> = days.iter().filter(|day| day.is_sound).collect();
        let _ = writeln!(
            text,
            "\nWithout a fault: {} alarms in {} h.",
            sound.iter().map(|day| day.alarms()).sum::<usize>(),
            sound.iter().map(|day| day.hours.len()).sum::<usize>()
        );
        Ok(text)
    }

    fn judge(&self, path: &Path, usual: Usual) -> anyhow::Result<Day> {
        let recording = Recording::read(path, &self.reading)?;
        let minutes = self.coils.minutes(&recording, self.coils.settle);
        let an_hour = recording.at(3600.0).max(1);
        let ends = (1..=minutes.len().div_ceil(an_hour)).map(|hour| (hour * an_hour).min(minutes.len()));
        let hours = ends.map(|end| self.coils.say(&self.coils.see(&minutes[..end], usual))).collect();
        let seen = self.coils.see(&minutes, usual);
        let file = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let is_sound = match &self.faulted {
            Some(column) => {
                let table = Table::read(path)?;
                let column = table.values_or_gaps(table.column(column)?)?;
                column.values.into_iter().flatten().all(|fault| fault == 0.0)
            }
            None => self.truth.get(&file).is_some_and(|truth| truth == "nothing"),
        };
        Ok(Day { file, hours, seen, is_sound })
    }
}

/// The files of a folder whose names begin so, in order.
fn files(dir: &Path, begins: &str) -> anyhow::Result<Vec<PathBuf>> {
    let place = || format!("can't read the folder {}", dir.display());
    let entries = std::fs::read_dir(dir).with_context(place)?;
    let mut files: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    files.retain(|path| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(begins)));
    files.sort();
    if files.is_empty() {
        bail!("{}: no file begins with {begins}", dir.display());
    }
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SETTINGS: &str = r#"
about = "made"
faulted = "fault"
reading = { map = ["time=t", "t0=before", "t1=after", "power=heat", "known=cool", "fan=fan"], full_power = 1.0, degc = 0.5, fan = true }
season = [{ begins = "day-", training = "day-0-sound.csv" }]
[coils]
still = 0.2
shut = 0.01
cools = 0.1
heats = 0.2
settle = 5
least = 20
margin = 0.7
arrives = 0.1
"#;

    /// A day of minutes: both shut, heating at a half, shut, cooling. The air behind the coils is 1 unit (0.5 degC) warmer by the fan, by
    /// 20 units of a whole heating valve, colder by 15 of the cooling valve, and warmer by what a fault adds: when not cooling, when cooling. `heat` is the share of the heat that comes.
    fn day(heat: f64, adds: [f64; 2], fan: [f64; 2]) -> String {
        let mut text = String::from("t,before,after,heat,cool,fan,fault\n");
        for k in 0..240 {
            let (valve, cool, add) = match k / 60 {
                1 => (0.5, 0.0, adds[0]),
                3 => (0.0, 0.8, adds[1] - 15.0),
                _ => (0.0, 0.0, adds[0]),
            };
            let before = 60.0 + 0.01 * f64::from(k % 7);
            let after = before + 1.0 + 20.0 * heat * valve + add;
            let fault = i32::from(heat != 1.0 || adds != [0.0; 2]);
            let fan = fan[k as usize % 2];
            text += &format!("{},{before:.2},{after:.2},{valve},{cool},{fan},{fault}\n", 60 * k);
        }
        text
    }

    #[test]
    fn what_heats_unasked_is_told_from_what_may_be_an_error_of_t1() {
        const BLOWS: [f64; 2] = [50.0, 51.0];
        let dir = std::env::temp_dir().join(format!("pt326-coils-{}", std::process::id()));
        std::fs::create_dir_all(&dir).unwrap();
        let days = [
            ("0-sound", day(1.0, [0.0; 2], BLOWS), "nothing"),
            ("1-leaks", day(1.0, [14.0, 31.0], BLOWS), "the heater"),
            ("2-offset", day(1.0, [14.0; 2], BLOWS), "the heater or T1"),
            ("3-closed", day(0.02, [0.0; 2], BLOWS), "the heater"),
            ("4-cools", day(1.0, [-9.0, 0.0], BLOWS), "the cooling coil or T1"),
            ("5-still", day(1.0, [14.0, 31.0], [10.0, 11.0]), "not judged"),
        ];
        for (name, text, _) in &days {
            std::fs::write(dir.join(format!("day-{name}.csv")), text).unwrap();
        }
        let table = super::super::score(SETTINGS, &dir).unwrap();
        for (name, _, said) in days {
            let row = table.lines().find(|line| line.contains(name)).unwrap();
            assert_eq!(row.split(" | ").nth(2), Some(said), "{table}");
        }
        assert!(table.contains("Without a fault: 0 alarms in 4 h."), "{table}");
        let missing = AirHandler::parse(&SETTINGS.replace("day-0", "no-0")).unwrap().score(&dir);
        assert!(missing.unwrap_err().to_string().contains("no-0-sound.csv"));
        std::fs::remove_dir_all(dir).unwrap();
    }
}
