//! Parts of the JSON schema of a configuration.

use std::ops::RangeInclusive;

use libration::Method;
use libration::catalog::Allowed;
use libration::ensemble::InstructionSet;
use libration_settings::{limits, names};
use schemars::{Schema, SchemaGenerator, json_schema};
use serde_json::{Value, json};

use crate::Effort;

/// An effort.
pub(crate) fn effort(_: &mut SchemaGenerator) -> Schema {
    json_schema!({ "type": "string", "enum": Effort::ALL.map(Effort::name) })
}

/// Integrators, at least one.
pub(crate) fn integrators(_: &mut SchemaGenerator) -> Schema {
    list(one_of(&Method::ALL.map(Method::name)))
}

/// An instruction set.
pub(crate) fn simd(_: &mut SchemaGenerator) -> Schema {
    let sets = InstructionSet::ALL.map(Some).into_iter().chain([None]);
    let names: Vec<_> = sets.map(names::instruction_set).collect();
    json_schema!({ "type": "string", "enum": names })
}

/// A mass or a stiffness.
pub(crate) fn spring(_: &mut SchemaGenerator) -> Schema {
    number(limits::SPRING)
}

/// A coordinate of a start.
pub(crate) fn coordinate(_: &mut SchemaGenerator) -> Schema {
    number(limits::COORDINATE)
}

/// A time step.
pub fn time_step(_: &mut SchemaGenerator) -> Schema {
    number(limits::TIME_STEP)
}

/// Time steps, at least one, each once.
pub fn time_steps(generator: &mut SchemaGenerator) -> Schema {
    list(time_step(generator).into())
}

/// Tolerances, at least one, each once.
pub fn tolerances(_: &mut SchemaGenerator) -> Schema {
    list(number(limits::TOLERANCE).into())
}

/// A number of steps.
pub fn steps(_: &mut SchemaGenerator) -> Schema {
    count(limits::STEPS)
}

/// Numbers of steps, at least one, each once.
pub fn horizons(generator: &mut SchemaGenerator) -> Schema {
    list(steps(generator).into())
}

/// A whole number in a range.
pub fn count(allowed: RangeInclusive<u64>) -> Schema {
    let (low, high) = (allowed.start(), allowed.end());
    json_schema!({ "type": "integer", "minimum": low, "maximum": high })
}

/// One of some names.
pub fn one_of(names: &[&str]) -> Value {
    json!({ "type": "string", "enum": names })
}

/// A list of such items, at least one, each once.
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
