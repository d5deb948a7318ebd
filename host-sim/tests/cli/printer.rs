//! The log of a printer's firmware, as it is: a hot end and a bed under control, one line a second or so, starts, gaps, a shutdown. Nothing is cut out
//! by hand, and nobody says what is normal.

use std::fmt::Write as _;

use fdi_core::Config;
use indicatif::ProgressBar;
use pt326_host::recording::run::{Diagnosed, Training, diagnose};
use pt326_host::recording::{Reading, Recording};

use crate::plant::Dice;
use crate::{arg, folder, on_a_large_stack, pt326, text};

/// A heater with its thermistor and its PI controller. Times in s, temperatures in degC above the room, powers as shares.
struct Heater {
    gain: f64,
    block: f64,
    lag: f64,
    noise: f64,
    heat: [f64; 2],
    sum: f64,
    pwm: f64,
}

impl Heater {
    fn hot_end() -> Self {
        Self { gain: 330.0, block: 140.0, lag: 5.0, noise: 0.08, heat: [0.0; 2], sum: 0.0, pwm: 0.0 }
    }

    fn bed() -> Self {
        Self { gain: 95.0, block: 420.0, lag: 12.0, noise: 0.03, heat: [0.0; 2], sum: 0.0, pwm: 0.0 }
    }

    /// A second later; what the thermistor reads, and off by how much the firmware believes it.
    fn goes_on(&mut self, target: f64, off: f64, dice: &mut Dice) -> f64 {
        self.heat[0] += (self.gain * self.pwm - self.heat[0]) / self.block;
        self.heat[1] += (self.heat[0] - self.heat[1]) / self.lag;
        let read = 21.5 + self.heat[1] + dice.between(-self.noise, self.noise) + off;
        let left = target - read;
        self.sum = if target > 0.0 && left.abs() < 20.0 {
            (self.sum + 0.0008 * left).clamp(0.0, 1.0)
        } else {
            self.sum
        };
        self.pwm = if target > 0.0 { (0.035 * left + self.sum).clamp(0.0, 1.0) } else { 0.0 };
        self.pwm = (1000.0 * self.pwm).round() / 1000.0;
        read
    }
}

/// A printer that writes its log.
struct Printer {
    log: String,
    /// The printer's own clock, s.
    time: f64,
    hot_end: Heater,
    bed: Heater,
    dice: Dice,
}

impl Printer {
    fn of(seed: u64) -> Self {
        let (hot_end, bed) = (Heater::hot_end(), Heater::bed());
        Self { log: String::new(), time: 1000.0, hot_end, bed, dice: Dice::of(seed) }
    }

    fn line(&mut self, time: f64, [target, temp, pwm]: [f64; 3], [bed_target, bed_temp, bed_pwm]: [f64; 3]) {
        let _ = writeln!(
            self.log,
            "Stats {time:.1}: gcodein=0  mcu: mcu_awake=0.002 mcu_task_avg=0.000010 bytes_write=4410 bytes_retransmit=9 freq=72000573 \
             heater_bed: target={bed_target:.0} temp={bed_temp:.1} pwm={bed_pwm:.3} print_time={:.3} buffer_time=0.000 print_stall=0 \
             extruder: target={target:.0} temp={temp:.1} pwm={pwm:.3} sysload=0.35 cputime=7.412 memavail=691268",
            time - 990.0,
        );
    }

    /// The firmware starts: a line that says so, and readings of 0.0 before the first real ones.
    fn start(&mut self) {
        let _ =
            writeln!(self.log, "Start printer at Wed May  1 10:00:00 2024 (1714557600.0 {:.1})", self.time);
        let _ = writeln!(
            self.log,
            "===== Config file =====\n[extruder]\nheater_pin = PA2\nmax_temp = 300\n======================="
        );
        for _ in 0..3 {
            self.time += 1.0;
            self.line(self.time, [0.0; 3], [0.0; 3]);
        }
    }

    /// So many seconds with these targets; `off` is by how much more than it is the hot end's thermistor reads, by what it would read. Stamps are late by
    /// up to 0.1 s.
    fn print(&mut self, seconds: usize, target: f64, bed: f64, off: impl Fn(usize, f64) -> f64) {
        for k in 0..seconds {
            self.time += 1.0;
            let wrong = off(k, 21.5 + self.hot_end.heat[1]);
            let temp = self.hot_end.goes_on(target, wrong, &mut self.dice);
            let bed_temp = self.bed.goes_on(bed, 0.0, &mut self.dice);
            let late = self.dice.between(0.0, 0.1);
            let (pwm, bed_pwm) = (self.hot_end.pwm, self.bed.pwm);
            self.line(self.time + late, [target, temp, pwm], [bed, bed_temp, bed_pwm]);
        }
    }

    /// An evening: heated up, several temperatures, so that the power moves.
    fn print_parts(&mut self) {
        self.print(20, 0.0, 0.0, |_, _| 0.0);
        for (seconds, target, bed) in [
            (500, 210.0, 60.0),
            (300, 200.0, 60.0),
            (300, 220.0, 55.0),
            (300, 205.0, 55.0),
            (300, 215.0, 60.0),
        ] {
            self.print(seconds, target, bed, |_, _| 0.0);
        }
    }

