//! The rows of a table on an even grid of time: sessions one after the other, gaps as samples that are missing.

use std::ops::Range;

use anyhow::{bail, ensure};

use super::date::{DAY, offset};
use super::map::{Map, Role};
use super::stamp::{Stamps, usual_step};
use super::table::{Column, Table};
use super::{Reading, clock};

/// A clock of days that counts from none counts less, s.
const A_YEAR: f64 = 365.0 * DAY;
/// Stamps may be off the grid by so much of Ts.
const UNEVEN: f64 = 0.2;
/// A sample that is older than so many Ts is missing, where uneven ones are brought to a grid.
const STALE: f64 = 2.0;
/// Samples of a grid that a typing error in a stamp may ask for.
const MOST: f64 = 5e6;
/// Ts after which the logger was off: what was before says nothing of what is now.
pub const OFF: f64 = 1000.0;
/// Samples that are missing between two sessions.
const BETWEEN: usize = 20;
/// A time that falls back more often than once in so many rows is none, and one that is the same as that before is rounded.
const LEAST_ROWS: usize = 20;

/// Which row stands at each place of an even grid of time.
pub(super) struct Grid {
    /// Ts, s.
    pub(super) sample_time: f64,
    /// The row at or before each point; none where it is missing.
    pub(super) rows: Vec<Option<usize>>,
    /// The row behind each point and how far it is on the way there, where the stamps are uneven.
    pub(super) next: Vec<Option<(usize, f64)>>,
    /// The samples of each session.
    pub(super) sessions: Vec<Range<usize>>,
    /// What the file's clock showed when each session began, s since 1970; empty where it tells no dates.
    pub(super) begins: Vec<f64>,
    /// How the times are told.
    pub(super) stamps: Option<Stamps>,
    /// What whoever reads the results must know.
    pub(super) remarks: Vec<String>,
}

/// A row and its time, s.
pub(super) type Stamp = (usize, f64);

impl Grid {
    pub(super) fn new(table: &Table, map: &Map, how: &Reading) -> anyhow::Result<Self> {
        let Some(column) = map.column(Role::Time).filter(|_| !how.untimed) else {
            let Some(sample_time) = how.sample_time else {
                bail!(
                    "{}: no column is said to be the time: add --map time=COLUMN, or --ts with the sample time in s",
                    table.file()
                )
            };
            let rows: Vec<_> = (0..table.rows()).map(Some).collect();
            let (next, sessions) = (Vec::new(), std::iter::once(0..rows.len()).collect());
            return Ok(Self {
                sample_time,
                rows,
                next,
                sessions,
                begins: Vec::new(),
                stamps: None,
                remarks: Vec::new(),
            });
        };
        let (stamps, Column { values, mut remarks }) =
            Stamps::of(table, table.column(column)?, how.time_unit)?;
        let mut times: Vec<Stamp> =
            values.into_iter().enumerate().filter_map(|(row, t)| Some((row, t?))).collect();
        ensure!(times.len() > 1, "{}: fewer than two rows have a time", table.file());
        remarks.extend(clock::turned(&mut times));
        spread(&mut times);
        if stamps.are_on_a_wall() {
            remarks.extend(clock::put_back(table, map, &mut times)?);
        }
        remarks.extend(clock::ordered(table, &mut times));
        times.dedup_by(|later, before| later.1 == before.1 && later.0.abs_diff(before.0) == 1);
        let labels = map
            .column(Role::Session)
            .map(|column| Ok::<_, anyhow::Error>(table.values_or_gaps(table.column(column)?)?.values))
            .transpose()?;
        let sessions = sessions(table, &times, labels.as_deref())?;
        let mut grid = Self {
            sample_time: 0.0,
            rows: Vec::new(),
            next: Vec::new(),
            sessions: Vec::new(),
            begins: Vec::new(),
            stamps: Some(stamps),
            remarks,
        };
        grid.fill(table, &sessions, how)?;
        // A clock without a date counts from midnight.
        if stamps.are_on_a_wall() && sessions.iter().all(|session| session[0].1 > A_YEAR) {
            let first = table.first_of(table.column(column)?)?.unwrap_or_default();
            grid.begins = sessions.iter().map(|session| session[0].1 + offset(&first)).collect();
        }
        grid.tell_sessions(table, &sessions);
        Ok(grid)
    }

