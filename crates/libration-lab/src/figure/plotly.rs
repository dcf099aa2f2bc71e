//! Figures for Plotly.js, from the same layout.

use serde_json::{Value, json};

use super::axis::{Axis, Ruler, Scale};
use super::color::ColorMap;
use super::drawn::{contour, edges, runs};
use super::label::Label;
use super::layout::{Bar, LABEL, Layout, NORMAL, Placed, SMALL, WIDTH};
use super::mark::{Across, Mark, Shape};
use super::panel::Figure;
use super::style::{Marker, Style};
use super::text;
use super::ticks::Tick;

/// Data and layout for Plotly.js, for a drawing as wide as `width`. Colours are `var(--name)`, or
/// `var(--name)/opacity`: the script of the page puts in those of the reader's preference.
pub fn plotly(figure: &Figure) -> Value {
    let layout = Layout::of(figure);
    let height = layout.height;
    let mut data = Vec::new();
    let mut annotations = Vec::new();
    let mut shapes = Vec::new();
    let mut out = json!({
        "width": WIDTH, "height": height,
        "margin": {"l": 0, "r": 0, "t": 0, "b": 0, "pad": 0},
        "paper_bgcolor": "rgba(0,0,0,0)", "plot_bgcolor": "rgba(0,0,0,0)",
        "font": {"family": "system-ui, -apple-system, 'Segoe UI', sans-serif", "size": SMALL, "color": "var(--soft)"},
        "hoverlabel": {"bgcolor": "var(--page)", "bordercolor": "var(--soft)", "font": {"size": NORMAL, "color": "var(--ink)"}},
        "showlegend": false, "hovermode": "closest", "dragmode": "zoom",
    });
    for (index, placed) in layout.panels.iter().enumerate() {
        let n = Number(index);
        out[n.key("xaxis")] =
            axis(&placed.panel.x, &placed.frame.x, &placed.x_ticks, WIDTH, &n.key("y"));
        out[n.key("yaxis")] =
            axis(&placed.panel.y, &placed.frame.y, &placed.y_ticks, height, &n.key("x"));
        for mark in &placed.panel.marks {
            traces(mark, placed, n, height, &mut data);
            if let Shape::Rule { across, at } = mark.shape {
                shapes.push(rule(mark, across, at, n));
            }
        }
        annotations.extend(titles(placed, height));
        annotations.extend(placed.labels.iter().map(|label| annotation(label, placed, n)));
    }
    for entry in &layout.legend {
        annotations.push(words(
            entry.text,
            [entry.text_x, entry.y],
            height,
            NORMAL,
            "ink",
            "left",
            0,
        ));
        let color = color(&entry.mark.style);
        let (from, to) = (entry.x, entry.text_x - 7.0);
        let paper = |x: f64, y: f64| (x / WIDTH, 1.0 - y / height);
        let dots = matches!(entry.mark.shape, Shape::Points { .. });
        let areas = matches!(entry.mark.shape, Shape::Envelope(_) | Shape::Region { .. });
        let reach = if dots { entry.mark.style.radius } else { 5.0 };
        let (left, right) =
            if dots { (from + 5.0 - reach, from + 5.0 + reach) } else { (from, to) };
        let (x0, y0) = paper(left, entry.y - if dots || areas { reach } else { 0.0 });
        let (x1, y1) = paper(right, entry.y + if dots || areas { reach } else { 0.0 });
        let kind = if dots {
            "circle"
        } else if areas {
            "rect"
        } else {
            "line"
        };
        let filled = dots && entry.mark.style.marker != Marker::OpenCircle;
        let fill = if filled {
            color.clone()
        } else if areas {
            format!("{color}/0.16")
        } else {
            "rgba(0,0,0,0)".into()
        };
        let width = if dots { 1.1 } else { entry.mark.style.width };
        shapes.push(json!({"type": kind, "xref": "paper", "yref": "paper", "x0": x0, "x1": x1, "y0": y0, "y1": y1,
            "fillcolor": fill, "line": {"color": color, "width": width, "dash": dash(&entry.mark.style)}}));
    }
    out["annotations"] = annotations.into();
    out["shapes"] = shapes.into();
    json!({ "data": data, "layout": out })
}

