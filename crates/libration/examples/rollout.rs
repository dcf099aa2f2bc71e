//! Effect of latency on a policy: eigenvalues of the loop against rollouts.
//!
//! A thousand oscillators under the same linear feedback, whose commands arrive later and later: which of them leave the
//! bound, and what they lose before they do.

use libration::State;
use libration::analysis::Plant;
use libration::control::{Feedback, Latency};
use libration::ensemble::{All, Execution};
use libration::integrator::VelocityVerlet;
use libration::rl::policy::Linear;
use libration::rl::start::UniformStart;
use libration::rl::task::Regulate;
use libration::rl::{Delays, Environment, Environments, Plan, Rollout};
use libration::system::Oscillator;

const DT: f64 = 0.01;
const GAINS: Feedback = Feedback { position: 10.0, velocity: 2.0 };

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (count, horizon) = (1024, 4000);
    let system = Oscillator { omega2: 10.0_f32 };
    let task = Regulate { position: 1.0, velocity: 0.1, effort: 0.01, bound: 3.0 };
    let start = UniformStart(State { q: [-1.0], v: [-1.0] }, State { q: [1.0], v: [1.0] });
    let policy = Linear { weights: [[-GAINS.position, -GAINS.velocity]], bias: [0.0] };
    let model = Oscillator { omega2: 10.0 };
    let plant = Plant::new(VelocityVerlet, model, State { q: [0.0], v: [0.0] }, DT);

    let critical = plant.latency_windows(GAINS).critical();
    println!("stable up to a latency of {:.3} steps", critical.unwrap_or(f64::INFINITY));
    println!("latency  spectral radius  episodes that end at the bound  reward of a step");
    let mut rollout = Rollout::new(Plan::new(horizon, count))?;
    for latency in [0, 5, 10, 15, 20, 25, 30] {
        let environment = Environment::new(All(system), VelocityVerlet, DT, task, start)
            .delays(Delays::of(0, latency));
        let mut all = Environments::new(environment, count, 1, Execution::parallel()?)?;
        all.rollout(policy, &mut rollout)?;
        let late = Latency::of_steps(latency.into()).ok_or("no latency")?;
        let radius = plant.spectral_radius(GAINS, late).to_f64();
        let reward: f64 = rollout.reward().iter().map(|&reward| f64::from(reward)).sum();
        println!(
            "{latency:7}  {radius:15.5}  {:30}  {:16.4}",
            rollout.finals().len(),
            reward / (count * horizon) as f64
        );
        // What the eigenvalues say is seen: a loop that they call stable loses nobody, and one that grows loses all.
        assert_eq!(rollout.finals().is_empty(), radius < 1.0, "latency {latency}");
    }
    Ok(())
}
