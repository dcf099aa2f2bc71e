//! Points of an orbit for a figure.

use libration::simulation::{Sample, SimulationError};
use libration::{Method, Model};
use libration_study::StudyError;

use super::Problem;

/// Points of an orbit: `q` and `v·turn/2π` in one degree of freedom, `q₀` and `q₁` in more.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Portrait {
    /// Abscissae.
    pub x: Vec<f64>,
    /// Ordinates.
    pub y: Vec<f64>,
}

/// The first `steps` steps; fewer if the orbit leaves the range of `f64`.
pub(super) fn trace<M: Model<D>, const D: usize>(
    problem: &Problem<M, D>,
    method: Method,
    dt: f64,
    steps: u64,
) -> Result<Portrait, StudyError> {
    let mut portrait = Portrait::default();
    let mut watch = |s: &Sample<f64, D>| {
        let [x, y] = match D {
            1 => [s.state.q[0], s.state.v[0] * problem.turn / std::f64::consts::TAU],
            _ => [s.state.q[0], s.state.q[1 % D]],
        };
        portrait.x.push(x);
        portrait.y.push(y);
    };
    match problem.run(method, problem.start, dt, steps, &mut watch) {
        Ok(_) | Err(SimulationError::NotFinite { .. }) => Ok(portrait),
        Err(error) => Err(error.into()),
    }
}
