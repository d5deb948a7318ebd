//! What the charts of the page show.

use super::chart::{Chart, Line, Span};
use super::page::CLOSE;
use super::{Told, learnt_from};
use crate::experiment::Row;
use pt326_fit::stretches::GAP;

/// Times that are shaded in each chart.
pub(super) fn shaded(told: &Told) -> Vec<Span> {
    let span = |class, from: f64, to: f64, title: String, mark: String| Span {
        class,
        span: (from, to),
        title,
        mark,
    };
    let mut spans = Vec::new();
    if let Some((part, _)) = learnt_from(told.training) {
        let at = |k: usize| k as f64 * told.recording.sample_time;
        spans.push(span("train", at(part.start), at(part.end), "learnt from".into(), String::new()));
    }
    spans.extend(
        told.unjudged.iter().map(|part| {
            span("blind", part.from, part.to, format!("not judged: {}", part.why), String::new())
        }),
    );
    spans.extend(
        told.done
            .record
            .faults
            .iter()
            .map(|fault| span("truth", fault.at, fault.end(), fault.label(), String::new())),
    );
    spans.extend(told.episodes.iter().enumerate().map(|(i, episode)| {
        let title = episode.headline().map_or(String::new(), |said| said.sentence);
        let mark = if i < CLOSE { (i + 1).to_string() } else { String::new() };
        span("alarm", episode.from, episode.to, title, mark)
    }));
    spans
}

/// What a chart shows.
#[derive(Clone, Copy)]
pub(super) enum Signal {
    T1,
    Difference,
    Power,
    Others,
}

/// The signals of the rows; none stands where the recording has a gap.
pub(super) struct Data<'a> {
    told: &'a Told<'a>,
    rows: Vec<Option<(&'a Row, f64)>>,
    times: Vec<f64>,
}

impl<'a> Data<'a> {
    pub(super) fn of(told: &'a Told<'a>) -> Self {
        let record = &told.done.record;
        let most = (told.done.thinned + GAP) as u32;
        let (mut rows, mut times, mut last) = (Vec::new(), Vec::new(), None);
        for (row, expected) in record.rows.iter().zip(&told.expected) {
            let index = row.tick.index;
            if let Some(last) = last.replace(index).filter(|last| index - last > most) {
                rows.push(None);
                times.push(0.5 * (record.time(last) + record.time(index)));
            }
            rows.push(Some((row, expected.unwrap_or(f64::NAN))));
            times.push(record.time(index));
        }
        Self { told, rows, times }
    }

    fn values(&self, of: impl Fn(&Row) -> Option<f32>) -> Vec<f64> {
        let value = |row: &Option<(&Row, f64)>| row.and_then(|(row, _)| of(row)).map_or(f64::NAN, f64::from);
        self.rows.iter().map(value).collect()
    }

    /// What was recorded at each row.
    fn samples(&self, of: impl Fn(&fdi_core::Observed) -> Option<f32>) -> Vec<f64> {
        let samples = &self.told.heater.samples;
        self.values(|row| of(samples.get(row.tick.index as usize)?))
    }

    pub(super) fn has_beside(&self) -> bool {
        self.told.heater.samples.iter().any(|sample| sample.beside.is_some())
    }

    pub(super) fn chart(
        &self,
        label: &str,
        span: (f64, f64),
        height: f64,
        spans: &[Span],
        signal: Signal,
    ) -> String {
        let expected: Vec<f64> =
            self.rows.iter().map(|row| row.map_or(f64::NAN, |(_, expected)| expected)).collect();
        let measured = self.samples(|sample| sample.t[1]);
        let band = self.told.band;
        let around = |middle: &[f64]| {
            let edge = |by: f64| middle.iter().map(|x| x + by).collect::<Vec<f64>>();
            Some([edge(-band), edge(band)]).filter(|_| band.is_finite())
        };
        let line = |class, values| Line { class, values, is_stepped: false };
        let percent = 100.0 / self.told.recording.units.full_power;
        let (band, lines) = match signal {
            Signal::T1 => (around(&expected), vec![line("model", expected), line("t1", measured)]),
            Signal::Difference => {
                let off: Vec<f64> = measured.iter().zip(&expected).map(|(t, e)| t - e).collect();
                let none: Vec<f64> = off.iter().map(|off| 0.0 * off).collect();
                (around(&none), vec![line("t1", off)])
            }
            Signal::Power => {
                let power = Line {
                    class: "power",
                    values: self.samples(|s| Some(s.power? * percent)),
                    is_stepped: true,
                };
                let beside = Line {
                    class: "other",
                    values: self.samples(|s| Some(s.beside? * percent)),
                    is_stepped: true,
                };
                (None, if self.has_beside() { vec![beside, power] } else { vec![power] })
            }
            Signal::Others => {
                let others =
                    [(self.told.heater.inputs.t0, "room", 0), (self.told.heater.inputs.t2, "other", 2)];
                let others = others.into_iter().filter(|(is, ..)| *is);
                (None, others.map(|(_, class, which)| line(class, self.samples(|s| s.t[which]))).collect())
            }
        };
        let least = 0.01 * f64::from(self.told.recording.units.full_power).min(1.0);
        Chart { label, span, height, times: &self.times, band, lines, spans: spans.to_vec(), least }.svg()
    }
}
