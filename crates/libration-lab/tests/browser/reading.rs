//! Reading the page: light, width, links and keys.

use std::collections::HashSet;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

use crate::page::{Page, WIDTHS, visit};

/// The contrast that body text needs, WCAG 2.2, 1.4.3.
const CONTRAST: f64 = 4.5;

/// Luminance of the page, and every text that stands out from it by less than a contrast.
const FAINT: &str = "(() => {
  const canvas = new OffscreenCanvas(1, 1).getContext('2d', { willReadFrequently: true });
  const rgba = (color) => {
    canvas.clearRect(0, 0, 1, 1);
    canvas.fillStyle = color;
    canvas.fillRect(0, 0, 1, 1);
    return canvas.getImageData(0, 0, 1, 1).data;
  };
  const luminance = (color) => {
    const [r, g, b] = [...rgba(color)].map((v) => v / 255)
      .map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const ground = (element) => {
    for (let e = element; e; e = e.parentElement) {
      const color = getComputedStyle(e).backgroundColor;
      if (rgba(color)[3] > 0) return color;
    }
    return 'white';
  };
  const written = (e) => [...e.childNodes].some((n) => n.nodeType === 3 && n.data.trim());
  const texts = [...document.querySelectorAll('body *:not(script, style, svg *)')]
    .filter((e) => written(e) && e.checkVisibility());
  const seen = texts.map((e) => {
    const [a, b] = [luminance(getComputedStyle(e).color), luminance(ground(e))];
    return [(Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05), e];
  });
  const faint = seen.filter(([contrast]) => contrast < LEAST)
    .map(([contrast, e]) => `${contrast.toFixed(2)}: ${e.textContent.slice(0, 60)}`);
  return [luminance(ground(document.body)), seen.length, faint];
})()";

#[test]
fn text_stands_out_from_the_page_in_the_light_and_in_the_dark() {
    visit(WIDTHS[0], |page| {
        let mut lights = Vec::new();
        for scheme in ["light", "dark"] {
            page.prefer(scheme);
            unfold(page);
            let seen = page.eval(&FAINT.replace("LEAST", &CONTRAST.to_string()));
            assert!(seen[1].as_u64().unwrap() > 50, "{scheme}: {} texts", seen[1]);
            assert_eq!(seen[2], json!([]), "{scheme}");
            lights.push(seen[0].as_f64().unwrap());
        }
        assert!(lights[0] > 0.8 && lights[1] < 0.05, "luminance of the page: {lights:?}");
    });
}

#[test]
fn nothing_makes_the_page_wider_than_its_window() {
    for width in WIDTHS {
        visit(width, |page| {
            unfold(page);
            let wide = page.number("document.documentElement.scrollWidth");
            let culprits = format!(
                "[...document.querySelectorAll('body *')].filter((e) => e.checkVisibility()
                   && e.getBoundingClientRect().right > {width} && !e.parentElement.closest('.scroll, .canvas'))
                   .map((e) => e.outerHTML.slice(0, 120))"
            );
            let culprits = page.texts(&culprits);
            assert!(wide <= f64::from(width), "{wide} of {width} pixels: {culprits:#?}");
        });
    }
}

#[test]
fn every_link_leads_to_its_target_even_into_a_fold() {
    for width in WIDTHS {
        visit(width, |page| {
            unfold(page);
            let lost = page.texts(
                "(async () => {
                   const frame = () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
                   const lost = [];
                   const all = [...document.querySelectorAll('a[href]')].filter((a) => a.checkVisibility());
                   // Several claims rest on the same finding.
                   const links = [...new Map(all.map((a) => [a.getAttribute('href'), a])).values()];
                   if (!links.some((a) => a.closest('.ledger'))) lost.push('no link in the ledger');
                   for (const link of links) {
                     document.querySelectorAll('details').forEach((fold) => { fold.open = false; });
                     history.replaceState(null, '', location.pathname);
                     scrollTo(0, 0);
                     link.closest('details')?.setAttribute('open', '');
                     link.click();
                     const target = document.getElementById(link.hash.slice(1));
                     const seen = () => {
                       const box = target?.getBoundingClientRect();
                       return target?.checkVisibility() && box.height > 0 && box.bottom > 0 && box.top < innerHeight;
                     };
                     // A busy machine opens a fold and scrolls to it some frames later.
                     for (let i = 0; i < 60 && !seen(); i++) await frame();
                     if (!seen()) lost.push(link.getAttribute('href'));
                   }
                   return lost;
                 })()",
            );
            assert!(lost.is_empty(), "at {width} pixels these lead nowhere: {lost:#?}");
        });
    }
}

