//! Text as HTML.

/// `text` with the characters that mean something to HTML escaped.
pub(super) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            c => out.push(c),
        }
    }
    out
}

/// `text` escaped, with what stands between backticks as code.
pub(super) fn text(text: &str) -> String {
    let pieces = text.split('`').enumerate();
    pieces
        .map(|(i, piece)| match i % 2 {
            0 => raise(&escape(piece)),
            _ => format!("<code>{}</code>", escape(piece)),
        })
        .collect()
}

/// Runs of raised characters as `<sup>`: fonts that lack them would mix two heights.
fn raise(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut raised = false;
    for c in text.chars() {
        let plain = match c {
            '⁻' => Some('−'),
            '¹' => Some('1'),
            '²' => Some('2'),
            '³' => Some('3'),
            '⁰' | '⁴'..='⁹' => char::from_digit(u32::from(c) - u32::from('⁰'), 10),
            _ => None,
        };
        if plain.is_some() != raised {
            raised = !raised;
            out.push_str(if raised { "<sup>" } else { "</sup>" });
        }
        out.push(plain.unwrap_or(c));
    }
    if raised {
        out.push_str("</sup>");
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_are_raised_together() {
        assert_eq!(text("2·10⁻¹² m²"), "2·10<sup>−12</sup> m<sup>2</sup>");
    }

    #[test]
    fn no_text_becomes_markup() {
        assert_eq!(text("a < b & `<i>`"), "a &lt; b &amp; <code>&lt;i&gt;</code>");
    }
}
