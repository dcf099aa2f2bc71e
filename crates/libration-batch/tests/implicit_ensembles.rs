//! Ensembles under implicit steps.

use libration_batch::ensemble::{
    BatchFloat, EnsembleError, Execution, InstructionSet, dynamics_of,
};
use libration_core::system::{HenonHeiles, Oscillator};
use libration_core::{AnySystem, ImplicitMethod};
use libration_equations::StepProgram;

#[test]
fn implicit_steps_have_the_bits_of_the_program_alone_in_every_lane() {
    let system = AnySystem::HenonHeiles(HenonHeiles { lambda: 1.0 });
    let dynamics = dynamics_of(system, 2).unwrap();
    let start = |n: usize, i: usize| 0.1 * (1.0 + i as f64).sin() + 1e-3 * n as f64;
    let (len, dt, steps) = (67, 0.05, 20);
    for set in InstructionSet::available() {
        let execution = Execution::serial().instructions(set).unwrap();
        for method in ImplicitMethod::ALL {
            let all = f64::program_ensemble(&dynamics, len, execution.clone(), &start);
            let mut all = all.unwrap();
            all.advance_implicit(method, dt, steps).unwrap();
            let step = StepProgram::implicit(method, &dynamics);
            let mut alone = step.program().on::<f64>();
            for n in 0..len {
                let mut state: Vec<f64> = (0..4).map(|i| start(n, i)).collect();
                for _ in 0..steps {
                    state = alone.run(&[&state[..], &[dt]].concat()).collect();
                }
                let own = [all.q(0), all.q(1), all.v(0), all.v(1)].map(|x| x.unwrap()[n]);
                assert_eq!(own[..], state[..], "{method:?} {n} {set:?}");
            }
        }
    }
}

#[test]
fn compiled_kernels_refuse_implicit_steps() {
    let oscillator = AnySystem::Oscillator(Oscillator { omega2: 1.0 });
    let mut all = f64::ensemble(oscillator, 1, 2, Execution::serial(), &|_, _| 1.0).unwrap();
    let refused = all.advance_implicit(ImplicitMethod::StablePd, 0.1, 1);
    assert_eq!(refused, Err(EnsembleError::Implicit { method: "stable-pd" }));
}
