//! The frame of a panel.

use super::axis::Ruler;
use super::geometry::Rect;

/// The place of a panel on the page.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    pub(super) rect: Rect,
    pub(super) x: Ruler,
    pub(super) y: Ruler,
}
