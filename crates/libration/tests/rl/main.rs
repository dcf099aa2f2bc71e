//! Environments and their rollouts.

#![allow(clippy::unwrap_used)]

mod any_policy;
mod bits;
mod clocks;
mod episodes;
mod faults;
mod float_types;
mod golden;
mod policies;
mod scalar_reference;
mod seeds;
mod steps;
mod tensors;

use libration::control::clock::{Fixed, Gaussian, Jittered, Skewed, Uniform};
use libration::ensemble::{All, Execution, InstructionSet};
use libration::integrator::SymplecticEuler;
use libration::rl::sensor::{Exact, Noisy};
use libration::rl::start::UniformStart;
use libration::rl::task::Regulate;
use libration::rl::variation::NoVariation;
use libration::rl::{Autoreset, Delays, Distribution, Environment, ErrorScale, Variation, World};
use libration::system::{BaselineOnly, Oscillator};
use libration::{Method, State};

const SPRING: Oscillator<f32> = Oscillator { omega2: 10.0 };
const TASK: Regulate = Regulate { position: 1.0, velocity: 0.1, effort: 0.01, bound: 1.2 };
const ANYWHERE: UniformStart<1> =
    UniformStart(State { q: [-1.0], v: [-2.0] }, State { q: [1.0], v: [2.0] });

/// A spring in one degree of freedom.
type Spring<C = Fixed, N = Exact, V = NoVariation, S = Oscillator<f32>> =
    Environment<S, All<S>, SymplecticEuler, Regulate, UniformStart<1>, C, N, V>;

/// Clocks that are wrong and uneven.
type Uneven = (Skewed, Jittered<Gaussian>);

/// Energy is pumped in, so that some episodes end at the bound before the limit of 60 steps.
fn ideal() -> Spring {
    Environment::new(All(SPRING), SymplecticEuler, 0.06, TASK, ANYWHERE).limit(60)
}

/// The same on one instruction set, which is compiled once and not once for each: for tests that do not compare them. With `AnyPolicy` it
/// is compiled once for all of these tests.
fn plain() -> Spring<Fixed, Exact, NoVariation, BaselineOnly<Oscillator<f32>>> {
    Environment::new(All(BaselineOnly(SPRING)), SymplecticEuler, 0.06, TASK, ANYWHERE).limit(60)
}

/// All that an environment can suffer from.
fn perturbed(
    autoreset: Autoreset,
) -> Spring<Uneven, Noisy<Uniform, 2>, impl Variation<f32, Oscillator<f32>, Regulate>> {
    use libration::control::Jitter;
    use libration::rl::variation::RandomParameters;

    Environment::new(All(SPRING), SymplecticEuler, 0.02, TASK, ANYWHERE)
        .substeps(3)
        .limit(60)
        .autoreset(autoreset)
        .delays(Delays { observation: [0, 4], action: [2, 7] })
        .saturation(2.5)
        .clock((Skewed(Jitter::Uniform(0.01)), Jittered(Gaussian(0.2))))
        .sensor(Noisy([Uniform(0.05), Uniform(0.1)]))
        .error_scale(ErrorScale { clock: [0.0, 2.0], sensor: [0.5, 1.5] })
        .variation(RandomParameters {
            numbers: [Distribution::Uniform(8.0, 12.0), Distribution::Uniform(1.0, 1.4)],
            apply: |[omega2, bound]: [f32; 2], _: Oscillator<f32>, task: Regulate| {
                (Oscillator { omega2 }, Regulate { bound: bound.into(), ..task })
            },
        })
}

/// One whose integrator is known only when the program runs: a large kernel, on one instruction set.
fn chosen(method: Method) -> impl World<f32, 2, 1> {
    use libration::control::Jitter;

    Environment::new(All(BaselineOnly(SPRING)), method, 0.02, TASK, ANYWHERE)
        .substeps(3)
        .limit(60)
        .delays(Delays { observation: [0, 4], action: [2, 7] })
        .saturation(2.5)
        .mass(0.3)
        .clock((Skewed(Jitter::Uniform(0.01)), Jittered(Gaussian(0.2))))
        .sensor(Noisy([Uniform(0.05), Uniform(0.1)]))
        .error_scale(ErrorScale { clock: [0.0, 2.0], sensor: [0.5, 1.5] })
}

/// On every instruction set, alone and with more threads than a small machine has cores.
fn executions() -> Vec<Execution> {
    InstructionSet::available().flat_map(executions_on).collect()
}

/// On one instruction set.
fn executions_on(set: InstructionSet) -> [Execution; 2] {
    [1, 3].map(|threads| {
        let execution = Execution::serial().threads(threads).unwrap().worth(1);
        execution.instructions(set).unwrap()
    })
}
