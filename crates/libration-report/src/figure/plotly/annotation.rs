//! Titles and labels as annotations of Plotly.

use serde_json::{Value, json};

use super::Number;
use crate::figure::axis::Ruler;
use crate::figure::label::Label;
use crate::figure::layout::PanelLayout;
use crate::figure::sizes::{LABEL, NORMAL, WIDTH, title_size};
use crate::text;

/// Text at a place on the page.
pub(super) fn annotation(
    text: &str,
    [x, y]: [f64; 2],
    height: f64,
    size: f64,
    ink: &str,
    anchor: &str,
    angle: i32,
) -> Value {
    json!({"text": text::html(text), "xref": "paper", "yref": "paper", "x": x / WIDTH, "y": 1.0 - y / height,
        "xanchor": anchor, "yanchor": "middle", "textangle": angle, "showarrow": false, "borderpad": 0,
        "font": {"size": size, "color": format!("var(--{ink})")}})
}

/// The titles of a panel, of its axes and of its colour bar.
pub(super) fn titles(placed: &PanelLayout<'_>, height: f64) -> Vec<Value> {
    let rect = placed.frame.rect;
    let (x, y) = (rect.x + rect.width / 2.0, rect.y + rect.height / 2.0);
    // Texts stand on a line in SVG and about their middle here.
    let base = 0.35 * NORMAL;
    let title = |text: &str, length: f64, at: [f64; 2], angle: i32| {
        annotation(text, at, height, title_size(text, length), "soft", "center", angle)
    };
    let foot = [x, rect.bottom() + 39.0 - base];
    let mut out = vec![
        title(&placed.panel.x.title(), rect.width, foot, 0),
        title(&placed.panel.y.title(), rect.height, [placed.numbers - 9.0 - base, y], -90),
    ];
    if let Some(text) = &placed.panel.title {
        let mut head =
            annotation(text, [rect.x, rect.y - 10.0 - base], height, LABEL, "ink", "left", 0);
        head["font"]["weight"] = 600.into();
        out.push(head);
    }
    if let Some(bar) = &placed.bar {
        out.push(title(&bar.colors.title(), rect.height, [bar.title() - base, y], -90));
    }
    out
}

/// A label that stays with its place on the mark when the reader zooms.
pub(super) fn label(label: &Label, placed: &PanelLayout<'_>, n: Number) -> Value {
    let (x, y) = (&placed.frame.x, &placed.frame.y);
    // The inverse of the ruler, on the scale of the axis, which annotations want.
    let back = |r: &Ruler, at: f64| {
        r.span.low + (at - r.from) / (r.to - r.from) * (r.span.high - r.span.low)
    };
    let ink = format!("var(--{})", label.role.name());
    let (right, down) = (label.at[0] - label.anchor[0], label.at[1] - label.anchor[1]);
    let mut out = json!({"text": text::html(&label.text), "xref": n.key("x"), "yref": n.key("y"),
        "x": back(x, label.anchor[0]), "y": back(y, label.anchor[1]),
        "xanchor": "left", "yanchor": "middle", "borderpad": 0,
        "font": {"size": label.size, "weight": if label.bold { 600 } else { 400 }, "color": ink}});
    let more = if label.leader().is_some() {
        json!({"showarrow": true, "arrowhead": 0, "arrowwidth": 0.8, "arrowcolor": format!("{ink}/0.6"),
            "axref": "pixel", "ayref": "pixel", "ax": right, "ay": down})
    } else {
        json!({"showarrow": false, "xshift": right, "yshift": -down})
    };
    if let (Value::Object(out), Value::Object(more)) = (&mut out, more) {
        out.extend(more);
        if !label.outside {
            out.insert("bgcolor".into(), "var(--page)/0.6".into());
        }
    }
    out
}
