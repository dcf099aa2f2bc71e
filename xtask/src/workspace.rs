//! Paths of the workspace and of build products.

use std::env;
use std::path::{Path, PathBuf};

/// The folder of the workspace.
pub(crate) fn root() -> PathBuf {
    let manifest = env::var_os("CARGO_MANIFEST_DIR")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")), PathBuf::from);
    manifest.parent().map_or_else(|| manifest.clone(), Path::to_path_buf)
}

/// The folder that cargo builds into.
pub(crate) fn target() -> PathBuf {
    match env::var_os("CARGO_TARGET_DIR") {
        // Commands run in the root, so that is where cargo looks for a relative folder, too.
        Some(folder) => root().join(folder),
        None => root().join("target"),
    }
}

/// A program that cargo has built, such as `debug/examples/orbit`.
pub(crate) fn built(program: &str) -> PathBuf {
    target().join(format!("{program}{}", env::consts::EXE_SUFFIX))
}

/// The crates of the engine: numbers and physics, which do no input or output.
pub(crate) const ENGINE: [&str; 8] = [
    "libration",
    "libration-analysis",
    "libration-batch",
    "libration-core",
    "libration-equations",
    "libration-linear",
    "libration-linear-loops",
    "libration-live",
];

/// Whether a file is a source of the engine.
pub(crate) fn in_engine(path: &str) -> bool {
    let file = |name| path.strip_prefix("crates/")?.strip_prefix(name)?.strip_prefix("/src/");
    ENGINE.into_iter().any(|name| file(name).is_some())
}
