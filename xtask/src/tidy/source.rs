//! The files that rules look at.

use std::fs;
use std::io::ErrorKind;
use std::path::Path;

use super::code;
use crate::command;

/// Endings of the files that people write; a file without one is a script or a licence.
const WRITTEN: [&str; 15] = [
    "css", "html", "js", "json", "md", "py", "pyi", "rs", "sh", "toml", "ts", "txt", "yaml", "yml",
    "",
];

/// Folders that hold products, not sources.
const PRODUCTS: [&str; 4] = [".git", ".venv", "node_modules", "target"];

/// The folder in the root that a report is written to; a crate has the same name.
const REPORT: &str = "libration-report";

/// One text file of the project.
pub(crate) struct Source {
    /// From the root of the workspace, separated by `/`.
    pub(crate) path: String,
    /// All of it.
    pub(crate) text: String,
    /// Rust without comments and the insides of literals, line for line; empty for other files.
    pub(crate) code: String,
}

impl Source {
    /// The file at `path` with this text.
    pub(crate) fn new(path: &str, text: &str) -> Self {
        let code = if path.ends_with(".rs") { code::of(text) } else { String::new() };
        Source { path: path.to_owned(), text: text.to_owned(), code }
    }

    /// The lines, counted from one.
    pub(super) fn lines(&self) -> impl Iterator<Item = (usize, &str)> {
        (1..).zip(self.text.lines())
    }

    /// The lines of code, counted from one.
    pub(crate) fn code_lines(&self) -> impl Iterator<Item = (usize, &str)> {
        (1..).zip(self.code.lines())
    }

    /// The folder `…/src/` of the crate whose Rust this is; none for tests and examples.
    pub(crate) fn crate_folder(&self) -> Option<&str> {
        let crates = if self.path.starts_with("xtask/") { "" } else { "crates/" };
        let (name, _) = self.path.strip_prefix(crates)?.split_once("/src/")?;
        let is_crate = self.path.ends_with(".rs") && !name.contains('/');
        is_crate.then(|| &self.path[..crates.len() + name.len() + "/src/".len()])
    }

    /// The name without folders.
    pub(super) fn file_name(&self) -> &str {
        self.path.rsplit('/').next().unwrap_or_default()
    }
}

/// The sources that git tracks; all that lie in `root` where it is no checkout.
pub(crate) fn tracked(root: &Path) -> Result<Vec<Source>, String> {
    let mut list = command::program("git");
    list.args(["ls-files", "-z"]).current_dir(root);
    let mut paths: Vec<String> = match command::output(&mut list) {
        Ok(listed) => listed.split_terminator('\0').map(str::to_owned).collect(),
        Err(_) => Vec::new(),
    };
    if paths.is_empty() {
        walk(root, "", &mut paths)?;
    }
    paths.sort();
    let mut sources = Vec::new();
    for path in paths.iter().filter(|path| is_written(path)) {
        match fs::read_to_string(root.join(path)) {
            Ok(text) => sources.push(Source::new(path, &text)),
            // Deleted and not yet committed, or not text.
            Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::InvalidData) => {}
            Err(error) => return Err(format!("{path} cannot be read: {error}")),
        }
    }
    Ok(sources)
}

fn is_written(path: &str) -> bool {
    let extension = Path::new(path).extension().map_or("", |e| e.to_str().unwrap_or("?"));
    WRITTEN.contains(&extension)
}

/// Adds the files below `root/folder` to `paths`.
fn walk(root: &Path, folder: &str, paths: &mut Vec<String>) -> Result<(), String> {
    let entries = fs::read_dir(root.join(folder))
        .map_err(|error| format!("{} cannot be read: {error}", root.join(folder).display()))?;
    for entry in entries.flatten() {
        let Ok(name) = entry.file_name().into_string() else { continue };
        let path = if folder.is_empty() { name.clone() } else { format!("{folder}/{name}") };
        if !entry.path().is_dir() {
            paths.push(path);
        } else if !PRODUCTS.contains(&name.as_str()) && path != REPORT {
            walk(root, &path, paths)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scratch::Scratch;

    #[test]
    fn a_folder_that_is_no_checkout_is_walked() {
        let scratch = Scratch::new("walk").unwrap();
        fs::create_dir_all(scratch.path().join("crates/a/src")).unwrap();
        fs::create_dir_all(scratch.path().join("target/debug")).unwrap();
        for file in ["crates/a/src/lib.rs", "run", "figure.svg", "target/debug/made.rs"] {
            fs::write(scratch.path().join(file), "").unwrap();
        }
        let sources = tracked(scratch.path()).unwrap();
        let paths: Vec<&str> = sources.iter().map(|source| source.path.as_str()).collect();
        assert_eq!(paths, ["crates/a/src/lib.rs", "run"]);
    }
}
