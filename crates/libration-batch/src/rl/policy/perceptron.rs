//! A small neural network.

use libration_core::random::Streams;
use libration_core::{Elementary, Float};

use super::{ActionSample, Policy, StepIndex, all_finite, lanes, network_operations};
use crate::rl::EnvironmentError;

/// The activation function of the hidden layers of a [`Perceptron`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Activation {
    /// The hyperbolic tangent.
    Tanh,
    /// `max(0, x)`.
    Relu,
}

/// A multilayer perceptron with hidden layers of `H` each, whose last layer is linear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Perceptron<'a, T, const H: usize> {
    /// Layer by layer its matrix, row by row, and then its biases: first `H × O`, then any number of `H × H`, at last
    /// `D × H`.
    pub parameters: &'a [T],
    /// The activation of the hidden layers.
    pub activation: Activation,
}

/// A [`Perceptron`] with parameters for each environment, as evolution strategies want.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PerceptronPerEnvironment<'a, T, const H: usize> {
    /// `[k, n]`, where number `k` of environment `n` is that of a [`Perceptron`].
    pub parameters: &'a [T],
    /// The activation of the hidden layers.
    pub activation: Activation,
}

/// Parameters of a layer.
const fn parameters(inputs: usize, outputs: usize) -> usize {
    outputs * (inputs + 1)
}

/// Hidden layers between the first and the last, if there are so many parameters.
fn between<const O: usize, const H: usize, const D: usize>(count: usize) -> usize {
    let ends = const { parameters(O, H) + parameters(H, D) };
    let each = const {
        assert!(H > 0, "a hidden layer of nothing");
        parameters(H, H)
    };
    count.saturating_sub(ends).div_ceil(each)
}

impl<T, const H: usize> Perceptron<'_, T, H> {
    /// The number of parameters with `hidden_layers` hidden layers, at least 1.
    pub const fn parameters(observation: usize, hidden_layers: usize, action: usize) -> usize {
        let between = hidden_layers.saturating_sub(1) * parameters(H, H);
        parameters(observation, H) + between + parameters(H, action)
    }
}

impl<T, const O: usize, const H: usize, const D: usize> Policy<T, O, D> for Perceptron<'_, T, H>
where
    T: Float + Elementary,
{
    fn check(&self, _: usize, _: usize) -> Result<(), EnvironmentError> {
        let found = self.parameters.len();
        let wanted = Self::parameters(O, 1 + between::<O, H, D>(found), D);
        EnvironmentError::shape("parameters of the network", found, wanted)?;
        let parameters = self.parameters.iter().map(|x| x.to_f64());
        all_finite::<T>("parameter of the network", parameters)
    }

    fn operations(&self, _: usize) -> u64 {
        let hidden = 1 + between::<O, H, D>(self.parameters.len());
        network_operations(self.parameters.len(), hidden * H, self.activation)
    }

    #[inline(always)]
    fn act(
        &self,
        place: StepIndex,
        seen: &[T; O],
        _: &mut impl FnMut() -> u32,
    ) -> ActionSample<T, D> {
        forward_one(self, place, seen)
    }

    #[inline(always)]
    fn act_all<const W: usize>(
        &self,
        _: StepIndex,
        seen: &[[T; W]; O],
        _: &mut Streams<W>,
        actions: &mut [[T; W]; D],
        log_probabilities: &mut [T; W],
    ) {
        *log_probabilities = [T::zero(); W];
        let between = between::<O, H, D>(self.parameters.len());
        let parameter = |k| [self.parameters[k]; W];
        forward::<T, O, H, D, W>(self.activation, between, parameter, seen, actions);
    }
}

impl<T, const O: usize, const H: usize, const D: usize> Policy<T, O, D>
    for PerceptronPerEnvironment<'_, T, H>
where
    T: Float + Elementary,
{
    fn check(&self, environments: usize, _: usize) -> Result<(), EnvironmentError> {
        let found = self.parameters.len();
        let layers = 1 + between::<O, H, D>(found.checked_div(environments).unwrap_or(0));
        let wanted = Perceptron::<T, H>::parameters(O, layers, D).saturating_mul(environments);
        EnvironmentError::shape("parameters of the networks", found, wanted)?;
        let parameters = self.parameters.iter().map(|x| x.to_f64());
        all_finite::<T>("parameter of the networks", parameters)
    }

    fn operations(&self, environments: usize) -> u64 {
        let found = self.parameters.len().checked_div(environments).unwrap_or(0);
        network_operations(found, (1 + between::<O, H, D>(found)) * H, self.activation)
    }

    #[inline(always)]
    fn act(
        &self,
        place: StepIndex,
        seen: &[T; O],
        _: &mut impl FnMut() -> u32,
    ) -> ActionSample<T, D> {
        forward_one(self, place, seen)
    }

    #[inline(always)]
    fn act_all<const W: usize>(
        &self,
        place: StepIndex,
        seen: &[[T; W]; O],
        _: &mut Streams<W>,
        actions: &mut [[T; W]; D],
        log_probabilities: &mut [T; W],
    ) {
        *log_probabilities = [T::zero(); W];
        let between = between::<O, H, D>(self.parameters.len() / place.environments.max(1));
        let parameter = |k| lanes::<T, W>(self.parameters, place, k);
        forward::<T, O, H, D, W>(self.activation, between, parameter, seen, actions);
    }
}

/// One action of a policy that has many at once.
#[inline(always)]
pub(super) fn forward_one<T: Float, P: Policy<T, O, D>, const O: usize, const D: usize>(
    policy: &P,
    place: StepIndex,
    seen: &[T; O],
) -> ActionSample<T, D> {
    let (mut actions, mut likely) = ([[T::zero(); 1]; D], [T::zero()]);
    let mut words = Streams::none();
    policy.act_all(place, &seen.map(|x| [x]), &mut words, &mut actions, &mut likely);
    ActionSample::deterministic(actions.map(|[x]| x))
}

