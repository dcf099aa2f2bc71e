//! Who acts in a rollout.

use libration::ensemble::InstructionSet;
use libration::rl::policy::{Activation, Network};
use libration_env::environments::{Acting, Actor};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;

use crate::array::Number;
use crate::error::refused;

/// A policy as `libration` hands it over: its name, numbers of it, and of a network the widths of its hidden layers and what they apply.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Told<'py> {
    name: String,
    numbers: Bound<'py, PyArray1<f64>>,
    hidden: Vec<usize>,
    activation: String,
}

/// A policy of the engine.
pub(crate) enum Acts<T> {
    Plain(Acting),
    Network { parameters: Vec<T>, hidden: Vec<usize>, activation: Activation },
}

impl<T: Number> Acts<T> {
    /// The one that was told.
    pub(crate) fn new(told: &Told<'_>) -> PyResult<Self> {
        let numbers = told.numbers.to_vec()?;
        Ok(match (told.name.as_str(), numbers.as_slice()) {
            ("linear", [weights @ .., bias]) => {
                Acts::Plain(Acting::Linear { weights: weights.to_vec(), bias: *bias })
            }
            ("random", &[low, high]) => Acts::Plain(Acting::Random { low, high }),
            ("constant", &[action]) => Acts::Plain(Acting::Constant(action)),
            ("network", _) => Acts::Network {
                parameters: numbers.iter().map(|&x| T::from_f64(x)).collect(),
                hidden: told.hidden.clone(),
                activation: match told.activation.as_str() {
                    "tanh" => Activation::Tanh,
                    "relu" => Activation::Relu,
                    other => {
                        let text =
                            format!("activation is {other:?}, but it must be 'tanh' or 'relu'");
                        return Err(refused(text));
                    }
                },
            },
            (other, _) => return Err(refused(format!("{other:?} is no policy of the engine"))),
        })
    }

    /// It, as the engine asks it.
    pub(crate) fn actor<const O: usize>(&self) -> Actor<'_, T, O> {
        match self {
            Acts::Plain(acting) => Actor::new(acting),
            Acts::Network { parameters, hidden, activation } => Actor::Network(Network {
                parameters,
                hidden,
                activation: *activation,
                instructions: InstructionSet::widest(),
            }),
        }
    }
}
