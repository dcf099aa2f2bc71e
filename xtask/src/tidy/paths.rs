//! The names that Rust takes from elsewhere: those that it imports, and the paths in its code.

use std::ops::Range;

use super::code::{is_word, words};

/// One name that a `use` brings into scope.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Import {
    /// The segments of its path; of `use a::*` those before the star.
    pub(super) path: Vec<String>,
    /// Its name here; `*` for every name of a module.
    pub(super) name: String,
    /// Whether the `use` has a visibility, and so is there for other modules.
    pub(super) is_reexport: bool,
    /// Where the `use` begins.
    pub(super) offset: usize,
}

/// All imports in `code`, with groups in braces taken apart.
pub(super) fn imports(code: &str) -> Vec<Import> {
    let mut imports = Vec::new();
    for statement in use_statements(code) {
        let before = code[..statement.start].trim_end();
        let is_reexport = before.ends_with("pub") || is_restricted(before);
        let tree = &code[statement.start + "use".len()..statement.end];
        let tree = tree.split_whitespace().collect::<Vec<_>>().join(" ");
        expand(&tree, &[], &mut |path, name| {
            imports.push(Import { path, name, is_reexport, offset: statement.start });
        });
    }
    imports
}

/// Whether `before` ends with `pub(…)`.
fn is_restricted(before: &str) -> bool {
    before.ends_with(')') && before.rfind('(').is_some_and(|at| before[..at].ends_with("pub"))
}

/// The statements `use …`, each up to its semicolon.
fn use_statements(code: &str) -> impl Iterator<Item = Range<usize>> {
    words(code, "use").filter_map(|at| {
        let tree = code[at + "use".len()..].trim_start();
        // A type `impl Trait + use<'a>` captures a lifetime and imports nothing.
        let end = at + code[at..].find(';')?;
        (!tree.starts_with('<')).then_some(at..end)
    })
}

/// Calls `add` with the path and the name of each leaf of a tree of imports.
fn expand(tree: &str, prefix: &[String], add: &mut impl FnMut(Vec<String>, String)) {
    let tree = tree.trim();
    if let Some((path, group)) = tree.split_once('{') {
        let prefix = [prefix, &segments(path)].concat();
        for branch in branches(group.strip_suffix('}').unwrap_or(group)) {
            expand(branch, &prefix, add);
        }
        return;
    }
    let (path, alias) = tree.split_once(" as ").map_or((tree, None), |(p, a)| (p, Some(a)));
    let mut path = [prefix, &segments(path)].concat();
    let is_glob = path.last().is_some_and(|last| last == "*");
    // `a::{self}` is `a`.
    if is_glob || path.len() > 1 && path.last().is_some_and(|last| last == "self") {
        path.pop();
    }
    let own = if is_glob { Some("*") } else { path.last().map(String::as_str) };
    if let Some(name) = alias.or(own).map(str::to_owned) {
        add(path, name);
    }
}

fn segments(path: &str) -> Vec<String> {
    path.split("::").map(str::trim).filter(|name| !name.is_empty()).map(str::to_owned).collect()
}

/// The parts of a group between its outermost commas.
fn branches(group: &str) -> impl Iterator<Item = &str> {
    let mut depth = 0;
    group
        .split(move |c| {
            depth += i32::from(c == '{') - i32::from(c == '}');
            c == ',' && depth == 0
        })
        .filter(|branch| !branch.trim().is_empty())
}

/// Where paths of names begin in `code` outside of imports, with their segments up to the first type argument.
pub(super) fn qualified(code: &str) -> Vec<(usize, Vec<String>)> {
    let uses: Vec<Range<usize>> = use_statements(code).collect();
    let mut paths = Vec::new();
    for (colons, _) in code.match_indices("::") {
        let before = &code[..colons];
        let start = before.trim_end_matches(is_word).len();
        // `x.sum::<f64>()` is a method, and `::b` of `a::b::c` the middle of a path.
        let is_first = !before[..start].ends_with([':', '.']);
        if start < colons && is_first && !uses.iter().any(|statement| statement.contains(&start)) {
            paths.push((start, segments(path_at(&code[start..]))));
        }
    }
    paths
}

/// The path that `code` begins with.
fn path_at(code: &str) -> &str {
    let mut length = 0;
    loop {
        let name = &code[length..];
        length += name.find(|c| !is_word(c)).unwrap_or(name.len());
        if !code[length..].strip_prefix("::").is_some_and(|rest| rest.starts_with(is_word)) {
            return &code[..length];
        }
        length += "::".len();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn imported(code: &str) -> Vec<String> {
        let shown = |import: &Import| format!("{} = {}", import.name, import.path.join("::"));
        imports(code).iter().map(shown).collect()
    }

    #[test]
    fn groups_are_taken_apart() {
        let code = "use super::{self, a::{b, c as d}, e::*,\n};\nuse f;\n";
        let expected =
            ["super = super", "b = super::a::b", "d = super::a::c", "* = super::e", "f = f"];
        assert_eq!(imported(code), expected);
    }

    #[test]
    fn a_use_with_a_visibility_is_a_reexport() {
        for visibility in ["pub ", "pub(crate) ", "pub(in crate::a) "] {
            assert!(imports(&format!("{visibility}use a::B;"))[0].is_reexport);
        }
        assert!(!imports("fn f(x: pub_t) {} use a::B;")[0].is_reexport);
        assert!(imports("fn f<'a>() -> impl Fn() + use<'a> { g(); }").is_empty());
    }

    #[test]
    fn paths_end_at_type_arguments_and_are_no_methods() {
        let code = "use a::b; let x = crate::c::D::<E>::f(g::H) + i.sum::<f64>() + <J>::k::l();";
        let paths: Vec<String> = qualified(code).iter().map(|(_, p)| p.join("::")).collect();
        assert_eq!(paths, ["crate::c::D", "g::H"]);
    }
}
