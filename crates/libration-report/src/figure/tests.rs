//! Claims about whole figures.

use std::collections::HashSet;

use super::layout::FigureLayout;
use super::mark_geometry::MarkGeometry;
use super::sizes::WIDTH;
use super::*;
use crate::text;

fn figure(panel: Panel) -> Figure {
    Figure::new("fig-1", "A title").description("A description").panel(panel)
}

/// The path data of all elements of a class.
fn paths(svg: &str, class: &str) -> Vec<String> {
    let document = roxmltree::Document::parse(svg).expect("well-formed");
    let of_class = document.descendants().filter(|node| node.attribute("class") == Some(class));
    of_class.filter_map(|node| node.attribute("d").map(str::to_owned)).collect()
}

/// The numbers of a part of a path, in pairs.
fn pairs(part: &str) -> Vec<[f64; 2]> {
    let spaced = part.replace('-', " -");
    let numbers: Vec<f64> = spaced.split_whitespace().map(|n| n.parse().unwrap()).collect();
    numbers.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect()
}

/// The starts of the parts of a path.
fn starts(d: &str) -> Vec<[f64; 2]> {
    let start = |part: &str| pairs(part.split(char::is_alphabetic).next().unwrap())[0];
    d.split('M').skip(1).map(start).collect()
}

/// The corners of a path of straight lines.
fn corners(d: &str) -> Vec<[f64; 2]> {
    let mut corners = Vec::new();
    for part in d.split('M').skip(1) {
        let (start, ways) = part.split_once('l').unwrap_or((part, ""));
        let mut at = pairs(start)[0];
        corners.push(at);
        for [right, down] in pairs(ways.trim_end_matches('Z')) {
            at = [at[0] + right, at[1] + down];
            corners.push(at);
        }
    }
    corners
}

/// Where Plotly will draw a value: from its domain, range and type, in pixels from the left or top.
fn plotly_place(layout: &serde_json::Value, axis: &str, value: f64) -> f64 {
    let of = |key: &str, end: usize| layout[axis][key][end].as_f64().unwrap();
    let value = if layout[axis]["type"] == "log" { value.log10() } else { value };
    let share = (value - of("range", 0)) / (of("range", 1) - of("range", 0));
    let place = of("domain", 0) + share * (of("domain", 1) - of("domain", 0));
    if axis.starts_with('x') {
        place * WIDTH
    } else {
        (1.0 - place) * layout["height"].as_f64().unwrap()
    }
}

fn busy() -> Figure {
    let x = vec![1e-3, 1e-2, 1e-1];
    let grid = Grid::sample([0.0, 1.0, 2.0], [0.0, 1.0], |x, y| x - y);
    let words = "a < b & \"c\" ]]> </script> \u{7} 10^{-3}";
    let first = Panel::new(Axis::log(words).unit(words), Axis::log(words))
        .title(words)
        .mark(Mark::line(x.clone(), vec![1e-16, 1e-12, 1e-3]).role(Role::Rk4).label(words))
        .mark(Mark::prediction(x.clone(), vec![2e-16, 3e-12, 5e-3]).label("predicted"))
        .mark(Mark::vertical(0.02).label("limit"));
    let second = Panel::new(Axis::linear("x").unit("m"), Axis::linear("y").unit("m"))
        .mark(Mark::raster(grid.clone(), Colors::new(words).unit("J")))
        .mark(Mark::contour(grid, [0.5]).role(Role::Theory))
        .mark(Mark::envelope(Envelope::of(&[0.0, 1.0, 2.0], &[0.1, 0.2, 0.1], 4)).label("band"))
        .mark(Mark::region([0.0, 1.0, 1.0], [0.0, 0.0, 1.0]).role(Role::Bad))
        .mark(Mark::note(0.5, 0.5, words));
    let mut figure = figure(first).panel(second).columns(2).number("9.1").caption(words);
    figure.title = words.into();
    figure
}

