//! Marks as traces of Plotly.

use serde_json::{Value, json};

use super::rounding::{PLACE_DIGITS, VALUE_DIGITS, place, rounded, shade};
use super::{Number, color, dash};
use crate::figure::axis::{Scale, Span};
use crate::figure::color::ColorMap;
use crate::figure::layout::{ColorBar, PanelLayout};
use crate::figure::mark::{Mark, Shape};
use crate::figure::mark_geometry::{contour, edges, runs};
use crate::figure::sizes::{EDGE, SMALL, WIDTH};
use crate::figure::style::{Marker, Style};
use crate::figure::ticks::Tick;
use crate::text;

/// A list in which what has no place on the axis is `null`.
fn places(values: &[f64], span: &Span) -> Vec<Option<f64>> {
    values.iter().map(|&v| span.scale.of(v).is_finite().then(|| place(v, span))).collect()
}

/// The traces of a mark.
pub(super) fn traces(
    mark: &Mark,
    placed: &PanelLayout<'_>,
    n: Number,
    height: f64,
    data: &mut Vec<Value>,
) {
    let panel = placed.panel;
    let (xs, ys) = (&placed.frame.x.span, &placed.frame.y.span);
    let base = |kind: &str| {
        json!({"type": kind, "xaxis": n.key("x"), "yaxis": n.key("y"),
            "name": mark.label.as_deref().map(text::html).unwrap_or_default(),
            "hovertemplate": hover(mark, panel.x.title(), panel.y.title())})
    };
    let line = |color: &str| json!({"color": color, "width": mark.style.width, "dash": dash(&mark.style), "simplify": false});
    let color = color(&mark.style);
    match &mark.shape {
        Shape::Line { x, y } => {
            let mut trace = base("scatter");
            trace["mode"] = "lines".into();
            trace["x"] = json!(places(x, xs));
            trace["y"] = json!(places(y, ys));
            trace["line"] = line(&color);
            data.push(trace);
        }
        Shape::Points { x, y } => {
            let mut trace = base("scatter");
            trace["mode"] = "markers".into();
            trace["cliponaxis"] = false.into();
            trace["x"] = json!(places(x, xs));
            trace["y"] = json!(places(y, ys));
            trace["marker"] = marker(&mark.style, &color);
            data.push(trace);
        }
        Shape::Envelope(e) => {
            let shown = |i: usize| {
                xs.scale.of(e.x[i]).is_finite()
                    && ys.scale.of(e.low[i]).is_finite()
                    && ys.scale.of(e.high[i]).is_finite()
            };
            for run in runs(e.x.len().min(e.low.len()).min(e.high.len()), shown) {
                let around = |there: &[f64], back: &[f64]| -> Vec<f64> {
                    there[run.clone()]
                        .iter()
                        .chain(back[run.clone()].iter().rev())
                        .copied()
                        .collect()
                };
                data.push(area(
                    base("scatter"),
                    [&around(&e.x, &e.x), &around(&e.high, &e.low)],
                    [xs, ys],
                    mark,
                ));
            }
        }
        Shape::Region { x, y } => data.push(area(base("scatter"), [x, y], [xs, ys], mark)),
        Shape::Contour { grid, levels } => {
            for &level in levels {
                for corners in contour(grid, level, &placed.frame) {
                    let mut trace = base("scatter");
                    trace["mode"] = "lines".into();
                    trace["x"] = corners.iter().map(|p| place(p[0], xs)).collect();
                    trace["y"] = corners.iter().map(|p| place(p[1], ys)).collect();
                    trace["line"] = line(&color);
                    trace["name"] = format!("{level}").into();
                    data.push(trace);
                }
            }
        }
        Shape::Raster { grid, .. } => {
            let Some(bar) = &placed.bar else { return };
            let mut trace = base("heatmap");
            trace["x"] = json!(places(&edges(&grid.x, xs.scale), xs));
            trace["y"] = json!(places(&edges(&grid.y, ys.scale), ys));
            let colors = bar.ruler.span;
            let rows = |of: &dyn Fn(f64) -> f64| -> Value {
                let finite = |&z: &f64| Some(of(z)).filter(|z| z.is_finite());
                let row = |row: &[f64]| row.iter().map(finite).collect::<Vec<_>>();
                grid.z.chunks(grid.x.len().max(1)).map(row).collect()
            };
            match colors.scale {
                Scale::Linear => trace["z"] = rows(&|z| shade(z, &colors, VALUE_DIGITS)),
                // Colours follow logarithms; the text beside the pointer shows values.
                Scale::Log => {
                    trace["z"] = rows(&|z| shade(colors.scale.of(z), &colors, 1));
                    trace["customdata"] = rows(&|z| rounded(z, f64::INFINITY, VALUE_DIGITS));
                }
            }
            trace["colorscale"] = colorscale(bar.colors.map);
            trace["zmin"] = bar.ruler.span.low.into();
            trace["zmax"] = bar.ruler.span.high.into();
            trace["hoverongaps"] = false.into();
            trace["colorbar"] = colorbar(bar, height);
            data.push(trace);
        }
        Shape::Rule { .. } | Shape::Note { .. } => {}
    }
}

