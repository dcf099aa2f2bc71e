//! The step at which an energy leaves the range of `f64`.

use libration::analysis::{Spectrum, UpdateMatrix};
use libration::number::Wide;
use libration::system::Oscillator;
use libration::{Hamiltonian, Model, Scalar, State};

use super::setting::Setting;

/// The step at which the energy left the range of `f64`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Overflow {
    pub(super) predicted: u64,
    pub(super) measured: u64,
    /// Logarithm of the factor by which the energy grows in a step.
    growth: f64,
}

impl Overflow {
    /// The overflow that was measured at a step, with its prediction from the exact orbit.
    pub(super) fn new(
        measured: u64,
        oscillator: Oscillator<f64>,
        step: &UpdateMatrix<Wide>,
        start: &State<f64, 1>,
    ) -> Self {
        let growth = 2.0 * Spectrum::new(step).radius_minus_one().to_f64().ln_1p();
        Overflow { predicted: predict(oscillator, step, start, measured), measured, growth }
    }

    /// By how many steps rounding may move the overflow: one, since it falls on a whole step, and as
    /// many as the energy takes to grow by what rounding leaves, at most a factor of e.
    pub(super) fn uncertainty(&self, setting: &Setting) -> f64 {
        let rounding = Setting { steps: self.measured, ..*setting }.rounding();
        1.0 + rounding.min(1.0) / self.growth
    }
}

/// The first step at which a term of the drift is too large for `f64`, by the exact orbit.
///
/// Twice the energy, that over ω² and that over E₀ bound all of `v²`, `q²`, `ω²q²`, E and E/E₀.
/// They grow with the energy of an unstable orbit, so the first step that could overflow is found
/// by bisection, and the first that does, by walking on from it; `about` bounds the search.
fn predict(
    oscillator: Oscillator<f64>,
    step: &UpdateMatrix<Wide>,
    start: &State<f64, 1>,
    about: u64,
) -> u64 {
    let (system, start) = (Model::<1>::on::<Wide>(&oscillator), start.map(Wide::from_f64));
    let most = Wide::from_f64(f64::MAX);
    let after = |n: u64| step.power(n).apply(&start);
    let initial = Hamiltonian::<Wide, 1>::energy(&system, &start);
    let could = |state: &State<Wide, 1>| {
        let twice = Hamiltonian::<Wide, 1>::energy(&system, state) * Wide::from_f64(2.0);
        [twice, twice / system.omega2, twice / initial].iter().any(|&bound| bound > most)
    };
    let does = |state: &State<Wide, 1>| {
        let (q2, v2) = (state.q[0] * state.q[0], state.v[0] * state.v[0]);
        let total = Hamiltonian::<Wide, 1>::energy(&system, state);
        let drift = (total - initial) / initial;
        [q2, v2, system.omega2 * q2, total, drift].iter().any(|&term| term > most)
    };
    let limit = about.saturating_mul(2);
    let (mut low, mut high) = (0, limit);
    while low < high {
        let middle = low + (high - low) / 2;
        if could(&after(middle)) { high = middle } else { low = middle + 1 }
    }
    let mut state = after(low);
    while !does(&state) && low < limit {
        state = step.apply(&state);
        low += 1;
    }
    low
}
