//! Eigenvalue, shape, controllability and observability of each mode of a plant.

use num_complex::Complex64;

use crate::controllability::BalancedPair;
use crate::{LinearPlant, PlantMode};

/// A mode of a plant with its eigenvalue, and how well inputs reach it and outputs show it.
#[derive(Clone, Debug, PartialEq)]
pub struct ModeDetails {
    /// Growth rate, frequency and the states that move most.
    pub mode: PlantMode,
    /// The eigenvalue in 1/s; of a pair the upper one.
    pub value: Complex64,
    /// The eigenvector, of largest entry 1.
    pub shape: Vec<Complex64>,
    /// The relative change of the entries of `A` and `B` up to which inputs reach all motions with this eigenvalue: 0 if they do not
    /// reach all of them as they are, at most 1.
    pub controllability: f64,
    /// The same of `A` and `C`, and of motions that outputs show.
    pub observability: f64,
    /// The change that is rounding.
    rounding: f64,
}

/// Change of a plant below which a mode is reached or shown weakly: models are not known to more digits.
const WEAK: f64 = 1e-6;

/// Roundings of the entries of a plant, for each state, that a change by rounding may be: eigenvalues have as many.
const ROUNDINGS: f64 = 64.0;

impl ModeDetails {
    /// Whether inputs reach all motions with this eigenvalue.
    pub fn is_controllable(&self) -> bool {
        self.controllability > self.rounding
    }

    /// Whether inputs reach all motions with this eigenvalue, but a change of the plant by less than 10⁻⁶ of its numbers may end that.
    pub fn is_weakly_controllable(&self) -> bool {
        self.is_controllable() && self.controllability < WEAK
    }

    /// Whether outputs show all motions with this eigenvalue.
    pub fn is_observable(&self) -> bool {
        self.observability > self.rounding
    }

    /// Whether outputs show all motions with this eigenvalue, but a change of the plant by less than 10⁻⁶ of its numbers may end that.
    pub fn is_weakly_observable(&self) -> bool {
        self.is_observable() && self.observability < WEAK
    }

    /// The natural frequency `|λ|` in rad/s; of a mode without oscillation its rate.
    pub fn natural_frequency(&self) -> f64 {
        self.value.norm()
    }

    /// The damping ratio `−Re λ/|λ|`, from −1 to 1; none of `λ = 0`.
    pub fn damping_ratio(&self) -> Option<f64> {
        let size = self.value.norm();
        // Not the negative zero.
        (size > 0.0).then(|| 0.0 - self.value.re / size)
    }

    /// The time in s in which the mode decays to 1/e; none if it does not decay.
    pub fn time_constant(&self) -> Option<f64> {
        (self.value.re < 0.0).then(|| -self.value.re.recip())
    }
}

impl LinearPlant {
    /// The modes of the plant with all details, the one that grows fastest first; of a pair one.
    ///
    /// Controllability is that of the test of Popov, Belevitch and Hautus, as for [`LinearPlant::unreachable_mode`].
    pub fn mode_details(&self) -> Vec<ModeDetails> {
        let driven = BalancedPair::new(&self.a, &self.b);
        let shown = BalancedPair::new(&self.a.transposed(), &self.c.transposed());
        let rounding = ROUNDINGS * self.states.len() as f64 * f64::EPSILON;
        let shapes = self.shapes();
        let named = self.name_shapes(&shapes);
        let details =
            |((value, shape), named): ((Complex64, Vec<Complex64>), &Vec<Complex64>)| ModeDetails {
                mode: self.mode(value, named),
                value: self.rate_of(value),
                shape,
                controllability: driven.controllability(value),
                observability: shown.controllability(value),
                rounding,
            };
        shapes.into_iter().zip(&named).map(details).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Matrix;

    #[test]
    fn a_mode_that_no_input_reaches_or_no_output_shows_is_marked_also_if_it_decays() {
        let a = Matrix::from_rows(&[[0.0, 1.0, 0.0], [-25.0, -2.0, 0.0], [0.0, 0.0, -3.0]]);
        let b = Matrix::from_rows(&[[0.0], [1.0], [0.0]]).unwrap();
        let c = Matrix::from_rows(&[[0.0, 0.0, 1.0]]).unwrap();
        let plant = LinearPlant::new(a.unwrap(), b, c, Matrix::zeros(1, 1)).unwrap();
        let [pair, lone] = &plant.mode_details()[..] else { panic!("two modes") };
        assert!(pair.is_controllable() && !pair.is_observable(), "{pair:?}");
        assert!(!lone.is_controllable() && lone.is_observable(), "{lone:?}");
        // λ² + 2λ + 25, a natural frequency of 5 rad/s and a damping ratio of 1/5.
        assert!((pair.natural_frequency() - 5.0).abs() < 1e-14, "{pair:?}");
        assert!((pair.damping_ratio().unwrap() - 0.2).abs() < 1e-15, "{pair:?}");
        assert!((pair.time_constant().unwrap() - 1.0).abs() < 1e-15, "{pair:?}");
        assert_eq!((lone.damping_ratio(), lone.time_constant()), (Some(1.0), Some(1.0 / 3.0)));
    }

    #[test]
    fn a_plant_that_does_not_move_by_itself_has_modes_that_inputs_reach() {
        let of = |inputs: usize| {
            let b = Matrix::from_fn(2, inputs, |i, k| f64::from(u8::from(i == k)));
            let plant = LinearPlant::new(
                Matrix::zeros(2, 2),
                b,
                Matrix::identity(2),
                Matrix::zeros(2, inputs),
            );
            plant.unwrap().mode_details()
        };
        let [one, two] = &of(2)[..] else { panic!("two modes") };
        assert!(one.is_controllable() && one.is_observable() && two.is_controllable(), "{one:?}");
        assert_eq!((one.mode.states[0].0.as_str(), two.mode.states[0].0.as_str()), ("x1", "x2"));
        assert_eq!((one.value.norm(), one.damping_ratio()), (0.0, None));
        // Of two integrators one input reaches one.
        assert!(of(1).iter().all(|mode| !mode.is_controllable()));
    }
}
