//! Collocation at the nodes of Gauss and Legendre.
//!
//! E. Hairer, C. Lubich, G. Wanner: Geometric Numerical Integration, 2nd ed., §II.1.3 (coefficients: table II.1.1), §IV.2 and §VI.4.

use super::{ImplicitIntegrator, NEWTON_STEPS};
use crate::array::each;
use crate::system::ImplicitSystem;
use crate::{Scalar, State};

/// The coefficients of a collocation method with `N` stages.
///
/// All are rational numbers and rational multiples of one root. The conditions of symplecticity and of symmetry hold for each value of that
/// root, so that its rounding affects neither. Sums of rates multiply rates by ratios, and not by rounded weights: those rounded alike in
/// each step would change the energy of an oscillator in proportion to time.
pub(super) trait Collocation<const N: usize>: Copy {
    /// The root, and what its rounding to `f64` leaves: with one part alone the order would be 2 in wider types.
    const ROOT: [f64; 2];

    /// `h` times the integrals of the shifted Legendre polynomials, in these polynomials: column `k` is that of `Pₖ`.
    fn integrals<S: Scalar>(h: S) -> [[S; N]; N];

    /// `h·a`, for `h` and its product with the root.
    fn coefficients<S: Scalar>(h: S, h_root: S) -> [[S; N]; N];

    /// `Σₖ Pₖ(cᵢ)·polynomialₖ` at each node `cᵢ`.
    fn at_nodes<S: Scalar>(polynomial: [S; N]) -> [S; N];

    /// `Σⱼ bⱼ·rateⱼ`.
    fn mean<S: Scalar>(rates: [S; N]) -> S;

    /// `Σⱼ (aᵢⱼ − bⱼ/2)·rateⱼ` over the root, of each stage `i`.
    fn offsets<S: Scalar>(rates: [S; N]) -> [S; N];
}

/// A function of the same coordinate of several states, for each coordinate.
fn of_coordinates<S: Scalar, const D: usize, const N: usize>(
    states: &[State<S, D>; N],
    f: impl Fn([S; N]) -> S,
) -> State<S, D> {
    State { q: each(|d| f(each(|i| states[i].q[d]))), v: each(|d| f(each(|i| states[i].v[d]))) }
}

/// One step: the rates `Kᵢ = f(y + h·Σⱼ aᵢⱼKⱼ)` by so many Newton steps, and `y' = y + h·Σᵢ bᵢKᵢ`.
///
/// In the first Newton step all derivatives are those at `y`. It solves for the Legendre coefficients of the polynomial of rates: their
/// equations have rational coefficients, and the mean rate is the first of them.
#[inline(never)]
pub(super) fn step<
    S: Scalar,
    const D: usize,
    T: ImplicitSystem<S, D>,
    M: Collocation<N>,
    const N: usize,
>(
    _: M,
    system: &T,
    start: State<S, D>,
    h: S,
    newton_steps: u32,
) -> State<S, D> {
    let mut right = [State::origin(); N];
    right[0] = system.rate(start);
    let polynomial = system.solve_stages(&[start; N], &M::integrals(h), right);
    if T::IS_EXACTLY_LINEAR {
        return start.plus(h, polynomial[0]);
    }
    let [root, rest] = M::ROOT.map(|part| h * S::from_f64(part));
    let h_root = root + rest;
    let coefficients = M::coefficients(h, h_root);
    let mut rates = [start; N];
    for (i, rate) in rates.iter_mut().enumerate() {
        *rate = of_coordinates(&polynomial, |polynomial| M::at_nodes(polynomial)[i]);
    }
    for _ in 1..newton_steps {
        let middle = start.plus(h.ratio(1, 2), of_coordinates(&rates, M::mean));
        let (mut at, mut residuals) = ([start; N], [start; N]);
        for i in 0..N {
            let offset = of_coordinates(&rates, |rates| M::offsets(rates)[i]);
            at[i] = middle.plus(h_root, offset);
            residuals[i] =
                of_coordinates(&[system.rate(at[i]), rates[i]], |[rate, own]| rate - own);
        }
        let corrections = system.solve_stages(&at, &coefficients, residuals);
        for (rate, correction) in rates.iter_mut().zip(corrections) {
            *rate = *rate + correction;
        }
    }
    start.plus(h, of_coordinates(&rates, M::mean))
}

