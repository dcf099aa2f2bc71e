//! Verdicts follow from what the audit measured: an energy that runs away and a step that is unstable are faults, and what is unknown is not good.

use libration_probe::{ProbeReport, Subject};
use libration_report::verdict::Outcome;

use crate::simulators::{
    Simulator, damped_pendulum, kinds, pendulum, pendulum_energy, pendulum_subject,
};

pub(crate) type Rates = fn(&[f64]) -> [f64; 2];

fn hardening(x: &[f64]) -> [f64; 2] {
    [x[1], -10.0 * x[0] - x[0].powi(3)]
}

fn hardening_energy(x: &[f64]) -> f64 {
    x[1] * x[1] / 2.0 + 5.0 * x[0] * x[0] + x[0].powi(4) / 4.0
}

fn explicit_euler(f: Rates, x: &[f64], dt: f64) -> Vec<f64> {
    let k = f(x);
    vec![x[0] + dt * k[0], x[1] + dt * k[1]]
}

pub(crate) fn rk4(f: Rates, x: &[f64], dt: f64) -> Vec<f64> {
    let at = |k: [f64; 2], h: f64| [x[0] + h * k[0], x[1] + h * k[1]];
    let a = f(x);
    let b = f(&at(a, dt / 2.0));
    let c = f(&at(b, dt / 2.0));
    let d = f(&at(c, dt));
    (0..2).map(|i| x[i] + dt / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i])).collect()
}

fn verlet(f: Rates, x: &[f64], dt: f64) -> Vec<f64> {
    let v = x[1] + dt / 2.0 * f(x)[1];
    let q = x[0] + dt * v;
    vec![q, v + dt / 2.0 * f(&[q, v])[1]]
}

/// A motion that is no equilibrium.
pub(crate) fn motion(state: [f64; 2], dt: f64, is_conservative: bool) -> Subject {
    let mut subject = Subject::new("spring", state.to_vec(), vec![], dt);
    subject.equilibrium = Some(false);
    subject.is_conservative = is_conservative;
    subject
}

pub(crate) fn change(report: &ProbeReport) -> f64 {
    report.defects.as_ref().unwrap().energy.as_ref().unwrap().change.unwrap()
}

#[test]
fn an_energy_that_diverges_in_the_run_of_the_audit_is_a_fault() {
    for is_conservative in [true, false] {
        let report = Simulator::new(|x, _, dt| explicit_euler(hardening, x, dt))
            .with_energy(hardening_energy)
            .audit(&motion([1.0, 0.0], 0.05, is_conservative));
        assert_eq!(kinds(&report), ["energy-drift"], "{}", report.answer);
        assert_eq!(report.verdict.outcome, Outcome::Fault);
        assert!(
            report.answer.contains("the energy diverges") && !report.answer.contains("No fault")
        );
    }
    // The same motion by a symplectic method.
    let report = Simulator::new(|x, _, dt| verlet(hardening, x, dt))
        .with_energy(hardening_energy)
        .audit(&motion([1.0, 0.0], 0.05, true));
    assert_eq!((kinds(&report), report.verdict.outcome), (vec![], Outcome::NoFault));
    assert_eq!(report.verdict.not_examined, ["stability along the motion"]);
}

#[test]
fn a_loss_of_the_step_is_a_fault_from_a_percent_of_the_energy_on() {
    // RK4 at ωh loses (ωh)⁶/72 of the energy per step, to first order.
    let oscillator: Rates = |x| [x[1], -x[0]];
    for (h, is_fault) in [(0.1_f64, false), (0.15, false), (0.2, true), (0.3, true)] {
        let mut subject = motion([1.0, 0.0], h, true);
        subject.equilibrium = None;
        subject.state = vec![0.0, 0.0];
        let report = Simulator::new(|x, _, dt| rk4(oscillator, x, dt))
            .with_energy(|x| (x[0] * x[0] + x[1] * x[1]) / 2.0)
            .audit(&subject);
        let lost = 20_000.0 * h.powi(6) / 72.0;
        let wanted = (-lost).exp_m1();
        // The next term of the loss is of relative order (ωh)².
        assert!((change(&report) / wanted - 1.0).abs() < h * h, "{} {wanted}", change(&report));
        assert_eq!(wanted < -0.01, is_fault);
        assert_eq!(kinds(&report) == ["energy-drift"], is_fault, "{h} {}", report.answer);
        assert_eq!(report.holds(), !is_fault);
        // Without an energy the modes have it.
        let report = Simulator::new(|x, _, dt| rk4(oscillator, x, dt)).audit(&subject);
        assert_eq!(kinds(&report) == ["energy-drift"], is_fault, "{h} {}", report.answer);
    }
}

