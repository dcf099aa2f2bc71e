//! The block machine on systems by equations.

use libration::ensemble::{AnyEnsemble, BatchFloat, Execution, InstructionSet};
use libration::equations::{Dynamics, StepProgram};
use libration::{Method, with_method};
use proptest::prelude::*;

use super::random_expressions::{equations, expression};

fn start<T: BatchFloat>(n: usize, i: usize) -> T {
    T::from_f64(0.37 * (1.0 + i as f64).sin() + 1e-3 * n as f64)
}

/// Trajectories that differ from those of the program of a step, run alone, in words.
fn differing<T: BatchFloat>(
    dynamics: &Dynamics,
    method: Method,
    len: usize,
    steps: u64,
    execution: &Execution,
) -> Vec<String> {
    let degrees = dynamics.degrees();
    let dt = T::from_f64(0.01);
    let mut all =
        AnyEnsemble::<T>::new(dynamics, None, len, execution.clone(), start::<T>).unwrap();
    all.advance(method, dt, 1);
    all.advance(method, dt, steps - 1);
    let step = with_method!(method, |method| StepProgram::new(method, dynamics));
    let mut alone = step.program().on::<T>();
    // The payload and the sign of what is no number are not those of a program.
    let bits = |x: T| if x.to_f64().is_nan() { u64::MAX } else { x.to_f64().to_bits() };
    let mut found = Vec::new();
    for n in (0..len).filter(|n| *n < 20 || n % 31 == 0 || n + 3 > len) {
        let mut state: Vec<T> = (0..2 * degrees).map(|i| start::<T>(n, i)).collect();
        for _ in 0..steps {
            let inputs: Vec<T> = state.iter().copied().chain([dt]).collect();
            state = alone.run(&inputs).collect();
        }
        for (i, &wanted) in state.iter().enumerate() {
            let plane = if i < degrees { all.q(i) } else { all.v(i - degrees) };
            let got = plane.unwrap()[n];
            if bits(got) != bits(wanted) {
                found.push(format!(
                    "{} lane {n} of {len}, coordinate {i}: {got:?}, not {wanted:?} ({execution:?})",
                    method.name()
                ));
            }
        }
    }
    found
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn trajectories_of_random_equations_have_the_bits_of_the_program_of_a_step(
        texts in prop::array::uniform3(expression()),
        method in prop::sample::select(Method::ALL.to_vec()),
        set in prop::sample::select(InstructionSet::available().collect::<Vec<_>>()),
        threads in 1..3usize,
        len in prop_oneof![1..40usize, 1000..1100usize],
    ) {
        let [x, y, s] = texts;
        let accelerations = vec![("x".to_owned(), x), ("y".to_owned(), y)];
        let equations = equations(accelerations, vec![("s".to_owned(), s)]);
        let execution =
            Execution::serial().instructions(set).unwrap().threads(threads).unwrap().worth(1);
        let dynamics = equations.dynamics();
        let none = Vec::<String>::new();
        prop_assert_eq!(differing::<f64>(dynamics, method, len, 4, &execution), none.clone());
        prop_assert_eq!(differing::<f32>(dynamics, method, len, 4, &execution), none);
    }
}

#[test]
fn a_chain_of_64_masses_has_the_bits_of_its_program_with_every_method() {
    let force = |i: usize| {
        let at = |i: usize| if (1..=64).contains(&i) { format!("x{i}") } else { "0".to_owned() };
        let [left, own, right] = [at(i - 1), at(i), at(i + 1)];
        (format!("x{i}"), format!("k*({left} - 2*{own} + {right}) - 0.1*{own}^3"))
    };
    let equations = equations((1..=64).map(force).collect(), Vec::new());
    for method in Method::ALL {
        let found = differing::<f64>(equations.dynamics(), method, 37, 5, &Execution::serial());
        assert_eq!(found, Vec::<String>::new());
    }
}

#[test]
fn outputs_that_are_inputs_or_constants_of_each_other_end_in_their_rows() {
    // Accelerations that are constants, a part of the state, and the position of each other, which is carried.
    let constant = equations(
        vec![("x".to_owned(), "0".to_owned()), ("y".to_owned(), "0*k".to_owned())],
        vec![("s".to_owned(), "one".to_owned())],
    );
    let pair = |x: &str, y: &str| {
        equations(vec![("x".into(), x.into()), ("y".into(), y.into())], Vec::new())
    };
    for equations in [constant, pair("y", "x"), pair("x", "x"), pair("y'", "x'"), pair("x", "y")] {
        for method in Method::ALL {
            let found = differing::<f64>(equations.dynamics(), method, 5, 3, &Execution::serial());
            assert_eq!(found, Vec::<String>::new());
        }
    }
}
