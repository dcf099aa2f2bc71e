//! Text with superscripts and subscripts, for pages and figures.

use std::fmt::Write;

/// What a page may do: run its own scripts and its engine in a worker, and load nothing (Content Security Policy, level 3).
pub(crate) const POLICY: &str = "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; \
     script-src 'unsafe-inline' 'wasm-unsafe-eval' blob:; worker-src blob:; style-src 'unsafe-inline'; img-src data: blob:; \
     base-uri 'none'; form-action 'none'\">";

/// The vertical position of a run of characters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Lift {
    Base,
    Above,
    Below,
}

const RAISED: &str = "⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁺ⁿ";
const RAISED_PLAIN: &str = "0123456789−+n";
const LOWERED: &str = "₀₁₂₃₄₅₆₇₈₉₋₊ₙ";

/// Splits text into runs. It supports `10^{-3}`, `10^-3`, `10⁻³`, `E_{max}`, `E_0` and `E₀`.
pub(crate) fn runs(text: &str) -> Vec<(Lift, String)> {
    let mut runs: Vec<(Lift, String)> = Vec::new();
    let mut push = |lift: Lift, c: char| match runs.last_mut() {
        Some((last, run)) if *last == lift => run.push(c),
        _ => runs.push((lift, c.to_string())),
    };
    let chars: Vec<char> = text.chars().collect();
    let mut at = 0;
    while at < chars.len() {
        let c = chars[at];
        at += 1;
        // Most characters are; the tables are searched for the others.
        if c.is_ascii() && c != '^' && c != '_' {
            push(Lift::Base, c);
            continue;
        }
        let plain = |table: &str| {
            let place = table.chars().position(|t| t == c)?;
            RAISED_PLAIN.chars().nth(place)
        };
        if let Some(c) = plain(RAISED) {
            push(Lift::Above, c);
        } else if let Some(c) = plain(LOWERED) {
            push(Lift::Below, c);
        } else if c == '^' || (c == '_' && !inside_a_word(&chars[..at - 1], chars.get(at))) {
            let lift = if c == '^' { Lift::Above } else { Lift::Below };
            let (script, end) = script(&chars, at);
            if script.is_empty() {
                push(Lift::Base, c);
            }
            script.iter().for_each(|&c| push(lift, if c == '-' { '−' } else { c }));
            at = end;
        } else {
            push(Lift::Base, c);
        }
    }
    runs
}

/// Whether an underscore between these characters belongs to a name, such as `x86_64`: only a single
/// letter has an index without braces.
fn inside_a_word(before: &[char], after: Option<&char>) -> bool {
    let word = before.iter().rev().take_while(|c| c.is_alphanumeric()).count();
    word > 1 && after != Some(&'{')
}

/// The script after `^` or `_`, and the index of the text after it.
fn script(chars: &[char], at: usize) -> (&[char], usize) {
    if chars.get(at) == Some(&'{')
        && let Some(length) = chars[at..].iter().position(|&c| c == '}')
    {
        return (&chars[at + 1..at + length], at + length + 1);
    }
    let signed = matches!(chars.get(at), Some('-' | '−' | '+')) as usize;
    let digits = chars[at..].iter().skip(signed).take_while(|c| c.is_ascii_digit()).count();
    if digits > 0 {
        return (&chars[at..at + signed + digits], at + signed + digits);
    }
    let alone = chars.get(at).is_some_and(|c| c.is_alphabetic())
        && !chars.get(at + 1).is_some_and(|c| c.is_alphanumeric());
    let end = at + usize::from(alone);
    (&chars[at..end], end)
}

/// Escapes text for XML and HTML, in content and in attributes, and removes characters that XML forbids.
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '&' => out.push_str("&amp;"),
            '"' => out.push_str("&quot;"),
            '\t' | '\n' | '\r' => out.push(' '),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => {}
            c => out.push(c),
        }
    }
    out
}

/// Renders text as the content of an SVG text element with a font size.
pub(crate) fn svg(text: &str, size: f64) -> String {
    let (mut out, mut height) = (String::new(), 0.0);
    for (lift, run) in runs(text) {
        let target = match lift {
            Lift::Base => 0.0,
            Lift::Above => -0.38 * size,
            Lift::Below => 0.22 * size,
        };
        let shift = target - height;
        height = target;
        let run = escape(&run);
        let small = if lift == Lift::Base { "" } else { " class=\"script\"" };
        let _ = match (shift == 0.0, small) {
            (true, "") => write!(out, "{run}"),
            _ => write!(out, "<tspan dy=\"{shift:.1}\"{small}>{run}</tspan>"),
        };
    }
    out
}

