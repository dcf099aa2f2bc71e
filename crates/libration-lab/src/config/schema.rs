//! The configuration as a JSON schema, for editors.

use std::ops::RangeInclusive;

use libration::Method;
use libration::catalog::Allowed;
use libration::ensemble::InstructionSet;
use schemars::generate::SchemaSettings;
use schemars::{Schema, SchemaGenerator, json_schema};
use serde_json::{Value, json};

use super::file::File;
use super::{limits, names};
use crate::bench::Implementation;
use crate::{Effort, studies};

/// The JSON schema of a configuration file.
pub fn schema() -> Value {
    let settings = SchemaSettings::draft2020_12().with(|s| s.inline_subschemas = true);
    settings.into_generator().into_root_schema_for::<File>().to_value()
}

pub(super) fn studies(_: &mut SchemaGenerator) -> Schema {
    let names: Vec<_> = studies::ALL.iter().map(|study| study.name()).collect();
    json_schema!({ "type": "array", "uniqueItems": true, "items": one_of(&names) })
}

pub(super) fn effort(_: &mut SchemaGenerator) -> Schema {
    json_schema!({ "type": "string", "enum": Effort::ALL.map(Effort::name) })
}

pub(super) fn integrators(_: &mut SchemaGenerator) -> Schema {
    let items = one_of(&Method::ALL.map(Method::name));
    json_schema!({ "type": "array", "uniqueItems": true, "minItems": 1, "items": items })
}

pub(super) fn spring(_: &mut SchemaGenerator) -> Schema {
    number(limits::SPRING)
}

pub(super) fn coordinate(_: &mut SchemaGenerator) -> Schema {
    number(limits::COORDINATE)
}

pub(super) fn time_step(_: &mut SchemaGenerator) -> Schema {
    number(limits::TIME_STEP)
}

pub(super) fn time_steps(generator: &mut SchemaGenerator) -> Schema {
    let items = time_step(generator);
    json_schema!({ "type": "array", "uniqueItems": true, "minItems": 1, "items": items })
}

pub(super) fn tolerances(_: &mut SchemaGenerator) -> Schema {
    let items = number(limits::TOLERANCE);
    json_schema!({ "type": "array", "uniqueItems": true, "minItems": 1, "items": items })
}

pub(super) fn horizons(generator: &mut SchemaGenerator) -> Schema {
    let items = steps(generator);
    json_schema!({ "type": "array", "uniqueItems": true, "minItems": 1, "items": items })
}

pub(super) fn steps(_: &mut SchemaGenerator) -> Schema {
    count(limits::STEPS)
}

pub(super) fn systems(_: &mut SchemaGenerator) -> Schema {
    let items = one_of(&studies::SYSTEMS);
    json_schema!({ "type": "array", "uniqueItems": true, "minItems": 1, "items": items })
}

pub(super) fn implementations(_: &mut SchemaGenerator) -> Schema {
    let items = one_of(&Implementation::ALL.map(Implementation::name));
    json_schema!({ "type": "array", "uniqueItems": true, "minItems": 1, "items": items })
}

pub(super) fn simd(_: &mut SchemaGenerator) -> Schema {
    let sets = InstructionSet::ALL.map(Some).into_iter().chain([None]);
    let names: Vec<_> = sets.map(names::instruction_set).collect();
    json_schema!({ "type": "string", "enum": names })
}

pub(super) fn coarsest(_: &mut SchemaGenerator) -> Schema {
    let (low, high) = (limits::COARSEST.start(), limits::COARSEST.end());
    let unit = limits::COARSEST_UNIT;
    json_schema!({ "type": "integer", "minimum": low, "maximum": high, "multipleOf": unit })
}

pub(super) fn steps_a_turn(_: &mut SchemaGenerator) -> Schema {
    count(limits::STEPS_A_TURN)
}

pub(super) fn turns(_: &mut SchemaGenerator) -> Schema {
    count(limits::TURNS)
}

fn count(allowed: RangeInclusive<u64>) -> Schema {
    let (low, high) = (allowed.start(), allowed.end());
    json_schema!({ "type": "integer", "minimum": low, "maximum": high })
}

fn number(allowed: Allowed) -> Schema {
    match allowed {
        Allowed::Positive => json_schema!({ "type": "number", "exclusiveMinimum": 0 }),
        Allowed::NonNegative => json_schema!({ "type": "number", "minimum": 0 }),
        Allowed::Finite => json_schema!({ "type": "number" }),
    }
}

fn one_of(names: &[&str]) -> Value {
    json!({ "type": "string", "enum": names })
}
