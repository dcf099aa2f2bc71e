//! Steps of an integrator on a linear plant as results.

use libration::AnyMethod;
use libration::analysis::{LinearStepper, StabilityFunction, StepMode, StepWindow};
use libration::linear::{Complex64, Discretisation, LinearPlant, Matrix, eigenvalues};
use libration_report::verdict::{Outcome, Verdict};
use serde::Serialize;

use super::SimulatedMode;
use crate::Stepping;
use crate::step_verdict::{ModeGrowth, StepGrowth, has_multiple};

/// Steps of an integrator on a plant.
#[derive(Clone, Debug, Serialize)]
pub struct StepAnalysis {
    /// The name of the integrator, or `exact`.
    pub integrator: &'static str,
    /// The stability function as a polynomial in `z = hλ` or a quotient of two; none of exact steps, and of integrators that distinguish positions from
    /// velocities.
    pub stability_function: Option<String>,
    /// The intervals `[from, to]` of time steps in s in which no mode grows that does not grow in exact steps; `to` is none without
    /// an end. None if they are not known.
    pub stable_dt: Option<Vec<[Option<f64>; 2]>>,
    /// The reason for which they are not known, if they are not: `as a mode of the plant grows`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unknown_stable_dt: Option<&'static str>,
    /// The end of the first of them, if it begins at 0; none without an end.
    pub largest_stable_dt: Option<f64>,
    /// The largest size of a multiplier of a mode: of the stability function at the eigenvalues of the plant, or of the eigenvalues of
    /// the update matrix.
    pub predicted_spectral_radius: Option<f64>,
    /// The spectral radius of the update matrix, the step of the integrator in `f64` from each unit vector.
    pub spectral_radius: Option<f64>,
    /// The same in `f32`; none of exact steps.
    pub spectral_radius_f32: Option<f64>,
    /// A simulation from the shape of the mode with the largest multiplier, in `f64`; none of exact steps.
    pub simulated: Option<SimulatedMode>,
    /// The same in `f32`.
    pub simulated_f32: Option<SimulatedMode>,
    /// The largest error of a growth rate in 1/s, and its mode from 0; above zero the mode grows faster than in exact steps. None of
    /// exact steps.
    pub largest_growth_error: Option<(f64, usize)>,
    /// The largest phase error in rad per step, and its mode from 0; above zero it turns further. None of exact steps.
    pub largest_phase_error: Option<(f64, usize)>,
    /// The modes of the plant in their order; empty without a time step, or if the step overflows.
    pub modes: Vec<ModeUnderSteps>,
    /// Whether the step lets deviations grow more than exact steps do; none without a time step.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub verdict: Option<Verdict>,
}

/// A mode of the plant under steps of an integrator.
#[derive(Clone, Debug, Serialize)]
pub struct ModeUnderSteps {
    /// The factor by which the mode grows in an exact step.
    pub exact_growth: f64,
    /// The factor by which it grows in a step of the integrator.
    pub growth: f64,
    /// The relative error of the growth in a step.
    pub growth_error_per_step: f64,
    /// The error of the growth rate in 1/s.
    pub growth_error: f64,
    /// The angle in rad by which the mode turns in an exact step.
    pub exact_angle: f64,
    /// The angle in rad by which it turns in a step of the integrator, of those that differ by whole turns the nearest.
    pub angle: f64,
    /// The phase error in rad per step.
    pub phase_error_per_step: f64,
    /// The phase error in rad/s.
    pub phase_error: f64,
    /// A simulation from the shape of the mode in `f64`; only with one integrator, and none of exact steps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub simulated: Option<SimulatedMode>,
    /// The same in `f32`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub simulated_f32: Option<SimulatedMode>,
}

/// Why no stable steps follow from a linearisation that is zero.
const NOTHING: &str = "as the linearisation is zero and decides nothing";

