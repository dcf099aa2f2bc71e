//! Plants that only their controller keeps from falling.

use libration::linear::{LinearPlant, Matrix};
use libration_identify::{Hold, KnownPlant, NoiseKind, Recording, Request, ResponseKind};

use crate::loops::{Draws, identified, quick, value};

const PERIOD: f64 = 0.01;
const DEAD_TIME: f64 = 0.0234;
const GAIN: f64 = 1.2;

/// A pendulum `ÿ = 9 (y + K u(t − τ) / 9)` that stands upright under a controller with a moving reference, by its closed form.
fn balanced(seed: u64) -> Recording {
    let mut draws = Draws(seed);
    let (mut times, mut commands, mut responses) = (Vec::new(), Vec::new(), Vec::new());
    let (mut y, mut v, mut reference) = (0.05_f64, 0.0_f64, 0.0);
    for k in 0..1200 {
        times.push(f64::from(k) * PERIOD);
        responses.push(y + 0.002 * draws.normal());
        if k % 20 == 0 {
            reference = 10.0 * draws.uniform();
        }
        commands.push(-30.0 * y - 8.0 * v + reference + 0.1 * draws.normal());
        // 23.4 ms are two periods and 3.4 ms of another.
        let earlier = |back: usize| {
            commands.len().checked_sub(1 + back).map_or(0.0, |place: usize| commands[place])
        };
        for (command, h) in [(earlier(3), 0.0034), (earlier(2), PERIOD - 0.0034)] {
            let rest = y + GAIN * command / 9.0;
            let (sinh, cosh) = ((3.0 * h).sinh(), (3.0 * h).cosh());
            (y, v) =
                (rest * cosh + v / 3.0 * sinh - GAIN * command / 9.0, 3.0 * rest * sinh + v * cosh);
        }
    }
    Recording::new(&times, &commands, &times, &responses).expect("a valid recording")
}

#[test]
fn the_dead_time_of_a_balanced_pendulum_is_found_through_its_closed_loop() {
    let recording = balanced(41);
    let matrix = |rows: &[[f64; 2]]| Matrix::from_fn(rows.len(), 2, |i, j| rows[i][j]);
    let plant = LinearPlant::new(
        matrix(&[[0.0, 1.0], [9.0, 0.0]]),
        Matrix::from_fn(2, 1, |i, _| i as f64),
        matrix(&[[1.0, 0.0]]),
        Matrix::zeros(1, 1),
    )
    .expect("a plant");
    let plant = KnownPlant::new(&plant, 0, 0).expect("a channel");
    let responses = vec![ResponseKind::Plant(Box::new(plant))];
    let request =
        Request { responses, lag: Some(0.0), arrivals: false, holds: vec![Hold::Zero], ..quick() };
    let found = identified(&recording, &request);
    assert_eq!(found.noise, NoiseKind::Disturbance, "{}", found.answer);
    let dead_time = found.parameter("dead_time").expect("a dead time");
    let interval = dead_time.interval.expect("an interval");
    // Within a tenth of a period of the controller.
    assert!((dead_time.value - DEAD_TIME).abs() < 1e-3, "{dead_time:?}");
    assert!(interval.high.is_some_and(|high| high - interval.low < 1.5e-3), "{dead_time:?}");
    // The gain is known from how the pendulum falls: to a part in a hundred.
    assert!((value(&found, "gain") / GAIN - 1.0).abs() < 0.01, "{}", found.answer);
}
