//! Layout of figures on the page, for both back ends.

use super::axis::{Ruler, Span};
use super::color::Colors;
use super::extent::spans;
use super::frame::Frame;
use super::geometry::Rect;
use super::label;
use super::label::Label;
use super::mark::{Mark, Shape};
use super::mark_geometry::MarkGeometry;
use super::panel::{Figure, Panel};
use super::sizes::{NORMAL, SMALL, WIDTH};
use super::ticks::{Tick, ticks};
use crate::text;

const GUTTER: f64 = 26.0;
const LEGEND_LINE: f64 = 22.0;
const SWATCH: f64 = 34.0;

/// The layout of a figure.
#[derive(Debug, Clone)]
pub(super) struct FigureLayout<'a> {
    pub(super) height: f64,
    pub(super) panels: Vec<PanelLayout<'a>>,
    pub(super) legend: Vec<LegendEntry<'a>>,
}

/// The layout of a panel.
#[derive(Debug, Clone)]
pub(super) struct PanelLayout<'a> {
    pub(super) panel: &'a Panel,
    pub(super) frame: Frame,
    pub(super) x_ticks: Vec<Tick>,
    pub(super) y_ticks: Vec<Tick>,
    pub(super) drawn: Vec<MarkGeometry>,
    pub(super) labels: Vec<Label>,
    pub(super) bar: Option<ColorBar<'a>>,
    /// The left edge of the numbers at the vertical axis.
    pub(super) numbers: f64,
}

/// A colour bar.
#[derive(Debug, Clone)]
pub(super) struct ColorBar<'a> {
    pub(super) rect: Rect,
    pub(super) colors: &'a Colors,
    pub(super) ruler: Ruler,
    pub(super) ticks: Vec<Tick>,
}

/// An entry of the legend above the figure.
#[derive(Debug, Clone)]
pub(super) struct LegendEntry<'a> {
    pub(super) mark: &'a Mark,
    pub(super) text: &'a str,
    /// The left end of the sample; the text stands to its right.
    pub(super) x: f64,
    pub(super) y: f64,
    /// The left end of the text.
    pub(super) text_x: f64,
}

/// The free space around the frames of a column or a row.
#[derive(Debug, Clone, Copy, Default)]
struct Margins {
    left: f64,
    right: f64,
}

impl<'a> FigureLayout<'a> {
    /// The layout of a figure. Margins depend on numbers and labels, which depend on the frames: the first
    /// pass measures, the second places.
    pub(super) fn of(figure: &'a Figure) -> Self {
        let columns = figure.columns.clamp(1, figure.panels.len().max(1));
        let start = vec![Margins { left: 64.0, right: 16.0 }; columns];
        let first = Self::arrange(figure, &start, 0.0);
        let mut margins = vec![Margins::default(); columns];
        for (index, placed) in first.panels.iter().enumerate() {
            let (margin, needed) = (&mut margins[index % columns], placed.needs());
            margin.left = margin.left.max(needed.left);
            margin.right = margin.right.max(needed.right);
        }
        let second = Self::arrange(figure, &margins, 0.0);
        let lines = second.legend.last().map_or(0.0, |entry| entry.y + 10.0);
        if lines > 0.0 { Self::arrange(figure, &margins, lines) } else { second }
    }

    fn arrange(figure: &'a Figure, margins: &[Margins], top: f64) -> Self {
        let columns = margins.len();
        let taken: f64 = margins.iter().map(|m| m.left + m.right).sum();
        let gutters = GUTTER * (columns - 1) as f64;
        let width = ((WIDTH - taken - gutters) / columns as f64).max(60.0);
        let height = width / figure.aspect.clamp(0.2, 10.0);
        let mut panels = Vec::with_capacity(figure.panels.len());
        let mut y = top;
        for row in figure.panels.chunks(columns) {
            let titled = row.iter().any(|panel| panel.title.is_some());
            y += if titled { 30.0 } else { 12.0 };
            let mut x = 0.0;
            for (panel, margin) in row.iter().zip(margins) {
                x += margin.left;
                let rect = Rect { x, y, width, height };
                panels.push(PanelLayout::of(panel, rect, columns));
                x += width + margin.right + GUTTER;
            }
            y += height + 50.0;
        }
        let mut layout = Self { height: y, panels, legend: Vec::new() };
        layout.legend = layout.entries();
        layout
    }