    /// Puts each session on the grid.
    fn fill(&mut self, table: &Table, sessions: &[&[Stamp]], how: &Reading) -> anyhow::Result<()> {
        let steps = sessions.iter().flat_map(|session| session.windows(2)).map(|pair| pair[1].1 - pair[0].1);
        let steps: Vec<f64> = steps.collect();
        let median = median(&steps);
        let usual = rounded(typical(&steps, median));
        let tried = how.sample_time.map_or([usual, tidy(median)], |said| [said; 2]);
        let lie_on = |ts: &f64| sessions.iter().all(|session| lies_on(session, *ts));
        let even = tried.into_iter().find(lie_on).filter(|_| !how.resample);
        let is_even = even.is_some();
        self.sample_time = even.or(how.sample_time).unwrap_or(usual);
        let ts = self.sample_time;
        for session in sessions {
            let ((_, start), (_, end)) = (session[0], session[session.len() - 1]);
            let count = (end - start) / ts;
            ensure!(
                (self.rows.len() as f64) + count < MOST,
                "{}: {start} to {end} s at {ts} s are {count:.0} samples",
                table.file()
            );
            if !self.rows.is_empty() {
                self.rows.extend([None; BETWEEN]);
            }
            let first = self.rows.len();
            self.rows.resize(first + count.round() as usize + 1, None);
            if is_even {
                for (row, t) in *session {
                    self.rows[first + ((t - start) / ts).round() as usize] = Some(*row);
                }
            } else {
                self.next.resize(self.rows.len(), None);
                self.resample(session, first);
            }
            self.sessions.push(first..self.rows.len());
        }
        if !is_even && !how.resample {
            let mut sorted = steps;
            sorted.sort_by(f64::total_cmp);
            let [low, high] =
                [0.01, 0.99].map(|share| rounded(sorted[(share * (sorted.len() - 1) as f64) as usize]));
            self.remarks.push(format!(
                "Its times are uneven, {low} to {high} s apart: brought to a grid of {ts} s, temperatures on straight lines between its rows."
            ));
        }
        let missing = self
            .sessions
            .iter()
            .flat_map(|session| &self.rows[session.clone()])
            .filter(|row| row.is_none())
            .count();
        if missing > 0 {
            let all: usize = self.sessions.iter().map(ExactSizeIterator::len).sum();
            self.remarks.push(format!("{missing} of {all} samples are missing."));
        }
        Ok(())
    }

    /// The row at or before each point of the grid, and the one behind it.
    fn resample(&mut self, session: &[Stamp], first: usize) {
        let (start, stale) = (session[0].1, STALE * self.sample_time);
        let mut last = 0;
        for k in first..self.rows.len() {
            let t = start + (k - first) as f64 * self.sample_time;
            while session.get(last + 1).is_some_and(|(_, next)| *next <= t + UNEVEN * self.sample_time) {
                last += 1;
            }
            let (row, at) = session[last];
            self.rows[k] = (t - at <= stale).then_some(row);
            let behind = session.get(last + 1).filter(|(_, next)| next - at <= stale);
            self.next[k] = behind.map(|(row, next)| (*row, ((t - at) / (next - at)).clamp(0.0, 1.0)));
        }
    }

    fn tell_sessions(&mut self, table: &Table, sessions: &[&[Stamp]]) {
        if sessions.len() < 2 {
            return;
        }
        let place = |(at, session): (&Range<usize>, &&[Stamp])| {
            format!(
                "line {} at {} s",
                table.line_of(session[0].0),
                rounded(at.start as f64 * self.sample_time)
            )
        };
        let mut places: Vec<String> = self.sessions.iter().zip(sessions).skip(1).take(8).map(place).collect();
        if sessions.len() > 9 {
            places.push("..".into());
        }
        self.remarks.push(format!(
            "Its times begin anew {} times ({}): {} sessions, put one behind the other.",
            sessions.len() - 1,
            places.join(", "),
            sessions.len()
        ));
    }
}

