//! Oscillators in several dimensions, which do not depend on each other.

use std::sync::atomic::AtomicBool;

use libration::Method;
use libration_analyze::trajectory::{FloatType, Format, Request, write};

use super::{requests, trajectory};

/// The positions and velocities of the rows as text, one list for each column; every float type prints all digits that tell two
/// numbers apart.
fn coordinates(request: &Request) -> Vec<Vec<String>> {
    let mut bytes = Vec::new();
    write(request, Format::Csv, &mut bytes, &AtomicBool::new(false)).unwrap();
    let text = String::from_utf8(bytes).unwrap();
    let rows: Vec<Vec<&str>> = text.lines().skip(1).map(|row| row.split(',').collect()).collect();
    let last = 2 + request.system.states.len();
    let column = |i: usize| rows.iter().map(|row| row[i].to_owned()).collect();
    (2..last).map(column).collect()
}

#[test]
fn each_dimension_of_an_oscillator_moves_as_it_does_alone() {
    for float in FloatType::ALL {
        for method in Method::ALL {
            let base = Request { float, ..trajectory::request("oscillator", method, 0.01, 40) };
            let one = base.system.twin.unwrap().system;
            let of = |q: &[f64], v: &[f64]| {
                let system = trajectory::from(one, [q.to_vec(), v.to_vec()]);
                Request { system, ..base.clone() }
            };
            let (q, v) = ([1.0, -0.3, 0.0], [0.5, 0.0, 2.0]);
            let all = of(&q, &v);
            let found = coordinates(&all);
            for i in 0..3 {
                let alone = coordinates(&of(&q[i..=i], &v[i..=i]));
                assert_eq!(
                    [&found[i], &found[3 + i]],
                    [&alone[0], &alone[1]],
                    "{method:?} {float:?}"
                );
            }
        }
    }
}

#[test]
fn the_matrix_of_an_oscillator_in_three_dimensions_has_that_of_one_in_each() {
    for method in Method::ALL {
        let of = |q: &[f64], v: &[f64]| {
            libration_analyze::analyze(&requests::request("oscillator", method, 0.1, q, v))
                .unwrap()
                .matrix
                .unwrap()
                .update_matrix
        };
        let (one, three) = (of(&[1.0], &[0.0]), of(&[1.0, 2.0, 3.0], &[0.0; 3]));
        for (i, row) in three.iter().enumerate() {
            for (j, &entry) in row.iter().enumerate() {
                let wanted = if i % 3 == j % 3 { one[i / 3][j / 3] } else { 0.0 };
                assert_eq!(entry, wanted, "{method:?} {i} {j}");
            }
        }
    }
}
