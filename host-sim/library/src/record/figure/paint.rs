//! Where everything goes in a figure, and the drawing of it.

use super::axis;
use super::canvas::{BOLD, Canvas, Colour, PLAIN};
use super::plot::{Band, Figure, Panel, Pen, Scale, THRESHOLD, THRESHOLD_LABEL};
use super::polyline::{Point, polylines};
use super::{Picture, place};

/// Width of a figure, px.
pub(super) const WIDTH: u32 = 1200;

// Sizes and places, px.
const PANEL: f64 = 190.0;
const TITLE: f64 = 34.0;
const HEADER_ROW: f64 = 20.0;
const FOOTER: f64 = 52.0;
const LEFT: f64 = 64.0;
const RIGHT: f64 = WIDTH as f64 - 20.0;
const SWATCH: f64 = 22.0;

const GRID: Pen = Pen::new(Colour(0xE1, 0xE5, 0xEA), 1.0);
const FRAME: Pen = Pen::new(Colour(0x9A, 0xA3, 0xAD), 1.0);
const MUTED: Colour = Colour(0x6B, 0x74, 0x7E);
const BAND_OPACITY: f64 = 0.17;

const TIME_TICKS: u32 = 10;
const VALUE_TICKS: u32 = 6;

/// Rows that the names of bands may take; a name that finds no room in them is left out.
const HEADER_ROWS: usize = 3;

/// A figure whose parts have found their places.
pub(super) struct Layout<'a> {
    figure: &'a Figure,
    names: Vec<Name<'a>>,
}

/// The name of a band: its centre in px, and its row, counted from the lowest.
struct Name<'a> {
    band: &'a Band,
    centre: f64,
    row: usize,
}

impl<'a> Layout<'a> {
    /// Finds the places.
    pub(super) fn new(figure: &'a Figure) -> Self {
        Self { figure, names: place_names(figure) }
    }

    /// Height of the names above the first panel, px.
    fn header(&self) -> f64 {
        let rows = self.names.iter().map(|name| name.row + 1).max().unwrap_or(0);
        HEADER_ROW * rows as f64
    }

    /// Names of the bands, above the first frame.
    fn paint_names(&self, canvas: &mut Canvas, frame_top: f64) {
        for name in &self.names {
            let y = frame_top - HEADER_ROW * (name.row as f64 + 0.5) - 1.0;
            let look = PLAIN.centred().coloured(darker(name.band.colour));
            canvas.text(&name.band.label, (name.centre, y), look);
        }
    }

    /// Labels of the time axis, below the last frame.
    fn paint_time(&self, canvas: &mut Canvas, frame_bottom: f64) {
        for (t, label) in axis::ticks(self.figure.span, TIME_TICKS) {
            let x = place(t, self.figure.span, (LEFT, RIGHT));
            canvas.text(&label, (x, frame_bottom + 13.0), PLAIN.centred());
        }
        canvas.text("time (s)", (0.5 * (LEFT + RIGHT), frame_bottom + 33.0), PLAIN.centred())
    }
}

impl Picture for Layout<'_> {
    fn size(&self) -> (u32, u32) {
        (WIDTH, (self.header() + PANEL * self.figure.panels.len() as f64 + FOOTER) as u32)
    }

    fn paint(&self, canvas: &mut Canvas) {
        let mut top = TITLE;
        for (i, panel) in self.figure.panels.iter().enumerate() {
            let title = top - 0.5 * TITLE + 2.0;
            paint_title(canvas, panel, title);
            if i == 0 {
                top += self.header();
                self.paint_names(canvas, top);
            }
            let bottom = top + PANEL - TITLE;
            Frame::new(self.figure, panel, (top, bottom)).paint(canvas, panel);
            top = bottom + TITLE;
        }
        self.paint_time(canvas, top - TITLE);
    }
}

/// Puts each name above its band, in the lowest row where it touches no other.
fn place_names(figure: &Figure) -> Vec<Name<'_>> {
    const GAP: f64 = 12.0;
    let mut row_ends = [LEFT - GAP; HEADER_ROWS];
    let mut bands: Vec<&Band> = figure.bands.iter().collect();
    bands.sort_by(|a, b| a.middle().total_cmp(&b.middle()));
    let mut names = Vec::new();
    for band in bands {
        let half = 0.5 * PLAIN.width(&band.label);
        if 2.0 * half > RIGHT - LEFT {
            continue;
        }
        let centre = place(band.middle(), figure.span, (LEFT, RIGHT)).clamp(LEFT + half, RIGHT - half);
        if let Some(row) = row_ends.iter().position(|end| end + GAP <= centre - half) {
            row_ends[row] = centre + half;
            names.push(Name { band, centre, row });
        }
    }
    names
}

