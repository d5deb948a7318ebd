//! Cells as a shaded table: rows that have groups of columns in common.

use super::Picture;
use super::canvas::{BOLD, Canvas, Colour, SMALL, WHITE};
use super::plot::{BLUE, INK, Pen, VERMILLION};

/// The table.
pub(crate) struct Matrix {
    pub(crate) title: String,
    /// What the rows are.
    pub(crate) corner: String,
    /// Names of the rows.
    pub(crate) rows: Vec<String>,
    /// From left to right.
    pub(crate) groups: Vec<Group>,
    /// How to read it.
    pub(crate) notes: Vec<String>,
}

/// Columns that belong together.
pub(crate) struct Group {
    pub(crate) title: String,
    pub(crate) columns: Vec<String>,
    /// By row, then by column.
    pub(crate) cells: Vec<Vec<Cell>>,
}

/// A cell.
#[derive(Clone, Debug)]
pub(crate) struct Cell {
    /// How dark it is, 0..=1; nothing is written in a cell of 0.
    pub(crate) shade: f64,
    /// It is as it should be.
    pub(crate) is_right: bool,
    pub(crate) text: String,
}

impl Cell {
    /// A share, 0..=1.
    pub(crate) fn share(share: f64, is_right: bool) -> Self {
        Self { shade: share, is_right, text: percent(share) }
    }
}

const WIDTH: f64 = 1200.0;
const LEFT: f64 = 170.0;
const GAP: f64 = 26.0;
const ROW: f64 = 26.0;
const HEAD: f64 = 175.0;
const NOTE: f64 = 21.0;

const FRAME: Pen = Pen::new(Colour(0xC8, 0xCE, 0xD5), 1.0);

impl Matrix {
    /// Width of a column, px.
    fn column(&self) -> f64 {
        let columns: usize = self.groups.iter().map(|group| group.columns.len()).sum();
        let gaps = GAP * (self.groups.len() as f64 - 1.0).max(0.0);
        ((WIDTH - LEFT - 20.0 - gaps) / columns.max(1) as f64).min(70.0)
    }

    fn group(&self, canvas: &mut Canvas, group: &Group, left: f64) {
        let width = self.column();
        canvas.text(&group.title, (left, 54.0), BOLD);
        for (i, name) in group.columns.iter().enumerate() {
            let x = left + width * (i as f64 + 0.5);
            canvas.upright(name, (x, HEAD - 8.0), SMALL);
        }
        for (j, row) in group.cells.iter().enumerate() {
            for (i, cell) in row.iter().enumerate() {
                let from = (left + width * i as f64, HEAD + ROW * j as f64);
                let to = (from.0 + width, from.1 + ROW);
                let colour = if cell.is_right { BLUE } else { VERMILLION };
                if cell.shade > 0.0 {
                    canvas.fill(from, to, colour, 0.12 + 0.78 * cell.shade);
                    let ink = if cell.shade > 0.5 { WHITE } else { INK };
                    let at = (0.5 * (from.0 + to.0), 0.5 * (from.1 + to.1));
                    canvas.text(&cell.text, at, SMALL.centred().coloured(ink));
                }
                let corners = [from, (to.0, from.1), to, (from.0, to.1), from];
                canvas.line(&corners, FRAME);
            }
        }
    }
}

/// Never 100 or 0 where it is not quite.
fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    match percent {
        100.0 => "100".into(),
        x if x < 0.1 => "<0.1".into(),
        x if x < 9.95 => format!("{x:.1}"),
        x if x > 99.0 => format!("{:.1}", (x * 10.0).floor() / 10.0),
        x => format!("{x:.0}"),
    }
}

impl Picture for Matrix {
    fn size(&self) -> (u32, u32) {
        let height = HEAD + ROW * self.rows.len() as f64 + 16.0 + NOTE * self.notes.len() as f64 + 8.0;
        (WIDTH as u32, height as u32)
    }

    fn paint(&self, canvas: &mut Canvas) {
        canvas.text(&self.title, (20.0, 22.0), BOLD.sized(14.5));
        canvas.text(&self.corner, (LEFT - 10.0, HEAD - 14.0), SMALL.right());
        for (j, name) in self.rows.iter().enumerate() {
            canvas.text(name, (LEFT - 10.0, HEAD + ROW * (j as f64 + 0.5)), SMALL.right());
        }
        let mut left = LEFT;
        for group in &self.groups {
            self.group(canvas, group, left);
            left += self.column() * group.columns.len() as f64 + GAP;
        }
        for (i, note) in self.notes.iter().enumerate() {
            let y = HEAD + ROW * self.rows.len() as f64 + 26.0 + NOTE * i as f64;
            canvas.text(note, (20.0, y), SMALL);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearly_all_is_not_all_and_nearly_none_is_not_none() {
        assert_eq!([1.0, 0.9996, 0.004, 0.0004, 0.42].map(percent), ["100", "99.9", "0.4", "<0.1", "42"]);
    }
}
