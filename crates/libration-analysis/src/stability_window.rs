//! The time steps at which a step is stable, exactly.

use libration_core::number::{Poly, Wide};
use libration_core::{Elementary, Scalar};

use super::roots::{Dyadic, IntegerPoly, Root, WholePoly, positive_roots};
use super::{SymbolicStep, UnknownStep};

/// A largest open interval of time steps at which every orbit stays bounded.
#[derive(Clone, Copy, Debug)]
pub struct StabilityWindow {
    /// The lower end, to 96 digits.
    pub from: Wide,
    /// The upper end; none if the window is unbounded.
    pub to: Option<Wide>,
}

impl SymbolicStep {
    /// All windows of stability among the positive time steps, rising; none if no step is stable.
    ///
    /// By Jury's criterion a real `2 × 2` matrix has no eigenvalue outside the unit circle just
    /// where `1 − det`, `1 + det − tr` and `1 + det + tr` are not negative. These are polynomials
    /// in the time step; their roots are isolated exactly, so no gap is too narrow to be seen. A
    /// double root at which the two eigenvalues touch at ±1 splits a window only if the matrix is
    /// defective there, so that orbits grow linearly: it does not where the matrix is ±1 itself.
    pub fn stability_windows(&self) -> Vec<StabilityWindow> {
        let entry = |i, j| self.matrix.entry(i, j);
        let entries = [entry(0, 0), entry(0, 1), entry(1, 0), entry(1, 1)];
        windows(entries.each_ref(), &UnknownStep::one())
    }
}

/// The windows of a matrix whose entries have these numerators, row by row, over one denominator.
///
/// At a pole, where the denominator is zero, one of the conditions is violated or all entries have a common factor.
pub(super) fn windows<const N: usize>(
    [a, b, c, d]: [&Poly<N>; 4],
    denominator: &Poly<N>,
) -> Vec<StabilityWindow> {
    // All of them times a number, with as many digits as it takes: the determinant may outgrow exact fractions.
    let Some(whole) = WholePoly::over_one_denominator([a, b, c, d, denominator]) else {
        return Vec::new();
    };
    let ([a, b, c, d, denominator], _) = whole;
    whole_windows([a, b, c, d], &denominator)
}

/// As [`windows`], of whole polynomials.
pub(super) fn whole_windows(
    numerators: [WholePoly; 4],
    denominator: &WholePoly,
) -> Vec<StabilityWindow> {
    let conditions = Conditions::of(numerators, denominator);
    let cells = Cells::of(&conditions.polynomials());
    let mut windows: Vec<StabilityWindow> = Vec::new();
    let mut before = false;
    for i in 0..=cells.roots.len() {
        let stable = conditions.bounded_at(&cells.sample(i));
        let left = i.checked_sub(1).map(|i| &cells.roots[i]);
        let value = |root: &Root| match conditions.squares {
            true => root.value().sqrt(),
            false => root.value(),
        };
        let to = cells.roots.get(i).map(value);
        let joined = before && left.is_some_and(|root| !conditions.defective_at(root));
        match windows.last_mut() {
            Some(window) if stable && joined => window.to = to,
            _ if stable => {
                windows.push(StabilityWindow { from: left.map_or(Wide::ZERO, value), to })
            }
            _ => {}
        }
        before = stable;
    }
    windows
}

/// Jury's polynomials of a step, and the entries that tell a defective double eigenvalue.
struct Conditions {
    /// `1 − det`.
    area: IntegerPoly,
    /// `1 + det − tr`: zero where 1 is an eigenvalue.
    plus: IntegerPoly,
    /// `1 + det + tr`: zero where −1 is an eigenvalue.
    minus: IntegerPoly,
    off_diagonal: [IntegerPoly; 2],
    /// Whether the unknown of the polynomials is the square of the time step.
    squares: bool,
}

impl Conditions {
    /// Those of the matrix with these numerators over one denominator, whose square is a factor of all of them.
    fn of([a, b, c, d]: [WholePoly; 4], denominator: &WholePoly) -> Self {
        let s = denominator;
        let (one, trace) = (s * s, s * &(&a + &d));
        let determinant = &(&a * &d) - &(&b * &c);
        let even = &one + &determinant;
        let [area, plus, minus] = [&one - &determinant, &even - &trace, &even + &trace];
        let polynomials = [area, plus, minus, b, c].map(WholePoly::primitive);
        let ([area, plus, minus, b, c], squares) = IntegerPoly::in_squares(polynomials.each_ref());
        Conditions { area, plus, minus, off_diagonal: [b, c], squares }
    }

    fn polynomials(&self) -> [&IntegerPoly; 3] {
        [&self.area, &self.plus, &self.minus]
    }

    /// Whether orbits stay bounded at a point where no polynomial but the zero polynomial vanishes.
    fn bounded_at(&self, x: &Dyadic) -> bool {
        let [area, plus, minus] = self.polynomials().map(|p| p.sign_at(x));
        let on_circle = area == 0 && (plus == 0 || minus == 0);
        let identity = self.off_diagonal.iter().all(|p| p.sign_at(x) == 0);
        area >= 0 && plus >= 0 && minus >= 0 && (!on_circle || identity)
    }

