//! Expectations over the distribution of step times.

use libration_core::control::Jitter;
use libration_core::number::Wide;
use libration_core::{Elementary, Scalar};

/// Means over a law of step times.
pub trait Averages {
    /// `E[1], E[ε], E[ε²], …`, where `ε` is no less than −1.
    fn moments(self) -> Box<dyn Iterator<Item = Wide>>;

    /// Weights and values of `ε` whose sums are means over the law, but for rounding, of what is smooth, and turns by no more than `turn`
    /// radians where `ε` changes by a standard deviation. Beyond [`MOST_TURN`] it is taken as that.
    fn nodes(self, turn: f64) -> Vec<(f64, f64)>;
}

impl Averages for Jitter {
    fn moments(self) -> Box<dyn Iterator<Item = Wide>> {
        match (self, self.clips()) {
            (Jitter::Gaussian(rms), true) => Box::new(gaussian_above(Wide::from_f64(rms))),
            (Jitter::Uniform(rms), true) => Box::new(uniform_above(half_width(rms))),
            (law, false) => Box::new(even_moments(law).flat_map(|moment| [moment, Wide::ZERO])),
        }
    }

    fn nodes(self, turn: f64) -> Vec<(f64, f64)> {
        let turn = turn.abs().min(MOST_TURN);
        if self.clips() {
            return nodes_above(self, turn);
        }
        match self {
            // The trapezoidal rule on a Gaussian errs by exp(−(2π/h − turn)²/2) only; to ten deviations. The nodes below −1 weigh less than
            // 10⁻⁸, but backwards in time what decays fast grows by more than that.
            Jitter::Gaussian(rms) => {
                let apart = (core::f64::consts::TAU / (turn + 12.0)).min(0.5);
                let last = (10.0 / apart).ceil() as i32;
                let at = |j: i32| f64::from(j) * apart;
                let weight = |x: f64| (-x * x / 2.0).exp();
                let all: f64 = (-last..=last).map(|j| weight(at(j))).sum();
                (-last..=last).map(|j| (weight(at(j)) / all, (at(j) * rms).max(-1.0))).collect()
            }
            Jitter::Uniform(rms) => {
                let half = half_width(rms).to_f64();
                pieces(-half, half, rms, turn, |_| 1.0 / (2.0 * half))
            }
        }
    }
}

/// `E[1], E[ε²], E[ε⁴], …` of the law that is not clipped; the odd ones vanish.
fn even_moments(law: Jitter) -> impl Iterator<Item = Wide> {
    let square = match law {
        Jitter::Gaussian(rms) => Wide::from_f64(rms).powi(2),
        Jitter::Uniform(rms) => half_width(rms).powi(2),
    };
    // σᵏ·(k − 1)!!, and (√3·σ)ᵏ/(k + 1).
    core::iter::successors(Some((1, Wide::one())), move |&(odd, moment)| {
        let next = match law {
            Jitter::Gaussian(_) => (moment * square).ratio(odd, 1),
            Jitter::Uniform(_) => (moment * square).ratio(odd, odd + 2),
        };
        Some((odd + 2, next))
    })
    .map(|(_, moment)| moment)
}

/// Half the width of a uniform law.
fn half_width(rms: f64) -> Wide {
    Wide::from_f64(3.0).sqrt() * Wide::from_f64(rms)
}

/// `±1`, the sign of `(−1)ᵏ`.
fn sign(k: i32) -> Wide {
    Wide::from_f64(if k % 2 == 0 { 1.0 } else { -1.0 })
}

/// The moments of a uniform law of this half width `w > 1`, of which what is below −1 is at −1: the integral of `εᵏ/2w` from
/// −1 to `w`, and `(−1)ᵏ·(w − 1)/2w`.
fn uniform_above(w: Wide) -> impl Iterator<Item = Wide> {
    let (one, width) = (Wide::one(), w.scaled(1));
    let atom = (w - one) / width;
    let powers = core::iter::successors(Some(w), move |&power| Some(power * w));
    (0..)
        .zip(powers)
        .map(move |(k, power)| ((power - sign(k + 1)) / width).ratio(1, k + 1) + sign(k) * atom)
}

