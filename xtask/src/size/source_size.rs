//! Lines and public types of sources.

use std::collections::BTreeMap;

use super::part::Part;
use crate::tidy::source::Source;

/// The folder of the Python package.
const PYTHON: &str = "python/libration/";

/// Items that are types of a public interface; unreachable ones are no `pub`, which the compiler checks.
const TYPES: [&str; 4] = ["struct", "enum", "trait", "type"];

/// All crates, and the Python package, by name.
pub(super) fn of(sources: &[Source]) -> Vec<Part> {
    let mut parts: BTreeMap<String, Part> = BTreeMap::new();
    for source in sources {
        let Some(name) = part(source) else { continue };
        let part = parts.entry(name.clone()).or_insert_with(|| Part { name, ..Part::default() });
        part.lines += source.text.lines().count();
        part.types.extend(source.code_lines().filter_map(|(_, line)| public_type(line)));
    }
    parts.into_values().collect()
}

/// The crate, or the Python package, whose source this is.
fn part(source: &Source) -> Option<String> {
    if source.path.starts_with(PYTHON) {
        return Some("python".to_owned()).filter(|_| !source.path.ends_with(".txt"));
    }
    let folder = source.crate_folder()?.strip_suffix("/src/")?;
    Some(folder.rsplit('/').next().unwrap_or(folder).to_owned())
}

/// The name of the public type that a line declares.
fn public_type(line: &str) -> Option<String> {
    let (kind, rest) = line.trim_start().strip_prefix("pub ")?.split_once(' ')?;
    let name: String = rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
    (TYPES.contains(&kind) && !name.is_empty()).then_some(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_and_public_types_of_a_crate_are_those_of_its_sources() {
        let found = of(&[
            Source::new("crates/a/src/lib.rs", "pub struct A<T>(T);\npub(crate) enum B {}\n"),
            Source::new("crates/a/src/b/c.rs", "    pub trait C: D {}\n// pub struct E;\n"),
            Source::new("crates/a/tests/t.rs", "pub struct F;\n"),
            Source::new("python/libration/a.py", "pub struct = 1\n"),
            Source::new("xtask/src/main.rs", "\n"),
        ]);
        let shown: Vec<_> =
            found.iter().map(|p| (p.name.as_str(), p.lines, p.types.len())).collect();
        assert_eq!(shown, [("a", 4, 2), ("python", 1, 0), ("xtask", 1, 0)]);
    }
}
