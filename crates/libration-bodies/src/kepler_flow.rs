//! Kepler's problem, solved to rounding in universal variables.

use libration_core::Elementary;

/// Position and velocity after `dt` on an orbit around the origin, which attracts with `strength = G·M > 0`: any conic section.
///
/// Universal variables (R. H. Battin, *An Introduction to the Mathematics and Methods of Astrodynamics*, 1999, §4.5) with the
/// iteration of Laguerre and Conway (B. A. Conway, *Celestial Mechanics* 39, 1986), between bounds of the solution.
pub fn kepler_flow(strength: f64, [position, velocity]: [[f64; 3]; 2], dt: f64) -> [[f64; 3]; 2] {
    let distance = dot(position, position).sqrt();
    let beta = 2.0 * strength / distance - dot(velocity, velocity);
    let orbit =
        Orbit { distance, beta, eta: dot(position, velocity), zeta: strength - beta * distance };
    // Whole periods change nothing.
    let period = TAU * strength / (beta * beta.sqrt());
    let time = if period.is_finite() { dt - (dt / period).round() * period } else { dt };
    let [g1, g2, g3] = orbit.solve(time);
    let end = distance + orbit.eta * g1 + orbit.zeta * g2;
    let (f_less_1, g) = (-strength * g2 / distance, time - strength * g3);
    let (f_rate, g_rate_less_1) = (-strength * g1 / (distance * end), -strength * g2 / end);
    // The sums are written as increments of the start, whose rounding errors are smaller.
    let along = |start: [f64; 3], a: f64, b: f64| -> [f64; 3] {
        core::array::from_fn(|axis| start[axis] + (a * position[axis] + b * velocity[axis]))
    };
    [along(position, f_less_1, g), along(velocity, f_rate, g_rate_less_1)]
}

use core::f64::consts::TAU;

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

struct Orbit {
    distance: f64,
    /// `2μ/r − v²`: positive on ellipses.
    beta: f64,
    /// `q·v`.
    eta: f64,
    /// `μ − βr`.
    zeta: f64,
}

/// Iterations after which bisection alone would have reached the last digit.
const MOST_ITERATIONS: usize = 1100;

impl Orbit {
    /// The functions `G₁, G₂, G₃` at the solution of Kepler's equation for a time.
    fn solve(&self, time: f64) -> [f64; 3] {
        // Time rises with the universal anomaly, of which it is the integral of the distance.
        let (mut low, mut high) =
            if time >= 0.0 { (0.0, f64::INFINITY) } else { (f64::NEG_INFINITY, 0.0) };
        let inverse = time / self.distance;
        let mut x = inverse * (1.0 - 0.5 * inverse * self.eta / self.distance);
        if !(low..=high).contains(&x) || !x.is_finite() {
            x = inverse;
        }
        let mut last_step = f64::INFINITY;
        for _ in 0..MOST_ITERATIONS {
            let [g0, g1, g2, g3] = self.functions(x);
            let excess = self.distance * x + self.eta * g2 + self.zeta * g3 - time;
            let distance = self.distance + self.eta * g1 + self.zeta * g2;
            let slope = self.eta * g0 + self.zeta * g1;
            // Functions of a hyperbola overflow far beyond the solution, on either side of the start.
            let is_beyond = if excess.is_nan() { x > 0.0 } else { excess > 0.0 };
            if is_beyond {
                high = high.min(x);
            } else {
                low = low.max(x);
            }
            let root = (16.0 * distance * distance - 20.0 * excess * slope).abs().sqrt();
            let mut next = x - 5.0 * excess / (distance + root);
            let is_bisected = !(next > low && next < high) && excess != 0.0;
            if is_bisected {
                next = match (low.is_finite(), high.is_finite()) {
                    (true, true) => low + 0.5 * (high - low),
                    _ => 2.0 * x,
                };
            }
            let step = (next - x).abs();
            // In the last digits the steps of the iteration no longer become smaller.
            let is_last = step <= f64::EPSILON * x.abs()
                || (!is_bisected && step <= 1e-12 * x.abs() && step >= 0.5 * last_step);
            if is_last {
                // The last step is too small to need new functions: G₁' = G₀, G₂' = G₁, G₃' = G₂.
                let step = next - x;
                return [g1 + step * g0, g2 + step * g1, g3 + step * g2];
            }
            (x, last_step) = (next, if is_bisected { f64::INFINITY } else { step });
        }
        let [_, g1, g2, g3] = self.functions(x);
        [g1, g2, g3]
    }

    /// `G₀ … G₃`, with `Gₖ(x) = xᵏ cₖ(βx²)` and the functions `cₖ` of Stumpff.
    fn functions(&self, x: f64) -> [f64; 4] {
        let z = self.beta * x * x;
        if z.abs() < 1.0 {
            let (c2, c3) = stumpff(z);
            let (g2, g3) = (x * x * c2, x * x * x * c3);
            return [1.0 - self.beta * g2, x - self.beta * g3, g2, g3];
        }
        let root = self.beta.abs().sqrt();
        let angle = root * x;
        let (g0, g1, half) = if z > 0.0 {
            (Elementary::cos(angle), Elementary::sin(angle) / root, Elementary::sin(0.5 * angle))
        } else {
            let half = Elementary::sinh(0.5 * angle);
            (Elementary::cosh(angle), Elementary::sinh(angle) / root, half)
        };
        let g2 = 2.0 * half * half / self.beta.abs();
        [g0, g1, g2, (x - g1) / self.beta]
    }
}

/// `c₂` and `c₃` for `|z| < 1`: series, whose next term is below a quarter of a unit in the last place.
fn stumpff(z: f64) -> (f64, f64) {
    // The quotients of neighbouring terms are z/((2k + 1)(2k + 2)) and z/((2k + 2)(2k + 3)).
    let series = |divisors: [f64; 9]| {
        divisors.into_iter().rev().fold(1.0, |sum, divisor| 1.0 - z / divisor * sum)
    };
    let c2 = series([12.0, 30.0, 56.0, 90.0, 132.0, 182.0, 240.0, 306.0, 380.0]);
    let c3 = series([20.0, 42.0, 72.0, 110.0, 156.0, 210.0, 272.0, 342.0, 420.0]);
    (c2 / 2.0, c3 / 6.0)
}