/// The moments of a Gaussian law, of which what is below −1 is at −1. Of the part above it `Iₖ = σ²(k − 1)Iₖ₋₂ +
/// σ²(−1)ᵏ⁻¹p(−1)` by parts, with the density `p`.
fn gaussian_above(rms: Wide) -> impl Iterator<Item = Wide> {
    let (one, z) = (Wide::one(), rms.recip());
    let density = (z * z).scaled(-1).exp().recip() / Wide::pi().scaled(1).sqrt();
    // Φ(z) − ½ = p·(z + z³/3 + z⁵/(3·5) + …).
    let terms = core::iter::successors(Some((1, z)), |&(odd, term)| {
        Some((odd + 2, (term * z * z).ratio(1, odd + 2)))
    });
    let sum = terms.take(SERIES).fold(Wide::ZERO, |sum, (_, term)| sum + term);
    let above = one.scaled(-1) + density * sum;
    let first = (rms * density, rms * rms);
    let parts = core::iter::successors(Some((1, above, first.0)), move |&(k, now, next)| {
        let square = first.1;
        let after = (square * now).ratio(k, 1) + sign(k) * first.0;
        Some((k + 1, next, after))
    });
    parts.map(move |(k, part, _)| part + sign(k - 1) * (one - above))
}

/// Terms of a series in `z²` for `z` up to `LARGEST`: the last is `z⁷⁹⁹/799!!`, below 2⁻¹²⁰⁰.
const SERIES: usize = 400;

/// Radians by which what is averaged turns within a standard deviation, beyond which more nodes are too many.
pub const MOST_TURN: f64 = 4096.0;

/// Gauss's quadrature with 24 nodes on pieces of an interval, of at most two deviations, or so many that what turns does so by 10 radians.
fn pieces(
    low: f64,
    high: f64,
    rms: f64,
    turn: f64,
    density: impl Fn(f64) -> f64,
) -> Vec<(f64, f64)> {
    // Without jitter there is one.
    let count = if rms > 0.0 {
        ((high - low) / rms * (turn / 10.0).max(0.25)).ceil().max(1.0)
    } else {
        1.0
    };
    let half = (high - low) / (2.0 * count);
    let rule = legendre(24);
    if half == 0.0 {
        return vec![(1.0, low)];
    }
    (0..count as u32)
        .map(|i| low + half * f64::from(2 * i + 1))
        .flat_map(|middle| rule.iter().map(move |&(weight, x)| (weight, middle + half * x)))
        .map(|(weight, x)| (half * weight * density(x), x))
        .collect()
}

/// [`Averages::nodes`] of a law that is clipped: −1 with what is below it, and pieces of the rest.
fn nodes_above(law: Jitter, turn: f64) -> Vec<(f64, f64)> {
    let rms = law.rms();
    let (end, density): (f64, Box<dyn Fn(f64) -> f64>) = match law {
        Jitter::Gaussian(_) => {
            let height = 1.0 / (rms * core::f64::consts::TAU.sqrt());
            (10.0 * rms, Box::new(move |x| height * (-0.5 * (x / rms).powi(2)).exp()))
        }
        Jitter::Uniform(_) => (law.largest(), Box::new(move |_| 1.0 / (12.0_f64.sqrt() * rms))),
    };
    let mut nodes = pieces(-1.0, end, rms, turn, density);
    let above: f64 = nodes.iter().map(|(weight, _)| weight).sum();
    nodes.push((1.0 - above, -1.0));
    nodes
}

