//! A figure as data: panels, traces, thresholds, and the times that are shaded.

use super::canvas::Colour;

/// Text and axes.
pub(super) const INK: Colour = Colour(0x24, 0x2B, 0x33);

/// Thresholds: one of Okabe and Ito's colours, which the colour-blind can tell apart.
pub(crate) const VERMILLION: Colour = Colour(0xD5, 0x5E, 0x00);

/// Another of them.
pub(crate) const BLUE: Colour = Colour(0x00, 0x72, 0xB2);

/// The start-up up to here, in s after the first row, does not count for the ranges.
const START_UP: f64 = 20.0;

/// A figure: panels over a common time axis.
pub(super) struct Figure {
    /// First and last time, s.
    pub(super) span: (f64, f64),
    /// Time of each sample, s.
    pub(super) times: Vec<f64>,
    /// Times that are shaded in every panel.
    pub(super) bands: Vec<Band>,
    /// From top to bottom.
    pub(super) panels: Vec<Panel>,
}

/// A time that is shaded.
pub(super) struct Band {
    /// Name at the top of the figure.
    pub(super) label: String,
    /// Begin and end, s.
    pub(super) span: (f64, f64),
    /// Tint.
    pub(super) colour: Colour,
}

/// One panel.
pub(super) struct Panel {
    /// What it shows, and its unit.
    pub(super) title: String,
    /// The scale of the values.
    pub(super) scale: Scale,
    /// Drawn in this order, so the last is on top.
    pub(super) traces: Vec<Trace>,
    /// Heights of dashed lines.
    pub(super) thresholds: Vec<f64>,
    /// Names of the levels 0, 1, 2 and so on, in place of their numbers.
    pub(super) names: Vec<&'static str>,
}

/// The scale of a panel's values.
#[derive(Clone, Copy)]
pub(super) enum Scale {
    /// As the values are, but so wide at least.
    AtLeast(f64),
    /// Whole numbers from 0 to this at least.
    Levels(f64),
}

/// One signal.
pub(super) struct Trace {
    /// Name in the legend.
    pub(super) label: &'static str,
    /// How it is drawn.
    pub(super) pen: Pen,
    /// One value a sample; what is not defined is no number.
    pub(super) values: Vec<f64>,
}

/// How a line is drawn.
#[derive(Clone, Copy)]
pub(super) struct Pen {
    /// Its colour.
    pub(super) colour: Colour,
    /// Its width, px.
    pub(super) width: f64,
    /// Whether it holds a value until the next.
    pub(super) stepped: bool,
    /// Whether it is dashed.
    pub(super) is_dashed: bool,
}

impl Pen {
    /// A plain line.
    pub(super) const fn new(colour: Colour, width: f64) -> Self {
        Self { colour, width, stepped: false, is_dashed: false }
    }

    /// The same, holding each value until the next.
    pub(super) const fn stepped(self) -> Self {
        Self { stepped: true, ..self }
    }

    /// The same, dashed.
    pub(super) const fn dashed(self) -> Self {
        Self { is_dashed: true, ..self }
    }
}

/// Pen of a threshold.
pub(super) const THRESHOLD: Pen = Pen::new(VERMILLION, 1.2).dashed();
/// Name of the thresholds in a legend.
pub(super) const THRESHOLD_LABEL: &str = "thresholds";

impl Band {
    /// The middle of it, s.
    pub(super) fn middle(&self) -> f64 {
        0.5 * (self.span.0 + self.span.1)
    }
}

impl Figure {
    /// Values that decide the range of a panel: those after the start-up, or all in a run that is not longer.
    pub(super) fn settled_values(&self, panel: &Panel) -> Vec<f64> {
        let start_up = self.times.partition_point(|&t| t < self.span.0 + START_UP);
        let settled = if start_up < self.times.len() { start_up } else { 0 };
        panel.traces.iter().flat_map(|trace| &trace.values[settled..]).copied().collect()
    }
}
