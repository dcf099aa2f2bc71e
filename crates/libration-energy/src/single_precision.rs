//! How finely an energy is stored.

/// Whether all numbers are of single precision.
pub(crate) fn is_single_precision(values: &[f64]) -> bool {
    values.iter().all(|x| f64::from(*x as f32) == *x)
}

/// Part of neighbouring samples that must be equal before energies are coarse.
const EQUAL: f64 = 0.02;

/// Part of the changes that must be multiples of the smallest one, and the part of it by which they may err.
const MULTIPLES: (f64, f64) = (0.9, 0.01);

/// The distance between stored energies: the smallest change from sample to sample, if some samples do not change and the other changes are
/// multiples of it; else 0. An energy that is constant between events, such as collisions, has samples that do not change, too.
pub(crate) fn quantum(values: &[f64]) -> f64 {
    let changes = || values.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let equal = changes().filter(|change| *change == 0.0).count();
    if (equal as f64) < EQUAL * values.len() as f64 {
        return 0.0;
    }
    let smallest = changes().filter(|change| *change > 0.0).fold(f64::INFINITY, f64::min);
    let largest = values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    let allowed = MULTIPLES.1 + 4.0 * f64::EPSILON * largest / smallest;
    let is_multiple =
        |change: &f64| (change / smallest - (change / smallest).round()).abs() < allowed;
    let multiples = changes().filter(is_multiple).count() - equal;
    let others = values.len() - 1 - equal;
    let is_stored = multiples as f64 >= MULTIPLES.0 * others as f64;
    if smallest.is_finite() && is_stored { smallest } else { 0.0 }
}
