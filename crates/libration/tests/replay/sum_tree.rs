//! Sum trees.

use libration::random::philox4x32;
use libration::replay::SumTree;

#[test]
fn after_any_changes_the_total_is_that_of_the_weights_and_no_weight_of_zero_is_ever_found() {
    for len in [1, 2, 7, 8, 9, 64, 65, 1000] {
        let mut tree = SumTree::new(len);
        assert_eq!((tree.total(), tree.find(0.0)), (0.0, None));
        for step in 0..20_000_u32 {
            let [a, b, c, d] = philox4x32([step, len as u32, 0, 0], [5, 6]);
            // Weights over thirty orders of magnitude: their sums round.
            let weight = |bits: u32| {
                if bits.is_multiple_of(3) { 0.0 } else { 10_f64.powi((bits % 31) as i32 - 15) }
            };
            let changes = [(a as usize % len, weight(b)), (c as usize % len, weight(d))];
            tree.set(&changes);
            let share = f64::from(a ^ d) / f64::from(u32::MAX);
            let found = tree.find(share * tree.total());
            assert_eq!(found.is_none(), tree.weights().iter().all(|&w| w == 0.0));
            assert!(found.is_none_or(|i| tree.weights()[i] > 0.0), "{len} {step} {found:?}");
            if step % 100 == 0 {
                let mut anew = SumTree::new(len);
                anew.set(&tree.weights().iter().copied().enumerate().collect::<Vec<_>>());
                assert_eq!(anew.total().to_bits(), tree.total().to_bits(), "{len} {step}");
                let sum: f64 = tree.weights().iter().sum();
                // At most as many roundings as levels, and as many as terms in the plain sum.
                let roundings = (len + 12) as f64 * f64::EPSILON;
                assert!((tree.total() - sum).abs() <= roundings * sum);
            }
        }
    }
}

#[test]
fn weights_laid_end_to_end_are_found_where_they_lie() {
    // Whole numbers: all sums are exact.
    let weights: Vec<f64> = (0..1000_u32).map(|i| f64::from(i % 7)).collect();
    let mut tree = SumTree::new(1000);
    tree.set(&weights.iter().copied().enumerate().collect::<Vec<_>>());
    let mut begin = 0.0;
    for (i, &weight) in weights.iter().enumerate().filter(|(_, w)| **w > 0.0) {
        for target in [begin, begin + 0.5 * weight, (begin + weight).next_down()] {
            assert_eq!(tree.find(target), Some(i), "{target}");
        }
        begin += weight;
    }
    assert_eq!(tree.total(), begin);
    // What lies beyond the end belongs to the last.
    assert_eq!([tree.find(begin), tree.find(-1.0)], [Some(999), Some(1)]);
}
