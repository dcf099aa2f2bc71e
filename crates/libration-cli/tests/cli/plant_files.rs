//! Plants in files of NumPy and MATLAB, through the binary.

use std::path::Path;

use predicates::prelude::*;

use super::advise::{json, libration};
use super::linear::written;

fn file(name: &str) -> String {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../libration-data/tests/array_file");
    Path::new(folder).join(name).to_string_lossy().into_owned()
}

#[test]
fn a_plant_in_a_file_of_arrays_gives_the_same_advice_as_the_same_one_in_a_table() {
    let folder = tempfile::tempdir().unwrap();
    let table = "\
a = [[0, 1], [-2.5, -0.125]]
b = [[0], [4]]
c = [[1, 0], [0, 1], [1, 1]]
sampling-period = 0.01
";
    let table = written(&folder, "plant.toml", table).to_string_lossy().into_owned();
    let advice = |plant: &str| {
        let gain = ["--gain=-0.5,0", "--period", "0.01", "--loss", "0.001"];
        json(&[&["advise", "--plant", plant][..], &gain].concat())
    };
    let expected = advice(&table);
    for name in ["deflated.npz", "v7.mat"] {
        let found = advice(&file(name));
        // The rest repeats the command line, which has the file.
        for key in ["answer", "plant_modes", "outputs", "margins", "cost", "deviations"] {
            assert_eq!(found[key], expected[key], "{name} {key}");
        }
    }
}

#[test]
fn an_array_that_is_no_matrix_is_refused_with_the_file_and_its_name() {
    for (name, wanted) in [("object.npz", "array `dt`"), ("structure.mat", "variable `plant`")] {
        let path = file(name);
        let wanted = predicate::str::contains(format!("cannot use `{path}` (--plant): {wanted}"));
        libration(&["advise", "--plant", &path, "--lqr", "1,1/1"]).code(2).stderr(wanted);
    }
}
