//! Pictures as SVG for pages and papers, and as PNG for a quick look: the paper's figures 4, 5 and 6, drawn from a run, and
//! the charts of a campaign.

pub(crate) mod axis;
mod canvas;
pub(crate) mod chart;
mod content;
pub(crate) mod matrix;
mod paint;
mod plot;
pub(crate) mod polyline;
mod text;

use std::path::Path;

use anyhow::Context;
use plotters::backend::{BitMapBackend, SVGBackend};
use rayon::prelude::*;

use crate::experiment::Record;
use canvas::{Medium, UNITS};
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

/// What can be drawn on any backend.
pub(crate) trait Picture: Sync {
    /// Width and height, px.
    fn size(&self) -> (u32, u32);

    /// Draws it.
    ///
    /// # Errors
    /// Those of the backend.
    fn paint<M: Medium>(&self, backend: &mut M) -> anyhow::Result<()>;
}

/// Writes `figure4.svg`, `figure4.png` and so on into a folder that exists.
///
/// # Errors
/// The file that can't be written.
pub fn draw_all(record: &Record, folder: &Path) -> anyhow::Result<()> {
    let draw_one = |number| {
        let figure = content::figure(number, record);
        draw(&Layout::new(&figure)?, &label(number), folder, &format!("figure{number}")).map(drop)
    };
    ALL.into_par_iter().try_for_each(draw_one)
}

/// Writes a picture as `name.svg` and `name.png` into a folder that exists, and gives the SVG.
///
/// # Errors
/// The file that can't be written.
pub(crate) fn draw(picture: &impl Picture, label: &str, folder: &Path, name: &str) -> anyhow::Result<String> {
    let path = |extension| folder.join(format!("{name}.{extension}"));
    let write_svg = || {
        let (path, svg) = (path("svg"), draw_svg(picture, label)?);
        std::fs::write(&path, &svg).with_context(|| format!("can't write {}", path.display()))?;
        anyhow::Ok(svg)
    };
    let write_png = || {
        let path = path("png");
        draw_png(picture, &path).with_context(|| format!("can't write {}", path.display()))
    };
    let (svg, png) = rayon::join(write_svg, write_png);
    png.and(svg)
}

/// A figure as SVG, without a file.
///
/// # Errors
/// Those of the drawing library.
#[cfg(test)]
pub(crate) fn svg(number: Number, record: &Record) -> anyhow::Result<String> {
    draw_svg(&Layout::new(&content::figure(number, record))?, &label(number))
}

fn label(number: Number) -> String {
    format!("Figure {number}")
}

fn draw_svg(picture: &impl Picture, label: &str) -> anyhow::Result<String> {
    let (width, height) = picture.size();
    let mut text = String::new();
    picture.paint(&mut SVGBackend::with_string(&mut text, (UNITS * width, UNITS * height)))?;
    // The backend counts in units and calls them pixels: the size is ours, the units stay in its viewBox.
    let body = text.split_once(" viewBox=").context("SVG without a viewBox")?.1;
    let attributes = format!("role=\"img\" aria-label=\"{label}\" stroke-linejoin=\"round\"");
    Ok(format!("<svg {attributes} width=\"{width}\" height=\"{height}\" viewBox={body}"))
}

fn draw_png(picture: &impl Picture, path: &Path) -> anyhow::Result<()> {
    let size = picture.size();
    let large = (UNITS * size.0, UNITS * size.1);
    let mut pixels = vec![0; 3 * (large.0 * large.1) as usize];
    picture.paint(&mut BitMapBackend::with_buffer(&mut pixels, large))?;
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, size.0, size.1);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::Fast);
    encoder.set_adaptive_filter(png::AdaptiveFilterType::Adaptive);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&reduce(&pixels, size.0 as usize))?;
    writer.finish()?;
    Ok(std::fs::write(path, file)?)
}

/// Maps a value from one interval to another.
fn place(x: f64, from: (f64, f64), to: (f64, f64)) -> f64 {
    to.0 + (x - from.0) / (from.1 - from.0) * (to.1 - to.0)
}

