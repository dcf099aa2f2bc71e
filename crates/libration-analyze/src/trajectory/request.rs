//! What trajectory is asked for.

use libration::catalog::{Actuation, Allowed};
use libration::ensemble::MOST_THREADS;
use libration::{AnySystem, Float, with_system};
use libration_settings::{limits, units};

use super::run::exact;
use super::{Copies, FloatType, TrajectoryError, loops};
use crate::analyze::{Stepping, Timing};

/// Largest number of values in a table: 8 GB of them, 2·10⁸ rows in one dimension.
const MOST_VALUES: u64 = 1_000_000_000;

/// A system, how to step it, from where, and which steps to keep.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// The system.
    pub system: AnySystem,
    /// The quantity of its commands.
    pub actuation: Actuation,
    /// How steps are taken.
    pub stepping: Stepping,
    /// The float type in which everything but the time is computed.
    pub float: FloatType,
    /// The time step in seconds.
    pub dt: f64,
    /// Number of steps.
    pub steps: u64,
    /// Initial positions.
    pub q: Vec<f64>,
    /// Initial velocities.
    pub v: Vec<f64>,
    /// Keep the start, each step that is a multiple of this, and the last step.
    pub every: u64,
    /// Several trajectories in place of one.
    pub copies: Option<Copies>,
    /// The loop that is closed, and clocks and commands that are not ideal.
    pub timing: Timing,
    /// The steps of a recorded clock, in multiples of `dt`, in place of steps that are all alike.
    pub record: Option<Vec<f64>>,
    /// Of all that is random.
    pub seed: u64,
}

impl Request {
    /// The parameters of the system, as they are given.
    pub(super) fn parameters(&self) -> Vec<(&'static str, f64)> {
        self.actuation.parameters(self.system)
    }

