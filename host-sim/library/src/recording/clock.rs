//! What clocks and loggers do to times: rows that come late, newest first, summer time.

use super::grid::Stamp;
use super::map::{Map, Role};
use super::stamp::usual_step;
use super::table::Table;
use pt326_fit::stretches::GAP;

/// A step of the clock by an hour, within so many samples of it.
const HOUR: f64 = 3600.0;
const NEAR: f64 = 1.5;

/// Whether times fall from row to row.
pub(super) fn is_newest_first(times: impl Iterator<Item = f64> + Clone) -> bool {
    let pairs = || times.clone().zip(times.clone().skip(1));
    pairs().filter(|(before, after)| after < before).count()
        > pairs().filter(|(before, after)| after > before).count()
}

/// Turns rows that stand newest first, and says so.
pub(super) fn turned(times: &mut [Stamp]) -> Option<String> {
    let is_turned = is_newest_first(times.iter().map(|(_, time)| *time));
    is_turned.then(|| times.reverse());
    is_turned.then(|| "Its rows stand newest first: turned round.".into())
}

/// Puts rows where their times belong, where it is seen that they are out of order, and says so.
pub(super) fn ordered(table: &Table, times: &mut [Stamp]) -> Option<String> {
    let falls = |times: &[Stamp]| times.windows(2).filter(|pair| pair[1].1 < pair[0].1).count();
    let (late, first) = put_late_ones(times);
    let is_mixed = falls(times) > GAP && is_whole(times);
    if is_mixed {
        times.sort_by(|a, b| a.1.total_cmp(&b.1));
    }
    match () {
        () if is_mixed => Some("Its rows are in no order: sorted by their times.".into()),
        () if late > 0 => {
            let line = first.map_or(0, |row| table.line_of(row));
            Some(format!("Rows that come late: {late}, the first in line {line}; sorted by their times."))
        }
        () => None,
    }
}

/// Moves each row that is a few places late to where it belongs; how many there were, and the first.
fn put_late_ones(times: &mut [Stamp]) -> (usize, Option<usize>) {
    let (mut late, mut first) = (0, None);
    for k in 1..times.len() {
        let (row, time) = times[k];
        // One that is earlier than all around it begins another session.
        if time >= times[k - 1].1 || time <= times[k.saturating_sub(GAP)].1 {
            continue;
        }
        let begin = k - times[..k].iter().rev().take_while(|(_, before)| *before > time).count();
        times[begin..=k].rotate_right(1);
        (late, first) = (late + 1, first.or(Some(row)));
    }
    (late, first)
}

/// Whether times in any order are those of one recording: no two the same, and nearly all steps alike.
fn is_whole(times: &[Stamp]) -> bool {
    let mut sorted: Vec<f64> = times.iter().map(|(_, time)| *time).collect();
    sorted.sort_by(f64::total_cmp);
    let step = usual_step(sorted.iter().copied()).unwrap_or(f64::INFINITY);
    let steps = || sorted.windows(2).map(|pair| pair[1] - pair[0]);
    let alike = steps().filter(|one| (one - step).abs() <= 0.2 * step).count();
    steps().all(|one| one > 0.0) && 10 * alike >= 9 * steps().count()
}

/// Takes summer time out of the times of a clock on a wall, and says so: it falls back by an hour, or leaps by one while T1 goes on.
pub(super) fn put_back(table: &Table, map: &Map, times: &mut [Stamp]) -> anyhow::Result<Option<String>> {
    let step = usual_step(times.iter().map(|(_, time)| *time)).unwrap_or(0.0);
    let by = |pair: &[Stamp], hour: f64| (pair[1].1 - pair[0].1 - hour - step).abs() <= NEAR * step;
    let is_step = |pair: &[Stamp]| step < 0.1 * HOUR && (by(pair, HOUR) || by(pair, -HOUR));
    if !times.windows(2).any(is_step) {
        return Ok(None);
    }
    let column = map.column(Role::T1).map(|column| table.column(column)).transpose()?;
    let t1 = column.map(|column| table.values_or_gaps(column)).transpose()?.unwrap_or_default().values;
    let change = |pair: &[Stamp]| Some((t1.get(pair[1].0).copied()?? - t1.get(pair[0].0).copied()??).abs());
    let mut changes: Vec<f64> = times.windows(2).filter_map(change).collect();
    changes.sort_by(f64::total_cmp);
    let largest = changes.get(99 * changes.len() / 100).copied().unwrap_or(0.0);
    let (mut passed, mut lines) = (0.0, Vec::new());
    let mut last = times[0];
    for k in 1..times.len() {
        let pair = [last, times[k]];
        last = times[k];
        let hour = if by(&pair, HOUR) { HOUR } else { -HOUR };
        if is_step(&pair) && change(&pair).is_some_and(|change| change <= largest) {
            passed += hour;
            lines.push(table.line_of(pair[1].0).to_string());
        }
        times[k].1 -= passed;
    }
    let said = format!(
        "The clock is put forward or back by an hour in line {}, while T1 goes on: taken out.",
        lines.join(", ")
    );
    Ok((!lines.is_empty()).then_some(said))
}

