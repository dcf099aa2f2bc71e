//! Golden bits of a run, shared with the tests of the Python package.

use std::f64::consts::PI;

use libration::State;
use libration::control::clock::{Gaussian, Jittered, Skewed, Uniform};
use libration::ensemble::{All, InstructionSet};
use libration::integrator::VelocityVerlet;
use libration::rl::policy::ActionSequence;
use libration::rl::sensor::Noisy;
use libration::rl::start::UniformStart;
use libration::rl::task::SwingUp;
use libration::rl::{Delays, Environment, Environments, StepBuffers};
use libration::system::{BaselineOnly, Pendulum};

use crate::executions_on;

/// FNV-1a, as anybody can write it in a line.
fn hash(bytes: impl IntoIterator<Item = u8>, hash: u64) -> u64 {
    bytes
        .into_iter()
        .fold(hash, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}

#[test]
fn a_perturbed_pendulum_keeps_its_bits_which_are_those_of_python() {
    const COUNT: usize = 5;
    let noise = Gaussian(0.02);
    let task = SwingUp { velocity: 0.1, effort: 0.001 };
    let start = UniformStart(State { q: [-PI], v: [-1.0] }, State { q: [PI], v: [1.0] });
    let world = Environment::new(
        All(BaselineOnly(Pendulum { omega2: 15.0_f32 })),
        VelocityVerlet,
        0.02 / 4.0,
        task,
        start,
    )
    .substeps(4)
    .limit(70)
    .delays(Delays { observation: [3, 3], action: [2, 6] })
    .saturation(6.0)
    .clock((Skewed(libration::control::Jitter::Gaussian(0.01)), Jittered(Uniform(0.1))))
    .sensor(Noisy([noise; 3]));
    // The bits of all instruction sets are compared in `bits.rs`.
    for execution in executions_on(InstructionSet::Baseline) {
        let mut all = Environments::new(world, COUNT, 0, execution).unwrap();
        all.seed(&core::array::from_fn::<_, COUNT, _>(|n| Some(7 + n as u64))).unwrap();
        let (mut seen, mut reward) = ([0.0; 3 * COUNT], [0.0; COUNT]);
        let (mut terminated, mut truncated) = ([0; COUNT], [0; COUNT]);
        let mut found = 0xcbf2_9ce4_8422_2325;
        for t in 0..300_u16 {
            let action = [0.5 * f32::from(t % 13) - 3.0; COUNT];
            let to = StepBuffers {
                seen: &mut seen,
                reward: &mut reward,
                terminated: &mut terminated,
                truncated: &mut truncated,
            };
            all.act(ActionSequence(&action), to).unwrap();
            found = hash(seen.iter().chain(&reward).flat_map(|x: &f32| x.to_le_bytes()), found);
            found = hash(truncated, found);
        }
        assert_eq!(found, 0x5b47_9a4f_0d35_afb5, "{found:#018x}");
    }
}
