//! The study `precision` of a system of equations: the rounding of float types beside the error of a step.

use half::{bf16, f16};
use libration::{Float, Method};
use libration_report::Record;
use libration_report::notation::{count, list, number};
use libration_report::page::{Highlight, Page};
use libration_report::record::{Cell, Finding, RecordError, Table};
use libration_study::{Lab, Study, StudyError};

use crate::subject::Problem;

/// Steps a turn.
const STEPS: u64 = 256;

/// The study `precision` of a system of equations.
#[derive(Clone, Copy, Debug)]
pub struct SystemPrecision<'a> {
    problem: &'a Problem,
}

impl<'a> SystemPrecision<'a> {
    /// Of a system from its start.
    pub fn new(problem: &'a Problem) -> Self {
        SystemPrecision { problem }
    }
}

/// The rounding of an integrator in a float type.
type Measure = fn(&Problem, Method, u64) -> Result<Option<f64>, StudyError>;

/// The float types with their roundings.
const FLOATS: [(&str, Measure); 4] =
    [float::<f64>(), float::<f32>(), float::<f16>(), float::<bf16>()];

const fn float<S: Float>() -> (&'static str, Measure) {
    (S::NAME, |problem, method, turns| problem.rounding_error::<S>(method, STEPS, turns))
}

impl Study for SystemPrecision<'_> {
    fn name(&self) -> &'static str {
        "precision"
    }

    fn question(&self) -> &'static str {
        "Which float types round less than the error of a step?"
    }

    fn run(&self, lab: &Lab<'_>) -> Result<Record, StudyError> {
        let mut record = Record::new(self.name(), self.question());
        let turns = lab.effort.choose(4, 16, 64);
        let methods = &lab.config.integrators;
        let problem = self.problem;
        let found = lab.sweep("rounding of float types", methods, |&method| {
            let mut roundings = Vec::new();
            for (_, measure) in FLOATS {
                roundings.push(measure(problem, method, turns)?);
            }
            Ok((problem.step_error(method, STEPS, turns)?, roundings))
        })?;
        let heads = FLOATS.map(|(name, _)| format!("rounding of {name}"));
        let heads = heads.iter().map(String::as_str);
        let columns: Vec<&str> =
            ["integrator", "error of the step"].into_iter().chain(heads).collect();
        let mut table = Table::new("rounding", &columns);
        for (&method, (step, roundings)) in methods.iter().zip(found) {
            let after = format!("after {} turns of {} steps", count(turns), count(STEPS));
            let id = |what: &str| format!("precision.{}.{what}", method.name());
            let mut find = |what: &str, text: String, size: Option<f64>| {
                if let Some(size) = size {
                    record.find(Finding::measured(id(what), text, "1", size));
                }
                size.map_or_else(|| Cell::absent("overflows"), Cell::from)
            };
            let title = method.title();
            let text = format!(
                "{title}: change by steps of half the length {after}, as a part of the largest value of a state"
            );
            let mut row = vec![title.into(), find("step", text, step)];
            for ((name, _), rounding) in FLOATS.iter().zip(roundings) {
                let text = format!(
                    "{title}: rounding of {name} {after}, as a part of the largest value of a state"
                );
                row.push(find(name, text, rounding));
            }
            table.push(row);
        }
        record.tables.push(table);
        Ok(record)
    }

    fn render(&self, record: &Record, page: &mut Page) -> Result<(), RecordError> {
        page.title = "Precision".into();
        let table = record.table("rounding")?;
        let suffices = |name: &str, method: Method| {
            let of = |what: &str| {
                record.finding(&format!("precision.{}.{what}", method.name())).map(|f| f.measured)
            };
            Some(of(name).ok()? < of("step").ok()?)
        };
        let answers: Vec<String> = Method::ALL
            .into_iter()
            .filter_map(|method| {
                // From the narrowest.
                let enough = FLOATS.iter().rev().map(|(name, _)| *name);
                let mut enough = enough.filter(|name| suffices(name, method) == Some(true));
                suffices("f64", method)?;
                Some(format!("{} {}", method.title(), enough.next().unwrap_or("none of them")))
            })
            .collect();
        if !answers.is_empty() {
            page.answer = format!(
                "Narrowest type that rounds less than the error of a step, at {} steps a turn: {}.",
                count(STEPS),
                answers.join(", ")
            );
        }
        if let Ok(f32) = record.finding("precision.rk4.f32") {
            page.highlights.push(Highlight {
                value: number(f32.measured, 2),
                text: "rounding of f32 with RK4, as a part of the largest value of a state".into(),
            });
        }
        page.paragraph(
            "Each integrator runs in a float type and in double-double, with equal steps from the same start; a type rounds the \
             parameters, the start and the time step, too. The error of a step is what halving it changes, without rounding. \
             No theory predicts the rounding of an arbitrary system, so these are measurements.",
        );
        page.table(table, 2);
        let of = |is_enough: bool| {
            let some = Method::ALL.into_iter().filter(|&m| suffices("f32", m) == Some(is_enough));
            some.map(|m| m.title()).collect::<Vec<_>>()
        };
        let (enough, coarse) = (of(true), of(false));
        if !enough.is_empty() {
            page.action(format!(
                "Run {} in f32: at {} steps a turn or fewer, rounding stays below the error of the step.",
                list(&enough),
                count(STEPS)
            ));
        }
        if !coarse.is_empty() {
            page.action(format!(
                "Run {} in f64: at {} steps a turn, rounding of f32 exceeds the error of the step.",
                list(&coarse),
                count(STEPS)
            ));
        }
        Ok(())
    }
}
