//! Figures in an HTML page.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::palette::STYLESHEET;
use super::panel::Figure;
use super::plotly::plotly;
use super::svg;
use crate::text;

const PLOTLY: &[u8] = include_bytes!("../../assets/plotly.min.js.gz");
const SCRIPT: &str = include_str!("../../assets/figure.js");

/// The `<figure>` element with the SVG, the caption and the data of the interactive figure. Without
/// [`scripts`] it is static.
pub fn embed(figure: &Figure) -> String {
    let id = text::escape(&figure.id);
    let number =
        figure.number.as_deref().map(|number| format!("Figure {} — ", text::escape(number)));
    format!(
        "<figure data-figure=\"{id}\" id=\"{id}\"><div class=\"canvas\">{}</div>\
         <figcaption><b>{}{}</b> {}</figcaption>\
         <script type=\"application/json\" id=\"data-{id}\">{}</script></figure>\n",
        svg::inline(figure),
        number.unwrap_or_default(),
        text::html(&figure.title),
        text::html(&figure.caption),
        // No `<` ever reaches the parser of the page, so no element can end or begin in the data.
        plotly(figure).to_string().replace('<', "\\u003c"),
    )
}

/// The stylesheet and the scripts of a page with figures, for the end of the body. They load nothing from
/// the network.
pub fn scripts() -> String {
    format!(
        "<style>{STYLESHEET}</style>\n\
         <script type=\"application/octet-stream+base64\" id=\"plotly\">{}</script>\n\
         <script>{SCRIPT}</script>\n",
        STANDARD.encode(PLOTLY)
    )
}
