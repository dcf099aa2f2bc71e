//! Marks as SVG elements.

use std::fmt::Write;

use super::path::{line, px};
use crate::figure::geometry::Place;
use crate::figure::layout::{LegendEntry, PanelLayout};
use crate::figure::mark::Shape;
use crate::figure::mark_geometry::MarkGeometry;
use crate::figure::raster_image;
use crate::figure::sizes::EDGE;
use crate::figure::style::{Marker, Style};

/// All marks of a panel. Points stand whole at the frame, everything else is clipped to it.
pub(super) fn marks(placed: &PanelLayout<'_>, clip: &str, out: &mut String) {
    let on = if placed.is_on_raster() { " on-picture" } else { "" };
    for (mark, drawn) in placed.panel.marks.iter().zip(&placed.drawn) {
        let (style, ink) = (&mark.style, mark.style.role.name());
        let _ = match drawn {
            MarkGeometry::Text(_) => continue,
            MarkGeometry::Points(_) => write!(out, "<g class=\"ink-{ink}{on}\">"),
            MarkGeometry::Picture(_) => {
                write!(out, "<g class=\"ink-{ink}{on}\" clip-path=\"url(#{clip}-p)\">")
            }
            _ => write!(out, "<g class=\"ink-{ink}{on}\" clip-path=\"url(#{clip})\">"),
        };
        match drawn {
            MarkGeometry::Lines(parts) => stroke(&joined(parts), style, !on.is_empty(), out),
            MarkGeometry::Levels(levels) => {
                let all = levels.iter().map(|(_, parts)| joined(parts));
                all.for_each(|d| stroke(&d, style, !on.is_empty(), out));
            }
            MarkGeometry::Points(points) => dots(points, style, out),
            MarkGeometry::Areas(areas) => areas.iter().for_each(|area| fill(area, style, out)),
            MarkGeometry::Picture(rect) => {
                if let (Shape::Raster { grid, colors }, Some(bar)) = (&mark.shape, &placed.bar) {
                    let blank = line(&[
                        [rect.x, rect.y],
                        [rect.right(), rect.y],
                        [rect.right(), rect.bottom()],
                        [rect.x, rect.bottom()],
                    ]);
                    let _ = write!(out, "<path class=\"blank\" d=\"{blank}Z\"/>");
                    let frame = [&placed.frame.x, &placed.frame.y];
                    let data = raster_image::grid_image(grid, colors, &bar.ruler.span, frame);
                    let _ = write!(
                        out,
                        "<image x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" preserveAspectRatio=\"none\" \
                         style=\"image-rendering:pixelated\" image-rendering=\"optimizeSpeed\" href=\"{data}\"/>",
                        px(rect.x),
                        px(rect.y),
                        px(rect.width),
                        px(rect.height)
                    );
                }
            }
            MarkGeometry::Text(_) => {}
        }
        out.push_str("</g>");
    }
}

/// A short sample of a mark, for the legend.
pub(super) fn sample(entry: &LegendEntry<'_>, out: &mut String) {
    let (style, x, y) = (&entry.mark.style, entry.x, entry.y);
    let end = entry.text_x - 7.0;
    match entry.mark.shape {
        Shape::Points { .. } => dots(&[[x + 5.0, y]], style, out),
        Shape::Envelope(_) | Shape::Region { .. } => {
            fill(&[[x, y - 5.0], [end, y - 5.0], [end, y + 5.0], [x, y + 5.0]], style, out);
        }
        _ => stroke(&line(&[[x, y], [end, y]]), style, false, out),
    }
}

fn joined(parts: &[Vec<Place>]) -> String {
    parts.iter().map(|part| line(part)).collect()
}

/// A line; over a picture with a pale edge, so that it is seen on dark values too.
fn stroke(d: &str, style: &Style, edged: bool, out: &mut String) {
    if d.is_empty() {
        return;
    }
    if edged {
        let width = px(style.width + EDGE);
        let _ = write!(out, "<path class=\"edge\" stroke-width=\"{width}\" d=\"{d}\"/>");
    }
    let dashes: Vec<String> = style.dashes().iter().map(|&length| px(length)).collect();
    let _ = write!(out, "<path class=\"line\" stroke-width=\"{}\"", px(style.width));
    if !dashes.is_empty() {
        let _ = write!(out, " stroke-dasharray=\"{}\"", dashes.join(" "));
    }
    let _ = write!(out, " d=\"{d}\"/>");
}

fn fill(area: &[Place], style: &Style, out: &mut String) {
    if area.len() > 2 {
        let (width, d) = (px(style.width), line(area));
        let _ = write!(out, "<path class=\"area\" stroke-width=\"{width}\" d=\"{d}Z\"/>");
    }
}

fn dots(points: &[Place], style: &Style, out: &mut String) {
    if points.is_empty() {
        return;
    }
    let r = style.radius;
    let mut d = String::new();
    for &[x, y] in points {
        let at = |dx: f64, dy: f64| format!("{} {}", px(x + dx * r), px(y + dy * r));
        let (radius, across) = (px(r), px(2.0 * r));
        let _ = match style.marker {
            Marker::OpenCircle | Marker::Circle => write!(
                d,
                "M{}a{radius} {radius} 0 1 0 {across} 0a{radius} {radius} 0 1 0-{across} 0Z",
                at(-1.0, 0.0)
            ),
            Marker::Square => {
                let side = px(1.8 * r);
                write!(d, "M{}h{side}v{side}h-{side}Z", at(-0.9, -0.9))
            }
            Marker::Diamond => {
                write!(d, "M{}L{}L{}L{}Z", at(0.0, -1.3), at(1.3, 0.0), at(0.0, 1.3), at(-1.3, 0.0))
            }
            Marker::Triangle => {
                write!(d, "M{}L{}L{}Z", at(0.0, -1.2), at(1.1, 0.8), at(-1.1, 0.8))
            }
            Marker::Cross => write!(
                d,
                "M{}L{}M{}L{}",
                at(-1.0, -1.0),
                at(1.0, 1.0),
                at(-1.0, 1.0),
                at(1.0, -1.0)
            ),
            Marker::Plus => {
                write!(d, "M{}L{}M{}L{}", at(-1.2, 0.0), at(1.2, 0.0), at(0.0, -1.2), at(0.0, 1.2))
            }
        };
    }
    let (class, width) = match style.marker {
        Marker::OpenCircle => ("open", px(1.1)),
        Marker::Cross | Marker::Plus => ("stroke", px(1.4)),
        _ => ("dot", px(0.0)),
    };
    let _ = write!(out, "<path class=\"{class}\" stroke-width=\"{width}\" d=\"{d}\"/>");
}