/// Puts a pale edge below each line, as over pictures in SVG.
pub(super) fn edged(traces: Vec<Value>) -> Vec<Value> {
    let mut out = Vec::with_capacity(traces.len());
    for trace in traces {
        if trace["mode"] == "lines" && trace["fill"].is_null() {
            let mut edge = trace.clone();
            let width = trace["line"]["width"].as_f64().unwrap_or(0.0) + EDGE;
            edge["line"] = json!({"color": "var(--page)/0.75", "width": width, "simplify": false});
            edge["hoverinfo"] = "skip".into();
            edge["hovertemplate"] = Value::Null;
            out.push(edge);
        }
        out.push(trace);
    }
    out
}

/// The text beside the pointer: enough digits to compare, and the unit.
fn hover(mark: &Mark, x: String, y: String) -> String {
    let name = mark.label.as_deref().map(|label| format!("<b>{}</b><br>", text::html(label)));
    let name = name.unwrap_or_default();
    let (x, y) = (text::html(&x), text::html(&y));
    match &mark.shape {
        Shape::Raster { colors, .. } => format!(
            "{x}: %{{x:.6~g}}<br>{y}: %{{y:.6~g}}<br>{}: %{{{}:.{VALUE_DIGITS}~g}}<extra></extra>",
            text::html(&colors.title()),
            if colors.scale == Scale::Log { "customdata" } else { "z" },
        ),
        _ => format!(
            "{name}{x}: %{{x:.{PLACE_DIGITS}~g}}<br>{y}: %{{y:.{PLACE_DIGITS}~g}}<extra></extra>"
        ),
    }
}

fn marker(style: &Style, color: &str) -> Value {
    let (symbol, size) = match style.marker {
        Marker::OpenCircle | Marker::Circle => ("circle", 2.0),
        Marker::Square => ("square", 1.8),
        Marker::Diamond => ("diamond", 1.9),
        Marker::Triangle => ("triangle-up", 2.3),
        Marker::Cross => ("x-thin-open", 2.0),
        Marker::Plus => ("cross-thin-open", 1.7),
    };
    let open = style.marker == Marker::OpenCircle;
    let width = match style.marker {
        Marker::OpenCircle => 1.1,
        Marker::Cross | Marker::Plus => 1.4,
        _ => 0.0,
    };
    let fill = if open { "var(--page)" } else { color };
    json!({"symbol": symbol, "size": size * style.radius, "color": fill, "opacity": 1,
        "line": {"color": color, "width": width}})
}

fn area(mut trace: Value, [x, y]: [&[f64]; 2], [xs, ys]: [&Span; 2], mark: &Mark) -> Value {
    let color = color(&mark.style);
    let closed = |values: &[f64], span: &Span| -> Vec<f64> {
        values.iter().chain(values.first()).map(|&v| place(v, span)).collect()
    };
    trace["mode"] = "lines".into();
    trace["fill"] = "toself".into();
    trace["hoveron"] = "points".into();
    trace["fillcolor"] = format!("{color}/0.16").into();
    trace["line"] = json!({"color": color, "width": mark.style.width, "simplify": false});
    trace["x"] = closed(x, xs).into();
    trace["y"] = closed(y, ys).into();
    trace
}

fn colorscale(map: ColorMap) -> Value {
    let stop =
        |(i, [r, g, b]): (usize, [u8; 3])| json!([i as f64 / 10.0, format!("rgb({r},{g},{b})")]);
    map.stops().into_iter().enumerate().map(stop).collect()
}

fn colorbar(bar: &ColorBar<'_>, height: f64) -> Value {
    let named: Vec<&Tick> = bar.ticks.iter().filter(|tick| !tick.label.is_empty()).collect();
    json!({
        "x": bar.rect.x / WIDTH, "xanchor": "left", "xpad": 0, "ypad": 0, "outlinewidth": 0,
        "y": 1.0 - bar.rect.bottom() / height, "yanchor": "bottom",
        "len": bar.rect.height, "lenmode": "pixels", "thickness": bar.rect.width,
        "ticks": "outside", "ticklen": 3, "tickcolor": "var(--soft)",
        "tickmode": "array",
        "tickvals": named.iter().map(|tick| bar.colors.scale.of(tick.value)).collect::<Vec<_>>(),
        "ticktext": named.iter().map(|tick| text::html(&tick.label)).collect::<Vec<_>>(),
        "tickfont": {"size": SMALL, "color": "var(--soft)"},
    })
}

#[cfg(test)]
mod tests {
    use crate::figure::{Axis, Colors, Figure, Grid, Mark, Panel, plotly};

    #[test]
    fn a_raster_has_its_values_once_and_on_a_logarithmic_scale_beside_their_logarithms() {
        let raster = |colors: Colors| {
            let value = |x: f64, y: f64| if x * y > 3.0 { 0.0 } else { x * y / 3.0 };
            let grid = Grid::sample([1.0, 2.0], [1.0, 2.0], value);
            let panel = Panel::new(Axis::linear("x"), Axis::linear("y"));
            let figure = Figure::new("x", "").panel(panel.mark(Mark::raster(grid, colors)));
            plotly(&figure)["data"][0].clone()
        };
        let linear = raster(Colors::new("z"));
        assert!(linear["customdata"].is_null() && linear["z"][0][1] == 0.6666667);
        assert!(linear["hovertemplate"].as_str().unwrap().contains("%{z:.7~g}"));
        let log = raster(Colors::new("z").log());
        assert!(log["customdata"][0][1] == 0.6666667 && log["z"][1][1].is_null());
        assert!((log["z"][0][1].as_f64().unwrap() - (2.0_f64 / 3.0).log10()).abs() < 1e-4);
        assert!(log["hovertemplate"].as_str().unwrap().contains("%{customdata:.7~g}"));
    }
}
