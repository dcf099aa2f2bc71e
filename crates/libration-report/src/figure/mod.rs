//! Figures: one description with two back ends.
//!
//! A [`Figure`] describes the data. [`svg::inline`] and [`svg::standalone`] draw it for a page and for a
//! file; [`plotly`] draws it interactively. Both use one layout: ranges, ticks, labels and contour lines
//! are computed once.
//!
//! ```
//! use libration_report::figure::{Axis, Figure, Role, Mark, Panel, embed, svg};
//!
//! let steps = [1e-3, 1e-2, 1e-1];
//! let panel = Panel::new(
//!     Axis::log("time step Δt").unit("s"),
//!     Axis::log("position error after 10 s").unit("m"),
//! )
//! .mark(Mark::line(steps, [1.1e-12, 1.0e-8, 1.0e-4]).role(Role::Rk4).label("RK4"))
//! .mark(Mark::prediction(steps, [1e-12, 1e-8, 1e-4]).label("predicted"));
//! let figure = Figure::new("fig-9-2", "The error of RK4 falls with the fourth power of the step.")
//!     .number("9.2")
//!     .caption("Line: measured. Circles: predicted.")
//!     .description("Log-log: a straight line of slope four.")
//!     .panel(panel);
//! assert!(embed(&figure).contains("Figure 9.2 —"));
//! assert!(svg::standalone(&figure).starts_with("<svg"));
//! ```

mod axis;
mod color;
mod envelope;
mod extent;
mod frame;
mod geometry;
mod grid;
mod label;
mod layout;
mod mark;
mod mark_geometry;
mod page;
mod palette;
mod panel;
mod plotly;
mod raster_image;
mod sizes;
mod style;
pub mod svg;
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
pub use style::{Dash, Marker, Role, Style};
