//! Changes of the conserved quantities in the course of a motion.

use libration::bodies::{Bodies, BodySimulation, Conserved, RoundingVariance};

use super::approach::{dot, minus};

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
    /// The kinetic energy at the start, relative to the centre of mass.
    inner_kinetic: f64,
    /// Whether energies are those relative to a centre of mass that moves fast.
    is_inner: bool,
    exchange: Exchange,
}

/// The kinetic energy relative to the centre of mass.
fn inner_kinetic(bodies: &Bodies, momentum: [f64; 3]) -> f64 {
    let mass: f64 = bodies.masses().iter().sum();
    let centre = momentum.map(|p| if mass > 0.0 { p / mass } else { 0.0 });
    let square = |velocity| {
        let relative = minus(velocity, centre);
        dot(relative, relative)
    };
    0.5 * bodies.iter().map(|body| body.mass * square(body.velocity)).sum::<f64>()
}

/// The energies that a motion exchanges.
#[derive(Clone, Copy, Debug)]
pub(super) struct Exchange {
    kinetic: [f64; 2],
    potential: [f64; 2],
}

impl Exchange {
    pub(super) fn new(kinetic: f64, potential: f64) -> Self {
        Exchange { kinetic: [kinetic; 2], potential: [potential; 2] }
    }

    pub(super) fn add(&mut self, kinetic: f64, potential: f64) {
        for ([low, high], value) in [(&mut self.kinetic, kinetic), (&mut self.potential, potential)]
        {
            (*low, *high) = (low.min(value), high.max(value));
        }
    }

    /// The larger of the ranges of both energies.
    fn range(&self) -> f64 {
        let range = |[low, high]: [f64; 2]| high - low;
        range(self.kinetic).max(range(self.potential))
    }

    /// Whether the motion exchanges hardly any energy, as on a circle.
    pub(super) fn is_steady(&self) -> bool {
        self.range() <= STEADY * self.kinetic[1]
    }

    /// The energy that the motion exchanges; of a steady motion the largest kinetic energy.
    pub(super) fn size(&self) -> f64 {
        if self.is_steady() { self.kinetic[1] } else { self.range() }
    }

    /// The largest kinetic energy.
    pub(super) fn largest_kinetic(&self) -> f64 {
        self.kinetic[1]
    }
}

/// The part of the kinetic energy that a motion exchanges at most, to be steady.
const STEADY: f64 = 1e-3;

/// Roundings of an energy, whose terms are rounded one by one, with a margin.
const ROUNDINGS: f64 = 64.0;

/// Variances of energy, momentum and angular momentum.
fn totals(variance: RoundingVariance) -> [f64; 3] {
    let RoundingVariance { energy, momentum, angular_momentum } = variance;
    let sum = |of: [f64; 3]| of.iter().sum::<f64>();
    [energy, sum(momentum), sum(angular_momentum)]
}

impl Changes {
    /// No changes yet.
    pub(super) fn new(simulation: &BodySimulation) -> Self {
        let start = simulation.conserved();
        let inner_kinetic = inner_kinetic(simulation.bodies(), start.momentum);
        let inner = (inner_kinetic + start.potential).abs();
        let moves = start.kinetic - inner_kinetic;
        Changes {
            inner_kinetic,
            is_inner: moves > SMALL * inner.max(inner_kinetic),
            exchange: Exchange::new(inner_kinetic, start.potential),
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
        let kinetic = inner_kinetic(simulation.bodies(), now.momentum);
        let change = match self.is_inner {
            true => kinetic - self.inner_kinetic + (now.potential - self.start.potential),
            false => now.energy - self.start.energy,
        };
        let changes = [
            change.abs(),
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
        self.exchange.add(kinetic, now.potential);
        self.samples += 1.0;
        true
    }

    /// The energy below which the roundings of the energies of one state hide what the motion exchanges.
    pub(super) fn rounding(&self) -> f64 {
        let [low, high] = self.exchange.potential;
        ROUNDINGS * f64::EPSILON * (low.abs().max(high.abs()) + self.start.kinetic)
    }

    /// The largest changes.
    pub(super) fn largest(&self) -> [f64; 3] {
        self.largest
    }

    /// The energies that the motion exchanged at the samples.
    pub(super) fn exchange(&self) -> &Exchange {
        &self.exchange
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
pub(super) const SMALL: f64 = 0.1;

/// The sizes to which changes are compared, and that of the energy in words: `|E|`, `Σ m|v|` and `Σ m|r||v|`.
///
/// Where the energy is small beside it, the kinetic energy. Neither has the motion of a centre of mass that moves fast. The zero of a
/// pair potential is arbitrary: the size is then what the motion exchanges.
pub(super) fn sizes(bodies: &Bodies, changes: &Changes) -> ([f64; 3], &'static str) {
    let length = |of: [f64; 3]| dot(of, of).sqrt();
    let (mut momenta, mut turns) = (0.0, 0.0);
    for body in bodies.iter() {
        let momentum = body.mass * length(body.velocity);
        momenta += momentum;
        turns += momentum * length(body.position);
    }
    let Changes { start, inner_kinetic, .. } = changes;
    let inner = (inner_kinetic + start.potential).abs();
    let (energy, scale) = match bodies.pairs() {
        Some(_) => (changes.exchange.size(), EXCHANGED),
        None if changes.is_inner && inner < SMALL * inner_kinetic => (*inner_kinetic, KINETIC),
        None if changes.is_inner => (inner, INNER),
        None if start.energy.abs() < SMALL * start.kinetic => (start.kinetic, KINETIC),
        None => (start.energy.abs(), TOTAL),
    };
    ([energy, momenta, turns], scale)
}

/// The size of the energy in words.
const TOTAL: &str = "|E|";
const KINETIC: &str = "the kinetic energy at the start";
const INNER: &str = "|E| without the motion of the centre of mass";
const EXCHANGED: &str = "the energy that the motion exchanges";
