//! One integrator at one step: theory and simulation.

use libration::analysis::{Eigenvalues, Linearisation, Spectrum, UpdateMatrix};
use libration::equations::{Dynamics, StepProgram};
use libration::number::Wide;
use libration::simulation::Simulator;
use libration::system::Oscillator;
use libration::{Float, Integrator, Method, Model, Scalar, State, with_method};
use libration_study::StudyError;

use crate::rounding::{accumulated, condition, path_of_unit_step, substeps};

/// Unit roundoff of the simulations.
const U: f64 = <f64 as Float>::UNIT_ROUNDOFF;

/// Theory of one step on the oscillator, with 1024 bits.
#[derive(Clone, Copy, Debug)]
pub(super) struct Theory {
    pub(super) radius_minus_one: f64,
    pub(super) determinant_minus_one: f64,
    pub(super) symplecticity_defect: f64,
    pub(super) reversibility_defect: f64,
    /// Angle of the step, and its excess over that of the exact solution, in rad; none where the
    /// eigenvalues are real.
    pub(super) angle: Option<(f64, f64)>,
    /// Whether the eigenvalues are real and equal.
    double: bool,
}

impl Theory {
    pub(super) fn of(method: Method, oscillator: Oscillator<f64>, dt: f64) -> Self {
        // The step of a linear system is the same about every state.
        let anywhere = State { q: [1.0], v: [0.0] };
        let dynamics = Dynamics::of::<1>(&oscillator, None);
        let linear =
            Linearisation::new(&StepProgram::of(method, &dynamics), &dynamics, &[1.0, 0.0], dt);
        let spectrum = Spectrum::new(&UpdateMatrix::of_step(method, oscillator, &anywhere, dt));
        let rates = UpdateMatrix::of_rates(oscillator, &anywhere);
        let exact = match Spectrum::new(&rates).eigenvalues {
            Eigenvalues::Complex { im, .. } => im * linear.dt,
            _ => Wide::ZERO,
        };
        let angle = matches!(spectrum.eigenvalues, Eigenvalues::Complex { .. }).then(|| {
            let angle = spectrum.angle();
            (angle.to_f64(), (angle - exact).to_f64())
        });
        Theory {
            radius_minus_one: spectrum.radius_minus_one().to_f64(),
            determinant_minus_one: spectrum.determinant_minus_one().to_f64(),
            symplecticity_defect: linear.step.symplecticity_defect().to_f64(),
            reversibility_defect: linear.reversibility_defect().to_f64(),
            angle,
            double: matches!(spectrum.eigenvalues, Eigenvalues::Double { .. }),
        }
    }
}

/// A measured value and the rounding that it may carry.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measured {
    pub(super) value: f64,
    pub(super) rounding: f64,
}

impl Measured {
    /// Whether it tells anything of a quantity of this size: rounding may not leave half of it.
    pub(super) fn tells(&self, size: f64) -> bool {
        self.value.is_finite() && self.rounding < 0.5 * size
    }
}

/// Simulation of many steps in `f64`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Run {
    /// Number of steps taken.
    pub(super) steps: u64,
    /// Spectral radius minus one.
    pub(super) radius_minus_one: Measured,
    /// Angle of a step minus that of the exact solution, in rad.
    pub(super) phase_error: Option<Measured>,
}

impl Run {
    /// Runs the two unit vectors for about `steps` steps, at most; the determinant and half the trace
    /// of the matrix that they span after `n` steps are `ρ²ⁿ` and `ρⁿ cos nθ`. None where a single
    /// step leaves the range in which areas can be measured.
    ///
    /// The theory is used to choose `n` such that `cos nθ` is near zero, where the angle is best
    /// resolved, and to count whole turns.
    pub(super) fn new(
        method: Method,
        oscillator: Oscillator<f64>,
        dt: f64,
        steps: u64,
        theory: &Theory,
    ) -> Result<Option<Self>, StudyError> {
        // Growth to 10^±100 leaves room for products.
        let allowed = 230.0 / theory.radius_minus_one.ln_1p().abs();
        let most = (steps as f64).min(allowed).max(1.0).floor();
        let mut steps = match theory.angle {
            Some((angle, _)) => {
                let quarter = std::f64::consts::FRAC_PI_2;
                let turns = ((most * angle - quarter) / std::f64::consts::PI).floor().max(0.0);
                ((turns * std::f64::consts::PI + quarter) / angle).round().clamp(1.0, most)
            }
            None => most,
        } as u64;
        // At a huge step the entries grow faster than the eigenvalues.
        let after = loop {
            let after = with_method!(method, |m| fundamental(m, oscillator, dt, steps))?;
            match after {
                Some(after) => break after,
                None if steps == 1 => return Ok(None),
                None => steps /= 2,
            }
        };
        Ok(Some(Run::of(method, oscillator, dt, steps, theory, &after)))
    }

