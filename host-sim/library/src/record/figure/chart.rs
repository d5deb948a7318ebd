//! A grid of small charts with one common scale of values: dots with bars, on logarithmic axes or over names.

use super::canvas::{BOLD, Canvas, Colour, PLAIN, SMALL};
use super::plot::{INK, Pen};
use super::{Picture, place};

/// A figure of small charts.
pub(crate) struct Chart {
    /// What it shows.
    pub(crate) title: String,
    /// Colours and what they stand for.
    pub(crate) legend: Vec<(String, Colour)>,
    /// Charts beside each other.
    pub(crate) columns: usize,
    /// From left to right, then down.
    pub(crate) panels: Vec<Panel>,
    /// The values' scale, common to all.
    pub(crate) y: Log,
    /// How to read it; what else must be known.
    pub(crate) notes: Vec<String>,
}

/// One chart.
pub(crate) struct Panel {
    pub(crate) title: String,
    pub(crate) x: Axis,
    pub(crate) dots: Vec<Dot>,
    /// Texts in the strip of infinity: place on the axis, px to the right of it, text, colour.
    pub(crate) strip: Vec<(f64, f64, String, Colour)>,
    /// A remark in that strip, in a colour.
    pub(crate) remark: Option<(String, Colour)>,
}

/// A horizontal axis.
pub(crate) enum Axis {
    /// Named places 0, 1, 2 and so on; a name may have two lines.
    Names(Vec<String>),
    /// Numbers.
    Log(Log),
}

/// A logarithmic scale, with room for zero at its low end and for infinity at its high end.
#[derive(Clone)]
pub(crate) struct Log {
    pub(crate) label: String,
    pub(crate) range: (f64, f64),
    /// Name of zero, if it may occur.
    pub(crate) zero: Option<&'static str>,
    /// Name of infinity, if it may occur.
    pub(crate) never: Option<&'static str>,
}

/// A dot.
pub(crate) struct Dot {
    pub(crate) colour: Colour,
    /// Moves it to the right, px.
    pub(crate) aside: f64,
    pub(crate) x: f64,
    /// Without it only the bars are drawn.
    pub(crate) y: Option<f64>,
    /// From where to where it may lie.
    pub(crate) x_bar: Option<(f64, f64)>,
    pub(crate) y_bar: Option<(f64, f64)>,
    /// Text beside it.
    pub(crate) label: String,
}

const WIDTH: f64 = 1200.0;
/// Height of a chart among several rows of them, and of one in a single row.
const PANEL_HEIGHT: f64 = 300.0;
const LONE_HEIGHT: f64 = 480.0;
const HEAD: f64 = 64.0;
const LEFT: f64 = 80.0;
const GAP: f64 = 78.0;
const TOP: f64 = 36.0;
const BOTTOM: f64 = 62.0;
const NOTE: f64 = 21.0;
/// Room for zero or infinity beyond an axis.
const STRIP: f64 = 46.0;
const RADIUS: f64 = 4.5;

const GRID: Pen = Pen::new(Colour(0xE1, 0xE5, 0xEA), 1.0);
const FRAME: Pen = Pen::new(Colour(0x9A, 0xA3, 0xAD), 1.0);
const STRIP_COLOUR: Colour = Colour(0xF4, 0xF5, 0xF7);

impl Log {
    /// A scale that holds all positive finite values.
    pub(crate) fn over(label: impl Into<String>, values: impl Iterator<Item = f64>) -> Self {
        let positive: Vec<f64> = values.filter(|x| *x > 0.0 && x.is_finite()).collect();
        let low = positive.iter().copied().reduce(f64::min).unwrap_or(1.0);
        let high = positive.iter().copied().fold(1.1 * low, f64::max);
        let range = (round(low, false), round(high, true));
        Self { label: label.into(), range, zero: None, never: None }
    }

    /// Where the numbers lie between two ends.
    fn inner(&self, (from, to): (f64, f64)) -> (f64, f64) {
        let way = (to - from).signum();
        let strip = |name: Option<_>| if name.is_some() { way * STRIP } else { 0.0 };
        (from + strip(self.zero), to - strip(self.never))
    }

    fn at(&self, x: f64, ends: (f64, f64)) -> f64 {
        let inner = self.inner(ends);
        if x == f64::INFINITY {
            return 0.5 * (inner.1 + ends.1);
        }
        if x <= 0.0 {
            return 0.5 * (ends.0 + inner.0);
        }
        let x = x.clamp(self.range.0, self.range.1);
        place(x.log10(), (self.range.0.log10(), self.range.1.log10()), inner)
    }

