//! Parts of the JSON schema of a configuration.

use std::ops::RangeInclusive;

use libration::Method;
use libration::catalog::Allowed;
use libration::ensemble::InstructionSet;
use libration_settings::limits;
use schemars::{Schema, SchemaGenerator, json_schema};
use serde_json::{Map, Value, json};

use crate::{Config, Effort, Spring, Start};

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

/// Returns the schema of the tables of a system.
pub(crate) fn system(_: &mut SchemaGenerator) -> Schema {
    let Spring { m, k } = Config::default().oscillator;
    let oscillator = table([
        ("m", "Mass in kg.", json!(m), number(limits::SPRING)),
        ("k", "Stiffness in N/m.", json!(k), number(limits::SPRING)),
        ("omega2", "k/m in s⁻², in place of both.", json!(k / m), number(limits::SPRING)),
    ]);
    let default = json!({ "m": m, "k": k });
    table([("oscillator", "A mass on a spring, m q'' = -k q.", default, oscillator)])
}

/// Returns the schema of a start.
pub(crate) fn start(_: &mut SchemaGenerator) -> Schema {
    let Start { q, v } = Config::default().start;
    table([
        ("q", "Position in m, or a list of one number.", json!(q), coordinate()),
        ("v", "Velocity in m/s, or a list of one number.", json!(v), coordinate()),
    ])
}

fn coordinate() -> Schema {
    let one = number(limits::COORDINATE);
    let list = json!({ "type": "array", "minItems": 1, "maxItems": 1, "items": one });
    json_schema!({ "anyOf": [one, list] })
}

/// Returns the schema of a table by its keys: name, description, default and schema of each.
fn table<const N: usize>(keys: [(&str, &str, Value, Schema); N]) -> Schema {
    let mut properties = Map::new();
    for (name, description, default, mut schema) in keys {
        schema.insert("description".to_owned(), json!(description));
        schema.insert("default".to_owned(), default);
        properties.insert(name.to_owned(), schema.to_value());
    }
    json_schema!({ "type": "object", "properties": properties, "additionalProperties": false })
}

/// Returns the schema of a key that this program reads for another command only.
pub(crate) fn ignored(reader: &str) -> Value {
    json!({ "description": format!("A key of `libration {reader}`, which `libration lab` ignores.") })
}

/// Returns the schema of a time step in s, or with a unit.
pub fn time_step(_: &mut SchemaGenerator) -> Schema {
    let unit = r"^\s*[0-9.eE+-]+\s*(ns|us|µs|μs|ms|s|min|h|d|Hz|kHz|MHz)?\s*$";
    let text = json!({ "type": "string", "pattern": unit });
    json_schema!({ "anyOf": [number(limits::TIME_STEP), text] })
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
