//! Figures for Plotly.js, from the same layout.

mod annotation;
mod rounding;
mod shape;
mod trace;

use serde_json::{Value, json};

use super::axis::{Axis, Ruler, Scale};
use super::layout::FigureLayout;
use super::mark::Shape;
use super::panel::Figure;
use super::sizes::{NORMAL, SMALL, WIDTH};
use super::style::Style;
use super::ticks::Tick;
use crate::text;

const FONT: &str = "system-ui, -apple-system, 'Segoe UI', sans-serif";

/// Data and layout for Plotly.js. Colours are `var(--name)` or `var(--name)/opacity`, which the script of
/// the page replaces by the preferred colour scheme, or `light(--name)` for the light scheme.
pub fn plotly(figure: &Figure) -> Value {
    let layout = FigureLayout::of(figure);
    let height = layout.height;
    let mut data = Vec::new();
    let mut annotations = Vec::new();
    let mut shapes = Vec::new();
    let mut out = json!({
        "width": WIDTH, "height": height,
        "margin": {"l": 0, "r": 0, "t": 0, "b": 0, "pad": 0},
        "paper_bgcolor": "rgba(0,0,0,0)", "plot_bgcolor": "rgba(0,0,0,0)",
        "font": {"family": FONT, "size": SMALL, "color": "var(--soft)"},
        "hoverlabel": {"bgcolor": "var(--page)", "bordercolor": "var(--soft)", "font": {"family": FONT, "size": NORMAL, "color": "var(--ink)"}},
        "showlegend": false, "hovermode": "closest", "dragmode": "zoom",
    });
    for (index, placed) in layout.panels.iter().enumerate() {
        let n = Number(index);
        out[n.key("xaxis")] =
            axis(&placed.panel.x, &placed.frame.x, &placed.x_ticks, WIDTH, &n.key("y"));
        out[n.key("yaxis")] =
            axis(&placed.panel.y, &placed.frame.y, &placed.y_ticks, height, &n.key("x"));
        let (mut traces, mut rules) = (Vec::new(), Vec::new());
        for mark in &placed.panel.marks {
            trace::traces(mark, placed, n, height, &mut traces);
            match &mark.shape {
                Shape::Rule { across, at } => rules.push(shape::rule(mark, *across, *at, n)),
                Shape::Raster { grid, .. } => rules.extend(shape::blank(grid, placed, n)),
                _ => {}
            }
        }
        let mut labels: Vec<Value> =
            placed.labels.iter().map(|label| annotation::label(label, placed, n)).collect();
        if placed.is_on_raster() {
            traces = trace::edged(traces);
            traces.iter_mut().chain(&mut rules).chain(&mut labels).for_each(always_light);
        }
        data.extend(traces);
        shapes.extend(rules);
        annotations.extend(annotation::titles(placed, height));
        annotations.extend(labels);
    }
    for entry in &layout.legend {
        let at = [entry.text_x, entry.y];
        annotations.push(annotation::annotation(entry.text, at, height, NORMAL, "ink", "left", 0));
        shapes.push(shape::sample(entry, height));
    }
    out["annotations"] = annotations.into();
    out["shapes"] = shapes.into();
    json!({ "data": data, "layout": out })
}

/// Sets the light colours of marks over a raster.
fn always_light(value: &mut Value) {
    match value {
        Value::String(text) if text.starts_with("var(--") => {
            *text = text.replacen("var(", "light(", 1);
        }
        Value::Object(fields) => {
            let own = |key: &str| !matches!(key, "hoverlabel" | "colorbar");
            fields.iter_mut().filter(|(key, _)| own(key)).for_each(|(_, v)| always_light(v));
        }
        _ => {}
    }
}

/// The index of a panel in the names of its axes.
#[derive(Debug, Clone, Copy)]
struct Number(usize);

impl Number {
    fn key(self, name: &str) -> String {
        if self.0 == 0 { name.to_owned() } else { format!("{name}{}", self.0 + 1) }
    }
}

fn axis(axis: &Axis, ruler: &Ruler, ticks: &[Tick], length: f64, anchor: &str) -> Value {
    let (from, to) = (ruler.from / length, ruler.to / length);
    // Ordinates count from the bottom of the page.
    let domain = if from < to { [from, to] } else { [1.0 - from, 1.0 - to] };
    let named: Vec<&Tick> = ticks.iter().filter(|tick| !tick.label.is_empty()).collect();
    let log = axis.scale == Scale::Log;
    json!({
        "type": if log { "log" } else { "linear" }, "domain": domain, "anchor": anchor,
        "range": [ruler.span.low, ruler.span.high], "autorange": false,
        "tickmode": "array",
        "tickvals": named.iter().map(|tick| tick.value).collect::<Vec<_>>(),
        "ticktext": named.iter().map(|tick| text::html(&tick.label)).collect::<Vec<_>>(),
        "exponentformat": "power", "minexponent": 4,
        "gridcolor": "var(--rule)", "linecolor": "var(--rule)", "showline": true, "mirror": true,
        "zeroline": false, "ticks": "", "ticklabelstandoff": 5,
        "tickfont": {"size": SMALL, "color": "var(--soft)"},
    })
}

fn color(style: &Style) -> String {
    format!("var(--{})", style.role.name())
}

fn dash(style: &Style) -> String {
    let lengths: Vec<String> = style.dashes().iter().map(|length| format!("{length}px")).collect();
    if lengths.is_empty() { "solid".into() } else { lengths.join(",") }
}