/// Gauss–Legendre collocation with two stages. Order 4; symplectic, time-reversible, stable for every step on every mode that does not
/// grow; it conserves quadratic invariants, such as the energy of an oscillator.
#[derive(Clone, Copy, Debug, Default)]
pub struct GaussLegendre4;

impl Collocation<2> for GaussLegendre4 {
    /// √3.
    const ROOT: [f64; 2] = [1.732_050_807_568_877_2, 1.0035084221806903e-16];

    fn integrals<S: Scalar>(h: S) -> [[S; 2]; 2] {
        let half = h.ratio(1, 2);
        [[half, -h.ratio(1, 6)], [half, S::zero()]]
    }

    fn coefficients<S: Scalar>(h: S, h_root: S) -> [[S; 2]; 2] {
        let (quarter, sixth) = (h.ratio(1, 4), h_root.ratio(1, 6));
        [[quarter, quarter - sixth], [quarter + sixth, quarter]]
    }

    fn at_nodes<S: Scalar>([constant, linear]: [S; 2]) -> [S; 2] {
        // P₁(cᵢ) = ∓√3/3.
        let part = (S::from_f64(Self::ROOT[0]) * linear).ratio(1, 3);
        [constant - part, constant + part]
    }

    fn mean<S: Scalar>([first, last]: [S; 2]) -> S {
        (first + last).ratio(1, 2)
    }

    fn offsets<S: Scalar>([first, last]: [S; 2]) -> [S; 2] {
        [-last.ratio(1, 6), first.ratio(1, 6)]
    }
}

impl ImplicitIntegrator for GaussLegendre4 {
    fn step<S: Scalar, const D: usize>(
        self,
        system: &impl ImplicitSystem<S, D>,
        state: State<S, D>,
        dt: S,
    ) -> State<S, D> {
        step(self, system, state, dt, NEWTON_STEPS)
    }
}

/// Gauss–Legendre collocation with three stages. Order 6; otherwise as [`GaussLegendre4`].
#[derive(Clone, Copy, Debug, Default)]
pub struct GaussLegendre6;

impl Collocation<3> for GaussLegendre6 {
    /// √15.
    const ROOT: [f64; 2] = [3.872_983_346_207_417, -1.362103086746368e-16];

    fn integrals<S: Scalar>(h: S) -> [[S; 3]; 3] {
        let (half, sixth, tenth, zero) = (h.ratio(1, 2), h.ratio(1, 6), h.ratio(1, 10), S::zero());
        [[half, -sixth, zero], [half, zero, -tenth], [zero, sixth, zero]]
    }

    fn coefficients<S: Scalar>(h: S, h_root: S) -> [[S; 3]; 3] {
        let (outer, inner) = (h.ratio(5, 36), h.ratio(2, 9));
        let (a, b, c) = (h_root.ratio(1, 15), h_root.ratio(1, 24), h_root.ratio(1, 30));
        [
            [outer, inner - a, outer - c],
            [outer + b, inner, outer - b],
            [outer + c, inner + a, outer],
        ]
    }

    fn at_nodes<S: Scalar>([constant, linear, quadratic]: [S; 3]) -> [S; 3] {
        // P₁(cᵢ) = ∓√15/5 or 0; P₂(cᵢ) = 2/5 or −1/2.
        let part = (S::from_f64(Self::ROOT[0]) * linear).ratio(1, 5);
        let outer = constant + quadratic.ratio(2, 5);
        [outer - part, constant - quadratic.ratio(1, 2), outer + part]
    }

    /// The inner rate and 5/18 of the differences to it, so that equal rates have no roundings.
    fn mean<S: Scalar>([first, inner, last]: [S; 3]) -> S {
        inner + ((first - inner) + (last - inner)).ratio(5, 18)
    }

    fn offsets<S: Scalar>([first, inner, last]: [S; 3]) -> [S; 3] {
        let twice = inner + inner;
        [-(twice + last).ratio(1, 30), (first - last).ratio(1, 24), (first + twice).ratio(1, 30)]
    }
}

impl ImplicitIntegrator for GaussLegendre6 {
    fn step<S: Scalar, const D: usize>(
        self,
        system: &impl ImplicitSystem<S, D>,
        state: State<S, D>,
        dt: S,
    ) -> State<S, D> {
        step(self, system, state, dt, NEWTON_STEPS)
    }
}
