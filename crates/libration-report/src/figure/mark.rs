//! Marks of a panel.

use serde::Serialize;

use super::color::Colors;
use super::envelope::Envelope;
use super::grid::Grid;
use super::style::{Dash, Marker, Role, Style};

/// A mark of a panel, in data coordinates.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Mark {
    /// The label, on the line if there is space, else in the legend.
    pub label: Option<String>,
    /// The style.
    pub style: Style,
    /// The geometry.
    pub shape: Shape,
}

/// The geometry of a mark. A value that is not finite, or not positive on a logarithmic axis,
/// leaves a gap.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Shape {
    /// A line through points.
    Line {
        /// Abscissae.
        x: Vec<f64>,
        /// Ordinates.
        y: Vec<f64>,
    },
    /// Unconnected points.
    Points {
        /// Abscissae.
        x: Vec<f64>,
        /// Ordinates.
        y: Vec<f64>,
    },
    /// The band between the smallest and the largest value of a long series.
    Envelope(Envelope),
    /// A grid of values in colour, with a colour bar.
    Raster {
        /// The values.
        grid: Grid,
        /// The colour map.
        colors: Colors,
    },
    /// Lines of equal value of a grid.
    Contour {
        /// The values.
        grid: Grid,
        /// The levels.
        levels: Vec<f64>,
    },
    /// A filled polygon.
    Region {
        /// Abscissae of the corners.
        x: Vec<f64>,
        /// Ordinates of the corners.
        y: Vec<f64>,
    },
    /// A straight line across the panel at one value.
    Rule {
        /// The direction of the line.
        across: Across,
        /// The value.
        at: f64,
    },
    /// The label of the mark, written at a place.
    Note {
        /// Abscissa of the start of the text.
        x: f64,
        /// Ordinate of the middle of the text.
        y: f64,
    },
}

/// The direction of a [`Shape::Rule`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Across {
    /// A horizontal line at a value of y.
    Horizontal,
    /// A vertical line at a value of x.
    Vertical,
}

impl Mark {
    fn new(shape: Shape) -> Self {
        Self { label: None, style: Style::default(), shape }
    }

    /// A line through points.
    pub fn line(x: impl Into<Vec<f64>>, y: impl Into<Vec<f64>>) -> Self {
        Self::new(Shape::Line { x: x.into(), y: y.into() })
    }

    /// Unconnected points: filled circles unless [`marker`](Self::marker) changes them.
    pub fn points(x: impl Into<Vec<f64>>, y: impl Into<Vec<f64>>) -> Self {
        Self::new(Shape::Points { x: x.into(), y: y.into() }).marker(Marker::Circle)
    }

    /// A prediction: open circles in the role of theory, over the measurement.
    pub fn prediction(x: impl Into<Vec<f64>>, y: impl Into<Vec<f64>>) -> Self {
        Self::new(Shape::Points { x: x.into(), y: y.into() }).role(Role::Theory).width(1.1)
    }

    /// The band of a long series.
    pub fn envelope(envelope: Envelope) -> Self {
        Self::new(Shape::Envelope(envelope)).width(1.0)
    }

    /// A grid of values in colour.
    pub fn raster(grid: Grid, colors: Colors) -> Self {
        Self::new(Shape::Raster { grid, colors })
    }

    /// Lines of equal value of a grid.
    pub fn contour(grid: Grid, levels: impl Into<Vec<f64>>) -> Self {
        Self::new(Shape::Contour { grid, levels: levels.into() }).dash(Dash::Solid).width(1.4)
    }

    /// A filled polygon.
    pub fn region(x: impl Into<Vec<f64>>, y: impl Into<Vec<f64>>) -> Self {
        Self::new(Shape::Region { x: x.into(), y: y.into() }).dash(Dash::Solid).width(1.0)
    }

    /// A horizontal line at a value of y.
    pub fn horizontal(at: f64) -> Self {
        Self::new(Shape::Rule { across: Across::Horizontal, at }).dash(Dash::Dashed).width(1.2)
    }

    /// A vertical line at a value of x.
    pub fn vertical(at: f64) -> Self {
        Self::new(Shape::Rule { across: Across::Vertical, at }).dash(Dash::Dashed).width(1.2)
    }

    /// Text at a place.
    pub fn note(x: f64, y: f64, text: impl Into<String>) -> Self {
        Self::new(Shape::Note { x, y }).label(text)
    }

    /// Sets the label.
    #[must_use]
    pub fn label(mut self, label: impl Into<String>) -> Self {
        self.label = Some(label.into());
        self
    }

    /// Sets the role.
    #[must_use]
    pub fn role(mut self, role: Role) -> Self {
        self.style.role = role;
        self
    }

    /// Sets the pattern of lines.
    #[must_use]
    pub fn dash(mut self, dash: Dash) -> Self {
        self.style.dash = dash;
        self
    }

    /// Sets the width of lines.
    #[must_use]
    pub fn width(mut self, width: f64) -> Self {
        self.style.width = width;
        self
    }

    /// Sets the shape of points.
    #[must_use]
    pub fn marker(mut self, marker: Marker) -> Self {
        self.style.marker = marker;
        self
    }

    /// Sets the radius of points.
    #[must_use]
    pub fn radius(mut self, radius: f64) -> Self {
        self.style.radius = radius;
        self
    }
}
