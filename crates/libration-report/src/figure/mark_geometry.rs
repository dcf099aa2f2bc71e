//! The geometry of marks on the page, which both back ends draw and labels keep clear of.

use super::axis::{Ruler, Scale};
use super::frame::Frame;
use super::geometry::{Place, Rect, finite};
use super::grid::{Grid, Polyline};
use super::mark::{Across, Shape};

/// The part of a mark inside its frame, in pixels.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum MarkGeometry {
    /// Lines, in parts between gaps.
    Lines(Vec<Vec<Place>>),
    /// Points inside the frame.
    Points(Vec<Place>),
    /// A filled polygon with its outline.
    Areas(Vec<Vec<Place>>),
    /// Contour lines with the level each belongs to.
    Levels(Vec<(f64, Vec<Vec<Place>>)>),
    /// A raster that fills a rectangle.
    Picture(Rect),
    /// A label.
    Text(Place),
}

impl MarkGeometry {
    /// The geometry of a shape in a frame.
    pub(super) fn of(shape: &Shape, frame: &Frame) -> Self {
        let at = |(&x, &y): (&f64, &f64)| [frame.x.at(x), frame.y.at(y)];
        // Strokes may be as wide as the slack without an end showing at the frame.
        let clip = frame.rect.expanded(6.0);
        let places = |x: &[f64], y: &[f64]| x.iter().zip(y).map(at).collect::<Vec<Place>>();
        match shape {
            Shape::Line { x, y } => Self::Lines(clip.clip_line(&places(x, y))),
            Shape::Points { x, y } => {
                let inside = |place: &Place| frame.rect.expanded(0.5).contains(*place);
                Self::Points(places(x, y).into_iter().filter(inside).collect())
            }
            Shape::Envelope(e) => {
                let bands = bands(&places(&e.x, &e.low), &places(&e.x, &e.high));
                Self::Areas(bands.iter().map(|band| clip.clip_polygon(band)).collect())
            }
            Shape::Region { x, y } => Self::Areas(vec![clip.clip_polygon(&places(x, y))]),
            Shape::Raster { grid, .. } => Self::Picture(picture(grid, frame)),
            Shape::Contour { grid, levels } => {
                let lines = |&level: &f64| (level, lines(grid, level, frame, &clip));
                Self::Levels(levels.iter().map(lines).collect())
            }
            Shape::Rule { across, at } => {
                let rect = frame.rect;
                let line = match across {
                    Across::Horizontal => {
                        [[rect.x, frame.y.at(*at)], [rect.right(), frame.y.at(*at)]]
                    }
                    Across::Vertical => {
                        [[frame.x.at(*at), rect.bottom()], [frame.x.at(*at), rect.y]]
                    }
                };
                Self::Lines(rect.clip_line(&line))
            }
            Shape::Note { x, y } => Self::Text(at((x, y))),
        }
    }

    /// Whether nothing of the mark is visible.
    pub(super) fn is_empty(&self) -> bool {
        match self {
            Self::Lines(parts) | Self::Areas(parts) => parts.iter().all(Vec::is_empty),
            Self::Points(places) => places.is_empty(),
            Self::Levels(levels) => levels.iter().all(|(_, parts)| parts.is_empty()),
            Self::Picture(rect) => !(rect.width > 0.0 && rect.height > 0.0),
            Self::Text(_) => false,
        }
    }

    /// Interrupts contour lines at a label.
    pub(super) fn clear_label(&mut self, label: &Rect) {
        let Self::Levels(levels) = self else { return };
        for (_, parts) in levels {
            *parts = parts.iter().flat_map(|part| label.outside_parts(part)).collect();
        }
    }

    /// The lines that labels must not cover.
    pub(super) fn strokes(&self) -> Vec<&[Place]> {
        match self {
            Self::Lines(parts) => parts.iter().map(Vec::as_slice).collect(),
            Self::Levels(levels) => {
                levels.iter().flat_map(|(_, parts)| parts).map(Vec::as_slice).collect()
            }
            _ => Vec::new(),
        }
    }
}