/// A plant in continuous time, with its modes.
pub(super) struct Subject<'a> {
    pub(super) plant: &'a LinearPlant,
    pub(super) stepper: Option<&'a LinearStepper>,
    pub(super) shapes: &'a [(Complex64, Vec<Complex64>)],
    /// Whether the plant is a linearisation that decides nothing.
    pub(super) decides_nothing: bool,
}

impl Subject<'_> {
    /// Analyses steps of `dt` seconds; without them the stable time steps only. With `detail` each mode is simulated.
    pub(super) fn analyze(
        &self,
        stepping: Stepping,
        dt: Option<f64>,
        detail: bool,
    ) -> StepAnalysis {
        let method = stepping.any_method();
        let (windows, unknown) = match method {
            None => (Some(vec![StepWindow::ALL]), None),
            Some(_) if self.decides_nothing => (None, Some(NOTHING)),
            Some(method) => self.stable_steps(method),
        };
        let first = windows.as_ref().and_then(|windows| windows.first());
        let mut analysis = StepAnalysis {
            integrator: stepping.name(),
            stability_function: method
                .and_then(StabilityFunction::of)
                .map(|function| function.to_string()),
            largest_stable_dt: first
                .filter(|window| window.from == 0.0 && window.to.is_finite())
                .map(|window| window.to),
            stable_dt: windows.map(|windows| windows.into_iter().map(ends).collect()),
            unknown_stable_dt: unknown,
            predicted_spectral_radius: None,
            spectral_radius: None,
            spectral_radius_f32: None,
            simulated: None,
            simulated_f32: None,
            largest_growth_error: None,
            largest_phase_error: None,
            modes: Vec::new(),
            verdict: None,
        };
        match (dt, method, self.stepper) {
            (Some(dt), None, _) => self.add_exact(&mut analysis, dt),
            (Some(dt), Some(method), Some(stepper)) => {
                self.add_steps(&mut analysis, stepper, method, dt, detail);
            }
            _ => {}
        }
        analysis.verdict = dt.map(|dt| match method {
            Some(_) => self.growth(&analysis, dt).verdict(),
            None => Verdict::new(Outcome::Stable, "exact steps"),
        });
        analysis
    }

    /// The growth of the plant in steps and in exact ones.
    fn growth<'s>(&self, analysis: &'s StepAnalysis, dt: f64) -> StepGrowth<'s> {
        let rates = self.shapes.iter().map(|(value, _)| value.re);
        StepGrowth {
            dt,
            radius: analysis.predicted_spectral_radius.or(analysis.spectral_radius),
            exact_rate: rates.fold(f64::NEG_INFINITY, f64::max),
            has_parted: self.shapes.iter().any(|(value, _)| value.norm() == 0.0)
                || has_multiple(self.shapes.iter().map(|(value, _)| *value)),
            stable_dt: analysis.stable_dt.as_deref(),
            has_stability_function: analysis.stability_function.is_some(),
            modes: analysis.modes.iter().map(ModeUnderSteps::in_a_step).collect(),
        }
    }

    /// The stable time steps, or the reason for which they are not known.
    fn stable_steps(&self, method: AnyMethod) -> (Option<Vec<StepWindow>>, Option<&'static str>) {
        let upper = self.shapes.iter().map(|(value, _)| *value);
        let lower = self.shapes.iter().filter(|(value, _)| value.im > 0.0);
        let values: Vec<Complex64> = upper.chain(lower.map(|(value, _)| value.conj())).collect();
        let Some(stepper) = self.stepper else { return (None, None) };
        match stepper.stable_steps(method, &values) {
            Some(windows) => (Some(windows), None),
            None => (None, Some(stepper.unknown_steps(method, &values))),
        }
    }

    fn add_exact(&self, analysis: &mut StepAnalysis, dt: f64) {
        let modes = StepMode::exact(self.shapes, dt);
        let step = Discretisation::exact(&self.plant.a, &self.plant.b, dt);
        analysis.spectral_radius = radius_of(&step.phi);
        analysis.set_modes(&modes);
        // Logarithms of exponentials round.
        (analysis.largest_growth_error, analysis.largest_phase_error) = (None, None);
        for mode in &mut analysis.modes {
            (mode.growth_error, mode.growth_error_per_step) = (0.0, 0.0);
            (mode.phase_error, mode.phase_error_per_step) = (0.0, 0.0);
            mode.angle = mode.exact_angle;
        }
    }

    fn add_steps(
        &self,
        analysis: &mut StepAnalysis,
        stepper: &LinearStepper,
        method: AnyMethod,
        dt: f64,
        detail: bool,
    ) {
        let double = stepper.with_step::<f64>(method, dt);
        let single = stepper.with_step::<f32>(method, dt);
        let (Some(double), Some(single)) = (double, single) else { return };
        let matrix = double.update_matrix();
        analysis.spectral_radius = radius_of(&matrix);
        analysis.spectral_radius_f32 = radius_of(&single.update_matrix());
        let modes = match StabilityFunction::of(method) {
            Some(function) => Some(StepMode::of_function(&function, self.shapes, dt)),
            None => StepMode::of_matrix(stepper, &matrix, self.shapes, dt),
        };
        let Some(modes) = modes else { return };
        analysis.set_modes(&modes);
        let Some(radius) = analysis.predicted_spectral_radius else { return };
        let states = self.plant.states.len();
        let fastest =
            modes.iter().max_by(|a, b| a.multiplier.norm().total_cmp(&b.multiplier.norm()));
        if let Some(mode) = fastest {
            analysis.simulated = SimulatedMode::new(mode, &double, radius, states);
            analysis.simulated_f32 = SimulatedMode::new(mode, &single, radius, states);
        }
        if detail {
            for (row, mode) in analysis.modes.iter_mut().zip(&modes) {
                row.simulated = SimulatedMode::new(mode, &double, radius, states);
                row.simulated_f32 = SimulatedMode::new(mode, &single, radius, states);
            }
        }
    }
}

