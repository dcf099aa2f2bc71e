//! Looking into figures.

use serde_json::{Value, json};

use crate::page::{Page, Point, WIDTHS, visit};

/// The JavaScript for the `index`-th figure of the page.
fn figure(index: usize) -> String {
    format!("document.querySelectorAll('figure[data-figure]')[{index}]")
}

/// What the page calls its figures; there are some.
fn figures(page: &mut Page) -> Vec<String> {
    let names = page.texts(
        "[...document.querySelectorAll('figure[data-figure]')].map((f) => f.dataset.figure)",
    );
    assert!(!names.is_empty(), "the page has no figures");
    names
}

/// Of figures with the same kinds of traces on axes of the same kinds, in one panel or in several, the first: its place
/// and its name.
fn kinds(page: &mut Page) -> Vec<(usize, String)> {
    let kinds = page.texts(
        "Promise.all([...document.querySelectorAll('figure[data-figure]')].map(async (figure) => {
           const packed = atob(figure.querySelector('script').textContent);
           const bytes = new Blob([Uint8Array.from(packed, (c) => c.charCodeAt(0))]);
           const text = bytes.stream().pipeThrough(new DecompressionStream('deflate'));
           const { data, layout } = await new Response(text).json();
           const axes = Object.keys(layout).filter((key) => /axis/.test(key));
           const types = [...data.map((t) => t.type), ...axes.map((key) => key[0] + layout[key].type)];
           return [...new Set(types)].sort().join() + (axes.length > 2);
         }))",
    );
    let first = |i: &usize| !kinds[..*i].contains(&kinds[*i]);
    let found: Vec<_> = figures(page).into_iter().enumerate().filter(|(i, _)| first(i)).collect();
    assert!(found.len() > 5, "{found:?}");
    found
}

/// Presses a figure's button with the mouse, and waits for the drawing.
fn explore(page: &mut Page, index: usize) {
    let figure = figure(index);
    let button = page.bring(&format!("{figure}.querySelector('.tools button')"));
    page.click(button);
    let ready = "querySelector('.tools button').textContent === 'Done'";
    assert!(page.comes_true(&format!("{figure}.{ready}")), "{figure} does not open");
    page.bring(&format!("{figure}.querySelector('.canvas')"));
    page.frame();
}

#[test]
fn every_figure_is_drawn_before_anyone_asks() {
    for width in WIDTHS {
        visit(width, |page| {
            for (index, name) in figures(page).iter().enumerate() {
                let parts = page.eval(&format!(
                    "(() => {{
                       const svg = {}.querySelector('svg.plot'), box = svg.getBoundingClientRect();
                       const ink = svg.querySelectorAll('path, circle, rect, line, polyline, polygon, image');
                       const marks = [...ink].filter((e) => e.closest('[class*=ink-]') || e.matches('image'));
                       const visible = marks.filter((e) => {{
                         const {{ width, height }} = e.getBoundingClientRect();
                         const {{ fill, stroke }} = getComputedStyle(e);
                         return width + height > 0 && (e.matches('image') || fill !== 'none' || stroke !== 'none');
                       }});
                       return [box.width, box.height, marks.length, visible.length];
                     }})()",
                    figure(index)
                ));
                let [across, down, marks, visible] =
                    [0, 1, 2, 3].map(|i| parts[i].as_f64().unwrap());
                assert!(across >= 300.0 && down >= 100.0, "{name} is {across} by {down} pixels");
                assert!(marks > 0.0 && visible == marks, "{name} shows {visible} of {marks} marks");
            }
        });
    }
}

#[test]
fn every_figure_opens_with_all_its_traces() {
    visit(WIDTHS[0], |page| {
        for (index, name) in figures(page).iter().enumerate() {
            explore(page, index);
            let traces = page.eval(&format!(
                "(() => {{
                   const live = {}.querySelector('.live');
                   const some = (t) => t.type === 'heatmap' || t.x.some((x, i) => x !== null && t.y[i] !== null);
                   return [live.data.filter(some).length,
                     live.querySelectorAll('.scatterlayer .trace, .heatmaplayer image').length];
                 }})()",
                figure(index)
            ));
            assert!(traces[0].as_u64().unwrap() > 0, "{name} has no traces");
            assert_eq!(traces[0], traces[1], "{name} draws another number of traces");
        }
    });
}

/// The place of a visible point of a figure: of the middle of a line, or of a picture. Others may
/// lie over it, so that what is read there is someone's reading, not always this line's.
fn place(page: &mut Page, index: usize) -> Point {
    let place = page.eval(&format!(
        "(() => {{
           const live = {}.querySelector('.live'), box = live.getBoundingClientRect();
           const canvas = live.parentElement.getBoundingClientRect();
           for (const trace of live.data) {{
             if (trace.hoverinfo === 'skip') continue;
             const x = live._fullLayout['xaxis' + (trace.xaxis ?? 'x').slice(1)];
             const y = live._fullLayout['yaxis' + (trace.yaxis ?? 'y').slice(1)];
             const order = [...trace.x.keys()].sort((a, b) => Math.abs(a - trace.x.length / 2) - Math.abs(b - trace.x.length / 2));
             for (const i of order) {{
               const j = trace.type === 'heatmap' ? Math.floor(trace.y.length / 2) : i;
               if (trace.x[i] === null || trace.y[j] === null) continue;
               const inside = [x.d2p(trace.x[i]), y.d2p(trace.y[j])];
               const at = [box.x + x._offset + inside[0], box.y + y._offset + inside[1]];
               if (inside[0] > 5 && inside[0] < x._length - 5 && inside[1] > 5 && inside[1] < y._length - 5
                 && at[0] > canvas.x + 5 && at[0] < canvas.right - 5) return at;
             }}
           }}
           return null;
         }})()",
        figure(index)
    ));
    serde_json::from_value(place).unwrap_or_else(|_| panic!("{} has no point", figure(index)))
}

