//! The growth of simulated loops agrees with their spectral radii.

use libration::analysis::{Imperfections, Plant};
use libration::control::controller::StateFeedback;
use libration::control::delay::Schedule;
use libration::control::{Feedback, Jitter, Latency};
use libration::ensemble::{All, Execution, Loops, Setup};
use libration::integrator::{Exact, Rk4, VelocityVerlet};
use libration::system::{BaselineOnly, Oscillator};
use libration::{Integrator, Method, State};
use proptest::prelude::*;

use super::single_loop::One;

const ORIGIN: State<f64, 1> = State { q: [0.0], v: [0.0] };

/// By how much `ln |y|` of a simulated loop changes a step, from two long windows; ±1 if it leaves the floats.
fn growth(
    method: impl Integrator,
    omega2: f64,
    dt: f64,
    feedback: Feedback,
    latency: Latency,
) -> f64 {
    const STEPS: u32 = 20_000;
    let state = State { q: [1.0], v: [0.3] };
    let setup = Setup::new(All(BaselineOnly(Oscillator { omega2 })), method)
        .controller(StateFeedback::to_origin(feedback))
        .delay(Schedule::late(latency));
    let mut all = Loops::new(setup, dt, 0, [0.0], &[state], Execution::serial()).unwrap();
    // Phases matter less than 1/STEPS.
    let mut sizes = [0.0_f64; 2];
    for size in &mut sizes {
        for _ in 0..STEPS / 2 {
            all.advance(1).unwrap();
            let State { q: [q], v: [v] } = all.state(0).unwrap();
            let now = (omega2 * q * q + v * v).ln() / 2.0;
            if !now.is_finite() || now.abs() > 600.0 {
                return now.signum() * if now.is_nan() { -1.0 } else { 1.0 };
            }
            *size += now;
        }
    }
    // The windows lie STEPS/2 apart.
    (sizes[1] - sizes[0]) / f64::from(STEPS / 2) / f64::from(STEPS / 2)
}

/// What a step of a loop makes of a unit of everything that it knows.
fn map(method: Method, omega2: f64, dt: f64, feedback: Feedback, latency: Latency) -> DMatrix {
    let begin = State { q: [0.0], v: [0.0] };
    let size = One::new(omega2, Rk4, feedback, latency, begin).known().len();
    let columns: Vec<Vec<f64>> = (0..size)
        .map(|j| {
            let mut one = One::new(omega2, method, feedback, latency, begin);
            one.set((0..size).map(|i| f64::from(u8::from(i == j))).collect());
            one.step(dt);
            one.known()
        })
        .collect();
    DMatrix((0..size).map(|i| (0..size).map(|j| columns[j][i]).collect()).collect())
}

/// The rate at which powers of a matrix grow, squared 45 times (I. Gelfand, 1941).
fn rate(mut power: DMatrix) -> f64 {
    let (mut log, mut steps) = (0.0, 1.0);
    for _ in 0..45 {
        let norm = power.norm();
        power = power.scaled(1.0 / norm).squared();
        log = 2.0 * (log + norm.ln());
        steps *= 2.0;
    }
    (log + power.norm().ln()) / steps
}

/// A square matrix, row by row.
struct DMatrix(Vec<Vec<f64>>);

impl DMatrix {
    fn norm(&self) -> f64 {
        self.0.iter().flatten().fold(0.0, |most: f64, x| most.max(x.abs()))
    }

    fn scaled(mut self, factor: f64) -> Self {
        self.0.iter_mut().flatten().for_each(|x| *x *= factor);
        self
    }

