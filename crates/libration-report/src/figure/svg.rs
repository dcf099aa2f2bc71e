//! Figures as SVG.

mod mark;
mod path;

use std::fmt::Write;

use path::px;

use super::layout::{FigureLayout, PanelLayout};
use super::palette::{Tone, resolved_stylesheet};
use super::panel::Figure;
use super::raster_image;
use super::sizes::{LABEL, NORMAL, SMALL, WIDTH, title_size};
use crate::text;
use crate::text::escape;

/// The figure for an HTML page that has the [stylesheet](super::STYLESHEET): it follows light, dark
/// and print.
pub fn inline(figure: &Figure) -> String {
    document(figure, "")
}

/// The figure as a standalone file, in the preferred colour scheme.
pub fn standalone(figure: &Figure) -> String {
    let (light, dark) = (resolved_stylesheet(Tone::Light), resolved_stylesheet(Tone::Dark));
    let style = format!("<style>{light}@media (prefers-color-scheme:dark){{{dark}}}</style>");
    document(figure, &style)
}

fn document(figure: &Figure, style: &str) -> String {
    let layout = FigureLayout::of(figure);
    let id = escape(&figure.id);
    let (width, height) = (px(WIDTH), px(layout.height));
    let mut out = format!("<svg class=\"plot\" viewBox=\"0 0 {width} {height}\"");
    if !style.is_empty() {
        let _ = write!(
            out,
            " xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\""
        );
    }
    let _ = write!(
        out,
        " role=\"img\" aria-labelledby=\"{id}-title {id}-desc\"><title id=\"{id}-title\">{}</title>\
         <desc id=\"{id}-desc\">{}</desc>{style}",
        escape(&figure.title),
        escape(&figure.description)
    );
    if !style.is_empty() {
        let _ = write!(out, "<rect class=\"paper\" width=\"{width}\" height=\"{height}\"/>");
    }
    for (index, placed) in layout.panels.iter().enumerate() {
        panel(placed, &format!("{id}-clip-{index}"), &mut out);
    }
    for entry in &layout.legend {
        let _ = write!(out, "<g class=\"ink-{}\">", entry.mark.style.role.name());
        mark::sample(entry, &mut out);
        let (x, y) = (px(entry.text_x), px(entry.y + 4.5));
        let words = text::svg(entry.text, NORMAL);
        let _ = write!(out, "<text class=\"legend\" x=\"{x}\" y=\"{y}\">{words}</text></g>");
    }
    out.push_str("</svg>");
    out
}

fn panel(placed: &PanelLayout<'_>, clip: &str, out: &mut String) {
    let rect = placed.frame.rect;
    let (x, y, right, bottom) = (px(rect.x), px(rect.y), px(rect.right()), px(rect.bottom()));
    let edge = rect.expanded(1.5);
    let _ = write!(
        out,
        "<clipPath id=\"{clip}\"><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/></clipPath>",
        px(edge.x),
        px(edge.y),
        px(edge.width),
        px(edge.height)
    );
    // Lines may stand out by half their width, pictures not at all.
    let _ = write!(
        out,
        "<clipPath id=\"{clip}-p\"><rect x=\"{x}\" y=\"{y}\" width=\"{}\" height=\"{}\"/></clipPath>",
        px(rect.width),
        px(rect.height)
    );
    let (mut grid, mut minor, mut numbers) = (String::new(), String::new(), String::new());
    for tick in &placed.x_ticks {
        let at = px(placed.frame.x.at(tick.value));
        let _ = if tick.label.is_empty() {
            write!(minor, "M{at} {bottom}v-4")
        } else {
            let label = text::svg(&tick.label, SMALL);
            let below = px(rect.bottom() + 18.0);
            let _ = write!(
                numbers,
                "<text x=\"{at}\" y=\"{below}\" text-anchor=\"middle\">{label}</text>"
            );
            write!(grid, "M{at} {y}V{bottom}")
        };
    }
    for tick in &placed.y_ticks {
        let place = placed.frame.y.at(tick.value);
        let at = px(place);
        let _ = if tick.label.is_empty() {
            write!(minor, "M{x} {at}h4")
        } else {
            let label = text::svg(&tick.label, SMALL);
            let (left, base) = (px(rect.x - 8.0), px(place + 4.0));
            let _ = write!(
                numbers,
                "<text x=\"{left}\" y=\"{base}\" text-anchor=\"end\">{label}</text>"
            );
            write!(grid, "M{x} {at}H{right}")
        };
    }
    let _ = write!(out, "<path class=\"grid\" d=\"{grid}\"/>");
    mark::marks(placed, clip, out);
    let _ = write!(out, "<path class=\"frame\" d=\"M{x} {y}H{right}V{bottom}H{x}Z\"/>");
    if !minor.is_empty() {
        let _ = write!(out, "<path class=\"minor\" d=\"{minor}\"/>");
    }
    out.push_str(&numbers);
    titles(placed, out);
    bar(placed, out);
    labels(placed, out);
}

