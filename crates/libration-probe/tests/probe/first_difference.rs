//! The first difference of two results.

use libration_probe::{FirstDifference, ulps};

#[test]
fn the_first_difference_is_located_in_step_environment_and_component() {
    let first: Vec<f64> = (0..24).map(f64::from).collect();
    let mut second = first.clone();
    second[17] = 17.0_f64.next_up();
    second[20] = f64::NAN;
    let found = FirstDifference::find(&first, &second, &[2, 4, 3]).unwrap();
    assert_eq!((found.index, found.ulps, found.differing), (vec![1, 1, 2], Some(1), 2));
    assert_eq!(FirstDifference::find(&first, &first, &[24]), None);
}

#[test]
fn units_in_the_last_place_count_across_zero() {
    assert_eq!(ulps(5e-324, -5e-324), Some(2));
    assert_eq!((ulps(0.0, -0.0), ulps(1.0, 1.0)), (Some(0), Some(0)));
    assert_eq!(ulps(f64::NAN, 1.0), None);
}
