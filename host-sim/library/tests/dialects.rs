//! One recording in dialects that are put together at random: how times and numbers are written, what stands between cells, how a header is called, what
//! befalls some rows. Each must come to the same samples, or be refused; never to others.

use std::fmt::Write as _;

use pt326_host::recording::{Reading, Recording};

const ROWS: usize = 200;
/// Ts, s.
const TS: usize = 10;
/// 2026-03-28 23:40:00 UTC: midnight passes.
const START: u64 = 1_774_741_200;
/// Dialects that are tried, and the seed of the first.
const TRIED: u64 = 80;
const SEED: u64 = 47;

/// Numbers below a bound, from a seed (SplitMix64).
struct Dice(u64);

impl Dice {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) % bound as u64) as usize
    }

    fn of<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.below(all.len())]
    }

    fn one_in(&mut self, count: usize) -> bool {
        self.below(count) == 0
    }
}

/// What was recorded at each row: T1, degC, and power, %.
fn truth() -> Vec<(f64, f64)> {
    let (mut heat, mut t) = (0.0, 0.0);
    let row = |k: usize| {
        let power = [35.0, 20.0, 80.0, 50.0, 65.0][k / 12 % 5];
        heat += (power - heat) / 12.0;
        t += (heat - t) / 2.5;
        let noise = 0.05 * ((k * 7919 % 13) as f64 / 6.0 - 1.0);
        (((21.0 + 0.5 * t + noise) * 100.0).round() / 100.0, power)
    };
    (0..ROWS).map(row).collect()
}

/// Day of the month, hour, minute and second at a row.
fn at(k: usize) -> (u64, u64, u64, u64) {
    let s = 23 * 3600 + 40 * 60 + (TS * k) as u64;
    (28 + s / 86_400, s / 3600 % 24, s / 60 % 60, s % 60)
}

