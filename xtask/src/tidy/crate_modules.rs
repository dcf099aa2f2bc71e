//! The modules of a crate, and the files that define the items which paths name.

use std::collections::{BTreeMap, HashMap};

use super::crate_file::{File, ModulePath};
use super::paths::{self, Import};
use super::source::Source;
use super::test_items;

/// The most imports that are followed for one path: those that name each other in a circle lead nowhere.
const MOST_IMPORTS: usize = 16;

/// A crate without its tests.
pub(super) struct Crate<'a> {
    pub(super) files: Vec<File<'a>>,
    modules: HashMap<ModulePath, Module>,
    /// The file of each macro with `#[macro_export]`, which is a member of the root.
    macros: HashMap<String, usize>,
}

#[derive(Default)]
struct Module {
    file: usize,
    imports: Vec<Import>,
}

/// A name that one file takes from another.
pub(super) struct Use {
    /// Index of the file that takes it.
    pub(super) from: usize,
    /// Index of the file that defines it.
    pub(super) to: usize,
    /// Its name where it is defined; `*` for all.
    pub(super) name: String,
    /// Where it stands in the code of the file that takes it.
    pub(super) offset: usize,
    /// Whether the file only passes it on.
    pub(super) is_reexport: bool,
}

/// Target of a path.
enum Place {
    Module(ModulePath),
    Item { file: usize, name: String },
}

/// The crates that the sources are of.
pub(super) fn crates(sources: &[Source]) -> Vec<Crate<'_>> {
    let mut folders: BTreeMap<&str, Vec<File<'_>>> = BTreeMap::new();
    for source in sources {
        if let Some(folder) = source.crate_folder() {
            folders.entry(folder).or_default().push(File::new(source));
        }
    }
    folders.into_values().map(Crate::new).collect()
}

impl<'a> Crate<'a> {
    fn new(mut files: Vec<File<'a>>) -> Self {
        let of_tests = |file: &File<'_>| {
            let modules = test_items::modules(&file.source.code);
            modules.map(|name| child(&file.module, name)).collect::<Vec<_>>()
        };
        let tests: Vec<ModulePath> = files.iter().flat_map(of_tests).collect();
        files.retain(|file| !tests.iter().any(|test| file.module.starts_with(test)));
        let (mut modules, mut macros) = (HashMap::<_, Module>::new(), HashMap::new());
        for (index, file) in files.iter().enumerate() {
            for module in file.modules() {
                modules.entry(module).or_insert(Module { file: index, imports: Vec::new() });
            }
            for import in paths::imports(&file.code) {
                modules.entry(file.module_at(import.offset)).or_default().imports.push(import);
            }
            macros.extend(file.exported_macros().map(|name| (name.to_owned(), index)));
        }
        Crate { files, modules, macros }
    }

    /// The names that files take from other files, by import or by path.
    pub(super) fn uses(&self) -> Vec<Use> {
        (0..self.files.len()).flat_map(|index| self.uses_in(index)).collect()
    }

    fn uses_in(&self, from: usize) -> Vec<Use> {
        let code = &self.files[from].code;
        let imported = paths::imports(code).into_iter().filter_map(|import| {
            let (to, name) = self.origin(from, import.offset, &import.path, import.name == "*")?;
            let Import { offset, is_reexport, .. } = import;
            Some(Use { from, to, name, offset, is_reexport })
        });
        let qualified = paths::qualified(code).into_iter().filter_map(|(offset, path)| {
            let (to, name) = self.origin(from, offset, &path, false)?;
            Some(Use { from, to, name, offset, is_reexport: false })
        });
        imported.chain(qualified).filter(|taken| taken.to != from).collect()
    }

    /// The file that defines what `path` names at `offset` in the file `from`, and the name there.
    fn origin(
        &self,
        from: usize,
        offset: usize,
        path: &[String],
        is_glob: bool,
    ) -> Option<(usize, String)> {
        match self.resolve(&self.files[from].module_at(offset), path, MOST_IMPORTS)? {
            Place::Item { file, name } => Some((file, name)),
            Place::Module(module) if is_glob => {
                Some((self.modules.get(&module)?.file, "*".to_owned()))
            }
            // The paths in the code that begin with the module's name say what is taken from it.
            Place::Module(_) => None,
        }
    }

    /// The item that `path` names in the module `scope`; nothing where it leads out of the crate.
    fn resolve(&self, scope: &[String], path: &[String], imports: usize) -> Option<Place> {
        let imports = imports.checked_sub(1)?;
        let (first, mut rest) = path.split_first()?;
        let mut place = match first.as_str() {
            "crate" => Place::Module(Vec::new()),
            "self" => Place::Module(scope.to_vec()),
            "super" => {
                let further = rest.iter().take_while(|name| *name == "super").count();
                rest = &rest[further..];
                Place::Module(scope[..scope.len().checked_sub(1 + further)?].to_vec())
            }
            // Neither a module nor an import: another crate, or an item of this file.
            name => self.declared(scope, name, rest.is_empty(), imports)?,
        };
        while let (Place::Module(module), Some((name, after))) = (&place, rest.split_first()) {
            place = self.member(module, name, after.is_empty(), imports)?;
            rest = after;
        }
        Some(place)
    }

    /// The member `name` of a module, wherever it is defined.
    fn member(
        &self,
        module: &[String],
        name: &str,
        is_last: bool,
        imports: usize,
    ) -> Option<Place> {
        if self.is_declared(module, name) {
            return self.declared(module, name, is_last, imports);
        }
        let here = self.modules.get(module)?.file;
        let defined = |file| Some(Place::Item { file, name: name.to_owned() });
        if self.files[here].defines(name) {
            return defined(here);
        }
        match self.macros.get(name) {
            Some(&file) if module.is_empty() => defined(file),
            _ => self.through_globs(module, name, is_last, imports).or_else(|| defined(here)),
        }
    }

    fn is_declared(&self, module: &[String], name: &str) -> bool {
        self.import(module, name).is_some() || self.modules.contains_key(&child(module, name))
    }

    fn import(&self, module: &[String], name: &str) -> Option<&Import> {
        // `use name` of a macro makes the module's own macro a member of it.
        let brings = |import: &&Import| import.name == name && import.path != [name];
        self.modules.get(module)?.imports.iter().find(brings)
    }

    /// The import or the module `name` of a module. At the end of a path the import comes first, as that of a
    /// function from a module of the same name does.
    fn declared(
        &self,
        module: &[String],
        name: &str,
        is_last: bool,
        imports: usize,
    ) -> Option<Place> {
        let module_of_name = child(module, name);
        let is_module = self.modules.contains_key(&module_of_name);
        match self.import(module, name) {
            Some(import) if is_last || !is_module => self.resolve(module, &import.path, imports),
            _ => is_module.then_some(Place::Module(module_of_name)),
        }
    }

    /// The item `name` that a module has through `use …::*`.
    fn through_globs(
        &self,
        module: &[String],
        name: &str,
        is_last: bool,
        imports: usize,
    ) -> Option<Place> {
        let globs = self.modules.get(module)?.imports.iter().filter(|import| import.name == "*");
        globs.filter_map(|glob| self.resolve(module, &glob.path, imports)).find_map(|place| {
            let Place::Module(other) = place else { return None };
            let file = &self.files[self.modules.get(&other)?.file];
            let has_name = self.is_declared(&other, name) || file.defines(name);
            has_name.then(|| self.member(&other, name, is_last, imports))?
        })
    }
}