    /// It stops, and goes on writing what it has measured last.
    fn shut_down(&mut self) {
        self.log += "MCU 'mcu' shutdown: ADC out of range\nTransition to shutdown state: ADC out of range\n";
        let last = self.log.lines().rev().find(|line| line.starts_with("Stats ")).unwrap().to_owned();
        let (_, said) = last.split_once(": ").unwrap();
        for _ in 0..90 {
            self.time += 1.0;
            let _ = writeln!(self.log, "Stats {:.1}: {said}", self.time);
        }
    }
}

fn parse(log: &str) -> Recording {
    Recording::parse("klippy.log".into(), log, &Reading::default())
        .unwrap_or_else(|error| panic!("{error:#}"))
}

/// What is made of a heater of a log of which nobody says what is normal.
fn judged(recording: &Recording, which: usize) -> Diagnosed {
    let config = Config::default();
    let training = Training::find(recording, &recording.heaters[which], &config).unwrap();
    diagnose(recording, which, &training, &[], &config, &ProgressBar::hidden()).unwrap()
}

/// Samples in alarm, with the name of each.
fn alarms(done: &Diagnosed) -> Vec<(usize, Option<&'static str>)> {
    let alarmed = done.record.rows.iter().filter(|row| row.report.likelihood.alarm);
    alarmed
        .map(|row| {
            (row.tick.index as usize, row.report.likelihood.finding.map(|finding| finding.class.name()))
        })
        .collect()
}

/// Two sessions, with a gap of 40 s in the first, which ends in a shutdown: both heaters are learnt from the log as it is, and nothing is wrong with them.
#[test]
fn a_log_of_a_sound_printer_is_learnt_as_it_is_and_raises_no_alarm() {
    on_a_large_stack(|| {
        for seed in 1..=3 {
            let mut printer = Printer::of(seed);
            printer.start();
            printer.print_parts();
            // It prints on, but nothing is written.
            let written = printer.log.len();
            printer.print(40, 215.0, 60.0, |_, _| 0.0);
            printer.log.truncate(written);
            printer.print(300, 205.0, 60.0, |_, _| 0.0);
            printer.shut_down();
            printer.time += 300.0;
            (printer.hot_end.pwm, printer.bed.pwm) = (0.0, 0.0);
            printer.start();
            printer.print_parts();
            let recording = parse(&printer.log);
            assert_eq!(recording.sessions.len(), 2, "seed {seed}: {:?}", recording.sessions);
            for (which, name) in ["extruder_temp", "heater_bed_temp"].into_iter().enumerate() {
                let done = judged(&recording, which);
                assert!(done.trained.fit > 85.0, "seed {seed}, {name}: {} %", done.trained.fit);
                assert_eq!(alarms(&done), [], "seed {seed}, {name}");
            }
        }
    });
}

/// A log that was cut by a rotation begins while the hot end is on its way up.
#[test]
fn a_log_that_begins_in_the_middle_of_a_transient_is_learnt() {
    on_a_large_stack(|| {
        for (seed, cut) in [(11, 40), (12, 70), (13, 110)] {
            let mut printer = Printer::of(seed);
            printer.start();
            printer.print_parts();
            let lines: Vec<&str> = printer.log.lines().filter(|line| line.starts_with("Stats ")).collect();
            let recording = parse(&lines[cut..].join("\n"));
            // From one way up and what comes behind it the gain is not known to a few per cent: the first third of the evening is not enough.
            let training = Training::Own(0..recording.len() * 6 / 10, "said".into());
            let done =
                diagnose(&recording, 0, &training, &[], &Config::default(), &ProgressBar::hidden()).unwrap();
            let model = done.trained.model;
            let gain = 100.0 * f64::from(model.gain) / Heater::hot_end().gain;
            assert!((0.97..1.03).contains(&gain), "seed {seed}: {gain} of the gain");
            assert!(done.trained.fit > 85.0, "seed {seed}: {} %", done.trained.fit);
            assert_eq!(alarms(&done), [], "seed {seed}");
        }
    });
}

/// The part that is found in a log of which the first lines are missing, by its ends and the words of why, the gain that is learnt there as a share of the true one, and how many samples there are.
fn found(printer: &Printer, cut: usize) -> ([usize; 2], String, f64, usize) {
    let lines: Vec<&str> = printer.log.lines().filter(|line| line.starts_with("Stats ")).collect();
    let recording = parse(&lines[cut..].join("\n"));
    let training = Training::find(&recording, &recording.heaters[0], &Config::default()).unwrap();
    let done = diagnose(&recording, 0, &training, &[], &Config::default(), &ProgressBar::hidden()).unwrap();
    let Training::Found(part, why, _) = training else { panic!("it was not looked for") };
    let gain = 100.0 * f64::from(done.trained.model.gain) / Heater::hot_end().gain;
    ([part.start, part.end], why, gain, recording.len())
}