#[test]
fn growth_by_the_step_is_a_fault_with_and_without_a_word_on_conservation() {
    // Partly implicit positions: det A = 1 + 0.4 ω²h².
    let growing = |x: &[f64], _: &[f64], dt: f64| {
        let v = x[1] - dt * 9.0 * x[0].sin();
        vec![x[0] + dt * (0.6 * v + 0.4 * x[1]), v]
    };
    for is_conservative in [true, false] {
        let mut subject = motion([1.0, 0.0], 0.02, is_conservative);
        let report = Simulator::new(growing).with_energy(pendulum_energy).audit(&subject);
        assert!(kinds(&report).contains(&"energy-drift"), "{}", report.answer);
        assert_eq!(report.verdict.outcome, Outcome::Fault);
        // At rest the modes say the same without an energy.
        (subject.state, subject.equilibrium) = (vec![0.0, 0.0], None);
        let report = Simulator::new(growing).audit(&subject);
        assert_eq!(kinds(&report), ["grows-always"]);
        assert_eq!(report.verdict.outcome, Outcome::Fault, "{}", report.answer);
        assert!(report.answer.contains("the step is unstable"), "{}", report.answer);
    }
}

#[test]
fn an_energy_that_grows_without_a_direction_is_a_fault_where_it_exceeds_itself() {
    // ωh = 2.4: beyond the limit of 2 at the bottom, the pendulum is thrown to rotations of any speed.
    for is_conservative in [true, false] {
        let report = Simulator::new(pendulum)
            .with_energy(pendulum_energy)
            .audit(&with_action(motion([1.0, 0.0], 0.8, is_conservative)));
        assert!(kinds(&report).contains(&"energy-drift"), "{}", report.answer);
    }
}

#[test]
fn the_energy_of_a_fall_is_compared_with_that_which_the_motion_exchanges() {
    // From beside the upright, where its energy is 9, a damped pendulum comes to rest at −9; at most 18 is energy of its speed.
    let mut subject = with_action(motion([core::f64::consts::PI, 0.0], 0.01, true));
    subject.equilibrium = Some(true);
    let report = Simulator::new(|x, u, dt| damped_pendulum(0.02, x, u, dt))
        .with_energy(pendulum_energy)
        .audit(&subject);
    assert!((-1.8..=-0.5).contains(&change(&report)), "{}", report.answer);
}

#[test]
fn a_mode_that_changes_its_sign_in_each_step_has_no_damping_that_the_step_adds() {
    // Symplectic Euler with ωh = 2.1: factors z² + 2.41 z + 1 = 0, −0.534 and −1.876.
    let spring = |x: &[f64], _: &[f64], dt: f64| {
        let v = x[1] - dt * 441.0 * x[0];
        vec![x[0] + dt * v, v]
    };
    let report = Simulator::new(spring).audit(&Subject::new("spring", vec![0.0, 0.0], vec![], 0.1));
    assert!(report.modes.iter().all(|mode| mode.numerical_damping.is_none()), "{:?}", report.modes);
    assert_eq!(report.verdict.outcome, Outcome::Fault, "{}", report.answer);
}