fn child(module: &[String], name: &str) -> ModulePath {
    [module, &[name.to_owned()]].concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The uses in a crate of these files, as `from -> to: name`.
    fn uses(files: &[(&str, &str)]) -> Vec<String> {
        let source =
            |(name, text): &(&str, &str)| Source::new(&format!("crates/a/src/{name}.rs"), text);
        let sources: Vec<Source> = files.iter().map(source).collect();
        let whole = &crates(&sources)[0];
        let file = |index: usize| whole.files[index].name().trim_end_matches(".rs");
        let shown = |u: &Use| format!("{} -> {}: {}", file(u.from), file(u.to), u.name);
        whole.uses().iter().map(shown).collect()
    }

    #[test]
    fn reexports_lead_to_the_file_that_defines_an_item() {
        let found = uses(&[
            ("lib", "mod a; mod d; pub use a::X as Y;"),
            ("a/mod", "mod b; mod c; pub(crate) use self::b::*; pub use c::X; struct Own;"),
            ("a/b", "pub fn item() {} pub use super::c::other;"),
            ("a/c", "pub struct X; pub fn other() {}"),
            ("d", "use crate::{Y, a::{item, other}}; fn f(x: super::a::Own) {}"),
        ]);
        let of_d: Vec<&String> = found.iter().filter(|u| u.starts_with('d')).collect();
        assert_eq!(of_d, ["d -> a/c: X", "d -> a/b: item", "d -> a/c: other", "d -> a/mod: Own"]);
    }

    #[test]
    fn a_path_through_an_imported_module_names_its_item() {
        let files = [
            ("lib", "mod a; mod b;"),
            (
                "a",
                "use super::b as it; use other::c; fn f() { it::g::<u8>(); c::h(); x.b::<u8>(); }",
            ),
            ("b", "pub fn g() {}"),
        ];
        assert_eq!(uses(&files), ["a -> b: g"]);
    }

    #[test]
    fn macros_are_where_they_are_written() {
        let files = [
            ("lib", "mod a; mod b; mod c;"),
            ("a", "#[macro_export] macro_rules! m { () => {} }"),
            ("b", "macro_rules! n { () => {} } pub(crate) use n;"),
            ("c", "use crate::b::n; fn f() { crate::m!(); }"),
        ];
        assert_eq!(uses(&files), ["c -> b: n", "c -> a: m"]);
    }

    #[test]
    fn imports_that_name_each_other_and_other_crates_lead_nowhere() {
        let files = [
            ("lib", "mod a; mod b; use std::fmt;"),
            ("a", "pub use crate::b::X;"),
            ("b", "pub use crate::a::X; use crate::fmt; use super::super::Y;"),
        ];
        assert!(uses(&files).is_empty());
    }
}
