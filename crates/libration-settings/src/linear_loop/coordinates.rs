//! Coordinates at which a search for an equilibrium begins.

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::{Fault, Number, suggestions};

/// Numbers of a state or of commands: one, one for each in order, or some by name.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(
    untagged,
    expecting = "expected a number, a list with one number for each coordinate, or a table by name"
)]
pub enum Coordinates {
    /// Of a system with one.
    One(Number),
    /// One for each.
    Each(Vec<Number>),
    /// By name; others are zero.
    Named(BTreeMap<String, Number>),
}

impl Coordinates {
    /// The numbers of `names`, where `known` is what they are without this.
    pub(super) fn numbers(
        &self,
        key: &'static str,
        names: &[&str],
        known: &[f64],
    ) -> Result<Vec<f64>, Fault> {
        let numbers: Vec<f64> = match self {
            Coordinates::One(Number(x)) => vec![*x],
            Coordinates::Each(each) => each.iter().map(|x| x.0).collect(),
            Coordinates::Named(some) => {
                let mut numbers = known.to_vec();
                for (name, x) in some {
                    let Some(i) = names.iter().position(|own| own == name) else {
                        let help = suggestions::suggest("names", name, names.iter().copied());
                        return Err(Fault::new(key, format!("unknown name `{name}`")).help(help));
                    };
                    numbers[i] = x.0;
                }
                numbers
            }
        };
        if let Some(x) = numbers.iter().find(|x| !x.is_finite()) {
            return Err(Fault::new(key, format!("{x:?} is given; expected finite numbers")));
        }
        if numbers.len() != names.len() {
            let short = key.rsplit('.').next().unwrap_or(key);
            let message = format!(
                "`{short}` has {} numbers; expected {}: {}",
                numbers.len(),
                names.len(),
                names.join(", ")
            );
            return Err(Fault::new(key, message));
        }
        Ok(numbers)
    }

    pub(super) fn len(&self) -> usize {
        match self {
            Coordinates::One(_) => 1,
            Coordinates::Each(each) => each.len(),
            Coordinates::Named(some) => some.len(),
        }
    }
}
