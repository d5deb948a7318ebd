//! The page about a recording.

use std::fmt::Write as _;

use super::super::map::Role;
use super::super::run::Training;
use super::data::{Data, Signal, shaded};
use super::findings::{Ending, Episode};
use super::{Told, WITHIN, learnt_from};
use crate::experiment::as_written;
use crate::record::report::{escape, significant, written};

const STYLE: &str = include_str!("page.css");
/// Alarms that have a chart of their own, and that are listed.
pub(super) const CLOSE: usize = 12;
const LISTED: usize = 200;
/// A fit that is worth a warning, %.
const POOR: f64 = 60.0;
/// A chart of an alarm shows so much before and after it, as a share of it, and so many samples at least.
const AROUND: f64 = 0.6;
const LEAST_AROUND: f64 = 60.0;

/// All of it.
pub(super) fn html(told: &Told) -> String {
    let name = std::path::Path::new(&told.recording.file).file_name();
    let name = name.map_or(told.recording.file.clone(), |name| name.to_string_lossy().into_owned());
    let parts = [
        introduction(told, &name),
        whole(told),
        alarms(told),
        scored(told),
        learnt(told),
        unjudged(told),
        reading(told),
    ];
    format!(
        "<!doctype html>\n<html lang='en'>\n<head>\n<meta charset='utf-8'>\n<meta name='viewport' content='width=device-width,initial-scale=1'>\n\
         <title>{}: diagnosed</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n{}</main>\n</body>\n</html>\n",
        escape(&name),
        parts.concat()
    )
}

/// What it is, and the outcome at a glance.
fn introduction(told: &Told, name: &str) -> String {
    let (record, recording) = (&told.done.record, told.recording);
    let from = told.done.watched_from as f64 * recording.sample_time;
    let watched = (record.end() - from).max(0.0);
    let in_alarm: f64 = told.episodes.iter().map(|episode| episode.to - episode.from).sum();
    let named =
        told.episodes.iter().filter(|e| e.headline().is_some_and(|said| said.class.is_some())).count();
    let count = told.episodes.len();
    let lead = match told.episodes.as_slice() {
        [] if watched <= 0.0 => "All of it was learnt from: nothing was left to watch.".to_owned(),
        [] if told.done.nothing_judged().is_some() => "Nothing could be judged.".to_owned(),
        [] => format!("Nothing was found wrong in the {} that were judged.", time(told.done.judged())),
        [one] => format!("One alarm, at {}.", when(told, one.from)),
        [first, ..] => format!("{count} alarms, the first at {}.", when(told, first.from)),
    };
    let fit = told.done.trained.fit;
    let rest = told.done.fit_on_the_rest;
    let mut keys = vec![
        (
            "Recorded",
            time(recording.len() as f64 * recording.sample_time),
            format!("a sample each {} s", written(recording.sample_time)),
        ),
        ("Watched", time(watched), format!("from {} on", time(from))),
        (
            "Alarms",
            count.to_string(),
            if count > 0 {
                format!(
                    "{named} of them named, {} % of the time",
                    significant(100.0 * in_alarm / watched.max(1e-9), 2)
                )
            } else {
                "while it was watched".to_owned()
            },
        ),
        ("Fit", format!("{} %", significant(fit, 3)), "of T1 where it was learnt, simulated".to_owned()),
    ];
    if rest.is_finite() {
        let place = if learnt_from(told.training).is_some() { "on the rest" } else { "here, faults and all" };
        keys[3].2 += &format!("; {} % {place}", significant(rest, 3));
    }
    if watched <= 0.0 {
        keys.truncate(1);
    }
    if let Some(score) = told.score {
        keys.push(("False alarms", score.false_alarms.to_string(), "by the truth that was given".to_owned()));
    }
    let keys = keys
        .into_iter()
        .map(|(name, value, note)| format!("<div><dt>{name}</dt><dd>{value}</dd><dd>{note}</dd></div>\n"));
    let warning = if fit < POOR {
        format!(
            "<p class='warn'>The model explains {} % of T1 where it was learnt. Below {POOR} % what is said here may be the model&rsquo;s fault.</p>\n",
            significant(fit, 3)
        )
    } else {
        String::new()
    };
    format!(
        "<h1>{}</h1>\n{}<p class='lead'>{lead}</p>\n{warning}<dl>\n{}</dl>\n",
        escape(name),
        which(told),
        keys.collect::<String>()
    )
}

