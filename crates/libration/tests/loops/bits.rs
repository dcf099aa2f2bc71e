//! The bits of a trajectory do not depend on the execution.

use libration::checkpoint::Checkpoint;
use libration::control::clock::{
    Correlated, Drifting, Gaussian, Jittered, LateTicks, MissedTicks, RandomWalk, Rates,
    Sinusoidal, Skewed, Uniform,
};
use libration::control::controller::{Force, Pid, PidGains, Saturated, StateFeedback};
use libration::control::delay::{Latencies, Order, Packets, Random, RecordedLatencies, Schedule};
use libration::control::{Clock, Controller, Delay, Feedback, Jitter, Latency, RandomLatency};
use libration::ensemble::{All, Assign, Execution, InstructionSet, Loops, PerTrajectory, Setup};
use libration::integrator::{ExplicitEuler, Rk4, SymplecticEuler, VelocityVerlet};
use libration::system::{BaselineOnly, Oscillator, Pendulum};
use libration::{Integrator, State, System};
use proptest::prelude::*;

use super::any_delay::AnyDelay;
use super::single_loop::One;

const GAINS: Feedback = Feedback { position: 3.0, velocity: 0.5 };

fn starts(count: usize) -> Vec<State<f32, 1>> {
    (0..count).map(|n| State { q: [1.0 - n as f32 * 1e-3], v: [0.25] }).collect()
}

/// The states after so many steps, and all that is remembered.
fn run<Sys, A, M, K, C, L>(
    setup: Setup<A, M, K, C, L>,
    count: usize,
    execution: Execution,
    parts: &[u64],
) -> Vec<[u32; 2]>
where
    Sys: System<f32, 1> + Copy + Send + Sync,
    A: Assign<Sys>,
    M: Integrator,
    K: Controller<f32, 1>,
    C: Clock<f32>,
    L: Delay<f32>,
{
    let mut loops = Loops::new(setup, 0.05, 11, [0.125], &starts(count), execution).unwrap();
    for &steps in parts {
        loops.advance(steps).unwrap();
    }
    let bits = |n| {
        let state = loops.state(n).unwrap();
        [state.q[0].to_bits(), state.v[0].to_bits()]
    };
    (0..count).map(bits).collect()
}

/// Runs the setup in every way that must make no difference.
fn same_bits<Sys, A, M, K, C, L>(
    setup: Setup<A, M, K, C, L>,
    fewer: impl Fn(usize) -> Setup<A, M, K, C, L>,
) where
    Sys: System<f32, 1> + Copy + Send + Sync,
    A: Assign<Sys>,
    M: Integrator,
    K: Controller<f32, 1>,
    C: Clock<f32>,
    L: Delay<f32>,
{
    const COUNT: usize = 333;
    let baseline = || Execution::serial().instructions(InstructionSet::Baseline).unwrap();
    // Beyond an epoch of the random numbers.
    let whole = run(setup, COUNT, baseline(), &[300]);
    assert!(whole.iter().any(|bits| *bits != whole[0]), "all alike");
    for set in InstructionSet::available() {
        let execution = Execution::serial().instructions(set).unwrap();
        assert_eq!(run(setup, COUNT, execution, &[300]), whole, "{}", set.name());
    }
    for threads in 1..=4 {
        let execution = Execution::serial().threads(threads).unwrap().worth(1);
        assert_eq!(run(setup, COUNT, execution, &[300]), whole, "{threads} threads");
    }
    assert_eq!(run(setup, COUNT, baseline(), &[1, 99, 0, 157, 43]), whole, "in parts");
    for count in [1, 2, 64, 65, 200] {
        let few = run(fewer(count), count, baseline(), &[300]);
        assert_eq!(few, whole[..count], "{count} trajectories");
    }
}

/// One that is the same for any number of trajectories.
fn same_bits_of<Sys, M, K, C, L>(setup: Setup<All<Sys>, M, K, C, L>)
where
    Sys: System<f32, 1> + Copy + Send + Sync,
    M: Integrator,
    K: Controller<f32, 1>,
    C: Clock<f32>,
    L: Delay<f32>,
{
    same_bits(setup, |_| setup);
}

fn oscillator<M>(method: M) -> Setup<All<Oscillator<f32>>, M> {
    Setup::new(All(Oscillator { omega2: 4.0 }), method)
}

/// On one instruction set, for tests that do not compare them: a loop is compiled for each.
fn plain_oscillator<M>(method: M) -> Setup<All<BaselineOnly<Oscillator<f32>>>, M> {
    Setup::new(All(BaselineOnly(Oscillator { omega2: 4.0 })), method)
}

/// Five clocks in one.
fn shaken() -> impl Clock<f32> {
    let jitter = (Jittered(Uniform(0.1)), Correlated { rms: 0.1, correlation: 0.9 });
    let waves = (Sinusoidal { rms: 0.1, rate: 0.3, phase: 1.0 }, MissedTicks { probability: 0.2 });
    ((jitter, waves), Skewed(Jitter::Gaussian(0.1)))
}