/// `x″ = 9x` grows at 3 1/s. Backward Euler has the factors 1/(1 ∓ 3h): −0.2 for h = 2, −1.25 for 0.6, and 1.03093 for 0.01.
#[test]
fn a_step_that_does_not_follow_a_growing_mode_is_not_without_fault() {
    // Implicit midpoint with h = 1: (1 + 3/2)/(1 − 3/2) = −5, more than half the rate of the exact e³, but with another sign in each step.
    let midpoint = |x: &[f64], _: &[f64], h: f64| {
        let (a, d) = (1.0 + 2.25 * h * h, 1.0 - 2.25 * h * h);
        vec![(a * x[0] + h * x[1]) / d, (9.0 * h * x[0] + a * x[1]) / d]
    };
    let turned =
        Simulator::new(midpoint).audit(&Subject::new("falling", vec![0.0; 2], vec![], 1.0));
    assert_eq!(turned.verdict.outcome, Outcome::NotResolved, "{}", turned.answer);
    let step = |x: &[f64], _: &[f64], h: f64| {
        let d = 1.0 - 9.0 * h * h;
        vec![(x[0] + h * x[1]) / d, (x[1] + 9.0 * h * x[0]) / d]
    };
    for (dt, outcome) in
        [(2.0, Outcome::NotResolved), (0.6, Outcome::NotResolved), (0.01, Outcome::NoFault)]
    {
        let subject = Subject::new("falling", vec![0.0, 0.0], vec![], dt);
        let report = Simulator::new(step).audit(&subject);
        assert_eq!(report.verdict.outcome, outcome, "{dt}: {}", report.answer);
        assert_eq!(report.answer.contains("No fault"), outcome.is_good(), "{}", report.answer);
    }
}

fn with_action(mut subject: Subject) -> Subject {
    let other = pendulum_subject();
    (subject.inputs, subject.action, subject.action_scale) =
        (other.inputs, other.action, other.action_scale);
    subject
}

#[test]
fn growth_of_the_system_is_no_fault_of_its_step() {
    // Inverted oscillators leave the finite numbers at any step, also where their energy is conserved.
    let inverted: Rates = |x| [x[1], x[0]];
    let energy = |x: &[f64]| (x[1] * x[1] - x[0] * x[0]) / 2.0;
    for is_conservative in [true, false] {
        let mut subject = motion([0.0, 0.0], 0.1, is_conservative);
        subject.equilibrium = None;
        let report =
            Simulator::new(|x, _, dt| verlet(inverted, x, dt)).with_energy(energy).audit(&subject);
        assert_eq!(kinds(&report), [""; 0], "{}", report.answer);
        assert_ne!(report.verdict.outcome, Outcome::Fault);
        assert!(report.verdict.is_good() != is_conservative, "{}", report.answer);
    }
    // ẋ = x by backward Euler grows faster than the system, but by half a percent of its rate.
    let subject = Subject::new("growth", vec![0.0], vec![], 0.01);
    let report = Simulator::new(|x, _, dt| vec![x[0] / (1.0 - dt)])
        .with_energy(|x| x[0] * x[0])
        .audit(&subject);
    assert_eq!(kinds(&report), [""; 0], "{}", report.answer);
    // A limit cycle of van der Pol, from within.
    let cycle: Rates = |x| [x[1], (1.0 - x[0] * x[0]) * x[1] - x[0]];
    let report = Simulator::new(|x, _, dt| rk4(cycle, x, dt))
        .with_energy(|x| (x[0] * x[0] + x[1] * x[1]) / 2.0)
        .audit(&Subject::new("cycle", vec![0.0, 0.0], vec![], 0.01));
    assert!(!kinds(&report).contains(&"energy-drift"), "{}", report.answer);
}

