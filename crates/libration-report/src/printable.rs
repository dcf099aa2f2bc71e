//! Text of files on a terminal: what would change the terminal, or the order of other text, is escaped.

use std::borrow::Cow;
use std::fmt::Write;

/// Whether a character acts on what shows it: a control character of ASCII or of Latin-1, a separator of lines, or a mark of the
/// direction of writing (Unicode Standard Annex 9), which lets text look like another.
fn acts(c: char) -> bool {
    c.is_control()
        || matches!(
            c,
            '\u{061c}'
                | '\u{200e}'
                | '\u{200f}'
                | '\u{2028}'
                | '\u{2029}'
                | '\u{202a}'..='\u{202e}'
                | '\u{2066}'..='\u{2069}'
        )
}

fn escaped(text: &str, is_kept: impl Fn(char) -> bool) -> Cow<'_, str> {
    let is_escaped = |c: char| acts(c) && !is_kept(c);
    if !text.contains(is_escaped) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len() + 8);
    for c in text.chars() {
        if is_escaped(c) {
            // As JSON and TOML write it. All of these characters have four hexadecimal digits.
            let _ = write!(out, "\\u{:04x}", u32::from(c));
        } else {
            out.push(c);
        }
    }
    Cow::Owned(out)
}

/// Text of a file, such as a name, within a line of output.
pub fn printable(text: &str) -> Cow<'_, str> {
    escaped(text, |_| false)
}

/// Output of several lines: ends of lines and tabulators stay. In JSON, the characters that change are within strings, and stay the same
/// characters.
pub fn printable_lines(text: &str) -> Cow<'_, str> {
    escaped(text, |c| matches!(c, '\n' | '\t'))
}

/// Output of several lines with styles of its own: sequences of Select Graphic Rendition (`ESC [ … m`) stay as well.
pub fn printable_styled(text: &str) -> String {
    let mut pieces = text.split("\u{1b}[");
    let mut out = printable_lines(pieces.next().unwrap_or_default()).into_owned();
    for piece in pieces {
        let end = piece.find(|c: char| !(c.is_ascii_digit() || c == ';'));
        let is_style = end.is_some_and(|end| piece[end..].starts_with('m'));
        out += if is_style { "\u{1b}[" } else { "\\u001b[" };
        out += &printable_lines(piece);
    }
    out
}

/// A string of TOML, with its quotes. Its escapes are `\uXXXX`, of which Rust's `\u{…}` is none.
pub fn toml_string(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            c if acts(c) => {
                let _ = write!(out, "\\u{:04x}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out + "\""
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_acts_on_a_terminal_is_escaped_and_other_text_is_as_it_was() {
        for text in ["", "Gelenk é ü \u{a0}x", "関節", "a\\b", "\u{1f916}"] {
            assert!(matches!(printable(text), Cow::Borrowed(same) if same == text));
        }
        for (text, shown) in [
            ("\u{1b}[31mred", "\\u001b[31mred"),
            ("a\r\nerror: b", "a\\u000d\\u000aerror: b"),
            ("\u{9b}2J", "\\u009b2J"),
            ("\u{7f}\0", "\\u007f\\u0000"),
            ("\u{202e}gnp.exe\u{2066}", "\\u202egnp.exe\\u2066"),
            ("\u{2028}\u{2029}\u{85}", "\\u2028\\u2029\\u0085"),
            ("\u{200e}\u{200f}\u{61c}", "\\u200e\\u200f\\u061c"),
        ] {
            assert_eq!(printable(text), shown);
        }
        assert_eq!(printable_lines("a\n\tb\r\u{1b}"), "a\n\tb\\u000d\\u001b");
        let styled = "\u{1b}[1;31merror\u{1b}[0m\u{1b}[2J\u{1b}]0;x\u{7}\u{1b}[";
        let shown = "\u{1b}[1;31merror\u{1b}[0m\\u001b[2J\\u001b]0;x\\u0007\\u001b[";
        assert_eq!(printable_styled(styled), shown);
    }

    #[test]
    fn json_keeps_its_meaning() {
        let value = serde_json::json!({ "na\u{9b}me": "\u{202e}x\u{7f}\n\u{1b}\\" });
        let text = serde_json::to_string_pretty(&value).unwrap();
        let shown = printable_lines(&text);
        assert!(shown.chars().all(|c| c == '\n' || !acts(c)), "{shown}");
        assert_eq!(serde_json::from_str::<serde_json::Value>(&shown).unwrap(), value);
    }
}
