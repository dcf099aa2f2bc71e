//! The study `stability` of a system of equations: its modes, and the time steps at which an integrator keeps them stable.

use std::sync::atomic::AtomicBool;

use libration::Method;
use libration::equations::StepProgram;
use libration_analyze::linear_analysis::{self, LinearRequest, StepAnalysis};
use libration_analyze::spectral_radius;
use libration_report::Record;
use libration_report::notation::seconds;
use libration_report::page::Page;
use libration_report::record::{Cell, Finding, RecordError, Series, Table, Tolerance};
use libration_settings::equations::EquationSystem;
use libration_settings::linear_loop::linearised_equations;
use libration_study::{Lab, Study, StudyError};

use super::system_page::{GROWS, KINKS, render};
use super::system_tables::{equilibrium, modes};

/// Steps a turn of the table of multipliers.
const STEPS_A_TURN: f64 = 64.0;

/// Growth per step that counts: above the rounding that parts double eigenvalues by its root, some 10⁻⁸.
const GROWTH: f64 = 1e-6;

/// Points of a curve.
const POINTS: usize = 160;

/// Steps from a half to one and a half times the predicted limit that are tried for the first at which a mode grows.
const TRIED: usize = 256;

/// Steps beyond these, each twice as long, that are tried for growth that begins slowly.
const DOUBLED: usize = 10;

/// Halvings of the interval in which the limit is searched: to 10⁻¹² of it.
const HALVINGS: usize = 32;

/// The study `stability` of a system of equations at its equilibrium.
#[derive(Clone, Copy, Debug)]
pub struct SystemStability<'a> {
    system: &'a EquationSystem,
    turn: f64,
}

impl<'a> SystemStability<'a> {
    /// Of a system with a turn of so many seconds.
    pub fn new(system: &'a EquationSystem, turn: f64) -> Self {
        SystemStability { system, turn }
    }
}

impl Study for SystemStability<'_> {
    fn name(&self) -> &'static str {
        "stability"
    }

    fn question(&self) -> &'static str {
        "Which modes does the system have at its equilibrium, and how large may a time step be there?"
    }

    fn run(&self, lab: &Lab<'_>) -> Result<Record, StudyError> {
        let mut record = Record::new(self.name(), self.question());
        let other = |error: String| StudyError::Other(error.into());
        let dt = self.turn / STEPS_A_TURN;
        let (plant, point) =
            linearised_equations(self.system).map_err(|fault| other(fault.message))?;
        let request = LinearRequest::open_loop(plant, dt, None);
        let linear =
            request.and_then(|request| linear_analysis::analyze(&request, &AtomicBool::new(false)));
        let linear = linear.map_err(|error| other(error.to_string()))?;
        let at = point.state_of(self.system);
        record.tables.push(equilibrium(self.system, &at));
        record.tables.push(modes(&linear.modes));
        if !self.system.equations.dynamics().accelerations().is_smooth() {
            record.tables.push(Table::new(KINKS, &[]));
        }
        let is_unstable = linear.modes.iter().any(|mode| mode.growth_rate > 0.0);
        if is_unstable {
            record.tables.push(Table::new(GROWS, &[]));
        }
        let own = |&method: &Method| {
            let theory = linear.steps.iter().find(|step| step.integrator == method.name());
            let program = StepProgram::new(method, self.system.equations.dynamics());
            let (system, turn, at) = (self.system, self.turn, &at[..]);
            OwnStep { system, turn, method, at, program, theory, is_unstable }
        };
        let steps: Vec<OwnStep<'_>> = lab.config.integrators.iter().map(own).collect();
        let limits = lab.sweep("largest stable steps", &steps, |step| Ok(step.measured_limit()))?;
        let mut table = Table::new(
            "steps",
            &[
                "integrator",
                "spectral radius: predicted",
                "measured",
                "largest stable step: predicted (s)",
                "measured (s)",
            ],
        );
        for (step, limit) in steps.iter().zip(limits) {
            table.push(step.find(dt, limit, &mut record));
        }
        record.tables.push(table);
        let curves = lab.sweep("spectral radii", &steps, |step| Ok(step.curve()))?;
        let dts = log_spaced(self.turn);
        let series = Series::new("radius").with("dt", "s", dts);
        let series = steps
            .iter()
            .zip(curves)
            .fold(series, |series, (step, curve)| series.with(step.method.name(), "1", curve));
        record.series.push(series);
        Ok(record)
    }

    fn render(&self, record: &Record, page: &mut Page) -> Result<(), RecordError> {
        render(record, page)
    }
}

/// Time steps from a hundredth of a turn to a whole one.
fn log_spaced(turn: f64) -> Vec<f64> {
    let part = |i: usize| i as f64 / (POINTS - 1) as f64;
    (0..POINTS).map(|i| turn * 100_f64.powf(part(i) - 1.0)).collect()
}

