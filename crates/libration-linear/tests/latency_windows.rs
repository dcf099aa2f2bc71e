//! Windows of stable latencies against the eigenvalues of whole period matrices.

#![allow(clippy::unwrap_used)]

use libration_core::control::Latency;
use libration_linear::{
    Channels, DiscreteController, LinearLoop, LinearPlant, Matrix, eigenvalues, is_schur_stable,
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
