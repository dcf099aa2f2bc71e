//! An analytical test for each kind of delay.

use libration::State;
use libration::control::controller::StateFeedback;
use libration::control::delay::{Latencies, Order, Packets, Random, RecordedLatencies, Schedule};
use libration::control::{Delay, Feedback, Latency, RandomLatency};
use libration::ensemble::{All, Execution, Loops, Setup};
use libration::integrator::VelocityVerlet;
use libration::system::{BaselineOnly, Oscillator};

use super::any_delay::AnyDelay;

/// The command that acts in the end of each step, on something that moves freely with velocity 1 under a command that
/// is its own position and too weak to move it: the time at which the command was computed, in steps.
fn computed_at<L: Delay<f64>>(delay: L, trajectories: usize, steps: usize) -> Vec<Vec<f64>> {
    // 2⁻¹⁰⁰: what it moves is lost in rounding.
    let weak = 1.0 / (1_u128 << 100) as f64;
    let feedback = Feedback { position: -weak, velocity: 0.0 };
    let setup = Setup::new(All(BaselineOnly(Oscillator { omega2: 0.0 })), VelocityVerlet)
        .controller(StateFeedback::to_origin(feedback))
        .delay(delay);
    let starts = vec![State { q: [0.0], v: [1.0] }; trajectories];
    let before = [-weak];
    let mut all = Loops::new(setup, 1.0, 5, before, &starts, Execution::serial()).unwrap();
    let mut times = vec![Vec::with_capacity(steps); trajectories];
    for _ in 0..steps {
        all.advance(1).unwrap();
        for (n, times) in times.iter_mut().enumerate() {
            times.push(all.command(n).unwrap()[0] / weak);
        }
    }
    times
}

/// What acts before the first command arrives.
const BEFORE: f64 = -1.0;

#[test]
fn a_command_of_whole_steps_acts_that_many_steps_later() {
    for whole in [0, 1, 2, 7] {
        let latency = Latency::of_steps(f64::from(whole)).unwrap();
        let times = &computed_at(Schedule::late(latency), 1, 12)[0];
        for (n, &time) in times.iter().enumerate() {
            let sent = n as f64 - f64::from(whole);
            assert_eq!(time, if sent >= 0.0 { sent } else { BEFORE }, "{whole} {n}");
        }
    }
}

#[test]
fn an_observation_that_is_late_is_of_the_state_as_it_was_and_a_fraction_counts() {
    // At step n acts what is computed at n − 1, of the state 1.25 earlier: n − 2.25.
    let times = &computed_at(Schedule::new(1.0, 1.25, 1.0).unwrap(), 1, 9)[0];
    for (n, &time) in times.iter().enumerate() {
        let seen = n as f64 - 2.25;
        assert_eq!(time, if seen >= 0.0 { seen } else { BEFORE }, "{n}");
    }
}

#[test]
fn a_sample_time_that_is_no_multiple_of_the_step_is_kept() {
    // Samples at 0, 2.5, 5 …, which act at once: at the end of step n the last one before n + 1.
    let times = &computed_at(Schedule::new(2.5, 0.0, 0.0).unwrap(), 1, 30)[0];
    for (n, &time) in times.iter().enumerate() {
        let last = (n as f64 + 0.75).div_euclid(2.5) * 2.5;
        assert_eq!(time, last, "{n}");
    }
}

#[test]
fn a_latency_of_any_part_splits_the_step_where_the_command_arrives() {
    // Nothing but a command of 1 from the time 0.3 on: velocity 0.7 and position 0.7²/2 after a step.
    let feedback = Feedback { position: 0.0, velocity: 0.0 };
    let to = StateFeedback { gains: Feedback { position: 1.0, ..feedback }, target: [1.0] };
    let latency = Latency::of_steps(0.3).unwrap();
    let setup =
        Setup::new(All(BaselineOnly(Oscillator { omega2: 0.0 })), VelocityVerlet).controller(to);
    let start = [State { q: [0.0], v: [0.0] }];
    let shared = setup.delay(Schedule::late(latency));
    let own = [latency];
    let each = setup.delay(Latencies::of_commands(&own));
    let mut first = Loops::new(shared, 1.0, 0, [0.0], &start, Execution::serial()).unwrap();
    let mut second = Loops::new(each, 1.0, 0, [0.0], &start, Execution::serial()).unwrap();
    first.advance(1).unwrap();
    second.advance(1).unwrap();
    for state in [first.state(0), second.state(0)].map(Option::<State<f64, 1>>::unwrap) {
        // A few roundings of numbers below one.
        assert!((state.v[0] - 0.7).abs() < 1e-15 && (state.q[0] - 0.245).abs() < 1e-15);
    }
}