/// Weights and nodes of Gauss's quadrature on `[−1, 1]`, by Newton's iteration on Legendre's polynomial.
fn legendre(n: usize) -> Vec<(f64, f64)> {
    let polynomial = |x: f64| {
        let (mut before, mut value) = (1.0, x);
        for k in 2..=n {
            let k = k as f64;
            (before, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * before) / k);
        }
        let slope = n as f64 * (x * value - before) / (x * x - 1.0);
        (value, slope)
    };
    let node = |i: usize| {
        let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
        for _ in 0..8 {
            let (value, slope) = polynomial(x);
            x -= value / slope;
        }
        let (_, slope) = polynomial(x);
        (2.0 / ((1.0 - x * x) * slope * slope), x)
    };
    (0..n).map(node).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_over_nodes_are_moments_also_of_laws_that_are_clipped() {
        for rms in [0.1, 0.3, 0.6, 3.0] {
            for law in [Jitter::Gaussian(rms), Jitter::Uniform(rms)] {
                for (k, moment) in (0..9).zip(law.moments().map(Wide::to_f64)) {
                    let sum: f64 =
                        law.nodes(0.0).iter().map(|(weight, x)| weight * x.powi(k)).sum();
                    // Where there are many, roundings of nodes, to their k-th power, and of weights, which Newton's iteration leaves with 14 digits; odd moments
                    // are sums of larger ones.
                    let size: f64 =
                        law.nodes(0.0).iter().map(|(weight, x)| (weight * x.powi(k)).abs()).sum();
                    let most = if law.clips() { 1e-13 * size } else { 1e-15 };
                    assert!((sum - moment).abs() < most, "{law:?} {k}: {sum} {moment}");
                }
            }
        }
    }

    #[test]
    fn nodes_hold_what_turns_as_often_as_is_said() {
        // The characteristic functions of the laws, at y = 30 deviations.
        let at = |law: Jitter| {
            let nodes = law.nodes(30.0);
            nodes.iter().map(|(weight, x)| weight * (300.0 * x).cos()).sum::<f64>()
        };
        assert!(at(Jitter::Gaussian(0.1)).abs() < 1e-14);
        let half = 30.0 * 3.0_f64.sqrt();
        let (found, wanted) = (at(Jitter::Uniform(0.1)), half.sin() / half);
        assert!((found - wanted).abs() < 1e-14, "{found} {wanted}");
    }

    #[test]
    fn no_node_is_a_period_of_negative_length() {
        for law in [Jitter::Gaussian(0.17), Jitter::Gaussian(0.3), Jitter::Uniform(0.57)] {
            assert!(law.nodes(0.0).iter().all(|&(_, x)| x >= -1.0), "{law:?}");
        }
    }

    #[test]
    fn a_law_that_is_clipped_loses_what_is_below() {
        // Uniform on ±2: a quarter is at −1, and E[ε] = (4 − 1)/8 − 1/4.
        let uniform = Jitter::Uniform(2.0 / 3.0_f64.sqrt());
        let found: Vec<f64> = uniform.moments().take(3).map(Wide::to_f64).collect();
        for (found, wanted) in found.into_iter().zip([1.0, 0.125, 9.0 / 12.0 + 0.25]) {
            // Of √3 in floats.
            assert!((found - wanted).abs() < 4e-16, "{found} {wanted}");
        }
        // Of a standard normal number x: E[max(x, −1)] = p(1) − Φ(−1), M. Abramowitz, I. Stegun, table 26.1.
        let mean = Jitter::Gaussian(1.0).moments().nth(1).unwrap().to_f64();
        let (density, below) = (0.241_970_724_519_143_37, 0.158_655_253_931_457_05);
        assert!((mean - (density - below)).abs() < 1e-16, "{mean}");
        // Where nothing is clipped the law is what it was.
        assert!(!Jitter::Gaussian(0.17).clips() && Jitter::Gaussian(0.18).clips());
        assert!(!Jitter::Uniform(0.57).clips() && Jitter::Uniform(0.58).clips());
    }

    #[test]
    fn moments_are_those_of_the_laws() {
        let moments = |law: Jitter| even_moments(law).take(4).map(Wide::to_f64).collect::<Vec<_>>();
        assert_eq!(moments(Jitter::Gaussian(1.0)), [1.0, 1.0, 3.0, 15.0]);
        assert_eq!(moments(Jitter::Gaussian(2.0))[..2], [1.0, 4.0]);
        // (√3)⁴/5 and (√3)⁶/7.
        assert_eq!(moments(Jitter::Uniform(1.0)), [1.0, 1.0, 1.8, 27.0 / 7.0]);
    }
}
