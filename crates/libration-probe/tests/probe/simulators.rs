//! Simulators that are written here, in ten lines each, without Libration.

use libration::linear::Matrix;
use libration_probe::{BlackBox, BlackBoxError, ProbeReport, Subject, probe};

type StepFunction<'a> = Box<dyn FnMut(&[f64], &[f64], f64) -> Vec<f64> + 'a>;
type Observer<'a> = Box<dyn FnMut(&[f64]) -> Vec<f64> + 'a>;
type Energy<'a> = Box<dyn Fn(&[f64]) -> f64 + 'a>;

/// A simulator of functions.
#[derive(Default)]
pub(crate) struct Simulator<'a> {
    pub(crate) step: Option<StepFunction<'a>>,
    pub(crate) observe: Option<Observer<'a>>,
    pub(crate) energy: Option<Energy<'a>>,
    pub(crate) is_batched: bool,
    /// Changes the results of a batch of this size.
    pub(crate) spoil: Option<usize>,
}

impl<'a> Simulator<'a> {
    pub(crate) fn new(step: impl FnMut(&[f64], &[f64], f64) -> Vec<f64> + 'a) -> Self {
        Simulator { step: Some(Box::new(step)), ..Simulator::default() }
    }

    pub(crate) fn with_energy(mut self, energy: impl Fn(&[f64]) -> f64 + 'a) -> Self {
        self.energy = Some(Box::new(energy));
        self
    }

    pub(crate) fn audit(mut self, subject: &Subject) -> ProbeReport {
        probe(&mut self, subject).unwrap()
    }
}

impl BlackBox for Simulator<'_> {
    fn step(
        &mut self,
        states: &Matrix,
        actions: &Matrix,
        dt: f64,
    ) -> Result<Matrix, BlackBoxError> {
        let step = self.step.as_mut().unwrap();
        let rows: Vec<Vec<f64>> =
            (0..states.rows()).map(|i| step(states.row(i), actions.row(i), dt)).collect();
        let mut next = Matrix::from_rows(&rows).unwrap();
        if self.spoil == Some(rows.len()) {
            let last = next.row_mut(rows.len() - 1).last_mut().unwrap();
            *last = last.next_up();
        }
        Ok(next)
    }

    fn is_batched(&self) -> bool {
        self.is_batched
    }

    fn observe(&mut self, states: &Matrix) -> Result<Option<Matrix>, BlackBoxError> {
        let Some(observe) = &mut self.observe else { return Ok(None) };
        let rows: Vec<Vec<f64>> = (0..states.rows()).map(|i| observe(states.row(i))).collect();
        Ok(Matrix::from_rows(&rows))
    }

    fn energies(&mut self, states: &Matrix) -> Result<Option<Vec<f64>>, BlackBoxError> {
        let Some(energy) = &self.energy else { return Ok(None) };
        Ok(Some((0..states.rows()).map(|i| energy(states.row(i))).collect()))
    }
}

/// A pendulum under a torque, hanging at zero: kick, then drift.
pub(crate) fn pendulum(x: &[f64], u: &[f64], dt: f64) -> Vec<f64> {
    damped_pendulum(0.0, x, u, dt)
}

/// The same with damping `gamma` in 1/s.
pub(crate) fn damped_pendulum(gamma: f64, x: &[f64], u: &[f64], dt: f64) -> Vec<f64> {
    let v = x[1] + dt * (-9.0 * x[0].sin() - gamma * x[1] + u[0]);
    vec![x[0] + dt * v, v]
}

/// Its energy without damping and torque.
pub(crate) fn pendulum_energy(x: &[f64]) -> f64 {
    x[1] * x[1] / 2.0 - 9.0 * x[0].cos()
}

/// A pendulum at rest with steps of 10 ms.
pub(crate) fn pendulum_subject() -> Subject {
    Subject::new("pendulum", vec![0.0, 0.0], vec![0.0], 0.01)
}

/// Kinds of the findings.
pub(crate) fn kinds(report: &ProbeReport) -> Vec<&'static str> {
    report.findings.iter().map(|finding| finding.kind.name()).collect()
}
