//! Lines, rectangles and texts in pixels, as SVG.

use std::fmt::{Display, Write as _};

use super::plot::{INK, Pen};
use super::polyline::Point;

/// Length of a dash and of the gap after it, px.
const DASH: &str = "9 6";
/// Width of a letter, in sizes: the mean of DejaVu Sans, the widest of the usual fonts. Each viewer takes a font of its own.
const LETTER: f64 = 0.6;

/// Red, green and blue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Colour(pub(crate) u8, pub(crate) u8, pub(crate) u8);

pub(super) const WHITE: Colour = Colour(0xFF, 0xFF, 0xFF);

impl Display for Colour {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self(red, green, blue) = self;
        write!(f, "#{red:02x}{green:02x}{blue:02x}")
    }
}

/// How a text is set.
#[derive(Clone, Copy)]
pub(super) struct Type {
    size: f64,
    is_bold: bool,
    colour: Colour,
    anchor: &'static str,
}

/// Text of labels.
pub(super) const PLAIN: Type = Type { size: 12.0, is_bold: false, colour: INK, anchor: "start" };
/// Text of titles.
pub(super) const BOLD: Type = Type { is_bold: true, ..PLAIN };
/// Text of notes and of values in a chart.
pub(super) const SMALL: Type = PLAIN.sized(10.5);

impl Type {
    /// The same, centred about its place.
    pub(super) const fn centred(self) -> Self {
        Self { anchor: "middle", ..self }
    }

    /// The same, ending at its place.
    pub(super) const fn right(self) -> Self {
        Self { anchor: "end", ..self }
    }

    /// The same in another size, px.
    pub(super) const fn sized(self, size: f64) -> Self {
        Self { size, ..self }
    }

    /// The same in another colour.
    pub(super) const fn coloured(self, colour: Colour) -> Self {
        Self { colour, ..self }
    }

    /// About the width of a text, px.
    pub(super) fn width(self, text: &str) -> f64 {
        LETTER * self.size * text.chars().count() as f64
    }
}

/// What was drawn so far.
pub(crate) struct Canvas(String);

impl Canvas {
    /// A white picture of this width and height, px; `label` says to a screen reader what it shows.
    pub(super) fn new(size: (u32, u32), label: &str) -> Self {
        let (width, height) = size;
        let head = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" aria-label=\"{}\" width=\"{width}\" \
             height=\"{height}\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" \
             fill=\"none\" stroke-linejoin=\"round\">\n",
            Escaped(label)
        );
        let mut canvas = Self(head);
        canvas.fill((0.0, 0.0), (f64::from(width), f64::from(height)), WHITE, 1.0);
        canvas
    }

    /// The picture.
    pub(super) fn finish(self) -> String {
        self.0 + "</svg>\n"
    }

    fn element(&mut self, element: std::fmt::Arguments) {
        let _ = writeln!(self.0, "{element}"); // a string takes everything
    }

    /// A filled rectangle between two corners, the upper left one first.
    pub(super) fn fill(&mut self, from: Point, to: Point, colour: Colour, opacity: f64) {
        let ((x, y), (width, height)) = (from, (to.0 - from.0, to.1 - from.1));
        self.element(format_args!(
            "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" fill=\"{colour}\" fill-opacity=\"{opacity:.2}\"/>"
        ));
    }

    /// A text about the height of its place.
    pub(super) fn text(&mut self, text: &str, at: Point, look: Type) {
        self.set(text, at, look, "");
    }

    /// A text that runs upwards from its place, about the vertical through it.
    pub(super) fn upright(&mut self, text: &str, at: Point, look: Type) {
        let (x, y) = at;
        self.set(text, at, look, &format!(" transform=\"rotate(-90 {x:.1} {y:.1})\""));
    }

    fn set(&mut self, text: &str, (x, y): Point, look: Type, turned: &str) {
        let Type { size, is_bold, colour, anchor } = look;
        let weight = if is_bold { " font-weight=\"bold\"" } else { "" };
        self.element(format_args!(
            "<text x=\"{x:.1}\" y=\"{y:.1}\" dy=\"0.36em\" font-size=\"{size}\"{weight} fill=\"{colour}\" text-anchor=\"{anchor}\"{turned}>{}</text>",
            Escaped(text)
        ));
    }

    /// A dot.
    pub(super) fn dot(&mut self, (x, y): Point, radius: f64, colour: Colour) {
        self.element(format_args!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\" fill=\"{colour}\"/>"));
    }

    /// A line through points.
    pub(super) fn line(&mut self, points: &[Point], pen: Pen) {
        self.0 += "<polyline points=\"";
        for (number, (x, y)) in without_midpoints(points).into_iter().enumerate() {
            let _ = write!(self.0, "{}{x:.1},{y:.1}", if number > 0 { " " } else { "" });
        }
        let Pen { colour, width, is_dashed, .. } = pen;
        let dashes = if is_dashed { format!(" stroke-dasharray=\"{DASH}\"") } else { String::new() };
        self.element(format_args!("\" stroke=\"{colour}\" stroke-width=\"{width}\"{dashes}/>"));
    }
}

/// Text as it stands within an element or an attribute.
struct Escaped<'a>(&'a str);

impl Display for Escaped<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.chars().try_for_each(|letter| match letter {
            '&' => f.write_str("&amp;"),
            '<' => f.write_str("&lt;"),
            '>' => f.write_str("&gt;"),
            '"' => f.write_str("&quot;"),
            other => f.write_char(other),
        })
    }
}

/// Drops the points within a horizontal stretch: they draw nothing.
fn without_midpoints(path: &[Point]) -> Vec<Point> {
    let mut kept: Vec<Point> = Vec::new();
    for &point in path {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_drawn_is_an_element_with_its_text_escaped() {
        let mut canvas = Canvas::new((40, 30), "a \"b\"");
        canvas.text("<T1 & T2>", (1.0, 2.04), BOLD.right());
        canvas.upright("up", (3.0, 4.0), PLAIN);
        canvas.line(&[(0.0, 1.0), (1.0, 1.0), (2.0, 1.0), (3.0, 5.0)], Pen::new(INK, 1.5).dashed());
        let svg = canvas.finish();
        for part in [
            "aria-label=\"a &quot;b&quot;\" width=\"40\" height=\"30\" viewBox=\"0 0 40 30\"",
            "y=\"2.0\" dy=\"0.36em\" font-size=\"12\" font-weight=\"bold\" fill=\"#242b33\" text-anchor=\"end\">&lt;T1 &amp; T2&gt;</text>",
            "transform=\"rotate(-90 3.0 4.0)\">up<",
            "<polyline points=\"0.0,1.0 2.0,1.0 3.0,5.0\" stroke=\"#242b33\" stroke-width=\"1.5\" stroke-dasharray=\"9 6\"/>",
        ] {
            assert!(svg.contains(part), "{part} in {svg}");
        }
    }
}
