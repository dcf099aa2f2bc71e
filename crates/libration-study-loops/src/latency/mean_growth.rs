//! The mean growth of a series.
//!
//! It uses nothing of the crate: the tests of `tests/study_loops` compile it alone, in place of the whole crate once more.

/// The mean growth from one to the next, with weights that begin and end smoothly: for what swings on the way and for
/// what dies out at the beginning the sum falls faster than any power of its length (S. Das, Y. Saiki,
/// E. Sander, J. A. Yorke, *Quantitative quasiperiodicity*, Nonlinearity 30, 2017).
pub(super) fn growth(logarithms: &[f64]) -> f64 {
    let count = logarithms.len() as f64;
    let (mut sum, mut weights) = (0.0, 0.0);
    for (i, pair) in logarithms.windows(2).enumerate() {
        let place = (i as f64 + 1.0) / count;
        let weight = (-1.0 / (place * (1.0 - place))).exp();
        sum += weight * (pair[1] - pair[0]);
        weights += weight;
    }
    sum / weights
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn growth_is_found_beneath_a_swing_and_a_transient() {
        let of = |n: u32| {
            let n = f64::from(n);
            -0.003 * n + (1.5 + (0.37 * n).sin() + 4.0 * (-0.05 * n).exp()).ln()
        };
        let logarithms: Vec<f64> = (0..2000).map(of).collect();
        // A plain mean of as many would be off by some 10⁻⁴, from the transient alone.
        let error = growth(&logarithms) + 0.003;
        assert!(error.abs() < 1e-8, "{error}");
    }
}
