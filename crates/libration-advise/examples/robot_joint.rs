//! Advice for a robot joint at 500 Hz with a latency of 3 ms: stability, and the imperfection that fails first.
//!
//! ```text
//! cargo run --release -p libration-advise --example robot_joint [PAGE.html]
//! ```

use std::error::Error;
use std::sync::atomic::AtomicBool;

use libration::analysis::Plant;
use libration::control::clock::Jittered;
use libration::control::controller::Luenberger;
use libration::control::delay::{Order, Packets};
use libration::control::{Latency, Schedule, WhiteNoise};
use libration::ensemble::{All, Execution, Loops, MeanCost, Setup};
use libration::integrator::Rk4;
use libration::system::Pendulum;
use libration::{State, System};
use libration_advise as advise;
use libration_advise::{Correction, Imperfection, Law, Regulator};
use libration_work::{Silent, Work};

/// The arm about the angle at which it is held: what is left of its weight there.
#[derive(Clone, Copy)]
struct Arm {
    pendulum: Pendulum<f64>,
    angle: f64,
}

impl System<f64, 1> for Arm {
    fn acceleration(&self, state: &State<f64, 1>) -> [f64; 1] {
        let at = |q: f64| self.pendulum.acceleration(&State { q: [q], v: [0.0] })[0];
        [at(self.angle + state.q[0]) - at(self.angle)]
    }
}

/// Periods that are compared with as many before.
const WINDOW: u32 = 2000;

/// Of the acceleration, in (m/s²)²·s.
const NOISE: f64 = 1e-6;

fn main() -> Result<(), Box<dyn Error>> {
    let mut request = advise::parse(include_str!("robot_joint.toml"), "robot_joint.toml")?;
    let page = std::env::args().nth(1);
    request.map = page.is_some();
    let stop = AtomicBool::new(false);
    let advice = advise::advise(&Work::new(&Silent, &stop), &request)?;
    println!("{}", advice.answer);
    if let Some(page) = page {
        std::fs::write(page, advise::page(&advice))?;
    }

    // The same loop by hand: an arm of its own, with the controller that was designed.
    let looped = advice.looped.as_ref().ok_or("there is a loop")?;
    let control = request.control.as_ref().ok_or("there is a loop")?;
    let arm = Arm { pendulum: Pendulum { omega2: 19.6 }, angle: 0.8 };
    // Near this angle the arm is an oscillator.
    let near = libration::system::Oscillator { omega2: 19.6 * 0.8_f64.cos() };
    let plant = Plant::exact(near, State { q: [0.0], v: [0.0] }, control.period);
    let Law::Observer { feedback: Regulator::Lqr(weights), correction: Correction::Kalman(noise) } =
        control.law
    else {
        return Err("a designed observer".into());
    };
    let controller = Luenberger::to_origin(plant.lqr(weights)?, plant.observer(noise)?);
    let limit = looped.budgets.iter().find(|budget| budget.kind == Imperfection::Latency);
    let limit = limit.and_then(|budget| budget.stable_up_to).ok_or("a limit of latency")?;
    let frequency = looped.fails_first.as_ref().and_then(|failing| failing.frequency);
    for (latency, holds) in [(control.latency, true), (0.98 * limit, true), (1.02 * limit, false)] {
        let late = Latency::of_seconds(latency, control.period).ok_or("no latency")?;
        let setup = Setup::new(All(arm), Rk4).controller(controller).delay(Schedule::late(late));
        let start = [State { q: [1e-6], v: [0.0] }];
        let mut one = Loops::new(setup, control.period, 0, [0.0], &start, Execution::serial())?;
        let (mut before, mut after, mut turns) = (0.0_f64, 0.0_f64, 0);
        let mut last = 1.0_f64;
        // What it begins with has to be forgotten first.
        for step in 0..3 * WINDOW {
            one.advance(1)?;
            let angle = one.state(0).map_or(f64::NAN, |state| state.q[0]);
            match step / WINDOW {
                0 => {}
                1 => before = before.max(angle.abs()),
                _ => {
                    after = after.max(angle.abs());
                    turns += u32::from(angle.signum() != last.signum());
                }
            }
            last = angle;
        }
        let swings = f64::from(turns) / 2.0 / (f64::from(WINDOW) * control.period);
        println!(
            "{:.3} ms late: {before:.2e} rad, then {after:.2e} rad, at {swings:.1} Hz",
            1e3 * latency
        );
        if (after < before) != holds {
            return Err("the simulation does not do what was said".into());
        }
        // At the limit it swings as was foretold.
        let foretold = frequency.filter(|_| latency > 0.9 * limit);
        if foretold.is_some_and(|hz| (swings / hz - 1.0).abs() > 0.1) {
            return Err(format!("it swings at {swings} Hz, not at {frequency:?}").into());
        }
    }
    // All at once: a clock that jitters, frames that are lost, and noise that is small enough for the arm to stay where it is linear.
    let simulated = looped.combined.simulated.ok_or("a simulation")?;
    let late = control.latency / control.period;
    let mut arrives = vec![0.0; late as usize + 1];
    arrives[late as usize] = 1.0 - control.loss;
    let packets = Packets::new(&arrives, Order::NewestActs)?.longer_by(late.fract())?;
    let setup = Setup::new(All(arm), Rk4)
        .controller(controller)
        .clock(Jittered(control.jitter))
        .delay(packets)
        .disturbance(WhiteNoise(NOISE));
    let starts = [State { q: [0.0], v: [0.0] }; 64];
    let mut all = Loops::new(setup, control.period, 1, [0.0], &starts, Execution::serial())?;
    all.advance(u64::from(WINDOW))?;
    let energy = plant.energy();
    let seen = all.observe(20_000, 1, |range| MeanCost::new(range, energy))?;
    let costs: Vec<f64> = seen.iter().flat_map(MeanCost::means).map(|cost| cost / NOISE).collect();
    let count = costs.len() as f64;
    let mean = costs.iter().sum::<f64>() / count;
    let variance = costs.iter().map(|cost| (cost - mean).powi(2)).sum::<f64>() / (count - 1.0);
    let error = (variance / count).sqrt();
    println!(
        "with all of it: a cost of {mean:.5} ± {error:.5}; {:.5} was said",
        simulated.predicted
    );
    match (mean - simulated.predicted).abs() <= 4.0 * error {
        true => Ok(()),
        false => Err("it does not cost what was said".into()),
    }
}
