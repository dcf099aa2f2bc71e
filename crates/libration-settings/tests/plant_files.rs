//! Plants in files of NumPy and MATLAB; `tools/make_plant_files.py` writes them.

#![allow(clippy::unwrap_used)]

use std::path::PathBuf;

use libration::linear::{LinearPlant, Matrix};
use libration_settings::linear_loop::{PlantTable, parse_plant, read_plant};

fn path(name: &str) -> PathBuf {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../libration-data/tests/array_file");
    PathBuf::from(folder).join(name)
}

fn plant(name: &str) -> LinearPlant {
    let table = PlantTable { file: Some(path(name).display().to_string()), ..Default::default() };
    table.plant().unwrap()
}

fn matrix(rows: &[&[f64]]) -> Matrix {
    Matrix::from_rows(rows).unwrap()
}

#[test]
fn arrays_of_numpy_and_matlab_give_the_same_sampled_plant() {
    for name in ["stored.npz", "deflated.npz", "v5.mat", "v7.mat"] {
        let plant = plant(name);
        assert_eq!(plant.a, matrix(&[&[0.0, 1.0], &[-2.5, -0.125]]), "{name}");
        assert_eq!(plant.b, matrix(&[&[0.0], &[4.0]]), "{name}");
        assert_eq!(plant.c, matrix(&[&[1.0, 0.0], &[0.0, 1.0], &[1.0, 1.0]]), "{name}");
        assert_eq!(plant.d, Matrix::zeros(3, 1), "{name}");
        assert_eq!(plant.sampling_period, Some(0.01), "{name}");
    }
}

#[test]
fn names_noise_and_arrays_of_one_dimension_are_read() {
    let plant = plant("types.npz");
    assert_eq!(plant.b, matrix(&[&[0.0], &[4.0]]));
    assert_eq!(plant.g, matrix(&[&[0.0], &[3.0]]));
    assert_eq!(plant.sampling_period, None);
    let units: Vec<_> = plant.states.iter().map(|state| (&*state.name, &*state.unit)).collect();
    assert_eq!(units, [("angle", "rad"), ("ω", "rad/s")]);
}

#[test]
fn a_mechanical_plant_is_read_by_its_mass_and_stiffness() {
    let plant = plant("mechanical.npz");
    assert_eq!((plant.a.rows(), plant.b.columns()), (4, 1));
    let accelerations = [plant.a[(2, 0)], plant.a[(2, 1)], plant.a[(3, 0)], plant.a[(3, 1)]];
    assert_eq!(accelerations, [-3.0, 1.0, 0.5, -0.5]);
}

#[test]
fn a_mechanical_plant_has_its_positions_as_outputs_also_with_a_direct_path() {
    let table = parse_plant("mass = [[2]]\nd = [[0.5]]\nstates = [\"angle (rad)\"]", "plant.toml");
    let plant = table.unwrap().plant().unwrap();
    assert_eq!((plant.c.entries(), plant.d.entries()), (&[1.0, 0.0][..], &[0.5][..]));
    assert_eq!((&*plant.outputs[0].name, &*plant.outputs[0].unit), ("angle", "rad"));
    let wrong = parse_plant("mass = [[2]]\nb = [[1], [1]]", "plant.toml").unwrap().plant();
    let error = wrong.unwrap_err().to_string();
    assert!(error.starts_with("`force` is 2 × 1; expected 1 rows"), "{error}");
    let error = parse_plant("mass = [[2]]\nspring = 1", "plant.toml").unwrap_err();
    assert!(error.message().contains("unknown key `spring`"), "{}", error.message());
}

#[test]
fn an_error_names_the_file_the_array_and_what_is_expected() {
    let table = PlantTable { file: Some("plant.npy".to_owned()), ..Default::default() };
    let error = table.plant().unwrap_err().to_string();
    assert!(error.contains("`plant.npy`") && error.contains(".npz or .mat"), "{error}");
    for (name, parts) in [
        ("object.npz", ["array `dt`", "expected a real number"]),
        ("structure.mat", ["variable `plant`", "expected a real matrix"]),
    ] {
        let error = read_plant(&path(name)).unwrap_err();
        assert!(parts.iter().all(|part| error.contains(part)), "{error}");
    }
}
