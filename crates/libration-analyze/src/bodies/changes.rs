//! Changes of the conserved quantities in the course of a motion.

use libration::bodies::{Bodies, BodySimulation, Conserved, RoundingVariance};

/// The quantities, in this order.
pub(super) const QUANTITIES: [&str; 3] = ["energy", "momentum", "angular momentum"];

/// The largest changes at the samples of a motion.
#[derive(Clone, Debug)]
pub(super) struct Changes {
    start: Conserved,
    /// Of energy, momentum and angular momentum.
    largest: [f64; 3],
    /// Sums of the variances of rounding in one step over the samples.
    variances: [f64; 3],
    /// Sums of the variances of reading a state.
    of_reading: [f64; 3],
    samples: f64,
}

/// Variances of energy, momentum and angular momentum.
fn totals(variance: RoundingVariance) -> [f64; 3] {
    let RoundingVariance { energy, momentum, angular_momentum } = variance;
    let sum = |of: [f64; 3]| of.iter().sum::<f64>();
    [energy, sum(momentum), sum(angular_momentum)]
}

impl Changes {
    /// No changes yet.
    pub(super) fn new(start: &BodySimulation) -> Self {
        let start = start.conserved();
        Changes {
            start,
            largest: [0.0; 3],
            variances: [0.0; 3],
            of_reading: [0.0; 3],
            samples: 0.0,
        }
    }

    /// Looks at the present state, unless it is stopped. Returns whether its energy is finite.
    pub(super) fn sample(
        &mut self,
        simulation: &BodySimulation,
        should_stop: &dyn Fn() -> bool,
    ) -> bool {
        let now = simulation.conserved();
        if should_stop() {
            return true;
        }
        if !now.energy.is_finite() {
            return false;
        }
        let distance = |a: [f64; 3], b: [f64; 3]| -> f64 {
            a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
        };
        let changes = [
            (now.energy - self.start.energy).abs(),
            distance(now.momentum, self.start.momentum),
            distance(now.angular_momentum, self.start.angular_momentum),
        ];
        let variances = totals(simulation.rounding_variance());
        let of_reading = totals(simulation.representation_variance());
        for i in 0..3 {
            self.largest[i] = self.largest[i].max(changes[i]);
            self.variances[i] += variances[i];
            self.of_reading[i] += of_reading[i];
        }
        self.samples += 1.0;
        true
    }

    /// The largest changes.
    pub(super) fn largest(&self) -> [f64; 3] {
        self.largest
    }

    /// The energy at the start.
    pub(super) fn start_energy(&self) -> f64 {
        self.start.energy
    }

    /// The largest changes that rounding alone would make in so many steps, as expected of random walks: the mean of the largest distance
    /// from the start is √(π/2) standard deviations of the last. Sums in the audit itself round once more.
    pub(super) fn by_rounding(&self, steps: u64, sizes: [f64; 3]) -> [f64; 3] {
        let samples = self.samples.max(1.0);
        let steps = core::f64::consts::FRAC_PI_2 * steps as f64;
        core::array::from_fn(|i| {
            // Of the states that are read, the largest error of many samples is near three standard deviations.
            let of_reading = 3.0 * (self.of_reading[i] / samples).sqrt();
            let walk = (steps * self.variances[i] / samples).sqrt();
            walk + of_reading + f64::EPSILON * sizes[i]
        })
    }
}

/// The part of the kinetic energy below which an energy is the small difference of larger ones, as near a parabolic orbit, and no scale.
const SMALL: f64 = 0.1;

/// The sizes to which changes are compared: `|E|`, `Σ m|v|` and `Σ m|r||v|`; where the energy is small beside it, the kinetic energy.
pub(super) fn sizes(bodies: &Bodies, start: &Conserved) -> [f64; 3] {
    let length = |of: [f64; 3]| of.iter().map(|x| x * x).sum::<f64>().sqrt();
    let (mut momenta, mut turns) = (0.0, 0.0);
    for body in bodies.iter() {
        let momentum = body.mass * length(body.velocity);
        momenta += momentum;
        turns += momentum * length(body.position);
    }
    let is_small = start.energy.abs() < SMALL * start.kinetic;
    let energy = if is_small { start.kinetic } else { start.energy.abs() };
    [energy, momenta, turns]
}
