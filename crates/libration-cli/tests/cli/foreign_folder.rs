//! Models in folders of others: what else lies there is never run.

use std::env;
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;

use assert_cmd::Command;

/// Modules that Python would import, on its own or for the package.
const MODULES: [&str; 12] = [
    "sitecustomize.py",
    "usercustomize.py",
    "runpy.py",
    "argparse.py",
    "json.py",
    "os.py",
    "typing.py",
    "numpy.py",
    "mujoco.py",
    "libration/__init__.py",
    "libration/hosts/__init__.py",
    "libration/hosts/__main__.py",
];

/// Writes a module that leaves a file beside it when it runs.
fn write_module(folder: &Path, name: &str) {
    let path = folder.join(name);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    let mark = "import io; io.open(__file__ + '.ran', 'w').close()\n";
    fs::write(path, mark).unwrap();
}

/// The modules of a folder that ran in the program.
fn modules_that_ran(folder: &Path) -> Vec<&'static str> {
    let ran = |name: &&str| folder.join(format!("{name}.ran")).exists();
    MODULES.into_iter().filter(ran).collect()
}

/// A Python that ignores `PYTHONSAFEPATH`, as releases before 3.11 do.
fn old_python(folder: &Path) -> String {
    let path = folder.join("python3.10");
    fs::write(&path, "#!/bin/sh\nunset PYTHONSAFEPATH\nexec python3 \"$@\"\n").unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
    path.display().to_string()
}

#[test]
fn modules_beside_a_model_are_never_run() {
    let tools = tempfile::tempdir().unwrap();
    let old = old_python(tools.path());
    let other = tempfile::tempdir().unwrap();
    let elsewhere = other.path().display().to_string();
    let mut cases = Vec::new();
    for python in ["python3", &old] {
        for command in ["gains", "probe"] {
            cases.push((python, command, None));
        }
    }
    // Entries of the search path that stand for the current folder.
    for path in ["", ":", ".", "./", &format!(":{elsewhere}"), &format!("{elsewhere}:"), "HERE"] {
        cases.push((&old, "gains", Some(path.to_owned())));
    }
    for (python, command, path) in cases {
        let folder = tempfile::tempdir().unwrap();
        for module in MODULES {
            write_module(folder.path(), module);
        }
        fs::write(folder.path().join("arm.xml"), "<mujoco/>").unwrap();
        let mut program = Command::cargo_bin("libration").unwrap();
        program.args([command, "--mujoco", "arm.xml", "--python", python]).current_dir(&folder);
        if let Some(path) = &path {
            program.env("PYTHONPATH", path.replace("HERE", &folder.path().display().to_string()));
        }
        let output = program.output().unwrap();
        let what = format!("{command} {python} {path:?}: {output:?}");
        // The package may be installed for this interpreter or not; the model has no joints.
        assert!(matches!(output.status.code(), Some(1 | 2)), "{what}");
        let none: [&str; 0] = [];
        assert_eq!(modules_that_ran(folder.path()), none, "{what}");
    }
}

#[test]
fn other_folders_of_the_search_path_stay() {
    let other = tempfile::tempdir().unwrap();
    write_module(other.path(), "sitecustomize.py");
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("arm.xml"), "<mujoco/>").unwrap();
    let path = env::join_paths([Path::new(""), other.path()]).unwrap();
    let output = Command::cargo_bin("libration")
        .unwrap()
        .args(["gains", "--mujoco", "arm.xml"])
        .current_dir(&folder)
        .env("PYTHONPATH", path)
        .output()
        .unwrap();
    assert!(matches!(output.status.code(), Some(1 | 2)), "{output:?}");
    assert_eq!(modules_that_ran(other.path()), ["sitecustomize.py"]);
}

#[test]
fn a_missing_package_names_the_interpreter() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("-arm.xml"), "<mujoco/>").unwrap();
    // -S: an interpreter without packages.
    let python = folder.path().join("bare");
    fs::write(&python, "#!/bin/sh\nexec python3 -S -E \"$@\"\n").unwrap();
    fs::set_permissions(&python, fs::Permissions::from_mode(0o755)).unwrap();
    let output = Command::cargo_bin("libration")
        .unwrap()
        .args(["gains", "--mujoco=-arm.xml", "--python", "./bare"])
        .current_dir(&folder)
        .output()
        .unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{errors}");
    assert!(errors.contains("No module named 'libration'"), "{errors}");
    assert!(errors.contains("pip install 'libration[mujoco]' for this interpreter"), "{errors}");
}
