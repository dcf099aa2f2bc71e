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
            energy: "q'^2/2 + alpha*q^2/2 + beta*q^4/4",
        },
        AnySystem::Kepler(_) => Texts {
            accelerations: &[
                ("x", "-mu*(1/sqrt(x*x + y*y))^3*x"),
                ("y", "-mu*(1/sqrt(x*x + y*y))^3*y"),
            ],
            energy: "(x'^2 + y'^2)/2 - mu/sqrt(x^2 + y^2)",
        },
        AnySystem::HenonHeiles(_) => Texts {
            accelerations: &[("x", "-x - lambda*(x*y + x*y)"), ("y", "-y - lambda*(x*x - y*y)")],
            energy: "(x'^2 + y'^2)/2 + (x^2 + y^2)/2 + lambda*(x^2*y - y^3/3)",
        },
    }
}

impl Definitions {
    /// The equations of a system of the catalogue without commands; its steps have the bits of the compiled system. A mass `m` and a
    /// stiffness `k` stand in place of the frequency that they make, if commands would be forces.
    pub fn of_catalogue(system: AnySystem, actuation: Actuation) -> Self {
        let Texts { accelerations, energy } = texts(system);
        let own = |text: &str| match actuation {
            Actuation::Force { .. } => text.replace("omega2", "(k/m)"),
            Actuation::Acceleration => text.to_owned(),
        };
        let parameters = actuation.parameters(system).into_iter();
        Definitions {
            coordinates: accelerations.iter().map(|(q, _)| (*q).to_owned()).collect(),
            accelerations: accelerations.iter().map(|(q, a)| ((*q).to_owned(), own(a))).collect(),
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