/// The recording from end to end.
fn whole(told: &Told) -> String {
    let record = &told.done.record;
    let start = record.rows.first().map_or(0.0, |row| record.time(row.tick.index));
    let span = (start, record.end().max(start + record.sample_time));
    let data = Data::of(told);
    let mut html = String::from("<h2>Measured against expected</h2>\n");
    let band = if told.band.is_finite() {
        format!(
            "<i class='area k-model'></i>within {} {} of it, as for {} % of what was learnt from",
            significant(told.band, 2),
            told.unit(),
            100.0 * WITHIN
        )
    } else {
        String::new()
    };
    let spans = shaded(told);
    let has = |class: &str| spans.iter().any(|span| span.class == class);
    let keys = [
        ("alarm", "alarm", "alarm"),
        ("truth", "truth", "what was truly wrong"),
        ("train", "room", "learnt from"),
        ("blind", "soft", "not judged"),
    ];
    let legend = keys.into_iter().filter(|(class, ..)| has(class));
    let legend: String =
        legend.map(|(_, colour, name)| format!("<i class='area k-{colour}'></i>{name}")).collect();
    html += &figure(
        &format!(
            "<span><b>T1</b> ({})</span><span><i class='k-t1'></i>measured<i class='k-model'></i>expected{band}{legend}</span>",
            told.unit()
        ),
        &data.chart("T1, measured and expected", span, 260.0, &spans, Signal::T1),
    );
    html += &figure(
        &format!(
            "<span><b>T1 measured less expected</b> ({})</span><span><i class='area k-model'></i>the same band</span>",
            told.unit()
        ),
        &data.chart("What is measured of T1 less what is expected", span, 120.0, &spans, Signal::Difference),
    );
    let beside = if data.has_beside() { "<i class='k-other'></i>of the heater beside" } else { "" };
    let key = if beside.is_empty() {
        String::new()
    } else {
        format!("<span><i class='k-power'></i>of this heater{beside}</span>")
    };
    html += &figure(
        &format!(
            "<span><b>Power</b> (%{})</span>{key}",
            match as_written(told.recording.units.full_power) {
                100.0 => String::new(),
                full => format!("; {} in the file is 100", written(full)),
            }
        ),
        &data.chart("Power", span, 110.0, &spans, Signal::Power),
    );
    if told.heater.inputs.t0 || told.heater.inputs.t2 {
        let names = [(told.heater.inputs.t0, "room", "T0"), (told.heater.inputs.t2, "other", "T2")];
        let names = names
            .into_iter()
            .filter(|(is, ..)| *is)
            .map(|(_, class, name)| format!("<i class='k-{class}'></i>{name}"));
        html += &figure(
            &format!(
                "<span><b>Other temperatures</b> ({})</span><span>{}</span>",
                told.unit(),
                names.collect::<String>()
            ),
            &data.chart("Other temperatures", span, 110.0, &spans, Signal::Others),
        );
    }
    html + "<p class='soft'>Times are in s from the first sample.</p>\n"
}

