//! The steps that are advised, beside simulations that know nothing of how they were found.

use libration::system::{Kepler, Oscillator, Pendulum};
use libration::{AnySystem, Hamiltonian, Integrator, Method, State};
use libration_lab::advise::{Measure, Request, Tolerance};

use super::advise::advice;

pub(crate) fn free(
    system: AnySystem,
    q: &[f64],
    v: &[f64],
    of: Measure,
    most: f64,
    horizon: f64,
) -> Request {
    Request {
        system,
        q: q.to_vec(),
        v: v.to_vec(),
        control: None,
        tolerance: Tolerance { of, most },
        horizon,
        rollout: [64, 64],
        map: false,
        asked_by: String::new(),
    }
}

#[test]
fn every_integrator_gets_the_largest_step_that_meets_the_tolerance() {
    let oscillator = Oscillator { omega2: 10.0 };
    // The largest distance from cos and sin, and of Kepler's and the pendulum's energy.
    let trajectory = |method: Method, dt: f64| {
        let (omega, mut largest) = (10.0_f64.sqrt(), 0.0_f64);
        let mut state = State { q: [1.0], v: [0.0] };
        for n in 1..=(8.0 / dt).round() as u64 {
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
        move |method, dt| {
            let first = system.energy(&start);
            let (mut state, mut largest) = (start, 0.0_f64);
            for _ in 0..(horizon / dt).round() as u64 {
                state = method.step(system, state, dt);
                let off = ((system.energy(&state) - first) / first).abs();
                largest = if off.is_finite() { largest.max(off) } else { f64::INFINITY };
            }
            largest
        }
    }
    let (kepler, pendulum) = (Kepler { mu: 1.0 }, Pendulum { omega2: 9.81 });
    let orbit = State { q: [1.0, 0.0], v: [0.0, 1.1] };
    let swing = State { q: [1.0], v: [0.0] };
    type Lost<'a> = Box<dyn Fn(Method, f64) -> f64 + 'a>;
    let cases: [(Request, Lost<'_>); 3] = [
        (
            free(AnySystem::Oscillator(oscillator), &[1.0], &[0.0], Measure::Trajectory, 1e-2, 8.0),
            Box::new(trajectory),
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
        assert_eq!(advice.integrators.len(), Method::ALL.len());
        let mut found = 0;
        for choice in &advice.integrators {
            let Some(dt) = choice.dt else { continue };
            found += 1;
            let method = Method::from_name(choice.integrator).unwrap();
            let name = format!("{} {method:?}, {dt}", advice.system);
            assert!(lost(method, dt) <= most, "{name}: {}", lost(method, dt));
            assert!(lost(method, 1.2 * dt) > most, "{name}: {}", lost(method, 1.2 * dt));
        }
        assert!(found >= 8, "{found} of {}", advice.system);
        // The cheapest first.
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
