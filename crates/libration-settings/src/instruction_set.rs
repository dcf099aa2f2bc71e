//! Names of instruction sets in settings.

use libration::ensemble::InstructionSet;

/// The name of an instruction set in settings; `widest` stands for the widest that the processor has.
pub fn instruction_set_name(set: Option<InstructionSet>) -> &'static str {
    set.map_or("widest", InstructionSet::name)
}
