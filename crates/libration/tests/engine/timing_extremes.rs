//! Timing of marginal loops, with huge gains, and over long times.

use libration::State;
use libration::analysis::{Imperfections, Plant};
use libration::control::{Feedback, Jitter, Latency};
use libration::integrator::{SymplecticEuler, VelocityVerlet};
use libration::system::Oscillator;

const ORIGIN: State<f64, 1> = State { q: [0.0], v: [0.0] };

#[test]
fn a_loop_on_the_edge_without_latency_has_its_windows_beside_it() {
    // Symplectic Euler under feedback of the position alone keeps areas: on the edge without latency, and stable or not with a
    // little, as the sign of the gain says. The radii are those of matrices in floats, by another program.
    let plant = Plant::new(SymplecticEuler, Oscillator { omega2: 1.0 }, ORIGIN, 0.5);
    let negative = Feedback { position: -0.3, velocity: 0.0 };
    let windows = plant.latency_windows(negative);
    assert!(windows.critical().is_some_and(|d| d > 3.0), "{windows:?}");
    for position in [-0.3, 0.3, -0.8, 0.7] {
        let feedback = Feedback { position, velocity: 0.0 };
        let windows = plant.latency_windows(feedback);
        for d in 1..60 {
            let within = |&(from, to): &(f64, Option<f64>)| {
                f64::from(d) > from && to.is_none_or(|to| f64::from(d) < to)
            };
            let latency = Latency::of_steps(f64::from(d)).unwrap();
            let stable = plant.spectral_radius(feedback, latency).to_f64() < 1.0;
            assert_eq!(windows.stable.iter().any(within), stable, "{position} {d} {windows:?}");
        }
    }
}

#[test]
fn gains_of_any_size_have_the_radius_of_their_matrix() {
    let plant = Plant::new(VelocityVerlet, Oscillator { omega2: 10.0 }, ORIGIN, 0.1);
    for gain in [1e10, 1e20, 1e30, 1e50] {
        let feedback = Feedback { position: gain, velocity: gain };
        let none = plant.spectral_radius(feedback, Latency::NONE).to_f64();
        // Of a large K the trace: K_p·Δt²/2 + K_d·Δt(1 − z²/4), z² = 0.1.
        let trace = gain * (0.005 + 0.0975);
        assert!((none / trace - 1.0).abs() < 1e-8, "{gain} {none}");
        // And of one step late λ³ + … + K·…: the root of its size.
        let late = plant.spectral_radius(feedback, Latency::of_steps(1.0).unwrap()).to_f64();
        assert!((late / trace.sqrt() - 1.0).abs() < 0.1, "{gain} {late}");
        assert!(plant.latency_windows(feedback).stable.is_empty());
    }
}

#[test]
fn a_radius_is_exact_where_two_eigenvalues_meet() {
    // Nothing acts: both are 1.
    let free = Plant::new(SymplecticEuler, Oscillator { omega2: 0.0 }, ORIGIN, 0.5);
    for d in [0.0, 1.0, 2.5, 5.0] {
        let latency = Latency::of_steps(d).unwrap();
        let radius = free.spectral_radius(Feedback::default(), latency).to_f64();
        assert!((radius - 1.0).abs() < 1e-15, "{d} {radius}");
    }
    // (λ − ½)², by K_d = (1 − r²)/Δt and K_p = (1 − r)²/Δt².
    let critical = Feedback { position: 1.0, velocity: 1.5 };
    let radius = free.spectral_radius(critical, Latency::NONE).to_f64();
    assert!((radius - 0.5).abs() < 1e-15, "{radius}");
}

#[test]
fn an_ensemble_does_not_come_back_into_phase_however_long_it_runs() {
    let plant = Plant::new(VelocityVerlet, Oscillator { omega2: 10.0 }, ORIGIN, 0.01);
    let start = State { q: [1.0], v: [0.0] };
    let size = |law, steps| {
        let State { q: [q], v: [v] } = plant.asynchronous_mean(&start, law, steps);
        (q * q + v * v / 10.0).sqrt()
    };
    for steps in [30_000, 39_738, 79_477, 1_000_000] {
        assert!(size(Jitter::Gaussian(0.01), steps) < 1e-12, "{steps}");
        // |sin y/y| with y = √3·σ·nθ'; the angle of a Verlet step rises by ωΔt but for z²/8.
        let y = 3.0_f64.sqrt() * 0.01 * steps as f64 * 10.0_f64.sqrt() * 0.01 * (1.0 + 1e-3 / 8.0);
        let (found, wanted) = (size(Jitter::Uniform(0.01), steps), (y.sin() / y).abs());
        // The next term of the angle, z⁴ of it, and how far its slope is from its value at the ends of the law.
        assert!((found - wanted).abs() < 1e-3, "{steps}: {found} {wanted}");
    }
}

#[test]
fn second_moments_of_exact_steps_are_those_of_a_quadrature_where_powers_do_not_settle() {
    let plant = Plant::exact(Oscillator { omega2: 10.0 }, ORIGIN, 1.0);
    let feedback = Feedback { position: 0.3, velocity: 0.2 };
    // By another program, in floats.
    for (rms, wanted) in [(1.0, 1.026_280_864), (2.0, 1.020_791)] {
        let law = Jitter::Gaussian(rms);
        let found = plant.mean_square(feedback, law).radius.to_f64();
        assert!((found / wanted - 1.0).abs() < 1e-6, "{rms} {found}");
        let drawn = Imperfections { jitter: law, ..Imperfections::NONE };
        let late = plant.mean_square_growth(&feedback.into(), &drawn).unwrap().exp();
        assert!((late / found - 1.0).abs() < 1e-10, "{rms} {late} {found}");
    }
    // And where an interpolation misses whole turns.
    let feedback = Feedback { position: 1.0, velocity: 0.1 };
    for (dt, wanted) in
        [(3.0, 1.132_565_988_878_039_3), (10.0, 1.111_541_510_673_539), (30.0, 1.111_541_501_517)]
    {
        let plant = Plant::exact(Oscillator { omega2: 10.0 }, ORIGIN, dt);
        let found = plant.mean_square(feedback, Jitter::Gaussian(0.2)).radius.to_f64();
        assert!((found / wanted - 1.0).abs() < 1e-11, "{dt} {found}");
    }
}
