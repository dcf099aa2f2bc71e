//! Settings of the systems of the catalogue.

use libration_core::AnySystem;
use libration_core::catalog::Actuation;
use libration_equations::Definitions;

use crate::Setting;

impl Setting {
    /// A system of the catalogue by its equations, at the start of its entry. In one dimension it has an input `u`: a force on
    /// its mass `m`, or an acceleration.
    pub fn of_system(system: AnySystem, actuation: Actuation) -> Self {
        let free = Definitions::of_catalogue(system, actuation);
        let is_single = free.coordinates.len() == 1;
        let definitions = if is_single { free.commanded(actuation) } else { free };
        let entry = system.entry();
        let at = |given: &[f64], i: usize| given.get(i).copied().unwrap_or(0.0);
        let start = definitions.coordinates.iter().enumerate();
        let start = start.flat_map(|(i, name)| {
            [(name.clone(), at(entry.q, i)), (format!("{name}'"), at(entry.v, i))]
        });
        let start = start.collect();
        Setting::of_equations(system.name(), definitions, start)
    }
}