#[cfg(test)]
mod tests {
    use super::super::{Reading, Recording};

    /// A ramp of 300 rows, a sample each 10 s; `time` makes the cell of a row, `order` says which row stands where.
    fn read(time: impl Fn(u32) -> String, order: impl Fn(u32) -> u32) -> Recording {
        with_t1(time, |k| 20.0 + 0.1 * f64::from(k), order)
    }

    fn with_t1(
        time: impl Fn(u32) -> String,
        t1: impl Fn(u32) -> f64,
        order: impl Fn(u32) -> u32,
    ) -> Recording {
        let row = |k: u32| format!("{},{},{}\n", time(k), t1(k), k / 20 % 2);
        let text: String = (0..300).map(|at| row(order(at))).collect();
        Recording::parse("f".into(), &format!("time,temp,power\n{text}"), &Reading::default()).unwrap()
    }

    fn is_the_ramp(recording: &Recording) -> bool {
        let samples = &recording.heaters[0].samples;
        let at = |(k, sample): (usize, &fdi_core::Observed)| {
            sample.t[1].is_some_and(|t| (f64::from(t) - 20.0 - 0.1 * k as f64).abs() < 1e-4)
        };
        samples.len() == 300 && recording.sessions.len() == 1 && samples.iter().enumerate().all(at)
    }

    #[test]
    fn rows_in_another_order_are_sorted_and_told() {
        let late = |at: u32| match at {
            50 => 51,
            51 => 50,
            80..83 => at + 1,
            83 => 80,
            at => at,
        };
        let mixed = |at: u32| at * 91 % 300;
        for (order, said) in [
            (&late as &dyn Fn(u32) -> u32, "Rows that come late: 2, the first in line 53;"),
            (&|at| 299 - at, "newest first"),
            (&mixed, "in no order"),
        ] {
            let recording = read(|k| (10 * k).to_string(), order);
            assert!(is_the_ramp(&recording), "{said}: {:?}", recording.remarks);
            assert!(recording.remarks.concat().contains(said), "{said}: {:?}", recording.remarks);
        }
    }

    /// The clock is put forward at line 102, or back; a logger that was off for an hour is another thing: T1 has gone elsewhere.
    #[test]
    fn summer_time_is_taken_out() {
        let clock = |k: u32, by: i64| {
            let s = 10_000 + 10 * i64::from(k) + if k < 100 { 0 } else { by };
            format!("2026-03-29 {:02}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60)
        };
        for by in [3600, -3600] {
            let recording = read(|k| clock(k, by), |at| at);
            assert!(is_the_ramp(&recording), "{by}: {:?}", recording.remarks);
            assert!(
                recording.remarks.concat().contains("by an hour in line 102,"),
                "{:?}",
                recording.remarks
            );
        }
        let off = with_t1(
            |k| clock(k, 3600),
            |k| if k < 100 { 60.0 + 0.1 * f64::from(k) } else { 25.0 + 0.1 * f64::from(k) },
            |at| at,
        );
        assert!(off.len() == 660, "{}", off.len());
    }

    #[test]
    fn a_clock_of_32_bits_goes_on_at_nought() {
        for (name, first, most, unit) in [
            ("t_ms", u64::from(u32::MAX) - 1_000_000, 1 << 32, 1000),
            ("t_us", 4_000_000_000, 1 << 32, 1_000_000),
            ("t_ms", 60_000, 1 << 16, 1000),
        ] {
            let time = |k: u32| ((first + 10 * u64::from(k) * unit) % most).to_string();
            let text: String = (0..200).map(|k| format!("{},{},1\n", time(k), 20 + k)).collect();
            let read =
                Recording::parse("f".into(), &format!("{name},temp,power\n{text}"), &Reading::default())
                    .unwrap();
            assert_eq!((read.len(), read.sessions.len(), read.sample_time), (200, 1, 10.0), "{name} {first}");
        }
    }
}
