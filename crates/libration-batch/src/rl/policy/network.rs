//! A neural network whose sizes are known when the program runs.

use libration_core::random::Streams;
use libration_core::{Elementary, Float};

use super::perceptron::Activation;
use super::{ActionSample, Policy, StepIndex, all_finite, network_operations, perceptron};
use crate::ensemble::{InstructionSet, Loop};
use crate::rl::EnvironmentError;

/// A multilayer perceptron of any hidden layers, whose last layer is linear: what a [`Perceptron`](super::Perceptron) is where they are all
/// as wide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Network<'a, T> {
    /// Layer by layer its matrix, row by row, and then its biases.
    pub parameters: &'a [T],
    /// Widths of the hidden layers, from 1 to [`Network::WIDEST`]; none for a linear policy.
    pub hidden: &'a [usize],
    /// The activation of the hidden layers.
    pub activation: Activation,
    /// The instruction set, which does not change the bits.
    pub instructions: InstructionSet,
}

/// Environments that go through the layers together.
const TOGETHER: usize = 16;

impl<T> Network<'_, T> {
    /// The most neurons of a hidden layer.
    pub const WIDEST: usize = 256;

    /// The number of parameters with these hidden layers.
    pub fn parameters(observation: usize, hidden: &[usize], action: usize) -> usize {
        let widths = hidden.iter().copied().chain([action]);
        let count = |(inputs, all): (usize, usize), outputs: usize| {
            (outputs, all.saturating_add(outputs.saturating_mul(inputs.saturating_add(1))))
        };
        widths.fold((observation, 0), count).1
    }
}

impl<T: Float + Elementary> Network<'_, T> {
    /// Checks the parameters for so many observed numbers and actions.
    pub(in crate::rl) fn check_sizes(
        &self,
        observation: usize,
        action: usize,
    ) -> Result<(), EnvironmentError> {
        let most = observation.min(Self::WIDEST);
        EnvironmentError::shape("inputs of a network", observation, most)?;
        EnvironmentError::shape("outputs of a network", action, action.min(Self::WIDEST))?;
        for &width in self.hidden {
            let allowed = width.clamp(1, Self::WIDEST);
            EnvironmentError::shape("neurons of a hidden layer", width, allowed)?;
        }
        let wanted = Self::parameters(observation, self.hidden, action);
        EnvironmentError::shape("parameters of the network", self.parameters.len(), wanted)?;
        let parameters = self.parameters.iter().map(|x| x.to_f64());
        all_finite::<T>("parameter of the network", parameters)
    }

    /// Multiplications and additions of an action, with those of activations.
    pub(in crate::rl) fn work(&self) -> u64 {
        let neurons: usize = self.hidden.iter().sum();
        network_operations(self.parameters.len(), neurons, self.activation)
    }

    /// The actions of `W` environments.
    pub(in crate::rl) fn forward<const W: usize>(&self, seen: &[[T; W]], actions: &mut [[T; W]]) {
        self.instructions.vectorize(Forward { network: self, seen, actions });
    }
}

impl<T, const O: usize, const D: usize> Policy<T, O, D> for Network<'_, T>
where
    T: Float + Elementary,
{
    fn check(&self, _: usize, _: usize) -> Result<(), EnvironmentError> {
        self.check_sizes(O, D)
    }

    fn operations(&self, _: usize) -> u64 {
        self.work()
    }

    #[inline(always)]
    fn act(
        &self,
        place: StepIndex,
        seen: &[T; O],
        _: &mut impl FnMut() -> u32,
    ) -> ActionSample<T, D> {
        perceptron::forward_one(self, place, seen)
    }

    /// A separate function, compiled once for all callers.
    fn act_all<const W: usize>(
        &self,
        _: StepIndex,
        seen: &[[T; W]; O],
        _: &mut Streams<W>,
        actions: &mut [[T; W]; D],
        log_probabilities: &mut [T; W],
    ) {
        *log_probabilities = [T::zero(); W];
        self.forward(seen, actions);
    }
}

/// The forward pass of a network for a block.
struct Forward<'a, 'n, T, const W: usize> {
    network: &'a Network<'n, T>,
    seen: &'a [[T; W]],
    actions: &'a mut [[T; W]],
}

