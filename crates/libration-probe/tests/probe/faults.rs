//! Faults that are planted on purpose are found and named.

use std::cell::{Cell, RefCell};
use std::collections::VecDeque;

use crate::simulators::{
    Simulator, damped_pendulum, kinds, pendulum, pendulum_energy, pendulum_subject,
};

#[test]
fn a_clean_step_has_no_finding() {
    let mut subject = pendulum_subject();
    subject.is_conservative = true;
    let report = Simulator::new(pendulum).with_energy(pendulum_energy).audit(&subject);
    assert_eq!(report.findings, [], "{}", report.answer);
    let mut batched = Simulator::new(pendulum);
    batched.is_batched = true;
    assert_eq!(kinds(&batched.audit(&pendulum_subject())), [""; 0]);
    let damped = Simulator::new(|x, u, dt| damped_pendulum(0.3, x, u, dt));
    assert_eq!(kinds(&damped.audit(&pendulum_subject())), [""; 0]);
}

#[test]
fn a_command_that_is_one_step_late_is_found_and_does_not_spoil_the_matrices() {
    let clean = Simulator::new(pendulum).audit(&pendulum_subject());
    let held = Cell::new(0.0);
    let late = Simulator::new(move |x, u, dt| pendulum(x, &[held.replace(u[0])], dt));
    let report = late.audit(&pendulum_subject());
    assert_eq!(kinds(&report), ["late-command"]);
    assert_eq!(report.hidden_latency[0].late_steps, 1.0);
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
    assert!((report.hidden_latency[0].late_steps - 2.4).abs() < 1e-6, "{report:?}");
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
    for tau in [0.05, 0.3, 2.0] {
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
        // 0.05 s are forgotten in 200 calls; what lasts 2 s is not gone after 4,096 calls, and no audit can be made.
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
    assert!(!report.memory.unwrap().settling.unwrap().is_of_commands);
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
    assert!((report.hidden_latency[0].late_steps - 1.5).abs() < 1e-12, "{report:?}");
}

#[test]
fn an_action_or_a_length_in_single_precision_is_found_and_named() {
    let single = |x: f64| f64::from(x as f32);
    let audit = |step: &dyn Fn(&[f64], &[f64], f64) -> Vec<f64>| {
        let report = Simulator::new(step).audit(&pendulum_subject());
        report.findings.iter().map(|found| found.text.clone()).collect::<Vec<_>>()
    };
    let action = audit(&|x, u, dt| pendulum(x, &[single(u[0])], dt));
    assert_eq!(action, ["the step rounds `u1` to single precision"]);
    let length = audit(&|x, u, dt| pendulum(x, u, single(dt)));
    assert_eq!(length, ["the step rounds dt to single precision"]);
    // A weak action is no rounded one, nor is a limit.
    assert_eq!(audit(&|x, u, dt| pendulum(x, &[1e-6 * u[0]], dt)), [""; 0]);
    assert_eq!(audit(&|x, u, dt| pendulum(x, &[u[0].min(0.013 + 3e-6)], dt)), [""; 0]);
}

#[test]
fn states_of_the_call_before_are_found() {
    let held = RefCell::new(vec![0.0, 0.0]);
    let late = Simulator::new(move |x, u, dt| pendulum(&held.replace(x.to_vec()), u, dt));
    assert_eq!(kinds(&late.audit(&pendulum_subject())), ["late-state"]);
}

#[test]
fn damping_with_the_wrong_sign_is_found_but_an_unstable_equilibrium_is_no_fault() {
    let driven = Simulator::new(|x, u, dt| damped_pendulum(-0.1, x, u, dt));
    let report = driven.audit(&pendulum_subject());
    assert_eq!((kinds(&report), report.holds()), (vec!["negative-damping"], true));
    let rate = report.driven_velocities[0].rate;
    assert!((rate - 0.1).abs() < 1e-8, "{rate}");
    let mut upright = pendulum_subject();
    upright.state[0] = core::f64::consts::PI;
    assert_eq!(kinds(&Simulator::new(pendulum).audit(&upright)), [""; 0]);
}

#[test]
fn an_energy_that_leaks_a_millionth_per_second_is_found() {
    // The energy falls with γ, on average over an oscillation.
    let leaking = || Simulator::new(|x, u, dt| damped_pendulum(1e-6, x, u, dt));
    let mut subject = pendulum_subject();
    subject.is_conservative = true;
    for report in
        [leaking().audit(&subject), leaking().with_energy(pendulum_energy).audit(&subject)]
    {
        assert_eq!(kinds(&report), ["energy-leak"], "{:?}", report.defects);
    }
}

#[test]
fn a_batch_that_differs_in_the_last_bit_is_found_and_located() {
    let mut simulator = Simulator::new(pendulum);
    simulator.is_batched = true;
    simulator.spoil = Some(4096);
    let report = simulator.audit(&pendulum_subject());
    assert_eq!(kinds(&report), ["bits-differ"]);
    let text = &report.findings[0].text;
    assert!(
        text.contains("first in environment 4095, component 1") && text.contains("1 ulps"),
        "{text}"
    );
}

#[test]
fn a_step_in_single_precision_is_found_also_if_it_returns_double_precision() {
    let single = |x: f64| f64::from(x as f32);
    let inside = Simulator::new(move |x, u, dt| {
        let v = x[1] + dt * (-9.0 * single(single(x[0]).sin()) + u[0]);
        vec![x[0] + dt * v, v]
    });
    let whole = Simulator::new(move |x, u, dt| {
        let x: Vec<f64> = x.iter().map(|x| single(*x)).collect();
        pendulum(&x, u, dt).into_iter().map(single).collect()
    });
    for simulator in [inside, whole] {
        let report = simulator.audit(&pendulum_subject());
        assert!(kinds(&report).contains(&"single-precision"), "{:?}", report.findings);
    }
}

#[test]
fn random_numbers_are_found_and_end_the_audit() {
    let draws = Cell::new(1_u64);
    let noisy = Simulator::new(move |x, u, dt| {
        draws.set(draws.get().wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1));
        let noise = (draws.get() >> 11) as f64 / (1_u64 << 53) as f64 - 0.5;
        pendulum(x, &[u[0] + noise], dt)
    });
    let report = noisy.audit(&pendulum_subject());
    assert_eq!(kinds(&report), ["not-reproducible"]);
    assert!(report.step.is_none() && report.answer.starts_with("One fault"), "{}", report.answer);
}