/// Nobody says what is normal in a log that begins on the way up. The first quarter alone would tell a gain that is 14 to 67 % too low: more is learnt from.
#[test]
fn more_is_learnt_from_where_the_first_quarter_is_a_way_up() {
    on_a_large_stack(|| {
        for (seed, cut) in [(11, 60), (12, 70), (13, 90), (14, 110)] {
            let mut printer = Printer::of(seed);
            printer.start();
            printer.print_parts();
            let ([from, to], why, gain, count) = found(&printer, cut);
            assert!((0.95..1.05).contains(&gain), "seed {seed}: {gain} of the gain");
            assert!(from == 0 && to > count * 3 / 10, "seed {seed}: {from} to {to} of {count}");
            assert!(!why.contains("no part tells the gain"), "seed {seed}: {why}");
        }
    });
}

/// The heater gives less from the middle of the log on, and up to its end: what is wrong is not learnt.
#[test]
fn a_fault_that_stays_is_not_learnt() {
    on_a_large_stack(|| {
        for (seed, gives) in [(41, 0.8), (42, 0.75), (43, 0.7)] {
            let mut printer = Printer::of(seed);
            printer.start();
            printer.print(20, 0.0, 0.0, |_, _| 0.0);
            for (k, target) in [210.0, 200.0, 220.0, 205.0, 215.0, 200.0, 210.0].into_iter().enumerate() {
                printer.hot_end.gain *= if k == 4 { gives } else { 1.0 };
                printer.print(300, target, 60.0, |_, _| 0.0);
            }
            let ([from, to], why, gain, count) = found(&printer, 55);
            assert!(from == 0 && to <= count * 4 / 7, "seed {seed}: {from} to {to} of {count}: {why}");
            assert!((0.9..1.1).contains(&gain), "seed {seed}: {gain} of the gain");
        }
    });
}

/// An error of the thermistor that leaps, and stays up to the end, is taken out of what is learnt from, and told where it begins.
#[test]
fn an_error_that_leaps_is_not_learnt() {
    on_a_large_stack(|| {
        for seed in [51, 52, 53] {
            let mut printer = Printer::of(seed);
            printer.start();
            printer.print(20, 0.0, 0.0, |_, _| 0.0);
            for target in [210.0, 200.0, 220.0] {
                printer.print(300, target, 60.0, |_, _| 0.0);
            }
            let from = printer.log.lines().filter(|line| line.starts_with("Stats ")).count();
            for target in [205.0, 215.0, 200.0, 210.0] {
                printer.print(300, target, 60.0, |_, _| 10.0);
            }
            let recording = parse(&printer.log);
            let done = judged(&recording, 0);
            let gain = 100.0 * f64::from(done.trained.model.gain) / Heater::hot_end().gain;
            assert!((0.9..1.1).contains(&gain), "seed {seed}: {gain} of the gain");
            let first = alarms(&done).first().map(|(k, _)| *k);
            assert!(first.is_some_and(|first| first.abs_diff(from) < 5), "seed {seed}: {from}, {first:?}");
        }
    });
}

/// Within seconds the reading falls to nonsense, and the firmware gives full power: its thermistor, or the heater, is said to be wrong within 3 s, before
/// the firmware itself stops.
#[test]
fn a_reading_that_collapses_is_told_within_3_s() {
    on_a_large_stack(|| {
        for (seed, a_second) in [(21, 60.0), (22, 25.0), (23, 12.0)] {
            let mut printer = Printer::of(seed);
            printer.start();
            printer.print_parts();
            let from = printer.log.lines().filter(|line| line.starts_with("Stats ")).count();
            printer.print(12, 215.0, 60.0, |k, reads| -f64::min(a_second * (k + 1) as f64, reads + 14.0));
            printer.shut_down();
            let recording = parse(&printer.log);
            let done = judged(&recording, 0);
            let alarms = alarms(&done);
            let first = alarms.first().map(|(k, _)| *k);
            assert!(
                first.is_some_and(|first| (from..=from + 3).contains(&first)),
                "seed {seed}: {from}, {alarms:?}"
            );
            let named = |name: &str| name.starts_with("t1_") || name == "heater_power" || name == "drift";
            let last = alarms.last().and_then(|(_, name)| *name);
            assert!(last.is_some_and(named), "seed {seed}: {alarms:?}");
        }
    });
}

/// The same by the command, in words.
#[test]
fn a_reading_that_collapses_is_told_in_words() {
    let mut printer = Printer::of(31);
    printer.start();
    printer.print_parts();
    printer.print(12, 215.0, 60.0, |k, reads| -f64::min(30.0 * (k + 1) as f64, reads + 14.0));
    printer.shut_down();
    let dir = folder("printer");
    let file = dir.join("klippy.log");
    std::fs::write(&file, &printer.log).unwrap();
    let done = pt326(&["diagnose", arg(&file), "--out", arg(&dir.join("out"))]);
    let said = text(&done.stdout);
    assert!(done.status.success(), "{said}{}", text(&done.stderr));
    assert!(said.contains(" of it judged, 1 alarm:\n  1724.00 s  T1 sees "), "{said}");
}
