//! What a step remembers of earlier calls is found and named.

use std::cell::{Cell, RefCell};
use std::collections::VecDeque;

use crate::simulators::{Simulator, damped_pendulum, kinds, pendulum, pendulum_subject};

#[test]
fn a_command_that_is_one_step_late_is_found_and_does_not_spoil_the_matrices() {
    let clean = Simulator::new(pendulum).audit(&pendulum_subject());
    let held = Cell::new(0.0);
    let late = Simulator::new(move |x, u, dt| pendulum(x, &[held.replace(u[0])], dt));
    let report = late.audit(&pendulum_subject());
    assert_eq!(kinds(&report), ["late-command"]);
    assert_eq!(report.hidden_latency[0].late_steps, Some(1.0));
    assert_eq!(report.step.unwrap().b, clean.step.unwrap().b);
}

#[test]
fn a_command_between_two_and_three_steps_late_has_its_fraction() {
    let queue = RefCell::new(VecDeque::from([0.0; 4]));
    let late = Simulator::new(move |x, u, dt| {
        let mut queue = queue.borrow_mut();
        queue.push_front(u[0]);
        queue.truncate(4);
        pendulum(x, &[0.6 * queue[2] + 0.4 * queue[3]], dt)
    });
    let report = late.audit(&pendulum_subject());
    assert_eq!(kinds(&report), ["late-command"]);
    // Rounding of forces of 1/64 beside positions of order one.
    assert!((report.hidden_latency[0].late_steps.unwrap() - 2.4).abs() < 1e-6, "{report:?}");
}

#[test]
fn a_stale_observation_is_found() {
    let mut simulator = Simulator::new(pendulum);
    let held = RefCell::new(vec![0.0, 0.0]);
    simulator.observe = Some(Box::new(move |x| held.replace(x.to_vec())));
    let report = simulator.audit(&pendulum_subject());
    assert_eq!(kinds(&report), ["stale-observation"]);
    assert_eq!(report.memory.unwrap().staleness(), 1.0);
    let mut fresh = Simulator::new(pendulum);
    fresh.observe = Some(Box::new(|x| vec![x[0].cos(), x[0].sin(), x[1]]));
    assert_eq!(kinds(&fresh.audit(&pendulum_subject())), [""; 0]);
}

#[test]
fn an_observation_that_is_stored_before_the_update_or_never_changes_is_found() {
    let audit = |sees: fn(&[f64]) -> f64, is_before: bool| {
        let stored = Cell::new(0.0);
        let mut simulator = Simulator::new(|x, u, dt| {
            let next = pendulum(x, u, dt);
            stored.set(sees(if is_before { x } else { &next }));
            next
        });
        simulator.observe = Some(Box::new(|_| vec![stored.get()]));
        let report = simulator.audit(&pendulum_subject());
        (kinds(&report), report.memory.unwrap().staleness())
    };
    for sees in [|x: &[f64]| x[0], |x: &[f64]| x[1], |x: &[f64]| x[0].cos() * x[1]] {
        assert_eq!(audit(sees, true), (vec!["stale-observation"], 1.0));
        assert_eq!(audit(sees, false), (vec![], 0.0));
    }
    assert_eq!(audit(|_| 3.0, false), (vec!["constant-observation"], 0.0));
}

#[test]
fn a_filter_of_commands_is_a_hidden_state_and_the_states_are_audited() {
    for tau in [0.05, 0.3, 0.8, 2.0] {
        let filtered = Cell::new(0.0);
        let report = Simulator::new(|x, u, dt| {
            filtered.set(filtered.get() + (u[0] - filtered.get()) * (1.0 - (-dt / tau).exp()));
            damped_pendulum(0.3, x, &[filtered.get()], dt)
        })
        .audit(&pendulum_subject());
        assert_eq!(kinds(&report), ["hidden-state"], "{:?}", report.findings);
        let memory = report.memory.as_ref().unwrap();
        let found = memory.settling.as_ref().unwrap();
        // Differences of 10⁻⁴ or less with roundings of 10⁻¹⁶ beside forces of order one.
        assert!((found.time_constant - tau).abs() < 1e-3 * tau, "{found:?}");
        // 0.8 s are 80 steps, forgotten in 3,700 calls; what lasts 2 s is not gone after 4,096 calls, and no audit can be made.
        assert_eq!(report.modes.is_empty(), tau > 1.0, "{report:?}");
    }
}

