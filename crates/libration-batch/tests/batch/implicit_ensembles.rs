//! Ensembles under implicit steps.

use libration_batch::ensemble::{AnyEnsemble, Execution, InstructionSet, dynamics_of};
use libration_core::system::{HenonHeiles, Oscillator};
use libration_core::{AnySystem, ImplicitMethod, Method};
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
            let all = AnyEnsemble::<f64>::new(&dynamics, None, len, execution.clone(), start);
            let mut all = all.unwrap();
            all.advance(method, dt, steps);
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
fn implicit_steps_of_an_oscillator_are_those_of_its_program() {
    let oscillator = AnySystem::Oscillator(Oscillator { omega2: 1.0 });
    let dynamics = dynamics_of(oscillator, 3).unwrap();
    let start = |n: usize, i: usize| 0.1 * n as f64 + i as f64;
    let positions = |twin| {
        let all = AnyEnsemble::<f64>::new(&dynamics, twin, 5, Execution::serial(), start);
        let mut all = all.unwrap();
        // Kernels, a program, and kernels again.
        all.advance(Method::Leapfrog, 0.1, 3);
        all.advance(ImplicitMethod::StablePd, 0.1, 3);
        all.advance(Method::Rk4, 0.1, 3);
        assert_eq!(all.step(), 9);
        [0, 1, 2].map(|i| all.q(i).unwrap().to_vec())
    };
    assert_eq!(positions(Some(oscillator)), positions(None));
}
