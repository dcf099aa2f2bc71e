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

/// Level of compression: the highest takes three times as long and saves a hundredth.
const LEVEL: u8 = 6;

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

#[cfg(test)]
mod tests {
    use miniz_oxide::inflate::decompress_to_vec_zlib;

    use super::*;
    use crate::figure::{Axis, Mark, Panel};

    fn figure(x: Vec<f64>, y: Vec<f64>) -> Figure {
        let words = "a < b & \"c\" ]]> </script>";
        let panel = Panel::new(Axis::linear(words), Axis::linear("y"));
        Figure::new("fig-1", words).number("9.1").panel(panel.mark(Mark::line(x, y).label(words)))
    }

    /// The description of the interactive figure, as the script of the page reads it.
    fn embedded(html: &str) -> serde_json::Value {
        let data = html.split("id=\"data-fig-1\">").nth(1).unwrap();
        let bytes = STANDARD.decode(data.split("</script>").next().unwrap()).expect("base64");
        let text = decompress_to_vec_zlib(&bytes).expect("the format `deflate` of browsers");
        serde_json::from_slice(&text).expect("JSON")
    }

    #[test]
    fn a_closing_tag_in_the_words_is_harmless() {
        let drawn = figure(vec![0.0, 1.0], vec![0.0, 1.0]);
        let html = embed(&drawn);
        assert_eq!(html.matches("</script").count(), 1, "only the end of the data");
        assert_eq!(embedded(&html)["data"][0]["name"], plotly(&drawn)["data"][0]["name"]);
        assert!(html.contains("<b>Figure 9.1 — a &lt; b"));
    }

    #[test]
    fn the_data_of_a_figure_are_embedded_whole_in_two_thirds_of_their_size() {
        let x: Vec<f64> = (0..2000).map(|i| f64::from(i) / 1000.0).collect();
        let drawn = figure(x.clone(), x.iter().map(|x| (7.0 * x).sin()).collect());
        let (html, whole) = (embed(&drawn), plotly(&drawn));
        assert_eq!(embedded(&html), whole);
        let rest = embed(&figure(vec![], vec![])).len();
        let size = html.len() - rest;
        assert!(size < whole.to_string().len() * 2 / 3, "{size} bytes");
    }
}
