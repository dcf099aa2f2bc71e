//! Statistics of clocks.

use libration::State;
use libration::control::clock::{
    Correlated, Drifting, Gaussian, Jittered, LateTicks, MissedTicks, RandomWalk, Rates, Recorded,
    Sinusoidal, Skewed, Uniform,
};
use libration::control::controller::OpenLoop;
use libration::control::{Clock, Jitter};
use libration::ensemble::{All, Execution, Loops, Setup};
use libration::integrator::SymplecticEuler;
use libration::system::{BaselineOnly, Oscillator};

use super::any_clock::AnyClock;

/// What moves freely in the steps of a clock.
pub(crate) fn free(
    clock: AnyClock<'_>,
) -> Setup<All<BaselineOnly<Oscillator<f64>>>, SymplecticEuler, OpenLoop, AnyClock<'_>> {
    Setup::new(All(BaselineOnly(Oscillator { omega2: 0.0 })), SymplecticEuler).clock(clock)
}

/// The steps of some trajectories, in multiples of `Δt`: what moves freely goes as far as time does.
fn ratios(clock: impl Clock<f64>, trajectories: usize, steps: usize) -> Vec<Vec<f64>> {
    ratios_of(AnyClock(&clock), trajectories, steps)
}

fn ratios_of(clock: AnyClock<'_>, trajectories: usize, steps: usize) -> Vec<Vec<f64>> {
    let setup = free(clock);
    let starts = vec![State { q: [0.0], v: [1.0] }; trajectories];
    let mut all = Loops::new(setup, 1.0, 77, [0.0], &starts, Execution::serial()).unwrap();
    let mut last = vec![0.0; trajectories];
    let mut steps_of = vec![Vec::with_capacity(steps); trajectories];
    for _ in 0..steps {
        all.advance(1).unwrap();
        for (n, last) in last.iter_mut().enumerate() {
            let now = all.state(n).unwrap().q[0];
            steps_of[n].push(now - *last);
            *last = now;
        }
    }
    steps_of
}

/// The mean of the products of `ε` with itself `lag` steps later, over all trajectories.
fn correlation(steps: &[Vec<f64>], lag: usize) -> f64 {
    let products = steps
        .iter()
        .flat_map(|one| one.iter().zip(&one[lag..]).map(|(a, b)| (a - 1.0) * (b - 1.0)));
    let (count, sum) = products.fold((0.0, 0.0), |(count, sum), x| (count + 1.0, sum + x));
    sum / count
}

/// Rounding of times below 1000, and of their differences.
const ROUNDING: f64 = 1e-12;

#[test]
fn jitter_has_the_variance_it_says_and_no_memory() {
    // 2¹⁵ draws: a variance of σ² is known to √(2/n) = 0.8 % for a Gaussian; four times that, and more than for a uniform law.
    let gaussian = ratios(Jittered(Gaussian(0.1)), 64, 512);
    let uniform = ratios(Jittered(Uniform(0.1)), 64, 512);
    for steps in [&gaussian, &uniform] {
        assert!((correlation(steps, 0) / 0.01 - 1.0).abs() < 0.032);
        assert!(correlation(steps, 1).abs() < 4.0 * 0.01 / 32_768_f64.sqrt());
    }
    let widest = uniform.iter().flatten().map(|x| (x - 1.0).abs()).fold(0.0, f64::max);
    assert!(widest <= 0.1 * 3.0_f64.sqrt() + ROUNDING && widest > 0.17);
}

#[test]
fn no_step_is_negative_however_wild_the_noise() {
    let steps = ratios(Jittered(Gaussian(3.0)), 4, 500).concat();
    assert!(steps.iter().all(|&dt| dt >= 0.0));
    // ε < −1 is 0.369 of all draws at three deviations; 2000 of them know that to 0.011.
    let none = steps.iter().filter(|&&dt| dt == 0.0).count() as f64 / 2000.0;
    assert!((none - 0.369).abs() < 0.044, "{none}");
}

#[test]
fn correlated_jitter_forgets_at_the_rate_it_says_and_is_stationary_from_the_start() {
    let steps = ratios(Correlated { rms: 0.1, correlation: 0.8 }, 256, 256);
    // Each trajectory holds some 256·(1 − φ)/(1 + φ) = 28 independent draws: 7000 in all, √(2/7000) = 1.7 %; three times that.
    for lag in [0, 1, 2, 5] {
        let wanted = 0.01 * 0.8_f64.powi(lag as i32);
        let found = correlation(&steps, lag);
        assert!((found - wanted).abs() < 0.05 * 0.01, "{lag}: {found} {wanted}");
    }
    let first: Vec<Vec<f64>> = steps.iter().map(|one| vec![one[0]]).collect();
    // 256 draws: √(2/256) = 9 %.
    assert!((correlation(&first, 0) / 0.01 - 1.0).abs() < 0.27);
}

#[test]
fn a_wandering_clock_is_a_random_walk_and_a_drifting_one_a_straight_line() {
    let steps = ratios(RandomWalk { rms: 0.001 }, 512, 400);
    for after in [100, 399] {
        let squares: f64 = steps.iter().map(|one| (one[after] - 1.0).powi(2)).sum();
        let wanted = 512.0 * after as f64 * 1e-6;
        // √(2/512) = 6 %; three times that.
        assert!((squares / wanted - 1.0).abs() < 0.19, "{after}");
    }
    for one in ratios(Drifting(Jitter::Gaussian(1e-4)), 3, 200) {
        let slope = (one[199] - one[0]) / 199.0;
        assert!(slope != 0.0 && (one[100] - 1.0 - 100.0 * slope).abs() < ROUNDING);
    }
}

