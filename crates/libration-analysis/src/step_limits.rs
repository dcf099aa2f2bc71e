//! The stable time steps of one integrator on many plants.

use core::cell::OnceCell;

use libration_core::system::DampedOscillator;
use libration_core::{AnyMethod, Integrator};
use num_complex::Complex64;

use super::neutral_steps::neutral_windows;
use super::stable_steps::without_rounding;
use super::step_search::{DAMPED, searched_windows};
use super::{LinearStepper, StabilityFunction, StabilityWindow, StepWindow, oscillator_windows};

/// The stable time steps of an integrator on many plants. What depends on the integrator alone is computed once.
#[derive(Debug)]
pub struct StepLimits {
    method: AnyMethod,
    function: Option<StabilityFunction>,
    /// The windows of the oscillator without damping, in powers of `ωh`; none if they are not known.
    undamped: OnceCell<Option<Vec<StepWindow>>>,
    /// Whether those of damped oscillators are searched too, in place of exact polynomials.
    searches: bool,
}

/// The most forces of a step whose polynomials on a damped oscillator take no more time than a search.
const SHORT: usize = 3;

/// The most forces of a step whose polynomials on a damped oscillator take a few seconds.
const LONG: usize = 15;

impl StepLimits {
    /// The limits of an integrator, as exact as [`LinearStepper::stable_steps`].
    pub fn new(method: impl Into<AnyMethod>) -> Self {
        StepLimits::with_exact(method.into(), LONG)
    }

    /// The same, by the search of [`LinearStepper::stable_steps`] also on damped oscillators if a step evaluates many forces: its exact
    /// polynomials take seconds for each.
    pub fn searched(method: impl Into<AnyMethod>) -> Self {
        StepLimits::with_exact(method.into(), SHORT)
    }

    /// The limits, from exact polynomials on damped oscillators up to `most` forces of a step.
    fn with_exact(method: AnyMethod, most: usize) -> Self {
        let searches = match method {
            AnyMethod::Explicit(method) => method.evaluations() > most,
            AnyMethod::Implicit(_) => false,
        };
        let function = StabilityFunction::of(method);
        StepLimits { method, function, undamped: OnceCell::new(), searches }
    }

    /// As [`LinearStepper::stable_steps`].
    pub fn of(&self, stepper: &LinearStepper, values: &[Complex64]) -> Option<Vec<StepWindow>> {
        let (method, values) = (self.method, without_rounding(values));
        if let Some(function) = &self.function {
            let kept = values.iter().filter(|value| value.re <= 0.0);
            return Some(intersection(kept.map(|&value| function.stable_steps(value))));
        }
        if !stepper.is_mechanical() || values.iter().any(|value| value.re > 0.0) {
            return None;
        }
        // In powers of ωh.
        let undamped = || windows_of(method, &DampedOscillator { omega2: 1.0, gamma: 0.0 });
        let undamped = self.undamped.get_or_init(undamped).as_ref()?;
        if !stepper.is_damped() {
            let of = |value: &Complex64| match value.norm() {
                0.0 => vec![StepWindow::ALL],
                size => undamped.iter().map(|window| window.scaled(size.recip())).collect(),
            };
            return Some(intersection(values.iter().map(of)));
        }
        let oscillators = if self.searches { None } else { stepper.oscillators(&values) };
        let exact = oscillators.and_then(|all| {
            all.iter().map(|one| windows_of(method, one)).collect::<Option<Vec<_>>>()
        });
        if let Some(exact) = exact {
            return Some(intersection(exact.into_iter()));
        }
        let last = undamped.last().map_or(0.0, |window| window.to);
        // Where gyroscopic forces leave an exact mode that neither grows nor decays, no search in `f64` tells growth from rounding.
        if values.iter().any(|value| value.re == 0.0 && value.im != 0.0) {
            let most = match method {
                AnyMethod::Explicit(_) => 2.0 * last + 1.0,
                AnyMethod::Implicit(_) => DAMPED[1],
            };
            return neutral_windows(stepper, method, &values, most);
        }
        match method {
            AnyMethod::Explicit(_) => {
                searched_windows(stepper, method, &values, [0.0, 2.0 * last + 1.0])
            }
            AnyMethod::Implicit(_) => searched_windows(stepper, method, &values, DAMPED),
        }
    }
}

/// The stability windows of a method on an oscillator, from exact polynomials; none if these outgrow their arithmetic.
fn windows_of(method: AnyMethod, one: &DampedOscillator<f64>) -> Option<Vec<StepWindow>> {
    let windows = oscillator_windows(method, one)?;
    let ends = |window: &StabilityWindow| StepWindow {
        from: window.from.to_f64(),
        to: window.to.map_or(f64::INFINITY, |to| to.to_f64()),
    };
    Some(windows.iter().map(ends).collect())
}

fn intersection(all: impl Iterator<Item = Vec<StepWindow>>) -> Vec<StepWindow> {
    all.fold(vec![StepWindow::ALL], |sum, next| StepWindow::intersections(&sum, &next))
}