/// The number of a panel in the names of its axes.
#[derive(Debug, Clone, Copy)]
struct Number(usize);

impl Number {
    fn key(self, name: &str) -> String {
        if self.0 == 0 { name.to_owned() } else { format!("{name}{}", self.0 + 1) }
    }
}

fn axis(axis: &Axis, ruler: &Ruler, ticks: &[Tick], length: f64, anchor: &str) -> Value {
    let (from, to) = (ruler.from / length, ruler.to / length);
    // Ordinates count from the foot of the page.
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
        "zeroline": false, "ticks": "", "ticklabelstandoff": 3,
        "tickfont": {"size": SMALL, "color": "var(--soft)"},
    })
}

fn color(style: &Style) -> String {
    format!("var(--{})", style.ink.name())
}

fn dash(style: &Style) -> String {
    let lengths: Vec<String> = style.dashes().iter().map(|length| format!("{length}px")).collect();
    if lengths.is_empty() { "solid".into() } else { lengths.join(",") }
}

/// A list in which what has no place on the axis is `null`.
fn values(values: &[f64], scale: Scale) -> Vec<Option<f64>> {
    values.iter().map(|&v| scale.of(v).is_finite().then_some(v)).collect()
}

fn traces(mark: &Mark, placed: &Placed<'_>, n: Number, height: f64, data: &mut Vec<Value>) {
    let panel = placed.panel;
    let (xs, ys) = (panel.x.scale, panel.y.scale);
    let base = |kind: &str| {
        json!({"type": kind, "xaxis": n.key("x"), "yaxis": n.key("y"),
            "name": mark.label.as_deref().map(text::html).unwrap_or_default(),
            "hovertemplate": hover(mark, panel.x.title(), panel.y.title())})
    };
    let line =
        |color: &str| json!({"color": color, "width": mark.style.width, "dash": dash(&mark.style)});
    let color = color(&mark.style);
    match &mark.shape {
        Shape::Line { x, y } => {
            let mut trace = base("scatter");
            trace["mode"] = "lines".into();
            trace["x"] = json!(values(x, xs));
            trace["y"] = json!(values(y, ys));
            trace["line"] = line(&color);
            data.push(trace);
        }
        Shape::Points { x, y } => {
            let mut trace = base("scatter");
            trace["mode"] = "markers".into();
            trace["cliponaxis"] = false.into();
            trace["x"] = json!(values(x, xs));
            trace["y"] = json!(values(y, ys));
            trace["marker"] = marker(&mark.style, &color);
            data.push(trace);
        }
        Shape::Envelope(e) => {
            let shown = |i: usize| {
                xs.of(e.x[i]).is_finite()
                    && ys.of(e.low[i]).is_finite()
                    && ys.of(e.high[i]).is_finite()
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
                    &around(&e.x, &e.x),
                    &around(&e.high, &e.low),
                    mark,
                ));
            }
        }
        Shape::Region { x, y } => data.push(area(base("scatter"), x, y, mark)),
        Shape::Contour { grid, levels } => {
            for &level in levels {
                for corners in contour(grid, level, &placed.frame) {
                    let mut trace = base("scatter");
                    trace["mode"] = "lines".into();
                    trace["x"] = corners.iter().map(|p| p[0]).collect();
                    trace["y"] = corners.iter().map(|p| p[1]).collect();
                    trace["line"] = line(&color);
                    trace["name"] = format!("{level}").into();
                    data.push(trace);
                }
            }
        }
        Shape::Raster { grid, .. } => {
            let Some(bar) = &placed.bar else { return };
            let mut trace = base("heatmap");
            trace["x"] = json!(edges(&grid.x, xs));
            trace["y"] = json!(edges(&grid.y, ys));
            let shade = |&z: &f64| Some(bar.ruler.span.scale.of(z)).filter(|z| z.is_finite());
            let row = |row: &[f64]| row.iter().map(shade).collect::<Vec<_>>();
            let rows = || grid.z.chunks(grid.x.len().max(1));
            trace["z"] = json!(rows().map(row).collect::<Vec<_>>());
            trace["customdata"] = json!(rows().collect::<Vec<_>>());
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

/// What is read where the reader points: enough digits to compare, and the unit.
fn hover(mark: &Mark, x: String, y: String) -> String {
    let name = mark.label.as_deref().map(|label| format!("<b>{}</b><br>", text::html(label)));
    let name = name.unwrap_or_default();
    let (x, y) = (text::html(&x), text::html(&y));
    match &mark.shape {
        Shape::Raster { colors, .. } => format!(
            "{x}: %{{x:.6~g}}<br>{y}: %{{y:.6~g}}<br>{}: %{{customdata:.7~g}}<extra></extra>",
            text::html(&colors.title())
        ),
        _ => format!("{name}{x}: %{{x:.8~g}}<br>{y}: %{{y:.8~g}}<extra></extra>"),
    }
}

fn marker(style: &Style, color: &str) -> Value {
    let (symbol, size) = match style.marker {
        Marker::OpenCircle | Marker::Circle => ("circle", 2.0),
        Marker::Square => ("square", 1.8),
        Marker::Diamond => ("diamond", 1.9),
        Marker::Triangle => ("triangle-up", 2.0),
        Marker::Cross => ("x-thin-open", 2.0),
        Marker::Plus => ("cross-thin-open", 2.4),
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

fn area(mut trace: Value, x: &[f64], y: &[f64], mark: &Mark) -> Value {
    let color = color(&mark.style);
    let closed =
        |values: &[f64]| -> Vec<f64> { values.iter().chain(values.first()).copied().collect() };
    trace["mode"] = "lines".into();
    trace["fill"] = "toself".into();
    trace["hoveron"] = "points".into();
    trace["fillcolor"] = format!("{color}/0.16").into();
    trace["line"] = json!({"color": color, "width": mark.style.width});
    trace["x"] = closed(x).into();
    trace["y"] = closed(y).into();
    trace
}

fn rule(mark: &Mark, across: Across, at: f64, n: Number) -> Value {
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

fn colorscale(map: ColorMap) -> Value {
    let stop =
        |(i, [r, g, b]): (usize, [u8; 3])| json!([i as f64 / 10.0, format!("rgb({r},{g},{b})")]);
    map.stops().into_iter().enumerate().map(stop).collect()
}

fn colorbar(bar: &Bar<'_>, height: f64) -> Value {
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

/// Text at a place on the page.
fn words(
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

fn titles(placed: &Placed<'_>, height: f64) -> Vec<Value> {
    let rect = placed.frame.rect;
    let (x, y) = (rect.x + rect.width / 2.0, rect.y + rect.height / 2.0);
    let base = 0.35 * NORMAL;
    let mut out = vec![
        words(
            &placed.panel.x.title(),
            [x, rect.bottom() + 39.0 - base],
            height,
            NORMAL,
            "soft",
            "center",
            0,
        ),
        words(
            &placed.panel.y.title(),
            [placed.numbers - 9.0 - base, y],
            height,
            NORMAL,
            "soft",
            "center",
            -90,
        ),
    ];
    if let Some(title) = &placed.panel.title {
        let mut head =
            words(title, [rect.x, rect.y - 10.0 - base], height, LABEL, "ink", "left", 0);
        head["font"]["weight"] = 600.into();
        out.push(head);
    }
    if let Some(bar) = &placed.bar {
        let at = [bar.title() - base, y];
        out.push(words(&bar.colors.title(), at, height, NORMAL, "soft", "center", -90));
    }
    out
}

/// A label that stays with its place on the mark when the reader zooms.
fn annotation(label: &Label, placed: &Placed<'_>, n: Number) -> Value {
    let (x, y) = (&placed.frame.x, &placed.frame.y);
    // The inverse of the ruler, on the scale of the axis, which annotations want.
    let back = |r: &Ruler, at: f64| {
        r.span.low + (at - r.from) / (r.to - r.from) * (r.span.high - r.span.low)
    };
    json!({"text": text::html(&label.text), "xref": n.key("x"), "yref": n.key("y"),
        "x": back(x, label.anchor[0]), "y": back(y, label.anchor[1]),
        "xshift": label.at[0] - label.anchor[0], "yshift": label.anchor[1] - label.at[1],
        "xanchor": "left", "yanchor": "middle", "showarrow": false, "borderpad": 0,
        "font": {"size": label.size, "weight": if label.bold { 600 } else { 400 },
            "color": format!("var(--{})", label.ink.name())}})
}
