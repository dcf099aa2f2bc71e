//! Modes of a linear plant under steps of an integrator.

use core::f64::consts::{PI, TAU};

use libration_core::Float;
use libration_linear::{Matrix, eigenvalues, eigenvector};
use num_complex::Complex64;

use super::{LinearStepper, StabilityFunction, StepOn};

/// A mode of a linear plant under steps of one length.
#[derive(Clone, Debug, PartialEq)]
pub struct StepMode {
    /// Its eigenvalue in 1/s; of a pair the upper one.
    pub value: Complex64,
    /// The time step in s.
    pub dt: f64,
    /// The factor by which a step multiplies the mode.
    pub multiplier: Complex64,
    /// The states that a step multiplies by it, as an eigenvector.
    pub shape: Vec<Complex64>,
}

/// An eigenvalue of the state matrix with its eigenvector; of a pair the upper one.
type Mode = (Complex64, Vec<Complex64>);

/// Logarithm of the factor by which the roundings of faster growing modes may rise in a simulation, and of the range of a simulation.
const MOST_POLLUTION: f64 = 2.0;
const MOST_RANGE: f64 = 40.0;

/// Relative difference of the sizes of a pair of multipliers above which a step has parted it; below it is rounding.
const PARTED: f64 = 1e-9;

impl StepMode {
    /// The modes under exact steps: each is multiplied by `e^{λh}`.
    pub fn exact(modes: &[Mode], dt: f64) -> Vec<StepMode> {
        StepMode::multiplied(modes, dt, Complex64::exp)
    }

    /// The modes under steps with this stability function, which have the eigenvectors of the plant.
    pub fn of_function(function: &StabilityFunction, modes: &[Mode], dt: f64) -> Vec<StepMode> {
        StepMode::multiplied(modes, dt, |z| function.at(z))
    }

    fn multiplied(modes: &[Mode], dt: f64, by: impl Fn(Complex64) -> Complex64) -> Vec<StepMode> {
        let of = |(value, shape): &Mode| StepMode {
            value: *value,
            dt,
            multiplier: by(*value * dt),
            shape: shape.clone(),
        };
        modes.iter().map(of).collect()
    }

    /// The modes under steps with this update matrix; none if it is not finite.
    ///
    /// Each eigenvector of the matrix belongs to the mode whose positions have the most similar shape (modal assurance criterion: R. J.
    /// Allemang, D. L. Brown, 1982), and of equal shapes to that with the nearest multiplier. Of a pair that a step parts into two
    /// real multipliers the larger one counts.
    pub fn of_matrix(
        stepper: &LinearStepper,
        matrix: &Matrix,
        modes: &[Mode],
        dt: f64,
    ) -> Option<Vec<StepMode>> {
        let vector = |value| Some((value, eigenvector(matrix, value)?));
        let upper = eigenvalues(matrix)?.into_iter().filter(|value| value.im >= 0.0);
        let of_step = both(&upper.map(vector).collect::<Option<Vec<Mode>>>()?);
        let exact = both(modes);
        let places = stepper.shape_states();
        let mut costs = Vec::new();
        for (i, (value, shape)) in exact.iter().enumerate() {
            let wanted = (value * dt).exp();
            for (j, (multiplier, other)) in of_step.iter().enumerate() {
                let apart = (multiplier - wanted).norm();
                // Rounding must not decide between equal shapes.
                let near = 1e-3 * apart / (1.0 + apart);
                costs.push((1.0 - similarity(shape, other, places) + near, i, j));
            }
        }
        costs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut partner: Vec<Option<usize>> = vec![None; exact.len()];
        let mut taken = vec![false; of_step.len()];
        for (_, i, j) in costs {
            if partner[i].is_none() && !taken[j] {
                (partner[i], taken[j]) = (Some(j), true);
            }
        }
        // A pair stands in `exact` as two neighbours, the upper one first.
        let mut found = Vec::new();
        for (i, (value, _)) in exact.iter().enumerate().filter(|(_, (value, _))| value.im >= 0.0) {
            let own = if value.im > 0.0 { &partner[i..=i + 1] } else { &partner[i..=i] };
            let mut of_own = own.iter().flatten().map(|&j| &of_step[j]);
            let first = of_own.next()?;
            let larger = of_own.find(|other| other.0.norm() > (1.0 + PARTED) * first.0.norm());
            let (multiplier, shape) = larger.unwrap_or(first).clone();
            found.push(StepMode { value: *value, dt, multiplier, shape });
        }
        Some(found)
    }

