//! Characteristic polynomials of loops with a delay: long, but with few terms.

use libration_core::Scalar;
use libration_core::number::Wide;

use crate::Complex;

/// `λᵐ·a(λ) + b(λ)` with `a = λ² + a₁λ + a₀`, held as `[a₀, a₁]`, and `b = b₂λ² + b₁λ + b₀`, as
/// `[b₀, b₁, b₂]`.
#[derive(Clone, Copy, Debug)]
pub(super) struct DelayPolynomial {
    pub(super) m: u64,
    pub(super) a: [Wide; 2],
    pub(super) b: [Wide; 3],
}

/// A complex `f64`.
type C = num_complex::Complex<f64>;

/// Sweeps of the iteration in floats; it takes some ten.
const SWEEPS: usize = 200;

/// Steps of Newton's iteration afterwards: from 30 good bits each doubles them, up to 1024.
const NEWTON: usize = 8;

/// Roots of about the largest size that are made exact.
const CANDIDATES: usize = 6;

impl DelayPolynomial {
    /// The largest absolute value of a root.
    pub(super) fn radius(&self) -> Wide {
        if self.a.iter().chain(&self.b).any(|x| x.is_nan()) {
            return Wide::NAN;
        }
        // Where nothing is fed back there are as many roots at zero as commands wait, which no iteration separates.
        if self.m > 0 && self.b.iter().all(|b| b.is_zero()) {
            return DelayPolynomial { m: 0, ..*self }.radius();
        }
        let mut roots = self.rough_roots();
        roots.sort_by(|x, y| y.norm().total_cmp(&x.norm()));
        let exact = roots.iter().take(CANDIDATES).map(|&root| self.polished(root).abs());
        exact.fold(Wide::ZERO, |largest, size| if size > largest { size } else { largest })
    }

    /// All roots, to the precision of floats where they are simple: Aberth's simultaneous iteration
    /// (O. Aberth, *Iteration methods for finding all zeros of a polynomial simultaneously*, Mathematics of
    /// Computation 27, 1973).
    fn rough_roots(&self) -> Vec<C> {
        let degree = self.m as usize + 2;
        // No root is to begin on an axis of symmetry.
        let angle = |k: usize| (k as f64 + 0.37) * core::f64::consts::TAU / degree as f64;
        let sizes = self.sizes().into_iter().enumerate();
        let mut roots: Vec<C> = sizes.map(|(k, size)| C::from_polar(size, angle(k))).collect();
        for _ in 0..SWEEPS {
            let mut largest = 0.0_f64;
            for i in 0..degree {
                let newton = self.correction(roots[i]);
                let repulsion: C =
                    (0..degree).filter(|&j| j != i).map(|j| (roots[i] - roots[j]).inv()).sum();
                let change = newton / (C::new(1.0, 0.0) - newton * repulsion);
                if change.is_finite() {
                    roots[i] -= change;
                    largest = largest.max(change.norm() / roots[i].norm().max(1e-12));
                }
            }
            if largest < 1e-13 {
                break;
            }
        }
        roots
    }

    /// About how large the roots are, by Newton's polygon: the upper hull of the logarithms of the coefficients (D. A. Bini, *Numerical
    /// computation of polynomial zeros by means of Aberth's method*, Numerical Algorithms 13, 1996).
    fn sizes(&self) -> Vec<f64> {
        let m = self.m as usize;
        let mut coefficients = vec![(m + 2, Wide::one())];
        let lower =
            [(m + 1, self.a[1]), (m, self.a[0]), (2, self.b[2]), (1, self.b[1]), (0, self.b[0])];
        for (power, value) in lower {
            match coefficients.iter_mut().find(|(other, _)| *other == power) {
                Some((_, sum)) => *sum = *sum + value,
                None => coefficients.push((power, value)),
            }
        }
        coefficients.sort_by_key(|&(power, _)| power);
        let points = coefficients.iter().filter(|(_, c)| !c.is_zero());
        let points = points.map(|&(power, c)| (power, c.abs().ln().to_f64()));
        let mut hull: Vec<(usize, f64)> = Vec::new();
        for (power, log) in points {
            // Left turns are no corners.
            while let [.., (p0, l0), (p1, l1)] = hull[..]
                && (l1 - l0) * (power - p0) as f64 <= (log - l0) * (p1 - p0) as f64
            {
                hull.pop();
            }
            hull.push((power, log));
        }
        let zeros = hull.first().map_or(0, |&(power, _)| power);
        let mut sizes = vec![1e-3; zeros];
        for pair in hull.windows(2) {
            let (count, fall) = (pair[1].0 - pair[0].0, pair[0].1 - pair[1].1);
            sizes.extend(core::iter::repeat_n((fall / count as f64).exp(), count));
        }
        sizes
    }

