//! Temperatures measured in an ensemble of trajectories.

use libration::equations::StepProgram;
use libration::random::{Address, Purpose};
use libration::thermostat::{LangevinMethod, LangevinStep};
use libration_work::{Interrupted, Work};

use super::TemperatureRequest;
use super::normal_modes::NormalModes;

/// Steps between checks for an interrupt and for a trajectory that left.
const BLOCK: u64 = 1024;

/// An ensemble of trajectories with a thermostat.
pub(super) struct Ensemble<'a> {
    pub(super) request: &'a TemperatureRequest,
    pub(super) modes: &'a NormalModes,
    /// Time step in s.
    pub(super) dt: f64,
}

/// The lengths of a trajectory, in steps.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lengths {
    /// Steps before the measurement.
    pub(super) discarded: u64,
    pub(super) measured: u64,
}

/// The result of a trajectory.
#[derive(Clone, Copy, Debug)]
pub(super) struct Means {
    /// Means over `kT`: of the virial of positions, and of the kinetic energy.
    pub(super) temperatures: [f64; 2],
    /// Whether it ended in the valley of the equilibrium.
    pub(super) is_at_home: bool,
}

impl Ensemble<'_> {
    /// The means of a trajectory that begins at rest; none if it does not stay finite.
    pub(super) fn means(
        &self,
        work: &Work<'_>,
        method: &LangevinMethod,
        lengths: Lengths,
        trajectory: u64,
    ) -> Result<Option<Means>, Interrupted> {
        let Ensemble { request, modes, dt } = *self;
        let dynamics = request.system.equations.dynamics();
        let NormalModes { equilibrium, mass, .. } = modes;
        let n = dynamics.degrees();
        let Some(step) = StepProgram::langevin(method, dynamics) else { return Ok(None) };
        let letters = libration::analysis::letters(method);
        let numbers = LangevinStep::new(dt, request.friction, letters);
        let LangevinStep { dt, decay, damping, implicit_factor } = numbers;
        let deviation = (request.temperature * method.noise_variance(numbers)).sqrt();
        let noise = 3 * n + dynamics.inputs() + 4;
        let mut inputs = equilibrium.clone();
        inputs.resize(noise + method.noises() * n, 0.0);
        inputs[noise - 4..noise].copy_from_slice(&[dt, decay, damping, implicit_factor]);
        let start: Vec<f64> = dynamics.accelerations().on::<f64>().run(&inputs[..2 * n]).collect();
        inputs[2 * n..3 * n].copy_from_slice(&start);
        let mut run = step.program().on::<f64>();
        let mut next = Vec::with_capacity(3 * n);
        let mut sums = [0.0; 2];
        for number in 0..lengths.discarded + lengths.measured {
            if number % BLOCK == 0 {
                work.check()?;
                if !inputs[..2 * n].iter().all(|x| x.is_finite()) {
                    return Ok(None);
                }
            }
            self.draw(&mut inputs[noise..], (trajectory, number), deviation);
            next.clear();
            next.extend(run.run(&inputs));
            inputs[..3 * n].copy_from_slice(&next);
            if number >= lengths.discarded {
                let (q, rest) = next.split_at(n);
                let (v, a) = rest.split_at(n);
                for i in 0..n {
                    for j in 0..n {
                        let mass = mass[(i, j)];
                        sums[0] -= (q[i] - equilibrium[i]) * mass * a[j];
                        sums[1] += v[i] * mass * v[j];
                    }
                }
            }
        }
        let scale = 1.0 / (lengths.measured as f64 * n as f64 * request.temperature);
        let temperatures = sums.map(|sum| sum * scale);
        if !temperatures.iter().all(|x| x.is_finite()) {
            return Ok(None);
        }
        Ok(Some(Means { temperatures, is_at_home: modes.is_in_valley(dynamics, &inputs[..n]) }))
    }

    /// Draws the vectors of noise of a step.
    fn draw(&self, noise: &mut [f64], (trajectory, step): (u64, u64), deviation: f64) {
        let pairs = noise.len().div_ceil(2) as u64;
        for (k, pair) in noise.chunks_mut(2).enumerate() {
            let step = step * pairs + k as u64;
            let address =
                Address { seed: self.request.seed, trajectory, step, purpose: Purpose::Thermostat };
            for (x, draw) in pair.iter_mut().zip(address.gaussian()) {
                *x = deviation * draw;
            }
        }
        let root = &self.modes.inverse_root;
        for vector in noise.chunks_mut(root.rows()) {
            // From below, since a row takes the draws above it.
            for i in (0..vector.len()).rev() {
                vector[i] = (0..=i).map(|j| root[(i, j)] * vector[j]).sum();
            }
        }
    }
}
