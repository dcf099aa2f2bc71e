//! Raster images of grids for SVG.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::axis::{Ruler, Span};
use super::color::{ColorMap, Colors};
use super::grid::Grid;

/// Number of shades of an image; the last index of the palette is transparent.
const SHADES: u16 = 255;
const BLANK: u8 = 255;

/// The grid as a data URI, one pixel a cell, the last row of the grid on top.
pub(super) fn grid_image(grid: &Grid, colors: &Colors, span: &Span, frame: [&Ruler; 2]) -> String {
    // A descending axis of samples is drawn from its other end.
    let columns = order(&grid.x, frame[0]);
    let mut rows = order(&grid.y, frame[1]);
    rows.reverse();
    let shade = |value: f64| {
        let share = span.share(value);
        if share.is_nan() { BLANK } else { (share * 254.0).round().clamp(0.0, 254.0) as u8 }
    };
    let cell = |row: usize, column: usize| shade(grid.at(column, row));
    let pixels: Vec<u8> = rows
        .iter()
        .flat_map(|&r| columns.iter().map(move |&c| (r, c)))
        .map(|(r, c)| cell(r, c))
        .collect();
    encode(grid.x.len() as u32, grid.y.len() as u32, &pixels, colors.map)
}

/// A colour bar as a data URI, its high end on top.
pub(super) fn bar_image(map: ColorMap) -> String {
    let pixels: Vec<u8> = (0..BLANK).rev().collect();
    encode(1, SHADES.into(), &pixels, map)
}

fn order(samples: &[f64], ruler: &Ruler) -> Vec<usize> {
    let mut order: Vec<usize> = (0..samples.len()).collect();
    let share = |i: usize| ruler.span.share(samples[i]);
    if samples.len() > 1 && share(0) > share(samples.len() - 1) {
        order.reverse();
    }
    order
}

fn encode(width: u32, height: u32, pixels: &[u8], map: ColorMap) -> String {
    let mut bytes = Vec::new();
    let mut palette: Vec<u8> = (0..SHADES).flat_map(|i| map.at(f64::from(i) / 254.0)).collect();
    palette.extend([128; 3]);
    let mut opacity = vec![255; usize::from(SHADES)];
    opacity.push(0);
    let mut encoder = png::Encoder::new(&mut bytes, width.max(1), height.max(1));
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_palette(palette);
    encoder.set_trns(opacity);
    encoder.set_compression(png::Compression::High);
    // Writing to memory fails only for an image without pixels, which is omitted.
    let written = encoder.write_header().and_then(|mut writer| {
        writer.write_image_data(pixels)?;
        writer.finish()
    });
    match written {
        Ok(()) => format!("data:image/png;base64,{}", STANDARD.encode(&bytes)),
        Err(_) => String::new(),
    }
}
