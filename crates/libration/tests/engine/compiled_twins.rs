//! Compiled twins of programs.

use libration::ensemble::{AnyEnsemble, Execution, dynamics_of};
use libration::{AnySystem, Method};

#[test]
fn compiled_kernels_of_a_twin_change_no_bit_of_any_method() {
    let system = AnySystem::build("oscillator", &[] as &[(&str, f64)]).unwrap();
    let dynamics = dynamics_of(system, 2).unwrap();
    let start = |n: usize, i: usize| (0.3 * n as f64 + i as f64).sin();
    for method in Method::all() {
        let bits = |twin| -> Vec<u64> {
            let execution = Execution::serial();
            let mut all = AnyEnsemble::<f64>::new(&dynamics, twin, 67, execution, start).unwrap();
            all.advance(method, 0.07, 5);
            let planes = [all.q(0), all.q(1), all.v(0), all.v(1)].map(|plane| plane.unwrap());
            let energies = all.energies().unwrap();
            planes.concat().iter().chain(&energies).map(|x| x.to_bits()).collect()
        };
        assert_eq!(bits(Some(system)), bits(None), "{}", method.name());
    }
}