/// The others.
fn stirred() -> impl Clock<f32> {
    let noise = (Jittered(Gaussian(0.1)), RandomWalk { rms: 0.01 });
    ((noise, LateTicks { probability: 0.2, by: 0.5 }), Drifting(Jitter::Uniform(1e-4)))
}

/// A pendulum on the other clocks, under the late force of another.
fn stirred_pendulum()
-> Setup<All<Pendulum<f32>>, VelocityVerlet, Force<Pendulum<f32>>, impl Clock<f32>, Schedule> {
    Setup::new(All(Pendulum { omega2: 4.0 }), VelocityVerlet)
        .controller(Force(Pendulum { omega2: 1.0 }))
        .clock(stirred())
        .delay(Schedule::late(Latency::of_steps(2.0).unwrap()))
}

#[test]
fn bits_do_not_depend_on_threads_numbers_instructions_or_parts_whatever_the_clock() {
    same_bits_of(oscillator(SymplecticEuler).clock(shaken()));
    same_bits_of(stirred_pendulum());
}

#[test]
fn bits_do_not_depend_on_threads_numbers_instructions_or_parts_whatever_the_delay() {
    let base =
        oscillator(SymplecticEuler).controller(StateFeedback::to_origin(GAINS)).clock(shaken());
    for schedule in [[1.0, 0.0, 0.0], [1.0, 1.0, 2.0], [1.0, 0.25, 1.5], [2.5, 0.0, 0.75]] {
        let [period, observation, action] = schedule;
        same_bits_of(base.delay(Schedule::new(period, observation, action).unwrap()));
    }
    let table = RandomLatency::new(vec![(0.0, 0.5), (2.0, 0.25), (3.25, 0.25)], 0.5).unwrap();
    same_bits_of(base.delay(AnyDelay::Random(Random(&table))));
    for order in [Order::NewestActs, Order::LastActs] {
        let packets = Packets::new(&[0.3, 0.3, 0.2], order).unwrap();
        same_bits_of(base.delay(AnyDelay::Packets(packets)));
    }
    let record: Vec<f64> = (0..300).map(|n| f64::from(n % 7) / 2.0).collect();
    let record = RecordedLatencies::new(&record).unwrap();
    same_bits_of(base.delay(AnyDelay::Recorded(record)));
}

#[test]
fn bits_do_not_depend_on_threads_numbers_instructions_or_parts_whatever_the_controller() {
    let late = Schedule::late(Latency::of_steps(2.0).unwrap());
    let pid = Pid::new(PidGains {
        proportional: 4.0,
        integral: 1.0,
        derivative: 1.0,
        filter: 0.1,
        most: 0.5,
        tracking: 0.5,
        target: [0.25],
    });
    same_bits_of(oscillator(VelocityVerlet).controller(pid.unwrap()).delay(late));
    same_bits_of(stirred_pendulum());
    // A plant, a rate and a latency for each.
    let latencies: Vec<Latency> =
        (0..333).map(|n| Latency::of_steps(f64::from(n % 40) / 10.0).unwrap()).collect();
    let seen: Vec<Latency> =
        (0..333).map(|n| Latency::of_steps(f64::from(n % 7) / 4.0).unwrap()).collect();
    let systems: Vec<Oscillator<f32>> =
        (0..333).map(|n| Oscillator { omega2: 1.0 + n as f32 / 100.0 }).collect();
    let rates: Vec<f64> = (0..333).map(|n| 1.0 + f64::from(n) * 1e-4).collect();
    let all = |count: usize| {
        Setup::new(PerTrajectory(&systems[..count]), Rk4)
            .controller(Saturated { controller: StateFeedback::to_origin(GAINS), most: 1.0 })
            .clock((Rates(&rates[..count]), MissedTicks { probability: 0.1 }))
            .delay(Latencies::of_commands(&latencies[..count]).with_observations(&seen[..count]))
    };
    same_bits(all(333), all);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn a_lane_is_the_plain_loop_of_one_trajectory_bit_for_bit(
        omega2 in 0.5..20.0_f64,
        dt in 0.005..0.15_f64,
        position in -0.5..15.0_f64,
        velocity in 0.0..4.0_f64,
        whole in 0..9_u32,
        part in prop_oneof![Just(0.0), Just(0.25), 0.01..0.99_f64],
        steps in 1..50_u64,
    ) {
        let feedback = Feedback { position, velocity };
        let latency = Latency::of_steps(f64::from(whole) + part).unwrap();
        let start = State { q: [1.0], v: [0.25] };
        let mut one = One::new(omega2, VelocityVerlet, feedback, latency, start);
        (0..steps).for_each(|_| one.step(dt));
        let setup = Setup::new(All(BaselineOnly(Oscillator { omega2 })), VelocityVerlet)
            .controller(StateFeedback::to_origin(feedback));
        let (states, latencies) = (vec![start; 70], vec![latency; 70]);
        let serial = Execution::serial;
        let scheduled = setup.delay(Schedule::late(latency));
        let mut shared = Loops::new(scheduled, dt, 0, [0.0], &states, serial()).unwrap();
        shared.advance(steps).unwrap();
        let own = setup.delay(Latencies::of_commands(&latencies));
        let mut each = Loops::new(own, dt, 0, [0.0], &states, serial()).unwrap();
        each.advance(steps).unwrap();
        for n in [0, 1, 63, 69] {
            prop_assert_eq!(shared.state(n), Some(one.state), "shared, {}", n);
            prop_assert_eq!(each.state(n), Some(one.state), "each its own, {}", n);
        }
    }
}

