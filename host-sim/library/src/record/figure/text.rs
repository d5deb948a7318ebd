//! Texts of figures: what a backend wants to know of them, and their pixels by a font that is built in, since a fresh machine has none.

use std::io;

use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{FontFamily, FontStyle, FontTransform, RGBColor};
use plotters_backend::{BackendColor, BackendCoord, BackendTextStyle};
use swash::FontRef;
use swash::scale::{Render, ScaleContext, Source};

use super::canvas::UNITS;
use super::plot::INK;

/// A size in px is that of a line; letters are smaller. The backend for SVG divides by it, too.
const LINE: f64 = 1.24;
/// Height of a small letter of the font, in sizes of its letters; the font itself does not tell it.
const SMALL: f32 = 0.547;

/// How a text is set.
#[derive(Clone, Copy)]
pub(super) struct Type {
    size: f64,
    style: FontStyle,
    colour: RGBColor,
    align: HPos,
}

/// Text of labels.
pub(super) const PLAIN: Type = Type { size: 15.0, style: FontStyle::Normal, colour: INK, align: HPos::Left };
/// Text of titles.
pub(super) const BOLD: Type = Type { style: FontStyle::Bold, ..PLAIN };

impl Type {
    /// The same, beginning at its place.
    pub(super) const fn left(self) -> Self {
        Self { align: HPos::Left, ..self }
    }

    /// The same, centred about its place.
    pub(super) const fn centred(self) -> Self {
        Self { align: HPos::Center, ..self }
    }

    /// The same, ending at its place.
    pub(super) const fn right(self) -> Self {
        Self { align: HPos::Right, ..self }
    }

    /// The same in another size, px.
    pub(super) const fn sized(self, size: f64) -> Self {
        Self { size, ..self }
    }

    /// The same in another colour.
    pub(super) const fn coloured(self, colour: RGBColor) -> Self {
        Self { colour, ..self }
    }

    /// Width of a text, px.
    ///
    /// # Errors
    /// The built-in font is damaged.
    pub(super) fn width(self, text: &str) -> io::Result<f64> {
        Ok(f64::from(self.advance(self.font()?, text)) / f64::from(UNITS))
    }

    fn font(self) -> io::Result<FontRef<'static>> {
        let bytes = match self.style {
            FontStyle::Bold => dejavu::sans::bold(),
            _ => dejavu::sans::regular(),
        };
        FontRef::from_index(bytes, 0).ok_or_else(|| io::Error::other("the built-in font is damaged"))
    }

    /// Size of the letters, units.
    fn em(self) -> f32 {
        (self.size * f64::from(UNITS) / LINE) as f32
    }

    /// Width of a text, units.
    fn advance(self, font: FontRef<'static>, text: &str) -> f32 {
        let (glyphs, letters) = (font.charmap(), font.glyph_metrics(&[]).scale(self.em()));
        text.chars().map(|letter| letters.advance_width(glyphs.map(letter))).sum()
    }
}

/// A text as a backend draws it, about the height of its place.
pub(super) struct Look {
    pub(super) of: Type,
    /// It runs upwards.
    pub(super) is_upright: bool,
}

impl BackendTextStyle for Look {
    type FontError = io::Error;

    fn color(&self) -> BackendColor {
        let RGBColor(r, g, b) = self.of.colour;
        BackendColor { alpha: 1.0, rgb: (r, g, b) }
    }

    fn size(&self) -> f64 {
        self.of.size * f64::from(UNITS)
    }

    fn transform(&self) -> FontTransform {
        if self.is_upright { FontTransform::Rotate270 } else { FontTransform::None }
    }

    fn style(&self) -> FontStyle {
        self.of.style
    }

    fn anchor(&self) -> Pos {
        Pos::new(self.of.align, VPos::Center)
    }

    fn family(&self) -> FontFamily<'_> {
        FontFamily::SansSerif
    }

    fn layout_box(&self, text: &str) -> io::Result<((i32, i32), (i32, i32))> {
        Ok(((0, 0), (self.of.advance(self.of.font()?, text) as i32, self.of.em() as i32)))
    }

    /// Letter by letter. Half the height of a small letter below the middle is the line that they stand on.
    fn draw<E, DrawFunc: FnMut(i32, i32, BackendColor) -> Result<(), E>>(
        &self,
        text: &str,
        (left, top): BackendCoord,
        mut draw: DrawFunc,
    ) -> io::Result<Result<(), E>> {
        let (font, em) = (self.of.font()?, self.of.em());
        let (glyphs, letters) = (font.charmap(), font.glyph_metrics(&[]).scale(em));
        let line = top + (0.5 * em * (1.0 + SMALL)).round() as i32;
        let mut context = ScaleContext::new();
        let mut scaler = context.builder(font).size(em).build();
        let mut pen = left as f32;
        for glyph in text.chars().map(|letter| glyphs.map(letter)) {
            if let Some(image) = Render::new(&[Source::Outline]).render(&mut scaler, glyph) {
                let place = image.placement;
                let (x, y) = (pen as i32 + place.left, line - place.top);
                for (at, cover) in (0..).zip(&image.data).filter(|(_, cover)| **cover > 0) {
                    let (column, row) = (at % place.width as i32, at / place.width as i32);
                    let colour = BackendColor { alpha: f64::from(*cover) / 255.0, ..self.color() };
                    if let Err(error) = draw(x + column, y + row, colour) {
                        return Ok(Err(error));
                    }
                }
            }
            pen += letters.advance_width(glyph);
        }
        Ok(Ok(()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The pixels that a text covers: their bounds, and how much they cover.
    fn drawn(text: &str, look: Type) -> ([i32; 4], f64) {
        let (mut bounds, mut sum) = ([i32::MAX, i32::MAX, i32::MIN, i32::MIN], 0.0);
        let draw = |x: i32, y: i32, colour: BackendColor| {
            bounds = [bounds[0].min(x), bounds[1].min(y), bounds[2].max(x), bounds[3].max(y)];
            sum += colour.alpha;
            Ok::<(), ()>(())
        };
        Look { of: look, is_upright: false }.draw(text, (0, 0), draw).unwrap().unwrap();
        (bounds, sum)
    }

    #[test]
    fn letters_fill_the_width_that_a_text_says_and_stand_about_its_middle() {
        let ([left, top, right, bottom], _) = drawn("xnxn", PLAIN);
        let width = PLAIN.width("xnxn").unwrap() * f64::from(UNITS);
        assert!(
            (0..4).contains(&left) && (f64::from(right) - width).abs() < 4.0,
            "{left} {right} of {width}"
        );
        let middle = Look { of: PLAIN, is_upright: false }.layout_box("xnxn").unwrap().1.1 / 2;
        assert!(((top + bottom) / 2 - middle).abs() <= 1, "{top} {bottom} about {middle}");
    }

    #[test]
    fn bold_covers_more_and_what_the_font_lacks_does_no_harm() {
        assert!(drawn("T1", BOLD).1 > 1.2 * drawn("T1", PLAIN).1);
        assert_eq!(drawn(" ", PLAIN).1, 0.0);
        assert!(PLAIN.width("\u{10FFFF}").unwrap() > 0.0);
    }
}