/// How many pixels of the outer eight columns of an element, left and right, its background changes.
fn shaded(page: &mut Page, element: &str) -> [usize; 2] {
    let mut picture = |background: &str| {
        page.eval(&format!("void ({element}.style.background = '{background}')"));
        page.frame();
        let clip = page.eval(&format!(
            "(() => {{
               const {{ x, y, width, height }} = {element}.getBoundingClientRect();
               return {{ x: x + scrollX, y: y + scrollY, width, height, scale: 1 }};
             }})()"
        ));
        let shot = page.ask("Page.captureScreenshot", json!({"format": "png", "clip": clip}));
        let bytes = STANDARD.decode(shot["data"].as_str().unwrap()).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut pixels).unwrap();
        (pixels, info.line_size, info.color_type.samples())
    };
    let ((with, line, size), (without, ..)) = (picture(""), picture("none"));
    page.eval(&format!("void ({element}.style.background = '')"));
    let rows = || with.chunks(line).zip(without.chunks(line));
    let differ = |columns: std::ops::Range<usize>| {
        let at = |row: &[u8], i: usize| row[i * size..(i + 1) * size].to_vec();
        rows().map(|(a, b)| columns.clone().filter(|&i| at(a, i) != at(b, i)).count()).sum()
    };
    let width = line / size;
    [differ(0..8), differ(width - 8..width)]
}

#[test]
fn what_scrolls_sideways_is_shaded_where_it_goes_on() {
    visit(WIDTHS[1], |page| {
        for scheme in ["light", "dark"] {
            page.prefer(scheme);
            for element in ["figure[data-figure] .canvas", "main > section > .scroll"] {
                let element = format!(
                    "[...document.querySelectorAll('{element}')].find((e) => e.scrollWidth > e.clientWidth + 50)"
                );
                page.bring(&element);
                let [left, right] = shaded(page, &element);
                assert!(left == 0 && right > 100, "{scheme}, {element}: {left}, {right}");
                page.eval(&format!("void ({element}.scrollLeft = 1e6)"));
                let [left, right] = shaded(page, &element);
                assert!(
                    left > 100 && right == 0,
                    "{scheme}, {element} at its end: {left}, {right}"
                );
                page.eval(&format!("void ({element}.scrollLeft = 0)"));
            }
        }
    });
}

/// The elements that the tab key should reach, in the order of the page.
const STOPS: &str = "[...document.querySelectorAll('a[href], button, summary, input, select, textarea, [tabindex]')]
  .filter((e) => e.checkVisibility({ visibilityProperty: true }) && e.tabIndex >= 0 && !e.disabled)";

#[test]
fn the_tab_key_reaches_everything_in_order_and_shows_where_it_is() {
    for width in WIDTHS {
        visit(width, |page| {
            page.eval(&format!("void (globalThis.stops = {STOPS})"));
            let count = page.number("stops.length") as usize;
            assert!(count > 10, "{count} stops");
            for kind in ["a", "button", "summary", ".scroll", "figure[data-figure] button"] {
                let some = page.eval(&format!("stops.some((e) => e.matches('{kind}'))"));
                assert_eq!(some, true, "{kind} cannot be reached at {width} pixels");
            }
            for stop in 0..count {
                page.press("Tab");
                let fault = page.eval(&format!(
                    "(() => {{
                       const e = document.activeElement, wanted = stops[{stop}];
                       const name = (e) => e.outerHTML.slice(0, 100);
                       if (e !== wanted) return `reaches ${{name(e)}} instead of ${{name(wanted)}}`;
                       const {{ outlineStyle, outlineWidth, outlineColor }} = getComputedStyle(e);
                       const ring = outlineStyle !== 'none' && parseFloat(outlineWidth) >= 1
                         && outlineColor !== 'rgba(0, 0, 0, 0)';
                       if (!ring) return `shows no focus on ${{name(e)}}`;
                       const box = e.getBoundingClientRect();
                       const seen = box.bottom > 0 && box.top < innerHeight && box.right > 0 && box.left < innerWidth;
                       return seen ? null : `leaves ${{name(e)}} out of sight`;
                     }})()"
                ));
                assert_eq!(fault, Value::Null, "stop {stop} at {width} pixels");
            }
        });
    }
}

#[test]
fn everything_that_the_tab_key_reaches_has_a_name_of_its_own() {
    visit(WIDTHS[0], |page| {
        unfold(page);
        let tree = page.ask("Accessibility.getFullAXTree", json!({}));
        let mut buttons = HashSet::new();
        let mut named = 0;
        for node in tree["nodes"].as_array().unwrap() {
            let properties = node["properties"].as_array().map_or(&[][..], Vec::as_slice);
            let focusable =
                properties.iter().any(|p| p["name"] == "focusable" && p["value"]["value"] == true);
            let role = node["role"]["value"].as_str().unwrap_or_default();
            if !focusable || node["ignored"] == true || role == "RootWebArea" {
                continue;
            }
            let name = node["name"]["value"].as_str().unwrap_or_default();
            assert!(!name.trim().is_empty(), "a {role} has no name: {node:#}");
            assert!(role != "button" || buttons.insert(name), "two buttons are called “{name}”");
            named += 1;
        }
        assert!(named > 10, "{named} names");
    });
}

/// Opens every fold.
fn unfold(page: &mut Page) {
    page.eval("document.querySelectorAll('details').forEach((fold) => { fold.open = true; })");
    page.frame();
}