#[test]
fn a_logarithmic_axis_reaches_rounding() {
    let y = Axis::log("error").range(1e-16, 1.0);
    let line = Mark::line([0.0, 0.5, 2.0], [1e-16, 1e-8, 1.0]);
    let drawn = figure(Panel::new(Axis::linear("t"), y).mark(line));
    let svg = svg::inline(&drawn);
    let line = corners(&paths(&svg, "line")[0]);
    let frame = FigureLayout::of(&drawn).panels[0].frame.rect;
    assert!((line[0][1] - frame.bottom()).abs() < 0.06, "10⁻¹⁶ stands at the foot");
    assert!((line[1][1] - (frame.y + frame.height / 2.0)).abs() < 0.06, "10⁻⁸ in the middle");
    assert!((line[2][1] - frame.y).abs() < 0.06, "1 at the top");
    assert!(svg.contains("class=\"script\">−16</tspan>"), "and the foot is marked");
}

#[test]
fn what_is_not_finite_is_a_gap_in_both() {
    let x: Vec<f64> = (0..7).map(f64::from).collect();
    let y = [1.0, 2.0, f64::NAN, 2.0, 1.0, 0.0, 3.0];
    let lines =
        |y_axis: Axis| figure(Panel::new(Axis::linear("t"), y_axis).mark(Mark::line(x.clone(), y)));
    let linear = lines(Axis::linear("y"));
    assert_eq!(paths(&svg::inline(&linear), "line")[0].matches('M').count(), 2);
    let trace = &plotly(&linear)["data"][0];
    assert!(trace["y"][2].is_null() && trace["y"][5] == 0.0);
    // Zero has no place on a logarithmic axis; the single sample after it is no line.
    let log = lines(Axis::log("y"));
    assert!(plotly(&log)["data"][0]["y"][5].is_null());
    assert_eq!(corners(&paths(&svg::inline(&log), "line")[0]).len(), 4);
}

#[test]
fn labels_of_close_lines_do_not_overlap() {
    let x = [0.0, 1.0];
    let lines = (0..4).map(|i| {
        let end = 1.0 + f64::from(i) * 1e-3;
        Mark::line(x, [0.0, end]).role(Role::Accent(i as u8)).label(format!("line {i}"))
    });
    let drawn = figure(Panel::new(Axis::linear("t"), Axis::linear("y")).marks(lines));
    let layout = FigureLayout::of(&drawn);
    let labels = &layout.panels[0].labels;
    assert_eq!(labels.len(), 4, "all have a place on their line");
    for (index, label) in labels.iter().enumerate() {
        let rect = label.rect();
        assert!(rect.right() <= WIDTH && rect.y >= 0.0 && rect.bottom() <= layout.height);
        assert!(
            labels[..index].iter().all(|other| !other.rect().intersects(&rect)),
            "{}",
            label.text
        );
    }
    let heights: Vec<f64> = labels.iter().map(|label| label.at[1]).collect();
    assert!(heights.windows(2).all(|pair| pair[0] > pair[1]), "in the order of the lines");
}

#[test]
fn a_label_without_room_goes_to_the_legend() {
    let wall = (0..60).map(|i| Mark::line([0.0, 0.9], [f64::from(i), f64::from(i)]));
    let named = Mark::line([0.0, 0.9], [30.5, 30.5]).label("in the thick of it");
    let axis = Axis::linear("t").range(0.0, 1.0);
    let panel = Panel::new(axis, Axis::linear("y")).marks(wall).mark(named);
    let drawn = figure(panel.mark(Mark::line([0.9, 1.0], [0.0, 59.0])).mark(Mark::vertical(0.95)));
    let layout = FigureLayout::of(&drawn);
    assert_eq!(layout.legend.len(), 1);
    assert!(layout.panels[0].labels.is_empty());
}

