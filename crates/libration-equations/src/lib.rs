//! Systems from text: expressions, and straight-line programs that evaluate them on any number type.
//!
//! This crate does no input or output, reads no clock and prints nothing.

mod catalogue;
mod definitions;
mod derivative_programs;
mod dynamics;
mod enclosure;
mod equation_error;
mod equations;
mod error;
mod expression;
mod function;
mod inner_controller;
mod local_frequency;
mod parser;
mod parser_input;
mod program;
mod program_builder;
mod projection;
mod recording;
mod resolver;
mod scalar_expression;
mod step_program;
mod step_trace;
mod task;
mod task_definitions;
mod task_scope;
mod vector_step;

pub use definitions::{Definitions, MAX_DEFINITIONS, MAX_DEGREES, MAX_EXPRESSIONS};
pub use dynamics::Dynamics;
pub use enclosure::{Enclosure, Interval};
pub use equation_error::{EquationError, EquationErrorKind};
pub use equations::{Degree, Equations};
pub use error::{ExpressionError, ExpressionErrorKind};
pub use expression::Expression;
pub use function::Function;
pub use parser_input::MAX_LENGTH;
pub use program::{Evaluation, Operation, Program, ValueId};
pub use recording::Recorded;
pub use step_program::StepProgram;
pub use step_trace::{Implicit, StageOperands, VectorId, VectorOperation};
pub use task::TaskPrograms;
pub use task_definitions::TaskDefinitions;
pub use vector_step::{Flow, VectorStep};