    /// The factor by which the mode grows in an exact step.
    pub fn exact_growth(&self) -> f64 {
        (self.value.re * self.dt).exp()
    }

    /// The angle in rad by which the mode turns in an exact step.
    pub fn exact_angle(&self) -> f64 {
        self.value.im * self.dt
    }

    /// The rate in 1/s by which the mode grows faster than in exact steps.
    pub fn growth_error(&self) -> f64 {
        self.multiplier.norm().ln() / self.dt - self.value.re
    }

    /// The angle in rad by which a step turns the mode further than an exact one; of those that differ by whole turns the smallest.
    pub fn phase_error(&self) -> f64 {
        nearest_zero(self.multiplier.arg() - self.exact_angle())
    }

    /// The multiplier per step of a simulation with these steps from the shape of the mode, by at most `most` steps, and their number.
    ///
    /// It is the projection of the last state on the first. There are fewer steps if the mode decays so fast that rounding errors of
    /// others would show. None if the simulation is not finite.
    pub fn simulated<S: Float>(
        &self,
        step: &StepOn<'_, S>,
        radius: f64,
        most: u32,
    ) -> Option<(Complex64, u32)> {
        let growth = self.multiplier.norm().ln();
        let slower = (radius.ln() - growth).max(0.0);
        let longest = (MOST_POLLUTION / slower).min(MOST_RANGE / growth.abs());
        let count = longest.clamp(1.0, f64::from(most)) as u32;
        let is_real = self.shape.iter().all(|x| x.im == 0.0);
        let mut re: Vec<f64> = self.shape.iter().map(|x| x.re).collect();
        let mut im: Vec<f64> = self.shape.iter().map(|x| x.im).collect();
        let amplitude = |re: &[f64], im: &[f64]| -> Complex64 {
            let parts = re.iter().zip(im).map(|(&re, &im)| Complex64::new(re, im));
            self.shape.iter().zip(parts).map(|(own, x)| own.conj() * x).sum()
        };
        let first = amplitude(&re, &im);
        let (mut last, mut angle) = (first, 0.0);
        for _ in 0..count {
            re = step.step(&re);
            if !is_real {
                im = step.step(&im);
            }
            let next = amplitude(&re, &im);
            angle += (next / last).arg();
            last = next;
        }
        let steps = f64::from(count);
        let growth = (last.norm() / first.norm()).powf(steps.recip());
        let mean = Complex64::from_polar(growth, angle / steps);
        (mean.re.is_finite() && mean.im.is_finite()).then_some((mean, count))
    }
}

/// An angle less the whole turns in it, from −π to π.
fn nearest_zero(angle: f64) -> f64 {
    let rest = angle - TAU * (angle / TAU).round();
    rest.clamp(-PI, PI)
}

/// The modes and the lower ones of their pairs.
fn both(upper: &[Mode]) -> Vec<Mode> {
    let mut all = Vec::new();
    for (value, shape) in upper {
        all.push((*value, shape.clone()));
        if value.im > 0.0 {
            all.push((value.conj(), shape.iter().map(Complex64::conj).collect()));
        }
    }
    all
}