#[test]
fn svg_is_well_formed_whatever_the_words() {
    for svg in [svg::inline(&busy()), svg::standalone(&busy())] {
        let document = roxmltree::Document::parse(&svg).expect("well-formed");
        let title = document.descendants().find(|node| node.has_tag_name("title"));
        let title = title.or_else(|| document.root_element().first_element_child());
        assert!(
            title.and_then(|node| node.text()).is_some_and(|text| text.contains("a < b & \"c\""))
        );
    }
}

#[test]
fn both_back_ends_show_the_same_places() {
    let drawn = busy();
    let (svg, interactive) = (svg::inline(&drawn), plotly(&drawn));
    let layout = &interactive["layout"];
    let expected = |trace: usize| -> Vec<[f64; 2]> {
        let trace = &interactive["data"][trace];
        let list = |key: &str| trace[key].as_array().unwrap().clone();
        let places = list("x").into_iter().zip(list("y"));
        places
            .map(|(x, y)| {
                let x = plotly_place(layout, "xaxis", x.as_f64().unwrap());
                [x, plotly_place(layout, "yaxis", y.as_f64().unwrap())]
            })
            .collect()
    };
    let near = |a: &[f64; 2], b: [f64; 2]| (a[0] - b[0]).abs() < 0.06 && (a[1] - b[1]).abs() < 0.06;
    let line = corners(&paths(&svg, "line")[0]);
    assert!(line.len() == 3 && line.iter().zip(expected(0)).all(|(a, b)| near(a, b)));
    // A circle starts at its left.
    let circles = starts(&paths(&svg, "open")[0]);
    let centres = circles.iter().map(|[x, y]| [x + Style::default().radius, *y]);
    assert!(centres.zip(expected(1)).all(|(a, b)| near(&a, b)) && circles.len() == 3);
    for (placed, [x, y]) in
        FigureLayout::of(&drawn).panels.iter().zip([["xaxis", "yaxis"], ["xaxis2", "yaxis2"]])
    {
        let shown = |axis: &str| [0, 1].map(|end| layout[axis]["range"][end].as_f64().unwrap());
        assert_eq!(shown(x), [placed.frame.x.span.low, placed.frame.x.span.high]);
        assert_eq!(shown(y), [placed.frame.y.span.low, placed.frame.y.span.high]);
    }
}

#[test]
fn a_contour_is_found_on_the_scale_of_the_axes() {
    let decades: Vec<f64> = (-4..=4).map(|e| 10_f64.powi(e)).collect();
    let grid = Grid::sample(decades.clone(), decades, |x, y| (x * y).log10());
    let panel = Panel::new(Axis::log("x"), Axis::log("y")).mark(Mark::contour(grid, [0.5]));
    let drawn = figure(panel);
    let layout = FigureLayout::of(&drawn);
    let MarkGeometry::Levels(levels) = &layout.panels[0].drawn[0] else { panic!("a contour") };
    let frame = layout.panels[0].frame;
    for [x, y] in levels.iter().flat_map(|(_, parts)| parts.iter().flatten()) {
        let decades = |share: f64, span: axis::Span| span.low + share * (span.high - span.low);
        let x = decades((x - frame.rect.x) / frame.rect.width, frame.x.span);
        let y = decades((frame.rect.bottom() - y) / frame.rect.height, frame.y.span);
        assert!((x + y - 0.5).abs() < 1e-9, "10^{x} · 10^{y} = 10^0.5, a straight line on paper");
    }
}

#[test]
fn a_contour_of_values_over_decades_is_found_in_their_logarithm() {
    let decades: Vec<f64> = (-4..=4).map(|e| 10_f64.powi(e)).collect();
    let grid = Grid::sample(decades.clone(), decades, |x, y| x * y);
    let panel = Panel::new(Axis::log("x"), Axis::log("y")).mark(Mark::contour(grid, [3.0]));
    let data = plotly(&figure(panel));
    let list = |key: &str| data["data"][0][key].as_array().unwrap().clone();
    for (x, y) in list("x").iter().zip(list("y")) {
        let product = x.as_f64().unwrap() * y.as_f64().unwrap();
        assert!((product / 3.0 - 1.0).abs() < 2e-8, "{x} · {y}");
    }
}

