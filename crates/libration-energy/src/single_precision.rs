//! How finely an energy is stored.

/// Whether all numbers are of single precision.
pub(crate) fn is_single_precision(values: &[f64]) -> bool {
    values.iter().all(|x| f64::from(*x as f32) == *x)
}

/// Part of neighbouring samples that must be equal before energies are coarse.
const EQUAL: f64 = 0.02;

/// The distance between stored energies: the smallest change from sample to sample, if some samples do not change; else 0.
pub(crate) fn quantum(values: &[f64]) -> f64 {
    let changes = || values.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let equal = changes().filter(|change| *change == 0.0).count();
    if (equal as f64) < EQUAL * values.len() as f64 {
        return 0.0;
    }
    let smallest = changes().filter(|change| *change > 0.0).fold(f64::INFINITY, f64::min);
    if smallest.is_finite() { smallest } else { 0.0 }
}