    /// The first thing that is asked for which makes it a loop.
    pub(super) fn looped(&self) -> Option<&'static str> {
        self.timing.first().or(self.record.as_ref().map(|_| "time-stamps"))
    }

    /// How many times as long as the time step the longest step may be.
    pub(super) fn longest(&self) -> f64 {
        let recorded = self.record.as_ref().map(|r| r.iter().copied().fold(0.0, f64::max));
        recorded.unwrap_or(1.0) * self.timing.longest()
    }

    /// Names of the columns, from left to right.
    pub fn column_names(&self) -> Vec<String> {
        let coordinates = |x, d| (0..d).map(move |i| format!("{x}{i}"));
        let mut names = self.copies.map_or_else(Vec::new, |_| vec!["trajectory".to_owned()]);
        names.extend(["step".to_owned(), "t".to_owned()]);
        names.extend(coordinates('q', self.q.len()));
        names.extend(coordinates('v', self.v.len()));
        names.push("energy".to_owned());
        names
    }

    /// Units of the columns, from left to right.
    pub fn column_units(&self) -> Vec<&'static str> {
        let trajectory = self.copies.map(|_| "1").into_iter();
        trajectory.chain(units::of_columns(self.system, self.q.len())).collect()
    }

    /// Number of steps that are kept if the state stays finite.
    fn kept(&self) -> u64 {
        let every = self.every.max(1);
        (self.steps / every).saturating_add(1 + u64::from(!self.steps.is_multiple_of(every)))
    }

    /// Number of rows if the state stays finite.
    pub fn rows(&self) -> u64 {
        self.kept().saturating_mul(self.copies.map_or(1, |copies| copies.count as u64))
    }

    /// Checks every value, and that the float type `S` can hold it.
    pub(super) fn check<S: Float>(&self) -> Result<(), TrajectoryError> {
        self.check_start::<S>()?;
        self.check_time_step::<S>()?;
        self.check_stepping()?;
        self.check_parameters::<S>()?;
        for (name, count) in [("steps", self.steps), ("every", self.every)] {
            if count == 0 {
                return Err(wrong(name, count, "at least 1"));
            }
        }
        if !limits::TRAJECTORY_STEPS.contains(&self.steps) {
            return Err(wrong("steps", self.steps, limits::trajectory_steps_allowed()));
        }
        if let Some(copies) = &self.copies {
            self.check_copies::<S>(copies)?;
        }
        if let Some(flag) = self.looped() {
            self.check_timing(flag)?;
        }
        if let Some(record) = self.record.as_ref().filter(|r| (r.len() as u64) < self.steps) {
            let allowed = format!("at most {}, the steps between the time stamps", record.len());
            return Err(wrong("steps", self.steps, allowed));
        }
        self.check_rows()
    }

    fn check_start<S: Float>(&self) -> Result<(), TrajectoryError> {
        let dimension = self.q.len();
        let entry = self.system.entry();
        if !entry.dimensions.contains(&dimension) {
            return Err(entry.wrong_dimension(dimension).into());
        }
        if self.v.len() != dimension {
            let allowed = format!("as many numbers as `q` has, {dimension}");
            return Err(wrong("v", list(&self.v), allowed));
        }
        for (name, values) in [("q", &self.q), ("v", &self.v)] {
            if !values.iter().all(|&x| S::from_f64(x).is_finite()) {
                let allowed = format!("finite in {}", S::NAME);
                return Err(wrong(name, list(values), allowed));
            }
        }
        Ok(())
    }

    fn check_copies<S: Float>(&self, copies: &Copies) -> Result<(), TrajectoryError> {
        if copies.count == 0 {
            return Err(wrong("count", 0, "at least 1"));
        }
        if !copies.spread.is_finite() {
            return Err(wrong("spread", format!("{:?}", copies.spread), Allowed::Finite));
        }
        if copies.threads > MOST_THREADS {
            let allowed = format!("at most {MOST_THREADS}");
            return Err(wrong("threads", copies.threads, allowed));
        }
        let furthest = 1.0 + copies.spread.abs();
        let all = self.q.iter().chain(&self.v);
        if !all.into_iter().all(|&x| S::from_f64(furthest * x).is_finite()) {
            let allowed = format!("so small that every start is finite in {}", S::NAME);
            return Err(wrong("spread", format!("{:?}", copies.spread), allowed));
        }
        copies.instruction_set().map(|_| ())
    }

    fn check_timing(&self, flag: &'static str) -> Result<(), TrajectoryError> {
        let (system, dimension) = (self.system.name(), self.q.len());
        if dimension > loops::MOST_DIMENSIONS {
            let value = format!("given for {system} in {dimension} dimensions");
            return Err(wrong(flag, value, format!("for at most {}", loops::MOST_DIMENSIONS)));
        }
        // A command would push it.
        if self.timing.feedback.is_some() && matches!(self.system, AnySystem::DrivenOscillator(_)) {
            let value = format!("given for {system}");
            return Err(wrong(
                "feedback",
                value,
                "for a system of which no coordinate is the time",
            ));
        }
        let latency = self.timing.latency_of(self.dt);
        latency.map(|_| ()).map_err(|steps| loops::late(self, steps))
    }

    fn check_time_step<S: Float>(&self) -> Result<(), TrajectoryError> {
        let dt = format!("{:?}", self.dt);
        if !Allowed::Positive.admits(self.dt) {
            return Err(wrong("dt", dt, Allowed::Positive));
        }
        let rounded = S::from_f64(self.dt).to_f64();
        if !Allowed::Positive.admits(rounded) {
            let allowed = format!("{} in {}, where it is {rounded}", Allowed::Positive, S::NAME);
            return Err(wrong("dt", dt, allowed));
        }
        Ok(())
    }

    fn check_stepping(&self) -> Result<(), TrajectoryError> {
        if self.stepping != Stepping::Exact {
            return Ok(());
        }
        if !self.system.is_linear() {
            let value = format!("{} for {}", self.stepping.name(), self.system.name());
            let allowed = "another integrator: exact steps are known of linear systems only";
            return Err(wrong("integrator", value, allowed));
        }
        with_system!(
            self.system,
            self.q.len(),
            |model, D| exact::<D>(&model, self).map(|_| ()),
            Ok(())
        )
    }

    fn check_parameters<S: Float>(&self) -> Result<(), TrajectoryError> {
        for (name, value) in self.system.parameters() {
            let rounded = S::from_f64(value).to_f64();
            if !rounded.is_finite() || (rounded == 0.0) != (value == 0.0) {
                let system = self.system.name();
                let float = S::NAME;
                return Err(TrajectoryError::Parameter { system, name, value, rounded, float });
            }
        }
        Ok(())
    }

    fn check_rows(&self) -> Result<(), TrajectoryError> {
        let columns = self.column_names().len() as u64;
        let most = MOST_VALUES / columns;
        let rows = self.rows();
        if rows <= most {
            return Ok(());
        }
        let count = self.copies.map_or(1, |copies| copies.count as u64);
        if count.saturating_mul(2) > most {
            let allowed = format!("at most {}: a table holds {most} rows", most / 2);
            return Err(wrong("count", count, allowed));
        }
        // Besides each `every`-th step there are the start and perhaps the last step.
        let least = self.steps.div_ceil((most / count).saturating_sub(2).max(1));
        let allowed = format!(
            "at least {least}: {} steps make {rows} rows, and a table holds at most {most}",
            self.steps
        );
        Err(wrong("every", self.every, allowed))
    }
}

fn wrong(name: &'static str, value: impl ToString, allowed: impl ToString) -> TrajectoryError {
    TrajectoryError::Value { name, value: value.to_string(), allowed: allowed.to_string() }
}

fn list(values: &[f64]) -> String {
    values.iter().map(f64::to_string).collect::<Vec<_>>().join(",")
}