impl<T, const W: usize> Loop for Forward<'_, '_, T, W>
where
    T: Float + Elementary,
{
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Forward { network: &Network { parameters, hidden, activation, .. }, seen, actions } =
            self;
        let mut layers = [[[T::zero(); TOGETHER]; Network::<()>::WIDEST]; 2];
        for first in (0..W).step_by(TOGETHER) {
            let count = (W - first).min(TOGETHER);
            let [mut inputs, mut outputs] = layers.each_mut();
            for (row, seen) in inputs.iter_mut().zip(seen) {
                row[..count].copy_from_slice(&seen[first..first + count]);
            }
            let (mut width, mut rest) = (seen.len(), parameters);
            for &next in hidden {
                rest = layer(rest, &inputs[..width], &mut outputs[..next]);
                perceptron::activate(activation, &mut outputs[..next]);
                (inputs, outputs, width) = (outputs, inputs, next);
            }
            layer(rest, &inputs[..width], &mut outputs[..actions.len()]);
            for (action, row) in actions.iter_mut().zip(outputs.iter()) {
                action[first..first + count].copy_from_slice(&row[..count]);
            }
        }
    }
}

/// The sums of a layer, each from its bias on; gives the parameters of those that follow.
#[inline(always)]
fn layer<'a, T: Float>(
    parameters: &'a [T],
    inputs: &[[T; TOGETHER]],
    outputs: &mut [[T; TOGETHER]],
) -> &'a [T] {
    let (matrix, rest) = parameters.split_at(inputs.len() * outputs.len());
    let (biases, rest) = rest.split_at(outputs.len());
    for ((output, &bias), row) in
        outputs.iter_mut().zip(biases).zip(matrix.chunks_exact(inputs.len().max(1)))
    {
        let mut sums = [bias; TOGETHER];
        for (input, &weight) in inputs.iter().zip(row) {
            for l in 0..TOGETHER {
                sums[l] = sums[l] + weight * input[l];
            }
        }
        *output = sums;
    }
    rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rl::policy::Perceptron;

    #[test]
    fn a_network_of_equal_layers_is_the_perceptron_to_the_bit() {
        let count = Perceptron::<f32, 5>::parameters(3, 2, 1);
        let parameters: Vec<f32> =
            (0..count).map(|k| ((k * 37 % 101) as f32 - 50.0) / 40.0).collect();
        assert_eq!(count, Network::<f32>::parameters(3, &[5, 5], 1));
        let seen: [[f32; 70]; 3] =
            core::array::from_fn(|i| core::array::from_fn(|l| ((i + 3 * l) as f32).sin()));
        let place = StepIndex { environment: 0, environments: 70, step: 0, row: 0 };
        for activation in [Activation::Tanh, Activation::Relu] {
            let wanted = Perceptron::<f32, 5> { parameters: &parameters, activation };
            let mut streams = Streams::none();
            let (mut expected, mut log) = ([[0.0; 70]; 1], [0.0; 70]);
            wanted.act_all(place, &seen, &mut streams, &mut expected, &mut log);
            for instructions in InstructionSet::available() {
                let network =
                    Network { parameters: &parameters, hidden: &[5, 5], activation, instructions };
                let mut found = [[0.0; 70]; 1];
                network.act_all(place, &seen, &mut streams, &mut found, &mut log);
                assert_eq!(found, expected);
                let alone: ActionSample<f32, 1> =
                    network.act(place, &seen.map(|row| row[9]), &mut || 0);
                assert_eq!(alone.action[0], expected[0][9]);
            }
        }
    }

    #[test]
    fn a_network_whose_numbers_do_not_fit_is_refused() {
        let instructions = InstructionSet::Baseline;
        let refused = |parameters: &[f32], hidden: &[usize]| {
            let network =
                Network { parameters, hidden, activation: Activation::Relu, instructions };
            Policy::<f32, 2, 1>::check(&network, 1, 1).unwrap_err().to_string()
        };
        assert_eq!(
            refused(&[0.0; 12], &[3]),
            "the number of parameters of the network is 12; it must be 13"
        );
        assert_eq!(
            refused(&[], &[300]),
            "the number of neurons of a hidden layer is 300; it must be 256"
        );
        assert!(refused(&[f32::NAN; 3], &[]).contains("parameter of the network"));
    }
}
