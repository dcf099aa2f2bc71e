//! A file of a crate, and the modules that are in it.

use std::ops::Range;

use super::code::{leading_name, words};
use super::source::Source;
use super::test_items;

/// Words before the name of an item in its definition.
const DEFINITIONS: [&str; 9] =
    ["const", "enum", "fn", "macro_rules!", "static", "struct", "trait", "type", "union"];

/// The path of a module from the root of its crate, which is empty.
pub(super) type ModulePath = Vec<String>;

/// A file of a crate without its tests.
pub(super) struct File<'a> {
    pub(super) source: &'a Source,
    /// Its code, with what only tests have as blanks.
    pub(super) code: String,
    pub(super) module: ModulePath,
    /// The blocks `mod name { … }` in it, outer ones first.
    blocks: Vec<(String, Range<usize>)>,
}

impl<'a> File<'a> {
    /// A source of a crate.
    pub(super) fn new(source: &'a Source) -> Self {
        let code = test_items::blanked(&source.code);
        let module = module_path(name(source));
        File { source, module, blocks: blocks(&code), code }
    }

    /// Its path below the folder of its crate.
    pub(super) fn name(&self) -> &'a str {
        name(self.source)
    }

    /// Its module and the modules inside.
    pub(super) fn modules(&self) -> impl Iterator<Item = ModulePath> {
        let inside = self.blocks.iter().map(|(_, block)| self.module_at(block.end - 1));
        [self.module.clone()].into_iter().chain(inside)
    }

    /// The module that the code at `offset` is in.
    pub(super) fn module_at(&self, offset: usize) -> ModulePath {
        let around = self.blocks.iter().filter(|(_, block)| block.contains(&offset));
        self.module.iter().chain(around.map(|(name, _)| name)).cloned().collect()
    }

    /// Whether the module of `other` is one below that of this file.
    pub(super) fn is_above(&self, other: &File<'_>) -> bool {
        other.module.starts_with(&self.module)
    }

    /// Whether the file has a definition of `name`.
    pub(super) fn defines(&self, name: &str) -> bool {
        words(&self.code, name).any(|at| {
            let before = self.code[..at].trim_end();
            DEFINITIONS.iter().any(|keyword| before.ends_with(keyword))
        })
    }

    /// The macros with `#[macro_export]`.
    pub(super) fn exported_macros(&self) -> impl Iterator<Item = &str> {
        words(&self.code, "macro_export").filter_map(|at| {
            let (_, definition) = self.code[at..].split_once("macro_rules!")?;
            Some(leading_name(definition))
        })
    }
}

fn name(source: &Source) -> &str {
    &source.path[source.crate_folder().map_or(0, str::len)..]
}

/// The module of the file at `path` below the folder of its crate.
fn module_path(path: &str) -> ModulePath {
    let path = path.strip_suffix(".rs").unwrap_or(path);
    if ["lib", "main"].contains(&path) {
        return Vec::new();
    }
    let folders = path.strip_suffix("/mod").unwrap_or(path);
    folders.split('/').map(str::to_owned).collect()
}

fn blocks(code: &str) -> Vec<(String, Range<usize>)> {
    words(code, "mod")
        .filter_map(|at| {
            let name = leading_name(&code[at + "mod".len()..]);
            let open = at + code[at..].find(['{', ';'])?;
            let is_block = !name.is_empty() && code[open..].starts_with('{');
            is_block.then(|| (name.to_owned(), open..open + block_length(&code[open..])))
        })
        .collect()
}

/// The length of the block whose opening brace `code` begins with.
fn block_length(code: &str) -> usize {
    let mut depth = 0;
    let closing = code.bytes().position(|byte| {
        depth += i32::from(byte == b'{') - i32::from(byte == b'}');
        depth == 0
    });
    closing.map_or(code.len(), |at| at + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn module_of(path: &str) -> String {
        File::new(&Source::new(path, "")).module.join("::")
    }

    #[test]
    fn the_path_of_a_file_names_its_module() {
        assert_eq!(module_of("crates/a/src/lib.rs"), "");
        assert_eq!(module_of("xtask/src/main.rs"), "");
        assert_eq!(module_of("crates/a/src/b/mod.rs"), "b");
        assert_eq!(module_of("crates/a/src/b/c.rs"), "b::c");
    }

    #[test]
    fn blocks_are_modules() {
        let text = "mod a;\nmod b { mod c { x } y }\nz\n#[cfg(test)] mod tests { use super::*; }";
        let source = Source::new("crates/a/src/d.rs", text);
        let file = File::new(&source);
        let modules: Vec<String> = file.modules().map(|module| module.join("::")).collect();
        assert_eq!(modules, ["d", "d::b", "d::b::c"]);
        for (name, module) in [("x", "d::b::c"), ("y", "d::b"), ("z", "d")] {
            let at = file.code.find(name).unwrap();
            assert_eq!(file.module_at(at).join("::"), module);
        }
    }
}
