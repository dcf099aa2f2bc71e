//! Rust with its comments and literals blanked, and words in what remains.

/// `text` with comments and the insides of literals as blanks, line for line.
pub(crate) fn of(text: &str) -> String {
    let mut code = String::with_capacity(text.len());
    let mut rest = text;
    let mut previous = ' ';
    while let Some(next) = rest.chars().next() {
        let blank = not_code(rest, is_word(previous));
        let (taken, remaining) = rest.split_at(blank.unwrap_or(next.len_utf8()));
        if blank.is_some() {
            code.extend(taken.chars().map(|c| if c == '\n' { '\n' } else { ' ' }));
            previous = ' ';
        } else {
            code.push(next);
            previous = next;
        }
        rest = remaining;
    }
    code
}

/// The length of the comment or literal that `rest` begins with.
fn not_code(rest: &str, within_word: bool) -> Option<usize> {
    if rest.starts_with("//") {
        return Some(rest.find('\n').unwrap_or(rest.len()));
    }
    if rest.starts_with("/*") {
        return Some(block_comment(rest));
    }
    if let Some(inside) = rest.strip_prefix('"') {
        return Some(1 + quoted(inside, '"'));
    }
    if let Some(inside) = rest.strip_prefix('\'') {
        let is_character = inside.starts_with('\\') || inside.chars().nth(1) == Some('\'');
        return is_character.then(|| 1 + quoted(inside, '\''));
    }
    if within_word { None } else { raw_string(rest) }
}

fn block_comment(rest: &str) -> usize {
    let mut depth = 0;
    let mut at = 0;
    while at < rest.len() {
        let here = &rest.as_bytes()[at..];
        if here.starts_with(b"/*") {
            depth += 1;
            at += 2;
        } else if here.starts_with(b"*/") {
            depth -= 1;
            at += 2;
            if depth == 0 {
                return at;
            }
        } else {
            at += 1;
        }
    }
    rest.len()
}

/// The length up to and with the closing `quote`.
fn quoted(inside: &str, quote: char) -> usize {
    let mut escaped = false;
    for (at, c) in inside.char_indices() {
        if c == quote && !escaped {
            return at + 1;
        }
        escaped = c == '\\' && !escaped;
    }
    inside.len()
}

fn raw_string(rest: &str) -> Option<usize> {
    let open = ["br", "cr", "r"].into_iter().find_map(|prefix| rest.strip_prefix(prefix))?;
    let inside = open.trim_start_matches('#');
    let hashes = open.len() - inside.len();
    let body = inside.strip_prefix('"')?;
    let close = format!("\"{}", "#".repeat(hashes));
    let length = body.find(&close).map_or(body.len(), |at| at + close.len());
    Some(rest.len() - body.len() + length)
}

/// Whether `c` can be part of a name.
pub(super) fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Where `word` begins in `code` and is no part of a longer word.
pub(super) fn words<'a>(code: &'a str, word: &'a str) -> impl Iterator<Item = usize> + 'a {
    let open_ended = !word.ends_with(is_word);
    prefixes(code, word)
        .filter(move |at| open_ended || !code[at + word.len()..].starts_with(is_word))
}

/// Where a word that starts with `prefix` begins in `code`.
pub(super) fn prefixes<'a>(code: &'a str, prefix: &'a str) -> impl Iterator<Item = usize> + 'a {
    code.match_indices(prefix).map(|(at, _)| at).filter(|&at| !code[..at].ends_with(is_word))
}

/// Whether `word` stands in `code`.
pub(super) fn has_word(code: &str, word: &str) -> bool {
    words(code, word).next().is_some()
}

/// The name that `code` begins with, after blanks; empty where there is none.
pub(super) fn leading_name(code: &str) -> &str {
    let code = code.trim_start();
    &code[..code.find(|c| !is_word(c)).unwrap_or(code.len())]
}

/// The line of the character at `offset`, counted from one.
pub(super) fn line_of(code: &str, offset: usize) -> usize {
    1 + code[..offset].matches('\n').count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_and_literals_are_blank() {
        for (text, code) in [
            ("a // b\nc", "a     \nc"),
            ("a /* b /* c */ d */ e", "a                   e"),
            (r#"f("a\"b", c)"#, "f(      , c)"),
            ("r#\"a \" b\"# c", "           c"),
            ("r#type b\"x\" br\"y\"", "r#type b         "),
            ("var\"x\"", "var   "),
            ("('\"', '\\'', 'µ') b", "(   ,     ,    ) b"),
            ("fn f<'a>(x: &'a str)", "fn f<'a>(x: &'a str)"),
            ("\"a\nb\" c", "  \n   c"),
        ] {
            assert_eq!(of(text), code, "{text}");
        }
    }

    #[test]
    fn a_word_is_no_part_of_another() {
        assert!(has_word("an unsafe block", "unsafe"));
        assert!(!has_word("unsafe_code", "unsafe"));
        assert!(!has_word("not_unsafe", "unsafe"));
        assert_eq!(prefixes("dist_mm + _mm_add", "_mm").collect::<Vec<_>>(), [10]);
    }
}
