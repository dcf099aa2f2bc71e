//! Items that only tests have.

use std::ops::Range;

use super::code::leading_name;

const MARKS: [&str; 2] = ["#[cfg(test)]", "#[cfg(all(test,"];

/// `code` with the items that only tests have as blanks, line for line.
pub(super) fn blanked(code: &str) -> String {
    let mut rest = 0;
    let mut kept = String::with_capacity(code.len());
    for item in items(code).filter(|item| !item.is_empty()) {
        // An item within another is blank already.
        if item.start >= rest {
            kept.push_str(&code[rest..item.start]);
            kept.extend(code[item.clone()].chars().map(|c| if c == '\n' { '\n' } else { ' ' }));
            rest = item.end;
        }
    }
    kept + &code[rest..]
}

/// The modules with a file of their own that only tests have.
pub(super) fn modules(code: &str) -> impl Iterator<Item = &str> {
    items(code).filter_map(|item| {
        let (_, declaration) = code[item].split_once("mod ")?;
        declaration.trim_end().ends_with(';').then(|| leading_name(declaration))
    })
}

fn items(code: &str) -> impl Iterator<Item = Range<usize>> {
    MARKS.iter().flat_map(move |mark| {
        code.match_indices(mark).map(move |(at, _)| at..at + item_length(&code[at..]))
    })
}

/// The length of the item that `code` begins with: up to its semicolon, or the end of its block.
fn item_length(code: &str) -> usize {
    let mut depth = 0;
    for (at, c) in code.char_indices() {
        match c {
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth -= 1,
            _ => {}
        }
        if depth < 0 {
            return at;
        }
        if depth == 0 && matches!(c, ';' | '}') {
            return at + 1;
        }
    }
    code.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_of_tests_are_blank() {
        for (code, kept) in [
            ("a; #[cfg(test)] mod tests { fn f() {} } b", "a; b"),
            ("#[cfg(test)]\n#[allow(x)]\nfn f(a: [u8; 2]) { g(); }\nfn h() {}", "fn h() {}"),
            ("#[cfg(test)] mod a; mod b;", "mod b;"),
            ("#[cfg(all(test, unix))] const A: B = B { c: [0; 1] }; d", "; d"),
            ("{ x: #[cfg(test)] y } z", "{ x: } z"),
        ] {
            let blank = blanked(code);
            assert_eq!(blank.split_whitespace().collect::<Vec<_>>().join(" "), kept);
            assert_eq!(blank.lines().count(), code.lines().count());
        }
    }

    #[test]
    fn only_modules_with_a_file_are_named() {
        let code = "#[cfg(test)]\nmod a;\nmod b;\n#[cfg(test)]\nmod c { mod d; }\n";
        assert_eq!(modules(code).collect::<Vec<_>>(), ["a"]);
    }
}