#[test]
fn one_unit_is_as_long_on_both_axes() {
    let portrait = Panel::new(Axis::linear("x"), Axis::linear("v")).equal();
    let drawn = figure(portrait.mark(Mark::line([-1.0, 3.0], [-1.0, 1.0])));
    let frame = FigureLayout::of(&drawn).panels[0].frame;
    let x = frame.rect.width / (frame.x.span.high - frame.x.span.low);
    let y = frame.rect.height / (frame.y.span.high - frame.y.span.low);
    assert!((x / y - 1.0).abs() < 1e-12, "{x} {y}");
}

#[test]
fn figures_of_one_page_share_no_id() {
    let other = Figure { id: "fig-2".into(), ..busy() };
    let ids: Vec<String> = [busy(), other]
        .iter()
        .flat_map(|figure| {
            let svg = svg::inline(figure);
            let document = roxmltree::Document::parse(&svg).unwrap();
            let ids = document.descendants().filter_map(|node| node.attribute("id"));
            ids.map(str::to_owned).collect::<Vec<String>>()
        })
        .collect();
    assert_eq!(ids.iter().collect::<HashSet<_>>().len(), ids.len(), "{ids:?}");
}

#[test]
fn a_file_stands_alone() {
    let svg = svg::standalone(&busy());
    assert!(!svg.contains("var("), "no custom property that a viewer would not know");
    assert!(svg.contains("#a8487f") && svg.contains("prefers-color-scheme:dark"));
    assert!(!scripts().replace("http://www.w3.org", "").contains("http"), "nothing is fetched");
}

#[test]
fn a_figure_serialises() {
    let json = serde_json::to_value(busy()).expect("serialises");
    assert_eq!(json["id"], "fig-1");
    assert_eq!(json["panels"][0]["y"]["scale"], "log");
    assert_eq!(json["panels"][0]["marks"][0]["style"]["ink"], "rk4");
    assert_eq!(json["panels"][0]["marks"][0]["shape"]["line"]["y"][0], 1e-16);
}

#[test]
fn an_empty_figure_and_empty_marks_are_drawn() {
    let nothing = Panel::new(Axis::log("x"), Axis::linear("y"))
        .mark(Mark::line([], []).label("nothing"))
        .mark(Mark::envelope(Envelope::default()))
        .mark(Mark::raster(Grid::sample([], [], |x, _| x), Colors::new("z")))
        .mark(Mark::contour(Grid::sample([], [], |x, _| x), [0.0]));
    for figure in [Figure::new("empty", "Nothing"), figure(nothing)] {
        roxmltree::Document::parse(&svg::standalone(&figure)).expect("well-formed");
        plotly(&figure);
    }
}

#[test]
fn a_long_title_fits_beside_its_axis() {
    let long = "the largest relative deviation of the energy from its value at the start, so far";
    let y = Axis::linear(long).unit("1");
    let drawn = figure(Panel::new(Axis::linear("t"), y).mark(Mark::line([0.0, 1.0], [0.0, 1.0])));
    let height = FigureLayout::of(&drawn.clone().aspect(2.0)).panels[0].frame.rect.height;
    let size = sizes::title_size(&drawn.panels[0].y.title(), height);
    assert!(text::width(long, size) < height + 40.0 && size >= 9.0, "{size}");
}

#[test]
fn marks_on_a_picture_have_the_colours_of_the_light() {
    let svg = svg::inline(&busy());
    assert!(svg.contains("class=\"ink-theory on-picture\""));
    assert!(svg.contains("class=\"ink-rk4\""), "and those beside it do not");
    let data = plotly(&busy())["data"].to_string();
    assert!(data.contains("light(--theory)") && data.contains("var(--rk4)"));
    assert!(svg::standalone(&busy()).contains(".plot .on-picture.ink-theory{color:#1b1f24}"));
}
