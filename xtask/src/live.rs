//! The engine of live pages, compiled to WebAssembly.

use std::path::PathBuf;
use std::{env, fs};

use miniz_oxide::deflate::compress_to_vec_zlib;

use crate::Outcome;
use crate::command::{cargo, program, run};
use crate::workspace::{root, target};

const TARGET: &str = "wasm32-unknown-unknown";

/// Compiles `libration-live` and writes its module, compressed, to the assets of `libration-report`.
pub(crate) fn build() -> Outcome {
    run(program("rustup").args(["target", "add", TARGET]))?;
    // Messages of panics name files: those of the registry and of this checkout have the same names on all machines.
    let home = env::var_os("CARGO_HOME").map(PathBuf::from);
    let home = home.or_else(|| Some(env::home_dir()?.join(".cargo"))).unwrap_or_default();
    let registries = fs::read_dir(home.join("registry/src")).into_iter().flatten().flatten();
    let folders = registries.map(|entry| (entry.path(), "registry"));
    let folders = [(home.clone(), "cargo"), (root(), "libration")].into_iter().chain(folders);
    let flags: Vec<String> = folders
        .map(|(folder, name)| format!("--remap-path-prefix={}={name}", folder.display()))
        .collect();
    run(cargo("rustc --package libration-live --lib --crate-type cdylib --profile live --target")
        .arg(TARGET)
        .env("RUSTFLAGS", flags.join(" ")))?;
    let module = target().join(TARGET).join("live/libration_live.wasm");
    let bytes = fs::read(&module).map_err(|error| format!("{}: {error}", module.display()))?;
    let asset = root().join("crates/libration-report/assets/live/engine.wasm.zlib");
    let packed = compress_to_vec_zlib(&bytes, 10);
    println!("{}: {} bytes, {} compressed", asset.display(), bytes.len(), packed.len());
    fs::write(&asset, packed).map_err(|error| format!("{}: {error}", asset.display()))
}