/// Each alarm with its sentences, the first of them near by.
fn alarms(told: &Told) -> String {
    if told.episodes.is_empty() {
        return String::new();
    }
    let data = Data::of(told);
    let mut html = String::from("<h2>Alarms</h2>\n");
    let row = |(i, episode): (usize, &Episode)| {
        let headline = episode.headline().map_or(String::new(), |said| said.sentence);
        let others: Vec<String> = episode
            .said
            .iter()
            .filter(|said| said.sentence != headline)
            .take(6)
            .map(|said| format!("<small>at {}: {}</small>", when(told, said.at), escape(&said.sentence)))
            .collect();
        let end = match episode.ending {
            Ending::Over => when(told, episode.to),
            Ending::Gap => format!("{}, a gap: whether it is over is not known", when(told, episode.to)),
            Ending::Stands => "the end".to_owned(),
        };
        format!(
            "<tr><td class='n'>{}</td><td class='n'>{}</td><td class='n'>{end}</td><td>{}{}</td></tr>\n",
            i + 1,
            when(told, episode.from),
            escape(&headline),
            others.concat()
        )
    };
    let rows: String = told.episodes.iter().take(LISTED).enumerate().map(row).collect();
    let _ = write!(
        html,
        "<div class='wide'><table>\n<thead><tr><th></th><th class='n'>From</th><th class='n'>To</th><th>The name that stood longest, and what else was said</th></tr></thead>\n\
         <tbody>\n{rows}</tbody>\n</table></div>\n"
    );
    if told.episodes.len() > LISTED {
        let _ = writeln!(html, "<p class='soft'>{} more are not listed.</p>", told.episodes.len() - LISTED);
    }
    let spans = shaded(told);
    for (i, episode) in told.episodes.iter().take(CLOSE).enumerate() {
        let record = &told.done.record;
        let around = (AROUND * (episode.to - episode.from)).max(LEAST_AROUND * record.sample_time);
        let first = record.rows.first().map_or(0.0, |row| record.time(row.tick.index));
        let span = ((episode.from - around).max(first), (episode.to + around).min(record.end()));
        let headline = episode.headline().map_or(String::new(), |said| said.sentence);
        html += &figure(
            &format!("<span><b>{}</b> {}</span>", i + 1, escape(&headline)),
            &data.chart("T1 around an alarm", span, 170.0, &spans, Signal::T1),
        );
    }
    html
}

/// How the faults that are known were seen.
fn scored(told: &Told) -> String {
    let Some(score) = told.score else { return String::new() };
    let after = |t: Option<f64>| t.map_or("never".to_owned(), |t| format!("{} s", significant(t, 3)));
    let number = |x: Option<f64>| x.map_or(String::new(), |x| significant(x, 3));
    let row = |seen: &super::super::score::Seen| {
        let tail = match (seen.tail, seen.endless) {
            (None, _) => String::new(),
            (Some(tail), false) => format!("{} s", significant(tail, 3)),
            (Some(_), true) => "does not end".to_owned(),
        };
        format!(
            "<tr><td>{}</td><td class='n'>{}</td><td class='n'>{}</td><td class='n'>{}</td><td>{}</td><td class='n'>{}</td><td class='n'>{}</td><td class='n'>{tail}</td></tr>\n",
            escape(&seen.fault),
            time(seen.at),
            after(seen.alarmed),
            after(seen.named),
            seen.said.unwrap_or("").replace('_', " "),
            number(seen.size),
            number(seen.size_true),
        )
    };
    let rows: String = score.faults.iter().map(row).collect();
    let at: Vec<String> = score.false_alarms_at.iter().take(20).map(|t| time(*t)).collect();
    let at = if at.is_empty() { String::new() } else { format!(", at {}", at.join(", ")) };
    format!(
        "<h2>Held against the truth</h2>\n<div class='wide'><table>\n<thead><tr><th>Fault</th><th class='n'>Onset</th><th class='n'>Alarm after</th><th class='n'>Named after</th>\
         <th>Said last</th><th class='n'>Size</th><th class='n'>True</th><th class='n'>Alarm after its end</th></tr></thead>\n<tbody>\n{rows}</tbody>\n</table></div>\n\
         <p>False alarms: {}{at}.</p>\n",
        score.false_alarms
    )
}

/// The model.
fn learnt(told: &Told) -> String {
    let of = match (learnt_from(told.training), told.training) {
        (Some((part, why)), _) => {
            let at = |k: usize| time(k as f64 * told.recording.sample_time);
            format!("From {} to {} ({}).", at(part.start), at(part.end), escape(why))
        }
        (None, Training::Other(other)) => {
            format!("All of {}, which is said to be normal.", escape(&other.file))
        }
        (None, _) => String::new(),
    };
    let all = told.learnt();
    let row = |learnt: &super::Learnt| {
        format!(
            "<tr><td>{}</td><td class='n'>{}</td><td class='n'>{}</td><td>{}</td></tr>\n",
            learnt.name,
            significant(learnt.value, 3),
            learnt.interval(),
            learnt.unit
        )
    };
    let rows: String = all.iter().map(row).collect();
    let every = told.done.trained.every;
    let means = if every > 1 {
        format!(
            " T1 answers over so many samples that the process is watched by means of {} s, the thermistor by each sample.",
            significant(told.recording.sample_time * f64::from(every), 3)
        )
    } else {
        String::new()
    };
    format!(
        "<h2>What was learnt</h2>\n<p>{of}{means}</p>\n<div class='wide'><table>\n<thead><tr><th></th><th class='n'>Value</th><th class='n'>95 % interval</th><th>Unit</th></tr></thead>\n<tbody>\n{rows}</tbody>\n</table></div>\n"
    )
}

