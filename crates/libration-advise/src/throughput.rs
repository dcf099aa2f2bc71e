//! Memory and speed of rollouts.

use std::time::Instant;

use libration::Method;
use libration::ensemble::{AnyEnsemble, BatchFloat};
use libration::rl::Plan;
use libration_settings::equations::EquationSystem;
use libration_work::Work;

use super::AdviseError;
use super::request::Request;

/// Memory and speed of rollouts on this machine.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Throughput {
    /// Number of environments.
    pub environments: usize,
    /// Number of measured trajectories.
    pub trajectories: usize,
    /// Steps of each environment.
    pub steps: usize,
    /// Bytes of the tensors of a rollout in `f32`.
    pub bytes: u128,
    /// Measured steps per second of the chosen integrator and float type with that many trajectories on one core.
    pub steps_a_second: f64,
    /// Simulated time per second, over all trajectories.
    pub simulated_a_second: f64,
}

/// Largest number of measured trajectories.
const MOST: usize = 1 << 16;

/// Shortest duration of the measurement, in s.
const LONG: f64 = 0.02;

impl Throughput {
    /// Measures the chosen integrator and step.
    pub(super) fn measure(
        work: &Work<'_>,
        request: &Request,
        method: Method,
        dt: f64,
        narrow: bool,
    ) -> Result<Throughput, AdviseError> {
        let [environments, steps] = request.rollout;
        let speed = match narrow {
            true => speed::<f32>(work, request, method, dt as f32)?,
            false => speed::<f64>(work, request, method, dt)?,
        };
        let [seen, commands] = sizes(&request.system);
        let bytes = Plan::new(steps, environments).bytes(seen, commands, size_of::<f32>());
        Ok(Throughput {
            environments,
            trajectories: environments.min(MOST),
            steps,
            bytes,
            steps_a_second: speed,
            simulated_a_second: speed * dt,
        })
    }
}

/// The numbers that an environment shows, and its commands: a system without inputs has one for each coordinate.
fn sizes(system: &EquationSystem) -> [usize; 2] {
    let inputs = system.equations.inputs().len();
    [system.states.len(), if inputs == 0 { system.states.len() / 2 } else { inputs }]
}

fn speed<T: BatchFloat>(
    work: &Work<'_>,
    request: &Request,
    method: Method,
    dt: T,
) -> Result<f64, AdviseError> {
    let Request { system, rollout: [count, _], .. } = request;
    let count = (*count).clamp(1, MOST);
    let start = system.initial_state();
    let of = |_: usize, i: usize| T::from_f64(start.get(i).copied().unwrap_or_default());
    let (dynamics, twin) = (system.equations.dynamics(), system.twin.map(|twin| twin.system));
    let mut all = AnyEnsemble::new(dynamics, twin, count, work.serial()?, of)?;
    let mut steps = 16;
    loop {
        let begun = Instant::now();
        all.advance(method, dt, steps);
        let seconds = begun.elapsed().as_secs_f64();
        if seconds > LONG || steps > 1 << 30 {
            return Ok(count as f64 * steps as f64 / seconds);
        }
        // As many as take long enough by this speed, of which the first steps know little.
        let missing = 1.2 * LONG / seconds;
        steps *= missing.clamp(2.0, 64.0) as u64;
    }
}
