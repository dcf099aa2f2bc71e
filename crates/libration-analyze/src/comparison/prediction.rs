//! Predicted costs of integrators.

use std::collections::BTreeMap;

use super::ComparedIntegrator;

/// The integrator of each order with the fewest stages, by which the others of this order are predicted.
///
/// With the leading error alone, an integrator of order `p` with the error constant `C` has the error `A·C·hᵖ` after a motion, where `A`
/// depends on the system and the order. One integrator of the order measures `A`; steps of the same error are as `C^(−1/p)`.
pub(super) struct Yardsticks(BTreeMap<u32, ComparedIntegrator>);

impl Yardsticks {
    pub(super) fn new(integrators: &[ComparedIntegrator]) -> Self {
        let mut of_order: BTreeMap<u32, ComparedIntegrator> = BTreeMap::new();
        let measured = integrators.iter().filter(|one| one.dt.is_some());
        for one in measured.filter(|one| one.error_constant.is_some()) {
            let known = of_order.entry(one.order).or_insert_with(|| one.clone());
            if one.stages < known.stages {
                known.clone_from(one);
            }
        }
        Yardsticks(of_order)
    }

    /// Writes the predictions.
    pub(super) fn predict(&self, integrators: &mut [ComparedIntegrator]) {
        for one in integrators {
            let known = self.0.get(&one.order).filter(|known| known.integrator != one.integrator);
            one.predicted_evaluations = known.and_then(|known| {
                let ratio = one.error_constant? / known.error_constant?;
                let shorter = ratio.powf(1.0 / f64::from(one.order));
                Some(known.evaluations? / known.stages as f64 * one.stages as f64 * shorter)
            });
        }
    }
}
