//! The step at which trajectories are apart.
//!
//! It uses nothing of the crate: the tests of `tests/study_loops` compile it alone, in place of the whole crate once more.

/// A distance at which trajectories are apart, in units of the orbit.
pub(super) const FAR: f64 = 0.1;

/// Where the distance first exceeds [`FAR`], between two looks in proportion.
pub(super) fn crossing(steps: &[u64], distance: &[f64]) -> Option<f64> {
    let beyond = distance.iter().position(|&d| d >= FAR)?;
    let (n, d) = (steps[beyond] as f64, distance[beyond]);
    let Some(before) = beyond.checked_sub(1) else { return Some(n) };
    let (m, c) = (steps[before] as f64, distance[before]);
    if c <= 0.0 {
        return Some(n);
    }
    let share = (FAR / c).ln() / (d / c).ln();
    Some(m * (n / m).powf(share))
}

#[cfg(test)]
mod tests {
    use super::crossing;

    #[test]
    fn a_power_law_crosses_where_it_says() {
        let steps = [1, 10, 100, 1000];
        let distance = steps.map(|n| 0.004 * (n as f64).sqrt());
        assert!((crossing(&steps, &distance).unwrap() / 625.0 - 1.0).abs() < 1e-12);
        assert_eq!(crossing(&steps, &[0.0; 4]), None);
        assert_eq!(crossing(&steps, &[0.2; 4]), Some(1.0));
    }
}