/// Where nothing was said.
fn unjudged(told: &Told) -> String {
    if told.unjudged.is_empty() {
        return String::new();
    }
    let item = |part: &super::Unjudged| {
        format!("<li>{} to {}: {}</li>\n", when(told, part.from), when(told, part.to), part.why)
    };
    let items: String = told.unjudged.iter().take(LISTED).map(item).collect();
    format!("<h2>Not judged</h2>\n<ul>\n{items}</ul>\n")
}

/// How the file was read, and what cannot be asked of it.
fn reading(told: &Told) -> String {
    let units = told.recording.units;
    let inputs = told.heater.inputs;
    let mut items: Vec<String> = told
        .recording
        .remarks
        .iter()
        .skip_while(|remark| remark.contains("; the same: "))
        .map(|remark| escape(remark))
        .collect();
    let lacks = [
        (
            !inputs.t0,
            "No T0: a constant is learnt in its place, so a room that warms looks like any other thing that warms T1.",
        ),
        (
            !inputs.t2,
            "No T2: faults of T1, of the heater and of the air are told apart only by how fast T1 changes.",
        ),
        (!inputs.fan, "No fan: the air flow, and dirt that it carries, are not considered."),
    ];
    items.extend(lacks.into_iter().filter(|(is, _)| *is).map(|(_, text)| text.to_owned()));
    let items: String = items.into_iter().map(|item| format!("<li>{item}</li>\n")).collect();
    format!(
        "<h2>How it was read</h2>\n<p>Columns and units:</p>\n<code>{} --full-power {} --fan {}</code>\n<ul style='margin-top:12px'>\n{items}</ul>\n",
        escape(&told.heater.map.arguments()),
        as_written(units.full_power),
        inputs.fan
    )
}

fn figure(caption: &str, svg: &str) -> String {
    format!("<figure>\n<figcaption>{caption}</figcaption>\n{svg}</figure>\n")
}

/// When it was: as it is read in the charts, with the date where the file has dates.
fn when(told: &Told, t: f64) -> String {
    told.recording.date(t).map_or_else(|| time(t), |date| format!("{} ({date})", time(t)))
}

/// Which heater of several it is, and where the others are.
fn which(told: &Told) -> String {
    let heaters = &told.recording.heaters;
    let Some(own) = heaters.iter().position(|heater| std::ptr::eq(heater, told.heater)) else {
        return String::new();
    };
    if heaters.len() < 2 {
        return String::new();
    }
    let link = |other: usize| {
        let place = match (own, other) {
            (0, _) => format!("heater-{}/report.html", other + 1),
            (_, 0) => "../report.html".to_owned(),
            _ => format!("../heater-{}/report.html", other + 1),
        };
        format!("<a href='{place}'>heater {}</a>", other + 1)
    };
    let others = (0..heaters.len()).filter(|other| told.has_others && *other != own).map(link);
    let others: Vec<String> = others.collect();
    let others = if others.is_empty() {
        String::new()
    } else {
        format!("; diagnosed beside it: {}", others.join(", "))
    };
    let map = &told.heater.map;
    let [t1, power] = [Role::T1, Role::Power].map(|role| escape(map.column(role).unwrap_or_default()));
    format!("<p>Heater {} of {}: {t1}, heated by {power}{others}.</p>\n", own + 1, heaters.len())
}

/// A time as it is read in the charts.
fn time(t: f64) -> String {
    let text = format!("{t:.2}");
    format!("{} s", text.trim_end_matches('0').trim_end_matches('.'))
}
