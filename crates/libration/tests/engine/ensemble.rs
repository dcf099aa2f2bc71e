//! Every lane of an ensemble equals the scalar trajectory, bit for bit.

use libration::ensemble::{
    All, AnyEnsemble, BatchFloat, Ensemble, EnsembleError, Execution, InstructionSet, Lanes,
    Observer, PerTrajectory,
};
use libration::integrator::{Rk4, Splitting, VelocityVerlet};
use libration::system::{DampedOscillator, Oscillator, Pendulum};
use libration::{
    AnySystem, Elementary, Float, Integrator, Method, Model, State, catalog, with_system,
};
use proptest::prelude::*;

use super::step_function::step_function;

/// A start near the default of the system, another for every trajectory and coordinate.
fn start<T: Float>(entry: &catalog::Entry, dimension: usize, n: usize, i: usize) -> T {
    let (values, at) = if i < dimension { (entry.q, i) } else { (entry.v, i - dimension) };
    let nudge = 1e-3 * ((7 * n + 3 * i) % 31) as f64;
    T::from_f64(values[at % values.len()] + nudge)
}

/// The trajectory `n` by itself, step by step.
fn alone<T: Float + Elementary>(
    system: AnySystem,
    dimension: usize,
    method: Method,
    n: usize,
    dt: T,
    steps: u64,
) -> Vec<T> {
    let entry = system.entry();
    with_system!(
        system,
        dimension,
        // The systems in the fewest dimensions are those that are compared.
        |model, D| if const { D > 2 } {
            unreachable!()
        } else {
            let step = step_function(method, Model::<D>::on::<T>(&model), dt);
            let start = State::<T, D> {
                q: core::array::from_fn(|i| start(entry, D, n, i)),
                v: core::array::from_fn(|i| start(entry, D, n, D + i)),
            };
            (0..steps).fold(start, |state, _| step(state)).coordinates().collect()
        },
        unreachable!()
    )
}

fn executions() -> Vec<Execution> {
    // However little there is to do.
    let threads =
        |n| move |set| Execution::serial().instructions(set).unwrap().threads(n).unwrap().worth(1);
    InstructionSet::available().flat_map(|set| [threads(1)(set), threads(3)(set)]).collect()
}

/// Lanes of an ensemble that differ from the lone trajectory, in words.
fn differing<T: BatchFloat>(
    system: AnySystem,
    method: Method,
    len: usize,
    steps: u64,
    execution: &Execution,
) -> Vec<String> {
    let entry = system.entry();
    let dimension = *entry.dimensions.start();
    let dt = T::from_f64(0.01);
    let begin = |n, i| start(entry, dimension, n, i);
    let mut all =
        AnyEnsemble::<T>::of_system(system, dimension, len, execution.clone(), begin).unwrap();
    // In two parts, so that a start in the middle is seen; so few steps have kernels of their own.
    let few = steps.min(2);
    all.advance(method, dt, few);
    all.advance(method, dt, steps - few);
    assert_eq!((all.len(), all.step(), all.dimension()), (len, steps, dimension));
    let bits = |x: T| x.to_f64().to_bits();
    let differs = |n: &usize| {
        let want = alone::<T>(system, dimension, method, *n, dt, steps);
        let q = (0..dimension).map(|i| all.q(i).unwrap()[*n]);
        let got = q.chain((0..dimension).map(|i| all.v(i).unwrap()[*n]));
        !got.zip(want).all(|(a, b)| bits(a) == bits(b))
    };
    let some = (0..len).filter(|n| len < 50 || n % 37 == 0 || n + 3 > len);
    some.filter(differs)
        .map(|n| format!("{} {} lane {n} of {len}, {execution:?}", entry.name, method.name()))
        .collect()
}

#[test]
fn every_lane_is_the_lone_trajectory_for_every_method_system_float_and_instruction_set() {
    for execution in executions() {
        for entry in catalog::ENTRIES {
            let system = AnySystem::build(entry.name, &[] as &[(&str, f64)]).unwrap();
            for method in Method::ALL {
                let mut found = differing::<f32>(system, method, 211, 20, &execution);
                found.extend(differing::<f64>(system, method, 211, 20, &execution));
                assert!(found.is_empty(), "{found:#?}");
            }
        }
    }
}

