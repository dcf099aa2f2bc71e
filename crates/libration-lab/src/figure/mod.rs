//! Figures: one description, two back ends that draw the same.
//!
//! A [`Figure`] says what is to be seen. [`svg::inline`] and [`svg::standalone`] draw it for a page
//! and for a file; [`plotly`] gives the drawing one can look into. Both start from one layout:
//! ranges, ticks, places of labels and contour lines are computed once.

mod axis;
mod color;
mod drawn;
mod envelope;
mod extent;
mod geometry;
mod grid;
mod label;
mod layout;
mod mark;
mod page;
mod palette;
mod panel;
mod picture;
mod plotly;
mod style;
pub mod svg;
mod text;
mod ticks;

#[cfg(test)]
mod tests;

pub use axis::{Axis, Scale};
pub use color::{ColorMap, Colors};
pub use envelope::Envelope;
pub use grid::{Grid, Polyline};
pub use mark::{Across, Mark, Shape};
pub use page::{embed, scripts};
pub use palette::STYLESHEET;
pub use panel::{Figure, Panel};
pub use plotly::plotly;
pub use style::{Dash, Ink, Marker, Style};
