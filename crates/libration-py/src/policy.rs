//! Policies of rollouts.

use libration::ensemble::InstructionSet;
use libration::rl::ProgramPolicy;
use libration::rl::policy::{Activation, Network};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;

use crate::array::Number;
use crate::error::value_error;

/// A policy from Python: name, parameters, and for a network the widths of hidden layers and the activation.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct PolicyRequest<'py> {
    name: String,
    numbers: Bound<'py, PyArray1<f64>>,
    hidden: Vec<usize>,
    activation: String,
}

/// A policy of the engine, for any number of observations and actions.
pub(crate) enum Policy<T> {
    /// Weights, a row for each action, then biases.
    Linear(Vec<f64>),
    /// Lower ends, then upper ends.
    Random(Vec<f64>),
    Constant(Vec<f64>),
    Network {
        parameters: Vec<T>,
        hidden: Vec<usize>,
        activation: Activation,
    },
}

impl<T: Number> Policy<T> {
    /// The requested policy.
    pub(crate) fn new(request: &PolicyRequest<'_>) -> PyResult<Self> {
        let numbers = request.numbers.to_vec()?;
        Ok(match request.name.as_str() {
            "linear" => Policy::Linear(numbers),
            "random" => Policy::Random(numbers),
            "constant" => Policy::Constant(numbers),
            "network" => Policy::Network {
                parameters: numbers.iter().map(|&x| T::from_f64(x)).collect(),
                hidden: request.hidden.clone(),
                activation: match request.activation.as_str() {
                    "tanh" => Activation::Tanh,
                    "relu" => Activation::Relu,
                    other => {
                        let text =
                            format!("activation is {other:?}, but it must be 'tanh' or 'relu'");
                        return Err(value_error(text));
                    }
                },
            },
            other => return Err(value_error(format!("{other:?} is no policy of the engine"))),
        })
    }

    /// Returns the policy of the engine for environments with so many actions.
    pub(crate) fn sized(&self, actions: usize) -> ProgramPolicy<'_, T> {
        match self {
            Policy::Linear(numbers) => {
                let (weights, bias) = numbers.split_at(numbers.len().saturating_sub(actions));
                ProgramPolicy::Linear { weights, bias }
            }
            Policy::Random(ends) => {
                let (low, high) = ends.split_at(ends.len() / 2);
                ProgramPolicy::Random { low, high }
            }
            Policy::Constant(action) => ProgramPolicy::Constant(action),
            Policy::Network { parameters, hidden, activation } => {
                let (activation, instructions) = (*activation, InstructionSet::widest());
                ProgramPolicy::Network(Network { parameters, hidden, activation, instructions })
            }
        }
    }
}