proptest! {
    // Each case is a whole ensemble; the combinations are covered by the test above.
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn no_number_of_trajectories_threads_or_steps_is_awkward(
        len in prop_oneof![
            0..4usize,
            // Blocks of every width, and one more or less.
            (prop::sample::select(vec![8, 16, 24, 32, 48, 64, 96, 128, 160, 208usize]), 0..3usize)
                .prop_map(|(width, off)| width + off - 1),
            Just(4095), Just(4097), Just(8209), 0..9000usize,
        ],
        steps in 0..12u64,
        threads in 1..4usize,
        method in prop::sample::select(Method::ALL.to_vec()),
        entry in prop::sample::select(catalog::ENTRIES.to_vec()),
        set in prop::sample::select(InstructionSet::available().collect::<Vec<_>>()),
    ) {
        let execution =
            Execution::serial().instructions(set).unwrap().threads(threads).unwrap().worth(1);
        let system = AnySystem::build(entry.name, &[] as &[(&str, f64)]).unwrap();
        prop_assert_eq!(differing::<f32>(system, method, len, steps, &execution), Vec::<String>::new());
        prop_assert_eq!(differing::<f64>(system, method, len, steps, &execution), Vec::<String>::new());
    }
}

#[test]
fn a_step_and_a_system_of_its_own_for_each_trajectory_are_taken_as_they_are() {
    let len = 1003;
    let systems: Vec<_> = (0..len)
        .map(|n| DampedOscillator { omega2: 1.0 + n as f32, gamma: 1e-3 * n as f32 })
        .collect();
    let dts: Vec<f32> = (0..len).map(|n| 1e-3 + 1e-6 * n as f32).collect();
    let start = State { q: [1.0_f32], v: [0.5] };
    for execution in executions() {
        let mut all = Ensemble::new(&vec![start; len], execution).unwrap();
        all.advance(Rk4, PerTrajectory(&systems), PerTrajectory(&dts), 50).unwrap();
        for n in 0..len {
            let lone = (0..50).fold(start, |s, _| Rk4.step(&systems[n], s, dts[n]));
            assert_eq!(all.state(n), Some(lone), "{n}");
        }
    }
}

#[test]
fn sixteen_dimensions_run_as_the_scalar_step() {
    let states: Vec<State<f64, 16>> = (0..101)
        .map(|n| State {
            q: core::array::from_fn(|i| (n + i) as f64),
            v: core::array::from_fn(|i| (2 * n) as f64 - i as f64),
        })
        .collect();
    let system = Oscillator { omega2: 2.0 };
    for execution in executions() {
        let mut all = Ensemble::new(&states, execution.clone()).unwrap();
        all.advance(VelocityVerlet, All(system), All(0.01), 9).unwrap();
        for (n, &start) in states.iter().enumerate() {
            let lone = (0..9).fold(start, |s, _| VelocityVerlet.step(&system, s, 0.01));
            assert_eq!(all.state(n), Some(lone));
        }
    }
}

#[test]
fn verlet_with_forces_that_depend_on_velocities_carries_no_acceleration() {
    let system = DampedOscillator { omega2: 3.0, gamma: 0.4 };
    let start = |n: usize| State { q: [1.0 + n as f32], v: [-0.5] };
    for execution in executions() {
        let mut all = Ensemble::from_fn(211, execution, start).unwrap();
        all.advance(VelocityVerlet, All(system), All(0.05), 30).unwrap();
        for n in 0..211 {
            let lone = (0..30).fold(start(n), |s, _| VelocityVerlet.step(&system, s, 0.05));
            assert_eq!(all.state(n), Some(lone), "{n}");
        }
    }
}

#[test]
fn parts_beyond_the_threads_are_done_by_whoever_is_free() {
    let execution = Execution::serial().threads(2).unwrap();
    // The first part waits for all others: whoever does it cannot do them.
    let done = std::sync::atomic::AtomicUsize::new(0);
    let all = execution.each((0..20).collect(), |i: usize| {
        if i > 0 {
            done.fetch_add(1, std::sync::atomic::Ordering::SeqCst);
        }
        while i == 0 && done.load(std::sync::atomic::Ordering::SeqCst) < 19 {
            std::thread::yield_now();
        }
        std::thread::current().id()
    });
    assert!(all[1..].iter().all(|&other| other != all[0]));
}

#[test]
fn a_method_that_is_no_ones_but_the_users_runs_as_the_scalar_step() {
    // More stages than are written out.
    let weights: [f64; 9] = [0.3, -0.1, 0.2, 0.1, 0.05, 0.15, -0.2, 0.4, 0.1];
    let method = Splitting { kicks: weights, drifts: weights };
    let system = Pendulum { omega2: 4.0 };
    let start = |n: usize| State { q: [1e-2 * n as f64], v: [0.3] };
    for execution in executions() {
        let mut all = Ensemble::from_fn(211, execution, start).unwrap();
        all.advance(method, All(system), All(0.02), 11).unwrap();
        for n in 0..211 {
            let lone = (0..11).fold(start(n), |s, _| method.step(&system, s, 0.02));
            assert_eq!(all.state(n), Some(lone), "{n}");
        }
    }
}

