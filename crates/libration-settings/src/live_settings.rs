//! Settings of live pages.

use libration::catalog;
use libration::live::Setting;

use crate::EquationExample;
use crate::equations::{EquationSystem, Twin};

/// Free motion of a system, from its start. A system of the catalogue in one dimension has an input `u`: a force on its mass `m`, or an
/// acceleration.
pub fn of_system(system: &EquationSystem) -> Setting {
    let definitions = match system.twin {
        Some(Twin { actuation, .. }) if system.definitions.coordinates.len() == 1 => {
            system.definitions.clone().commanded(actuation)
        }
        _ => system.definitions.clone(),
    };
    let start = system.states.iter().filter(|state| state.start != 0.0 || system.states.len() <= 4);
    let start = start.map(|state| (state.name.clone(), state.start)).collect();
    Setting::of_equations(&system.name, definitions, start)
}

/// The systems of the catalogue and the example files, without those that are too large for a page.
pub fn examples() -> Vec<Setting> {
    let none: [(&str, f64); 0] = [];
    let catalogue = catalog::ENTRIES.into_iter().filter_map(|entry| {
        let built = catalog::build(entry.name, &none).ok()?;
        Some(of_system(&EquationSystem::of_catalogue(built, None, None).ok()?))
    });
    let files = EquationExample::ALL.into_iter().filter_map(|example| {
        let system = EquationSystem::parse(example.text, example.name, &[]).ok()?;
        let fits = system.equations.degrees().len() <= libration::live::MOST_DEGREES;
        fits.then(|| of_system(&system))
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
