//! Functions, kernels and bytes of the libraries of the release program.

use std::collections::BTreeMap;

use rustc_demangle::demangle;
use serde_json::Value;

use super::part::Compiled;
use crate::command;

/// Segments of the paths of batch kernels.
const KERNELS: [&str; 2] = ["::run_baseline", "::vectorize"];

/// The libraries of the release program that lie in the workspace, by the name of the crate, and the program itself.
pub(super) fn of_release_program() -> Result<BTreeMap<String, Compiled>, String> {
    let build = "build --release -p libration-cli --message-format json-render-diagnostics";
    let messages = command::output(&mut command::cargo(build))?;
    let mut found = BTreeMap::new();
    for message in messages.lines() {
        let message: Value = serde_json::from_str(message).map_err(|error| error.to_string())?;
        if let Some((name, library)) = own_library(&message) {
            let mut nm = command::program("nm");
            nm.args(["--print-size", "--defined-only", library]);
            found.insert(name.to_owned(), functions(&command::output(&mut nm)?));
        }
    }
    Ok(found)
}

/// The name and the library of a crate of this workspace that a message of cargo tells of.
fn own_library(message: &Value) -> Option<(&str, &str)> {
    let manifest = message["manifest_path"].as_str()?;
    let name = manifest.strip_suffix("/Cargo.toml")?.rsplit('/').next()?;
    let is_own = message["package_id"].as_str()?.starts_with("path+");
    let mut files = message["filenames"].as_array()?.iter().filter_map(Value::as_str);
    let library = files.find(|file| file.ends_with(".rlib"))?;
    is_own.then_some((name, library))
}

/// Sums up what `nm --print-size` lists: address, size, kind and name.
fn functions(listed: &str) -> Compiled {
    let function = |line: &str| {
        let mut words = line.split_ascii_whitespace().skip(1);
        let (size, kind, name) = (words.next()?, words.next()?, words.next()?);
        let bytes = usize::from_str_radix(size, 16).ok()?;
        let name = demangle(name).to_string();
        let kernels = usize::from(KERNELS.iter().any(|kernel| name.contains(kernel)));
        ["t", "T", "w", "W"].contains(&kind).then_some(Compiled { functions: 1, kernels, bytes })
    };
    listed.lines().filter_map(function).fold(Compiled::default(), Compiled::plus)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_are_counted_with_their_bytes_and_data_is_not() {
        let listed = "\
            libration.o:\n\
            0000000000000000 0000000000000010 T _ZN1a3run17h0123456789abcdefE\n\
            0000000000000000 0000000000000020 t _ZN1a12run_baseline17h0123456789abcdefE\n\
            0000000000000000 0000000000000040 r _ZN1a5table17h0123456789abcdefE\n\
            0000000000000000 T without_size\n";
        let expected = Compiled { functions: 2, kernels: 1, bytes: 48 };
        assert_eq!(functions(listed), expected);
    }
}
