//! Figures in an HTML page.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use miniz_oxide::deflate::compress_to_vec_zlib;

use super::palette::STYLESHEET;
use super::panel::Figure;
use super::plotly::plotly;
use super::svg;
use crate::text;

const PLOTLY: &[u8] = include_bytes!("../../assets/plotly.min.js.gz");
const SCRIPT: &str = include_str!("../../assets/figure.js");

/// Level of compression: higher ones take longer and save less than a hundredth.
const LEVEL: u8 = 9;

/// The `<figure>` element with the SVG, the caption and the compressed data of the interactive figure.
/// Without [`scripts`] it is static.
pub fn embed(figure: &Figure) -> String {
    let id = text::escape(&figure.id);
    let number =
        figure.number.as_deref().map(|number| format!("Figure {} — ", text::escape(number)));
    format!(
        "<figure data-figure=\"{id}\" id=\"{id}\"><div class=\"canvas\">{}</div>\
         <figcaption><b>{}{}</b> {}</figcaption>\
         <script type=\"application/zlib+base64\" id=\"data-{id}\">{}</script></figure>\n",
        svg::inline(figure),
        number.unwrap_or_default(),
        text::html(&figure.title),
        text::html(&figure.caption),
        STANDARD.encode(compress_to_vec_zlib(plotly(figure).to_string().as_bytes(), LEVEL)),
    )
}

/// The stylesheet and the scripts of a page with figures, for the end of the body. They load nothing from
/// the network.
pub fn scripts() -> String {
    format!(
        "<style>{STYLESHEET}</style>\n\
         <script type=\"application/gzip+base64\" id=\"plotly\">{}</script>\n\
         <script>{SCRIPT}</script>\n",
        STANDARD.encode(PLOTLY)
    )
}
