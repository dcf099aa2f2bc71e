//! Parts of the JSON schema of a configuration.

use std::ops::RangeInclusive;

use libration::Method;
use libration::catalog::Allowed;
use libration::ensemble::InstructionSet;
use libration_settings::limits;
use schemars::{Schema, SchemaGenerator, json_schema};
use serde_json::{Value, json};

use crate::Effort;

/// Returns the schema of an effort.
pub(crate) fn effort(_: &mut SchemaGenerator) -> Schema {
    json_schema!({ "type": "string", "enum": Effort::ALL.map(Effort::name) })
}

/// Returns the schema of integrators, at least one.
pub(crate) fn integrators(_: &mut SchemaGenerator) -> Schema {
    list(one_of(&Method::ALL.map(Method::name)))
}

/// Returns the schema of an instruction set.
pub(crate) fn simd(_: &mut SchemaGenerator) -> Schema {
    let sets = InstructionSet::ALL.map(Some).into_iter().chain([None]);
    let names: Vec<_> = sets.map(libration_settings::instruction_set_name).collect();
    json_schema!({ "type": "string", "enum": names })
}

/// Returns the schema of a mass or a stiffness.
pub(crate) fn spring(_: &mut SchemaGenerator) -> Schema {
    number(limits::SPRING)
}

/// Returns the schema of an initial coordinate.
pub(crate) fn coordinate(_: &mut SchemaGenerator) -> Schema {
    number(limits::COORDINATE)
}

/// Returns the schema of a time step.
pub fn time_step(_: &mut SchemaGenerator) -> Schema {
    number(limits::TIME_STEP)
}

/// Returns the schema of time steps, at least one, each once.
pub fn time_steps(generator: &mut SchemaGenerator) -> Schema {
    list(time_step(generator).into())
}

/// Returns the schema of tolerances, at least one, each once.
pub fn tolerances(_: &mut SchemaGenerator) -> Schema {
    list(number(limits::TOLERANCE).into())
}

/// Returns the schema of a number of steps.
pub fn steps(_: &mut SchemaGenerator) -> Schema {
    count(limits::STEPS)
}

/// Returns the schema of numbers of steps, at least one, each once.
pub fn horizons(generator: &mut SchemaGenerator) -> Schema {
    list(steps(generator).into())
}

/// Returns the schema of a whole number in a range.
pub fn count(allowed: RangeInclusive<u64>) -> Schema {
    let (low, high) = (allowed.start(), allowed.end());
    json_schema!({ "type": "integer", "minimum": low, "maximum": high })
}

/// Returns the schema of one of `names`.
pub fn one_of(names: &[&str]) -> Value {
    json!({ "type": "string", "enum": names })
}

/// Returns the schema of a list of items, at least one, each once.
pub fn list(items: Value) -> Schema {
    json_schema!({ "type": "array", "uniqueItems": true, "minItems": 1, "items": items })
}

fn number(allowed: Allowed) -> Schema {
    match allowed {
        Allowed::Positive => json_schema!({ "type": "number", "exclusiveMinimum": 0 }),
        Allowed::NonNegative => json_schema!({ "type": "number", "minimum": 0 }),
        Allowed::Finite => json_schema!({ "type": "number" }),
    }
}
