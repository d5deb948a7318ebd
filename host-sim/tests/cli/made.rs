//! Recordings of heaters that nobody has: whatever is in them, nothing panics, and no sentence is absurd.

use std::ops::RangeInclusive;

use fdi_core::Config;
use indicatif::ProgressBar;
use pt326_host::experiment::Origin;
use pt326_host::recording::report::Told;
use pt326_host::recording::run::{Training, diagnose};
use pt326_host::recording::{Heater, Reading, Recording};

use crate::on_a_large_stack;
use crate::plant::Dice;

/// A log of a heater with one or two lags under somebody's hand, and what happens to it and to its logger.
fn made(seed: u64) -> (String, Reading) {
    let dice = &mut Dice::of(seed);
    let count = dice.between(300.0, 900.0) as usize;
    let ts = dice.any(&[0.1, 0.25, 1.0, 1.0, 5.0, 60.0, 600.0]);
    let full = dice.any(&[1.0, 100.0, 255.0]);
    let [slow, fast] = [dice.between(5.0, 60.0), dice.between(0.5, 10.0)];
    let rise = dice.any(&[3.0, 40.0, 40.0, 200.0]);
    let noise = dice.any(&[0.0, 0.02, 0.3]);
    let step = dice.any(&[0.001, 0.1, 0.3]);
    let has = [dice.one_in(3.0), dice.one_in(5.0), dice.one_in(3.0)];
    let hold = dice.between(5.0, 60.0) as usize;
    let (mut heat, mut t1, mut t2, mut power, mut time) = (0.0, 0.0, 0.0, 0.0, 0.0);
    let mut asked = dice.next();
    let [onset, length] = [dice.between(0.5, 0.9) * count as f64, dice.between(10.0, 200.0)];
    let kind = dice.any(&[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10]);
    let is_regulated = dice.one_in(3.0);
    let size = dice.between(-0.5, 0.5) * rise;
    let room = dice.between(-5.0, 30.0);
    let mut text = format!(
        "time,{}temp,{}power{}\n",
        if has[0] { "room," } else { "" },
        if has[1] { "second," } else { "" },
        if has[2] { ",beside" } else { "" }
    );
    let mut last = String::new();
    for k in 0..count {
        if k % hold == 0 {
            asked = if dice.one_in(4.0) { dice.any(&[0.0, 1.0]) } else { dice.next() };
        }
        let acts = (onset..onset + length).contains(&(k as f64));
        power +=
            if is_regulated { (3.0 * (asked - t1) - power).clamp(-0.1, 0.1) } else { 0.5 * (asked - power) };
        power = power.clamp(0.0, 1.0);
        let given = match kind {
            1 if acts => 0.0,
            2 if acts => 1.0,
            3 if acts => 0.6 * power,
            _ => power,
        };
        heat += (given - heat) / slow;
        t1 += (heat - t1) / fast.max(1.0);
        t2 += (t1 - t2) / 4.0;
        let mut read =
            |t: f64, off: f64| ((room + rise * t + off + noise * (dice.next() - 0.5)) / step).round() * step;
        let off = |of: usize| if kind == of && acts { size } else { 0.0 };
        let drift = if kind == 9 { 0.3 * rise * (k as f64 - onset).max(0.0) / count as f64 } else { 0.0 };
        let readings = [read(0.0, off(10)), read(t1, off(4) + drift), read(t2, off(8))];
        let t = match kind {
            5 if acts => String::new(),
            6 if acts => last.clone(),
            7 if acts => format!("{:.3}", dice.between(-1e3, 1e3)),
            _ => format!("{:.3}", readings[1]),
        };
        last.clone_from(&t);
        time += ts;
        if dice.one_in(300.0) {
            time += dice.any(&[-10.0 * ts, 30.0 * ts, 0.0, 3000.0 * ts]);
        }
        if dice.one_in(200.0) {
            continue;
        }
        let of = |is: bool, x: f64| if is { format!("{x:.3},") } else { String::new() };
        let beside =
            if has[2] { format!(",{:.3}", full * dice.any(&[0.0, 0.3, 0.5])) } else { String::new() };
        text += &format!(
            "{time:.3},{}{t},{}{:.3}{beside}\n",
            of(has[0], readings[0]),
            of(has[1], readings[2]),
            full * power
        );
    }
    let mut map = vec!["time=time".to_owned(), "t1=temp".into(), "power=power".into()];
    let more = [(has[0], "t0=room"), (has[1], "t2=second"), (has[2], "known=beside")];
    map.extend(more.into_iter().filter(|(is, _)| *is).map(|(_, pair)| pair.to_owned()));
    let reading = Reading { map, full_power: Some(full), fan: Some(dice.one_in(3.0)), ..Reading::default() };
    (text, reading)
}

