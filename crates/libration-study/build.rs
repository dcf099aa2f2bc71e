//! Records the version of the compiler, for the description of the machine.

use std::process::Command;

fn main() {
    let compiler = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let version = Command::new(compiler).arg("--version").output().ok();
    let version = version.and_then(|output| String::from_utf8(output.stdout).ok());
    let version = version.as_deref().unwrap_or("an unknown compiler").trim();
    println!("cargo:rustc-env=LIBRATION_COMPILER={version}");
    println!("cargo:rerun-if-changed=build.rs");
}
