//! The motion of a plant in a part of a period, for simulations.

use crate::{Discretisation, LinearLoop, LinearPlant, Matrix, StepIntegrals};

/// The motion of a plant in a part of a period under held inputs, and its cost.
#[derive(Clone, Debug)]
pub struct PartMotion {
    /// `Φ` and `Γ`. If noise is held through a period, the last columns of `Γ` are its effect.
    pub step: Discretisation,
    /// The covariance that white noise adds to the states; none if noise is held.
    pub covariance: Option<Matrix>,
    /// The expected cost as a form of states and inputs, without `constant`.
    pub cost: Matrix,
    /// The expected cost of the noise within the part.
    pub constant: f64,
}

impl LinearLoop {
    /// Whether noise is held through each period, and the cost is that of the states at the beginning of a period: for a sampled plant, and
    /// after [`LinearLoop::with_held_noise`].
    pub fn holds_noise_and_cost(&self) -> bool {
        self.holds_noise() || self.plant().sampling_period.is_some()
    }

    /// The motion from one phase to another of a period of `seconds`.
    ///
    /// Noise and cost are integrals over the part ([`StepIntegrals`]). The cost of a part is its expectation, given the state at the
    /// beginning of the part.
    pub fn part_motion(&self, seconds: f64, [from, to]: [f64; 2]) -> PartMotion {
        let LinearPlant { a, b, g, sampling_period, .. } = self.plant();
        let (n, m) = (a.rows(), b.columns());
        let length = (to - from) * seconds;
        if !self.holds_noise_and_cost() {
            let noise = g.congruence(&Matrix::identity(g.columns()));
            let integrals = StepIntegrals::new(a, b, &noise, self.cost_form(), length);
            return PartMotion {
                step: Discretisation::exact(a, b, length),
                covariance: Some(integrals.noise),
                cost: integrals.cost,
                constant: integrals.constant,
            };
        }
        let mut driven = Matrix::zeros(n, m + g.columns());
        driven.set_block((0, 0), b);
        driven.set_block((0, m), g);
        let step = match sampling_period {
            None => Discretisation::exact(a, &driven, length),
            Some(_) => Discretisation { phi: a.clone(), gamma: driven },
        };
        let cost = self.cost_form().scaled(to - from);
        PartMotion { step, covariance: None, cost, constant: 0.0 }
    }
}