#[test]
fn explicit_euler_is_symplectic_euler_with_the_force_one_step_late_bit_for_bit() {
    let (spring, dt) = (Oscillator { omega2: 10.0 }, 0.01);
    let start = State { q: [1.0], v: [0.25] };
    // Nothing but the late force acts, and before it arrives, nothing.
    let late = Setup::new(All(BaselineOnly(Oscillator { omega2: 0.0 })), SymplecticEuler)
        .controller(Force(spring))
        .delay(Schedule::late(Latency::of_steps(1.0).unwrap()));
    let mut delayed = Loops::new(late, dt, 0, [0.0], &[start], Execution::serial()).unwrap();
    let mut euler = start;
    for step in 0..1000 {
        delayed.advance(1).unwrap();
        let before = euler.v;
        euler = ExplicitEuler.step(&spring, euler, dt);
        // Its velocity is the one that explicit Euler had a step before.
        let state = delayed.state(0).unwrap();
        assert_eq!((state.q, state.v), (euler.q, before), "{step}");
    }
}

#[test]
fn loops_that_are_restored_go_on_bit_for_bit_and_one_that_is_reset_begins_anew() {
    let setup = plain_oscillator(VelocityVerlet)
        .controller(StateFeedback::to_origin(GAINS))
        .clock(shaken())
        .delay(Schedule::new(1.0, 0.5, 4.25).unwrap());
    let fresh = || Loops::new(setup, 0.1, 3, [0.5], &starts(100), Execution::serial()).unwrap();
    let mut whole = fresh();
    whole.advance(7).unwrap();
    let middle = whole.to_bytes();
    whole.advance(20).unwrap();
    let mut resumed = fresh();
    resumed.advance(3).unwrap();
    resumed.restore(&middle).unwrap();
    resumed.advance(20).unwrap();
    assert_eq!((resumed.to_bytes(), resumed.step()), (whole.to_bytes(), 27));
    // Before the first command arrives the initial one acts, as at the very beginning.
    assert_ne!(resumed.command(5), Some([0.5]));
    resumed.reset(5, starts(100)[5]);
    assert_eq!(resumed.command(5), Some([0.5]));
    assert_eq!(resumed.state(5), Some(starts(100)[5]));
    resumed.advance(4).unwrap();
    assert_eq!(resumed.command(5), Some([0.5]));
    resumed.advance(2).unwrap();
    assert_ne!(resumed.command(5), Some([0.5]));
    // The neighbours noticed nothing.
    whole.advance(6).unwrap();
    assert_eq!(resumed.state(6), whole.state(6));
}

#[test]
fn latencies_of_its_own_make_of_a_trajectory_what_a_schedule_for_all_does() {
    let steps = |x: f64| Latency::of_steps(x).unwrap();
    let pairs: Vec<[f64; 2]> =
        (0..40_u32).map(|n| [n % 5, n / 5].map(|x| f64::from(x) * 0.75)).collect();
    let [seen, commands] = [0, 1].map(|i| pairs.iter().map(|p| steps(p[i])).collect::<Vec<_>>());
    let setup = plain_oscillator(VelocityVerlet)
        .controller(StateFeedback { gains: GAINS, target: [0.5] })
        .clock(shaken());
    let starts = [State { q: [1.0_f32], v: [0.25] }; 40];
    let own = setup.delay(Latencies::of_commands(&commands).with_observations(&seen));
    let mut own = Loops::new(own, 0.1, 3, [0.125], &starts, Execution::serial()).unwrap();
    own.advance(30).unwrap();
    for (n, [observation, command]) in pairs.into_iter().enumerate() {
        let all = setup.delay(Schedule::new(1.0, observation, command).unwrap());
        let mut all = Loops::new(all, 0.1, 3, [0.125], &starts, Execution::serial()).unwrap();
        all.advance(30).unwrap();
        assert_eq!(own.state(n), all.state(n), "{observation} {command}");
    }
}
