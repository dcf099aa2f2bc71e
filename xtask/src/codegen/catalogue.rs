//! The methods and systems of the engine, by the names of their types.

/// Every method: its type and its name. A test compares them with the engine, on which this program
/// does not depend, since it would then have to be compiled before any task.
pub(super) const METHODS: [(&str, &str); 9] = [
    ("ExplicitEuler", "explicit-euler"),
    ("SymplecticEuler", "symplectic-euler"),
    ("SymplecticEulerDriftFirst", "symplectic-euler-drift-first"),
    ("VelocityVerlet", "velocity-verlet"),
    ("TextbookVerlet", "textbook-verlet"),
    ("Leapfrog", "leapfrog"),
    ("Rk4", "rk4"),
    ("Composition<VelocityVerlet, 3>", "yoshida4"),
    ("Composition<VelocityVerlet, 5>", "suzuki4"),
];

/// The systems with kernels of their own: their types and their names.
pub(super) const SYSTEMS: [(&str, &str); 1] = [("Oscillator", "oscillator")];

/// The names of the block machine, which takes any system and any method.
pub(super) const MACHINE: [&str; 2] = ["block machine", "any"];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::codegen::kernel::without_paths;
    use libration::{AnySystem, Method, Model, with_method};

    fn type_of<T>(_: &T) -> String {
        without_paths(core::any::type_name::<T>())
    }

    #[test]
    fn the_methods_are_those_of_the_engine() {
        let kinds = Method::ALL.map(|method| with_method!(method, |m| type_of(&m)));
        let names = Method::ALL.map(Method::name);
        assert_eq!(METHODS.map(|(kind, _)| kind), kinds.each_ref().map(String::as_str));
        assert_eq!(METHODS.map(|(_, name)| name), names);
    }

    #[test]
    fn systems_with_kernels_are_called_as_in_the_engine() {
        let system = AnySystem::build(SYSTEMS[0].1, &[] as &[(&str, f64)]).unwrap();
        let AnySystem::Oscillator(model) = system else { panic!("{system:?}") };
        let name = type_of(&Model::<1>::on::<f32>(&model));
        assert_eq!(SYSTEMS[0].0, name.trim_end_matches("<f32>"));
    }
}