    fn squared(&self) -> Self {
        let n = self.0.len();
        let entry = |i: usize, j: usize| (0..n).map(|k| self.0[i][k] * self.0[k][j]).sum();
        DMatrix((0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect())
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn a_loop_is_stable_in_simulation_where_its_spectral_radius_says_so(
        omega2 in 0.5..20.0_f64,
        dt in 0.005..0.15_f64,
        position in -0.5..15.0_f64,
        velocity in 0.0..4.0_f64,
        whole in 0..12_u32,
        part in prop_oneof![Just(0.0), 0.01..0.99_f64],
        method in prop::sample::select(vec![
            Method::ExplicitEuler, Method::SymplecticEuler, Method::VelocityVerlet, Method::Rk4,
        ]),
    ) {
        let feedback = Feedback { position, velocity };
        let latency = Latency::of_steps(f64::from(whole) + part).unwrap();
        let model = Oscillator { omega2 };
        let plant = Plant::new(method, model, ORIGIN, dt);
        let predicted = plant.spectral_radius(feedback, latency).to_f64().ln();
        let simulated = rate(map(method, omega2, dt, feedback, latency));
        prop_assume!(predicted.abs() > 1e-9);
        prop_assert_eq!(predicted > 0.0, simulated > 0.0, "{} {}", predicted, simulated);
    }
}

#[track_caller]
fn grows_as_its_plant(method: impl Integrator, plant: &Plant<'_>, steps: f64) {
    let feedback = Feedback { position: 0.0, velocity: 1.0 };
    let latency = Latency::of_steps(steps).unwrap();
    let rate = plant.spectral_radius(feedback, latency).to_f64().ln();
    let found = growth(method, 10.0, 0.01, feedback, latency);
    let out_of_range = found.abs() == 1.0;
    // The waves of ln |y| are below one: 1e-4 over ten thousand steps.
    assert!(
        out_of_range && found == rate.signum() || (found - rate).abs() < 1e-4,
        "{steps}: {found} {rate}"
    );
}

#[test]
fn a_simulated_loop_grows_at_the_rate_of_its_spectral_radius() {
    // An analytical test of a delay of whole steps, and of one with a part.
    let plant = Plant::new(VelocityVerlet, Oscillator { omega2: 10.0 }, ORIGIN, 0.01);
    for steps in [0.0, 1.0, 42.0, 100.0, 100.25, 173.5] {
        grows_as_its_plant(VelocityVerlet, &plant, steps);
    }
}

#[test]
fn a_loop_in_exact_steps_grows_as_the_sampled_system_does() {
    let model = Oscillator { omega2: 10.0 };
    let exact = Exact::new::<1>(model, 0.01).unwrap();
    for steps in [0.0, 0.5, 42.25] {
        grows_as_its_plant(exact, &Plant::exact(model, ORIGIN, 0.01), steps);
    }
}

#[test]
fn second_moments_of_a_late_loop_under_jitter_grow_as_those_of_its_simulated_steps() {
    // The mean of M ⊗ M over so many steps of lengths from the middles of equal parts of a uniform law; they miss its integral by
    // their square.
    const PARTS: u32 = 1000;
    let feedback = Feedback { position: 6.0, velocity: 1.0 };
    for method in [Method::SymplecticEuler, Method::VelocityVerlet, Method::Rk4] {
        for (steps, rms) in [(1.0, 0.1), (2.5, 0.3), (0.75, 0.5)] {
            let latency = Latency::of_steps(steps).unwrap();
            let mut sum = Vec::new();
            for i in 0..PARTS {
                let x = (2.0 * f64::from(i) + 1.0) / f64::from(PARTS) - 1.0;
                let dt = 0.1 * (1.0 + 3.0_f64.sqrt() * rms * x);
                let DMatrix(m) = map(method, 10.0, dt, feedback, latency);
                let n = m.len();
                sum.resize(n * n, vec![0.0; n * n]);
                for (row, sums) in sum.iter_mut().enumerate() {
                    for (column, sum) in sums.iter_mut().enumerate() {
                        *sum += m[row / n][column / n] * m[row % n][column % n] / f64::from(PARTS);
                    }
                }
            }
            let model = Oscillator { omega2: 10.0 };
            let plant = Plant::new(method, model, ORIGIN, 0.1);
            let law = Jitter::Uniform(rms);
            let drawn = Imperfections { latency, jitter: law, ..Imperfections::NONE };
            let wanted = plant.mean_square_growth(&feedback.into(), &drawn).unwrap();
            let found = rate(DMatrix(sum));
            assert!((found - wanted).abs() < 1e-6, "{method:?} {steps} {rms}: {found} {wanted}");
        }
    }
}
