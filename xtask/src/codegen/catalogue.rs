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

/// Every system: its type and its name.
pub(super) const SYSTEMS: [(&str, &str); 7] = [
    ("Oscillator", "oscillator"),
    ("DampedOscillator", "damped-oscillator"),
    ("DrivenOscillator", "driven-oscillator"),
    ("Pendulum", "pendulum"),
    ("Duffing", "duffing"),
    ("Kepler", "kepler"),
    ("HenonHeiles", "henon-heiles"),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::codegen::kernel::without_paths;
    use libration::catalog::ENTRIES;
    use libration::{AnySystem, Method, Model, with_method, with_system};

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
    fn the_systems_are_those_of_the_engine() {
        fn kind<const D: usize>(model: impl Model<D>) -> String {
            let name = type_of(&model.on::<f32>());
            name.trim_end_matches("<f32>").to_owned()
        }
        let listed = ENTRIES.map(|entry| {
            let system = AnySystem::build(entry.name, &[] as &[(&str, f64)]).unwrap();
            let dimension = *entry.dimensions.start();
            (with_system!(system, dimension, |m, D| kind::<D>(m), String::new()), entry.name)
        });
        assert_eq!(SYSTEMS, listed.each_ref().map(|(kind, name)| (kind.as_str(), *name)));
    }
}
