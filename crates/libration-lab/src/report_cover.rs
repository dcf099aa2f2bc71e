//! The head and the end of the report of a run.

use libration_report::notation::{number, plural, seconds};
use libration_report::page::Chapter;
use libration_report::report::Cover;
use libration_study::Config;

use crate::results::{Results, StudiedSystem};
use crate::{claims_table, live_page, system_page};

/// The studies whose answers, figure and actions open the report, where they are in the run: which steps are stable, and which
/// integrator costs least.
const FIRST_ANSWERS: &[&str] = &["stability", "spectrum", "efficiency"];

/// Those of a report on a system of equations: which steps are stable, and which keep the energy or have the least error.
const FIRST_ANSWERS_OF_SYSTEM: &[&str] = &["stability", "nonlinear", "convergence"];

/// The findings whose numbers open the report, where they are in the run.
const KEY_FINDINGS: &[&str] = &[
    "stability.velocity-verlet.window-1-to",
    "drift.velocity-verlet.dt-0.01.largest",
    "convergence.oscillator.rk4.global-order-position",
    "hierarchy.equal-7.latency.energy",
];

/// Whether the oscillator is that of the source report, which claims nothing of others.
fn is_of_the_source(config: &Config) -> bool {
    let source = Config::default();
    config.oscillator == source.oscillator && config.start == source.start
}

/// Whether the names are those of all studies that apply to the system.
fn is_all(names: &[String], system: Option<&StudiedSystem>) -> bool {
    system.is_some_and(|system| system.study_count == names.len())
}

/// Returns the head and the end of the report.
pub(crate) fn cover(results: &Results, chapters: &[Chapter]) -> Cover {
    let Results { config, machine, .. } = results;
    let (spring, start) = (config.oscillator, config.start);
    let command = results.command.clone();
    let subject = match &results.system {
        Some(system) => system_page::subject(&system.summary),
        None => {
            let [m, k, q, v] = [spring.m, spring.k, start.q, start.v].map(|x| number(x, 6));
            format!("Oscillator, m = {m} kg, k = {k} N/m, from ({q}, {v})")
        }
    };
    let setting = format!(
        "{subject} · {} · {} · {} · `{command}{studies}`",
        plural(config.integrators.len(), "integrator"),
        machine.cpu,
        seconds(results.seconds, 2),
        // Of a system the names are those of all that apply, unless somebody chose some.
        studies = match config.studies.as_slice() {
            [] => String::new(),
            names if is_all(names, results.system.as_ref()) => String::new(),
            names => format!(" {}", names.join(" ")),
        },
    );
    let host = format!(
        "{}, {}, {} · Libration {} · {} · all numbers in `results.json`, all series in \
         `data/`, all figures in `figures/`",
        machine.cpu,
        plural(machine.cores, "core"),
        machine.platform,
        machine.version,
        seconds(results.seconds, 2),
    );
    let system = results.system.as_ref();
    Cover {
        headline: system.map(|system| system.summary.name.clone()).unwrap_or_default(),
        command,
        setting,
        machine: host,
        complete: results.complete,
        first_answers: match system {
            Some(_) => FIRST_ANSWERS_OF_SYSTEM,
            None => FIRST_ANSWERS,
        },
        key_findings: KEY_FINDINGS,
        live: live_page::settings(config, system),
        claims: match is_of_the_source(config) && system.is_none() {
            true => claims_table::render(results, chapters),
            false => String::new(),
        },
        system: system.map_or_else(String::new, system_page::states),
        scope: system_page::not_applicable(&results.not_applicable),
    }
}