    /// The marks without a label in a panel, each text once.
    fn entries(&self) -> Vec<LegendEntry<'a>> {
        let left = self.panels.first().map_or(0.0, |placed| placed.frame.rect.x);
        let (mut x, mut y) = (left, 14.0);
        let mut entries: Vec<LegendEntry<'a>> = Vec::new();
        for placed in &self.panels {
            for (index, mark) in placed.panel.marks.iter().enumerate() {
                let Some(text) = mark.label.as_deref() else { continue };
                let named = placed.labels.iter().any(|label| label.mark == index);
                if named || entries.iter().any(|e| e.text == text && e.mark.style == mark.style) {
                    continue;
                }
                let sample = if matches!(mark.shape, Shape::Points { .. }) { 16.0 } else { SWATCH };
                let width = sample + text::width(text, NORMAL);
                if x > left && x + width > WIDTH - 8.0 {
                    (x, y) = (left, y + LEGEND_LINE);
                }
                entries.push(LegendEntry { mark, text, x, y, text_x: x + sample });
                x += width + 18.0;
            }
        }
        entries
    }
}

impl Figure {
    /// Whether any panel shows data. Rules and notes are not data.
    pub fn has_data(&self) -> bool {
        FigureLayout::of(self).panels.iter().any(|placed| {
            let data = |mark: &Mark| !matches!(mark.shape, Shape::Rule { .. } | Shape::Note { .. });
            let mut marks = placed.panel.marks.iter().zip(&placed.drawn);
            marks.any(|(mark, drawn)| data(mark) && !drawn.is_empty())
        })
    }
}

impl<'a> PanelLayout<'a> {
    fn of(panel: &'a Panel, rect: Rect, columns: usize) -> Self {
        let [x, y] = spans(panel, rect.width / rect.height);
        let x = Ruler { span: x, from: rect.x, to: rect.right() };
        let y = Ruler { span: y, from: rect.bottom(), to: rect.y };
        let frame = Frame { rect, x, y };
        let bar = panel.marks.iter().find_map(|mark| match &mark.shape {
            Shape::Raster { grid, colors } => Some(ColorBar::of(colors, &grid.z, &rect)),
            _ => None,
        });
        let x_ticks = ticks(&x.span, rect.width, 62.0);
        let y_ticks = match panel.y.names.as_slice() {
            [] => ticks(&y.span, rect.height, 34.0),
            names => named(names),
        };
        let mut drawn: Vec<MarkGeometry> =
            panel.marks.iter().map(|m| MarkGeometry::of(&m.shape, &frame)).collect();
        let labels = label::place(panel, &drawn, &frame, columns, bar.is_some());
        for label in labels.iter().filter(|label| !label.outside) {
            drawn.iter_mut().for_each(|d| d.clear_label(&label.rect().expanded(2.0)));
        }
        let widest = y_ticks.iter().map(|tick| text::width(&tick.label, SMALL)).fold(0.0, f64::max);
        let numbers = rect.x - 8.0 - widest;
        Self { panel, frame, x_ticks, y_ticks, drawn, labels, bar, numbers }
    }

    /// Whether the panel has a raster. Its colours do not change in the dark, so marks over it are light.
    pub(super) fn is_on_raster(&self) -> bool {
        self.drawn.iter().any(|drawn| matches!(drawn, MarkGeometry::Picture(_)))
    }

    /// The space that this panel needs on both sides of its frame.
    fn needs(&self) -> Margins {
        let title = if self.panel.y.label.is_empty() { 0.0 } else { NORMAL + 10.0 };
        let rect = self.frame.rect;
        let edge = self.x_ticks.last().map_or(0.0, |tick| text::width(&tick.label, SMALL) / 2.0);
        let ends = self.labels.iter().map(|label| label.rect().right() - rect.right() + 2.0);
        let bar = self.bar.as_ref().map_or(0.0, |bar| bar.right() - rect.right() + 2.0);
        let right = ends.fold(edge.max(bar).max(8.0), f64::max);
        Margins { left: (rect.x - self.numbers + title).max(30.0), right }
    }
}

impl<'a> ColorBar<'a> {
    fn of(colors: &'a Colors, values: &[f64], frame: &Rect) -> Self {
        let [low, high] = colors.ends(values);
        let (low, high) = (colors.scale.of(low), colors.scale.of(high));
        let span = Span { scale: colors.scale, low, high };
        let rect = Rect { x: frame.right() + 14.0, width: 13.0, ..*frame };
        let ruler = Ruler { span, from: frame.bottom(), to: frame.y };
        Self { rect, colors, ruler, ticks: ticks(&span, frame.height, 34.0) }
    }

    /// The left edge of the numbers.
    pub(super) fn numbers(&self) -> f64 {
        self.rect.right() + 6.0
    }

    /// The line on which the title is centred.
    pub(super) fn title(&self) -> f64 {
        let width = |tick: &Tick| text::width(&tick.label, SMALL);
        self.numbers() + self.ticks.iter().map(width).fold(0.0, f64::max) + NORMAL + 2.0
    }

    fn right(&self) -> f64 {
        self.title() + 4.0
    }
}

/// A tick for each name, from 0 downwards.
fn named(names: &[String]) -> Vec<Tick> {
    let tick = |(i, name): (usize, &String)| Tick { value: -(i as f64), label: name.clone() };
    names.iter().enumerate().map(tick).collect()
}
