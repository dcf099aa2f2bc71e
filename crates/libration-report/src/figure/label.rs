//! Labels at marks, without overlaps.

use super::frame::Frame;
use super::geometry::{Place, Rect, centre};
use super::mark::{Across, Shape};
use super::mark_geometry::MarkGeometry;
use super::panel::Panel;
use super::sizes::{LABEL, SMALL};
use super::style::Role;
use super::ticks;
use crate::text;

/// A label of a mark.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Label {
    /// The index of the mark in its panel.
    pub(super) mark: usize,
    pub(super) text: String,
    pub(super) role: Role,
    pub(super) size: f64,
    pub(super) bold: bool,
    /// The left end of the text, and the middle of its height.
    pub(super) at: Place,
    /// The place on the mark that it belongs to.
    pub(super) anchor: Place,
    /// Whether the label is to the right of the frame.
    pub(super) outside: bool,
}

impl Label {
    /// The space that the text takes.
    pub(super) fn rect(&self) -> Rect {
        let width = if self.bold { text::bold_width } else { text::width }(&self.text, self.size);
        let height = self.size * 1.2;
        Rect { x: self.at[0], y: self.at[1] - height / 2.0, width, height }
    }

    /// The thin line from a label to its mark, if they are apart.
    pub(super) fn leader(&self) -> Option<[Place; 2]> {
        let far = self.outside && (self.at[1] - self.anchor[1]).abs() > 5.0;
        far.then(|| [[self.anchor[0] + 1.5, self.anchor[1]], [self.at[0] - 2.0, self.at[1]]])
    }
}

/// Places the labels of a panel; a mark without space for its label gets none.
pub(super) fn place(
    panel: &Panel,
    drawn: &[MarkGeometry],
    frame: &Frame,
    columns: usize,
    bar: bool,
) -> Vec<Label> {
    let mut table = Table { frame, drawn, labels: Vec::new() };
    let room = if bar { 0.0 } else { 250.0 / columns as f64 };
    let ends: Vec<Option<Place>> = drawn.iter().map(|d| end(d, &frame.rect)).collect();
    for (index, mark) in panel.marks.iter().enumerate() {
        let text = mark.label.clone().unwrap_or_default();
        let (role, at) = (mark.style.role, [0.0; 2]);
        let label = Label {
            mark: index,
            text,
            role,
            size: LABEL,
            bold: true,
            at,
            anchor: at,
            outside: false,
        };
        match (&mark.shape, &drawn[index]) {
            (Shape::Note { .. }, MarkGeometry::Text(at)) => {
                let note = Label { size: SMALL + 0.5, bold: false, at: *at, anchor: *at, ..label };
                table.labels.push(note);
            }
            (Shape::Line { .. } | Shape::Envelope(_), _) if mark.label.is_some() => {
                let Some(anchor) = ends[index] else { continue };
                let near = anchor[0] > frame.rect.right() - 0.03 * frame.rect.width;
                if near && label.rect().width < room {
                    let at = [frame.rect.right() + 8.0, anchor[1]];
                    table.labels.push(Label { anchor, at, outside: true, ..label });
                }
            }
            _ => {}
        }
    }
    spread(&mut table.labels, &frame.rect);
    for (index, mark) in panel.marks.iter().enumerate() {
        let text = mark.label.clone().unwrap_or_default();
        let (role, at) = (mark.style.role, [0.0; 2]);
        let done = table.labels.iter().any(|label| label.mark == index);
        let label = Label {
            mark: index,
            text,
            role,
            size: LABEL,
            bold: true,
            at,
            anchor: at,
            outside: false,
        };
        match (&mark.shape, &drawn[index]) {
            (_, MarkGeometry::Levels(levels)) => {
                let steps = levels.windows(2).map(|pair| (pair[1].0 - pair[0].0).abs());
                let step = steps.fold(f64::INFINITY, f64::min);
                for (level, lines) in levels {
                    let text = match &mark.label {
                        Some(name) if levels.len() == 1 => name.clone(),
                        _ => ticks::level(*level, step),
                    };
                    table.on_line(Label { text, size: SMALL, bold: false, ..label.clone() }, lines);
                }
            }
            _ if done || mark.label.is_none() => {}
            (Shape::Rule { across, .. }, MarkGeometry::Lines(lines)) => {
                let small = Label { size: SMALL + 0.5, bold: false, ..label };
                table.by_rule(small, *across, lines);
            }
            (Shape::Region { .. }, MarkGeometry::Areas(areas)) => {
                let Some(at) = areas.first().and_then(|area| centre(area)) else { continue };
                let rect = label.rect();
                let places = [0.0, -0.6, 0.6, -1.2, 1.2, -2.4, 2.4];
                let places = places.map(|k| [at[0] - rect.width / 2.0, at[1] + k * 20.0]);
                table.first_free(label, places.map(|p| (p, at)));
            }
            (_, MarkGeometry::Lines(lines) | MarkGeometry::Areas(lines)) => {
                table.along(label, ends[index], lines)
            }
            _ => {}
        }
    }
    table.labels
}

/// The last visible place of a line, or the middle of the right end of a band.
fn end(drawn: &MarkGeometry, frame: &Rect) -> Option<Place> {
    match drawn {
        MarkGeometry::Lines(parts) => {
            let inside = |place: &&Place| frame.expanded(0.5).contains(**place);
            parts.iter().rev().find_map(|part| part.iter().rev().find(inside)).copied()
        }
        MarkGeometry::Areas(areas) => {
            let area = areas.iter().rev().find(|area| !area.is_empty())?;
            let right = area.iter().map(|p| p[0]).fold(f64::MIN, f64::max);
            let near: Vec<Place> = area.iter().copied().filter(|p| p[0] > right - 8.0).collect();
            centre(&near).map(|[_, y]| [right.min(frame.right()), y])
        }
        _ => None,
    }
}

