//! Recordings of heaters that nobody has: whatever is in them, nothing panics, and no sentence is absurd.

use fdi_core::Config;
use host_sim::experiment::Origin;
use host_sim::recording::report::Told;
use host_sim::recording::run::{Training, diagnose};
use host_sim::recording::{Reading, Recording};
use indicatif::ProgressBar;

use crate::on_a_large_stack;
use crate::plant::Dice;

/// A log of a heater with one or two lags under somebody's hand, and what happens to it and to its logger.
fn made(seed: u64) -> (String, Reading) {
    let dice = &mut Dice::of(seed);
    let count = dice.between(300.0, 900.0) as usize;
    let ts = dice.any(&[0.1, 0.25, 1.0, 1.0, 5.0, 60.0]);
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
    let kind = dice.any(&[0, 1, 2, 3, 4, 5, 6, 7]);
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
        power += 0.5 * (asked - power);
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
        let readings = [read(0.0, 0.0), read(t1, if kind == 4 && acts { size } else { 0.0 }), read(t2, 0.0)];
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
    let (mut read, mut refused) = (0, 0);
    for seed in 1..=150 {
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
    assert!(read > 100 && refused > 100, "{read} read, {refused} refused");
}

/// The number before some words.
fn before(sentence: &str, words: &str) -> Option<f64> {
    let (head, _) = sentence.split_once(words)?;
    head.trim_end().rsplit([' ', ',']).next()?.parse().ok()
}

#[test]
fn no_sentence_about_a_made_recording_is_absurd() {
    on_a_large_stack(look);
}

fn look() {
    let (mut judged, mut named) = (0, 0);
    for seed in 1..=100 {
        let (text, how) = made(seed);
        let Ok(recording) = Recording::parse(format!("made {seed}"), &text, &how) else { continue };
        let heater = &recording.heaters[0];
        let training = Training::Own(0..recording.len() / 2, "made".into());
        let config = Config::default();
        let Ok(done) = diagnose(&recording, 0, &training, &[], &config, &ProgressBar::hidden()) else {
            continue;
        };
        assert!(matches!(done.record.origin, Origin::Watched { .. }));
        let told = Told::new(&recording, heater, &training, &done, None);
        let page = told.page();
        judged += 1;
        let (low, high) = heater
            .samples
            .iter()
            .filter_map(|s| s.t[1])
            .fold((f64::MAX, f64::MIN), |(low, high), t| (low.min(t.into()), high.max(t.into())));
        let span = high - low;
        let plausible = low - span - 1.0..=high + span + 1.0;
        for said in told.episodes.iter().flat_map(|episode| &episode.said) {
            let sentence = &said.sentence;
            named += usize::from(said.class.is_some());
            let place = format!("seed {seed}, {:?}, {low} to {high}: {sentence}", how.map);
            for (is, name) in [
                (heater.inputs.t0, "T0"),
                (heater.inputs.t2, "T2"),
                (heater.inputs.fan, "air flow"),
                (false, "tube"),
            ] {
                assert!(is || !sentence.contains(name), "{name}: {place}");
            }
            for absurd in ["NaN", "inf ", "? °", "? unit", "{", "T1 expected, as"] {
                assert!(!sentence.contains(absurd), "{absurd}: {place}");
            }
            for words in [" °C measured", " expected"] {
                let number = before(sentence, words)
                    .filter(|_| sentence.contains("°C measured") && !sentence.contains(" power "));
                assert!(number.is_none_or(|number| plausible.contains(&number)), "{words}: {place}");
            }
            let off = sentence
                .split_once(" reads ")
                .and_then(|(_, rest)| rest.split(' ').next()?.parse::<f64>().ok());
            assert!(off.is_none_or(|off| off.abs() <= 2.0 * span + 1.0), "{place}");
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
    assert!(judged > 20 && named > 10, "{judged} judged, {named} named");
}
