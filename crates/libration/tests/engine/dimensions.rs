//! Uncoupled degrees of freedom have the bits of separate systems.

use half::{bf16, f16};
use libration::system::Oscillator;
use libration::{Float, Method, Model, State};
use proptest::prelude::*;

use super::step_function::step_function;

/// The bits, as far as `f64` can hold those of every float type: it can.
fn bits<S: Float, const D: usize>(state: State<S, D>) -> Vec<u64> {
    state.coordinates().map(|x| x.to_f64().to_bits()).collect()
}

/// One hundred steps.
fn run<S: Float, const D: usize>(
    oscillator: Oscillator<f64>,
    method: Method,
    start: State<f64, D>,
    dt: f64,
) -> State<S, D> {
    let system = Model::<D>::on::<S>(&oscillator);
    let (start, dt) = (start.map(S::from_f64), S::from_f64(dt));
    let step = step_function(method, system, dt);
    (0..100).fold(start, |state, _| step(state))
}

/// Three dimensions at once against one at a time.
fn compare<S: Float>(
    oscillator: Oscillator<f64>,
    method: Method,
    State { q, v }: State<f64, 3>,
    dt: f64,
) -> Result<(), TestCaseError> {
    let together = run::<S, 3>(oscillator, method, State { q, v }, dt);
    for i in 0..3 {
        let alone = run::<S, 1>(oscillator, method, State { q: [q[i]], v: [v[i]] }, dt);
        let part = State { q: [together.q[i]], v: [together.v[i]] };
        prop_assert_eq!(bits(part), bits(alone), "{} on {}", method.name(), S::NAME);
    }
    Ok(())
}

proptest! {
    #[test]
    fn three_dimensions_are_three_oscillators_bit_for_bit(
        q in prop::array::uniform3(-2.0..2.0),
        v in prop::array::uniform3(-2.0..2.0),
        omega2 in 0.01..20.0,
        dt in 0.001..0.1,
    ) {
        let (oscillator, start) = (Oscillator { omega2 }, State { q, v });
        for method in Method::ALL {
            compare::<f64>(oscillator, method, start, dt)?;
            compare::<f32>(oscillator, method, start, dt)?;
            compare::<f16>(oscillator, method, start, dt)?;
            compare::<bf16>(oscillator, method, start, dt)?;
        }
    }
}
