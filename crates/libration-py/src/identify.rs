//! Identification of a loop from a recording.

use libration::linear::LinearPlant;
use libration_identify::{
    Hold, KnownPlant, NoiseKind, Recording, Request, ResponseKind, Start, identify, loop_file, page,
};
use libration_study::Silent;
use libration_work::Work;
use numpy::PyReadonlyArray1;
use pyo3::prelude::*;
use serde_json::Value;

use crate::background::run_in_background;
use crate::error::{unknown, value_error};

/// Commands and responses, each with its times.
type Arrays<'py> = [PyReadonlyArray1<'py, f64>; 4];

/// Identifies a loop. Gives JSON, the file of the loop, and a page.
#[pyfunction]
pub(crate) fn _identify(
    py: Python<'_>,
    arrays: Arrays<'_>,
    options: &str,
) -> PyResult<(String, Option<String>, String)> {
    let wrong = |error: &dyn core::fmt::Display| value_error(error.to_string());
    let [command_times, commands, response_times, responses] = &arrays;
    let options: Value = serde_json::from_str(options).map_err(|error| wrong(&error))?;
    let (times, values) = (command_times.as_slice()?, commands.as_slice()?);
    let (response_times, responses) = (response_times.as_slice()?, responses.as_slice()?);
    let recording = match options["command_before"].as_f64() {
        Some(before) => Recording::behind(before, times, values, response_times, responses),
        None => Recording::new(times, values, response_times, responses),
    };
    let recording = recording.map_err(|error| wrong(&error))?;
    let request = request(&options)?;
    let found = run_in_background(
        py,
        |stop| identify(&recording, &request, &Work::new(&Silent, stop)),
        |_| Ok(()),
    )?;
    let found = found.map_err(|error| wrong(&error))?;
    let json = serde_json::to_string(&found).map_err(|error| wrong(&error))?;
    Ok((json, found.has_loop().then(|| loop_file(&found)), page(&found)))
}

fn request(options: &Value) -> PyResult<Request> {
    let number = |key: &str| options[key].as_f64();
    let whole = |key: &str| options[key].as_u64().unwrap_or(0);
    let responses = match options.get("plant").filter(|plant| !plant.is_null()) {
        Some(plant) => vec![ResponseKind::Plant(Box::new(known_plant(plant)?))],
        None => choice("model", options, &ResponseKind::SIMPLE, ResponseKind::name)?,
    };
    Ok(Request {
        responses,
        noises: choice("noise", options, &NoiseKind::ALL, |noise| noise.name())?,
        holds: choice("hold", options, &[Hold::Zero, Hold::Linear], |hold| hold.name())?,
        dead_time: number("dead_time"),
        lag: number("lag"),
        gain: number("gain"),
        largest_dead_time: number("largest_dead_time"),
        start: match options["start"].as_str().unwrap_or("auto") {
            "auto" => None,
            _ => choice("start", options, &Start::ALL, |start| start.name())?.first().copied(),
        },
        budget: options["budget"]
            .as_u64()
            .map(|budget| usize::try_from(budget).unwrap_or(usize::MAX)),
        arrivals: options["random_arrivals"].as_bool().unwrap_or(true),
        details: true,
        bootstrap: usize::try_from(whole("bootstrap")).unwrap_or(usize::MAX),
        seed: whole("seed"),
    })
}

/// The plant of a table as `[system.linear]` has it, with one input and one output.
fn known_plant(table: &Value) -> PyResult<KnownPlant> {
    let text = table.as_str().unwrap_or_default();
    let plant: LinearPlant = libration_settings::linear_loop::parse_plant(text, "plant.toml")
        .map_err(|error| value_error(error.to_string()))?
        .plant()
        .map_err(|fault| value_error(fault.to_string()))?;
    let channels = [plant.inputs.len(), plant.outputs.len()];
    let known = (channels == [1, 1]).then(|| KnownPlant::new(&plant, 0, 0)).flatten();
    known.ok_or_else(|| {
        value_error(format!(
            "plant has {} inputs and {} outputs{}; expected one of each, in continuous time",
            channels[0],
            channels[1],
            if plant.sampling_period.is_some() { " and is sampled" } else { "" }
        ))
    })
}

/// The kinds that an option names: one, or all with `auto`.
fn choice<T: Clone>(
    key: &str,
    options: &Value,
    all: &[T],
    name: impl Fn(&T) -> &'static str,
) -> PyResult<Vec<T>> {
    let text = options[key].as_str().unwrap_or("auto");
    if text == "auto" {
        return Ok(all.to_vec());
    }
    let found = all.iter().find(|kind| name(kind) == text);
    found.map(|kind| vec![kind.clone()]).ok_or_else(|| {
        let names: Vec<&str> = ["auto"].into_iter().chain(all.iter().map(&name)).collect();
        unknown(key, text, names)
    })
}
