//! The engine as assembly.

use std::path::{Path, PathBuf};
use std::process::Stdio;

use crate::{command, workspace};

/// Compiles the engine and returns the file that holds its assembly.
///
/// Without link-time optimisation: with it the compiler leaves vectors to the linker, and what it
/// prints has none. In a folder of its own, which keeps other builds as they are; names of functions
/// in the newer of the two manglings, which tells types and widths.
pub(super) fn build() -> Result<PathBuf, String> {
    let folder = workspace::target().join("codegen");
    let mut compile = command::cargo(
        "rustc --package libration-batch --lib --release --message-format=json-render-diagnostics \
         -- --emit asm -C symbol-mangling-version=v0",
    );
    compile
        .env("CARGO_TARGET_DIR", folder)
        .env("CARGO_PROFILE_RELEASE_LTO", "off")
        .stderr(Stdio::inherit());
    let messages = command::output(&mut compile)?;
    of_artifact(&messages).ok_or_else(|| "cargo does not say where it put the engine".to_owned())
}

/// The assembly beside the metadata of the engine that cargo's messages name.
///
/// Old files lie beside it, with other numbers in their names.
fn of_artifact(messages: &str) -> Option<PathBuf> {
    let metadata = messages
        .split('"')
        .filter(|word| word.ends_with(".rmeta"))
        .map(|path| PathBuf::from(path.replace(r"\\", r"\")))
        .find(|path| name(path).is_some_and(|name| name.starts_with("liblibration_batch-")))?;
    let unit = name(&metadata)?.strip_prefix("lib")?;
    Some(metadata.with_file_name(unit).with_extension("s"))
}

fn name(path: &Path) -> Option<&str> {
    path.file_name()?.to_str()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_assembly_lies_beside_the_metadata() {
        let messages = r#"{"filenames":["t/deps/libhalf-1.rlib","t/deps/libhalf-1.rmeta"]}
{"filenames":["t/liblibration_batch.rlib","t/deps/liblibration_batch-2.rmeta"],"fresh":true}"#;
        assert_eq!(of_artifact(messages), Some(PathBuf::from("t/deps/libration_batch-2.s")));
        assert_eq!(of_artifact("{}"), None);
    }
}
