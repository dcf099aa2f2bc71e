//! Descriptions of chapters of the report, without layout.

use crate::figure::Figure;
use crate::live::LiveSetting;
use crate::record::{Record, Table};

/// The content of a chapter, from top to bottom.
#[derive(Clone, Debug, Default)]
pub struct Page {
    /// The chapter's heading.
    pub title: String,
    /// A sentence that opens the chapter; empty for none.
    pub headline: String,
    /// The answer in one or two sentences, for the head of the report.
    pub answer: String,
    /// The key numbers, most important first; four are shown.
    pub highlights: Vec<Highlight>,
    /// What is used of each limit, as bars below the key numbers of a single page.
    pub bars: Vec<Bar>,
    /// What a reader should do, in a few sentences with `code` between backticks. They close a chapter, and the first screen of a single page.
    pub actions: Vec<String>,
    /// The settings of the [live section](crate::live) of a single page, below its answer; without any there is none.
    pub live: Vec<LiveSetting>,
    /// The evidence.
    pub blocks: Vec<Block>,
}

/// A key number.
#[derive(Clone, Debug)]
pub struct Highlight {
    /// The number with its unit.
    pub value: String,
    /// The description of the number.
    pub text: String,
}

/// A bar: the used part of a limit.
#[derive(Clone, Debug)]
pub struct Bar {
    /// What is used.
    pub name: String,
    /// The used part, where 1 is the limit.
    pub part: f64,
    /// The used size and its limit in words.
    pub text: String,
}

/// A block of a chapter.
#[derive(Clone, Debug)]
pub enum Block {
    /// A smaller heading.
    Heading(String),
    /// A paragraph, with `code` between backticks.
    Paragraph(String),
    /// A remark.
    Note(String),
    /// Lines of code to paste, which break at spaces only.
    Code(String),
    /// A figure.
    Figure(Box<Figure>),
    /// A table with a number of significant digits.
    Table {
        /// The numbers.
        table: Table,
        /// Significant digits to show.
        digits: usize,
    },
}

impl Page {
    /// Adds a heading.
    pub fn heading(&mut self, text: impl Into<String>) {
        self.blocks.push(Block::Heading(text.into()));
    }

    /// Adds a paragraph.
    pub fn paragraph(&mut self, text: impl Into<String>) {
        self.blocks.push(Block::Paragraph(text.into()));
    }

    /// Adds a remark.
    pub fn note(&mut self, text: impl Into<String>) {
        self.blocks.push(Block::Note(text.into()));
    }

    /// Adds lines of code to paste.
    pub fn code(&mut self, text: impl Into<String>) {
        self.blocks.push(Block::Code(text.into()));
    }

    /// Adds what a reader should do.
    pub fn action(&mut self, text: impl Into<String>) {
        self.actions.push(text.into());
    }

    /// Adds a figure if it shows data. A configuration may exclude all data of a figure.
    pub fn figure(&mut self, figure: Figure) {
        if figure.has_data() {
            self.blocks.push(Block::Figure(Box::new(figure)));
        }
    }

    /// The figures, from top to bottom.
    pub fn figures(&self) -> impl Iterator<Item = &Figure> {
        self.blocks.iter().filter_map(|block| match block {
            Block::Figure(figure) => Some(figure.as_ref()),
            _ => None,
        })
    }

    /// Adds a table of the record, shown with `digits` significant digits.
    pub fn table(&mut self, table: &Table, digits: usize) {
        self.blocks.push(Block::Table { table: table.clone(), digits });
    }
}

/// A finished chapter: a record and its page.
#[derive(Clone, Debug)]
pub struct Chapter {
    /// The numbers.
    pub record: Record,
    /// The page that shows them.
    pub page: Page,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::{Axis, Mark, Panel};

    #[test]
    fn a_figure_in_which_nothing_is_drawn_is_not_shown() {
        let panel = || Panel::new(Axis::log("steps"), Axis::log("drift"));
        let with = |mark: Mark| Figure::new("x", "").panel(panel().mark(mark));
        let mut page = Page::default();
        page.figure(Figure::new("no-panels", ""));
        page.figure(Figure::new("no-marks", "").panel(panel()));
        // What is not positive leaves a gap on a logarithmic axis.
        page.figure(with(Mark::line([1.0, 2.0], [0.0, f64::NAN])));
        page.figure(with(Mark::horizontal(1e-3).label("rounding")));
        assert_eq!(page.figures().count(), 0);
        page.figure(with(Mark::line([1.0, 2.0], [0.1, 0.2])));
        page.figure(with(Mark::prediction([1.0], [0.1])));
        assert_eq!(page.figures().count(), 2);
    }
}