#[test]
fn pointing_at_a_figure_reads_its_values() {
    for width in WIDTHS {
        visit(width, |page| {
            for (index, name) in figures(page).iter().enumerate() {
                explore(page, index);
                let (x, y) = place(page, index);
                page.point((x - 3.0, y));
                page.point((x, y));
                let label = format!("{}.querySelector('.hoverlayer .hovertext')", figure(index));
                let shown = page.comes_true(&format!("{label}?.textContent.includes(':')"));
                assert!(shown, "{name} says nothing at ({x}, {y}), {width} pixels wide");
            }
        });
    }
}

/// The ranges of a figure's axes.
fn ranges(page: &mut Page, index: usize) -> Vec<(f64, f64)> {
    let ranges = page.eval(&format!(
        "(() => {{
           const {{ layout }} = {}.querySelector('.live');
           return Object.keys(layout).filter((key) => /^[xy]axis/.test(key)).sort().map((key) => layout[key].range);
         }})()",
        figure(index)
    ));
    serde_json::from_value(ranges).unwrap()
}

#[test]
fn dragging_zooms_into_a_figure_and_its_button_resets_it() {
    for width in WIDTHS {
        visit(width, |page| {
            for (index, name) in kinds(page) {
                explore(page, index);
                let before = ranges(page, index);
                let corner = page.eval(&format!(
                    "(() => {{
                       const live = {}.querySelector('.live'), box = live.getBoundingClientRect();
                       const {{ xaxis: x, yaxis: y }} = live._fullLayout;
                       return [box.x + x._offset, box.y + y._offset, Math.min(x._length, innerWidth - box.x - x._offset), y._length];
                     }})()",
                    figure(index)
                ));
                let [left, top, across, down] = [0, 1, 2, 3].map(|i| corner[i].as_f64().unwrap());
                let at = |share: f64| (left + share * across, top + share * down);
                page.drag(at(0.25), at(0.75));
                let reset = format!("{}.querySelectorAll('.tools button')[1]", figure(index));
                assert!(page.comes_true(&format!("!{reset}.hidden")), "{name} does not zoom");
                page.frame();
                let inside = ranges(page, index);
                let smaller = |(b, i): (&(f64, f64), &(f64, f64))| {
                    (i.1 - i.0).abs() < 0.9 * (b.1 - b.0).abs()
                };
                // The first panel has the first axes; others may be tied to it or not.
                let zoomed = before.iter().zip(&inside).filter(|&pair| smaller(pair)).count();
                assert!(zoomed >= 2, "{name}: from {before:?} to {inside:?}");
                let button = page.bring(&reset);
                page.click(button);
                assert!(page.comes_true(&format!("{reset}.hidden")), "{name} does not reset");
                page.frame();
                assert_eq!(ranges(page, index), before, "{name} returns to another view");
            }
        });
    }
}

#[test]
fn open_figures_take_the_colours_of_the_dark_and_back() {
    visit(WIDTHS[0], |page| {
        let names = figures(page);
        (0..names.len()).for_each(|index| explore(page, index));
        let colors = ["light", "dark", "light"].map(|scheme| {
            page.prefer(scheme);
            page.frame();
            // Axes carry the colour of the rules, whatever lies between them.
            page.texts(
                "[...document.querySelectorAll('.live')].map((live) => live._fullLayout.xaxis.linecolor)",
            )
        });
        for (index, name) in names.iter().enumerate() {
            let [light, dark, again] = [0, 1, 2].map(|i| &colors[i][index]);
            assert_ne!(light, dark, "{name} stays light in the dark");
            assert_eq!(light, again, "{name} stays dark in the light");
        }
    });
}

#[test]
fn a_figure_can_be_explored_with_the_keys_alone() {
    visit(WIDTHS[0], |page| {
        for (index, name) in kinds(page) {
            let button = format!("{}.querySelector('.tools button')", figure(index));
            let live = format!("{}.querySelector('.live')", figure(index));
            page.eval(&format!("{button}.focus()"));
            page.press("Enter");
            assert!(
                page.comes_true(&format!(
                    "document.activeElement === {live} && {button}.textContent === 'Done'"
                )),
                "{name} does not open"
            );
            let focus = page.eval(&format!("getComputedStyle({live}).outlineStyle"));
            assert_ne!(focus, "none", "{name} does not show that it has the focus");
            let before = ranges(page, index);
            page.press("+");
            page.frame();
            assert_ne!(ranges(page, index), before, "{name} does not zoom");
            page.press("0");
            page.frame();
            assert_eq!(ranges(page, index), before, "{name} does not reset");
            page.press("ArrowRight");
            let lines = page.eval(&format!(
                "{live}.data.some((t) => t.type === 'scatter' && t.hoverinfo !== 'skip')"
            ));
            let reading =
                page.eval(&format!("{}.querySelector('.reading').textContent", figure(index)));
            let reads = reading.as_str().is_some_and(|text| text.contains("x = "));
            assert!(reads || lines == Value::Bool(false), "{name} reads “{reading}”");
            page.press("Escape");
            let left = page.comes_true(&format!("document.activeElement === {button} && !{live}"));
            assert!(left, "{name} does not return to its button");
        }
        assert_eq!(page.eval("document.querySelectorAll('.live').length"), json!(0));
    });
}