fn titles(placed: &PanelLayout<'_>, out: &mut String) {
    let rect = placed.frame.rect;
    let (middle_x, middle_y) = (rect.x + rect.width / 2.0, rect.y + rect.height / 2.0);
    if let Some(head) = &placed.panel.title {
        let (x, y) = (px(rect.x), px(rect.y - 10.0));
        let words = text::svg(head, LABEL);
        let _ = write!(out, "<text class=\"head\" x=\"{x}\" y=\"{y}\">{words}</text>");
    }
    let (x, y) = (&placed.panel.x.title(), &placed.panel.y.title());
    let foot = format!("translate({} {})", px(middle_x), px(rect.bottom() + 39.0));
    title(x, rect.width, &foot, out);
    let side = format!("translate({} {}) rotate(-90)", px(placed.numbers - 9.0), px(middle_y));
    title(y, rect.height, &side, out);
}

/// The title of an axis that is `length` long.
fn title(words: &str, length: f64, transform: &str, out: &mut String) {
    let size = title_size(words, length);
    let words = text::svg(words, size);
    let size =
        if size < NORMAL { format!(" style=\"font-size:{}px\"", px(size)) } else { String::new() };
    let _ = write!(
        out,
        "<text class=\"title\" transform=\"{transform}\" text-anchor=\"middle\"{size}>{words}</text>"
    );
}

fn bar(placed: &PanelLayout<'_>, out: &mut String) {
    let Some(bar) = &placed.bar else { return };
    let rect = bar.rect;
    let _ = write!(
        out,
        "<image x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" preserveAspectRatio=\"none\" href=\"{}\"/>",
        px(rect.x),
        px(rect.y),
        px(rect.width),
        px(rect.height),
        raster_image::bar_image(bar.colors.map)
    );
    for tick in bar.ticks.iter().filter(|tick| !tick.label.is_empty()) {
        let place = bar.ruler.at(tick.value);
        let (edge, at) = (px(rect.right()), px(place));
        let (x, y, words) = (px(bar.numbers()), px(place + 4.0), text::svg(&tick.label, SMALL));
        let _ = write!(
            out,
            "<path class=\"minor\" d=\"M{edge} {at}h3\"/><text x=\"{x}\" y=\"{y}\">{words}</text>"
        );
    }
    let middle = px(rect.y + rect.height / 2.0);
    let side = format!("translate({} {middle}) rotate(-90)", px(bar.title()));
    title(&bar.colors.title(), rect.height, &side, out);
}

fn labels(placed: &PanelLayout<'_>, out: &mut String) {
    for label in &placed.labels {
        let class = match (label.bold, label.size > SMALL) {
            (true, _) => "label",
            (false, true) => "note",
            (false, false) => "level",
        };
        let halo = if label.outside { "" } else { " halo" };
        let (x, y) = (px(label.at[0]), px(label.at[1] + 0.35 * label.size));
        let words = text::svg(&label.text, label.size);
        let on = if placed.is_on_raster() && !label.outside { " on-picture" } else { "" };
        let _ = write!(out, "<g class=\"ink-{}{on}\">", label.role.name());
        if let Some([from, to]) = label.leader() {
            let d = path::line(&[from, to]);
            let _ = write!(out, "<path class=\"leader\" d=\"{d}\"/>");
        }
        let _ = write!(out, "<text class=\"{class}{halo}\" x=\"{x}\" y=\"{y}\">{words}</text></g>");
    }
}