/// Stamps that are rounded so coarsely that several rows have the same: these share the time until the next. Of the first fewer rows may be there: they are
/// the last ones of theirs, as those of the last stamp are the first ones.
fn spread(times: &mut [Stamp]) {
    const STEPS: [f64; 6] = [60.0, 10.0, 1.0, 0.1, 0.01, 0.001];
    let multiple = |step: f64| move |(_, t): &Stamp| (t / step - (t / step).round()).abs() < 1e-3;
    let Some(step) = STEPS.into_iter().find(|step| times.iter().all(multiple(*step))) else { return };
    let usual = usual_step(times.iter().map(|(_, t)| *t)).unwrap_or(0.0);
    let twice = times.windows(2).filter(|pair| pair[0].1 == pair[1].1).count();
    // A few that are the same are rows that were written twice.
    if usual > 2.5 * step || twice * LEAST_ROWS <= times.len() {
        return;
    }
    let mut counts: Vec<usize> = times.chunk_by(|a, b| a.1 == b.1).map(<[Stamp]>::len).collect();
    let (last, middle) = (counts.len() - 1, counts.len() / 2);
    let usual = *counts.select_nth_unstable(middle).1;
    for (place, same) in times.chunk_by_mut(|a, b| a.1 == b.1).enumerate() {
        let whole = if place == 0 || place == last { same.len().max(usual) } else { same.len() };
        let before = if place == 0 { whole - same.len() } else { 0 };
        let share = |i: usize| (before + i) as f64 / whole as f64;
        same.iter_mut().enumerate().for_each(|(i, (_, t))| *t += step * share(i));
    }
}

/// Cuts the rows where time does not go on, the logger was off for long, or another session is named.
fn sessions<'a>(
    table: &Table,
    times: &'a [Stamp],
    labels: Option<&[Option<f64>]>,
) -> anyhow::Result<Vec<&'a [Stamp]>> {
    let off = OFF * usual_step(times.iter().map(|(_, t)| *t)).unwrap_or(f64::INFINITY);
    let label = |row: usize| labels.and_then(|labels| labels[row]);
    let goes_on = |(before, from): &Stamp, (row, to): &Stamp| {
        to > from && to - from <= off && label(*row) == label(*before)
    };
    let sessions: Vec<&[Stamp]> = times.chunk_by(goes_on).collect();
    let back = || times.windows(2).filter(|pair| pair[1].1 <= pair[0].1);
    let count = back().count();
    if count * LEAST_ROWS > times.len()
        && let Some(pair) = back().next()
    {
        bail!(
            "{}, line {}: time {} comes after {}, expected a later one, and so {count} times. If the rows are in order, leave the time out: --ts with the sample time in s",
            table.file(),
            table.line_of(pair[1].0),
            pair[1].1,
            pair[0].1
        );
    }
    Ok(sessions)
}

/// Whether all stamps are where an even grid has its points, no two at the same.
fn lies_on(session: &[Stamp], ts: f64) -> bool {
    let mut last = None;
    session.iter().all(|(_, t)| {
        let place = (t - session[0].1) / ts;
        let is_new = last.replace(place.round()) != Some(place.round());
        is_new && (place - place.round()).abs() <= UNEVEN
    })
}

fn median(steps: &[f64]) -> f64 {
    let mut steps = steps.to_vec();
    let middle = steps.len() / 2;
    if steps.is_empty() { 1.0 } else { *steps.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

/// The mean of the steps that leave no row out: of stamps that are rounded, the median is.
fn typical(steps: &[f64], median: f64) -> f64 {
    let kept: Vec<f64> = steps.iter().copied().filter(|step| *step <= 2.5 * median).collect();
    let mean = kept.iter().sum::<f64>() / kept.len().max(1) as f64;
    // Rows that are left out now and then lengthen the mean, and not the median.
    if (mean - median).abs() < 0.1 * median { median } else { mean }
}

/// A sample time as someone would write it: stamps are rounded.
fn tidy(step: f64) -> f64 {
    let rounded = (step * 1e4).round() / 1e4;
    if rounded > 0.0 { rounded } else { step }
}

/// Two digits, or three where two are off by more than 2 %: two recordings of a logger that is not exact come to the same.
fn rounded(step: f64) -> f64 {
    let to = |digits: usize| format!("{step:.*e}", digits - 1).parse().unwrap_or(step);
    let short: f64 = to(2);
    if (short - step).abs() <= 0.02 * step.abs() { short } else { to(3) }
}
