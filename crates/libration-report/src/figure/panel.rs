//! Descriptions of figures.

use serde::Serialize;

use super::axis::Axis;
use super::mark::Mark;

/// The description of a figure.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Figure {
    /// The file stem and anchor: letters, digits and hyphens.
    pub id: String,
    /// The number of the figure in the source report.
    pub number: Option<String>,
    /// The finding in one sentence.
    pub title: String,
    /// Further information about the figure.
    pub caption: String,
    /// The description for screen readers.
    pub description: String,
    /// The panels, row by row.
    pub panels: Vec<Panel>,
    /// The number of panels per row.
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

    /// Sets the number of the figure in the source report.
    #[must_use]
    pub fn number(mut self, number: impl Into<String>) -> Self {
        self.number = Some(number.into());
        self
    }

    /// Sets the caption after the title.
    #[must_use]
    pub fn caption(mut self, caption: impl Into<String>) -> Self {
        self.caption = caption.into();
        self
    }

    /// Sets the description for screen readers.
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

    /// Sets the number of panels per row.
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
}

/// One frame with its two axes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Panel {
    /// The title above the frame.
    pub title: Option<String>,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// Whether a unit has the same length on both axes, as in phase portraits. A range grows if needed.
    pub equal: bool,
    /// The marks, from bottom to top.
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

    /// Gives a unit the same length on both axes.
    #[must_use]
    pub fn equal(mut self) -> Self {
        self.equal = true;
        self
    }

    /// Adds a mark on top.
    #[must_use]
    pub fn mark(mut self, mark: Mark) -> Self {
        self.marks.push(mark);
        self
    }

    /// Adds marks on top.
    #[must_use]
    pub fn marks(mut self, marks: impl IntoIterator<Item = Mark>) -> Self {
        self.marks.extend(marks);
        self
    }
}
