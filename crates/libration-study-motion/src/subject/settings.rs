//! Settings that studies of several systems share.

use std::ops::RangeInclusive;

use libration_settings::{Fault, suggestions};
use libration_study::schema::{list, one_of};
use schemars::{Schema, SchemaGenerator, json_schema};

use super::{Halvings, SYSTEMS};

/// Steps per turn at the largest step of a sequence of halvings.
pub(crate) const COARSEST: RangeInclusive<u64> = COARSEST_UNIT..=4096;

/// The divisor of such a number: the number of comparisons per turn.
const COARSEST_UNIT: u64 = Halvings::SAMPLES;

/// The number `value` of steps per turn at the largest step.
pub(crate) fn coarsest(key: &'static str, value: i128) -> Result<u64, Fault> {
    let multiple = COARSEST_UNIT;
    match u64::try_from(value) {
        Ok(steps) if COARSEST.contains(&steps) && steps.is_multiple_of(multiple) => Ok(steps),
        _ => {
            let (low, high) = (COARSEST.start(), COARSEST.end());
            let allowed = format!("a multiple of {multiple} from {low} to {high}");
            Err(Fault::new(key, format!("`{key}` is {value}, but it must be {allowed}")))
        }
    }
}

/// Checks names of systems: known, at least one, each once.
pub(crate) fn check_systems(key: &'static str, systems: &[String]) -> Result<(), Fault> {
    if systems.is_empty() {
        return Err(Fault::new(key, format!("`{key}` must name at least one system")));
    }
    for (i, name) in systems.iter().enumerate() {
        if !SYSTEMS.contains(&name.as_str()) {
            let fault = Fault::at(key, i, format!("unknown system `{name}`"));
            return Err(fault.help(suggestions::suggest("systems", name, SYSTEMS)));
        }
        if systems[..i].contains(name) {
            return Err(Fault::at(key, i, format!("the system `{name}` is named twice")));
        }
    }
    Ok(())
}

/// The schema of a list of systems.
pub(crate) fn systems_schema(_: &mut SchemaGenerator) -> Schema {
    list(one_of(&SYSTEMS))
}

/// The schema of a number of steps per turn at the largest step.
pub(crate) fn coarsest_schema(_: &mut SchemaGenerator) -> Schema {
    let (low, high) = (COARSEST.start(), COARSEST.end());
    let unit = COARSEST_UNIT;
    json_schema!({ "type": "integer", "minimum": low, "maximum": high, "multipleOf": unit })
}