    /// 1, 2, 5 times powers of ten, with labels; only the powers themselves are labelled on a long scale.
    fn ticks(&self) -> Vec<(f64, String)> {
        let (low, high) = (self.range.0.log10(), self.range.1.log10());
        let long = high - low > 3.1;
        let powers = (low.floor() as i32)..=(high.ceil() as i32);
        let steps = powers.flat_map(|power| [1.0, 2.0, 5.0].map(|f| (f, f * 10f64.powi(power))));
        let inside = steps.filter(|(_, x)| (self.range.0 * 0.999..=self.range.1 * 1.001).contains(x));
        inside
            .map(|(f, x)| {
                (x, if long && f > 1.0 { String::new() } else { format!("{}", (x * 1e9).round() / 1e9) })
            })
            .collect()
    }
}

/// The nearest of 1, 2, 5 times a power of ten below or above.
fn round(x: f64, up: bool) -> f64 {
    let power = 10f64.powf(x.log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0].map(|f| f * power);
    let found = if up {
        steps.into_iter().find(|s| *s >= x * 0.999)
    } else {
        steps.into_iter().rev().find(|s| *s <= x * 1.001)
    };
    found.unwrap_or(x)
}

impl Chart {
    fn rows(&self) -> usize {
        self.panels.len().div_ceil(self.columns)
    }

    fn panel_height(&self) -> f64 {
        if self.rows() > 1 { PANEL_HEIGHT } else { LONE_HEIGHT }
    }

    fn legend(&self, canvas: &mut Canvas) {
        let mut x = WIDTH - 20.0;
        for (name, colour) in self.legend.iter().rev() {
            canvas.text(name, (x, 22.0), PLAIN.right());
            x -= PLAIN.width(name) + 14.0;
            canvas.dot((x, 23.0), RADIUS, *colour);
            x -= 24.0;
        }
    }

    fn paint_panel(&self, canvas: &mut Canvas, i: usize) {
        let panel = &self.panels[i];
        let width = (WIDTH - LEFT - 20.0 + GAP) / self.columns as f64;
        let left = LEFT + width * (i % self.columns) as f64;
        let top = HEAD + self.panel_height() * (i / self.columns) as f64 + TOP;
        let frame =
            Frame { x: (left, left + width - GAP), y: (top + self.panel_height() - TOP - BOTTOM, top) };
        canvas.text(&panel.title, (left, top - 15.0), BOLD);
        frame.y_axis(canvas, &self.y);
        match &panel.x {
            Axis::Names(names) => frame.names(canvas, names),
            Axis::Log(log) => frame.x_axis(canvas, log),
        }
        if let Some((remark, colour)) = &panel.remark {
            let y = self.y.at(f64::INFINITY, frame.y);
            canvas.text(remark, (frame.x.0 + 8.0, y), SMALL.coloured(*colour));
        }
        for dot in &panel.dots {
            frame.dot(canvas, &panel.x, &self.y, dot);
        }
        for (x, aside, text, colour) in &panel.strip {
            let at = (frame.x_of(&panel.x, *x) + aside, self.y.at(f64::INFINITY, frame.y));
            canvas.text(text, at, SMALL.centred().coloured(*colour));
        }
        let ((l, r), (b, t)) = (frame.x, frame.y);
        canvas.line(&[(l, t), (r, t), (r, b), (l, b), (l, t)], FRAME)
    }
}

impl Picture for Chart {
    fn size(&self) -> (u32, u32) {
        let notes = NOTE * self.notes.len() as f64;
        (WIDTH as u32, (HEAD + self.panel_height() * self.rows() as f64 + notes + 8.0) as u32)
    }

    fn paint(&self, canvas: &mut Canvas) {
        canvas.text(&self.title, (20.0, 22.0), BOLD.sized(14.5));
        canvas.text(&format!("Vertical: {}", self.y.label), (20.0, 48.0), PLAIN);
        self.legend(canvas);
        for i in 0..self.panels.len() {
            self.paint_panel(canvas, i);
        }
        for (i, note) in self.notes.iter().enumerate() {
            let y = HEAD + self.panel_height() * self.rows() as f64 + NOTE * (i as f64 + 0.3);
            canvas.text(note, (20.0, y), SMALL);
        }
    }
}

/// A chart's frame: left and right end, lower and upper end, px.
struct Frame {
    x: (f64, f64),
    y: (f64, f64),
}

impl Frame {
    fn y_axis(&self, canvas: &mut Canvas, log: &Log) {
        let inner = log.inner(self.y);
        if let Some(name) = log.never {
            canvas.fill((self.x.0, self.y.1), (self.x.1, inner.1), STRIP_COLOUR, 1.0);
            canvas.text(name, (self.x.0 - 6.0, log.at(f64::INFINITY, self.y)), SMALL.right());
        }
        for (value, label) in log.ticks() {
            let y = log.at(value, self.y);
            canvas.line(&[(self.x.0, y), (self.x.1, y)], GRID);
            canvas.text(&label, (self.x.0 - 6.0, y), SMALL.right());
        }
    }