    /// `p/p'` at `x`, without overflow.
    fn correction(&self, x: C) -> C {
        let [a0, a1] = self.a.map(Wide::to_f64).map(C::from);
        let [b0, b1, b2] = self.b.map(Wide::to_f64).map(C::from);
        let (a, da) = (x * x + a1 * x + a0, x * 2.0 + a1);
        let (b, db) = ((b2 * x + b1) * x + b0, b2 * x * 2.0 + b1);
        let m = self.m as f64;
        let turns = C::from_polar(1.0, m * x.arg());
        if x.norm() <= 1.0 {
            let power = turns * x.norm().powf(m);
            let value = a * power + b;
            // m·λᵐ⁻¹·a, which is 0 for m = 0.
            let from_power = if self.m == 0 { C::from(0.0) } else { power / x * m * a };
            value / (da * power + from_power + db)
        } else {
            let power = turns.conj() * x.norm().powf(-m);
            (a + b * power) / (da + a * m / x + db * power)
        }
    }

    /// A root from nearby, by Newton's iteration on `p/p'` in 1024 bits, to which roots that are double are simple ones.
    fn polished(&self, from: C) -> Complex {
        let ([a0, a1], [b0, b1, b2]) = (self.a, self.b);
        let real = Complex::real;
        let horner = |x: Complex, coefficients: [Wide; 3]| {
            let [low, middle, high] = coefficients.map(real);
            high.times(x).plus(middle).times(x).plus(low)
        };
        let two = |x: Wide| x.scaled(1);
        let mut x = Complex { re: Wide::from_f64(from.re), im: Wide::from_f64(from.im) };
        for _ in 0..NEWTON {
            let a = horner(x, [a0, a1, Wide::one()]);
            let da = horner(x, [a1, two(Wide::one()), Wide::ZERO]);
            let (dda, ddb) = (real(two(Wide::one())), real(two(b2)));
            let (b, db) = (horner(x, [b0, b1, b2]), horner(x, [b1, two(b2), Wide::ZERO]));
            // λᵐ, and mλᵐ⁻¹.
            let power = x.powi(self.m);
            let slope = match self.m.checked_sub(1) {
                Some(less) => x.powi(less).times(real(Wide::from_f64(self.m as f64))),
                None => real(Wide::ZERO),
            };
            let value = power.times(a).plus(b);
            let derivative = power.times(da).plus(slope.times(a)).plus(db);
            let bend = match self.m.checked_sub(2) {
                Some(less) => {
                    let factor = self.m as f64 * (self.m - 1) as f64;
                    x.powi(less).times(real(Wide::from_f64(factor)))
                }
                None => real(Wide::ZERO),
            };
            let twice = slope.times(da).times(real(two(Wide::one())));
            let second = bend.times(a).plus(twice).plus(power.times(dda)).plus(ddb);
            let below = derivative.times(derivative).minus(value.times(second));
            if below.abs().is_zero() {
                break;
            }
            x = x.minus(value.times(derivative).over(below));
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wide<const N: usize>(numbers: [f64; N]) -> [Wide; N] {
        numbers.map(Wide::from_f64)
    }

    #[test]
    fn without_feedback_the_delay_does_not_matter() {
        for m in [1, 20, 4096] {
            let quasi = DelayPolynomial { m, a: wide([1.0, -2.5]), b: [Wide::ZERO; 3] };
            assert_eq!(quasi.radius().to_f64(), 2.0);
        }
    }

    #[test]
    fn without_delay_and_feedback_the_radius_is_that_of_a_quadratic() {
        // (λ − ½)(λ − 2), and b = 0.
        let quasi = DelayPolynomial { m: 0, a: wide([1.0, -2.5]), b: [Wide::ZERO; 3] };
        assert_eq!(quasi.radius().to_f64(), 2.0);
    }

    #[test]
    fn a_pure_delay_has_all_roots_on_a_circle() {
        // λⁿ = c.
        for m in [1_u64, 7, 300] {
            let quasi = DelayPolynomial { m, a: [Wide::ZERO; 2], b: wide([-0.25, 0.0, 0.0]) };
            let wanted = 0.25_f64.powf(1.0 / (m as f64 + 2.0));
            assert!((quasi.radius().to_f64() - wanted).abs() < 1e-15, "{m}");
        }
    }
}
