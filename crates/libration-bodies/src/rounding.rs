//! The drift of conserved quantities by rounding, predicted.

use core::f64::consts::LN_2;

use super::bodies::Bodies;
use super::direct_sum::axes;
use super::forces::PairForces;

/// Variances of the change of conserved quantities in one step by rounding, if the rounding errors are independent.
///
/// To rounding alone, kicks along the lines between bodies and drifts conserve momentum and angular momentum. D. Brouwer, *The
/// Astronomical Journal* 46, 1937: the changes are random walks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RoundingVariance {
    /// Of the energy.
    pub energy: f64,
    /// Of each component of the momentum.
    pub momentum: [f64; 3],
    /// Of each component of the angular momentum.
    pub angular_momentum: [f64; 3],
}

/// Sums that a step rounds.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Roundings {
    /// Sums of velocities.
    pub(crate) kicks: f64,
    /// Sums of positions.
    pub(crate) drifts: f64,
    /// The part of the step that an evaluation of the accelerations takes.
    pub(crate) kick_length: f64,
    /// Whether the sums keep what they round off.
    pub(crate) is_compensated: bool,
    /// Of the forces of a pair potential.
    pub(crate) of_pairs: PairRoundings,
}

/// Mean squares of rounding errors of the forces of a pair potential.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PairRoundings {
    /// Of a component of the force on a body.
    force: f64,
    /// Of the change of that component with the place of a body.
    stiffness: f64,
}

/// Pairs whose forces are computed a second time, with 106 bits, or those of one body.
const CHECKED_PAIRS: usize = 256;

impl PairRoundings {
    /// Measured: the difference of the forces from those in 106 bits, of a few bodies that `number` chooses.
    pub(crate) fn new(pairs: &PairForces<'_>, positions: &[f64], number: u64) -> Self {
        let count = pairs.masses.len();
        let bodies = (CHECKED_PAIRS / count).clamp(1, count);
        // Scattered, since the numbers of steps that are sampled are multiples of a stride.
        let scattered = number.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 32;
        let first = (scattered % count as u64) as usize;
        let mut of = PairRoundings::default();
        for i in (first..first + bodies).map(|i| i % count) {
            for j in (0..count).filter(|&j| j != i) {
                let [error, stiffness] = pairs.potential.errors(&pairs.pair(positions, i, j));
                of.force += error / (3 * bodies) as f64;
                of.stiffness += stiffness / (3 * bodies) as f64;
            }
        }
        of
    }
}

/// The accelerations of all bodies.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Accelerations<'a> {
    pub(crate) all: &'a [f64],
    pub(crate) gravity: &'a [f64],
    /// Potentials of gravity.
    pub(crate) potentials: &'a [f64],
}

/// The mean square of a relative rounding error, in units of `u²`: of numbers whose logarithms are spread evenly.
const MEAN_SQUARE: f64 = 1.0 / (8.0 * LN_2);

impl RoundingVariance {
    pub(crate) fn new(
        bodies: &Bodies,
        accelerations: Accelerations<'_>,
        roundings: Roundings,
    ) -> Self {
        let Roundings { kicks, drifts, kick_length, is_compensated, of_pairs } = roundings;
        let Accelerations { all, gravity, potentials } = accelerations;
        let unit = f64::EPSILON / 2.0;
        let state = if is_compensated { 0.0 } else { MEAN_SQUARE * unit * unit };
        // An acceleration: the product with a weight, in which two squares, a root and a quotient were rounded, and its product with the
        // step. That of a pair potential has a sum, a quotient and a product besides what was measured.
        let [force, of_quotient] = [6.0, 3.0].map(|count| count * MEAN_SQUARE * unit * unit);
        let mut variance = RoundingVariance::default();
        for ((i, body), potential) in bodies.iter().enumerate().zip(potentials) {
            let (mass, q, v) = (body.mass, body.position, body.velocity);
            let [a, g] = [all, gravity].map(|of| axes(of).map(|plane| plane[i]));
            let square = g.iter().map(|g| g * g).sum::<f64>();
            // Forces are those at rounded positions, between which they still are opposite and central. Of a single source the gradient is 2Gm/r³ = 2a²/|φ|.
            let gradient = if *potential == 0.0 { 0.0 } else { 2.0 * square / potential };
            let shift = MEAN_SQUARE * unit * unit * q.iter().map(|q| q * q).sum::<f64>();
            let per_mass = (kick_length / mass).powi(2);
            let of_places = shift * (kick_length * gradient).powi(2) / 3.0
                + if mass > 0.0 { shift * of_pairs.stiffness * per_mass / 3.0 } else { 0.0 };
            let of_pairs = if mass > 0.0 { of_pairs.force * per_mass } else { 0.0 };
            // Variances of the errors of velocity and position in a step.
            let of_v: [f64; 3] = core::array::from_fn(|axis| {
                let (g, other) = (kick_length * g[axis], kick_length * (a[axis] - g[axis]));
                let of_force = force * g * g + of_quotient * other * other + of_pairs;
                kicks * (state * v[axis] * v[axis] + of_force)
            });
            let of_q: [f64; 3] = core::array::from_fn(|axis| drifts * state * q[axis] * q[axis]);
            let square = mass * mass;
            for axis in 0..3 {
                let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
                variance.energy += square
                    * (v[axis] * v[axis] * (of_v[axis] + kicks * of_places)
                        + a[axis] * a[axis] * of_q[axis]);
                variance.momentum[axis] += square * of_v[axis];
                variance.angular_momentum[axis] += square
                    * (q[next] * q[next] * of_v[last]
                        + q[last] * q[last] * of_v[next]
                        + v[last] * v[last] * of_q[next]
                        + v[next] * v[next] * of_q[last]);
            }
        }
        variance
    }
}
