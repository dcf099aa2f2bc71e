//! Growth of orbits, by simulation.

use libration::simulation::{Sample, SimulationError, Simulator};
use libration::system::Oscillator;
use libration::{Integrator, State};

/// An orbit grows if its largest extent in the second half exceeds that in the first by this.
pub(super) const GROWTH: f64 = 1.01;

/// Whether the orbits of both unit vectors grow from the first to the second half of `steps` steps on
/// the oscillator with `ω = 1`.
pub(super) fn grows(integrator: impl Integrator, z: f64, steps: u64) -> bool {
    let unit = Oscillator { omega2: 1.0 };
    let one = |q: f64, v: f64| {
        let mut extent = [0.0_f64; 2];
        let mut watch = |sample: &Sample<f64, 1>| {
            let half = usize::from(sample.step > steps / 2);
            extent[half] = extent[half].max(sample.state.q[0].abs() + sample.state.v[0].abs());
        };
        let start = State { q: [q], v: [v] };
        let outcome = Simulator::new(unit, integrator, start, z)
            .and_then(|mut simulator| simulator.run(steps, &mut watch));
        matches!(outcome, Err(SimulationError::NotFinite { .. })) || extent[1] > GROWTH * extent[0]
    };
    one(1.0, 0.0) || one(0.0, 1.0)
}
