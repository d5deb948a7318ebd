//! Samples as they come, a line each.

use std::io::BufRead;

use anyhow::{Context, ensure};
use fdi_core::Config;

use super::super::terminal::print;
use super::DiagnoseArgs;
use crate::experiment::{Origin, Record, Row, tick_time};
use crate::record::summary::sentence;
use crate::recording::training::train;
use crate::recording::{Reading, Recording};

/// Learns from the other recording, then reads standard input until it ends.
pub(super) fn run(args: &DiagnoseArgs, how: &Reading, config: &Config) -> anyhow::Result<()> {
    let path = args.train_on.as_deref().context("--live asks for --train-on")?;
    let other = Recording::read(path, how)?;
    let heater = &other.heaters[0];
    let trained = train(&other, heater, &heater.samples, config)?;
    print(&format!("{}: learnt from {}, {:.1} % explained\n", heater.map, other.file, trained.fit))?;
    let mut monitor = trained.monitor;
    monitor.resume();
    let mut lines = std::io::stdin().lock().lines();
    let header = lines.next().context("standard input is empty: expected a header")??;
    let learnt = other.len() as u32;
    let origin = Origin::Watched { file: "standard input".into() };
    let mut record = Record::new(origin, &trained.config, &[], Vec::new(), None);
    record.sample_time = other.sample_time;
    let mut said = None;
    for (line, number) in lines.zip(2..) {
        let line = line?;
        // A recording of one line: the same cells, the same errors.
        let how = Reading {
            sample_time: Some(other.sample_time),
            celsius: Some(other.units.celsius.into()),
            ..how.clone()
        };
        let one = Recording::parse(
            format!("standard input, line {number}"),
            &format!("{header}\n{line}\n"),
            &how.untimed(),
        )?;
        ensure!(!one.is_empty(), "standard input, line {number} holds no sample");
        let (mut tick, mut report) = monitor.step(&one.heaters[0].samples[0]);
        tick.index = tick.index.saturating_sub(learnt);
        let likelihood = &mut report.likelihood;
        if let Some(finding) = &mut likelihood.finding {
            finding.onset = finding.onset.saturating_sub(learnt);
        }
        let now = likelihood.alarm.then(|| likelihood.finding.map(|finding| finding.class));
        if now != said {
            said = now;
            let row = Row { applied: tick.drive, tick, report, truth: 0 };
            let what = match (now, row.report.likelihood.finding) {
                (None, _) => "all is as expected again".to_owned(),
                (_, Some(finding)) => sentence(&record, &row, &finding),
                _ => "something is wrong, and it cannot be told what yet".to_owned(),
            };
            print(&format!("{:>9.2} s  {what}\n", tick_time(row.tick.index, record.sample_time)))?;
        }
    }
    Ok(())
}
