//! The description of a figure.

use serde::Serialize;

use super::axis::Axis;
use super::layout::Layout;
use super::mark::{Mark, Shape};

/// A figure: what both back ends draw.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Figure {
    /// A name that serves as file stem and anchor: letters, digits and hyphens.
    pub id: String,
    /// The number the figure has in the report whose claims it judges.
    pub number: Option<String>,
    /// The finding in one sentence.
    pub title: String,
    /// What else the reader must know to read the figure.
    pub caption: String,
    /// The figure in words, for those who cannot see it.
    pub description: String,
    /// The panels, row by row.
    pub panels: Vec<Panel>,
    /// How many panels stand in a row.
    pub columns: usize,
    /// The width of a panel's frame over its height.
    pub aspect: f64,
}

impl Figure {
    /// A figure without panels.
    pub fn new(id: impl Into<String>, title: impl Into<String>) -> Self {
        Self {
            id: id.into(),
            number: None,
            title: title.into(),
            caption: String::new(),
            description: String::new(),
            panels: Vec::new(),
            columns: 1,
            aspect: 1.75,
        }
    }

    /// Sets the number the figure has in the source report.
    #[must_use]
    pub fn number(mut self, number: impl Into<String>) -> Self {
        self.number = Some(number.into());
        self
    }

    /// Sets what follows the title below the figure.
    #[must_use]
    pub fn caption(mut self, caption: impl Into<String>) -> Self {
        self.caption = caption.into();
        self
    }

    /// Puts the figure into words.
    #[must_use]
    pub fn description(mut self, description: impl Into<String>) -> Self {
        self.description = description.into();
        self
    }

    /// Adds a panel.
    #[must_use]
    pub fn panel(mut self, panel: Panel) -> Self {
        self.panels.push(panel);
        self
    }

    /// Sets how many panels stand in a row.
    #[must_use]
    pub fn columns(mut self, columns: usize) -> Self {
        self.columns = columns.max(1);
        self
    }

    /// Sets the width of a panel's frame over its height.
    #[must_use]
    pub fn aspect(mut self, aspect: f64) -> Self {
        self.aspect = aspect;
        self
    }

    /// Whether data are drawn in any panel; lines across a panel and words are none.
    pub fn shows_anything(&self) -> bool {
        Layout::of(self).panels.iter().any(|placed| {
            let data = |mark: &Mark| !matches!(mark.shape, Shape::Rule { .. } | Shape::Note { .. });
            let mut marks = placed.panel.marks.iter().zip(&placed.drawn);
            marks.any(|(mark, drawn)| data(mark) && !drawn.is_empty())
        })
    }
}

/// One frame with its two axes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Panel {
    /// Written above the frame, if there is more than one.
    pub title: Option<String>,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// One unit is as long on both axes, as phase portraits want it. A range grows where needed.
    pub equal: bool,
    /// What is drawn, the first lowest.
    pub marks: Vec<Mark>,
}

impl Panel {
    /// An empty frame.
    pub fn new(x: Axis, y: Axis) -> Self {
        Self { title: None, x, y, equal: false, marks: Vec::new() }
    }

    /// Sets the title.
    #[must_use]
    pub fn title(mut self, title: impl Into<String>) -> Self {
        self.title = Some(title.into());
        self
    }

    /// Makes one unit as long on both axes.
    #[must_use]
    pub fn equal(mut self) -> Self {
        self.equal = true;
        self
    }

    /// Adds a mark on top of those before it.
    #[must_use]
    pub fn mark(mut self, mark: Mark) -> Self {
        self.marks.push(mark);
        self
    }

    /// Adds marks on top of those before them.
    #[must_use]
    pub fn marks(mut self, marks: impl IntoIterator<Item = Mark>) -> Self {
        self.marks.extend(marks);
        self
    }
}
