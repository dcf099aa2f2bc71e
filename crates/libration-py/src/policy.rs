//! Policies of rollouts.

use libration::ensemble::InstructionSet;
use libration::rl::policy::{Activation, Network};
use libration_env::environments::{AnyPolicy, PolicySettings};
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

/// A policy of the engine.
pub(crate) enum Policy<T> {
    Plain(PolicySettings),
    Network { parameters: Vec<T>, hidden: Vec<usize>, activation: Activation },
}

impl<T: Number> Policy<T> {
    /// The one that was request.
    pub(crate) fn new(request: &PolicyRequest<'_>) -> PyResult<Self> {
        let numbers = request.numbers.to_vec()?;
        Ok(match (request.name.as_str(), numbers.as_slice()) {
            ("linear", [weights @ .., bias]) => {
                Policy::Plain(PolicySettings::Linear { weights: weights.to_vec(), bias: *bias })
            }
            ("random", &[low, high]) => Policy::Plain(PolicySettings::Random { low, high }),
            ("constant", &[action]) => Policy::Plain(PolicySettings::Constant(action)),
            ("network", _) => Policy::Network {
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
            (other, _) => return Err(value_error(format!("{other:?} is no policy of the engine"))),
        })
    }

    /// Returns the policy as an actor of the engine.
    pub(crate) fn actor<const O: usize>(&self) -> AnyPolicy<'_, T, O> {
        match self {
            Policy::Plain(acting) => AnyPolicy::new(acting),
            Policy::Network { parameters, hidden, activation } => AnyPolicy::Network(Network {
                parameters,
                hidden,
                activation: *activation,
                instructions: InstructionSet::widest(),
            }),
        }
    }
}
