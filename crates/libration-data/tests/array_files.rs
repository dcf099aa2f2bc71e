//! Files of arrays by NumPy and SciPy; `tools/make_plant_files.py` writes them.

use libration_data::{ArrayValues, NamedArray, read_mat, read_npz};

const LIMIT: usize = 1 << 16;

type Reader = fn(&[u8], usize) -> Result<Vec<NamedArray>, String>;

macro_rules! file {
    ($name:literal) => {
        &include_bytes!(concat!("array_file/", $name))[..]
    };
}

/// The numbers of a variable.
fn numbers<'a>(arrays: &'a [NamedArray], name: &str) -> (&'a [usize], &'a [f64]) {
    let array = arrays.iter().find(|array| array.name == name).expect(name);
    match &array.values {
        ArrayValues::Numbers { shape, entries } => (shape, entries),
        ArrayValues::Integers { .. } | ArrayValues::Text(_) => panic!("{name}"),
    }
}

const A: [f64; 4] = [0.0, 1.0, -2.5, -0.125];
const C: [f64; 6] = [1.0, 0.0, 0.0, 1.0, 1.0, 1.0];

#[test]
fn stored_and_compressed_files_have_the_arrays_that_were_saved() {
    let files: [(Reader, &[u8], &str, &[usize]); 4] = [
        (read_npz, file!("stored.npz"), "dt", &[]),
        (read_npz, file!("deflated.npz"), "dt", &[]),
        (read_mat, file!("v5.mat"), "Ts", &[1, 1]),
        (read_mat, file!("v7.mat"), "Ts", &[1, 1]),
    ];
    for (read, bytes, period, shape) in files {
        let arrays = read(bytes, LIMIT).unwrap();
        assert_eq!(arrays.len(), 5);
        assert_eq!(numbers(&arrays, "A"), (&[2, 2][..], &A[..]));
        assert_eq!(numbers(&arrays, "B"), (&[2, 1][..], &[0.0, 4.0][..]));
        assert_eq!(numbers(&arrays, "C"), (&[3, 2][..], &C[..]));
        assert_eq!(numbers(&arrays, "D"), (&[3, 1][..], &[0.0; 3][..]));
        assert_eq!(numbers(&arrays, period), (shape, &[0.01][..]));
    }
}

#[test]
fn numbers_of_other_types_orders_and_versions_are_the_same() {
    let arrays = read_npz(file!("types.npz"), LIMIT).unwrap();
    assert_eq!(numbers(&arrays, "A"), (&[2, 2][..], &A[..]));
    assert_eq!(numbers(&arrays, "B"), (&[2][..], &[0.0, 4.0][..]));
    assert_eq!(numbers(&arrays, "C"), (&[3, 2][..], &C[..]));
    assert_eq!(numbers(&arrays, "G"), (&[2, 1][..], &[0.0, 3.0][..]));
    let names = ["angle (rad)", "ω (rad/s)"].map(str::to_owned).to_vec();
    assert_eq!(arrays[4].values, ArrayValues::Text(names));

    let arrays = read_npz(file!("versions.npz"), LIMIT).unwrap();
    assert_eq!(numbers(&arrays, "A"), (&[2, 2][..], &A[..]));
    assert_eq!(numbers(&arrays, "B"), (&[2, 1][..], &[0.0, 4.0][..]));

    let arrays = read_mat(file!("types.mat"), LIMIT).unwrap();
    assert_eq!(numbers(&arrays, "A"), (&[2, 2][..], &A[..]));
    assert_eq!(numbers(&arrays, "B"), (&[2, 1][..], &[0.0, 4.0][..]));
    assert_eq!(numbers(&arrays, "C"), (&[3, 2][..], &C[..]));
    assert_eq!(numbers(&arrays, "D"), (&[3, 1][..], &[-1.0; 3][..]));
}

