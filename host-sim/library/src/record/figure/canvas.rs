//! Lines, rectangles and texts in pixels, on any backend of plotters.

use plotters::backend::{BitMapBackend, DrawingBackend, SVGBackend};
use plotters::style::{Color, RGBColor, ShapeStyle};

use super::plot::Pen;
use super::polyline::Point;
use super::text::{Look, Type};

/// Backends work on whole units; a pixel is so many of them, which makes lines smooth.
pub(super) const UNITS: u32 = 2;
/// Length of a dash and of the gap after it, px.
const DASH: (f64, f64) = (9.0, 6.0);

/// What the backends do differently.
pub(crate) trait Medium: DrawingBackend<ErrorType: 'static> {
    /// Whether a wide line is drawn well as one path. The bitmap fills it as a polygon, which breaks where the path
    /// comes near itself.
    const WHOLE_PATHS: bool;
}

impl Medium for SVGBackend<'_> {
    const WHOLE_PATHS: bool = true;
}

impl Medium for BitMapBackend<'_> {
    const WHOLE_PATHS: bool = false;
}

/// A backend that is drawn on in pixels.
pub(super) struct Canvas<'a, M>(pub(super) &'a mut M);

impl<M: Medium> Canvas<'_, M> {
    /// A filled rectangle between two corners, the upper left one first.
    pub(super) fn fill(&mut self, from: Point, to: Point, colour: impl Color) -> anyhow::Result<()> {
        Ok(self.0.draw_rect(units(from), units(to), &colour.filled(), true)?)
    }

    /// A text about the height of its place.
    pub(super) fn text(&mut self, text: &str, at: Point, look: Type) -> anyhow::Result<()> {
        Ok(self.0.draw_text(text, &Look { of: look, is_upright: false }, units(at))?)
    }

    /// A text that runs upwards from its place, about the vertical through it.
    pub(super) fn upright(&mut self, text: &str, at: Point, look: Type) -> anyhow::Result<()> {
        Ok(self.0.draw_text(text, &Look { of: look.left(), is_upright: true }, units(at))?)
    }

    /// A dot.
    pub(super) fn dot(&mut self, at: Point, radius: f64, colour: RGBColor) -> anyhow::Result<()> {
        let radius = (radius * f64::from(UNITS)) as u32;
        Ok(self.0.draw_circle(units(at), radius, &colour.filled(), true)?)
    }

    /// A line through points.
    pub(super) fn line(&mut self, points: &[Point], pen: Pen) -> anyhow::Result<()> {
        let width = (pen.width * f64::from(UNITS)).round().max(1.0) as u32;
        let path = without_midpoints(points.iter().copied().map(units));
        if M::WHOLE_PATHS {
            return Ok(self.0.draw_path(path, &stroke(pen.colour, width))?);
        }
        for pair in path.windows(2) {
            self.thick_segment(pair[0], pair[1], width as i32, pen.colour)?;
        }
        Ok(())
    }

    /// Thin lines side by side.
    fn thick_segment(
        &mut self,
        from: (i32, i32),
        to: (i32, i32),
        width: i32,
        colour: RGBColor,
    ) -> anyhow::Result<()> {
        let steep = (to.1 - from.1).abs() > (to.0 - from.0).abs();
        for side in (0..width).map(|i| i - width / 2) {
            let aside = |(x, y)| if steep { (x + side, y) } else { (x, y + side) };
            self.0.draw_line(aside(from), aside(to), &stroke(colour, 1))?;
        }
        Ok(())
    }

    /// A horizontal line, dashed if the pen is.
    pub(super) fn horizontal(&mut self, (from, to): (f64, f64), y: f64, pen: Pen) -> anyhow::Result<()> {
        if !pen.dashed {
            return self.line(&[(from, y), (to, y)], pen);
        }
        let dashes = ((to - from) / (DASH.0 + DASH.1)).ceil() as u32;
        for x in (0..dashes).map(|i| from + f64::from(i) * (DASH.0 + DASH.1)) {
            self.line(&[(x, y), ((x + DASH.0).min(to), y)], pen)?;
        }
        Ok(())
    }
}

fn units(p: Point) -> (i32, i32) {
    let unit = |x: f64| (x * f64::from(UNITS)).round() as i32;
    (unit(p.0), unit(p.1))
}

fn stroke(colour: RGBColor, width: u32) -> ShapeStyle {
    colour.stroke_width(width)
}

/// Drops the points within a horizontal stretch: they draw nothing.
fn without_midpoints(path: impl Iterator<Item = (i32, i32)>) -> Vec<(i32, i32)> {
    let mut kept: Vec<(i32, i32)> = Vec::new();
    for point in path {
        if let [.., a, b] = kept.as_slice()
            && a.1 == b.1
            && b.1 == point.1
        {
            kept.pop();
        }
        kept.push(point);
    }
    kept
}
