//! Which engine was read last: so that nobody compiles for minutes what nobody has changed.

use std::fs;
use std::path::{Path, PathBuf};

use crate::tidy::code;
use crate::{Outcome, command, workspace};

const HEADER: &str = "\
# The engine whose kernels `cargo xtask codegen` has read and found made of vectors: its compiler, its code without comments, what it
# depends on and how it is compiled, as a number. `codegen` writes this file anew; `ci` reads the kernels where it does not agree.
";

/// The inputs of the compilation of the kernels.
pub(super) fn seal() -> Result<String, String> {
    let compiler = command::output(command::program("rustc").arg("--version"))?;
    let tree = "tree --package libration-batch -e normal --prefix none";
    let tree = command::output(&mut command::cargo(tree))?;
    // Without the folder of the engine itself.
    let tree = tree.lines().map(|line| line.split(" (").next().unwrap_or_default().to_owned());
    let manifest = read(&workspace::root().join("Cargo.toml"))?;
    let profiles = manifest.split("\n[").filter(|table| table.starts_with("profile.release"));
    let profiles: Vec<String> = profiles.map(str::to_owned).collect();
    let mut paths = Vec::new();
    for name in ["libration-batch", "libration-core"] {
        gather(&workspace::root().join("crates").join(name).join("src"), &mut paths)?;
    }
    paths.sort();
    let sources = paths.iter().map(|path| Ok(code::of(&read(path)?)));
    let sources = sources.collect::<Result<Vec<String>, String>>()?;
    let all = tree.chain(profiles).chain(sources);
    Ok(format!("{HEADER}{}\n{:016x}\n", compiler.trim(), hash(all)))
}

/// Whether the engine is the one that was read.
pub(super) fn is_whole() -> bool {
    let recorded = read(&file());
    seal().is_ok_and(|seal| recorded.is_ok_and(|recorded| recorded == seal))
}

/// Keeps that this engine was read.
pub(super) fn keep() -> Outcome {
    let path = file();
    fs::write(&path, seal()?)
        .map_err(|error| format!("{} cannot be written: {error}", path.display()))
}

fn file() -> PathBuf {
    workspace::root().join("crates/libration/benches/codegen.txt")
}

fn read(path: &Path) -> Result<String, String> {
    fs::read_to_string(path).map_err(|error| format!("{} cannot be read: {error}", path.display()))
}

/// All files below a folder.
fn gather(folder: &Path, paths: &mut Vec<PathBuf>) -> Outcome {
    let unreadable = |error| format!("{} cannot be read: {error}", folder.display());
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        if path.is_dir() {
            gather(&path, paths)?;
        } else {
            paths.push(path);
        }
    }
    Ok(())
}

/// FNV-1a of all lines that are not blank: nobody wants to deceive anybody here.
fn hash(parts: impl IntoIterator<Item = String>) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for part in parts {
        for line in part.lines().map(str::trim).filter(|line| !line.is_empty()) {
            for byte in line.bytes().chain([b'\n']) {
                hash = (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
            }
        }
    }
    hash
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blank_lines_and_indentation_change_nothing_and_any_letter_does() {
        let hash = |text: &str| hash([text.to_owned()]);
        assert_eq!(hash("fn f() {\n\n    1\n}"), hash("fn f() {\n1\n}\n"));
        assert_ne!(hash("fn f() { 1 }"), hash("fn f() { 2 }"));
        assert_ne!(hash("ab\nc"), hash("a\nbc"));
    }

    #[test]
    fn the_seal_of_this_engine_names_its_compiler_and_is_the_same_twice() {
        let seal = seal().unwrap();
        assert!(seal.contains("\nrustc 1."), "{seal}");
        assert_eq!(seal, super::seal().unwrap());
    }
}