    /// Returns results of the matrix of `steps` steps, in units in which orbits are circles.
    fn of(
        method: Method,
        oscillator: Oscillator<f64>,
        dt: f64,
        steps: u64,
        theory: &Theory,
        after: &UpdateMatrix<f64>,
    ) -> Self {
        let exact = oscillator.omega2.sqrt() * dt;
        let condition = condition(method, exact, steps);
        let [a, b, c, d] = [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(i, j)| after.entry(i, j));
        let (n, determinant, half, skew) =
            (steps as f64, after.determinant(), (a + d) / 2.0, (a - d) / 2.0);
        // |det − half²| = |bc + skew²|, without its cancellation and without an underflow.
        let product = b.abs().sqrt() * c.abs().sqrt();
        let sign = if (b < 0.0) == (c < 0.0) { 1.0 } else { -1.0 };
        let tilt = if skew == 0.0 { 0.0 } else { (skew / product).powi(2) };
        let root = |wanted: f64| product * (wanted * (sign + tilt)).max(0.0).sqrt();
        let size = match theory.angle {
            Some(_) => determinant.abs().sqrt(),
            None if theory.double => half.abs(),
            None => half.abs() + root(1.0),
        };
        // Roundings of a step are independent; n of them add up like √n, and 20 covers the number
        // of operations of a step. Rounded coefficients such as Δt/6 are the same at every step.
        // Both are magnified by the condition of the eigenvectors.
        let rounding = 20.0 * U * accumulated(exact, n) * condition;
        let path = exact * path_of_unit_step(method);
        let coefficients = 4.0 * U * exact * path.exp() * condition;
        // What a root of a difference of squares makes of them, and of the products under the root:
        // near a double eigenvalue a perturbation c moves the root of n steps by up to √(n²Δc).
        let products = 4.0 * U * (product * product + skew * skew) / (size * size);
        let under_root = |root: f64| {
            let error = 2.0 * root * rounding
                + rounding * rounding
                + products
                + (1.0 + 2.0 * root) * n * coefficients;
            (error / root).min(error.sqrt())
        };
        let relative = match theory.angle {
            Some(_) => rounding + products,
            None if theory.double => rounding,
            None => rounding + under_root(root(1.0) / size),
        };
        let phase_error = theory.angle.map(|(angle, _)| {
            let sine = root(-1.0);
            let folded = sine.atan2(half);
            let turns = (n * angle / std::f64::consts::TAU).floor();
            let rest = n * angle - turns * std::f64::consts::TAU;
            let total = if rest <= std::f64::consts::PI {
                turns * std::f64::consts::TAU + folded
            } else {
                (turns + 1.0) * std::f64::consts::TAU - folded
            };
            // The entries of a short turn are rounded relative to their own size.
            let short = rounding * total + rounding * rounding / total;
            let turned = short.min(under_root(sine / size).min(rounding + products.sqrt()));
            Measured {
                value: total / n - exact,
                rounding: (turned + 4.0 * U * total) / n + coefficients,
            }
        });
        let radius_minus_one = (size.ln() / n).exp_m1();
        Run {
            steps,
            radius_minus_one: Measured {
                value: radius_minus_one,
                rounding: (relative / n + coefficients) * (1.0 + radius_minus_one),
            },
            phase_error,
        }
    }
}

/// The matrix of `steps` steps, by simulation from the two unit vectors; none if its products leave
/// the range of `f64`.
fn fundamental(
    integrator: impl Integrator,
    oscillator: Oscillator<f64>,
    dt: f64,
    steps: u64,
) -> Result<Option<UpdateMatrix<f64>>, StudyError> {
    let run = |q: f64, v: f64| -> Result<Option<State<f64, 1>>, StudyError> {
        let start = State { q: [q], v: [v] };
        let mut simulator =
            Simulator::new(Model::<1>::on::<f64>(&oscillator), integrator, start, dt)?;
        // Leaving the range is a result, not a failure.
        let finished = simulator.run(steps, &mut ()).is_ok();
        Ok(Some(simulator.sample().state).filter(|_| finished))
    };
    let columns = run(1.0, 0.0)?.zip(run(0.0, 1.0)?);
    let matrix = columns.map(|(dq, dv)| UpdateMatrix { dq, dv });
    let measurable = |m: &UpdateMatrix<f64>| {
        let products = [m.entry(0, 0) * m.entry(1, 1), m.entry(0, 1) * m.entry(1, 0)];
        let squares = [m.trace() * m.trace(), (m.entry(0, 0) - m.entry(1, 1)).powi(2)];
        products.iter().chain(&squares).all(|x| x.is_finite())
    };
    Ok(matrix.filter(measurable))
}

/// The defects of one step as `f64` arithmetic has them, and the rounding that they may carry.
pub(super) fn defects(
    method: Method,
    oscillator: Oscillator<f64>,
    dt: f64,
) -> (Measured, Measured) {
    with_method!(method, |m| {
        let step = UpdateMatrix::<f64>::from_map(|e| m.step(&oscillator, e, dt));
        let back = UpdateMatrix::from_map(|e| m.step(&oscillator, e, -dt));
        let largest = step.rows().concat().iter().fold(1.0_f64, |a, x| a.max(x.abs()));
        // An entry carries a few roundings of its own size in each substep, and a defect sums products
        // of two.
        let rounding = 40.0 * substeps(method) as f64 * U * largest * largest;
        let measured = |value: f64| Measured { value, rounding };
        (
            measured(step.symplecticity_defect()),
            measured(back.after(&step).distance_from_identity()),
        )
    })
}

/// The largest absolute value of an eigenvalue of a `2 × 2` matrix of floats.
pub(super) fn radius(matrix: &UpdateMatrix<f64>) -> f64 {
    let (half, determinant) = (matrix.trace() / 2.0, matrix.determinant());
    let discriminant = half * half - determinant;
    if discriminant < 0.0 { determinant.sqrt() } else { half.abs() + discriminant.sqrt() }
}

/// One step of `method` on a mode `q̈ = −ω²q − γq̇` with eigenvalues `λ, λ̄`, at `Δt = 1`.
pub(super) fn radius_at(method: Method, re: f64, im: f64) -> f64 {
    let mode = libration::system::DampedOscillator { omega2: re * re + im * im, gamma: -2.0 * re };
    with_method!(method, |m| radius(&UpdateMatrix::<f64>::from_map(|e| {
        m.step(&mode, e, f64::one())
    })))
}