/// How a row tells its time: the column's name, and a cell. Numbers have a point.
type Time = (&'static str, fn(usize) -> String);
const TIMES: [Time; 44] = [
    ("time", |k| (TS * k).to_string()),
    ("time", |k| format!("{:.1}", (TS * k) as f64)),
    ("time", |k| format!("{:.3}", (TS * k) as f64)),
    ("time", |k| format!("{:.6e}", (TS * k) as f64)),
    ("time", |k| (1000 * TS * k).to_string()),
    ("time_ms", |k| (1000 * TS * k).to_string()),
    ("time_us", |k| (1_000_000 * TS * k).to_string()),
    ("time", |k| (1_000_000 * TS * k).to_string()),
    ("time_ms", |k| ((4_294_000_000 + 1000 * TS * k) % 4_294_967_296).to_string()),
    ("Time (min)", |k| format!("{:.4}", (TS * k) as f64 / 60.0)),
    ("elapsed_h", |k| format!("{:.6}", (TS * k) as f64 / 3600.0)),
    ("time_d", |k| format!("{:.8}", (TS * k) as f64 / 86_400.0)),
    ("time", |k| format!("{:.7}", 46_109.0 + (85_200 + TS * k) as f64 / 86_400.0)),
    ("time", |k| format!("{:.8}", 740_069.0 + (85_200 + TS * k) as f64 / 86_400.0)),
    ("timestamp", |k| (START + (TS * k) as u64).to_string()),
    ("timestamp", |k| (1000 * (START + (TS * k) as u64)).to_string()),
    ("timestamp", |k| (1_000_000_000 * (START + (TS * k) as u64)).to_string()),
    ("ticks", |k| (10_000_000 * (62_135_596_800 + START + (TS * k) as u64)).to_string()),
    ("time", |k| with(k, |d, h, m, s| format!("2026-03-{d} {h:02}:{m:02}:{s:02}"))),
    ("time", |k| with(k, |d, h, m, s| format!("2026-03-{d}T{h:02}:{m:02}:{s:02}.000"))),
    ("time", |k| with(k, |d, h, m, s| format!("2026-03-{d}T{h:02}:{m:02}:{s:02}Z"))),
    ("time", |k| with(k, |d, h, m, s| format!("2026-03-{d}T{h:02}:{m:02}:{s:02}+01:00"))),
    ("time", |k| with(k, |d, h, m, s| format!("2026-03-{d} {h:02}:{m:02}:{s:02} +0100"))),
    ("time", |k| with(k, |d, h, m, s| format!("2026/03/{d} {h:02}:{m:02}:{s:02}"))),
    ("time", |k| with(k, |d, h, m, s| format!("3/{d}/2026 {h}:{m:02}:{s:02}"))),
    ("time", |k| {
        with(k, |d, h, m, s| {
            format!("3/{d}/2026 {}:{m:02}:{s:02} {}", (h + 11) % 12 + 1, ["AM", "PM"][(h / 12) as usize])
        })
    }),
    ("time", |k| with(k, |d, h, m, s| format!("{d}/03/2026 {h:02}:{m:02}:{s:02}"))),
    ("time", |k| with(k, |d, h, m, s| format!("0{}/03/2026 {h:02}:{m:02}:{s:02}", d - 24))),
    ("time", |k| with(k, |d, h, m, s| format!("03/0{}/26 {h:02}:{m:02}:{s:02}", d - 24))),
    ("time", |k| with(k, |d, h, m, s| format!("{d}.03.2026 {h:02}:{m:02}:{s:02}"))),
    ("time", |k| with(k, |d, h, m, s| format!("{d}.3.26 {h:02}:{m:02}:{s:02}"))),
    ("time", |k| with(k, |d, h, m, s| format!("{d}-03-2026 {h:02}:{m:02}:{s:02}"))),
    ("time", |k| with(k, |d, h, m, s| format!("{d} Mar 2026 {h:02}:{m:02}:{s:02}"))),
    ("time", |k| with(k, |d, h, m, s| format!("{d}-Mar-2026 {h:02}:{m:02}:{s:02}"))),
    ("time", |k| with(k, |d, h, m, s| format!("March {d} 2026 {h:02}:{m:02}:{s:02}"))),
    ("time", |k| with(k, |d, h, m, s| format!("Sat Mar {d} {h:02}:{m:02}:{s:02} 2026"))),
    ("time", |k| with(k, |d, h, m, s| format!("202603{d}{h:02}{m:02}{s:02}"))),
    ("time", |k| with(k, |d, h, m, s| format!("202603{d}T{h:02}{m:02}{s:02}Z"))),
    ("time", |k| with(k, |_, h, m, s| format!("{h:02}:{m:02}:{s:02}"))),
    ("time", |k| with(k, |_, h, m, s| format!("{h:02}:{m:02}:{s:02}.250"))),
    ("time", |k| with(k, |_, h, m, _| format!("{h:02}:{m:02}"))),
    ("time", |k| format!("{}:{:02}:{:02}", TS * k / 3600, TS * k / 60 % 60, TS * k % 60)),
    ("time", |k| format!("PT{}S", TS * k)),
    ("time", |k| format!("{} s", TS * k)),
];

fn with(k: usize, of: impl Fn(u64, u64, u64, u64) -> String) -> String {
    let (d, h, m, s) = at(k);
    of(d, h, m, s)
}

/// How a temperature and a power are told: the column's name, and a cell.
type Cell = (&'static str, fn(f64) -> String);
const TEMPERATURES: [Cell; 8] = [
    ("temperature", |t| format!("{t:.2}")),
    ("temperature", |t| t.to_string()),
    ("Temperature [°C]", |t| format!("{t:.3}")),
    ("temp", |t| format!("{t:.2} °C")),
    ("temp", |t| format!("{t:.2}C")),
    ("temperature_F", |t| format!("{:.2}", 1.8 * t + 32.0)),
    ("temp_K", |t| format!("{:.2}", t + 273.15)),
    ("T1", |t| format!("{t:.3e}")),
];
const POWERS: [Cell; 6] = [
    ("power", |p| p.to_string()),
    ("power", |p| format!("{p:.1}")),
    ("Heater (%)", |p| format!("{p} %")),
    ("duty", |p| format!("{p}%")),
    ("output", |p| format!("{:.2}", p / 100.0)),
    ("pwm", |p| (2.55 * p).round().to_string()),
];

/// What befalls a file, by its rows; how many rows have no sample then.
type Trouble = (&'static str, fn(&mut Vec<String>, char) -> usize);
const TROUBLES: [Trouble; 13] = [
    ("nothing", |_, _| 0),
    ("nothing", |_, _| 0),
    ("a short row", |rows, c| {
        rows[70] = rows[70].split(c).take(2).collect::<Vec<_>>().join(&c.to_string());
        1
    }),
    ("rows that are lost", |rows, _| rows.drain(90..95).count()),
    ("an empty line", |rows, _| {
        rows.insert(50, String::new());
        0
    }),
    ("a header again", |rows, _| {
        rows.insert(100, "HEADER".into());
        0
    }),
    ("zeros of a power failure", |rows, _| {
        rows[60] = "\0".repeat(40);
        1
    }),
    ("two rows that are exchanged", |rows, _| {
        rows.swap(80, 81);
        0
    }),
    ("newest first", |rows, _| {
        rows.reverse();
        0
    }),
    ("a row twice", |rows, _| {
        let row = rows[30].clone();
        rows.insert(30, row);
        0
    }),
    ("a last row that is cut off", |rows, _| {
        let last = rows.pop().unwrap();
        rows.push(last[..1].to_owned());
        1
    }),
    ("words at the end", |rows, _| {
        rows.push("End of log".into());
        0
    }),
    ("a cell that is no number", |rows, c| {
        let cells = rows[40].split(c).map(str::to_owned).collect::<Vec<_>>();
        let last = cells.len() - 1;
        rows[40] = [&cells[..last], &["#N/A".to_owned()]].concat().join(&c.to_string());
        0
    }),
];

/// A dialect: its text, how many samples are missing, and what it is.
fn dialect(dice: &mut Dice) -> (String, usize, String) {
    let (time, temperature, power) = (dice.of(&TIMES), dice.of(&TEMPERATURES), dice.of(&POWERS));
    let separator = dice.of(&[',', ',', ';', ';', '\t', '|']);
    let is_comma = separator != ',' && dice.one_in(2);
    let (is_quoted, has_index, has_others) = (dice.one_in(5), dice.one_in(6), dice.one_in(4));
    let (above, end) = (dice.below(5), dice.of(&["\n", "\n", "\r\n", "\r"]));
    let (what, trouble) = match dice.of(&TROUBLES) {
        // Which of the rows of a minute is lost, or comes late, no stamp of minutes tells.
        _ if time.1(0) == "23:40" => TROUBLES[0],
        trouble => trouble,
    };
    let number = |cell: String| if is_comma { cell.replace('.', ",") } else { cell };
    // Points of a date are none of a number.
    let stamp = |cell: String| if cell.matches('.').count() == 1 { number(cell) } else { cell };
    let join = |cells: Vec<String>| {
        let quoted = |cell: String| {
            if is_quoted || cell.contains(separator) { format!("\"{cell}\"") } else { cell }
        };
        cells.into_iter().map(quoted).collect::<Vec<_>>().join(&separator.to_string())
    };
    let row = |k: usize, (t, p): (f64, f64)| {
        let mut cells = vec![stamp(time.1(k)), number(temperature.1(t)), number(power.1(p))];
        if has_others {
            cells.extend(["21.5".to_owned(), "ok".to_owned()].map(number));
        }
        if has_index {
            cells.insert(0, (k + 1).to_string());
        }
        join(cells)
    };
    let mut names: Vec<String> = [time.0, temperature.0, power.0].map(str::to_owned).to_vec();
    names.extend(["setpoint", "state"].into_iter().filter(|_| has_others).map(str::to_owned));
    if has_index {
        names.insert(0, "no".into());
    }
    let header = join(names);
    let mut rows: Vec<String> = truth().into_iter().enumerate().map(|(k, of)| row(k, of)).collect();
    let missing = trouble(&mut rows, separator);
    let mut text = match above {
        0 => format!("# by a logger{end}"),
        1 => format!("Logger 7{end}{end}"),
        _ => String::new(),
    };
    let _ = write!(text, "{header}{end}");
    let lines = rows.iter().map(|row| row.replace("HEADER", &header));
    text += &lines.collect::<Vec<_>>().join(end);
    let whole = what != "a last row that is cut off";
    text += if whole { end } else { "" };
    (text, missing, format!("{what}; {}", &header))
}

/// What is wrong with a recording of the truth; nothing if it is right.
fn wrong(recording: &Recording, missing: usize) -> Option<String> {
    let (samples, full) = (&recording.heaters[0].samples, f64::from(recording.units.full_power));
    let offset = ROWS.checked_sub(samples.len()).filter(|short| *short <= missing);
    if offset.is_none() || (recording.sample_time - TS as f64).abs() > 1e-6 {
        return Some(format!("{} samples, one each {} s", samples.len(), recording.sample_time));
    }
    let mut gone = 0;
    for (k, ((t, p), sample)) in truth().iter().zip(samples).enumerate() {
        let off = |x: Option<f32>, y: f64, most: f64| x.is_some_and(|x| (f64::from(x) - y).abs() > most);
        gone += usize::from(sample.t[1].is_none() || sample.power.is_none());
        if off(sample.t[1], *t, 0.03) || off(sample.power.map(|p| 100.0 * p / full as f32), *p, 0.5) {
            return Some(format!("sample {k} is {sample:?}, expected {t} degC and {p} %"));
        }
    }
    (gone > missing + 1).then(|| format!("{gone} samples are missing"))
}

#[test]
fn no_dialect_is_taken_for_another() {
    let (mut refused, mut bad) = (Vec::new(), Vec::new());
    for seed in SEED..SEED + TRIED {
        let (text, missing, what) = dialect(&mut Dice(seed));
        let begin: String = text.lines().take(3).collect::<Vec<_>>().join("\n");
        match Recording::parse("f".into(), &text, &Reading::default()) {
            Err(error) => refused.push(format!("seed {seed}: {what}: {error:#}\n{begin}")),
            Ok(recording) => {
                let wrong = wrong(&recording, missing);
                bad.extend(
                    wrong.map(|why| format!("seed {seed}: {what}: {why}\n{begin}\n{:?}", recording.remarks)),
                );
            }
        }
    }
    assert!(bad.is_empty(), "{} of {TRIED} are wrong:\n{}", bad.len(), bad.join("\n"));
    assert!(refused.is_empty(), "{} of {TRIED} are refused:\n{}", refused.len(), refused.join("\n"));
}
