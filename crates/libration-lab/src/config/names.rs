//! Names as people type them.

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
}
