//! The order of convergence, by distances of results.
//!
//! It uses nothing of the crate: the tests of `tests/probe` compile it alone, in place of the whole crate once more.

/// Roundings, relative to the scales, at which a difference says nothing. Errors of a thousand steps add up.
const ROUNDING: f64 = 1e-13;
/// Largest distance of the last two estimates from an integer, and that of a single one.
const SETTLED: [f64; 2] = [0.15, 0.05];

/// The order that distances of results of successive halvings have in the end, the estimates of it from the longest steps on, and whether
/// no distance is beyond rounding.
pub(crate) fn settled_order(differences: &[f64]) -> (Option<u32>, Vec<f64>, bool) {
    let significant = differences.iter().take_while(|d| **d > ROUNDING).count();
    let estimates: Vec<f64> =
        differences[..significant].windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect();
    // Of runs that diverge nothing is known.
    let is_exact = !differences.is_empty() && differences.iter().all(|d| *d <= ROUNDING);
    // The shortest steps are nearest to the limit, until rounding is.
    let near = |x: f64, order: f64, most: f64| (x - order).abs() < most && order >= 1.0;
    let order = match estimates[..] {
        [.., before, last] => {
            let order = last.round();
            let is_settled = near(before, order, SETTLED[0]) && near(last, order, SETTLED[0]);
            is_settled.then_some(order as u32)
        }
        [only] => near(only, only.round(), SETTLED[1]).then_some(only.round() as u32),
        [] => None,
    };
    (order, estimates, is_exact)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_is_that_of_the_shortest_steps_that_rounding_leaves() {
        let order_of = |differences: Vec<f64>| settled_order(&differences).0;
        let of = |p: i32, floor: f64| {
            let differences = (0..6).map(|k| 1e-2 * 2.0_f64.powi(-p * k) + floor).collect();
            order_of(differences)
        };
        assert_eq!((of(1, 0.0), of(2, 1e-14), of(4, 2e-14)), (Some(1), Some(2), Some(4)));
        assert_eq!(order_of(vec![1e-3, 4e-4, 3e-4, 1e-5, 9e-6, 1e-6]), None);
        // An order that longer steps seem to have is none.
        assert_eq!(order_of(vec![1e-1, 2.5e-2, 6.2e-3, 2e-3, 8e-4]), None);
        assert_eq!(order_of(vec![1e-9, 6.2e-11, 1e-14]), Some(4));
        assert!(settled_order(&[0.0; 6]).2);
        assert!(!settled_order(&[f64::NAN; 6]).2);
    }
}
