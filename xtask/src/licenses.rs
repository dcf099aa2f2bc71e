//! `cargo xtask licenses`: the licenses of all packages that are linked into the program and the Python package, as one file.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::{Outcome, command, workspace};

/// The name of the file, in the root of the workspace. The wheel and the source distribution contain it.
const FILE: &str = "THIRD-PARTY-LICENSES.txt";

/// The packages that users get in compiled form.
const ROOTS: [&str; 2] = ["libration-cli", "libration-py"];

const HEAD: &str = "The program and the Python package of Libration contain the packages below, under these licenses.\n";

/// The license of Libration, whose text packages without one get under their own authors.
const MIT: &str = include_str!("../../LICENSE-MIT");

/// Writes the file.
pub(crate) fn write() -> Outcome {
    let path = workspace::root().join(FILE);
    fs::write(&path, text()?).map_err(|error| format!("{}: {error}", path.display()))
}

/// Fails if the file is not that of the locked dependencies.
pub(crate) fn check() -> Outcome {
    match fs::read_to_string(workspace::root().join(FILE)) {
        Ok(found) if found == text()? => Ok(()),
        _ => Err(format!(
            "{FILE} is not that of the dependencies in Cargo.lock: `cargo xtask licenses` writes it"
        )),
    }
}

fn text() -> Result<String, String> {
    let metadata = command::output(&mut command::cargo("metadata --format-version 1 --locked"))?;
    let metadata: Value = serde_json::from_str(&metadata).map_err(|error| error.to_string())?;
    let mut by_license: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for package in linked(&metadata) {
        let field = |name: &str| package[name].as_str().unwrap_or_default();
        let title = format!("{} {} ({})", field("name"), field("version"), field("license"));
        let folder = Path::new(field("manifest_path")).parent().unwrap_or(Path::new(""));
        let license = license(folder, package)?;
        by_license.entry(license).or_default().insert(title);
    }
    let mut sections: Vec<(BTreeSet<String>, String)> =
        by_license.into_iter().map(|(license, packages)| (packages, license)).collect();
    sections.sort();
    let mut text = HEAD.to_owned();
    for (packages, license) in sections {
        let packages: Vec<String> = packages.into_iter().collect();
        // Writing to a string cannot fail.
        let _ = write!(text, "\n{}\n{}\n\n{license}\n", "=".repeat(80), packages.join("\n"));
    }
    Ok(text)
}

/// The packages of others that are linked into what users get, on any platform. Macros and build scripts are not linked.
fn linked(metadata: &Value) -> Vec<&Value> {
    fn list(value: &Value) -> &[Value] {
        value.as_array().map_or(&[], Vec::as_slice)
    }
    let packages: BTreeMap<&str, &Value> = list(&metadata["packages"])
        .iter()
        .filter_map(|package| Some((package["id"].as_str()?, package)))
        .collect();
    let is_macro = |package: &Value| {
        list(&package["targets"]).iter().any(|t| list(&t["kind"]).contains(&"proc-macro".into()))
    };
    let nodes: BTreeMap<&str, &Value> = list(&metadata["resolve"]["nodes"])
        .iter()
        .filter_map(|node| Some((node["id"].as_str()?, node)))
        .collect();
    let mut waiting: Vec<&str> = packages
        .iter()
        .filter(|(_, package)| ROOTS.iter().any(|root| package["name"] == *root))
        .map(|(id, _)| *id)
        .collect();
    let mut found = BTreeSet::new();
    while let Some(id) = waiting.pop() {
        if !found.insert(id) {
            continue;
        }
        for dependency in nodes.get(id).map_or(&[][..], |n| list(&n["deps"])) {
            let is_linked = list(&dependency["dep_kinds"]).iter().any(|d| d["kind"].is_null());
            let package = dependency["pkg"].as_str().unwrap_or_default();
            if is_linked && packages.get(package).is_some_and(|package| !is_macro(package)) {
                waiting.push(package);
            }
        }
    }
    found
        .iter()
        .filter_map(|id| packages.get(id).copied())
        .filter(|p| !p["source"].is_null())
        .collect()
}

/// The texts in the folder of a package: its notices and, of several licenses to choose from, that of MIT.
fn license(folder: &Path, package: &Value) -> Result<String, String> {
    let unread = |error| format!("{}: {error}", folder.display());
    let mut notices = Vec::new();
    let mut licenses = Vec::new();
    for entry in fs::read_dir(folder).map_err(unread)? {
        let path = entry.map_err(unread)?.path();
        let name = upper(&path);
        if !path.is_file() {
            continue;
        }
        if name.starts_with("NOTICE") {
            notices.push(path);
        } else if ["LICENSE", "LICENCE", "COPYING", "UNLICENSE"].iter().any(|n| name.starts_with(n))
        {
            licenses.push(path);
        }
    }
    let is_choice = package["license"].as_str().is_some_and(|l| !l.contains(" AND "));
    let is_mit = |path: &PathBuf| {
        upper(path).trim_end_matches(".MD").trim_end_matches(".TXT").ends_with("MIT")
    };
    if is_choice && licenses.iter().any(is_mit) {
        licenses.retain(is_mit);
    }
    licenses.append(&mut notices);
    licenses.sort();
    let mut texts = Vec::new();
    for path in &licenses {
        let text = fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
        let lines: Vec<&str> = text.lines().map(str::trim_end).collect();
        texts.push(lines.join("\n").trim_matches('\n').to_owned());
    }
    if !texts.is_empty() {
        return Ok(texts.join("\n\n"));
    }
    let allowed = package["license"].as_str().unwrap_or_default();
    if !allowed.contains("MIT") {
        return Err(format!("{} has no license text: {allowed:?}", package["name"]));
    }
    let authors: Vec<&str> =
        package["authors"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
    let holders =
        if authors.is_empty() { "the authors of the package".into() } else { authors.join(", ") };
    let (_, terms) = MIT.split_once("\n\nPermission").ok_or("LICENSE-MIT has no terms")?;
    Ok(format!("Copyright (c) {holders}\n\nPermission{}", terms.trim_end()))
}

fn upper(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().to_uppercase()
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::linked;

    #[test]
    fn macros_build_scripts_and_own_packages_are_not_linked_and_those_of_dependencies_are() {
        let package = |name: &str, source: Option<&str>, kind: &str| json!({ "id": name, "name": name, "source": source, "targets": [{ "kind": [kind] }] });
        let needs = |name: &str, kind: Option<&str>| json!({ "pkg": name, "dep_kinds": [{ "kind": kind }] });
        let metadata = json!({
            "packages": [
                package("libration-py", None, "cdylib"),
                package("libration", None, "lib"),
                package("zstd", Some("registry"), "lib"),
                package("cc", Some("registry"), "lib"),
                package("derive", Some("registry"), "proc-macro"),
                package("stranger", Some("registry"), "lib"),
            ],
            "resolve": { "nodes": [
                { "id": "libration-py", "deps": [needs("libration", None), needs("derive", None)] },
                { "id": "libration", "deps": [needs("zstd", None), needs("cc", Some("build"))] },
                { "id": "zstd", "deps": [] },
            ] },
        });
        let names: Vec<&str> =
            linked(&metadata).iter().filter_map(|p| p["name"].as_str()).collect();
        assert_eq!(names, ["zstd"]);
    }
}
