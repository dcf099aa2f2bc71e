//! Settings of the systems of the catalogue.

use libration_core::AnySystem;
use libration_core::catalog::Actuation;
use libration_equations::Definitions;

use crate::Setting;

impl Setting {
    /// A system of the catalogue by its equations, at the start of its entry. In one dimension it has an input `u`: a force on
    /// its mass `m`, or an acceleration.
    pub fn of_system(system: AnySystem, actuation: Actuation) -> Self {
        let (accelerations, energy): (&[(&str, &str)], &str) = match system {
            AnySystem::Oscillator(_) => (&[("q", "-omega2*q")], "q'^2/2 + omega2*q^2/2"),
            AnySystem::DampedOscillator(_) => {
                (&[("q", "-omega2*q - gamma*q'")], "q'^2/2 + omega2*q^2/2")
            }
            AnySystem::DrivenOscillator(_) => {
                (&[("q", "-omega2*q - gamma*q' + amplitude*cos(drive*t)")], "q'^2/2 + omega2*q^2/2")
            }
            AnySystem::Pendulum(_) => (&[("q", "-omega2*sin(q)")], "q'^2/2 + omega2*(1 - cos(q))"),
            AnySystem::Duffing(_) => {
                (&[("q", "-alpha*q - beta*q^3")], "q'^2/2 + alpha*q^2/2 + beta*q^4/4")
            }
            AnySystem::Kepler(_) => (
                &[("x", "-mu*x/(x^2 + y^2)^1.5"), ("y", "-mu*y/(x^2 + y^2)^1.5")],
                "(x'^2 + y'^2)/2 - mu/sqrt(x^2 + y^2)",
            ),
            AnySystem::HenonHeiles(_) => (
                &[("x", "-x - 2*lambda*x*y"), ("y", "-y - lambda*(x^2 - y^2)")],
                "(x'^2 + y'^2)/2 + (x^2 + y^2)/2 + lambda*(x^2*y - y^3/3)",
            ),
        };
        let is_force = matches!(actuation, Actuation::Force { .. });
        let command = match (accelerations.len(), is_force) {
            (1, true) => " + u/m",
            (1, false) => " + u",
            _ => "",
        };
        // A mass and a stiffness stand in place of the frequency that they make.
        let own = |text: &str| match is_force {
            true => text.replace("omega2", "k/m"),
            false => text.to_owned(),
        };
        let named = |(name, value): (&'static str, f64)| (name.to_owned(), value);
        let parameters = actuation.parameters(system).into_iter().map(named).collect();
        let definitions = Definitions {
            coordinates: accelerations.iter().map(|(name, _)| (*name).to_owned()).collect(),
            accelerations: accelerations
                .iter()
                .map(|(name, text)| ((*name).to_owned(), own(text) + command))
                .collect(),
            parameters,
            inputs: if command.is_empty() { Vec::new() } else { vec!["u".into()] },
            energy: Some(own(energy)),
            ..Definitions::default()
        };
        let entry = system.entry();
        let at = |given: &[f64], i: usize| given.get(i).copied().unwrap_or(0.0);
        let start = definitions.coordinates.iter().enumerate();
        let start = start.flat_map(|(i, name)| {
            [(name.clone(), at(entry.q, i)), (format!("{name}'"), at(entry.v, i))]
        });
        let start = start.collect();
        Setting::of_equations(system.name(), definitions, start)
    }
}

#[cfg(test)]
mod tests {
    use libration_core::catalog::{ENTRIES, build};
    use libration_core::with_system;
    use libration_equations::{Dynamics, Equations};

    use super::*;

    /// Positions and velocities of the catalogue as those of the equations, whose time is a degree of its own.
    const STATE: [f64; 4] = [0.7, -0.3, 0.4, 0.9];

    #[test]
    fn the_equations_of_each_system_are_those_of_the_catalogue() {
        for entry in ENTRIES {
            let none: [(&str, f64); 0] = [];
            let system = AnySystem::build(entry.name, &none).unwrap();
            let own =
                Equations::new(&Setting::of_system(system, Actuation::Acceleration).definitions)
                    .unwrap();
            let d = *entry.dimensions.start();
            let other = with_system!(system, d, |model, D| Dynamics::of::<D>(&model, None), {
                panic!("{} has {d} dimensions", entry.name)
            });
            assert_eq!(own.degrees().len(), d, "{}", entry.name);
            let at: Vec<f64> = [&STATE[..d], &STATE[2..2 + d]].concat();
            let run = |dynamics: &Dynamics| -> Vec<f64> {
                let energy = dynamics.energy().unwrap();
                let all = dynamics.accelerations().on::<f64>().run(&at).collect::<Vec<_>>();
                all.into_iter().chain(energy.on::<f64>().run(&at)).collect()
            };
            for (own, other) in run(own.dynamics()).iter().zip(run(&other)) {
                assert!((own - other).abs() < 1e-14, "{}: {own} is not {other}", entry.name);
            }
        }
    }

    #[test]
    fn a_force_moves_a_mass_on_its_spring() {
        let (system, actuation) = build("oscillator", &[("m", 2.0), ("k", 8.0)]).unwrap();
        let own = Equations::new(&Setting::of_system(system, actuation).definitions).unwrap();
        let acceleration: Vec<f64> =
            own.dynamics().accelerations().on::<f64>().run(&[1.0, 0.0, 3.0]).collect();
        assert_eq!(acceleration, [-2.5]);
    }
}
