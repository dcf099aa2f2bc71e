//! The code of the README with its imports: a trajectory, its theory, an ensemble and a batch of robots.

use libration::State;
use libration::analysis::SymbolicStep;
use libration::control::clock::{Gaussian, Jittered};
use libration::ensemble::{All, Ensemble, Execution};
use libration::integrator::{Rk4, VelocityVerlet};
use libration::rl::policy::Linear;
use libration::rl::start::FixedStart;
use libration::rl::task::Regulate;
use libration::rl::{Delays, Environment, Environments, Plan, Rollout};
use libration::simulation::{EnergyDrift, Simulator};
use libration::system::{Oscillator, Pendulum};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let oscillator = Oscillator::from_mass_and_stiffness(1.0, 10.0);
    let start = State { q: [1.0], v: [0.0] };

    let mut drift = EnergyDrift::new(oscillator, &start);
    Simulator::new(oscillator, VelocityVerlet, start, 0.01)?.run(1_000_000, &mut drift)?;
    println!("{:e}", drift.largest());

    let step = SymbolicStep::new(Rk4).ok_or("no polynomials")?;
    println!("{}", step.determinant());

    let pendulum = All(Pendulum { omega2: 9.81_f32 });
    let swing = |n: usize| State { q: [0.01 * n as f32], v: [0.0] };
    let mut all = Ensemble::from_fn(300, Execution::default(), swing)?;
    all.advance(VelocityVerlet, pendulum, All(0.001), 1_000_000)?;

    let task = Regulate { position: 1.0, velocity: 0.1, effort: 0.01, bound: 10.0 };
    let spring = All(Oscillator { omega2: 10.0_f32 });
    let robot = Environment::new(spring, VelocityVerlet, 0.01, task, FixedStart(start))
        .limit(200)
        .delays(Delays::of(0, 2))
        .clock(Jittered(Gaussian(0.1)));
    let mut robots = Environments::new(robot, 4096, 7, Execution::default())?;
    let mut rollout = Rollout::new(Plan::new(1024, 4096).truncated())?;
    robots.rollout(Linear { weights: [[-10.0, -2.0]], bias: [0.0] }, &mut rollout)?;
    println!("{} episodes ended, none lost", rollout.finals().len());
    assert!(rollout.finals().iter().all(|end| !end.lost));
    Ok(())
}
