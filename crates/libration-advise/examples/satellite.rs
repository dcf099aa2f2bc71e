//! Integrator and time step for the orbit of a satellite over a year.
//!
//! ```text
//! cargo run --release -p libration-advise --example satellite [DAYS]
//! ```

use std::error::Error;
use std::sync::atomic::AtomicBool;

use libration::simulation::{EnergyDrift, Simulator};
use libration::system::Kepler;
use libration::{Method, State, with_method};
use libration_advise as advise;
use libration_work::{Silent, Work};

fn main() -> Result<(), Box<dyn Error>> {
    let mut request = advise::parse(include_str!("satellite.toml"), "satellite.toml")?;
    if let Some(days) = std::env::args().nth(1) {
        request.horizon = 86_400.0 * days.parse::<f64>()?;
    }
    let stop = AtomicBool::new(false);
    let advice = advise::advise(&Work::new(&Silent, &stop), &request)?;
    println!("{}", advice.answer);
    println!("runner-up: {}", advice.runner_up.as_deref().unwrap_or("none"));

    // The advice is followed, by code of one's own.
    let (choice, dt) = advice.chosen().ok_or("nothing meets the tolerance")?;
    let method = Method::from_name(choice.integrator).ok_or("an integrator of its own")?;
    let earth = Kepler { mu: 398_600.441_8 };
    let start = State { q: [7000.0, 0.0], v: [0.0, 7.6] };
    for (step, holds) in [(dt, true), (1.2 * dt, false)] {
        let mut drift = EnergyDrift::new(earth, &start);
        let steps = (request.horizon / step).round() as u64;
        with_method!(method, |m| Simulator::new(earth, m, start, step)?.run(steps, &mut drift))?;
        println!(
            "{} in steps of {step:.4} s loses {:.4e} of the energy",
            method.title(),
            drift.largest()
        );
        if (drift.largest() <= request.tolerance.most) != holds {
            return Err("the simulation does not do what was said".into());
        }
    }
    Ok(())
}