/// Contour lines in the frame. They are found on the scale of the axes, so that a logarithmic axis
/// has the crossing at the same share of the way on paper as the level has between two samples.
fn lines(grid: &Grid, level: f64, frame: &Frame, clip: &Rect) -> Vec<Vec<Place>> {
    contour(grid, level, frame)
        .iter()
        .flat_map(|line| {
            let places: Vec<Place> =
                line.iter().map(|&[x, y]| [frame.x.at(x), frame.y.at(y)]).collect();
            clip.clip_line(&places)
        })
        .collect()
}

/// Contour lines in data coordinates, interpolated on the scale of the axes. Values above zero that
/// span more than two decades are interpolated in their logarithm.
pub(super) fn contour(grid: &Grid, level: f64, frame: &Frame) -> Vec<Polyline> {
    let (x, y) = (frame.x.span.scale, frame.y.span.scale);
    let finite = || grid.z.iter().copied().filter(|z| z.is_finite());
    let (low, high) = (finite().fold(f64::MAX, f64::min), finite().fold(0.0, f64::max));
    let z = if low > 0.0 && high > 100.0 * low { Scale::Log } else { Scale::Linear };
    let on = |scale: Scale, values: &[f64]| values.iter().map(|&v| scale.of(v)).collect();
    let on_scale = Grid { x: on(x, &grid.x), y: on(y, &grid.y), z: on(z, &grid.z) };
    let back = |line: Polyline| line.into_iter().map(|[a, b]| [x.value(a), y.value(b)]).collect();
    on_scale.contour(z.of(level)).into_iter().map(back).collect()
}

/// The closed bands between two lines, one for each stretch without a gap.
fn bands(low: &[Place], high: &[Place]) -> Vec<Vec<Place>> {
    runs(low.len().min(high.len()), |i| finite(low[i]) && finite(high[i]))
        .into_iter()
        .map(|run| {
            let back = low[run.clone()].iter().rev();
            high[run.clone()].iter().chain(back).copied().collect()
        })
        .collect()
}

/// The stretches of indices for which `present` holds.
pub(super) fn runs(count: usize, present: impl Fn(usize) -> bool) -> Vec<std::ops::Range<usize>> {
    let mut runs: Vec<std::ops::Range<usize>> = Vec::new();
    for index in (0..count).filter(|&i| present(i)) {
        match runs.last_mut() {
            Some(run) if run.end == index => run.end += 1,
            _ => runs.push(index..index + 1),
        }
    }
    runs
}

/// The rectangle that a grid covers: half a cell beyond its outer samples.
fn picture(grid: &Grid, frame: &Frame) -> Rect {
    let outer = |samples: &[f64], ruler: &Ruler| {
        let places: Vec<f64> =
            edges(samples, ruler.span.scale).iter().map(|&v| ruler.at(v)).collect();
        let (first, last) = (places.first().copied(), places.last().copied());
        (first.unwrap_or(0.0), last.unwrap_or(0.0))
    };
    let ((left, right), (bottom, top)) = (outer(&grid.x, &frame.x), outer(&grid.y, &frame.y));
    Rect { x: left, y: top, width: right - left, height: bottom - top }
}

/// The edges of the cells around samples that are evenly spaced on a scale: one more than samples.
pub(super) fn edges(samples: &[f64], scale: Scale) -> Vec<f64> {
    let (Some(&first), Some(&last)) = (samples.first(), samples.last()) else { return Vec::new() };
    let (first, last) = (scale.of(first), scale.of(last));
    let gaps = (samples.len() - 1) as f64;
    let step = if gaps > 0.0 { (last - first) / gaps } else { 1.0 };
    (0..=samples.len()).map(|i| scale.value(first + step * (i as f64 - 0.5))).collect()
}
