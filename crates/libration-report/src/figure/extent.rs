//! Ranges of a panel.

use super::axis::{Scale, Span};
use super::mark::{Across, Shape};
use super::mark_geometry::edges;
use super::panel::Panel;

/// The horizontal and vertical ranges of a panel with a frame of this aspect.
pub(super) fn spans(panel: &Panel, aspect: f64) -> [Span; 2] {
    let (mut xs, mut ys) = (Vec::new(), Vec::new());
    let (mut dots, mut filled) = (false, false);
    for mark in &panel.marks {
        match &mark.shape {
            Shape::Line { x, y } => both(x, y, panel, &mut xs, &mut ys),
            Shape::Points { x, y } => {
                dots = true;
                both(x, y, panel, &mut xs, &mut ys);
            }
            Shape::Envelope(e) => {
                both(&e.x, &e.low, panel, &mut xs, &mut ys);
                both(&e.x, &e.high, panel, &mut xs, &mut ys);
            }
            Shape::Raster { grid, .. } => {
                filled = true;
                xs.extend(edges(&grid.x, panel.x.scale));
                ys.extend(edges(&grid.y, panel.y.scale));
            }
            Shape::Contour { grid, .. } => {
                xs.extend(&grid.x);
                ys.extend(&grid.y);
            }
            Shape::Region { x, y } => both(x, y, panel, &mut xs, &mut ys),
            Shape::Rule { across: Across::Horizontal, at } => ys.push(*at),
            Shape::Rule { across: Across::Vertical, at } => xs.push(*at),
            Shape::Note { x, y } => both(&[*x], &[*y], panel, &mut xs, &mut ys),
        }
    }
    let air = |share: f64| if filled { 0.0 } else { share };
    let x = panel.x.span(xs.into_iter(), air(if dots || panel.equal { 0.03 } else { 0.0 }));
    let y = panel.y.span(ys.into_iter(), air(0.05));
    let linear = x.scale == Scale::Linear && y.scale == Scale::Linear;
    if panel.equal && linear { equal(x, y, aspect) } else { [x, y] }
}

/// Collects the values of points with a place within the set ranges.
fn both(x: &[f64], y: &[f64], panel: &Panel, xs: &mut Vec<f64>, ys: &mut Vec<f64>) {
    let within = |range: Option<[f64; 2]>, v: f64| range.is_none_or(|[a, b]| v >= a && v <= b);
    for (&x, &y) in x.iter().zip(y) {
        let shown = panel.x.scale.of(x).is_finite() && panel.y.scale.of(y).is_finite();
        if shown && within(panel.x.range, x) && within(panel.y.range, y) {
            xs.push(x);
            ys.push(y);
        }
    }
}

/// Widens one range until a unit has the same length on both axes.
fn equal(mut x: Span, mut y: Span, aspect: f64) -> [Span; 2] {
    let ratio = (x.high - x.low) / (y.high - y.low) / aspect;
    if ratio < 1.0 {
        x.widen(1.0 / ratio);
    } else {
        y.widen(ratio);
    }
    [x, y]
}
