//! Tests of energies that diverge although no force adds any.

use std::sync::atomic::{AtomicU64, Ordering};

use libration::{AnySystem, Method};
use libration_analyze::trajectory::{Monitor, Outcome, Request, simulate, simulate_until};
use libration_settings::equations::EquationSystem;

use super::trajectory::{from, request};

fn fault(request: &Request) -> Option<String> {
    match simulate(request).unwrap().outcome {
        Outcome::EnergyDiverges { verdict, .. } => Some(verdict.evidence),
        Outcome::Complete | Outcome::Iterated(_) => None,
        other => panic!("{other:?}"),
    }
}

fn equations(acceleration: &str, energy: &str, start: f64) -> EquationSystem {
    let text = format!(
        "[system]\nname = \"own\"\ncoordinates = [\"x\"]\nacceleration.x = \"{acceleration}\"\nenergy = \"{energy}\"\nstart = {{ x = {start:?} }}\n"
    );
    EquationSystem::parse(&text, "own.toml", &[]).unwrap()
}

#[test]
fn steps_beyond_their_limit_are_a_fault_of_the_energy_and_steps_below_are_none() {
    // ωΔt of 2.21 and 1; the limit of velocity Verlet is 2. Of 1 the energy follows a modified one, which differs by (ωΔt)²/4.
    let system = || {
        let one = AnySystem::build("oscillator", &[("omega2", 10.0)]).unwrap();
        from(one, [vec![1.0], vec![0.0]])
    };
    for every in [1, 100] {
        let of = |dt| {
            let steps = request("oscillator", Method::VelocityVerlet, dt, 100);
            Request { system: system(), every, ..steps }
        };
        let found = fault(&of(0.7)).unwrap();
        assert!(found.starts_with("the energy goes from 5 to 5.9"), "{found}");
        assert!(found.contains("though the forces conserve it at 66 states"), "{found}");
        assert_eq!(fault(&of(1.0 / 10.0_f64.sqrt())), None);
    }
    // Explicit Euler on a damped spring: the eigenvalue 1 + Δt·(−0.25 + 3.15 i) has the modulus 1.32 at Δt = 0.3.
    let one = AnySystem::build("damped-oscillator", &[("omega2", 10.0), ("gamma", 0.5)]).unwrap();
    let steps = request("oscillator", Method::ExplicitEuler, 0.3, 60);
    let damped = Request { system: from(one, [vec![1.0], vec![0.0]]), ..steps };
    let found = fault(&damped).unwrap();
    assert!(found.contains("though the forces add none"), "{found}");
    // The energy leaves the range of numbers long before the state, which is finite.
    let long = request("oscillator", Method::ExplicitEuler, 0.1, 8000);
    let found = fault(&long).unwrap();
    assert!(found.contains("beyond the range of numbers"), "{found}");
    // A pendulum that explicit Euler turns ever faster, at a rate that falls: whatever the length of the run.
    for steps in [200, 1000, 5000, 50_000] {
        let pendulum =
            Request { every: steps, ..request("pendulum", Method::ExplicitEuler, 0.05, steps) };
        assert!(fault(&pendulum).is_some(), "{steps}");
    }
}