/// A text with some of its characters and lines made others.
fn spoilt(text: &str, dice: &mut Dice) -> String {
    const ODD: [&str; 24] = [
        "",
        "\n",
        "\r\n",
        ",",
        ";",
        "\t",
        "\"",
        "#",
        "-",
        ".",
        "e",
        "nan",
        "inf",
        "1e300",
        "-1e308",
        "9999999999999999999",
        "on",
        "°",
        "\u{0}",
        "=",
        ":",
        "2024-05-01 10:00:00",
        "1/2/3 4:5 PM",
        "session",
    ];
    let rare = dice.any(&[100.0, 2000.0, 20_000.0]);
    let mut out = String::new();
    for line in text.lines() {
        let copies = if dice.one_in(rare) { dice.any(&[0, 2, 3]) } else { 1 };
        for _ in 0..copies {
            for c in line.chars() {
                if dice.one_in(rare) { out += dice.any(&ODD) } else { out.push(c) }
            }
            out += dice.any(&["\n", "\n", "\n", "\r\n"]);
        }
    }
    out
}

/// Whatever a file holds, it is read or refused in words.
#[test]
fn no_text_makes_the_reader_panic() {
    is_read_or_refused(1..=15);
}

#[test]
#[ignore = "long: ./check --all"]
fn no_text_makes_the_reader_panic_at_length() {
    is_read_or_refused(16..=165);
}

fn is_read_or_refused(seeds: RangeInclusive<u64>) {
    let (mut read, mut refused) = (0, 0);
    for seed in seeds {
        let (whole, how) = made(seed);
        let mut dice = Dice::of(seed);
        let few: Vec<&str> = whole.lines().take(80).collect();
        let klipper: String = few
            .iter()
            .map(|line| {
                format!(
                    "Stats {}: extruder: target=200 temp={} pwm=0.5\n",
                    line.split(',').next().unwrap_or(""),
                    line.len()
                )
            })
            .collect();
        for text in [few.join("\n"), few.join("\n").replace(',', ";"), klipper] {
            let text = spoilt(&text, &mut dice);
            for how in [Reading::default(), how.clone()] {
                match Recording::parse("made".into(), &text, &how) {
                    Ok(recording) => {
                        read += 1;
                        assert!(
                            recording.heaters.iter().all(|heater| heater.samples.len() == recording.len())
                        );
                        assert!(recording.stretches().iter().all(|stretch| stretch.end <= recording.len()));
                        assert!(recording.sample_time > 0.0 && recording.sample_time.is_finite());
                    }
                    Err(error) => {
                        refused += 1;
                        assert!(format!("{error:#}").contains(|c: char| c.is_alphabetic()));
                    }
                }
            }
        }
    }
    assert!(read > 10 && refused > 10, "{read} read, {refused} refused");
}

/// The numbers of a sentence before some words, with the interval that stands behind one in brackets.
fn numbers_before(sentence: &str, words: &str) -> Vec<f64> {
    let Some((head, _)) = sentence.split_once(words) else { return Vec::new() };
    let from = head.rfind([',', ';', ':']).map_or(0, |place| place + 1);
    let number = |word: &str| word.trim_matches(['(', ')']).replace('\u{2212}', "-").parse().ok();
    head[from..].split(' ').filter_map(number).collect()
}

