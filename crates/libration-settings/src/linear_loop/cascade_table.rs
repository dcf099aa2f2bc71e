//! Tables of cascades of two controllers.

use libration::linear::{Cascade, DiscreteController, LinearPlant, Signal};
use serde::Deserialize;

use super::design::{Cascaded, Design, by_outputs};
use super::part_table::find;
use super::pid_table::{Gains, PidChannel, side_by_side, zero};
use super::plant_table::{Rows, matrix};
use super::state_space_table::StateSpaceTable;
use crate::{Count, Fault, Number};

/// The table `[controller.cascade]`: an inner controller whose references an outer one computes less often.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct CascadeTable {
    /// The outer controller runs in every so-manieth period.
    every: Count,
    /// The inner controller runs in every so-manieth period (default: 1).
    #[serde(default = "one")]
    inner_every: Count,
    /// The periods from a run of the outer controller until its references act (default: 0).
    #[serde(default = "none")]
    outer_latency: Count,
    /// Names of the references, with units in parentheses (default: those of the outer PID controllers, or numbered).
    references: Option<Vec<String>>,
    /// From outputs and references to inputs.
    inner: CascadeControllerTable,
    /// From outputs to references.
    outer: CascadeControllerTable,
}

/// A controller of a cascade.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(rename_all = "kebab-case")]
pub enum CascadeControllerTable {
    /// Commands × measurements.
    Gain(Rows),
    /// `m' = A m + B y` and `u = C m + D y`.
    StateSpace(StateSpaceTable),
    /// PID controllers.
    Pid(Vec<CascadePidTable>),
}

/// A PID controller of a cascade. The inner one holds an output at a reference, the outer one holds it at zero by a reference.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct CascadePidTable {
    output: String,
    input: Option<String>,
    reference: Option<String>,
    proportional: Number,
    #[serde(default = "zero")]
    integral: Number,
    #[serde(default = "zero")]
    derivative: Number,
    #[serde(default = "zero", deserialize_with = "crate::duration::number")]
    filter: Number,
}

const INNER: &str = "controller.cascade.inner";
const OUTER: &str = "controller.cascade.outer";

fn one() -> Count {
    Count(1)
}

fn none() -> Count {
    Count(0)
}

impl CascadeTable {
    /// The schedule of both controllers around `plant`, in periods of `period` seconds.
    ///
    /// # Errors
    /// [`Fault`]: matrices that do not fit, unknown signals, or impossible rates.
    pub(super) fn design(&self, plant: &LinearPlant, period: f64) -> Result<Design, Fault> {
        let whole = |key: &'static str, Count(count): Count, least: i128| {
            let name = key.rsplit('.').next().unwrap_or(key);
            match usize::try_from(count) {
                Ok(count_of) if count >= least && count_of <= Cascade::MOST_PERIODS => Ok(count_of),
                _ => Err(Fault::new(
                    key,
                    format!(
                        "`{name}` is {count}; expected {least} to {} periods",
                        Cascade::MOST_PERIODS
                    ),
                )),
            }
        };
        let outer_every = whole("controller.cascade.every", self.every, 1)?;
        let inner_every = whole("controller.cascade.inner-every", self.inner_every, 1)?;
        let outer_latency = whole("controller.cascade.outer-latency", self.outer_latency, 0)?;
        let references = self.references()?;
        let measured: Vec<Signal> = plant.outputs.iter().chain(&references).cloned().collect();
        let outer = self.outer.controller(&Side {
            key: OUTER,
            measured: &plant.outputs,
            commands: &references,
            references: &[],
            words: ["references", "outputs"],
            period: period * outer_every as f64,
        })?;
        let inner = self.inner.controller(&Side {
            key: INNER,
            measured: &measured,
            commands: &plant.inputs,
            references: &references,
            words: ["inputs", "outputs and references"],
            period: period * inner_every as f64,
        })?;
        let often = |every: usize| match every {
            1 => "every period".to_owned(),
            every => format!("every {every} periods"),
        };
        let later = match outer_latency {
            0 => String::new(),
            1 => ", whose references act one period later".to_owned(),
            count => format!(", whose references act {count} periods later"),
        };
        let description = format!(
            "cascade: {} {} by {}{later}; {} {} by {}",
            often(outer_every),
            names(&references),
            outer.1,
            often(inner_every),
            names(&plant.inputs),
            inner.1,
        );
        let cascade =
            Cascade { inner: inner.0, outer: outer.0, inner_every, outer_every, outer_latency };
        let wrong = |error: libration::linear::CascadeError| {
            Fault::new("controller.cascade", error.to_string())
        };
        let schedule = cascade.schedule().map_err(wrong)?;
        let cascade = Some(Cascaded { references, inner_every, outer_every, outer_latency });
        Ok(Design { cascade, ..by_outputs(plant, schedule, description) })
    }

    /// The references: by their names, those of the outer PID controllers, or numbered.
    fn references(&self) -> Result<Vec<Signal>, Fault> {
        let wrong = |message: String| Fault::new("controller.cascade.references", message);
        let count = match &self.outer {
            CascadeControllerTable::Gain(rows) => Some(rows.len()),
            CascadeControllerTable::StateSpace(table) => Some(table.commands()),
            CascadeControllerTable::Pid(_) => None,
        };
        let signals: Vec<Signal> = match (&self.references, &self.outer) {
            (Some(names), _) => names.iter().map(|name| Signal::parse(name)).collect(),
            (None, CascadeControllerTable::Pid(tables)) => {
                let mut names: Vec<&String> = Vec::new();
                for name in tables.iter().filter_map(|table| table.reference.as_ref()) {
                    if !names.contains(&name) {
                        names.push(name);
                    }
                }
                names.into_iter().map(|name| Signal::new(name, "")).collect()
            }
            (None, _) => Signal::numbered("r", count.unwrap_or(0)),
        };
        let given = signals.len();
        if let Some(count) = count.filter(|count| *count != given) {
            return Err(wrong(format!(
                "{given} names of references; expected {count}, one for each command of the outer controller"
            )));
        }
        if signals.is_empty() {
            return Err(wrong(
                "the outer controller has no references; expected at least one".into(),
            ));
        }
        let repeated = |i: &usize| signals[..*i].iter().any(|s| s.name == signals[*i].name);
        if let Some(i) = (0..given).find(repeated) {
            let name = &signals[i].name;
            return Err(wrong(format!(
                "two references have the name `{name}`; expected different names"
            )));
        }
        Ok(signals)
    }
}

