//! One definition of a step, four instruments: it simulates, differentiates, and prints its own
//! update matrix.

use libration::analysis::{Spectrum, SymbolicStep, UpdateMatrix};
use libration::integrator::{Rk4, VelocityVerlet};
use libration::simulation::{EnergyDrift, SimulationError, Simulator};
use libration::system::{Oscillator, Pendulum};
use libration::{Model, State};

fn main() -> Result<(), SimulationError> {
    // On floats the step simulates.
    let oscillator = Oscillator::from_mass_and_stiffness(1.0, 10.0);
    let start = State { q: [1.0], v: [0.0] };
    let mut drift = EnergyDrift::new(oscillator, &start);
    let mut simulator = Simulator::new(oscillator, VelocityVerlet, start, 0.01)?;
    simulator.run(1_000_000, &mut drift)?;
    println!("largest drift in a million steps   {:e}", drift.largest());
    println!("force evaluations, counted         {}", simulator.evaluations());

    // On polynomials it prints its update matrix.
    if let Some(step) = SymbolicStep::new(Rk4) {
        println!("RK4, position to position          {}", step.matrix.entry(0, 0));
        println!("RK4, determinant                   {}", step.determinant());
    }

    // On dual numbers with 1024 bits it is linearised, here about a swinging pendulum.
    let pendulum = Pendulum { omega2: 9.81 };
    let about = State { q: [2.0], v: [0.3] };
    let matrix = UpdateMatrix::of_step(VelocityVerlet, pendulum, &about, 0.05);
    let spectrum = Spectrum::new(&matrix);
    println!("pendulum, det M − 1                {}", spectrum.determinant_minus_one().to_f64());

    // The same model on another number type is the same physics with fewer bits.
    let coarse = Simulator::new(
        Model::<1>::on::<f32>(&oscillator),
        VelocityVerlet,
        start.map(|x| x as f32),
        0.01,
    );
    let mut coarse = coarse?;
    coarse.run(1_000_000, &mut ())?;
    println!(
        "f32 ends at x = {}, f64 at x = {}",
        coarse.sample().state.q[0],
        simulator.sample().state.q[0]
    );
    Ok(())
}