    /// Whether ±1 is a double eigenvalue at `root` and has a single eigenvector.
    fn defective_at(&self, root: &Root) -> bool {
        // The interval holds one root of all of them: what shares a root with one that vanishes there does so, too.
        let mut cut = self.polynomials().into_iter().filter(|p| !p.is_zero());
        let Some(one) = cut.find(|p| p.vanishes_within(root)) else { return false };
        let vanishes = |p: &IntegerPoly| p.is_zero() || p.gcd(one).vanishes_within(root);
        vanishes(&self.area)
            && (vanishes(&self.plus) || vanishes(&self.minus))
            && !self.off_diagonal.iter().all(vanishes)
    }
}

/// The positive axis, cut at the roots of some polynomials into cells where none changes its sign.
pub(super) struct Cells {
    pub(super) roots: Vec<Root>,
}

impl Cells {
    /// Cut at the roots of `polynomials`; those that are zero everywhere do not cut.
    pub(super) fn of(polynomials: &[&IntegerPoly]) -> Self {
        Cells { roots: positive_roots(polynomials) }
    }

    /// A point within the `i`-th cell, counted from zero upwards.
    pub(super) fn sample(&self, i: usize) -> Dyadic {
        match (i.checked_sub(1).map(|i| &self.roots[i].high), self.roots.get(i).map(|r| &r.low)) {
            (None, None) => Dyadic::power_of_two(0),
            (None, Some(above)) => above.scaled(-1),
            (Some(below), None) => below.scaled(1),
            (Some(below), Some(above)) => below.middle(above),
        }
    }
}

#[cfg(test)]
mod tests {
    use libration_core::integrator::{Composition, VelocityVerlet};
    use libration_core::{Integrator, Method, with_method};

    use super::*;

    fn windows(integrator: impl Integrator) -> Vec<(f64, f64)> {
        let ends = |w: &StabilityWindow| (w.from.to_f64(), w.to.unwrap().to_f64());
        SymbolicStep::new(integrator).unwrap().stability_windows().iter().map(ends).collect()
    }

    fn of(method: Method) -> Vec<(f64, f64)> {
        with_method!(method, |m| windows(m))
    }

    #[test]
    fn the_shipped_methods_lose_stability_where_the_textbooks_say() {
        for method in [
            Method::SymplecticEuler,
            Method::SymplecticEulerDriftFirst,
            Method::VelocityVerlet,
            Method::TextbookVerlet,
            Method::Leapfrog,
        ] {
            assert_eq!(of(method), [(0.0, 2.0)], "{}", method.name());
        }
        assert_eq!(of(Method::Rk4), [(0.0, 8.0_f64.sqrt())]);
        assert_eq!(of(Method::ExplicitEuler), []);
        // With exact weights; ours are rounded to 2⁻⁵³, and the limit moves five times as far.
        let [(from, to)] = of(Method::Yoshida4)[..] else { panic!() };
        assert!(from == 0.0 && (to - 1.573_401_947_434_540_1).abs() < 1e-15, "{to:?}");
    }

    #[test]
    fn a_composition_with_a_gap_is_given_its_gap() {
        // Two Verlet steps of 0.4z and 0.6z: by hand, tr² = 4 at z² = 20/3, 10 and 50/3.
        let gap = Composition { base: VelocityVerlet, weights: [0.4, 0.6] };
        let [first, second] = windows(gap)[..] else { panic!() };
        let expected = [(0.0, (20.0 / 3.0_f64).sqrt()), (10.0_f64.sqrt(), (50.0 / 3.0_f64).sqrt())];
        for ((from, to), (want_from, want_to)) in [first, second].into_iter().zip(expected) {
            assert!((from - want_from).abs() < 1e-15 * from.max(1.0), "{from:?}");
            assert!((to - want_to).abs() < 4e-15, "{to:?} {want_to:?}");
        }
    }

    #[test]
    fn eigenvalues_that_touch_split_a_window_only_where_the_matrix_is_defective() {
        // Two equal halves touch at z = 2√2, where the matrix is −1: no orbit grows.
        let halves = Composition { base: VelocityVerlet, weights: [0.5, 0.5] };
        assert_eq!(windows(halves), [(0.0, 4.0)]);
    }

    #[test]
    fn a_gap_far_narrower_than_any_sweep_is_found() {
        // Three nearly equal thirds: the gap near z = 3 closes as they become equal.
        let d = 2.0_f64.powi(-40);
        let third = 1.0 / 3.0;
        let nearly = Composition {
            base: VelocityVerlet,
            weights: [third - d, 1.0 - 2.0 * (third - d), third - d],
        };
        let found = windows(nearly);
        assert_eq!(found.len(), 3, "{found:?}");
        let gap = found[1].0 - found[0].1;
        assert!(gap > 0.0 && gap < 1e-10 && (found[0].1 - 3.0).abs() < 1e-10, "{found:?}");
    }
}