impl StepAnalysis {
    fn set_modes(&mut self, modes: &[StepMode]) {
        let radius = modes.iter().map(|mode| mode.multiplier.norm()).reduce(f64::max);
        self.predicted_spectral_radius = radius.filter(|radius| radius.is_finite());
        self.modes = modes.iter().map(ModeUnderSteps::new).collect();
        let largest = |of: fn(&ModeUnderSteps) -> f64| {
            let errors = self.modes.iter().enumerate().map(|(i, mode)| (of(mode), i));
            errors.reduce(|a, b| if b.0.abs() > a.0.abs() { b } else { a })
        };
        self.largest_growth_error = largest(|mode| mode.growth_error);
        self.largest_phase_error = largest(|mode| mode.phase_error_per_step);
    }
}

impl ModeUnderSteps {
    fn in_a_step(&self) -> ModeGrowth {
        let &ModeUnderSteps { growth, angle, exact_growth, exact_angle, .. } = self;
        ModeGrowth { growth, angle, exact_growth, exact_angle }
    }

    fn new(mode: &StepMode) -> Self {
        let error = mode.phase_error();
        ModeUnderSteps {
            exact_growth: mode.exact_growth(),
            growth: mode.multiplier.norm(),
            growth_error_per_step: (mode.growth_error() * mode.dt).exp_m1(),
            growth_error: mode.growth_error(),
            exact_angle: mode.exact_angle(),
            angle: mode.exact_angle() + error,
            phase_error_per_step: error,
            phase_error: error / mode.dt,
            simulated: None,
            simulated_f32: None,
        }
    }
}

/// The spectral radius; none if it is not finite.
fn radius_of(matrix: &Matrix) -> Option<f64> {
    let radius = eigenvalues(matrix)?.iter().map(|value| value.norm()).fold(0.0, f64::max);
    radius.is_finite().then_some(radius)
}

fn ends(window: StepWindow) -> [Option<f64>; 2] {
    [Some(window.from), Some(window.to).filter(|to| to.is_finite())]
}
