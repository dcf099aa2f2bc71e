//! The instruction set of an option or of the environment.

use clap::builder::{PossibleValuesParser, TypedValueParser};
use libration::ensemble::{EnsembleError, InstructionSet};

use crate::error::Failure;

/// The environment variable with the default instruction set.
const VARIABLE: &str = "LIBRATION_SIMD";

/// Returns the parser of `--simd`.
pub(super) fn instruction_sets() -> impl TypedValueParser<Value = InstructionSet> {
    PossibleValuesParser::new(InstructionSet::ALL.map(InstructionSet::name))
        .try_map(|name| InstructionSet::from_name(&name).ok_or("unknown instruction set"))
}

/// Returns the instruction set of `option`, else that of the environment, else none.
///
/// # Errors
/// If the environment variable has an unknown value, or the processor lacks the instruction set.
pub(crate) fn instruction_set(
    option: Option<InstructionSet>,
) -> Result<Option<InstructionSet>, Failure> {
    let by_name = |name: String| match InstructionSet::from_name(&name) {
        Some(set) => Ok(set),
        None => {
            let known = InstructionSet::ALL.map(InstructionSet::name).join(", ");
            Err(Failure::usage(format!("{VARIABLE} is `{name}`; expected one of {known}")))
        }
    };
    let set = match (option, std::env::var_os(VARIABLE)) {
        (Some(set), _) => Some(set),
        (None, Some(name)) if !name.is_empty() => {
            Some(by_name(name.to_string_lossy().into_owned())?)
        }
        _ => None,
    };
    match set {
        Some(requested) if !requested.is_available() => {
            Err(Failure::usage(EnsembleError::Instructions { requested }))
        }
        set => Ok(set),
    }
}