/// The title at the left, and at the right the legend where there is something to tell apart.
fn paint_title(canvas: &mut Canvas, panel: &Panel, y: f64) {
    canvas.text(&panel.title, (LEFT, y), BOLD);
    let thresholds = (!panel.thresholds.is_empty()).then_some((THRESHOLD_LABEL, THRESHOLD));
    let keys: Vec<_> = panel.traces.iter().map(|t| (t.label, t.pen)).chain(thresholds).collect();
    if keys.len() < 2 {
        return;
    }
    let mut x = RIGHT;
    for (label, pen) in keys.into_iter().rev() {
        canvas.text(label, (x, y), PLAIN.right());
        x -= PLAIN.width(label) + 7.0;
        let pen = Pen { width: pen.width.max(2.0), ..pen };
        canvas.line(&[(x - SWATCH, y + 1.0), (x, y + 1.0)], pen);
        x -= SWATCH + 18.0;
    }
}

/// The frame of one panel: ranges, and where they lie in px.
struct Frame<'a> {
    figure: &'a Figure,
    y: (f64, f64),
    range: (f64, f64),
    ticks: Vec<(f64, String)>,
}

impl<'a> Frame<'a> {
    fn new(figure: &'a Figure, panel: &Panel, y: (f64, f64)) -> Self {
        let values = figure.settled_values(panel);
        let (range, count) = match panel.scale {
            Scale::AtLeast(span) => (axis::range(values, &panel.thresholds, span), VALUE_TICKS),
            Scale::Levels(top) => {
                let top = values.into_iter().fold(top, f64::max);
                ((-0.12 * top, 1.12 * top), (1.24 * top).ceil().min(6.0) as u32)
            }
        };
        let levels = (0..panel.names.len()).map(|level| (level as f64, String::new()));
        let ticks = if panel.names.is_empty() { axis::ticks(range, count) } else { levels.collect() };
        Self { figure, y, range, ticks }
    }

    fn x_of(&self, t: f64) -> f64 {
        place(t, self.figure.span, (LEFT, RIGHT))
    }

    fn y_of(&self, value: f64) -> f64 {
        place(value, self.range, (self.y.1, self.y.0))
    }

    fn paint(&self, canvas: &mut Canvas, panel: &Panel) {
        let (top, bottom) = self.y;
        for band in &self.figure.bands {
            let (from, until) = (self.x_of(band.span.0), self.x_of(band.span.1));
            canvas.fill((from, top), (until.max(from + 1.0), bottom), band.colour, BAND_OPACITY);
        }
        self.paint_grid(canvas, panel);
        self.paint_traces(canvas, panel);
        for &threshold in panel.thresholds.iter().filter(|x| x.is_finite()) {
            let y = self.y_of(threshold);
            canvas.line(&[(LEFT, y), (RIGHT, y)], THRESHOLD);
        }
        let corners = [(LEFT, top), (RIGHT, top), (RIGHT, bottom), (LEFT, bottom), (LEFT, top)];
        canvas.line(&corners, FRAME)
    }

    fn paint_grid(&self, canvas: &mut Canvas, panel: &Panel) {
        for (t, _) in axis::ticks(self.figure.span, TIME_TICKS) {
            canvas.line(&[(self.x_of(t), self.y.0), (self.x_of(t), self.y.1)], GRID);
        }
        for (value, label) in &self.ticks {
            let y = self.y_of(*value);
            canvas.line(&[(LEFT, y), (RIGHT, y)], GRID);
            canvas.text(label, (LEFT - 8.0, y), PLAIN.right());
        }
        self.paint_names(canvas, panel)
    }

    /// Names of levels stand in the frame, over their lines: they are too long for the margin, and before monitoring
    /// begins there is room.
    fn paint_names(&self, canvas: &mut Canvas, panel: &Panel) {
        for (level, name) in panel.names.iter().enumerate() {
            let y = self.y_of(level as f64);
            canvas.text(name, (LEFT + 8.0, y - 8.0), PLAIN.coloured(MUTED));
        }
    }

    fn paint_traces(&self, canvas: &mut Canvas, panel: &Panel) {
        let mut drawn = false;
        for trace in &panel.traces {
            let points: Vec<Point> = self
                .figure
                .times
                .iter()
                .zip(&trace.values)
                .map(|(&t, &v)| (self.x_of(t), self.y_of(v)))
                .collect();
            for line in polylines(&points, trace.pen.stepped, self.y) {
                canvas.line(&line, trace.pen);
                drawn = true;
            }
        }
        if drawn {
            return;
        }
        let middle = (0.5 * (LEFT + RIGHT), 0.5 * (self.y.0 + self.y.1));
        canvas.text("not defined in this run", middle, PLAIN.centred().coloured(MUTED))
    }
}

/// A tint's colour as text: dark enough to be read on white.
fn darker(Colour(r, g, b): Colour) -> Colour {
    let half = |x: u8| (f64::from(x) * 0.65) as u8;
    Colour(half(r), half(g), half(b))
}