#[test]
fn an_unstable_step_and_no_fault_are_never_in_one_text() {
    let explicit = |x: &[f64], u: &[f64], dt: f64| {
        vec![x[0] + dt * x[1], x[1] + dt * (-9.0 * x[0].sin() + u[0])]
    };
    let at = |angle: f64, dt: f64, has_fixed_dt: bool| {
        let mut subject = pendulum_subject();
        (subject.state[0], subject.dt, subject.has_fixed_dt) = (angle, dt, has_fixed_dt);
        subject
    };
    let upright = core::f64::consts::PI;
    for (report, outcome) in [
        (Simulator::new(explicit).audit(&at(0.0, 0.01, false)), Outcome::Fault),
        (Simulator::new(explicit).audit(&at(0.0, 0.01, true)), Outcome::Unknown),
        (Simulator::new(pendulum).audit(&at(upright, 0.01, false)), Outcome::NoFault),
        // With one length the growth may be that of the step.
        (Simulator::new(pendulum).audit(&at(upright, 0.01, true)), Outcome::Unknown),
        (Simulator::new(pendulum).audit(&at(0.0, 0.7, false)), Outcome::Fault),
        (Simulator::new(pendulum).audit(&at(0.0, 0.7, true)), Outcome::Unknown),
        // On a motion the limit at a point is no proof.
        (Simulator::new(pendulum).audit(&at(0.4, 0.7, false)), Outcome::Unknown),
    ] {
        assert_eq!(report.verdict.outcome, outcome, "{}", report.answer);
        let says = |part: &str| report.answer.contains(part);
        assert!(!(says("is unstable") && says("No fault")), "{}", report.answer);
        assert_eq!(says("No fault"), outcome == Outcome::NoFault, "{}", report.answer);
        assert_eq!(says("is unknown"), outcome == Outcome::Unknown, "{}", report.answer);
        assert_eq!(report.holds(), outcome == Outcome::NoFault);
        let page = libration_probe::page(&report);
        assert_eq!(page.contains("has no fault"), outcome == Outcome::NoFault);
    }
}

#[test]
fn a_step_without_a_derivative_has_no_good_verdict() {
    // A contact that begins there.
    let contact = |x: &[f64], _: &[f64], dt: f64| {
        let v = x[1] - dt * 9.0 * x[0].max(0.0);
        vec![x[0] + dt * v, v]
    };
    let report = Simulator::new(contact).audit(&Subject::new("contact", vec![0.0; 2], vec![], 0.1));
    assert!(kinds(&report).contains(&"not-differentiable"), "{}", report.answer);
    assert_eq!(report.verdict.outcome, Outcome::Unknown, "{}", report.answer);
}

/// An action that the simulator reads through `read`.
fn audit_of_action(read: fn(f64) -> f64) -> ProbeReport {
    let step = |x: &[f64], u: &[f64], dt: f64| pendulum(x, &[read(u[0])], dt);
    Simulator::new(step).audit(&pendulum_subject())
}

#[test]
fn an_action_without_a_proportional_effect_has_no_good_verdict() {
    // A quantised action, a dead zone, two limits, a switch, an action that is not used, and one of its sides only.
    let readings: [fn(f64) -> f64; 7] = [
        |u| (127.0 * u).round() / 127.0,
        |u| u - u.clamp(-0.05, 0.05),
        |u| u.clamp(-0.1, 0.1),
        |u| u.clamp(-0.02, 0.02),
        |u| if u == 0.0 { 0.0 } else { u.signum() },
        |_| 0.0,
        |u| u.max(0.0),
    ];
    for (i, read) in readings.into_iter().enumerate() {
        let report = audit_of_action(read);
        assert!(!report.verdict.is_good(), "{i}: {}", report.answer);
    }
    // Weak, strong and slightly curved actions are good.
    let readings: [fn(f64) -> f64; 3] = [|u| 1e-3 * u, |u| 30.0 * u, |u| u + 0.2 * u * u];
    for (i, read) in readings.into_iter().enumerate() {
        let report = audit_of_action(read);
        assert!(report.verdict.is_good(), "{i}: {}", report.answer);
    }
}

#[test]
fn growth_that_is_not_measurable_is_stated_as_a_bound() {
    // Explicit Euler at ωh = 10⁻⁷ grows by (ωh)²/2 = 5·10⁻¹⁵ per step: below any difference of results.
    let euler = |x: &[f64], _: &[f64], dt: f64| vec![x[0] + dt * x[1], x[1] - dt * 1e-4 * x[0]];
    let mut subject = motion([0.0, 0.0], 1e-5, false);
    subject.equilibrium = None;
    let report = Simulator::new(euler).audit(&subject);
    let is_bound = |text: &str| text.contains("per step") && text.contains("is not measurable");
    assert_eq!(report.verdict.outcome, Outcome::NoFault, "{}", report.verdict);
    assert!(is_bound(&report.verdict.evidence), "{}", report.verdict);
    assert!(is_bound(&report.answer), "{}", report.answer);
}
