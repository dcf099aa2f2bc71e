//! Speed of the block machine over kernels that are compiled for one system.
//!
//! ```sh
//! cargo run --release -p libration --example block_machine
//! ```
//!
//! Both take the same steps with 10⁵ trajectories, or as many as the argument says, on one core; that their bits are equal is checked on the way.

use std::time::Instant;

use libration::ensemble::{All, AnyEnsemble, BatchFloat, Ensemble, EnsembleError, Execution};
use libration::equations::Dynamics;
use libration::integrator::{Rk4, SymplecticEuler, VelocityVerlet};
use libration::system::{Oscillator, Pendulum};
use libration::{Integrator, Method, Model, State};

const ROUNDS: usize = 7;

/// Trajectories and steps of each round, and the least ratio that is asked.
struct Bar {
    trajectories: usize,
    steps: u64,
    least: f64,
}

fn main() -> Result<(), EnsembleError> {
    println!("system      float  integrator         compiled/machine time   asked");
    let (oscillator, pendulum) = (Oscillator { omega2: 10.0 }, Pendulum { omega2: 10.0 });
    let number = std::env::args().nth(1).map(|argument| argument.parse().expect("a number"));
    let trajectories = number.unwrap_or(100_000);
    both("oscillator", oscillator, &Bar { trajectories, steps: 400, least: 0.3 })?;
    both("pendulum", pendulum, &Bar { trajectories, steps: 60, least: 0.6 })
}

fn both<M: Model<1>>(name: &str, model: M, bar: &Bar) -> Result<(), EnsembleError>
where
    M::On<f64>: Send + Sync,
    M::On<f32>: Send + Sync,
{
    methods::<f64, M>(name, model, bar)?;
    methods::<f32, M>(name, model, bar)
}

fn methods<T: BatchFloat, M: Model<1>>(name: &str, model: M, bar: &Bar) -> Result<(), EnsembleError>
where
    M::On<T>: Send + Sync,
{
    compare::<T, M>(name, model, (SymplecticEuler, Method::SymplecticEuler), bar)?;
    compare::<T, M>(name, model, (VelocityVerlet, Method::VelocityVerlet), bar)?;
    compare::<T, M>(name, model, (Rk4, Method::Rk4), bar)
}

fn compare<T: BatchFloat, M: Model<1>>(
    name: &str,
    model: M,
    (integrator, method): (impl Integrator, Method),
    bar: &Bar,
) -> Result<(), EnsembleError>
where
    M::On<T>: Send + Sync,
{
    let start =
        |n: usize, i: usize| T::from_f64(0.3 * (0.5 + (n % 1000) as f64 * 1e-3 + 0.3 * i as f64));
    let (dt, system) = (T::from_f64(0.01), model.on::<T>());
    let state = |n| State { q: [start(n, 0)], v: [start(n, 1)] };
    let dynamics = Dynamics::of(&model, None);
    let count = bar.trajectories;
    let mut compiled = Ensemble::from_fn(count, Execution::serial(), state)?;
    let mut machine = AnyEnsemble::<T>::new(&dynamics, None, count, Execution::serial(), start)?;
    let mut ratios: Vec<f64> = Vec::new();
    for _ in 0..ROUNDS {
        let begun = Instant::now();
        compiled.advance(integrator, All(system), All(dt), bar.steps)?;
        let first = begun.elapsed();
        let begun = Instant::now();
        machine.advance(method, dt, bar.steps);
        ratios.push(first.as_secs_f64() / begun.elapsed().as_secs_f64());
    }
    assert_eq!((Some(compiled.q(0)), Some(compiled.v(0))), (machine.q(0), machine.v(0)));
    ratios.sort_by(f64::total_cmp);
    let (median, float, method) = (ratios[ROUNDS / 2], T::NAME, method.name());
    println!("{name:11} {float:6} {method:18} {median:>21.2} {:>7}", bar.least);
    Ok(())
}