/// An RGB picture reduced by [`UNITS`] to a width in px: each pixel is the mean of the units that it covers.
fn reduce(pixels: &[u8], width: usize) -> Vec<u8> {
    const CHANNELS: usize = 3;
    /// So many pixels of a row are looked at together: most of a picture is its white ground, of which nothing need be computed.
    const SPAN: usize = 16;
    let units = UNITS as usize;
    let row = CHANNELS * width * units;
    let ground = [u8::MAX; CHANNELS * SPAN * UNITS as usize];
    let mut reduced = vec![u8::MAX; pixels.len() / (units * units)];
    for (rows, reduced) in pixels.chunks_exact(row * units).zip(reduced.chunks_exact_mut(CHANNELS * width)) {
        for (span, reduced) in reduced.chunks_mut(CHANNELS * SPAN).enumerate() {
            let (from, length) = (span * ground.len(), units * reduced.len());
            let covered: [&[u8]; UNITS as usize] =
                core::array::from_fn(|y| &rows[y * row + from..y * row + from + length]);
            if covered.iter().all(|units| *units == &ground[..length]) {
                continue;
            }
            let mut columns = [0; CHANNELS * SPAN * UNITS as usize];
            for row in covered {
                for at in 0..length {
                    columns[at] += u32::from(row[at]);
                }
            }
            let columns = columns.as_chunks::<CHANNELS>().0.chunks_exact(units);
            for (pixel, covered) in reduced.as_chunks_mut::<CHANNELS>().0.iter_mut().zip(columns) {
                for channel in 0..CHANNELS {
                    let sum: u32 = covered.iter().map(|unit| unit[channel]).sum();
                    pixel[channel] = ((sum + UNITS * UNITS / 2) / (UNITS * UNITS)) as u8;
                }
            }
        }
    }
    reduced
}

#[cfg(test)]
mod tests {
    use fdi_core::Config;
    use fdi_core::likelihood::{FaultClass, Finding, LikelihoodReport, Readiness};

    use super::*;
    use crate::experiment::run;
    use crate::experiment::scenario::Scenario;

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
        let frames = svg.matches(&format!("points=\"{0},", UNITS * 64)).count();
        assert!(frames >= panels, "{frames} frames");
    }

    #[test]
    fn a_run_too_short_to_learn_has_all_its_panels() {
        for (number, panels) in ALL.into_iter().zip([4, 4, 8]) {
            let svg = svg(number, &record(10.0)).unwrap();
            assert_is_sound(&svg, panels);
            assert!(svg.contains("&lt;b&gt; &amp; co"));
        }
        assert!(svg(Number::Six, &record(10.0)).unwrap().contains("not defined in this run"));
    }

    #[test]
    fn a_run_of_nothing_has_all_its_panels() {
        let mut empty = record(1.0);
        empty.rows.clear();
        for (number, panels) in ALL.into_iter().zip([4, 4, 8]) {
            assert_is_sound(&svg(number, &empty).unwrap(), panels);
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
        let svg = svg(Number::Six, &record).unwrap();
        assert!(svg.matches(">\ndrift\n<").count() == 1, "the verdict's name beside its level");
        assert!(svg.contains("thresholds") && svg.contains("learning what is normal"));
        assert!(!svg.contains("not defined in this run"));
        assert!(svg.len() < 400_000, "{}", svg.len());
    }

    #[test]
    fn files_are_pictures_and_the_same_each_time() {
        let record = record(30.0);
        let folder = std::env::temp_dir().join(format!("pt326-figures-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        draw_all(&record, &folder).unwrap();
        let again = content::figure(Number::Four, &record);
        draw_png(&Layout::new(&again).unwrap(), &folder.join("again.png")).unwrap();
        let read = |name: &str| std::fs::read(folder.join(name)).unwrap();
        let pictures = ["figure4.png", "figure5.png", "figure6.png", "again.png"].map(read);
        let svgs = ["figure4.svg", "figure5.svg", "figure6.svg"].map(read);
        std::fs::remove_dir_all(&folder).unwrap();

        assert!(pictures.iter().all(|png| png.starts_with(b"\x89PNG\r\n\x1a\n")));
        assert!(pictures[0] == pictures[3] && pictures[0] != pictures[1]);
        for (file, number) in svgs.into_iter().zip(ALL) {
            assert!(file == svg(number, &record).unwrap().into_bytes(), "figure {number}");
        }
    }

    #[test]
    fn a_folder_that_is_not_there_is_named() {
        let error = draw_all(&record(1.0), Path::new("/nowhere/at/all")).unwrap_err();
        assert!(format!("{error:#}").contains("/nowhere/at/all/figure"), "{error:#}");
    }

    #[test]
    fn a_pixel_is_the_mean_of_its_units() {
        let unit_rows = [[0, 0, 0, 100, 0, 8], [100, 0, 0, 200, 4, 8]].concat();
        assert_eq!(reduce(&unit_rows, 1), [100, 1, 4]);
    }

    /// Spans of the white ground are passed over, whole ones and the last of a row.
    #[test]
    fn each_pixel_among_white_ones_is_the_mean_of_its_units() {
        let width = 37;
        for pixel in 0..2 * width {
            let mut unit_rows = vec![255; 3 * 4 * 2 * width];
            let (x, y) = (pixel % width, pixel / width);
            unit_rows[3 * (2 * width * (2 * y + 1) + 2 * x) + 1] = 55; // the green of the unit at the lower left
            let mut wanted = vec![255; 3 * 2 * width];
            wanted[3 * pixel + 1] = 205;
            assert_eq!(reduce(&unit_rows, width), wanted, "pixel {pixel}");
        }
    }
}