#[test]
fn an_energy_that_a_force_adds_or_that_falls_is_no_fault() {
    let of = |acceleration: &str, energy: &str, start, method, dt, steps| {
        let system = equations(acceleration, energy, start);
        fault(&Request { system, ..request("oscillator", method, dt, steps) })
    };
    let free = "x'^2/2 + x^2/2";
    // Resonances, from rest.
    for drive in ["sin(t)", "sin(t + 1)", "2*cos(t)"] {
        assert_eq!(of(&format!("-x + {drive}"), free, 0.0, Method::Rk4, 0.062_831_853, 6400), None);
    }
    // Forces that act for a short time, between the states that are looked at; a damper does, too.
    for force in [
        "40*exp(-((t - 70)/0.1)^2)",
        "if(t > 70, if(t < 70.2, 50, 0), 0)",
        "-if(t > 70, if(t < 71, x', 0), 0)",
    ] {
        assert_eq!(of(&format!("-x + {force}"), free, 1.0, Method::Rk4, 0.01, 10_000), None);
    }
    // Negative friction, a limit cycle from near rest, a fall, and damping.
    assert_eq!(of("-x + 0.2*x'", free, 1e-3, Method::Rk4, 0.01, 10_000), None);
    assert_eq!(of("-x + (1 - x^2)*x'", free, 1e-6, Method::Rk4, 0.01, 10_000), None);
    assert_eq!(of("-9.81", "x'^2/2 + 9.81*x", 100.0, Method::Rk4, 0.01, 10_000), None);
    assert_eq!(of("-x - 0.5*x'", free, 1.0, Method::VelocityVerlet, 0.01, 10_000), None);
    // From near the top of a pendulum, where little is exchanged for most of the run.
    assert_eq!(of("sin(x)", "x'^2/2 + cos(x)", 1e-9, Method::VelocityVerlet, 0.1, 230), None);
    // A potential without a lower end: the energy is kept while its parts grow without end.
    assert_eq!(of("x", "x'^2/2 - x^2/2", 1.0, Method::Rk4, 0.01, 2000), None);
}

/// The number of pieces in which a run is taken.
#[derive(Default)]
struct Pieces(AtomicU64);

impl Monitor for Pieces {
    fn on_step(&self, _: u64) {
        self.0.fetch_add(1, Ordering::Relaxed);
    }
}

#[test]
fn a_long_run_is_looked_at_64_times() {
    let steps = 1_000_000;
    let long = Request { every: steps, ..request("oscillator", Method::Leapfrog, 0.01, steps) };
    let pieces = Pieces::default();
    simulate_until(&long, &pieces).unwrap();
    // Beside them the monitor is asked after each 65536 steps.
    let found = pieces.0.into_inner();
    assert!((64..=64 + steps / 65_536 + 2).contains(&found), "{found}");
}

/// A planar Kepler motion around a mass of 1.
fn kepler(q: [f64; 2], v: [f64; 2], method: Method, dt: f64, steps: u64) -> Option<String> {
    let one = AnySystem::build("kepler", &[("mu", 1.0)]).unwrap();
    let system = from(one, [q.to_vec(), v.to_vec()]);
    fault(&Request { system, every: steps, ..request("oscillator", method, dt, steps) })
}

/// Speed at the pericentre and apocentre of an orbit with the half axis 1, by `v² = 2/r − 1`.
fn speed(distance: f64) -> f64 {
    (2.0 / distance - 1.0).sqrt()
}

#[test]
fn an_orbit_that_is_lost_is_a_fault_below_the_kinetic_energy_of_its_pericentre() {
    // The largest energies and the last ones are those of twenty lines of NumPy. There the mean growth in the last eighth is 112, 198, 155,
    // 113, 146 and 141 % of the mean kinetic energy, over all steps.
    for (q, v, method, dt, steps, found) in [
        (
            [0.05, 0.0],
            [0.0, 6.2],
            Method::Leapfrog,
            0.05,
            1000,
            "−0.78 to 6.326, in the mean by 112 %",
        ),
        ([0.1, 0.0], [0.0, 4.358], Method::VelocityVerlet, 0.02, 1000, "−0.5039 to 0.0"),
        ([0.1, 0.0], [0.0, 4.358], Method::ExplicitEuler, 0.001, 20_000, "−0.5039 to −0.22"),
        ([1.0, 0.0], [0.0, 1.0], Method::ExplicitEuler, 0.05, 1000, "−0.5 to −0.1978"),
        ([0.1, 0.0], [0.0, 4.358], Method::SymplecticEuler, 0.02, 1000, "−0.5039 to "),
        // A bound orbit from its apocentre, which is lost at a later pericentre.
        ([1.9, 0.0], [0.0, speed(1.9)], Method::Leapfrog, 0.05, 500, "−0.5 to 0.96"),
    ] {
        let said = kepler(q, v, method, dt, steps).unwrap_or_default();
        assert!(
            said.contains(found) && said.contains("of the mean kinetic energy"),
            "{method:?} {dt}: {said}"
        );
    }
}