/// The forward pass of networks with the given parameters.
#[inline(always)]
fn forward<T, const O: usize, const H: usize, const D: usize, const W: usize>(
    activation: Activation,
    between: usize,
    parameter: impl Fn(usize) -> [T; W],
    seen: &[[T; W]; O],
    actions: &mut [[T; W]; D],
) where
    T: Float + Elementary,
{
    let mut hidden = [[T::zero(); W]; H];
    layer(0, &parameter, seen, &mut hidden);
    activate(activation, &mut hidden);
    let mut first = const { parameters(O, H) };
    for _ in 0..between {
        let inputs = hidden;
        layer(first, &parameter, &inputs, &mut hidden);
        activate(activation, &mut hidden);
        first += const { parameters(H, H) };
    }
    layer(first, &parameter, &hidden, actions);
}

#[inline(always)]
pub(super) fn activate<T: Float + Elementary, const W: usize>(
    activation: Activation,
    hidden: &mut [[T; W]],
) {
    for row in hidden {
        match activation {
            Activation::Tanh => {
                for x in row {
                    *x = tanh(*x);
                }
            }
            Activation::Relu => {
                for x in row {
                    // What is no number stays none.
                    *x = if *x < T::zero() { T::zero() } else { *x };
                }
            }
        }
    }
}

/// The sums of a layer, each from its bias on; its parameters are those from the `first` on.
#[inline(always)]
fn layer<T: Float, const I: usize, const N: usize, const W: usize>(
    first: usize,
    parameter: &impl Fn(usize) -> [T; W],
    inputs: &[[T; W]; I],
    outputs: &mut [[T; W]; N],
) {
    for (j, output) in outputs.iter_mut().enumerate() {
        let mut sums = parameter(first + N * I + j);
        for (i, input) in inputs.iter().enumerate() {
            let weight = parameter(first + j * I + i);
            for l in 0..W {
                sums[l] = sums[l] + weight[l] * input[l];
            }
        }
        *output = sums;
    }
}

/// The hyperbolic tangent, from nothing but sums, products and quotients: the same bits wherever it is computed.
///
/// Lambert's continued fraction at a thirty-second of the argument (W. B. Jones, W. J. Thron, *Continued Fractions*, 1980,
/// section 6.1), and five times `tanh 2x = 2 tanh x/(1 + tanh² x)`. Beyond 20 it is 1 in every float type.
#[inline(always)]
fn tanh<T: Float + Elementary>(x: T) -> T {
    let most = T::from_f64(20.0);
    let x = if x > most { most } else { x };
    let x = if x < -most { -most } else { x };
    let x = x * T::from_f64(1.0 / 32.0);
    let square = x * x;
    let mut denominator = T::from_f64(13.0);
    for odd in [11.0, 9.0, 7.0, 5.0, 3.0, 1.0] {
        denominator = T::from_f64(odd) + square * denominator.recip();
    }
    let mut value = x * denominator.recip();
    for _ in 0..5 {
        value = (value + value) * (T::one() + value * value).recip();
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tangent_is_good_to_a_few_units_of_the_last_place() {
        for k in -4000..=4000 {
            let x = f64::from(k) / 180.0;
            let (found, exact) = (tanh(x), x.tanh());
            // Each doubling adds a rounding or two and keeps those before: 16 units are measured to be enough.
            assert!(
                (found - exact).abs() <= 16.0 * f64::EPSILON * exact.abs(),
                "{x} {found} {exact}"
            );
            let (found, exact) = (tanh(x as f32), f64::from(x as f32).tanh());
            let bound = 16.0 * f64::from(f32::EPSILON) * exact.abs();
            assert!((f64::from(found) - exact).abs() <= bound, "{x} {found} {exact}");
        }
        assert!(tanh(f64::NAN).is_nan());
        assert_eq!([tanh(f64::INFINITY), tanh(f64::NEG_INFINITY)], [1.0, -1.0]);
    }

    #[test]
    fn a_network_is_the_sums_that_its_parameters_say() {
        // Two inputs, two hidden layers of two, one output.
        let parameters: Vec<f64> = (0..15).map(|k| 0.3 - 0.07 * f64::from(k)).collect();
        assert_eq!(parameters.len(), Perceptron::<f64, 2>::parameters(2, 2, 1));
        let p = &parameters;
        let first = [0, 1].map(|j| p[2 * j] * 0.5 - p[2 * j + 1] * 2.0 + p[4 + j]);
        let relu = |x: f64| x.max(0.0);
        for (activation, function) in
            [(Activation::Relu, &relu as &dyn Fn(f64) -> f64), (Activation::Tanh, &f64::tanh)]
        {
            let hidden = first.map(function);
            let second = [0, 1]
                .map(|j| p[6 + 2 * j] * hidden[0] + p[7 + 2 * j] * hidden[1] + p[10 + j])
                .map(function);
            let wanted = p[12] * second[0] + p[13] * second[1] + p[14];
            let network = Perceptron::<f64, 2> { parameters: p, activation };
            let place = StepIndex { environment: 0, environments: 1, step: 0, row: 0 };
            let act: ActionSample<f64, 1> = network.act(place, &[0.5, -2.0], &mut || 0);
            assert!((act.action[0] - wanted).abs() < 1e-15, "{activation:?} {act:?} {wanted}");
        }
        let short = Perceptron::<f64, 2> { parameters: &p[..14], activation: Activation::Relu };
        let refused = Policy::<f64, 2, 1>::check(&short, 1, 1).unwrap_err().to_string();
        assert_eq!(refused, "the number of parameters of the network is 14; it must be 15");
    }
}
