//! Two charts of each model, low-passed, and the one threshold of all.

use std::ops::Range;

use fdi_core::Seconds;
use fdi_core::filter::LowPass;

use super::model::{Frozen, Usual};
use super::settings::Plant;
use super::signs::{Sign, Signs};

/// What was learnt of a plant while nothing was wrong.
#[derive(Clone, Debug)]
pub(super) struct Watch {
    signals: Vec<Usual>,
    models: Vec<Frozen>,
    /// Of each model's innovations.
    innovations: Vec<Usual>,
    low_pass: LowPass,
    /// Standard deviation of each chart.
    sd: Vec<f32>,
    threshold: f32,
}

impl Watch {
    /// Learns models, charts and threshold.
    ///
    /// # Errors
    /// The file is too short.
    pub(super) fn learn(plant: &Plant, training: &[Vec<f32>]) -> anyhow::Result<Self> {
        // The core's filter takes a cut-off: that of this share, with a sample as the unit of time.
        let low_pass = LowPass::new(-(1.0 - plant.low_pass).ln(), Seconds(1.0));
        let signals = training.iter().map(|signal| Usual::of(signal)).collect();
        let mut watch = Self {
            signals,
            models: Vec::new(),
            innovations: Vec::new(),
            low_pass,
            sd: vec![1.0; 2 * plant.models.len()],
            threshold: f32::INFINITY,
        };
        let scaled = watch.scaled(training);
        for model in &plant.models {
            let model = Frozen::learn(model, &scaled)?;
            watch.innovations.push(Usual::of(&model.innovations(&scaled)[plant.skip..]));
            watch.models.push(model);
        }
        watch.sd = watch.charts(training).iter().map(|chart| Usual::of(&chart[plant.skip..]).sd).collect();
        let charts = watch.charts(training);
        let mut largest: Vec<f32> = watch.largest(&charts).split_off(plant.skip);
        largest.sort_by(f32::total_cmp);
        watch.threshold = largest[(plant.quantile * (largest.len() - 1) as f64).ceil() as usize];
        Ok(watch)
    }

    fn scaled(&self, signals: &[Vec<f32>]) -> Vec<Vec<f32>> {
        let scaled = signals.iter().zip(&self.signals);
        scaled.map(|(signal, usual)| signal.iter().map(|x| usual.scaled(*x)).collect()).collect()
    }

    /// The charts of a file, in standard deviations: of each model the innovation and its square, less 1.
    pub(super) fn charts(&self, signals: &[Vec<f32>]) -> Vec<Vec<f32>> {
        let scaled = self.scaled(signals);
        let of = |(model, usual): (&Frozen, &Usual)| {
            let left: Vec<f32> = model.innovations(&scaled).iter().map(|e| usual.scaled(*e)).collect();
            let square = left.iter().map(|e| e * e - 1.0).collect();
            [left, square]
        };
        let charts = self.models.iter().zip(&self.innovations).flat_map(of);
        charts.zip(&self.sd).map(|(chart, sd)| self.low_passed(&chart, *sd)).collect()
    }

    fn low_passed(&self, chart: &[f32], sd: f32) -> Vec<f32> {
        let mut state = Some([0.0]);
        chart.iter().map(|x| self.low_pass.step(&mut state, &[*x])[0] / sd).collect()
    }

    /// The largest magnitude of all charts at each sample.
    fn largest(&self, charts: &[Vec<f32>]) -> Vec<f32> {
        let at = |k: usize| charts.iter().map(|chart| chart[k].abs()).fold(0.0, f32::max);
        (0..charts[0].len()).map(at).collect()
    }

    /// Which samples are in alarm.
    pub(super) fn alarms(&self, charts: &[Vec<f32>]) -> Vec<bool> {
        self.largest(charts).into_iter().map(|largest| largest > self.threshold).collect()
    }

    /// The sign of each chart over some samples.
    pub(super) fn signs(&self, charts: &[Vec<f32>], within: Range<usize>) -> Signs {
        charts.iter().map(|chart| Sign::of(&chart[within.clone()], self.threshold)).collect()
    }
}
