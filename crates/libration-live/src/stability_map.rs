//! A map of stability over two entries of a setting.

use libration_equations::StepProgram;

use crate::control_loop::ControlLoop;
use crate::motion::{radius, step_matrix};
use crate::subject::Subject;
use crate::{Answer, Setting, SettingError};

/// An entry of a setting that varies along an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct MapAxis {
    /// The key: `dt`, a part of the loop, or `parameter.NAME`.
    pub key: String,
    /// The values.
    pub values: Vec<f64>,
}

impl MapAxis {
    fn parameter(&self) -> Option<&str> {
        self.key.strip_prefix("parameter.")
    }
}

/// The rate in 1/s at which small deviations from the equilibrium grow, for each value along `x` and the one of `y`; NaN where there
/// is none.
///
/// # Errors
/// [`SettingError`]: a setting or an axis that is wrong.
pub fn map_row(
    setting: &Setting,
    x: &MapAxis,
    (key, y): (&str, f64),
) -> Result<Answer, SettingError> {
    let mut setting = setting.clone();
    setting.set(key, &y.to_string())?;
    // A parameter of the axis becomes an input of the programs, which are made once.
    if let Some(name) = x.parameter()
        && !setting.definitions.vary(name)
    {
        return Err(SettingError::Key(x.key.clone()));
    }
    let subject = Subject::new(&setting)?;
    let step = StepProgram::of(setting.integrator, subject.equations.dynamics());
    let point = |parameters: &[f64]| match &setting.control {
        Some(_) => subject.point(parameters),
        None => subject.calm_point(parameters),
    };
    let fixed = x.parameter().is_none().then(|| point(&[]));
    let mut rates = Vec::with_capacity(x.values.len());
    for &value in &x.values {
        let mut setting = setting.clone();
        let varied = x.parameter().map(|_| value);
        if varied.is_none() {
            setting.set(&x.key, &value.to_string())?;
        }
        let moved = varied.map(|value| point(&[value]));
        let Some(point) = moved.as_ref().or(fixed.as_ref()) else { continue };
        let rate = match &setting.control {
            Some(control) => ControlLoop::new(&subject, point.clone(), control, setting.dt)
                .ok()
                .and_then(|own| own.exact_growth()),
            None => {
                let matrix = step_matrix(&subject, &step, point, setting.dt);
                radius(&matrix).map(|radius| radius.ln() / setting.dt)
            }
        };
        rates.push(rate.unwrap_or(f64::NAN));
    }
    let mut answer = Answer::default();
    answer.column("growth", rates);
    Ok(answer)
}
