//! The systems of the catalogue as equations.

use libration_core::AnySystem;
use libration_core::catalog::Actuation;

use super::Definitions;

/// Accelerations by coordinate, and the energy.
struct Texts {
    accelerations: &'static [(&'static str, &'static str)],
    energy: &'static str,
}

/// The operations are those of the compiled systems, in their order.
fn texts(system: AnySystem) -> Texts {
    match system {
        AnySystem::Oscillator(_) => {
            Texts { accelerations: &[("q", "-omega2*q")], energy: "q'^2/2 + omega2*q^2/2" }
        }
        AnySystem::DampedOscillator(_) => Texts {
            accelerations: &[("q", "-omega2*q - gamma*q'")],
            energy: "q'^2/2 + omega2*q^2/2",
        },
        AnySystem::DrivenOscillator(_) => Texts {
            accelerations: &[("q", "-omega2*q - gamma*q' + amplitude*cos(drive*t)")],
            energy: "q'^2/2 + omega2*q^2/2",
        },
        AnySystem::Pendulum(_) => Texts {
            accelerations: &[("q", "-omega2*sin(q)")],
            energy: "q'^2/2 + omega2*(1 - cos(q))",
        },
        AnySystem::Duffing(_) => Texts {
            accelerations: &[("q", "-alpha*q - beta*(q*q*q)")],
            energy: "q'^2/2 + alpha*q^2/2 + beta*(q^2*q^2)/4",
        },
        AnySystem::Kepler(_) => Texts {
            accelerations: &[
                ("x", "-mu*(1/sqrt(x*x + y*y))^3*x"),
                ("y", "-mu*(1/sqrt(x*x + y*y))^3*y"),
            ],
            energy: "(x'^2 + y'^2)/2 - mu*(1/sqrt(x*x + y*y))",
        },
        AnySystem::HenonHeiles(_) => Texts {
            accelerations: &[("x", "-x - lambda*(x*y + x*y)"), ("y", "-y - lambda*(x*x - y*y)")],
            energy: "(x'^2 + y'^2)/2 + (x^2 + y^2)/2 + lambda*(x*x*y - y*y*y/3)",
        },
    }
}

impl Definitions {
    /// The equations of a system of the catalogue without commands; its steps have the bits of the compiled system. A mass `m` and a
    /// stiffness `k` stand in place of the frequency that they make, if commands would be forces.
    pub fn of_catalogue(system: AnySystem, actuation: Actuation) -> Self {
        let Texts { accelerations, energy } = texts(system);
        let accelerations = accelerations.iter().map(|(q, a)| ((*q).to_owned(), (*a).to_owned()));
        Definitions::with_texts(system, actuation, accelerations.collect(), energy)
    }

    /// The same in as many dimensions as the system exists in: an oscillator has up to eight that do not depend on each other.
    pub fn of_catalogue_in(system: AnySystem, actuation: Actuation, dimension: usize) -> Self {
        if !matches!(system, AnySystem::Oscillator(_)) || dimension < 2 {
            return Definitions::of_catalogue(system, actuation);
        }
        let all = |term: &dyn Fn(usize) -> String| {
            (0..dimension).map(term).collect::<Vec<String>>().join(" + ")
        };
        let accelerations = (0..dimension).map(|i| (format!("q{i}"), format!("-omega2*q{i}")));
        let energy = format!(
            "({})/2 + omega2*({})/2",
            all(&|i| format!("q{i}'*q{i}'")),
            all(&|i| format!("q{i}*q{i}"))
        );
        Definitions::with_texts(system, actuation, accelerations.collect(), &energy)
    }

    fn with_texts(
        system: AnySystem,
        actuation: Actuation,
        accelerations: Vec<(String, String)>,
        energy: &str,
    ) -> Self {
        let own = |text: &str| match actuation {
            Actuation::Force { .. } => text.replace("omega2", "(k/m)"),
            Actuation::Acceleration => text.to_owned(),
        };
        let parameters = actuation.parameters(system).into_iter();
        Definitions {
            coordinates: accelerations.iter().map(|(q, _)| q.clone()).collect(),
            accelerations: accelerations.into_iter().map(|(q, a)| (q, own(&a))).collect(),
            parameters: parameters.map(|(name, value)| (name.to_owned(), value)).collect(),
            energy: Some(own(energy)),
            ..Definitions::default()
        }
    }

    /// The same with an input of each coordinate, `u` of one, `u_x` and `u_y` of two: a force on the mass `m`, or an acceleration.
    #[must_use]
    pub fn commanded(mut self, actuation: Actuation) -> Self {
        let is_single = self.coordinates.len() == 1;
        let by_mass = match actuation {
            Actuation::Force { .. } => "*(1/m)",
            Actuation::Acceleration => "",
        };
        for (q, acceleration) in &mut self.accelerations {
            let input = if is_single { "u".to_owned() } else { format!("u_{q}") };
            *acceleration += &format!(" + {input}{by_mass}");
            self.inputs.push(input);
        }
        self
    }
}
