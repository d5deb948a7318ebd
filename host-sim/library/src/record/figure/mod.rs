//! Pictures as SVG: the paper's figures 4, 5 and 6, drawn from a run, and the charts of a campaign.

pub(crate) mod axis;
mod canvas;
pub(crate) mod chart;
mod content;
pub(crate) mod matrix;
mod paint;
mod plot;
pub(crate) mod polyline;

use std::path::Path;

use anyhow::Context;
use rayon::prelude::*;

use crate::experiment::Record;
use canvas::Canvas;
pub(crate) use canvas::Colour;
use paint::Layout;
pub(crate) use plot::{BLUE, VERMILLION};

/// A figure of the paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Number {
    /// Measurements and predictions.
    Four = 4,
    /// Output residuals and the features of the models.
    Five,
    /// The decisive residuals, and the fault vectors.
    Six,
}

/// All figures, in order.
pub const ALL: [Number; 3] = [Number::Four, Number::Five, Number::Six];

impl std::fmt::Display for Number {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}", *self as u8)
    }
}

/// What can be drawn.
pub(crate) trait Picture: Sync {
    /// Width and height, px.
    fn size(&self) -> (u32, u32);

    /// Draws it on a canvas of that size.
    fn paint(&self, canvas: &mut Canvas);
}

/// Writes `figure4.svg` and so on into a folder that exists.
///
/// # Errors
/// The file that can't be written.
pub fn draw_all(record: &Record, folder: &Path) -> anyhow::Result<()> {
    ALL.into_par_iter().try_for_each(|number| {
        let figure = content::figure(number, record);
        draw(&Layout::new(&figure), &label(number), folder, &format!("figure{number}"))
    })
}

/// Writes a picture as `name.svg` into a folder that exists.
///
/// # Errors
/// The file that can't be written.
pub(crate) fn draw(picture: &impl Picture, label: &str, folder: &Path, name: &str) -> anyhow::Result<()> {
    let path = folder.join(format!("{name}.svg"));
    std::fs::write(&path, drawn(picture, label)).with_context(|| format!("can't write {}", path.display()))
}

fn label(number: Number) -> String {
    format!("Figure {number}")
}

fn drawn(picture: &impl Picture, label: &str) -> String {
    let mut canvas = Canvas::new(picture.size(), label);
    picture.paint(&mut canvas);
    canvas.finish()
}

/// Maps a value from one interval to another.
fn place(x: f64, from: (f64, f64), to: (f64, f64)) -> f64 {
    to.0 + (x - from.0) / (from.1 - from.0) * (to.1 - to.0)
}

#[cfg(test)]
mod tests {
    use fdi_core::Config;
    use fdi_core::likelihood::{FaultClass, Finding, LikelihoodReport, Readiness};

    use super::*;
    use crate::experiment::run;
    use crate::experiment::scenario::Scenario;

    fn svg(number: Number, record: &Record) -> String {
        drawn(&Layout::new(&content::figure(number, record)), &label(number))
    }

    fn record(duration: f64) -> Record {
        let mut scenario = Scenario { duration, ..Scenario::default() };
        scenario.faults[0].name = "<b> & co".into();
        scenario.faults[0].at = 2.0;
        run(&Config::default(), &scenario, 1).unwrap()
    }

    fn assert_is_sound(svg: &str, panels: usize) {
        assert!(svg.starts_with("<svg ") && svg.trim_end().ends_with("</svg>"));
        assert_eq!(svg.matches("<text").count(), svg.matches("</text>").count());
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "a place that is no number");
        let frames = svg.matches("points=\"64.0,").count();
        assert!(frames >= panels, "{frames} frames");
    }

    #[test]
    fn a_run_too_short_to_learn_has_all_its_panels() {
        for (number, panels) in ALL.into_iter().zip([4, 4, 8]) {
            let svg = svg(number, &record(10.0));
            assert_is_sound(&svg, panels);
            assert!(svg.contains("&lt;b&gt; &amp; co"));
        }
        assert!(svg(Number::Six, &record(10.0)).contains("not defined in this run"));
    }

    #[test]
    fn a_run_of_nothing_has_all_its_panels() {
        let mut empty = record(1.0);
        empty.rows.clear();
        for (number, panels) in ALL.into_iter().zip([4, 4, 8]) {
            assert_is_sound(&svg(number, &empty), panels);
        }
    }

    #[test]
    fn thresholds_and_faults_are_in_figure_6() {
        let mut record = record(400.0);
        for row in record.rows.iter_mut().skip(3500) {
            row.report.likelihood = LikelihoodReport {
                readiness: Readiness::Armed,
                alarm: true,
                finding: Some(Finding {
                    class: FaultClass::Drift,
                    confidence: 1.0,
                    magnitude: None,
                    onset: 3500,
                }),
                ..LikelihoodReport::default()
            };
        }
        let svg = svg(Number::Six, &record);
        assert!(svg.matches(">drift<").count() == 1, "the verdict's name beside its level");
        assert!(svg.contains("thresholds") && svg.contains("learning what is normal"));
        assert!(!svg.contains("not defined in this run"));
        assert!(svg.len() < 400_000, "{}", svg.len());
    }

    #[test]
    fn files_are_the_figures() {
        let record = record(30.0);
        let folder = std::env::temp_dir().join(format!("pt326-figures-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        draw_all(&record, &folder).unwrap();
        let files =
            ALL.map(|number| std::fs::read_to_string(folder.join(format!("figure{number}.svg"))).unwrap());
        std::fs::remove_dir_all(&folder).unwrap();
        assert_eq!(files, ALL.map(|number| svg(number, &record)));
    }

    #[test]
    fn a_folder_that_is_not_there_is_named() {
        let error = draw_all(&record(1.0), Path::new("/nowhere/at/all")).unwrap_err();
        assert!(format!("{error:#}").contains("/nowhere/at/all/figure"), "{error:#}");
    }
}