#[test]
fn each_part_has_a_thread_of_its_own_and_results_come_in_their_order() {
    for threads in [1, 2, 3] {
        let execution = Execution::serial().threads(threads).unwrap();
        for parts in [0, 1, 2, 3, 8] {
            let done = execution.each((0..parts).collect(), |i| (i, std::thread::current().id()));
            assert_eq!(done.iter().map(|(i, _)| *i).collect::<Vec<_>>(), Vec::from_iter(0..parts));
            // With more parts than threads the first is whoever's comes first.
            if parts == threads {
                assert_eq!(done[0].1, std::thread::current().id());
                let again = execution.each((0..parts).collect(), |_| std::thread::current().id());
                assert_eq!(done.iter().map(|(_, thread)| *thread).collect::<Vec<_>>(), again);
                let distinct: std::collections::HashSet<_> = again.into_iter().collect();
                assert_eq!(distinct.len(), threads);
            }
        }
    }
}

/// Sums positions over trajectories at each step that it sees.
struct Sums(Vec<f64>, u64);

impl Observer<f64, 1> for Sums {
    #[inline(always)]
    fn observe(&mut self, lanes: &Lanes<'_, f64, 1>) {
        let at = (lanes.step / self.1) as usize;
        self.0.resize(self.0.len().max(at + 1), 0.0);
        lanes.q[0].iter().for_each(|q| self.0[at] += q);
    }
}

#[test]
fn observers_see_the_same_in_the_same_order_wherever_the_ensemble_runs() {
    let states: Vec<State<f64, 1>> =
        (0..1_507).map(|n| State { q: [(n as f64).sin()], v: [0.1] }).collect();
    let seen = executions().into_iter().map(|execution| {
        let mut all = Ensemble::new(&states, execution).unwrap();
        let system = All(Pendulum { omega2: 1.0 });
        let sums = all.observe(Rk4, system, All(0.1), 25, 10, |_| Sums(Vec::new(), 10)).unwrap();
        let more = all.observe(Rk4, system, All(0.1), 10, 10, |_| Sums(Vec::new(), 10)).unwrap();
        let bits = |sums: Vec<Sums>| -> Vec<Vec<u64>> {
            sums.into_iter().map(|s| s.0.into_iter().map(f64::to_bits).collect()).collect()
        };
        (bits(sums), bits(more))
    });
    let seen: Vec<_> = seen.collect();
    // Three runs. Steps 0, 10 and 20; then 30 alone.
    assert_eq!(seen[0].0.len(), 3);
    assert!(seen[0].0.iter().all(|sums| sums.len() == 3));
    assert!(seen[0].1.iter().all(|sums| sums.len() == 4 && sums[..3] == [0, 0, 0]));
    assert!(seen.iter().all(|other| other == &seen[0]));
}

#[test]
fn a_trajectory_that_overflows_is_named_and_disturbs_no_other() {
    let start = |n: usize| State { q: [if n == 300 { 1e38_f32 } else { 1.0 }], v: [0.0] };
    let mut all = Ensemble::from_fn(1000, Execution::serial(), start).unwrap();
    all.advance(Rk4, All(Oscillator { omega2: 10.0 }), All(1.0), 50).unwrap();
    assert_eq!(all.not_finite().collect::<Vec<_>>(), [300]);
    let neighbour = all.state(299);
    assert!((0..1000).filter(|&n| n != 300).all(|n| all.state(n) == neighbour));
}

#[test]
fn what_cannot_be_run_is_refused_in_words() {
    let states = [State { q: [1.0_f32], v: [0.0] }; 3];
    let mut all = Ensemble::new(&states, Execution::serial()).unwrap();
    let system = All(Oscillator { omega2: 1.0 });
    let error = all.advance(Rk4, system, PerTrajectory(&[0.1; 2]), 1).unwrap_err();
    assert!(error.to_string().contains("2 time steps for 3 trajectories"), "{error}");
    let far = usize::MAX / 64;
    let error = Ensemble::<f64, 1>::from_fn(far, Execution::serial(), |_| unreachable!());
    assert!(matches!(error, Err(EnsembleError::Memory(_))));
    for set in InstructionSet::ALL.into_iter().filter(|set| !set.is_available()) {
        let error = Execution::serial().instructions(set).unwrap_err().to_string();
        assert!(error.contains(set.name()) && error.contains("baseline"), "{error}");
    }
    assert!(all.observe(Rk4, system, All(0.1), 1, 0, |_| Nothing).is_err());
}

struct Nothing;

impl Observer<f32, 1> for Nothing {
    fn observe(&mut self, _: &Lanes<'_, f32, 1>) {}
}
