//! Windows of stable latencies against the eigenvalues of whole period matrices.

#![allow(clippy::unwrap_used)]

use libration_core::control::Latency;
use libration_linear::{
    Channels, DiscreteController, LinearLoop, LinearLoopError, LinearPlant, Matrix, eigenvalues,
    is_schur_stable,
};
use num_complex::Complex64;

/// Random numbers of a fixed sequence, from −1 to 1.
fn numbers(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / (1_u64 << 30) as f64 - 1.0
    }
}

fn random_loop(seed: u64, direct: bool) -> LinearLoop {
    let mut next = numbers(seed);
    let mut random = |rows: usize, columns: usize, size: f64| {
        let mut matrix = Matrix::zeros(rows, columns);
        matrix.entries_mut().iter_mut().for_each(|x| *x = size * next());
        matrix
    };
    // Every other plant turns several times within a period.
    let [period, speed] = if seed.is_multiple_of(2) { [0.2, 2.0] } else { [2.5, 4.0] };
    for _ in 0..200 {
        let n = 2 + (seed % 5) as usize;
        let [a, b, c] = [random(n, n, speed), random(n, 2, 1.0), random(2, n, 1.0)];
        let mut a = a;
        (0..n).for_each(|i| a[(i, i)] -= 0.5 * speed);
        let d = random(2, 2, if direct { 0.3 } else { 0.0 });
        let plant = LinearPlant::new(a, b, c, d).unwrap();
        let controller = DiscreteController::gain(random(2, 2, 2.0));
        let cost = Matrix::identity(n + 2);
        let linear = LinearLoop::new(plant, controller, period, cost, vec![0.0; 2]).unwrap();
        if is_schur_stable(&linear.period_matrix(&linear.ideal()).unwrap()) {
            return linear;
        }
    }
    panic!("no stable loop");
}

fn at(linear: &LinearLoop, channels: &Channels, latency: f64) -> Matrix {
    let mut timing = linear.ideal();
    let latency = Latency::of_steps(latency).unwrap();
    match channels {
        Channels::Inputs(all) => all.iter().for_each(|&i| timing.input_latency[i] = latency),
        Channels::Outputs(all) => all.iter().for_each(|&j| timing.output_latency[j] = latency),
    }
    linear.period_matrix(&timing).unwrap()
}

#[test]
fn windows_are_where_the_spectral_radius_of_the_whole_matrix_is_below_one() {
    let mut ends = 0;
    for seed in 0..60 {
        let linear = random_loop(seed, seed % 3 == 0);
        for channels in [Channels::Inputs(vec![0]), Channels::Outputs(vec![1])] {
            let windows = linear.latency_windows(&linear.ideal(), &channels, [12.0, 12.0]).unwrap();
            let inside = |latency: f64| {
                windows.iter().any(|window| {
                    window.from <= latency && window.to.is_none_or(|to| latency <= to)
                })
            };
            let ends_near = |latency: f64| {
                let near = |end: f64| (end - latency).abs() < 1e-4;
                windows.iter().any(|w| near(w.from) || w.to.is_some_and(near))
            };
            for i in 0..240 {
                let latency = 0.05 * f64::from(i) + 1e-3;
                if ends_near(latency) {
                    continue;
                }
                let stable = is_schur_stable(&at(&linear, &channels, latency));
                assert_eq!(inside(latency), stable, "{seed} {channels:?} {latency}: {windows:?}");
            }
            for window in &windows {
                if let (Some(to), Some(angle)) = (window.to, window.angle) {
                    ends += 1;
                    let matrix = at(&linear, &channels, to);
                    let value = eigenvalues(&matrix)
                        .unwrap()
                        .into_iter()
                        .min_by(|a, b| {
                            let off =
                                |v: &Complex64| (v - Complex64::from_polar(1.0, angle)).norm();
                            off(a).total_cmp(&off(b))
                        })
                        .unwrap();
                    // Of a simple eigenvalue of a matrix of norm 10.
                    assert!(
                        (value - Complex64::from_polar(1.0, angle)).norm() < 1e-9,
                        "{seed} {to}: {value}"
                    );
                }
            }
        }
    }
    assert!(ends > 40, "{ends}");
}

/// A loop around the plant with one input and these matrices, sampled or not.
fn loop_of(
    a: &[Vec<f64>],
    b: &[f64],
    sampling: Option<f64>,
    gain: &[f64],
    period: f64,
) -> LinearLoop {
    let n = a.len();
    let columns: Vec<[f64; 1]> = b.iter().map(|x| [*x]).collect();
    let [a, b] = [Matrix::from_rows(a), Matrix::from_rows(&columns)].map(Option::unwrap);
    let mut plant = LinearPlant::new(a, b, Matrix::identity(n), Matrix::zeros(n, 1)).unwrap();
    plant.sampling_period = sampling;
    let commands: Vec<f64> = gain.iter().map(|k| -k).collect();
    let controller = DiscreteController::gain(Matrix::from_rows(&[commands]).unwrap());
    let cost = Matrix::identity(n + 1);
    LinearLoop::new(plant, controller, period, cost, vec![0.0; n]).unwrap()
}

/// An open loop with an eigenvalue at −1, ±i or 1 has a pole there on the unit circle, where its response is no number.
#[test]
fn an_open_loop_with_poles_on_the_unit_circle_has_windows() {
    for (a, b, gain) in [
        (vec![vec![0.5, 0.0], vec![0.0, -1.0]], [1.0, 1.0], [0.05, -0.4]),
        (vec![vec![-1.0, 0.0], vec![0.0, 1.0]], [1.0, 1.0], [-0.3, 0.2]),
        (vec![vec![0.0, -1.0], vec![1.0, 0.0]], [1.0, 0.0], [0.1, 0.3]),
        (vec![vec![-1.0, 1.0], vec![0.0, -1.0]], [0.0, 1.0], [0.2, -0.5]),
    ] {
        let linear = loop_of(&a, &b, Some(0.1), &gain, 0.1);
        let channels = Channels::Inputs(vec![0]);
        let windows = linear.latency_windows(&linear.ideal(), &channels, [12.0, 12.0]).unwrap();
        for whole in 0..12 {
            let latency = f64::from(whole);
            let inside = windows
                .iter()
                .any(|window| window.from <= latency && window.to.is_none_or(|to| latency <= to));
            let stable = is_schur_stable(&at(&linear, &channels, latency));
            assert_eq!(inside, stable, "{a:?} {gain:?} {latency}: {windows:?}");
        }
    }
}

/// `s − 1` in a period of 28 s: the plant grows by `e²⁸`, and all of its response but a part of `e⁻²⁸` is on the unit circle.
#[test]
fn a_search_among_roundings_ends() {
    let period = 28.0_f64;
    let gain = period.exp() / period.exp_m1();
    let linear = loop_of(&[vec![1.0]], &[1.0], None, &[gain], period);
    let found = linear.latency_windows(&linear.ideal(), &Channels::Inputs(vec![0]), [160.0; 2]);
    // By hand: the loop is unstable from a latency of about `e⁻ʰ` s on.
    match found {
        Ok(windows) => assert!(windows.iter().all(|w| w.to.is_some_and(|to| to < 1e-9))),
        Err(error) => assert!(matches!(error, LinearLoopError::Search { .. }), "{error}"),
    }
}
