//! An ensemble on one thread, whose system, method and float type are chosen by name.
//!
//! `kernels [system] [method] [float] [instructions] [trajectories] [steps]`, as in
//! `kernels kepler yoshida4 f32 avx2 1000 500`. It reads no clock: `cargo xtask instructions` counts
//! what it executes.

use std::error::Error;

use libration::ensemble::{AnyEnsemble, BatchFloat, Execution, InstructionSet};
use libration::{AnySystem, Method};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let mut argument = |default: &str| arguments.next().unwrap_or_else(|| default.to_owned());
    let system = AnySystem::build(&argument("pendulum"), &[] as &[(&str, f64)])?;
    let method = argument("velocity-verlet");
    let method = Method::from_name(&method).ok_or_else(|| format!("no method `{method}`"))?;
    let float = argument("f64");
    let set = argument(InstructionSet::widest().name());
    let set = InstructionSet::from_name(&set).ok_or_else(|| format!("no instructions `{set}`"))?;
    let (trajectories, steps) = (argument("1000").parse()?, argument("10000").parse()?);
    match float.as_str() {
        "f32" => run::<f32>(system, method, set, trajectories, steps),
        "f64" => run::<f64>(system, method, set, trajectories, steps),
        _ => Err(format!("no batches of `{float}`").into()),
    }
}

/// Starts about that of the catalogue, each a little further out than the one before.
fn run<T: BatchFloat>(
    system: AnySystem,
    method: Method,
    set: InstructionSet,
    trajectories: usize,
    steps: u64,
) -> Result<(), Box<dyn Error>> {
    let entry = system.entry();
    let dimension = *entry.dimensions.start();
    let start = |n: usize, i: usize| {
        let coordinate = match i.checked_sub(dimension) {
            None => entry.q[i % entry.q.len()],
            Some(i) => entry.v[i % entry.v.len()],
        };
        T::from_f64(coordinate * (1.0 + 1e-3 * n as f64 / trajectories as f64))
    };
    let execution = Execution::serial().instructions(set)?;
    let mut all = AnyEnsemble::<T>::of_system(system, dimension, trajectories, execution, start)?;
    let before = first_energy(&all);
    all.advance(method, T::from_f64(0.01), steps);
    println!(
        "{trajectories} trajectories, {steps} steps of {} with {}",
        method.title(),
        set.name()
    );
    if let (Some(before), Some(after)) = (before, first_energy(&all)) {
        println!("energy of the first before and after: {before} and {after} J/kg");
    }
    Ok(())
}

/// The energy of the first trajectory.
fn first_energy<T: BatchFloat>(all: &AnyEnsemble<T>) -> Option<f64> {
    all.energies()?.first().copied().map(T::to_f64)
}