#[test]
fn a_hidden_state_of_states_is_no_filter_of_commands() {
    let filtered = Cell::new(0.0);
    let report = Simulator::new(|x, u, dt| {
        filtered.set(filtered.get() + 0.1 * (x[1] - filtered.get()));
        damped_pendulum(0.3, &[x[0], filtered.get()], u, dt)
    })
    .audit(&pendulum_subject());
    assert_eq!(kinds(&report), ["hidden-state"], "{:?}", report.findings);
    assert_eq!(report.memory.unwrap().settling.unwrap().is_of_commands, Some(false));
    assert!(report.modes.is_empty());
    // Without actions there are none to hold.
    let filtered = Cell::new(0.0);
    let mut subject = pendulum_subject();
    (subject.action, subject.action_scale, subject.inputs) = (vec![], vec![], vec![]);
    let report = Simulator::new(|x, _, dt| {
        filtered.set(filtered.get() + 0.1 * (x[1] - filtered.get()));
        damped_pendulum(0.3, &[x[0], filtered.get()], &[0.0], dt)
    })
    .audit(&subject);
    assert_eq!(kinds(&report), ["hidden-state"], "{:?}", report.findings);
    assert!(report.modes.is_empty());
}

#[test]
fn a_delay_that_alternates_is_late_by_its_mean() {
    let calls = Cell::new(0);
    let queue = RefCell::new([0.0; 3]);
    let late = Simulator::new(|x, u, dt| {
        calls.set(calls.get() + 1);
        let mut queue = queue.borrow_mut();
        *queue = [u[0], queue[0], queue[1]];
        pendulum(x, &[queue[1 + calls.get() % 2]], dt)
    });
    let report = late.audit(&pendulum_subject());
    assert_eq!(kinds(&report), ["late-command", "irregular-delay"], "{:?}", report.findings);
    assert!((report.hidden_latency[0].late_steps.unwrap() - 1.5).abs() < 1e-12, "{report:?}");
}

#[test]
fn states_of_the_call_before_are_found() {
    let held = RefCell::new(vec![0.0, 0.0]);
    let late = Simulator::new(move |x, u, dt| pendulum(&held.replace(x.to_vec()), u, dt));
    assert_eq!(kinds(&late.audit(&pendulum_subject())), ["late-state"]);
}

#[test]
fn a_delay_that_changes_after_many_steps_is_found_with_its_shares() {
    let queue = RefCell::new(VecDeque::from([0.0; 4]));
    let calls = Cell::new(0);
    let late = Simulator::new(move |x, u, dt| {
        let mut queue = queue.borrow_mut();
        queue.push_front(u[0]);
        queue.truncate(4);
        calls.set(calls.get() + 1);
        let delay = if calls.get() < 60_000 { 2 } else { 3 };
        pendulum(x, &[queue[delay]], dt)
    });
    let report = late.audit(&pendulum_subject());
    assert!(kinds(&report).contains(&"irregular-delay"), "{:?}", report.findings);
    let [(2.0, two), (3.0, three)] = report.delays[0].delays[..] else { panic!("{report:?}") };
    assert!(two > 20_000 && three > 10_000, "{two} {three}");
}

/// A pendulum whose commands act 30 ms late, whatever the step, in a queue of times and commands.
fn late_by_seconds(
    now: &Cell<f64>,
    queue: &RefCell<VecDeque<(f64, f64)>>,
    x: &[f64],
    u: f64,
    dt: f64,
) -> Vec<f64> {
    let mut queue = queue.borrow_mut();
    queue.push_front((now.get(), u));
    queue.truncate(1000);
    // Half a step, so that rounded times do not matter.
    let used = queue.iter().find(|(time, _)| *time <= now.get() - 0.03 + dt / 2.0);
    let used = used.map_or(0.0, |(_, u)| *u);
    now.set(now.get() + dt);
    pendulum(x, &[used], dt)
}