#[test]
fn each_trajectory_has_its_own_latency() {
    let latencies = [0.0, 1.0, 2.5, 4.0].map(|steps| Latency::of_steps(steps).unwrap());
    let times = computed_at(Latencies::of_commands(&latencies), 4, 9);
    for (latency, times) in latencies.iter().zip(&times) {
        for (n, &time) in times.iter().enumerate() {
            let sent = n as f64 - latency.steps().trunc();
            assert_eq!(time, if sent >= 0.0 { sent } else { BEFORE }, "{latency:?} {n}");
        }
    }
}

#[test]
fn a_long_latency_is_kept_in_short_floats() {
    // A command of 1 that is sent at once: the step in which it acts.
    let to = StateFeedback { gains: Feedback { position: 1.0, velocity: 0.0 }, target: [1.0] };
    let long = [7_u32, 127, 257, 259, 300, 1001, 2049, 4096];
    let latencies = long.map(|steps| Latency::of_steps(f64::from(steps)).unwrap());
    let setup =
        Setup::new(All(BaselineOnly(Oscillator { omega2: half::bf16::ZERO })), VelocityVerlet);
    let setup = setup.controller(to).delay(Latencies::of_commands(&latencies));
    let zero = half::bf16::ZERO;
    let starts = [State { q: [zero], v: [zero] }; 8];
    let dt = half::bf16::from_f64(1e-6);
    let mut all = Loops::new(setup, dt, 0, [zero], &starts, Execution::serial()).unwrap();
    for step in 0..=4096 {
        all.advance(1).unwrap();
        for (n, &latency) in long.iter().enumerate() {
            let acts = all.command(n).unwrap()[0] != zero;
            assert_eq!(acts, step >= latency, "{latency} {step}");
        }
    }
}

#[test]
fn each_trajectory_has_its_own_latency_of_what_it_observes() {
    let steps = |x: f64| Latency::of_steps(x).unwrap();
    let seen = [0.0, 0.25, 1.0, 1.75, 3.5].map(steps);
    let commands = [0.5, 0.0, 2.5, 0.5, 1.0].map(steps);
    let times = computed_at(Latencies::of_commands(&commands).with_observations(&seen), 5, 12);
    for ((seen, command), times) in seen.iter().zip(&commands).zip(&times) {
        for (n, &time) in times.iter().enumerate() {
            // Computed at a whole step, of the state as it was before.
            let saw = n as f64 - command.steps().trunc() - seen.steps();
            assert_eq!(time, if saw >= 0.0 { saw } else { BEFORE }, "{seen:?} {command:?} {n}");
        }
    }
}

#[test]
fn a_random_latency_and_a_packet_may_take_a_part_of_a_step() {
    // Free, from rest, under a command of 1 as soon as one arrives.
    let to = StateFeedback { gains: Feedback { position: 1.0, velocity: 0.0 }, target: [1.0] };
    let setup =
        Setup::new(All(BaselineOnly(Oscillator { omega2: 0.0 })), VelocityVerlet).controller(to);
    let table = RandomLatency::new(vec![(0.25, 1.0)], 0.0).unwrap();
    let start = [State { q: [0.0_f64], v: [0.0] }];
    let random = setup.delay(AnyDelay::Random(Random(&table)));
    let mut random = Loops::new(random, 1.0, 0, [0.0], &start, Execution::serial()).unwrap();
    random.advance(1).unwrap();
    let packets = Packets::new(&[1.0], Order::LastActs).unwrap();
    assert!(packets.longer_by(1.0).unwrap_err().to_string().contains("below 1"));
    let packets = setup.delay(AnyDelay::Packets(packets.longer_by(0.25).unwrap()));
    let mut packets = Loops::new(packets, 1.0, 0, [0.0], &start, Execution::serial()).unwrap();
    packets.advance(1).unwrap();
    let velocities = [random.state(0), packets.state(0)].map(|state| state.unwrap().v[0]);
    assert_eq!(velocities, [0.75; 2]);
}

