//! Points of an orbit for a figure.

use libration::Method;
use libration::simulation::SimulationError;
use libration_study::StudyError;

use super::Problem;

/// Points of an orbit: the first two states, positions first. A velocity beside its position is shown as `v·turn/2π`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Portrait {
    /// Abscissae.
    pub x: Vec<f64>,
    /// Ordinates.
    pub y: Vec<f64>,
    /// The names of both axes.
    pub axes: [String; 2],
    /// Their units; empty without one.
    pub units: [String; 2],
}

/// The first `steps` steps; fewer if the orbit leaves the range of `f64`.
pub(super) fn trace(
    problem: &Problem,
    method: Method,
    dt: f64,
    steps: u64,
) -> Result<Portrait, StudyError> {
    let mut states = problem.states.iter();
    let Some(first) = states.next() else { return Ok(Portrait::default()) };
    let second = states.next().unwrap_or(first);
    let is_scaled = first.place < problem.degrees() && second.place >= problem.degrees();
    let (scale, name, unit) = match is_scaled {
        true => (1.0 / problem.omega(), format!("{}·turn/2π", second.name), first.unit.clone()),
        false => (1.0, second.name.clone(), second.unit.clone()),
    };
    let axes = [first.name.clone(), name];
    let units = [first.unit.clone(), unit];
    let mut portrait = Portrait { axes, units, ..Portrait::default() };
    let mut watch = |_, state: &[f64]| {
        portrait.x.push(state[first.place]);
        portrait.y.push(state[second.place] * scale);
    };
    match problem.run(method, &problem.start, dt, steps, &mut watch) {
        Ok(_) | Err(SimulationError::NotFinite { .. }) => Ok(portrait),
        Err(error) => Err(error.into()),
    }
}
