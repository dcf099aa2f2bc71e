//! Logarithmically spaced steps.

/// Returns steps from 1 to `last`, evenly spaced in their logarithm, each once.
pub fn log_spaced_steps(last: u64, per_decade: f64) -> Vec<u64> {
    let decades = (last as f64).log10();
    let count = (decades * per_decade).ceil().max(1.0);
    let mut steps: Vec<u64> = (0..=count as u64)
        .map(|i| 10_f64.powf(decades * i as f64 / count).round() as u64)
        .collect();
    steps.dedup();
    steps
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_begin_at_one_end_at_the_last_and_never_repeat() {
        for last in [1, 2, 7, 1_000_000] {
            let steps = log_spaced_steps(last, 24.0);
            assert_eq!((steps.first(), steps.last()), (Some(&1), Some(&last)));
            assert!(steps.windows(2).all(|pair| pair[0] < pair[1]));
        }
    }
}