#[test]
fn recorded_latencies_are_followed_step_by_step() {
    let latencies = [0.0, 1.0, 1.5, 3.0, 0.0, 2.0];
    let recorded = AnyDelay::Recorded(RecordedLatencies::new(&latencies).unwrap());
    let times = computed_at(recorded, 2, 6);
    assert_eq!(times[1], [0.0, 0.0, 1.0, 0.0, 4.0, 3.0]);
}

#[test]
fn random_latencies_follow_their_table_and_hold() {
    let table = RandomLatency::new(vec![(0.0, 0.5), (2.0, 0.3), (3.0, 0.2)], 0.75).unwrap();
    let times = computed_at(AnyDelay::Random(Random(&table)), 64, 1000);
    let (mut counts, mut stays) = ([0.0_f64; 4], 0.0);
    for times in &times {
        let latencies: Vec<usize> =
            times.iter().enumerate().skip(3).map(|(n, &time)| n - time as usize).collect();
        latencies.iter().for_each(|&latency| counts[latency] += 1.0 / 63_808.0);
        stays += latencies.windows(2).filter(|pair| pair[0] == pair[1]).count() as f64 / 63_744.0;
    }
    // An eighth of the draws is fresh: 8000, √(p(1 − p)/8000·7) < 0.015 with the memory; three times that.
    for (found, wanted) in counts.into_iter().zip([0.5, 0.0, 0.3, 0.2]) {
        assert!((found - wanted).abs() < 0.045, "{counts:?}");
    }
    // The hold, and a fresh draw of the same.
    let wanted = 0.75 + 0.25 * (0.25 + 0.09 + 0.04);
    assert!((stays - wanted).abs() < 0.01, "{stays} {wanted}");
}

#[test]
fn packets_overtake_each_other_by_the_rule_that_is_stated() {
    let probabilities = [0.4, 0.2, 0.2];
    let packets = |probabilities: &[f64], order| {
        AnyDelay::Packets(Packets::new(probabilities, order).unwrap())
    };
    let newest = computed_at(packets(&probabilities, Order::NewestActs), 64, 500);
    let last = computed_at(packets(&probabilities, Order::LastActs), 64, 500);
    let goes_back = |times: &Vec<f64>| times.windows(2).any(|pair| pair[1] < pair[0]);
    assert!(!newest.iter().any(goes_back));
    assert!(last.iter().all(goes_back));
    // What acts is as old as the command that was sent now if it takes no time, and so on: where the newest acts, it is of
    // this step with probability 0.4, and of this step or the last with 1 − 0.6·(1 − 0.6).
    let share = |times: &[Vec<f64>], age: f64| {
        let all = times.iter().flat_map(|one| one.iter().enumerate().skip(3));
        all.filter(|&(n, &time)| n as f64 - time <= age).count() as f64 / (64.0 * 497.0)
    };
    // √(p(1 − p)/31808) < 0.003 for what has no memory; four times that.
    assert!((share(&newest, 0.0) - 0.4).abs() < 0.012);
    assert!((share(&newest, 1.0) - 0.76).abs() < 0.012);
    // Nothing is lost where the probabilities are all.
    let sure = computed_at(packets(&[0.0, 1.0], Order::NewestActs), 1, 5);
    assert_eq!(sure[0], [BEFORE, 0.0, 1.0, 2.0, 3.0]);
    let lost = computed_at(packets(&[0.0], Order::NewestActs), 1, 5);
    assert_eq!(lost[0], [BEFORE; 5]);
}