/// The modal assurance criterion of two shapes at these places: 1 for the same shape, 0 for orthogonal ones.
fn similarity(a: &[Complex64], b: &[Complex64], places: &[usize]) -> f64 {
    let inner = |a: &[Complex64], b: &[Complex64]| -> Complex64 {
        places.iter().map(|&i| a[i].conj() * b[i]).sum()
    };
    let sizes = inner(a, a).re * inner(b, b).re;
    if sizes > 0.0 { inner(a, b).norm_sqr() / sizes } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use libration_core::{AnyMethod, ImplicitMethod, Method};

    use super::*;

    /// Three masses between walls, with dampers of other proportions than the springs.
    fn chain() -> Matrix {
        let springs = [[5.0, -2.0, 0.0], [-2.0, 6.0, -4.0], [0.0, -4.0, 9.0]];
        let dampers = [[0.2, 0.0, 0.0], [0.0, 0.1, -0.1], [0.0, -0.1, 0.1]];
        Matrix::from_fn(6, 6, |i, j| match (i < 3, j < 3) {
            (true, _) => f64::from(u8::from(j == i + 3)),
            (false, true) => -springs[i - 3][j],
            (false, false) => -dampers[i - 3][j - 3],
        })
    }

    fn modes(a: &Matrix) -> Vec<Mode> {
        let upper = eigenvalues(a).unwrap().into_iter().filter(|value| value.im >= 0.0);
        upper.map(|value| (value, eigenvector(a, value).unwrap())).collect()
    }

    fn step_modes(a: &Matrix, method: impl Into<AnyMethod>, dt: f64) -> Vec<StepMode> {
        let stepper = LinearStepper::new(a).unwrap();
        let matrix = stepper.with_step::<f64>(method, dt).unwrap().update_matrix();
        StepMode::of_matrix(&stepper, &matrix, &modes(a), dt).unwrap()
    }

    #[test]
    fn errors_of_each_mode_fall_with_the_order_of_the_method() {
        let a = chain();
        for method in AnyMethod::all() {
            let errors = |dt: f64| -> Vec<f64> {
                let of = |mode: &StepMode| mode.growth_error().hypot(mode.phase_error() / dt);
                step_modes(&a, method, dt).iter().map(of).collect()
            };
            // Splittings fall to order 1 or 2 where forces depend on velocities.
            let order = match method {
                AnyMethod::Explicit(Method::Rk4) => 4.0,
                AnyMethod::Implicit(method) => f64::from(method.order()),
                _ => 1.0,
            };
            // With shorter steps the errors of order 6 are roundings.
            let dt = if order == 6.0 { 0.16 } else { 0.02 };
            for (coarse, fine) in errors(dt).iter().zip(errors(0.5 * dt)) {
                assert!((coarse / fine).log2() > order - 0.2, "{method:?} {coarse} {fine}");
                assert!(*coarse < 0.3, "{method:?} {coarse}");
            }
        }
    }

    #[test]
    fn the_matrix_of_a_runge_kutta_step_has_the_multipliers_of_its_stability_function() {
        let a = chain();
        let implicit = [ImplicitMethod::BackwardEuler, ImplicitMethod::Trapezoid];
        let implicit = implicit.map(|method| (AnyMethod::from(method), 0.7));
        let explicit = [(Method::Rk4, 0.7), (Method::ExplicitEuler, 0.3), (Method::Rk4, 1.1)];
        let explicit = explicit.map(|(method, dt)| (AnyMethod::from(method), dt));
        for (method, dt) in explicit.into_iter().chain(implicit) {
            let function = StabilityFunction::of(method).unwrap();
            let wanted = StepMode::of_function(&function, &modes(&a), dt);
            for (found, wanted) in step_modes(&a, method, dt).iter().zip(&wanted) {
                let off = (found.multiplier - wanted.multiplier).norm();
                // Six by six with entries of about 1.
                assert!(off < 1e-13, "{method:?} {found:?} {wanted:?}");
            }
        }
    }

    #[test]
    fn undamped_modes_under_verlet_turn_by_the_arcsine_also_near_the_limit() {
        // Modes of 1, √3, … rad/s of three equal masses and springs: sin(φ/2) = ωh/2.
        let a = Matrix::from_fn(6, 6, |i, j| match (i < 3, j < 3) {
            (true, _) => f64::from(u8::from(j == i + 3)),
            (false, true) => [-2.0, 1.0, 0.0][(i - 3).abs_diff(j)],
            (false, false) => 0.0,
        });
        let dt = 1.05;
        for mode in step_modes(&a, Method::VelocityVerlet, dt) {
            let wanted = 2.0 * (0.5 * mode.value.im * dt).asin();
            assert!((mode.multiplier.arg() - wanted).abs() < 1e-13, "{mode:?}");
            assert!((mode.multiplier.norm() - 1.0).abs() < 1e-14, "{mode:?}");
        }
    }

    #[test]
    fn a_simulation_measures_the_multiplier_of_each_mode() {
        let a = chain();
        let stepper = LinearStepper::new(&a).unwrap();
        for method in AnyMethod::all() {
            let dt = 0.2;
            let all = step_modes(&a, method, dt);
            let radius = all.iter().map(|mode| mode.multiplier.norm()).fold(0.0, f64::max);
            let step = stepper.with_step::<f64>(method, dt).unwrap();
            let single = stepper.with_step::<f32>(method, dt).unwrap();
            for mode in all {
                let (found, steps) = mode.simulated(&step, radius, 1000).unwrap();
                // Backward Euler parts the modes so fast that the slower one is lost after six steps.
                assert!(steps >= 5, "{steps}");
                assert!((found - mode.multiplier).norm() < 1e-13, "{method:?} {found} {mode:?}");
                let (found, _) = mode.simulated(&single, radius, 1000).unwrap();
                let off = (found - mode.multiplier).norm();
                // Roundings of 2⁻²⁴, of the matrix too.
                assert!(off > 1e-12 && off < 2e-6, "{method:?} {found} {mode:?}");
            }
        }
    }
}
