//! From settings to environments.

use libration::ensemble::Execution;
use libration::rl::EnvironmentError;
use libration_analyze::trajectory::FloatType;
use libration_data::Values;

use super::settings::Dataset;
use crate::environments;
use crate::environments::{Acting, Actor, Batch, Compiled};

/// A float type of data sets.
pub(super) trait Number: Compiled {
    /// Its name in NumPy.
    const NUMPY: &str;

    /// A column of them.
    fn column(values: Vec<Self>) -> Values<'static>;

    /// A column of what lies elsewhere.
    fn view(values: &[Self]) -> Values<'_>;
}

impl Number for f32 {
    const NUMPY: &str = "<f4";

    fn column(values: Vec<f32>) -> Values<'static> {
        Values::F32(values.into())
    }

    fn view(values: &[f32]) -> Values<'_> {
        Values::F32(values.into())
    }
}

impl Number for f64 {
    const NUMPY: &str = "<f8";

    fn column(values: Vec<f64>) -> Values<'static> {
        Values::F64(values.into())
    }

    fn view(values: &[f64]) -> Values<'_> {
        Values::F64(values.into())
    }
}

/// What is to be done with the environments of a group.
pub(super) trait Visit {
    /// What comes of it.
    type Output;

    /// Does it.
    fn visit<T: Number, const O: usize>(
        self,
        all: Box<dyn Batch<T, O>>,
        actor: Actor<'static, T, O>,
    ) -> Self::Output;
}

/// Neighbouring environments of a data set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Group {
    /// Which one.
    pub(super) number: usize,
    /// The number of its first environment.
    pub(super) first: usize,
    /// How many they are.
    pub(super) len: usize,
}

impl Dataset {
    /// A group of environments.
    pub(super) fn group(&self, number: usize) -> Group {
        let first = number * self.chunk.environments;
        Group { number, first, len: (self.environments - first).min(self.chunk.environments) }
    }

    /// Makes a group's environments, at their start, and does something with them.
    ///
    /// # Errors
    /// If the settings cannot be.
    pub(super) fn with<V: Visit>(
        &self,
        Group { first, len, .. }: Group,
        execution: &Execution,
        visit: V,
    ) -> Result<V::Output, EnvironmentError> {
        let visit = Acted(visit, &self.policy);
        match self.float {
            FloatType::F64 => self.recipe.with::<f64, _>([first, len], self.seed, execution, visit),
            _ => self.recipe.with::<f32, _>([first, len], self.seed, execution, visit),
        }
    }
}

/// What is to be done, and who acts.
struct Acted<'a, V>(V, &'a Acting);

impl<T: Number, V: Visit> environments::Visit<T> for Acted<'_, V> {
    type Output = V::Output;

    fn visit<const O: usize>(self, all: Box<dyn Batch<T, O>>) -> V::Output {
        self.0.visit(all, Actor::new(self.1))
    }
}
