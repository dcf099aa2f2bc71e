//! The instruction set that is asked for, by a flag or by the environment.

use clap::builder::{PossibleValuesParser, TypedValueParser};
use libration::ensemble::{EnsembleError, InstructionSet};

use crate::error::Failure;

/// The variable that names an instruction set where no flag does.
const VARIABLE: &str = "LIBRATION_SIMD";

/// The value of a flag `--simd`.
pub(super) fn instruction_sets() -> impl TypedValueParser<Value = InstructionSet> {
    PossibleValuesParser::new(InstructionSet::ALL.map(InstructionSet::name))
        .try_map(|name| InstructionSet::from_name(&name).ok_or("unknown instruction set"))
}

/// What `flag` says, or the environment; none if neither does.
///
/// # Errors
/// If the environment names none, or the processor lacks what is asked for.
pub(crate) fn asked(flag: Option<InstructionSet>) -> Result<Option<InstructionSet>, Failure> {
    let by_name = |name: String| match InstructionSet::from_name(&name) {
        Some(set) => Ok(set),
        None => {
            let known = InstructionSet::ALL.map(InstructionSet::name).join(", ");
            Err(Failure::usage(format!("{VARIABLE} is `{name}`, but it must be one of {known}")))
        }
    };
    let set = match (flag, std::env::var_os(VARIABLE)) {
        (Some(set), _) => Some(set),
        (None, Some(name)) if !name.is_empty() => {
            Some(by_name(name.to_string_lossy().into_owned())?)
        }
        _ => None,
    };
    match set {
        Some(asked) if !asked.is_available() => {
            Err(Failure::usage(EnsembleError::Instructions { asked }))
        }
        set => Ok(set),
    }
}