/// The signals of a controller of a cascade.
struct Side<'a> {
    key: &'static str,
    /// What it measures: outputs, and of the inner one then references.
    measured: &'a [Signal],
    /// What it commands.
    commands: &'a [Signal],
    /// What it follows; the outer one nothing.
    references: &'a [Signal],
    /// Commands and measurements in words.
    words: [&'static str; 2],
    /// The seconds between two runs.
    period: f64,
}

impl CascadeControllerTable {
    /// The controller, and in words.
    fn controller(&self, side: &Side<'_>) -> Result<(DiscreteController, String), Fault> {
        let shape = [side.commands.len(), side.measured.len()];
        match self {
            CascadeControllerTable::Gain(rows) => {
                let gain = matrix(side.key, rows)?;
                if [gain.rows(), gain.columns()] != shape {
                    let (rows, columns) = (gain.rows(), gain.columns());
                    let ([m, p], [to, from]) = (shape, side.words);
                    let message =
                        format!("`gain` is {rows} × {columns}; expected {m} × {p}: {to} × {from}");
                    return Err(Fault::new(side.key, message));
                }
                Ok((DiscreteController::gain(gain), "a gain".into()))
            }
            CascadeControllerTable::StateSpace(table) => {
                let own = table.controller(|_| side.key, shape, side.words)?;
                let words = format!("a controller of {} states", own.memory());
                Ok((own, words))
            }
            CascadeControllerTable::Pid(tables) => pid(tables, side),
        }
    }
}

fn pid(tables: &[CascadePidTable], side: &Side<'_>) -> Result<(DiscreteController, String), Fault> {
    let wrong = |message: String| Fault::new(side.key, message);
    if tables.is_empty() {
        return Err(wrong("there is no PID controller; expected at least one".into()));
    }
    let key = |fault: Fault| Fault { key: side.key.into(), ..fault };
    let outputs = side.measured.len() - side.references.len();
    let is_inner = side.key == INNER;
    let mut channels = Vec::new();
    let mut words = Vec::new();
    for table in tables {
        let output = find("outputs", &table.output, &side.measured[..outputs]).map_err(key)?;
        let mut measured = vec![(output, 1.0)];
        let mut from = format!("`{}`", table.output);
        let command = match (is_inner, &table.input, &table.reference) {
            (true, Some(input), reference) => {
                if let Some(name) = reference {
                    let followed = find("references", name, side.references).map_err(key)?;
                    measured.push((outputs + followed, -1.0));
                    from += &format!(" less the reference `{name}`");
                }
                find("inputs", input, side.commands).map_err(key)?
            }
            (false, None, Some(reference)) => {
                find("references", reference, side.commands).map_err(key)?
            }
            (true, None, _) => {
                return Err(wrong("a PID controller of the inner loop requires `input`".into()));
            }
            (false, Some(_), _) => {
                return Err(wrong(
                    "a PID controller of the outer loop has an `input`; expected only a `reference`, which it commands".into(),
                ));
            }
            (false, None, None) => {
                return Err(wrong(
                    "a PID controller of the outer loop requires `reference`".into(),
                ));
            }
        };
        let gains = Gains([table.proportional, table.integral, table.derivative, table.filter]);
        words.push(format!("PID from {from} {}", gains.describe()));
        channels.push(PidChannel { measured, command, gains });
    }
    let shape = [side.measured.len(), side.commands.len()];
    let controller = side_by_side(&channels, shape, side.period).map_err(wrong)?;
    Ok((controller, words.join("; ")))
}

/// Names in words.
fn names(signals: &[Signal]) -> String {
    let names: Vec<String> = signals.iter().map(|signal| format!("`{}`", signal.name)).collect();
    names.join(", ")
}
