//! Tests of advised steps against independent simulations.

use std::f64::consts::TAU;

use libration::control::Feedback;
use libration::system::{Kepler, Oscillator, Pendulum};
use libration::{AnySystem, Hamiltonian, Integrator, Method, State, System};
use libration_advise::{Measure, Request, Tolerance};

use super::case::{Case, at_start};
use super::requests::advice;

pub(crate) fn free(
    system: AnySystem,
    q: &[f64],
    v: &[f64],
    of: Measure,
    most: f64,
    horizon: f64,
) -> Request {
    let system = at_start(system, q, v);
    Request { rollout: [64, 64], ..Request::new(system, Tolerance { of, most }, horizon) }
}

/// The fewest steps that cover a horizon.
fn steps_over(horizon: f64, dt: f64) -> u64 {
    ((horizon / dt) * (1.0 - 1e-12)).ceil() as u64
}

#[test]
fn every_integrator_gets_the_largest_step_that_meets_the_tolerance() {
    let oscillator = Oscillator { omega2: 10.0 };
    // The largest distance from cos and sin, and of Kepler's and the pendulum's energy, relative to the mean kinetic energy.
    let trajectory = |method: Method, dt: f64| {
        let (omega, mut largest) = (10.0_f64.sqrt(), 0.0_f64);
        let mut state = State { q: [1.0], v: [0.0] };
        for n in 1..=steps_over(8.0, dt) {
            state = method.step(&oscillator, state, dt);
            let (sine, cosine) = (omega * n as f64 * dt).sin_cos();
            largest = largest.max((state.q[0] - cosine).hypot(state.v[0] / omega + sine));
        }
        largest
    };
    fn energy<Sys: Hamiltonian<f64, D>, const D: usize>(
        system: &Sys,
        start: State<f64, D>,
        horizon: f64,
    ) -> impl Fn(Method, f64) -> f64 {
        // The mean of ½v² over 2·10⁵ steps of RK4; that of the advice is off by parts of a thousand.
        let mean = |(state, mean): (State<f64, D>, f64), _| {
            let state = Method::Rk4.step(system, state, horizon / 2e5);
            (state, mean + 0.5 / 2e5 * state.v.iter().map(|v| v * v).sum::<f64>())
        };
        let (_, scale) = (0..200_000).fold((start, 0.0), mean);
        move |method, dt| {
            let first = system.energy(&start);
            let (mut state, mut largest) = (start, 0.0_f64);
            for _ in 0..steps_over(horizon, dt) {
                state = method.step(system, state, dt);
                let off = ((system.energy(&state) - first) / scale).abs();
                largest = if off.is_finite() { largest.max(off) } else { f64::INFINITY };
            }
            largest / 1.005
        }
    }
    // By how much the angle in the plane of q and v/ω is off in the end, with all its turns.
    let phase = |method: Method, dt: f64| {
        let (omega, mut ahead) = (10.0_f64.sqrt(), 0.0_f64);
        let mut state = State { q: [1.0], v: [0.0] };
        for _ in 0..steps_over(60.0, dt) {
            let next = method.step(&oscillator, state, dt);
            let [a, b] = [state, next].map(|y| (-y.v[0] / omega).atan2(y.q[0]));
            // A step is off by less than half a turn.
            let turn = b - a - omega * dt;
            ahead += turn - TAU * (turn / TAU).round();
            state = next;
            // A swing that is twice as large or half has no phase to speak of.
            if !(0.5..2.0).contains(&state.q[0].hypot(state.v[0] / omega)) {
                return f64::INFINITY;
            }
        }
        // The advice takes ω from samples of the motion, and is off by parts of a thousand.
        ahead.abs() / 1.005
    };
    // The largest distance from steps of order four of a ten-thousandth of a second.
    let far = |method: Method, dt: f64| {
        let pendulum = Pendulum { omega2: 9.81 };
        let mut states = [State { q: [2.0], v: [0.0] }; 2];
        let (mut off, mut far, mut fast) = (Vec::new(), 0.0_f64, 0.0_f64);
        for _ in 0..steps_over(6.0, dt) {
            let parts = (dt / 1e-4).ceil();
            states[0] = method.step(&pendulum, states[0], dt);
            for _ in 0..parts as u64 {
                states[1] = Method::Rk4.step(&pendulum, states[1], dt / parts);
                let State { q: [q], v: [v] } = states[1];
                (far, fast) = (far.max(q.abs()), fast.max(v.abs()));
            }
            let [own, truth] = states;
            off.push([own.q[0] - truth.q[0], own.v[0] - truth.v[0]]);
        }
        let omega = fast / far.max(2.0);
        off.into_iter().map(|[q, v]| q.hypot(v / omega)).fold(0.0, f64::max) / far.max(2.0)
    };
    let (kepler, pendulum) = (Kepler { mu: 1.0 }, Pendulum { omega2: 9.81 });
    let orbit = State { q: [1.0, 0.0], v: [0.0, 1.1] };
    let swing = State { q: [1.0], v: [0.0] };
    type Lost<'a> = Box<dyn Fn(Method, f64) -> f64 + 'a>;
    let cases: [(Request, Lost<'_>); 5] = [
        (
            free(AnySystem::Oscillator(oscillator), &[1.0], &[0.0], Measure::Trajectory, 1e-2, 8.0),
            Box::new(trajectory),
        ),
        (
            free(AnySystem::Oscillator(oscillator), &[1.0], &[0.0], Measure::Phase, 0.1, 60.0),
            Box::new(phase),
        ),
        (
            free(AnySystem::Pendulum(pendulum), &[2.0], &[0.0], Measure::Trajectory, 1e-2, 6.0),
            Box::new(far),
        ),
        (
            free(AnySystem::Kepler(kepler), &orbit.q, &orbit.v, Measure::Energy, 1e-4, 20.0),
            Box::new(energy(&kepler, orbit, 20.0)),
        ),
        (
            free(AnySystem::Pendulum(pendulum), &swing.q, &swing.v, Measure::Energy, 1e-3, 10.0),
            Box::new(energy(&pendulum, swing, 10.0)),
        ),
    ];
    for (request, lost) in &cases {
        let advice = advice(request).unwrap();
        let most = request.tolerance.most;
        // `dormand-prince-8` and `dormand-prince-rkn-12` are tried, too.
        let tables = Method::most_efficient_tables().count() + 2;
        assert_eq!(advice.integrators.len(), Method::ALL.len() + tables);
        let mut found = 0;
        for choice in &advice.integrators {
            let Some(dt) = choice.dt else { continue };
            found += 1;
            let method = Method::from_name(choice.integrator).unwrap();
            let name = format!("{} {method:?}, {dt}", advice.system);
            assert!(lost(method, dt) <= most, "{name}: {}", lost(method, dt));
            if choice.lost_beyond.is_some_and(|beyond| beyond <= most) {
                let listed = |warning: &&String| warning.contains(choice.integrator);
                let warning = advice.warnings.iter().find(listed).expect(&name);
                assert!(warning.contains("were not tried"), "{name}: {warning}");
            } else {
                assert!(lost(method, 1.2 * dt) > most, "{name}: {}", lost(method, 1.2 * dt));
            }
        }
        assert!(found >= 8, "{found} of {}", advice.system);
        let costs: Vec<f64> = advice.integrators.iter().filter_map(|c| c.evaluations).collect();
        assert!(costs.is_sorted() && costs.len() == found, "{costs:?}");
        assert!(advice.answer.starts_with(advice.integrators[0].integrator), "{}", advice.answer);
    }
}

#[test]
fn a_tolerance_that_nothing_meets_says_what_is_the_best_possible() {
    let oscillator = AnySystem::Oscillator(Oscillator { omega2: 10.0 });
    let request = free(oscillator, &[1.0], &[0.0], Measure::Energy, 1e-30, 1.0);
    let found = advice(&request).unwrap();
    assert!(found.chosen().is_none() && found.throughput.is_none());
    assert!(found.warnings[0].contains("the best possible is"), "{:?}", found.warnings);
    assert!(found.answer.starts_with("No integrator keeps"), "{}", found.answer);
}

/// An oscillator that a command pushes.
struct Pushed {
    omega2: f64,
    command: f64,
}

impl System<f64, 1> for Pushed {
    fn acceleration(&self, state: &State<f64, 1>) -> [f64; 1] {
        [self.command - self.omega2 * state.q[0]]
    }
}

/// The samples of a loop whose command comes `late` periods late, in so many steps a period, of which one is cut where it comes.
fn samples(case: Case, method: Method, late: f64, substeps: u64, periods: u64) -> Vec<[f64; 2]> {
    let mut state = State { q: [0.1], v: [0.0] };
    let (mut commands, mut samples) = (Vec::new(), Vec::new());
    let h = case.period / substeps as f64;
    let (whole, part) = (late.trunc() as usize, late.fract());
    let cut = (part * substeps as f64).floor();
    for k in 0..periods as usize {
        let Feedback { position, velocity } = case.gains;
        commands.push(-position * state.q[0] - velocity * state.v[0]);
        let of = |k: Option<usize>| k.map_or(0.0, |k| commands[k]);
        let [before, after] = [of(k.checked_sub(whole + 1)), of(k.checked_sub(whole))];
        let step =
            |state, command, dt| method.step(&Pushed { omega2: case.omega2, command }, state, dt);
        for i in 0..substeps {
            let rest = part * substeps as f64 - i as f64;
            state = match rest {
                rest if rest >= 1.0 => step(state, before, h),
                rest if i as f64 == cut && rest > 0.0 => {
                    let first = step(state, before, rest * h);
                    step(first, after, (1.0 - rest) * h)
                }
                _ => step(state, after, h),
            };
        }
        samples.push([state.q[0], state.v[0]]);
    }
    samples
}

#[test]
fn a_loop_gets_the_fewest_steps_in_a_period_that_meet_the_tolerance() {
    let case =
        Case { omega2: 10.0, gains: Feedback { position: 10.0, velocity: 2.0 }, period: 0.1 };
    for late in [0.0, 0.7, 1.0] {
        let mut request = case.request();
        (request.tolerance.most, request.horizon) = (2e-3, 4.0);
        if let Some(control) = &mut request.control {
            control.latency = late * case.period;
        }
        let found = advice(&request).unwrap();
        let truth = samples(case, Method::Suzuki4, late, 2048, 40);
        let (mut far, mut fast) = (0.1_f64, 0.0_f64);
        for [q, v] in &truth {
            (far, fast) = (far.max(q.abs()), fast.max(v.abs()));
        }
        let lost = |method, substeps| {
            let own = samples(case, method, late, substeps, 40);
            let off = own
                .iter()
                .zip(&truth)
                .map(|(a, b)| (a[0] - b[0]).hypot((a[1] - b[1]) / (fast / far)));
            off.fold(0.0, f64::max) / far
        };
        let mut narrow = 0;
        for choice in &found.integrators {
            let Some(substeps) = choice.substeps else { continue };
            let method = Method::from_name(choice.integrator).unwrap();
            // The truths are of 512 and of 2048 steps.
            let name = format!("{method:?}, {substeps} steps, {late} late");
            assert!(lost(method, substeps) <= 2e-3 * 1.001, "{name}: {}", lost(method, substeps));
            if substeps > 1 {
                narrow += 1;
                let fewer = lost(method, substeps - 1);
                assert!(fewer > 2e-3 * 0.999, "{name}: {fewer} with one less");
            }
        }
        assert!(narrow >= 3, "{narrow} of {:?}", found.integrators);
    }
}

/// A circular orbit is known in closed form; the search knows its error by a reference whose steps are as long as those of a
/// first-order method, or parts of those of others.
#[test]
fn errors_against_the_reference_are_those_against_a_circular_orbit_in_closed_form() {
    let kepler = Kepler { mu: 1.0 };
    let request =
        free(AnySystem::Kepler(kepler), &[1.0, 0.0], &[0.0, 1.0], Measure::Trajectory, 1e-3, 7.0);
    let found = advice(&request).unwrap();
    let mut orders = [0; 7];
    for choice in found.integrators.iter().filter(|choice| choice.dt.is_some()) {
        let (method, dt) = (Method::from_name(choice.integrator).unwrap(), choice.dt.unwrap());
        let mut state = State { q: [1.0, 0.0], v: [0.0, 1.0] };
        let mut largest = 0.0_f64;
        for n in 1..=steps_over(7.0, dt) {
            state = method.step(&kepler, state, dt);
            let (sine, cosine) = (n as f64 * dt).sin_cos();
            let off =
                [state.q[0] - cosine, state.q[1] - sine, state.v[0] + sine, state.v[1] - cosine];
            // The size of the true state is √2.
            largest = largest.max((off.iter().map(|x| x * x).sum::<f64>() / 2.0).sqrt());
        }
        // The search adds 0.1 % for the reference, whose own error is 1/4096 but for terms of higher order: 1/4040 for `suzuki4`.
        let ratio = choice.lost / largest / 1.001;
        assert!((ratio - 1.0).abs() < 1.0 / 4000.0, "{}: {ratio}", choice.integrator);
        orders[method.order() as usize / 2] += 1;
    }
    assert_eq!(orders.map(|count| count.min(2)), [2, 2, 2, 1, 2, 1, 1], "{orders:?}");
}

/// The phase error of a step has a zero near 0.27 s at 40 s, between steps that lose more.
#[test]
fn a_step_whose_error_passes_through_zero_is_not_taken() {
    let pendulum = AnySystem::Pendulum(Pendulum { omega2: 9.81 });
    let request = free(pendulum, &[1.3], &[0.4], Measure::Phase, 1e-5, 40.0);
    let found = advice(&request).unwrap();
    let name = "blanes-moan-srkn-6-4";
    let choice = found.integrators.iter().find(|choice| choice.integrator == name).unwrap();
    // At horizons of 38, 39, 41 and 42 s its largest steps are between 0.210 and 0.213 s.
    let dt = choice.dt.unwrap();
    assert!((0.208..0.215).contains(&dt), "{dt}");
}