#[test]
fn a_simulator_that_ignores_dt_is_found() {
    let fixed = Simulator::new(|x, u, _| pendulum(x, u, 0.01));
    let report = fixed.audit(&pendulum_subject());
    assert_eq!(kinds(&report), ["ignores-dt"]);
    assert!(report.flow.is_none() && !report.modes.is_empty());
}

#[test]
fn a_state_that_is_no_equilibrium_is_a_warning_unless_it_is_said_to_be_none() {
    let mut subject = pendulum_subject();
    subject.state[0] = 0.5;
    let report = Simulator::new(pendulum).audit(&subject);
    assert_eq!((kinds(&report), report.holds()), (vec!["no-equilibrium"], true));
    subject.equilibrium = Some(false);
    assert_eq!(kinds(&Simulator::new(pendulum).audit(&subject)), [""; 0]);
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
    assert!((latency.late - 0.03).abs() < 1e-9, "{latency:?}");
    // The gain in the limit of small steps, and with it the half step by which the integrator is early.
    assert!((report.flow.as_ref().unwrap().b[(1, 0)] - 1.0).abs() < 1e-9, "{:?}", report.flow);
    assert!((latency.integrator_delay.unwrap() + 0.005).abs() < 1e-5, "{latency:?}");
    subject.stated_delays = vec![0.03];
    assert_eq!(kinds(&late().audit(&subject)), [""; 0]);
    subject.stated_delays = vec![0.02];
    let report = late().audit(&subject);
    assert!(
        report.findings[0]
            .text
            .contains("acts 3.000 steps late (0.0300 s) on average, 2.000 are stated"),
        "{:?}",
        report.findings
    );
}

#[test]
fn damping_with_the_wrong_sign_is_found_also_where_nothing_oscillates() {
    let driven = Simulator::new(|x, _, dt| {
        let v = x[1] + dt * (-x[0] + 5.0 * x[1]);
        vec![x[0] + dt * v, v]
    });
    assert!(kinds(&driven.audit(&pendulum_subject())).contains(&"negative-damping"));
}

#[test]
fn a_rough_step_is_no_step_in_single_precision() {
    // A smooth function of short waves is neither.
    let waves = Simulator::new(|x, u, dt| pendulum(x, &[u[0] + (1e4 * x[0]).sin() / 1e4], dt));
    assert!(!kinds(&waves.audit(&pendulum_subject())).contains(&"single-precision"));
    // Noise by the bits of the state, and the tolerance of an iterative solver.
    let hashed =
        |x: f64| (x.to_bits().wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 40) as f64 / 16_777_216.0;
    for size in [1e-3, 1e-7] {
        let rough = Simulator::new(|x, u, dt| {
            let next = pendulum(x, u, dt);
            vec![next[0], next[1] + size * (hashed(x[0]) - 0.5)]
        });
        let found = kinds(&rough.audit(&pendulum_subject()));
        assert!(found.contains(&"rough") && !found.contains(&"single-precision"), "{found:?}");
    }
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
fn a_step_that_diverges_is_audited_and_called_unstable() {
    // Rates of −1 and −10⁶ by explicit Euler.
    let stiff = Simulator::new(|x, _, dt| vec![x[0] - dt * x[0], x[1] - dt * 1e6 * x[1]]);
    let report = stiff.audit(&libration_probe::Subject::new("stiff", vec![0.0, 0.0], vec![], 0.01));
    assert!(kinds(&report).contains(&"unstable-step"), "{:?}", report.findings);
    assert!((report.largest_dt.unwrap().dt.unwrap() - 2e-6).abs() < 1e-11);
}