/// What of a sentence cannot be.
fn absurd(recording: &Recording, heater: &Heater, sentence: &str) -> Option<String> {
    for (is, name) in [
        (heater.inputs.t0, "T0"),
        (heater.inputs.t2, "T2"),
        (heater.inputs.fan, "air flow"),
        (heater.inputs.fan, "fan"),
        (false, "tube"),
        (false, "NaN"),
        (false, "inf "),
        (false, "{"),
    ] {
        if !is && sentence.contains(name) {
            return Some(format!("{name} is not there"));
        }
    }
    let asked = [
        "is it loose? ",
        "is its contact loose? ",
        "is it loose, or is heat lost? ",
        "are their wires swapped?",
    ];
    if asked.into_iter().fold(sentence.to_owned(), |left, asked| left.replace(asked, "")).contains('?') {
        return Some("a question".into());
    }
    let unit = recording.unit(heater);
    let which = ["T0", "T1", "T2"].iter().position(|name| sentence.starts_with(name));
    let readings =
        |which: usize| heater.samples.iter().filter_map(move |sample| sample.t[which]).map(f64::from);
    if let Some(which) = which {
        let (low, high) =
            readings(which).fold((f64::MAX, f64::MIN), |(low, high), t| (low.min(t), high.max(t)));
        for measured in numbers_before(sentence, &format!(" {unit} measured")) {
            let digit = 0.006 * measured.abs().max(10.0);
            if !readings(which).any(|t| (t - measured).abs() <= digit) {
                return Some(format!("{measured} was never measured"));
            }
        }
        let far = |by: f64| low - by * (high - low) - 1.0..=high + by * (high - low) + 1.0;
        let expected = numbers_before(sentence, " expected");
        if expected.iter().any(|expected| !far(1.0).contains(expected)) {
            return Some(format!("{expected:?} expected of what reads {low} to {high}"));
        }
        let off = numbers_before(sentence, &format!(" {unit} too"));
        if off.first().is_some_and(|off| off.abs() > 1.5 * (high - low) + 1.0) {
            return Some(format!("off by {off:?} where it reads {low} to {high}"));
        }
    }
    for words in [" % less", " % weaker"] {
        let shares = numbers_before(sentence, words);
        if shares.iter().any(|share| *share > 100.0) {
            return Some(format!("{shares:?}{words}"));
        }
    }
    None
}

#[test]
fn no_sentence_about_a_made_recording_is_absurd() {
    on_a_large_stack(look);
}

fn look() {
    let (mut judged, mut named, mut absurdities) = (0, 0, Vec::new());
    for seed in 1..=100 {
        let (text, how) = made(seed);
        let Ok(recording) = Recording::parse(format!("made {seed}"), &text, &how) else { continue };
        let heater = &recording.heaters[0];
        let config = Config::default();
        let own = Training::Own(0..recording.len() / 2, "made".into());
        let training =
            if seed % 10 > 0 { Some(own) } else { Training::find(&recording, heater, &config).ok() };
        let Some(training) = training else { continue };
        let Ok(done) = diagnose(&recording, 0, &training, &[], &config, &ProgressBar::hidden()) else {
            continue;
        };
        assert!(matches!(done.record.origin, Origin::Watched { .. }));
        let told = Told::new(&recording, heater, &training, &done, None);
        let page = told.page();
        judged += 1;
        for said in told.episodes.iter().flat_map(|episode| &episode.said) {
            named += usize::from(said.class.is_some());
            if let Some(why) = absurd(&recording, heater, &said.sentence) {
                absurdities.push(format!("seed {seed}, {:?}: {why}: {}", how.map, said.sentence));
            }
        }
        assert!(
            !page.contains("NaN") && !page.contains("inf ") && !page.contains("False alarms"),
            "seed {seed}"
        );
        assert!(
            !page.contains("tube") && told.text().lines().all(|line| !line.contains("? °C")),
            "seed {seed}"
        );
    }
    println!("{judged} judged, {named} named");
    assert!(absurdities.is_empty(), "{}", absurdities.join("\n"));
    assert!(judged > 20 && named > 10, "{judged} judged, {named} named");
}