/// Steps of a method about the equilibrium.
struct OwnStep<'a> {
    system: &'a EquationSystem,
    turn: f64,
    method: Method,
    at: &'a [f64],
    program: StepProgram,
    /// What theory predicts; none where it does not apply.
    theory: Option<&'a StepAnalysis>,
    /// Whether a mode of the system itself grows.
    is_unstable: bool,
}

impl OwnStep<'_> {
    /// The spectral radius of the derivative of a step.
    fn radius(&self, dt: f64) -> f64 {
        spectral_radius(&self.program, self.system, self.at, dt).unwrap_or(f64::NAN)
    }

    fn curve(&self) -> Vec<f64> {
        log_spaced(self.turn).into_iter().map(|dt| self.radius(dt)).collect()
    }

    fn predicted_limit(&self) -> Option<f64> {
        self.theory.filter(|_| !self.is_unstable)?.largest_stable_dt
    }

    /// The step from which on a mode grows, and how uncertain it is: where growth begins slowly it depends on the growth that counts.
    fn measured_limit(&self) -> Option<[f64; 2]> {
        let [limit, earlier] = [GROWTH, 0.25 * GROWTH].map(|growth| self.limit_of_growth(growth));
        let (limit, earlier) = (limit?, earlier?);
        // No limit, or one at zero, is a result without uncertainty. Growth that begins as slowly as by a square is twice as far at
        // four times the growth.
        let is_slow = limit.is_finite() && earlier > 0.0;
        Some([limit, if is_slow { 2.0 * (limit - earlier).abs() } else { 0.0 }])
    }

    /// The first step of the curve with which a mode grows, where no theory predicts the limit; none if there is none.
    fn first_growing(&self) -> Option<f64> {
        let is_searched = self.theory.is_none() && !self.is_unstable;
        let mut steps = log_spaced(self.turn).into_iter().filter(|_| is_searched);
        steps.find(|&dt| self.radius(dt) > 1.0 + GROWTH)
    }

    /// The step about the predicted limit, or that of the curve, from which on a mode grows by `growth` in each; zero if one does in smaller steps already.
    fn limit_of_growth(&self, growth: f64) -> Option<f64> {
        let predicted = self.predicted_limit().or_else(|| self.first_growing())?;
        let is_stable = |dt: f64| self.radius(dt) <= 1.0 + growth;
        // Beyond the limit a step may be stable again; where growth begins slowly, it counts far beyond.
        let tried = |i: usize| match i.checked_sub(TRIED) {
            None => predicted * (0.5 + i as f64 / TRIED as f64),
            Some(i) => predicted * 1.5 * 2_f64.powi(i as i32),
        };
        let Some(first) = (0..=TRIED + DOUBLED).find(|&i| !is_stable(tried(i))) else {
            return Some(f64::INFINITY);
        };
        let Some(before) = first.checked_sub(1) else { return Some(0.0) };
        let (mut low, mut high) = (tried(before), tried(first));
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if is_stable(middle) { low = middle } else { high = middle }
        }
        Some(low)
    }

    /// Adds what was found; returns the row of the table.
    fn find(&self, dt: f64, limit: Option<[f64; 2]>, record: &mut Record) -> Vec<Cell> {
        let (name, title) = (self.method.name(), self.method.title());
        let id = |what: &str| format!("stability.{name}.{what}");
        let radius = self.radius(dt);
        let text = format!(
            "{title}: spectral radius of the derivative of a step of {} at the equilibrium",
            seconds(dt, 3)
        );
        let predicted = self.theory.and_then(|theory| theory.predicted_spectral_radius);
        record.find(match predicted {
            Some(predicted) => {
                let why = "rounding parts double eigenvalues by its root";
                let tolerance = Tolerance::absolute(GROWTH, why);
                Finding::predicted(id("radius"), text, "1", predicted, radius, tolerance)
            }
            None => Finding::measured(id("radius"), text, "1", radius),
        });
        let text = format!("{title}: largest time step at which no mode grows");
        if let (Some(predicted), Some([limit, uncertain])) = (self.predicted_limit(), limit) {
            let why = "a growth of 10⁻⁶ a step counts, and a fourth of it gives an earlier limit: twice their distance";
            let tolerance = Tolerance::absolute(uncertain + GROWTH * predicted, why);
            record.find(Finding::predicted(id("limit"), text, "s", predicted, limit, tolerance));
        } else if let Some([limit, _]) = limit {
            record.find(Finding::measured(id("limit"), text, "s", limit));
        }
        let absent = |otherwise| match self.is_unstable {
            true => Cell::absent("the system has a growing mode"),
            false => Cell::absent(otherwise),
        };
        let unknown = match self.theory {
            None => "no theory with states of first order",
            Some(_) => "none",
        };
        let cell = |x: Option<f64>, or| x.map_or_else(|| absent(or), Cell::from);
        vec![
            title.into(),
            predicted.map_or_else(|| Cell::absent("—"), |x| Cell::rounded(x, 8)),
            Cell::rounded(radius, 8),
            cell(self.predicted_limit(), unknown),
            cell(limit.map(|[limit, _]| limit), "none"),
        ]
    }
}
