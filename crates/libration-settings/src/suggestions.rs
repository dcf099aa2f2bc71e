//! Suggestions for unknown names.

use libration::CatalogError;
use libration::catalog::ENTRIES;

/// Smallest similarity of a suggested name, between 0 and 1.
const NEAR: f64 = 0.7;

/// The candidate most similar to `name`, if one is similar enough.
///
/// A part of a compound name suffices: `verlet` is similar to `velocity-verlet`.
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let name = name.to_lowercase();
    // A common beginning alone does not make a single letter similar to a word.
    let likeness = |other: &str| match (other.len(), name.len()) {
        (1, 3..) => 0.0,
        _ => strsim::jaro_winkler(&name, other),
    };
    let unlikeness = |candidate: &str| {
        let whole = likeness(candidate);
        let parts = candidate.split('-').map(|part| 0.95 * likeness(part));
        1.0 - parts.fold(whole, f64::max)
    };
    candidates
        .into_iter()
        .map(|candidate| (unlikeness(candidate), candidate))
        .filter(|(unlikeness, _)| *unlikeness < 1.0 - NEAR)
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate)
}

/// Help for an unknown `name`: the most similar of the `known` names and a list of them; `what` is their noun in the plural.
pub fn suggest<'a>(
    what: &str,
    name: &str,
    known: impl IntoIterator<Item = &'a str> + Clone,
) -> String {
    let list: Vec<_> = known.clone().into_iter().map(|name| format!("`{name}`")).collect();
    let all = format!("the {what} are {}", list.join(", "));
    let meant = key_meant(name).filter(|meant| known.clone().into_iter().any(|one| one == *meant));
    match meant.or_else(|| nearest(name, known)) {
        Some(near) => format!("did you mean `{near}`? {all}"),
        None => all,
    }
}

/// Keys of settings, each with its other names in former versions and other libraries.
const KEYS: [(&str, &[&str]); 3] = [
    ("dtype", &["float", "float_type", "precision"]),
    ("num_envs", &["environments", "environment", "n_envs", "nenvs"]),
    ("max_episode_steps", &["limit", "time_limit", "episode_length", "max_steps"]),
];

/// The key that is meant by another name: the same thing comes before one that is spelled alike.
pub(crate) fn key_meant(name: &str) -> Option<&'static str> {
    KEYS.iter().find(|(_, others)| others.contains(&name)).map(|(key, _)| *key)
}

/// The laws of jitter and skew, each with its other names in libraries and textbooks.
const LAWS: [(&str, &[&str]); 2] = [
    ("gaussian", &["normal", "norm", "gauss", "randn", "n"]),
    ("uniform", &["rectangular", "rect", "flat", "rand", "equal", "u"]),
];

/// The law that is meant by another name: the same thing comes before one that is spelled alike.
pub fn law_meant(name: &str) -> Option<&'static str> {
    let lower = name.to_lowercase();
    let same = LAWS.iter().find(|(_, others)| others.contains(&&*lower)).map(|(law, _)| *law);
    same.or_else(|| nearest(name, LAWS.map(|(law, _)| law)))
}

/// Help for an unknown law.
pub fn suggest_law(name: &str) -> String {
    let all = "the laws are `gaussian`, `uniform`";
    law_meant(name).map_or_else(|| all.to_owned(), |law| format!("did you mean `{law}`? {all}"))
}

/// The suggestion at the end of a message about an unknown system or parameter; empty without a similar name.
pub fn catalog_help(error: &CatalogError) -> String {
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
    fn nearest_returns_the_most_similar_name() {
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
        assert_eq!(nearest("temperature", ["t", "x"]), None);
        assert_eq!(nearest("T", ["t", "x"]), Some("t"));
    }

    #[test]
    fn a_law_by_another_name_is_the_law_that_it_is() {
        for (name, law) in [
            ("normal", Some("gaussian")),
            ("Normal", Some("gaussian")),
            ("gauss", Some("gaussian")),
            ("norm", Some("gaussian")),
            ("gausian", Some("gaussian")),
            ("rectangular", Some("uniform")),
            ("unifrom", Some("uniform")),
            ("flat", Some("uniform")),
            ("poisson", None),
        ] {
            assert_eq!(law_meant(name), law, "{name}");
        }
    }

    #[test]
    fn catalog_errors_suggest_known_names() {
        let error = |name, parameters: &[(&str, f64)]| {
            catalog_help(&libration::AnySystem::build(name, parameters).unwrap_err())
        };
        assert_eq!(error("oscilator", &[]), "; did you mean `oscillator`?");
        assert_eq!(error("oscillator", &[("omega", 1.0)]), "; did you mean `omega2`?");
        assert_eq!(error("oscillator", &[("temperature", 1.0)]), "");
        assert_eq!(error("oscillator", &[("omega2", -1.0)]), "");
    }
}
