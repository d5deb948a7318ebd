//! Charts of a recording as SVG: what was measured over what was expected, with times that are shaded.

use std::fmt::Write as _;

use crate::record::figure::axis;
use crate::record::figure::polyline::polylines;
use crate::record::report::escape;

const WIDTH: f64 = 1080.0;
const LEFT: f64 = 58.0;
const RIGHT: f64 = WIDTH - 12.0;
const TOP: f64 = 8.0;
const FOOT: f64 = 24.0;

/// A chart over time.
pub(super) struct Chart<'a> {
    /// What it shows, for those who can't see it.
    pub(super) label: &'a str,
    /// First and last time, s.
    pub(super) span: (f64, f64),
    /// Height of the frame, px.
    pub(super) height: f64,
    /// The time of each value, s.
    pub(super) times: &'a [f64],
    /// Between these, a band.
    pub(super) band: Option<[Vec<f64>; 2]>,
    /// Drawn in this order.
    pub(super) lines: Vec<Line>,
    /// Times that are shaded.
    pub(super) spans: Vec<Span>,
    /// The range is so wide at least.
    pub(super) least: f64,
}

/// A signal.
pub(super) struct Line {
    /// Its class in the style sheet.
    pub(super) class: &'static str,
    /// One value a time; what is not known is no number.
    pub(super) values: Vec<f64>,
    /// It holds each value until the next.
    pub(super) is_stepped: bool,
}

/// A time that is shaded.
#[derive(Clone)]
pub(super) struct Span {
    /// Its class in the style sheet.
    pub(super) class: &'static str,
    /// From and to, s.
    pub(super) span: (f64, f64),
    /// What is said there.
    pub(super) title: String,
    /// What stands at its head.
    pub(super) mark: String,
}

impl Chart<'_> {
    pub(super) fn svg(&self) -> String {
        let shown = |t: &f64| (self.span.0..=self.span.1).contains(t);
        let place: Vec<usize> = (0..self.times.len()).filter(|k| shown(&self.times[*k])).collect();
        let values = self.lines.iter().flat_map(|line| place.iter().map(|k| line.values[*k]));
        let bounds = self.band.iter().flatten().flat_map(|edge| place.iter().map(|k| edge[*k]));
        let range = axis::range(values.chain(bounds).collect(), &[], self.least);
        let (bottom, height) = (TOP + self.height, TOP + self.height + FOOT);
        let x = |t: f64| LEFT + (t - self.span.0) / (self.span.1 - self.span.0) * (RIGHT - LEFT);
        let y = |v: f64| bottom - (v - range.0) / (range.1 - range.0) * self.height;
        let mut svg =
            format!("<svg role='img' aria-label='{}' viewBox='0 0 {WIDTH} {height}'>\n", escape(self.label));
        for (t, label) in axis::ticks(self.span, 10) {
            let _ = writeln!(
                svg,
                "<path class='grid' d='M{0:.1} {TOP}V{bottom}'/><text class='x' x='{0:.1}' y='{1}'>{label}</text>",
                x(t),
                bottom + 16.0
            );
        }
        for (v, label) in axis::ticks(range, 5) {
            let _ = writeln!(
                svg,
                "<path class='grid' d='M{LEFT} {0:.1}H{RIGHT}'/><text class='y' x='{1}' y='{2:.1}'>{label}</text>",
                y(v),
                LEFT - 7.0,
                y(v) + 4.0
            );
        }
        for span in self.spans.iter().filter(|span| span.span.1 > self.span.0 && span.span.0 < self.span.1) {
            let (from, to) = (x(span.span.0).max(LEFT), x(span.span.1).min(RIGHT));
            let _ = writeln!(
                svg,
                "<rect class='{}' x='{from:.1}' y='{TOP}' width='{:.1}' height='{}'><title>{}</title></rect>",
                span.class,
                (to - from).max(1.5),
                self.height,
                escape(&span.title)
            );
            if !span.mark.is_empty() {
                let middle = (0.5 * (from + to)).clamp(LEFT + 6.0, RIGHT - 6.0);
                let _ = writeln!(
                    svg,
                    "<text class='mark' x='{middle:.1}' y='{}'>{}</text>",
                    TOP + 13.0,
                    escape(&span.mark)
                );
            }
        }
        if let Some([low, high]) = &self.band {
            self.area(
                &mut svg,
                [low, high].map(|edge| place.iter().map(|k| (x(self.times[*k]), y(edge[*k]))).collect()),
            );
        }
        for line in &self.lines {
            let points: Vec<(f64, f64)> =
                place.iter().map(|k| (x(self.times[*k]), y(line.values[*k]))).collect();
            let mut path = String::new();
            for piece in polylines(&points, line.is_stepped, (TOP, bottom)) {
                for (i, (x, y)) in piece.iter().enumerate() {
                    let _ = write!(path, "{}{x:.1} {y:.1}", if i == 0 { 'M' } else { 'L' });
                }
            }
            let _ = writeln!(svg, "<path class='{}' d='{path}'/>", line.class);
        }
        svg + "</svg>\n"
    }

    /// The band, a column of a pixel each: the widest of what lies within.
    fn area(&self, svg: &mut String, [low, high]: [Vec<(f64, f64)>; 2]) {
        let columns = low.chunk_by(|a, b| a.0.floor() == b.0.floor());
        let (mut there, mut back, mut first) = (String::new(), Vec::new(), 0);
        let mut close = |there: &mut String, back: &mut Vec<(f64, f64)>| {
            for (x, y) in back.drain(..).rev() {
                let _ = write!(there, "L{x:.1} {y:.1}");
            }
            if !there.is_empty() {
                let _ = writeln!(svg, "<path class='band' d='{there}Z'/>");
            }
            there.clear();
        };
        let bottom = TOP + self.height;
        for column in columns {
            let upper = &high[first..first + column.len()];
            first += column.len();
            let most = |points: &[(f64, f64)], of: fn(f64, f64) -> f64| {
                points.iter().map(|(_, y)| y.clamp(TOP, bottom)).reduce(of).unwrap_or(f64::NAN)
            };
            let (below, above) = (most(column, f64::max), most(upper, f64::min));
            if !(below.is_finite() && above.is_finite()) {
                close(&mut there, &mut back);
                continue;
            }
            let x = column[0].0;
            let _ = write!(there, "{}{x:.1} {above:.1}", if there.is_empty() { 'M' } else { 'L' });
            back.push((x, below));
        }
        close(&mut there, &mut back);
    }
}
