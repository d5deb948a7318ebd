//! How much faster than real time the paper's experiment runs on one core: whole, and its two sides alone.
//!
//! `cargo bench -p pt326-host`. An "element" is a simulated second, so elements a second are times real time.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use fdi_core::{Command, Config, Instrument, RawSample};
use pt326_host::experiment::scenario::Scenario;
use pt326_host::experiment::{self, as_written, sample};
use pt326_rig::Rig;

const SEED: u64 = 1;

fn bench(c: &mut Criterion) {
    let (config, scenario) = (Config::default(), Scenario::default());
    let sample_time = as_written(config.sample_time.0);
    let new_rig = || Rig::new(&scenario.rig, scenario.disturbance, sample_time, SEED, &scenario.faults);
    let record = experiment::run(&config, &scenario, SEED).expect("the defaults are valid");
    let drives: Vec<f64> = record.rows.iter().map(|row| f64::from(row.tick.drive.0)).collect();
    let mut rig = new_rig();
    let codes: Vec<_> = drives.iter().map(|&drive| next_codes(&mut rig, drive)).collect();

    let mut group = c.benchmark_group("experiment");
    group.throughput(Throughput::Elements(scenario.duration as u64));
    group.bench_function("rig and instrument", |b| b.iter(|| experiment::run(&config, &scenario, SEED)));
    group.bench_function("rig alone", |b| {
        b.iter(|| {
            let mut rig = new_rig();
            drives.iter().for_each(|&drive| {
                black_box(next_codes(&mut rig, drive));
            });
        });
    });
    group.bench_function("instrument alone", |b| {
        b.iter(|| {
            let mut instrument = Instrument::new(&config).expect("the defaults are valid");
            instrument.command(Command::Arm).expect("a new instrument is off");
            for &raw in &codes {
                let tick = instrument.control(raw);
                black_box(instrument.diagnose(&tick, tick.drive));
            }
        });
    });
    group.finish();
}

fn next_codes(rig: &mut Rig, drive: f64) -> RawSample {
    let raw = sample(rig);
    rig.advance(drive);
    raw
}

criterion_group!(benches, bench);
criterion_main!(benches);