    fn x_axis(&self, canvas: &mut Canvas, log: &Log) {
        let inner = log.inner(self.x);
        let y = self.y.0 + 13.0;
        if let Some(name) = log.zero {
            canvas.fill((self.x.0, self.y.1), (inner.0, self.y.0), STRIP_COLOUR, 1.0);
            canvas.text(name, (log.at(0.0, self.x), y), SMALL.centred());
        }
        for (value, label) in log.ticks() {
            let x = log.at(value, self.x);
            canvas.line(&[(x, self.y.0), (x, self.y.1)], GRID);
            // The name of zero stands right beside the lowest number.
            if log.zero.is_none() || x > inner.0 + STRIP {
                canvas.text(&label, (x, y), SMALL.centred());
            }
        }
        canvas.text(&log.label, (0.5 * (self.x.0 + self.x.1), y + 18.0), SMALL.centred())
    }

    fn names(&self, canvas: &mut Canvas, names: &[String]) {
        for (i, name) in names.iter().enumerate() {
            let x = self.name_at(i as f64, names.len());
            canvas.line(&[(x, self.y.0), (x, self.y.1)], GRID);
            for (line, text) in name.lines().enumerate() {
                canvas.text(text, (x, self.y.0 + 13.0 + 16.0 * line as f64), SMALL.centred());
            }
        }
    }

    fn name_at(&self, i: f64, count: usize) -> f64 {
        place(i, (-0.5, count as f64 - 0.5), self.x)
    }

    fn x_of(&self, axis: &Axis, x: f64) -> f64 {
        match axis {
            Axis::Names(names) => self.name_at(x, names.len()),
            Axis::Log(log) => log.at(x, self.x),
        }
    }

    fn dot(&self, canvas: &mut Canvas, x: &Axis, y: &Log, dot: &Dot) {
        let x_of = |value| self.x_of(x, value) + dot.aside;
        let pen = Pen::new(dot.colour, 1.5);
        let at_x = x_of(dot.x);
        if let Some((low, high)) = dot.y_bar {
            let ends = [low, high].map(|end| y.at(end, self.y));
            canvas.line(&ends.map(|end| (at_x, end)), pen);
            for end in ends {
                canvas.line(&[(at_x - 4.0, end), (at_x + 4.0, end)], pen);
            }
        }
        let Some(value) = dot.y else { return };
        let at = (at_x, y.at(value, self.y));
        if let Some((low, high)) = dot.x_bar {
            let ends = [low, high].map(x_of);
            canvas.line(&ends.map(|end| (end, at.1)), pen);
            for end in ends {
                canvas.line(&[(end, at.1 - 4.0), (end, at.1 + 4.0)], pen);
            }
        }
        canvas.dot(at, RADIUS, dot.colour);
        let in_strip = matches!(x, Axis::Log(_)) && dot.x <= 0.0;
        let ambient = self.x.1 - at.0 - 9.0 > SMALL.width(&dot.label);
        let (place, look) = match (in_strip, ambient) {
            (true, _) => ((at.0 - 8.0, at.1), SMALL.right()),
            (false, true) => ((at.0 + 7.0, at.1 - 9.0), SMALL),
            (false, false) => ((at.0 - 7.0, at.1 - 9.0), SMALL.right()),
        };
        canvas.text(&dot.label, place, look.coloured(INK))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scale_ends_on_round_numbers_and_has_ambient_for_what_is_none() {
        let values = [0.17, 3.1, 0.0, f64::INFINITY].into_iter();
        let log = Log { zero: Some("0"), never: Some("never"), ..Log::over("s", values) };
        assert_eq!(log.range, (0.1, 5.0));
        let ends = (0.0, 460.0);
        let places = [0.0, 0.1, 5.0, f64::INFINITY].map(|x| log.at(x, ends));
        assert_eq!(places, [0.5 * STRIP, STRIP, 460.0 - STRIP, 460.0 - 0.5 * STRIP]);
        let labels: Vec<String> = log.ticks().into_iter().map(|t| t.1).collect();
        assert_eq!(labels, ["0.1", "0.2", "0.5", "1", "2", "5"]);
    }

    #[test]
    fn a_scale_of_nothing_is_still_one() {
        let log = Log::over("", std::iter::empty());
        assert!(log.range.0 < log.range.1 && log.at(1.0, (0.0, 1.0)).is_finite());
    }
}