/// Renders text as HTML.
pub(crate) fn html(text: &str) -> String {
    let wrap = |(lift, run): (Lift, String)| {
        let run = escape(&run);
        match lift {
            Lift::Base => run,
            Lift::Above => format!("<sup>{run}</sup>"),
            Lift::Below => format!("<sub>{run}</sub>"),
        }
    };
    runs(text).into_iter().map(wrap).collect()
}

/// Renders text as HTML, with code between backticks.
pub fn render_html(text: &str) -> String {
    let pieces = text.split('`').enumerate();
    pieces
        .map(|(i, piece)| match i % 2 {
            0 => html(piece),
            // Browsers break lines at hyphens, and so within `--dt`.
            _ if is_option(piece) => format!("<code class=\"word\">{}</code>", escape(piece)),
            _ => format!("<code>{}</code>", escape(piece)),
        })
        .collect()
}

/// Whether code is a short word with a hyphen, such as an option.
fn is_option(code: &str) -> bool {
    code.len() <= 24 && code.contains('-') && !code.contains(' ')
}

/// Renders text without markup, as for the title of a window: `10⁻³`, `E₀`.
pub(crate) fn plain(text: &str) -> String {
    let lift = |table: &str, c: char| {
        let place = RAISED_PLAIN.chars().position(|p| p == c);
        place.and_then(|place| table.chars().nth(place)).unwrap_or(c)
    };
    let write = |(height, run): (Lift, String)| -> String {
        match height {
            Lift::Base => run.replace('`', ""),
            Lift::Above => run.chars().map(|c| lift(RAISED, c)).collect(),
            Lift::Below => run.chars().map(|c| lift(LOWERED, c)).collect(),
        }
    };
    runs(text).into_iter().map(write).collect()
}

/// A width that bold text does not exceed in the usual sans-serif fonts.
pub(crate) fn bold_width(text: &str, size: f64) -> f64 {
    1.12 * width(text, size)
}

/// A width that the text does not exceed in the usual sans-serif fonts.
pub(crate) fn width(text: &str, size: f64) -> f64 {
    let advance = |c: char| match c {
        'i' | 'j' | 'l' | '.' | ',' | ':' | ';' | '\'' | '|' | '·' => 0.34,
        ' ' | 'f' | 't' | 'r' | '(' | ')' | 'I' | '/' => 0.42,
        'm' | 'w' | 'M' | 'W' | '−' | '=' | '+' | '≤' | '≥' | '×' | '≈' => 0.86,
        c if c.is_uppercase() => 0.73,
        _ => 0.64,
    };
    let run = |(lift, run): (Lift, String)| {
        let size = if lift == Lift::Base { size } else { size * 0.75 };
        run.chars().map(advance).sum::<f64>() * size
    };
    runs(text).into_iter().map(run).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_notation_of_a_power_is_the_same() {
        let expected = vec![(Lift::Base, "10".to_owned()), (Lift::Above, "−3".to_owned())];
        for text in ["10^{-3}", "10^-3", "10⁻³", "10^{−3}"] {
            assert_eq!(runs(text), expected, "{text}");
        }
        assert_eq!(runs("E_0"), runs("E₀"));
        for name in ["a_file_name", "x86_64"] {
            assert_eq!(runs(name).len(), 1, "words with underscores stay words");
        }
    }

    #[test]
    fn the_line_returns_to_its_height_after_a_script() {
        assert_eq!(
            svg("10^{2} s", 10.0),
            "10<tspan dy=\"-3.8\" class=\"script\">2</tspan><tspan dy=\"3.8\"> s</tspan>"
        );
        assert_eq!(html("x^2 < 1"), "x<sup>2</sup> &lt; 1");
    }

    #[test]
    fn plain_text_has_no_markup() {
        assert_eq!(plain("off by 1.1·10^{-9} m, `E_0`"), "off by 1.1·10⁻⁹ m, E₀");
    }

    #[test]
    fn an_option_is_not_broken_at_its_hyphens() {
        assert_eq!(
            render_html("`--dt` of `a - b`"),
            "<code class=\"word\">--dt</code> of <code>a - b</code>"
        );
    }

    #[test]
    fn no_prose_becomes_markup() {
        assert_eq!(
            render_html("a < b & 10⁻¹² in `<i>^2`"),
            "a &lt; b &amp; 10<sup>−12</sup> in <code>&lt;i&gt;^2</code>"
        );
    }
}