#[test]
fn doubles_that_matlab_packs_into_bytes_are_read_in_both_orders_of_bytes() {
    for bytes in [file!("packed_little.mat"), file!("packed_big.mat")] {
        let arrays = read_mat(bytes, LIMIT).unwrap();
        let expected = [0.0, 1.0, 2.0, 7.0, 200.0, 255.0];
        assert_eq!(numbers(&arrays, "A"), (&[2, 3][..], &expected[..]));
    }
}

#[test]
fn what_is_not_a_real_matrix_is_refused_with_its_name() {
    let mut hdf5 = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".to_vec();
    hdf5.resize(600, b' ');
    let files: [(Reader, &[u8], &[&str]); 9] = [
        (read_npz, file!("complex.npz"), &["`A`", "`<c16`", "expected a real number"]),
        (read_npz, file!("object.npz"), &["`dt`", "`|O`"]),
        (read_mat, file!("complex.mat"), &["`A`", "complex", "expected a real matrix"]),
        (read_mat, file!("sparse.mat"), &["`A`", "sparse", "full("]),
        (read_mat, file!("structure.mat"), &["`plant`", "structure", "ssdata"]),
        (read_mat, &hdf5, &["version 7.3", "HDF5", "'-v7'"]),
        (read_mat, file!("stored.npz"), &["not a MATLAB file", "'-v7'"]),
        (read_npz, file!("v5.mat"), &["not a complete .npz archive"]),
        (read_npz, b"", &["not a complete .npz archive"]),
    ];
    for (read, bytes, parts) in files {
        let error = read(bytes, LIMIT).unwrap_err();
        assert!(parts.iter().all(|part| error.contains(part)), "{error}");
    }
}

/// All files that are read, with whether a checksum covers every number.
fn readable() -> [(Reader, &'static [u8], bool); 10] {
    [
        (read_npz, file!("stored.npz"), true),
        (read_npz, file!("deflated.npz"), true),
        (read_npz, file!("types.npz"), true),
        (read_npz, file!("versions.npz"), true),
        (read_npz, file!("mechanical.npz"), true),
        (read_mat, file!("v7.mat"), true),
        (read_mat, file!("v5.mat"), false),
        (read_mat, file!("types.mat"), false),
        (read_mat, file!("packed_little.mat"), false),
        (read_mat, file!("packed_big.mat"), false),
    ]
}

#[test]
fn a_file_that_ends_early_is_refused_or_has_the_first_variables_only() {
    for (read, bytes, _) in readable() {
        let whole = read(bytes, LIMIT).unwrap();
        for length in 0..bytes.len() {
            // The variables of a MATLAB file follow each other without a count.
            if let Ok(arrays) = read(&bytes[..length], LIMIT) {
                assert!(whole.starts_with(&arrays), "{length}");
                assert!(bytes.starts_with(b"MATLAB") && arrays.len() < whole.len(), "{length}");
            }
        }
    }
}

#[test]
fn a_changed_byte_is_an_error_or_changes_no_number_that_a_checksum_covers() {
    for (read, bytes, is_covered) in readable() {
        let whole = read(bytes, LIMIT).unwrap();
        let mut changed = bytes.to_vec();
        for i in 0..bytes.len() {
            for mask in [1, 2, 4, 8, 16, 32, 64, 128, 255] {
                changed[i] = bytes[i] ^ mask;
                if let Ok(arrays) = read(&changed, LIMIT) {
                    assert!(!is_covered || whole.starts_with(&arrays), "byte {i}, mask {mask}");
                }
            }
            changed[i] = bytes[i];
        }
    }
}

#[test]
fn arrays_that_are_longer_than_the_limit_are_refused() {
    for (read, bytes) in [(read_npz as Reader, file!("deflated.npz")), (read_mat, file!("v7.mat"))]
    {
        let error = read(bytes, 100).unwrap_err();
        assert!(error.contains("expected at most 100"), "{error}");
    }
}
