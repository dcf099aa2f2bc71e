//! Process noise.

use libration::State;
use libration::control::WhiteNoise;
use libration::control::clock::{Jittered, Uniform};
use libration::control::controller::StateFeedback;
use libration::ensemble::{All, Execution, Loops, Setup};
use libration::integrator::VelocityVerlet;
use libration::system::{BaselineOnly, Oscillator};

#[test]
fn a_velocity_takes_up_the_intensity_in_a_second_whatever_the_steps() {
    const COUNT: usize = 20_000;
    let free = All(BaselineOnly(Oscillator { omega2: 0.0 }));
    let starts = vec![State { q: [0.0], v: [0.0] }; COUNT];
    for (dt, steps, jitter) in [(0.1, 20, 0.0), (0.01, 200, 0.0), (0.1, 20, 0.4)] {
        let setup = Setup::new(free, VelocityVerlet)
            .clock(Jittered(Uniform(jitter)))
            .disturbance(WhiteNoise(3.0));
        let mut all = Loops::new(setup, dt, 7, [0.0], &starts, Execution::serial()).unwrap();
        all.advance(steps).unwrap();
        let v = all.trajectories().v(0);
        let variance = v.iter().map(|v| v * v).sum::<f64>() / COUNT as f64;
        // Two seconds; four standard errors of a variance.
        let error = 4.0 * (2.0 / COUNT as f64).sqrt();
        assert!((variance / 6.0 - 1.0).abs() < error, "{dt} {jitter}: {variance}");
    }
}

#[test]
fn noise_is_beside_the_command_and_of_none_nothing_is_left() {
    let gains = libration::control::Feedback { position: 3.0, velocity: 1.0 };
    let setup = Setup::new(All(BaselineOnly(Oscillator { omega2: 10.0 })), VelocityVerlet)
        .controller(StateFeedback::to_origin(gains));
    let starts = [State { q: [1.0], v: [0.0] }; 3];
    let run = |intensity: f64| -> State<f64, 1> {
        let setup = setup.disturbance(WhiteNoise(intensity));
        let mut all = Loops::new(setup, 0.1, 7, [0.0], &starts, Execution::serial()).unwrap();
        all.advance(100).unwrap();
        all.state(1).unwrap()
    };
    let mut still = Loops::new(setup, 0.1, 7, [0.0], &starts, Execution::serial()).unwrap();
    still.advance(100).unwrap();
    let still = still.state(1).unwrap();
    assert_eq!(run(0.0), still);
    // What is linear is moved in proportion: twice as far by four times the intensity, but for rounding.
    let [once, twice]: [f64; 2] = [run(1.0), run(4.0)].map(|state| state.q[0] - still.q[0]);
    assert!((twice - 2.0 * once).abs() < 1e-12 && once.abs() > 1e-3, "{once} {twice}");
}

#[test]
fn noise_that_is_none_is_refused() {
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        let setup = Setup::new(All(BaselineOnly(Oscillator { omega2: 10.0 })), VelocityVerlet)
            .disturbance(WhiteNoise(bad));
        let start = [State { q: [1.0], v: [0.0] }];
        let refused = Loops::new(setup, 0.1, 7, [0.0], &start, Execution::serial());
        let error = refused.err().map(|error| error.to_string()).unwrap_or_default();
        assert!(error.contains("the intensity of the noise"), "{bad}: {error}");
    }
}