#[test]
fn asynchronous_clocks_keep_their_rates() {
    let skewed = ratios(Skewed(Jitter::Uniform(0.1)), 3, 10);
    for one in &skewed {
        assert!(one.iter().all(|dt| (dt - one[0]).abs() < ROUNDING));
        assert!((one[0] - 1.0).abs() <= 0.1 * 3.0_f64.sqrt());
    }
    assert!(skewed[0][0] != skewed[1][0] && skewed[1][0] != skewed[2][0]);
    let listed = ratios(Rates(&[1.0, 0.5, 2.0]), 3, 4);
    assert_eq!(listed, [vec![1.0; 4], vec![0.5; 4], vec![2.0; 4]]);
}

#[test]
fn a_waving_clock_swings_at_its_rate_with_its_rms() {
    let rate = std::f64::consts::TAU / 8.0;
    let steps = &ratios(Sinusoidal { rms: 0.1, rate, phase: 0.5 }, 1, 16)[0];
    for (n, dt) in steps.iter().enumerate() {
        let wanted = 1.0 + 0.1 * 2.0_f64.sqrt() * (rate * n as f64 + 0.5).sin();
        assert!((dt - wanted).abs() < ROUNDING, "{n}: {dt} {wanted}");
    }
}

#[test]
fn time_that_is_missed_is_made_up_for() {
    let steps = ratios(MissedTicks { probability: 0.3 }, 16, 500);
    let missed = steps.iter().flatten().filter(|&&dt| dt == 0.0).count() as f64 / 8000.0;
    // √(0.3·0.7/8000) = 0.005; four times that.
    assert!((missed - 0.3).abs() < 0.021, "{missed}");
    for one in &steps {
        let (mut time, mut run) = (0.0, 0.0);
        for (n, &dt) in one.iter().enumerate() {
            run += 1.0;
            time += dt;
            // A step after k missed ones is 1 + k long, and time is what it would be.
            if dt > 0.0 {
                assert_eq!((dt, time), (run, (n + 1) as f64));
                run = 0.0;
            }
        }
    }
}

#[test]
fn a_late_tick_is_not_passed_on() {
    for one in ratios(LateTicks { probability: 0.3, by: 0.25 }, 8, 200) {
        let mut time = 0.0;
        for (n, dt) in one.iter().enumerate() {
            assert!([0.75, 1.0, 1.25].contains(dt));
            time += dt;
            // Never more than one lateness from where it should be, at either end.
            assert!((time - (n + 1) as f64).abs() <= 0.25);
        }
    }
}

#[test]
fn recorded_steps_are_those_between_the_stamps() {
    let (steps, mean) = Recorded::steps_between(&[10.0, 10.5, 10.5, 13.0]).unwrap();
    assert_eq!((&steps[..], mean), (&[0.5, 0.0, 2.5][..], 1.0));
    assert_eq!(ratios(Recorded::once(&steps), 2, 3)[1], steps);
    let twice = ratios(Recorded::repeated(&steps), 1, 6);
    assert_eq!(twice[0], [0.5, 0.0, 2.5, 0.5, 0.0, 2.5]);
}

#[test]
fn two_clocks_in_a_pair_are_one_whose_steps_are_products() {
    let steps = [0.5, 2.0, 1.0, 3.0];
    let pair = ratios((Rates(&[2.0]), Recorded::once(&steps)), 1, 4);
    assert_eq!(pair[0], [1.0, 4.0, 2.0, 6.0]);
}

#[test]
fn the_halves_of_a_pair_have_nothing_to_do_with_each_other() {
    let pair = (Skewed(Jitter::Gaussian(0.1)), Skewed(Jitter::Gaussian(0.1)));
    let steps = ratios(pair, 2000, 1).concat();
    let mean = steps.iter().sum::<f64>() / 2000.0;
    let variance = steps.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / 2000.0;
    // Of a product of independent rates σ² twice, and 0.04 of equal ones; √(2/2000) = 3 %, four times that.
    assert!((mean - 1.0).abs() < 0.0127 && (variance / 0.0201 - 1.0).abs() < 0.13, "{variance}");
}

#[test]
fn what_begins_again_does_not_begin_alike() {
    let clock = Correlated { rms: 0.1, correlation: 0.9 };
    let setup = free(AnyClock(&clock));
    let start = State { q: [0.0], v: [1.0] };
    let mut all = Loops::new(setup, 1.0, 77, [0.0], &[start; 3], Execution::serial()).unwrap();
    let mut first = Vec::new();
    for _ in 0..4 {
        all.reset(1, start);
        let step = all.step();
        all.advance(10).unwrap();
        // The same as of any trajectory of that number that is reset at that step.
        let other = [start; 2];
        let mut again = Loops::new(setup, 1.0, 77, [0.0], &other, Execution::serial()).unwrap();
        again.advance(step).unwrap();
        again.reset(1, start);
        again.advance(10).unwrap();
        assert_eq!(again.state(1), all.state(1));
        first.push(f64::to_bits(all.state(1).unwrap().q[0]));
    }
    first.dedup();
    assert_eq!(first.len(), 4);
}