#[test]
fn orbits_with_errors_at_their_pericentres_alone_are_no_fault() {
    // 40 steps in a turn around the circle through the pericentre. There symplectic Euler changes the energy by half of it, for a short time.
    for eccentricity in [0.3, 0.6, 0.9] {
        let (near, far) = (1.0 - eccentricity, 1.0 + eccentricity);
        let dt = core::f64::consts::TAU * f64::powf(near, 1.5) / 40.0;
        for method in [Method::Leapfrog, Method::VelocityVerlet, Method::SymplecticEuler] {
            for start in [near, far] {
                // Half an orbit, and a number that is not whole.
                for turns in [0.5, 3.3] {
                    let steps = (core::f64::consts::TAU * turns / dt) as u64;
                    let found = kepler([start, 0.0], [0.0, speed(start)], method, dt, steps);
                    assert_eq!(found, None, "{method:?} {start} {turns}");
                }
            }
        }
    }
}

#[test]
fn bounded_errors_of_oscillations_are_no_fault_in_the_mean() {
    // Symplectic Euler just below ωΔt = 0.5, the limit of growth as a part of what is exchanged: the energy oscillates between H/1.25 and H/0.75.
    for phase in 0..24 {
        let angle = f64::from(phase) * core::f64::consts::PI / 24.0;
        let start = [vec![angle.cos()], vec![-angle.sin()]];
        for (method, dt) in [
            (Method::SymplecticEuler, 0.49),
            (Method::SymplecticEulerDriftFirst, 0.49),
            (Method::Leapfrog, 1.0),
            (Method::VelocityVerlet, 1.0),
        ] {
            for steps in [16, 20, 40, 64, 130, 250, 1000] {
                let one = AnySystem::build("oscillator", &[("omega2", 1.0)]).unwrap();
                let system = from(one, start.clone());
                let found = fault(&Request {
                    system,
                    every: steps,
                    ..request("oscillator", method, dt, steps)
                });
                assert_eq!(found, None, "{method:?} {phase} {steps}");
            }
        }
    }
    // A stiff spring that hardly moves beside a soft one, and a pendulum that turns over near its top.
    let text = "[system]\nname = \"own\"\ncoordinates = [\"x\", \"y\"]\nacceleration.x = \"-1e4*x\"\nacceleration.y = \"-y\"\n\
        energy = \"(x'^2 + y'^2 + 1e4*x^2 + y^2)/2\"\nstart = { x = 1e-3, y = 1.0 }\n";
    let pair = || EquationSystem::parse(text, "own.toml", &[]).unwrap();
    for steps in [20, 100, 3000, 50_000] {
        let own = request("oscillator", Method::VelocityVerlet, 0.01, steps);
        assert_eq!(fault(&Request { system: pair(), every: steps, ..own }), None, "{steps}");
        let top = AnySystem::build("pendulum", &[("omega2", 1.0)]).unwrap();
        let system = from(top, [vec![0.0], vec![2.0]]);
        let own = request("oscillator", Method::SymplecticEuler, 0.1, steps);
        assert_eq!(fault(&Request { system, every: steps, ..own }), None, "{steps}");
    }
}

#[test]
fn roundings_of_a_large_constant_are_no_growth() {
    // Floats near 1e9 are 1.19e-7 apart. The start has 0.4995 of that, which is rounded to 0. The step adds (ωΔt)²/4 of it, and it is rounded to 1.
    let distance = 2.0_f64.powi(-23);
    let system = equations("-x", "x'^2/2 + x^2/2 + 1e9", (2.0 * 0.4995 * distance).sqrt());
    let own = request("oscillator", Method::Leapfrog, 0.1, 1000);
    assert_eq!(fault(&Request { system, ..own }), None);
}
