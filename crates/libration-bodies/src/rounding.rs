//! The drift of conserved quantities by rounding, predicted.

use core::f64::consts::LN_2;

use super::bodies::Bodies;
use super::direct_sum::axes;

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
#[derive(Clone, Copy, Debug)]
pub(crate) struct Roundings {
    /// Sums of velocities.
    pub(crate) kicks: f64,
    /// Sums of positions.
    pub(crate) drifts: f64,
    /// The part of the step that an evaluation of the accelerations takes.
    pub(crate) kick_length: f64,
    /// Whether the sums keep what they round off.
    pub(crate) is_compensated: bool,
}

/// The mean square of a relative rounding error, in units of `u²`: of numbers whose logarithms are spread evenly.
const MEAN_SQUARE: f64 = 1.0 / (8.0 * LN_2);

impl RoundingVariance {
    pub(crate) fn new(
        bodies: &Bodies,
        accelerations: &[f64],
        potentials: &[f64],
        roundings: Roundings,
    ) -> Self {
        let Roundings { kicks, drifts, kick_length, is_compensated } = roundings;
        let unit = f64::EPSILON / 2.0;
        let state = if is_compensated { 0.0 } else { MEAN_SQUARE * unit * unit };
        // An acceleration: the product with a weight, in which two squares, a root and a quotient were rounded, and its product with the
        // step.
        let force = 6.0 * MEAN_SQUARE * unit * unit;
        let mut variance = RoundingVariance::default();
        for ((i, body), potential) in bodies.iter().enumerate().zip(potentials) {
            let (mass, q, v) = (body.mass, body.position, body.velocity);
            let a = axes(accelerations).map(|plane| plane[i]);
            let square = a.iter().map(|a| a * a).sum::<f64>();
            // Forces are those at rounded positions, between which they still are opposite and central. Of a single source the gradient is 2Gm/r³ = 2a²/|φ|.
            let gradient = if *potential == 0.0 { 0.0 } else { 2.0 * square / potential };
            let shift = MEAN_SQUARE * unit * unit * q.iter().map(|q| q * q).sum::<f64>();
            let of_places = shift * (kick_length * gradient).powi(2) / 3.0;
            // Variances of the errors of velocity and position in a step.
            let of_v: [f64; 3] = core::array::from_fn(|axis| {
                kicks * (state * v[axis] * v[axis] + force * (kick_length * a[axis]).powi(2))
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
