//! Sizes of figures and of their text, in pixels.

use crate::text;

/// The width of every figure, in pixels.
pub(super) const WIDTH: f64 = 860.0;
/// The size of the numbers at the ticks.
pub(super) const SMALL: f64 = 12.0;
/// The size of axis titles.
pub(super) const NORMAL: f64 = 13.0;
/// The size of labels.
pub(super) const LABEL: f64 = 13.5;
/// How much wider than a line over a picture its pale edge is.
pub(super) const EDGE: f64 = 2.4;

/// The size at which a title of an axis fits beside a frame that is `length` long.
pub(super) fn title_size(title: &str, length: f64) -> f64 {
    let needed = text::width(title, NORMAL);
    (NORMAL * ((length + 36.0) / needed).min(1.0)).max(9.0)
}
