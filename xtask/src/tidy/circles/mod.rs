//! Files use each other in one direction. Two may share one noun; more cannot be read one at a time.
//!
//! A module may use the modules that it consists of, and they may use what it defines: that is no circle.

mod components;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use super::crate_modules::{self, Crate};
use super::finding::Finding;
use super::source::Source;

/// The most files that may use each other.
const LARGEST: usize = 2;

/// The names that one file takes from another, by the indices of both.
type Edges = BTreeMap<(usize, usize), BTreeSet<String>>;

/// Circles of more than two files of a crate, or of more than two modules of its root, at the first file of each.
pub(super) fn check(sources: &[Source]) -> Vec<Finding> {
    let crates = crate_modules::crates(sources);
    let found = |within: &Crate<'_>| match circles(within) {
        // A circle of files is told once.
        files if files.is_empty() => circles_of_modules(within),
        files => files,
    };
    crates.iter().flat_map(found).collect()
}

/// Circles of modules of the root, whichever of their files use each other.
fn circles_of_modules(within: &Crate<'_>) -> Vec<Finding> {
    let top = |file: usize| within.files[file].module.first();
    let mut modules: Vec<&String> = (0..within.files.len()).filter_map(top).collect();
    modules.sort_unstable();
    modules.dedup();
    let mut graph = vec![Vec::new(); modules.len()];
    for taken in within.uses() {
        let (Some(from), Some(to)) = (top(taken.from), top(taken.to)) else { continue };
        let place = |module| modules.binary_search(&module);
        if let (true, Ok(from), Ok(to)) = (from != to, place(from), place(to)) {
            graph[from].push(to);
        }
    }
    let circles =
        components::components(&graph).into_iter().filter(|circle| circle.len() > LARGEST);
    circles
        .filter_map(|circle| {
            let names: Vec<&str> = circle.iter().map(|&module| modules[module].as_str()).collect();
            let first = within.files.iter().find(|file| file.module.first() == Some(modules[circle[0]]))?;
            let advice = format!(
                "the modules {} use each other in a circle: move the type that they share down into a module of its own",
                names.join(", ")
            );
            Some(Finding::new(&first.source.path, 1, advice))
        })
        .collect()
}

fn circles(within: &Crate<'_>) -> Vec<Finding> {
    let edges = edges(within);
    let mut graph = vec![Vec::new(); within.files.len()];
    for &(from, to) in edges.keys() {
        graph[from].push(to);
    }
    let components = components::components(&graph).into_iter();
    let circles = components.filter(|files| files.len() > LARGEST);
    circles.map(|files| finding(within, &files, &edges)).collect()
}

fn edges(within: &Crate<'_>) -> Edges {
    let mut edges = Edges::new();
    for taken in within.uses().into_iter().filter(|taken| !taken.is_reexport) {
        if !within.files[taken.from].is_above(&within.files[taken.to]) {
            edges.entry((taken.from, taken.to)).or_default().insert(taken.name);
        }
    }
    edges
}

fn finding(within: &Crate<'_>, circle: &[usize], edges: &Edges) -> Finding {
    let mut advice = format!(
        "{} files use each other in a circle: move the type that they share down into a file of \
         its own",
        circle.len()
    );
    for ((from, to), names) in edges {
        if circle.contains(from) && circle.contains(to) {
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            let (from, to) = (within.files[*from].name(), within.files[*to].name());
            // Writing to a string does not fail.
            let _ = write!(advice, "\n    {from} -> {to}: {}", names.join(", "));
        }
    }
    Finding::new(&within.files[circle[0]].source.path, 1, advice)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The findings in a crate of these files below its root.
    fn findings(files: &[(&str, &str)]) -> Vec<Finding> {
        let source =
            |(name, text): &(&str, &str)| Source::new(&format!("crates/a/src/{name}.rs"), text);
        check(&files.iter().map(source).collect::<Vec<Source>>())
    }

    #[test]
    fn a_circle_of_three_is_found_with_its_edges() {
        let found = findings(&[
            ("lib", "mod a; mod b; mod c; mod d;"),
            ("a", "use super::b::{self, B as Other};\npub fn a() { b::g() }"),
            ("b", "pub struct B; pub fn g() { crate::c::C::new() }"),
            ("c", "use crate::a::a; pub struct C;"),
            ("d", "use crate::{a::a, c::C};"),
        ]);
        let [finding] = found.as_slice() else { panic!("{found:?}") };
        assert_eq!(finding.place(), ("crates/a/src/a.rs", 1));
        let edges = "\n    a.rs -> b.rs: B, g\n    b.rs -> c.rs: C\n    c.rs -> a.rs: a";
        assert!(finding.to_string().ends_with(edges), "{finding}");
    }

    #[test]
    fn a_circle_of_three_folders_is_found_though_no_files_form_one() {
        let files = [
            ("lib", "mod a; mod b; mod c;"),
            ("a/mod", "mod one; mod two;"),
            ("a/one", "use crate::b::two::F; pub struct F;"),
            ("a/two", "pub struct F;"),
            ("b/mod", "mod one; pub mod two;"),
            ("b/one", "pub use crate::c::two::F;"),
            ("b/two", "pub struct F;"),
            ("c/mod", "mod one; pub mod two;"),
            ("c/one", "use crate::a::two::F;"),
            ("c/two", "pub struct F;"),
        ];
        let found = findings(&files);
        let [finding] = found.as_slice() else { panic!("{found:?}") };
        assert!(finding.to_string().contains("the modules a, b, c use each other"), "{finding}");
    }

    #[test]
    fn a_circle_of_two_passes() {
        let files = [
            ("lib", "mod a; mod b;"),
            ("a", "use super::b::B; pub struct A;"),
            ("b", "use super::a::A; pub struct B;"),
        ];
        assert!(findings(&files).is_empty());
    }

    #[test]
    fn a_circle_through_reexports_is_one_of_the_files_that_define_the_items() {
        let root = ("m/mod", "mod a; mod b; mod c; pub use a::A; pub(crate) use {b::B, c::C};");
        let [a, b] = [("m/a", "use super::B; pub struct A;"), ("m/b", "use super::C; struct B;")];
        let tied = findings(&[root, a, b, ("m/c", "use crate::m::A; struct C;")]);
        assert_eq!(tied.len(), 1);
        assert!(!tied[0].to_string().contains("mod.rs"), "{}", tied[0]);
        assert!(findings(&[root, a, b, ("m/c", "struct C;")]).is_empty());
    }

    #[test]
    fn a_module_may_use_the_modules_below_it() {
        let files = [
            ("m/mod", "mod a; mod b; pub struct M; fn f() { a::f(); b::f(); }"),
            ("m/a", "use super::M; pub fn f() {}"),
            ("m/b", "use super::M; pub fn f() {}"),
        ];
        assert!(findings(&files).is_empty());
    }

    #[test]
    fn what_only_tests_use_is_ignored() {
        let test = "pub struct C; #[cfg(test)] mod tests { use crate::a::A; }";
        let files = [
            ("lib", "mod a; mod b; mod c; #[cfg(test)] mod tests;"),
            ("a", "use crate::b::B; pub struct A;"),
            ("b", "use crate::c::C; pub struct B;"),
            ("c", test),
            ("tests", "use crate::a::A; pub struct T;"),
        ];
        assert!(findings(&files).is_empty());
    }
}
