//! Groups of environments of a data set.

use libration::ensemble::Execution;
use libration::rl::EnvironmentError;
use libration_analyze::trajectory::FloatType;
use libration_data::Values;

use super::settings::Dataset;
use crate::environments::{AnyEnvironments, EnvironmentFloat};

/// A float type of data sets.
pub(super) trait Number: EnvironmentFloat {
    /// The type code in NumPy.
    const NUMPY: &str;

    /// A column that owns its values.
    fn column(values: Vec<Self>) -> Values<'static>;

    /// A column that borrows its values.
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

/// An operation on the environments of a group.
pub(super) trait GroupVisitor {
    /// The result of the operation.
    type Output;

    /// Runs the operation.
    fn visit<T: Number>(self, all: Box<dyn AnyEnvironments<T>>) -> Self::Output;
}

/// A group of neighbouring environments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Group {
    /// The number of the group.
    pub(super) number: usize,
    /// The number of its first environment.
    pub(super) first: usize,
    /// The number of environments.
    pub(super) len: usize,
}

impl Dataset {
    /// The group with this number.
    pub(super) fn group(&self, number: usize) -> Group {
        let first = number * self.chunk.environments;
        Group { number, first, len: (self.environments - first).min(self.chunk.environments) }
    }

    /// Builds the environments of a group at their start and runs an operation on them.
    ///
    /// # Errors
    /// If the settings are invalid.
    pub(super) fn with<V: GroupVisitor>(
        &self,
        Group { first, len, .. }: Group,
        execution: &Execution,
        visit: V,
    ) -> Result<V::Output, EnvironmentError> {
        let which = ([first, len], self.seed, execution);
        Ok(match self.float {
            FloatType::F64 => visit.visit::<f64>(self.environment.build(which)?),
            _ => visit.visit::<f32>(self.environment.build(which)?),
        })
    }
}
