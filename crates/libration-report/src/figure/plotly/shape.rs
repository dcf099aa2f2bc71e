//! Rules, and the samples of the legend, as shapes of Plotly.

use serde_json::{Value, json};

use super::{Number, color, dash};
use crate::figure::grid::Grid;
use crate::figure::layout::{LegendEntry, PanelLayout};
use crate::figure::mark::{Across, Mark, Shape};
use crate::figure::mark_geometry::edges;
use crate::figure::sizes::WIDTH;
use crate::figure::style::Marker;

/// A straight line across a panel.
pub(super) fn rule(mark: &Mark, across: Across, at: f64, n: Number) -> Value {
    let line =
        json!({"color": color(&mark.style), "width": mark.style.width, "dash": dash(&mark.style)});
    match across {
        Across::Horizontal => {
            json!({"type": "line", "xref": format!("{} domain", n.key("x")), "yref": n.key("y"),
            "x0": 0, "x1": 1, "y0": at, "y1": at, "line": line})
        }
        Across::Vertical => {
            json!({"type": "line", "xref": n.key("x"), "yref": format!("{} domain", n.key("y")),
            "x0": at, "x1": at, "y0": 0, "y1": 1, "line": line})
        }
    }
}

/// The background of a picture where it has no value.
pub(super) fn blank(grid: &Grid, placed: &PanelLayout<'_>, n: Number) -> Option<Value> {
    let (x, y) = (edges(&grid.x, placed.panel.x.scale), edges(&grid.y, placed.panel.y.scale));
    Some(json!({"type": "rect", "layer": "below", "xref": n.key("x"), "yref": n.key("y"),
        "x0": x.first()?, "x1": x.last()?, "y0": y.first()?, "y1": y.last()?,
        "fillcolor": "var(--page)", "line": {"width": 0}}))
}

/// The sample of a mark in the legend.
pub(super) fn sample(entry: &LegendEntry<'_>, height: f64) -> Value {
    let style = &entry.mark.style;
    let color = color(style);
    let (middle, reach) = (entry.x + 5.0, style.radius);
    let none = "rgba(0,0,0,0)".to_owned();
    let (kind, [left, right], half, fill) = match entry.mark.shape {
        Shape::Points { .. } => {
            let kind = if style.marker == Marker::Square { "rect" } else { "circle" };
            let fill = if style.marker == Marker::OpenCircle { none } else { color.clone() };
            (kind, [middle - reach, middle + reach], reach, fill)
        }
        Shape::Envelope(_) | Shape::Region { .. } => {
            ("rect", [entry.x, entry.text_x - 7.0], 5.0, format!("{color}/0.16"))
        }
        _ => ("line", [entry.x, entry.text_x - 7.0], 0.0, none),
    };
    let mut out = json!({"type": kind, "xref": "paper", "yref": "paper",
        "x0": left / WIDTH, "x1": right / WIDTH,
        "y0": 1.0 - (entry.y - half) / height, "y1": 1.0 - (entry.y + half) / height, "fillcolor": fill,
        "line": {"color": color, "width": if half > 0.0 { 1.1 } else { style.width }, "dash": if half > 0.0 { "solid".into() } else { dash(style) }}});
    if let (Shape::Points { .. }, Some(path)) = (&entry.mark.shape, outline(style.marker, reach)) {
        out["type"] = "path".into();
        out["path"] = path.into();
        out["xsizemode"] = "pixel".into();
        out["ysizemode"] = "pixel".into();
        out["xanchor"] = (middle / WIDTH).into();
        out["yanchor"] = (1.0 - entry.y / height).into();
    }
    out
}

/// Markers that are neither circles nor squares, around their middle; up is positive.
fn outline(marker: Marker, r: f64) -> Option<String> {
    let at = |x: f64, y: f64| format!("{:.1},{:.1}", x * r, y * r);
    match marker {
        Marker::OpenCircle | Marker::Circle | Marker::Square => None,
        Marker::Diamond => {
            Some(format!("M{}L{}L{}L{}Z", at(0.0, 1.3), at(1.3, 0.0), at(0.0, -1.3), at(-1.3, 0.0)))
        }
        Marker::Triangle => {
            Some(format!("M{}L{}L{}Z", at(0.0, 1.2), at(1.1, -0.8), at(-1.1, -0.8)))
        }
        Marker::Cross => Some(format!(
            "M{}L{}M{}L{}",
            at(-1.0, 1.0),
            at(1.0, -1.0),
            at(-1.0, -1.0),
            at(1.0, 1.0)
        )),
        Marker::Plus => {
            Some(format!("M{}L{}M{}L{}", at(-1.2, 0.0), at(1.2, 0.0), at(0.0, 1.2), at(0.0, -1.2)))
        }
    }
}
