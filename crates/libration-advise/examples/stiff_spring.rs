//! Time step and float type for a stiff spring.
//!
//! ```text
//! cargo run --release -p libration-advise --example stiff_spring
//! ```

use std::error::Error;
use std::sync::atomic::AtomicBool;

use libration::system::Oscillator;
use libration::{Float, Hamiltonian, Integrator, Method, State};
use libration_advise as advise;
use libration_work::{Silent, Work};

/// The largest error of the energy over a second relative to `scale`, in numbers of type `T`.
fn lost<T: Float>(method: Method, dt: f64, scale: f64) -> f64 {
    let spring = Oscillator { omega2: 1e8 };
    let same = Oscillator { omega2: T::from_f64(spring.omega2) };
    let start = State { q: [1e-5], v: [0.0] };
    let first = spring.energy(&start);
    let mut state = start.map(T::from_f64);
    (0..(1.0 / dt).round() as u64).fold(0.0, |largest: f64, _| {
        state = method.step(&same, state, T::from_f64(dt));
        largest.max((spring.energy(&state.map(T::to_f64)) - first).abs() / scale)
    })
}

fn main() -> Result<(), Box<dyn Error>> {
    let request = advise::parse(include_str!("stiff_spring.toml"), "stiff_spring.toml")?;
    let stop = AtomicBool::new(false);
    let advice = advise::advise(&Work::new(&Silent, &stop), &request)?;
    println!("{}", advice.answer);

    let (choice, dt) = advice.chosen().ok_or("nothing meets the tolerance")?;
    let method = Method::from_name(choice.integrator).ok_or("an integrator of its own")?;
    // The mean kinetic energy.
    let scale = advice.tolerance.scale.ok_or("a tolerance of the energy has a scale")?;
    for float in &advice.floats {
        let found = match float.float {
            "f32" => lost::<f32>(method, dt, scale),
            _ => lost::<f64>(method, dt, scale),
        };
        println!("{}: {:.4e} said, {found:.4e} found", float.float, float.lost);
        if (found <= request.tolerance.most) != float.meets {
            return Err("the simulation does not do what was said".into());
        }
    }
    Ok(())
}