#[test]
fn a_delay_in_seconds_that_the_simulator_states_is_no_finding_and_is_flushed_at_any_step() {
    let (now, queue) = (Cell::new(0.0), RefCell::new(VecDeque::new()));
    let late = || Simulator::new(|x, u, dt| late_by_seconds(&now, &queue, x, u[0], dt));
    let mut subject = pendulum_subject();
    let report = late().audit(&subject);
    assert_eq!(kinds(&report), ["late-command"]);
    let latency = &report.hidden_latency[0];
    assert!((latency.late.unwrap() - 0.03).abs() < 1e-9, "{latency:?}");
    // The gain in the limit of small steps, and with it the half step by which the integrator is early.
    assert!((report.flow.as_ref().unwrap().b[(1, 0)] - 1.0).abs() < 1e-9, "{:?}", report.flow);
    assert!((latency.integrator_delay.unwrap() + 0.005).abs() < 1e-5, "{latency:?}");
    subject.stated_delays = vec![0.03];
    assert_eq!(kinds(&late().audit(&subject)), [""; 0]);
    subject.stated_delays = vec![0.02];
    let report = late().audit(&subject);
    assert!(
        report.findings[0].text.contains("acts 3 steps late (0.03 s) on average, 2 steps stated"),
        "{:?}",
        report.findings
    );
}

#[test]
fn a_command_that_is_late_now_and_then_is_found() {
    let (calls, held) = (Cell::new(0), Cell::new(0.0));
    let late = Simulator::new(|x, u, dt| {
        calls.set(calls.get() + 1);
        let before = held.replace(u[0]);
        pendulum(x, &[if calls.get() % 997 == 0 { before } else { u[0] }], dt)
    });
    assert!(kinds(&late.audit(&pendulum_subject())).contains(&"irregular-delay"));
}

#[test]
fn one_stale_component_of_an_observation_is_enough() {
    let before = RefCell::new(vec![0.0, 0.0]);
    let mut simulator = Simulator::new(|x, u, dt| {
        *before.borrow_mut() = x.to_vec();
        pendulum(x, u, dt)
    });
    simulator.observe = Some(Box::new(|x| vec![x[0], before.borrow()[1]]));
    assert_eq!(kinds(&simulator.audit(&pendulum_subject())), ["stale-observation"]);
}

#[test]
fn observations_that_vary_are_found_and_do_not_end_the_audit() {
    let draws = Cell::new(1_u64);
    let mut simulator = Simulator::new(pendulum);
    simulator.observe = Some(Box::new(|x| {
        draws.set(draws.get().wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1));
        vec![x[0] + (draws.get() >> 11) as f64 * 1e-20]
    }));
    let report = simulator.audit(&pendulum_subject());
    assert_eq!(kinds(&report), ["not-reproducible"]);
    assert!(report.largest_dt.is_some());
}

#[test]
fn a_command_that_is_late_in_each_seventh_call_is_found() {
    for period in [5, 7, 50, 128] {
        let (calls, held) = (Cell::new(0), Cell::new(0.0));
        let late = Simulator::new(|x, u, dt| {
            calls.set(calls.get() + 1);
            let before = held.replace(u[0]);
            pendulum(x, &[if calls.get() % period == 0 { before } else { u[0] }], dt)
        });
        let found = kinds(&late.audit(&pendulum_subject()));
        assert!(found.contains(&"irregular-delay"), "{period} {found:?}");
    }
}

#[test]
fn a_command_that_acts_and_takes_half_back_is_early() {
    let held = Cell::new(0.0);
    let lead = Simulator::new(|x, u, dt| pendulum(x, &[2.0 * u[0] - held.replace(u[0])], dt));
    let report = lead.audit(&pendulum_subject());
    // (0·2 + 1·(−1))/(2 − 1).
    assert!((report.hidden_latency[0].late_steps.unwrap() + 1.0).abs() < 1e-9, "{report:?}");
}

#[test]
fn a_force_of_time_is_no_filter() {
    let now = Cell::new(0.0);
    let driven = Simulator::new(|x, u, dt| {
        now.set(now.get() + dt);
        pendulum(x, &[u[0] + 0.1 * f64::sin(now.get())], dt)
    });
    assert_eq!(kinds(&driven.audit(&pendulum_subject())), ["not-reproducible"]);
}
