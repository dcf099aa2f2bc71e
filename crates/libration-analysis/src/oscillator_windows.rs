//! The stable time steps of an oscillator.

use libration_core::number::{Poly, Ratio};
use libration_core::system::DampedOscillator;
use libration_core::{AnyMethod, Integrator, Model, Scalar};

use super::roots::WholePoly;
use super::stability_window::whole_windows;
use super::{Letter, RationalStep, StabilityWindow, SymbolicStep, Tableau, UnknownStep};

/// The stability windows of a method on an oscillator, in powers of the time step; none if they are not known.
pub fn oscillator_windows(
    method: impl Into<AnyMethod>,
    oscillator: &DampedOscillator<f64>,
) -> Option<Vec<StabilityWindow>> {
    match method.into() {
        AnyMethod::Explicit(method) => {
            let symbolic = SymbolicStep::of(method, &Model::on::<UnknownStep>(oscillator));
            match symbolic {
                Some(symbolic) => Some(symbolic.stability_windows()),
                None => word_windows(method, oscillator),
            }
        }
        AnyMethod::Implicit(method) => {
            let step = RationalStep::damped(method, oscillator.omega2, oscillator.gamma)?;
            Some(step.stability_windows())
        }
    }
}

/// The longest word whose windows are isolated: a Sturm sequence of longer ones takes minutes.
const LONGEST: usize = 48;

/// The windows of a word, whose matrix is the product of its letters in whole numbers of any size.
fn word_windows(
    integrator: impl Integrator,
    oscillator: &DampedOscillator<f64>,
) -> Option<Vec<StabilityWindow>> {
    let word = Tableau::new(integrator)?.word().filter(|word| word.len() <= LONGEST)?;
    let [omega2, gamma] = [oscillator.omega2, oscillator.gamma].map(Ratio::from_f64);
    let mut product: Option<([WholePoly; 4], WholePoly)> = None;
    for letter in word {
        let [one, zero] = [Unknown::one(), Unknown::ZERO];
        let times = |c: Ratio| Unknown::monomial(c, 1);
        let [a, b, c, d] = match letter {
            Letter::Kick(w) => [one, zero, times(-(w * omega2)), one - times(w * gamma)],
            Letter::Drift(w) => [one, times(w), zero, one],
        };
        let (letter, scale) = WholePoly::over_one_denominator([&a, &b, &c, &d])?;
        product = Some(match product {
            None => (letter, scale),
            Some((before, by)) => (after(&letter, &before), &scale * &by),
        });
    }
    let (numerators, denominator) = product?;
    Some(whole_windows(numerators, &denominator))
}

/// An entry of the matrix of a letter.
type Unknown = Poly<2>;

/// The product of two matrices.
fn after([a, b, c, d]: &[WholePoly; 4], [e, f, g, h]: &[WholePoly; 4]) -> [WholePoly; 4] {
    [&(a * e) + &(b * g), &(a * f) + &(b * h), &(c * e) + &(d * g), &(c * f) + &(d * h)]
}
