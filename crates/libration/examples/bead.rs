//! A custom system: a bead on a rotating hoop, used with every instrument.

use libration::analysis::Linearisation;
use libration::equations::{Dynamics, StepProgram};
use libration::integrator::{Rk4, VelocityVerlet};
use libration::simulation::{EnergyDrift, SimulationError, Simulator};
use libration::{Elementary, Hamiltonian, Model, State, System};

/// `θ̈ = (Ω² cos θ − ω²) sin θ`, with ω² = g/r and the hoop turning at Ω about its diameter.
///
/// Strogatz: Nonlinear Dynamics and Chaos, §3.5, without friction.
#[derive(Clone, Copy)]
struct Bead<S> {
    omega2: S,
    hoop2: S,
}

impl<S: Elementary> System<S, 1> for Bead<S> {
    fn acceleration(&self, state: &State<S, 1>) -> [S; 1] {
        let [angle] = state.q;
        [(self.hoop2 * angle.cos() - self.omega2) * angle.sin()]
    }
}

impl<S: Elementary> Hamiltonian<S, 1> for Bead<S> {
    fn energy(&self, state: &State<S, 1>) -> S {
        let ([angle], [v]) = (state.q, state.v);
        let sin = angle.sin();
        let potential =
            self.omega2 * (S::one() - angle.cos()) - (self.hoop2 * sin * sin).ratio(1, 2);
        (v * v).ratio(1, 2) + potential
    }
}

impl Model<1> for Bead<f64> {
    type On<S: Elementary> = Bead<S>;
    const LINEAR: bool = false;

    fn on<S: Elementary>(&self) -> Bead<S> {
        Bead { omega2: S::from_f64(self.omega2), hoop2: S::from_f64(self.hoop2) }
    }
}

fn main() -> Result<(), SimulationError> {
    let bead = Bead { omega2: 9.81, hoop2: 25.0 };
    let start = State { q: [0.9], v: [0.0] };
    let mut drift = EnergyDrift::new(bead, &start);
    Simulator::new(bead, VelocityVerlet, start, 0.01)?.run(100_000, &mut drift)?;
    println!("largest drift over 1000 s          {:e}", drift.largest());

    // The system is a program as well, and so is a step on it.
    let (dynamics, at) = (Dynamics::of::<1>(&bead, None), [0.9, 0.0]);
    let linear = |step| Linearisation::new(&step, &dynamics, &at, 0.01);
    let verlet = linear(StepProgram::new(VelocityVerlet, &dynamics));
    let rk4 = linear(StepProgram::new(Rk4, &dynamics));
    println!(
        "‖MᵀJM − J‖, velocity Verlet        {:e}",
        verlet.step.symplecticity_defect().to_f64()
    );
    println!("‖MᵀJM − J‖, RK4                    {:e}", rk4.step.symplecticity_defect().to_f64());
    Ok(())
}