/// Moves the labels outside of the frame apart, as little as needed, in the order of their lines.
fn spread(labels: &mut [Label], frame: &Rect) {
    let mut column: Vec<&mut Label> = labels.iter_mut().filter(|label| label.outside).collect();
    column.sort_by(|a, b| a.at[1].total_cmp(&b.at[1]));
    let apart = LABEL * 1.25;
    // Groups of touching labels are centred on the mean of their lines; groups that meet merge.
    let mut groups: Vec<(f64, usize)> = Vec::new();
    for label in &column {
        groups.push((label.at[1], 1));
        while let [.., (above, m), (below, n)] = groups[..] {
            let reach = (m + n) as f64 / 2.0 * apart;
            if below - above >= reach {
                break;
            }
            groups.truncate(groups.len() - 2);
            groups.push(((above * m as f64 + below * n as f64) / (m + n) as f64, m + n));
        }
    }
    let mut places = Vec::with_capacity(column.len());
    let mut floor = frame.y;
    for (middle, count) in groups {
        let half = (count - 1) as f64 / 2.0 * apart;
        let first = (middle - half).min(frame.bottom() + 4.0 - 2.0 * half).max(floor);
        places.extend((0..count).map(|i| first + i as f64 * apart));
        floor = first + count as f64 * apart;
    }
    column.iter_mut().zip(places).for_each(|(label, y)| label.at[1] = y);
}

struct Table<'a> {
    frame: &'a Frame,
    drawn: &'a [MarkGeometry],
    labels: Vec<Label>,
}

impl Table<'_> {
    /// Beside the end of its line, or above or below some place of it.
    fn along(&mut self, label: Label, end: Option<Place>, lines: &[Vec<Place>]) {
        let (rect, mut places) = (label.rect(), Vec::new());
        if let Some(p) = end {
            places.push(([p[0] + 8.0, p[1] + 6.0], p));
            places.push(([p[0] + 8.0, p[1] - 8.0], p));
            places.push(([p[0] + 12.0, p[1] + 14.0], p));
        }
        let corners: Vec<Place> = lines.iter().flatten().copied().collect();
        for share in [0.97, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.1] {
            let Some(&p) = corners.get((share * corners.len() as f64) as usize) else { continue };
            for gap in [-13.0, 13.0, -20.0, 20.0] {
                places.push(([p[0] - rect.width / 2.0, p[1] + gap], p));
                places.push(([p[0] + 9.0, p[1] + gap], p));
                places.push(([p[0] - rect.width - 9.0, p[1] + gap], p));
            }
        }
        self.first_free(label, places);
    }

    /// On a contour line itself, its middle on the line.
    fn on_line(&mut self, label: Label, lines: &[Vec<Place>]) {
        let Some(line) = lines.iter().max_by_key(|line| line.len()) else { return };
        let (rect, count) = (label.rect(), line.len() as f64);
        let places = (1..20).map(|k| {
            let p = line[(count * f64::from(k * 7 % 20) / 20.0) as usize];
            ([p[0] - rect.width / 2.0, p[1]], p)
        });
        let inside = self.frame.rect.expanded(-2.0);
        let free = places.map(|(at, anchor)| Label { at, anchor, ..label.clone() }).find(|label| {
            let rect = label.rect();
            inside.contains_rect(&rect)
                && self.labels.iter().all(|l| !l.rect().expanded(3.0).intersects(&rect))
        });
        self.labels.extend(free);
    }

    fn by_rule(&mut self, label: Label, across: Across, lines: &[Vec<Place>]) {
        let Some([a, b]) = lines.first().and_then(|line| Some([*line.first()?, *line.last()?]))
        else {
            return;
        };
        let (width, mut places) = (label.rect().width, Vec::new());
        for share in [0.0, 0.15, 0.3, 0.45, 0.6, 0.75] {
            match across {
                Across::Horizontal => {
                    let x = b[0] - width - 6.0 - share * (b[0] - a[0]);
                    places.extend([-9.0, 10.0].map(|gap| ([x, b[1] + gap], [x, b[1]])));
                }
                Across::Vertical => {
                    let y = b[1] + 12.0 + share * (a[1] - b[1]);
                    places.extend([6.0, -6.0 - width].map(|gap| ([b[0] + gap, y], [b[0], y])));
                }
            }
        }
        self.first_free(label, places);
    }

    /// Takes the first place where the label covers nothing.
    fn first_free(&mut self, label: Label, places: impl IntoIterator<Item = (Place, Place)>) {
        let placed = places.into_iter().map(|(at, anchor)| Label { at, anchor, ..label.clone() });
        let free = placed.into_iter().find(|label| self.is_free(label));
        self.labels.extend(free);
    }

    fn is_free(&self, label: &Label) -> bool {
        let rect = label.rect();
        if !self.frame.rect.expanded(-3.0).contains_rect(&rect) {
            return false;
        }
        let near = rect.expanded(2.0);
        let covers =
            |line: &[Place]| line.windows(2).any(|p| near.clip_segment(p[0], p[1]).is_some());
        let spoiled = |drawn: &MarkGeometry| match drawn {
            MarkGeometry::Points(points) => points.iter().any(|&p| near.expanded(2.0).contains(p)),
            other => other.strokes().into_iter().any(covers),
        };
        self.labels.iter().all(|l| !l.rect().expanded(2.0).intersects(&rect))
            && !self.drawn.iter().any(spoiled)
    }
}
