//! Settings of live pages.

use std::path::Path;

use libration::catalog;
use libration::live::Setting;

use crate::EquationExample;
use crate::equations::EquationSystem;
use crate::linear_loop::PlantTable;

/// Free motion of a system by its equations, from its start.
pub fn of_equations(system: &EquationSystem) -> Setting {
    let start = system.states.iter().filter(|state| state.start != 0.0 || system.states.len() <= 4);
    let start = start.map(|state| (state.name.clone(), state.start)).collect();
    Setting::of_equations(&system.name, system.definitions.clone(), start)
}

/// The system of equations that a plant is linearised from, near its start; none of other plants.
pub fn of_plant_table(table: &PlantTable) -> Option<Setting> {
    let PlantTable { of: Some(file), parameters, at: None, command: None, .. } = table else {
        return None;
    };
    let text = crate::read_text(Path::new(file)).ok()?;
    let set: Vec<(String, f64)> =
        parameters.iter().map(|(name, value)| (name.clone(), value.0)).collect();
    EquationSystem::parse(&text, file, &set).ok().as_ref().map(of_equations)
}

/// The systems of the catalogue and the example files, without those that are too large for a page.
pub fn examples() -> Vec<Setting> {
    let none: [(&str, f64); 0] = [];
    let catalogue = catalog::ENTRIES.into_iter().filter_map(|entry| {
        let (system, actuation) = catalog::build(entry.name, &none).ok()?;
        Some(Setting::of_system(system, actuation))
    });
    let files = EquationExample::ALL.into_iter().filter_map(|example| {
        let system = EquationSystem::parse(example.text, example.name, &[]).ok()?;
        let fits = system.equations.degrees().len() <= libration::live::MOST_DEGREES;
        fits.then(|| of_equations(&system))
    });
    catalogue.chain(files).collect()
}

#[cfg(test)]
mod tests {
    use libration::live;

    use super::*;

    #[test]
    fn each_example_moves_in_a_page_and_has_a_prediction() {
        let all = examples();
        assert!(all.len() >= 15, "{}", all.len());
        for setting in all {
            let answer = live::answer(&format!("view\n{setting}"));
            assert_eq!(answer.get_text("error"), "", "{}", setting.system);
            assert!(answer.get("time").len() > 100, "{}", setting.system);
            assert!(answer.get("growth.predicted")[0].is_finite(), "{}", setting.system);
            assert_eq!(setting.to_string().parse::<Setting>().unwrap(), setting);
        }
    }
}
