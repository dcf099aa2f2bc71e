//! Observers of an ensemble agree with those of single trajectories, for every execution.

use libration::ensemble::{
    All, Copies, Drift, Execution, InstructionSet, MeanSquareError, Moments, PerTrajectory,
};
use libration::integrator::VelocityVerlet;
use libration::system::Pendulum;
use libration::{Ensemble, Hamiltonian, Integrator, State};

/// More than one chunk, and an awkward number.
const COUNT: usize = 5003;
const STEPS: u64 = 60;
const EVERY: u64 = 7;

fn system(n: usize) -> Pendulum<f64> {
    Pendulum { omega2: 1.0 + n as f64 / COUNT as f64 }
}

fn start(n: usize) -> State<f64, 1> {
    State { q: [2.0 * n as f64 / COUNT as f64], v: [0.1] }
}

const DT: f64 = 0.05;

/// The states of trajectory `n` at the steps that are observed.
fn alone(n: usize) -> Vec<State<f64, 1>> {
    let mut state = start(n);
    let mut seen = vec![state];
    for step in 1..=STEPS {
        state = VelocityVerlet.step(&system(n), state, DT);
        if step % EVERY == 0 {
            seen.push(state);
        }
    }
    seen
}

/// Runs an ensemble under the eyes of what `observer` makes, everywhere, and checks that the answers are
/// the same; gives one of them.
fn everywhere<R: PartialEq + std::fmt::Debug>(
    run: impl Fn(Ensemble<f64, 1>, &[Pendulum<f64>]) -> R,
) -> R {
    let systems: Vec<_> = (0..COUNT).map(system).collect();
    let answers = InstructionSet::available().flat_map(|set| [(set, 1), (set, 3)]);
    let answers = answers.map(|(set, threads)| {
        let execution = Execution::serial().instructions(set).unwrap();
        let execution = execution.threads(threads).unwrap().worth(1);
        run(Ensemble::from_fn(COUNT, execution, start).unwrap(), &systems)
    });
    answers
        .reduce(|first, other| {
            assert_eq!(first, other);
            first
        })
        .unwrap()
}

#[test]
fn copies_are_the_states_of_lone_trajectories() {
    let copies = everywhere(|mut ensemble, systems| {
        ensemble
            .observe(VelocityVerlet, PerTrajectory(systems), All(DT), STEPS, EVERY, Copies::new)
            .unwrap()
    });
    let of = |n: usize| copies.iter().find_map(|copies| copies.states(n));
    // Runs of 512: a sixteenth would be less.
    for n in [0, 1, 511, 512, COUNT - 1] {
        assert_eq!(of(n), Some(&alone(n)[..]));
    }
    assert_eq!(of(COUNT), None);
    assert_eq!(copies[0].steps(), [0, 7, 14, 21, 28, 35, 42, 49, 56]);
    assert_eq!(copies[1].trajectories(), 512..1024);
}

#[test]
fn the_largest_drift_is_that_of_lone_trajectories() {
    let drifts = everywhere(|mut ensemble, systems| {
        let watch = |range| Drift::<f64, Pendulum<f64>, _>::new(range, PerTrajectory(systems));
        let watched = ensemble
            .observe(VelocityVerlet, PerTrajectory(systems), All(DT), STEPS, EVERY, watch)
            .unwrap();
        watched.iter().flat_map(Drift::largest).collect::<Vec<f64>>()
    });
    assert_eq!(drifts.len(), COUNT);
    for n in [0, 17, 4096, COUNT - 1] {
        let energies: Vec<f64> = alone(n).iter().map(|s| system(n).energy(s)).collect();
        let changes = energies.iter().map(|e| (e - energies[0]).abs());
        assert_eq!(drifts[n], changes.fold(0.0, f64::max) / energies[0].abs());
    }
}

#[test]
fn an_energy_that_is_no_number_is_not_forgotten() {
    let mut ensemble = Ensemble::from_fn(3, Execution::serial(), start).unwrap();
    let wild = [system(0), Pendulum { omega2: f64::NAN }, system(2)];
    let watch = |range| Drift::<f64, Pendulum<f64>, _>::new(range, PerTrajectory(&wild));
    let watched =
        ensemble.observe(VelocityVerlet, PerTrajectory(&wild), All(DT), 3, 1, watch).unwrap();
    let drifts: Vec<f64> = watched.iter().flat_map(Drift::largest).collect();
    assert!(drifts[0].is_finite() && drifts[1].is_nan() && drifts[2].is_finite(), "{drifts:?}");
}

#[test]
fn the_mean_square_error_is_that_of_lone_trajectories() {
    let exact = |n: usize, step: u64| State { q: [n as f64 * 1e-3], v: [step as f64 * 1e-2] };
    let means = everywhere(|mut ensemble, systems| {
        let watch = |range| MeanSquareError::new(range, exact);
        let watched = ensemble
            .observe(VelocityVerlet, PerTrajectory(systems), All(DT), STEPS, EVERY, watch)
            .unwrap();
        watched.iter().flat_map(MeanSquareError::means).collect::<Vec<_>>()
    });
    for n in [0, 4095, COUNT - 1] {
        let seen = alone(n);
        let squares = |apart: &dyn Fn(&State<f64, 1>, State<f64, 1>) -> f64| {
            let sum = seen.iter().enumerate().fold(0.0, |sum, (i, state)| {
                sum + apart(state, exact(n, i as u64 * EVERY)).powi(2)
            });
            sum / seen.len() as f64
        };
        let [q, v] = means[n];
        assert_eq!(q, squares(&|state, exact| state.q[0] - exact.q[0]));
        assert_eq!(v, squares(&|state, exact| state.v[0] - exact.v[0]));
    }
}

#[test]
fn moments_are_those_of_all_trajectories_at_each_step() {
    let summaries = everywhere(|mut ensemble, systems| {
        let watch = |_| Moments::new();
        let parts = ensemble
            .observe(VelocityVerlet, PerTrajectory(systems), All(DT), STEPS, EVERY, watch)
            .unwrap();
        Moments::merged(parts).summaries().collect::<Vec<_>>()
    });
    assert_eq!(summaries.len(), 9);
    let all: Vec<_> = (0..COUNT).map(alone).collect();
    for (i, summary) in summaries.iter().enumerate() {
        assert_eq!((summary.step, summary.count), (i as u64 * EVERY, COUNT as u64));
        let mean = all.iter().map(|seen| seen[i].q[0]).sum::<f64>() / COUNT as f64;
        let square = |seen: &Vec<State<f64, 1>>| (seen[i].q[0] - mean).powi(2);
        let variance = all.iter().map(square).sum::<f64>() / COUNT as f64;
        // Both add 5003 numbers of order one, in other orders: their roundings differ by less than
        // that many ulps.
        let near = |a: f64, b: f64| (a - b).abs() < COUNT as f64 * f64::EPSILON;
        assert!(near(summary.mean.q[0], mean) && near(summary.variance.q[0], variance));
    }
}
