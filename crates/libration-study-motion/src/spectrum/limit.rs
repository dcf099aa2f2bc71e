//! Limits of stability, from polynomials and from simulation.

use libration::analysis::SymbolicStep;
use libration::simulation::Simulator;
use libration::system::Oscillator;
use libration::{Method, State, with_method};
use libration_report::record::{Finding, Tolerance};
use libration_study::StudyError;

use super::step::radius_at;
use crate::growth::{GROWTH, grows};
use crate::stable_step::{HIGHEST, largest_stable};

/// A limit, as predicted and as measured.
#[derive(Clone, Debug)]
pub(super) struct Limit {
    predicted: Option<f64>,
    measured: f64,
    tolerance: Tolerance,
}

impl Limit {
    /// The first `z` at which the undamped oscillator is unstable: by the exact windows of stability
    /// of the polynomial matrix, and by the growth of orbits.
    ///
    /// `steps` are simulated to decide whether an orbit grows.
    pub(super) fn imaginary(method: Method, steps: u64) -> Result<Self, StudyError> {
        let predicted = largest_stable(method)?;
        let measured = first_loss(|z| !with_method!(method, |m| grows(m, z, steps)));
        Ok(Limit {
            predicted: Some(predicted),
            measured,
            tolerance: Tolerance::absolute(
                // An orbit that grows by 1 % in half of the steps: by 1 + az² a step from zero on, and
                // by about 1 + (z − limit) beyond a limit.
                if predicted == 0.0 { 0.01 } else { 2.0 * (GROWTH - 1.0) / steps as f64 },
                format!(
                    "what {steps} steps resolve: growth of 1 % in the second half, beats near a \
                     double eigenvalue, and the lowest z = 0.01 that is tried"
                ),
            ),
        })
    }

    /// The first `|λ|Δt` at which a critically damped mode is unstable: by the real polynomial
    /// `R(z)` of a Runge–Kutta method, and by the eigenvalues of the step in `f64`.
    pub(super) fn real(method: Method) -> Self {
        let measured = first_loss(|x| radius_at(method, -x, 0.0) <= 1.0 + 1e-9);
        let polynomial = matches!(method, Method::ExplicitEuler | Method::Rk4)
            .then(|| SymbolicStep::new(method))
            .flatten();
        let predicted = polynomial.map(|step| {
            // On eigenvalues ±i the matrix is [[c, s], [−s, c]](h) and R(z) = c(−iz) + i·s(−iz):
            // the coefficients of both, with alternating signs.
            let (c, s) = (step.matrix.entry(0, 0), step.matrix.entry(0, 1));
            let coefficient = |k: usize| {
                let sign = if (k / 2).is_multiple_of(2) { 1.0 } else { -1.0 };
                sign * (c.coefficient(k) + s.coefficient(k)).to_f64()
            };
            let value = |z: f64| (0..8).rev().fold(0.0, |sum, k| sum * z + coefficient(k));
            first_loss(|x| value(-x).abs() <= 1.0)
        });
        Limit {
            predicted,
            measured,
            tolerance: Tolerance::absolute(
                1e-7,
                "the critically damped eigenvalue is double: rounding u moves it by √u",
            ),
        }
    }

    /// As a finding; without a prediction where a split step has no stability function.
    pub(super) fn finding(self, id: String, text: String) -> Finding {
        match self.predicted {
            Some(predicted) => {
                Finding::predicted(id, text, "1", predicted, self.measured, self.tolerance)
            }
            None => Finding::measured(id, text, "1", self.measured),
        }
    }
}

/// The first point at which `stable` is lost, walking from 0 in steps of 0.01 and then bisecting;
/// zero if it is not stable at the first of them, and [`HIGHEST`] if it is nowhere lost up to there.
fn first_loss(stable: impl Fn(f64) -> bool) -> f64 {
    let grid = |i: u32| f64::from(i) * 0.01;
    let Some(lost) = (1..=800).find(|&i| !stable(grid(i))) else { return HIGHEST };
    if lost == 1 {
        return 0.0;
    }
    let (mut low, mut high) = (grid(lost - 1), grid(lost));
    while high - low > 4.0 * f64::EPSILON * high {
        let middle = 0.5 * (low + high);
        if stable(middle) { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// At `z = 2` symplectic Euler has the eigenvalue −1 twice and one eigenvector: radius one, and
/// yet `x` after `n` steps from `(1, 0)` is `±(2n + 1)`.
pub(super) fn defective_growth() -> Result<Finding, StudyError> {
    const N: u64 = 1_000_000;
    let start = State { q: [1.0_f64], v: [0.0] };
    let method = libration::integrator::SymplecticEuler;
    let mut simulator = Simulator::new(Oscillator { omega2: 1.0 }, method, start, 2.0)?;
    simulator.run(N, &mut ())?;
    Ok(Finding::predicted(
        "spectrum.symplectic-euler.defective-growth",
        format!("symplectic Euler at z = 2, spectral radius 1: |x| after {N} steps from (1, 0)"),
        "m",
        (2 * N + 1) as f64,
        simulator.sample().state.q[0].abs(),
        Tolerance::exact("all numbers are whole and below 2⁵³"),
    ))
}
