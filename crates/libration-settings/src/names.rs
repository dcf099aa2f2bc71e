//! Names as people type them.

use libration::CatalogError;
use libration::catalog::ENTRIES;
use libration::ensemble::InstructionSet;

/// What an instruction set is called, or that it is to be the widest that there is.
pub fn instruction_set(set: Option<InstructionSet>) -> &'static str {
    set.map_or("widest", InstructionSet::name)
}

/// How alike two names must be, between 0 and 1, for one to be offered for the other.
const NEAR: f64 = 0.7;

/// The candidate that `name` most likely stands for, if one is near enough.
///
/// A part of a compound name will do: `verlet` is near `velocity-verlet`.
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let name = name.to_lowercase();
    let unlikeness = |candidate: &str| {
        let whole = strsim::jaro_winkler(&name, candidate);
        let parts = candidate.split('-').map(|part| 0.95 * strsim::jaro_winkler(&name, part));
        1.0 - parts.fold(whole, f64::max)
    };
    candidates
        .into_iter()
        .map(|candidate| (unlikeness(candidate), candidate))
        .filter(|(unlikeness, _)| *unlikeness < 1.0 - NEAR)
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate)
}

/// What to say about a `name` that is none of the `known` ones, which are called `what`.
pub fn suggest<'a>(
    what: &str,
    name: &str,
    known: impl IntoIterator<Item = &'a str> + Clone,
) -> String {
    let list: Vec<_> = known.clone().into_iter().map(|name| format!("`{name}`")).collect();
    let all = format!("the {what} are {}", list.join(", "));
    match nearest(name, known) {
        Some(near) => format!("did you mean `{near}`? {all}"),
        None => all,
    }
}

/// The end of a sentence that says what the catalogue lacks: which name was likely meant, or nothing where none is near enough.
pub fn meant(error: &CatalogError) -> String {
    let near = match error {
        CatalogError::UnknownParameter { name, known, .. } => {
            nearest(name, known.iter().map(|parameter| parameter.name))
        }
        CatalogError::UnknownSystem { name } => nearest(name, ENTRIES.map(|entry| entry.name)),
        _ => None,
    };
    near.map_or_else(String::new, |near| format!("; did you mean `{near}`?"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_name_is_the_one_that_was_meant() {
        let names = ["explicit-euler", "velocity-verlet", "textbook-verlet", "leapfrog", "rk4"];
        for (typed, meant) in [
            ("verlet", Some("velocity-verlet")),
            ("textbook", Some("textbook-verlet")),
            ("euler", Some("explicit-euler")),
            ("RK-4", Some("rk4")),
            ("leap-frog", Some("leapfrog")),
            ("adams", None),
            ("", None),
        ] {
            assert_eq!(nearest(typed, names), meant, "{typed}");
        }
    }

    #[test]
    fn what_the_catalogue_lacks_was_meant_as_something_that_it_has() {
        let error = |name, parameters: &[(&str, f64)]| {
            meant(&libration::AnySystem::build(name, parameters).unwrap_err())
        };
        assert_eq!(error("oscilator", &[]), "; did you mean `oscillator`?");
        assert_eq!(error("oscillator", &[("omega", 1.0)]), "; did you mean `omega2`?");
        assert_eq!(error("oscillator", &[("temperature", 1.0)]), "");
        assert_eq!(error("oscillator", &[("omega2", -1.0)]), "");
    }
}
