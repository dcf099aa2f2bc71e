//! Each integrator is written once, in one place, for every number type and dimension.

use std::collections::HashMap;

use super::code::{line_of, words};
use super::finding::Finding;
use super::source::Source;

const HOME: &str = "crates/libration-core/src/integrator/";

/// Implementations of `Integrator` outside their folder, and second ones of the same type.
pub(super) fn check(sources: &[Source]) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut first: HashMap<&str, String> = HashMap::new();
    for source in sources {
        for (number, name) in implementations(&source.code) {
            if !source.path.starts_with(HOME) {
                let advice = format!("`{name}` is an integrator: define it in {HOME}");
                findings.push(Finding::new(&source.path, number, advice));
            }
            let place = format!("{}:{number}", source.path);
            if let Some(other) = first.get(name) {
                let advice = format!(
                    "a second definition of `{name}`, after {other}: keep the one that is generic \
                     over the number and the dimension"
                );
                findings.push(Finding::new(&source.path, number, advice));
            } else {
                first.insert(name, place);
            }
        }
    }
    findings
}

/// Line and type name of each `impl … Integrator for …`.
fn implementations(code: &str) -> impl Iterator<Item = (usize, &str)> {
    words(code, "Integrator").filter_map(|at| {
        let target = code[at + "Integrator".len()..].trim_start().strip_prefix("for ")?;
        let target = target.strip_prefix("&'static ").unwrap_or(target);
        let path = target.split(['<', '{', ' ', '\n']).next()?;
        Some((line_of(code, at), path.rsplit("::").next()?))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn places(sources: &[(&str, &str)]) -> Vec<(String, usize)> {
        let sources: Vec<Source> =
            sources.iter().map(|(path, text)| Source::new(path, text)).collect();
        let place = |finding: &Finding| (finding.place().0.to_owned(), finding.place().1);
        check(&sources).iter().map(place).collect()
    }

    const EULER: (&str, &str) =
        ("crates/libration-core/src/integrator/euler.rs", "impl Integrator for Euler {}\n");

    #[test]
    fn a_second_definition_is_found() {
        let again = "crates/libration-core/src/integrator/euler32.rs";
        let text = "struct A;\nimpl<const N: usize> crate::Integrator for super::Euler<N> {}\n";
        assert_eq!(places(&[EULER, (again, text)]), [(again.to_owned(), 2)]);
    }

    #[test]
    fn an_integrator_outside_its_folder_is_found() {
        let elsewhere = "crates/libration-lab/src/batch.rs";
        let text = "impl<S>\n    Integrator for Heun<S>\n{\n}\n";
        assert_eq!(places(&[EULER, (elsewhere, text)]), [(elsewhere.to_owned(), 2)]);
    }

    #[test]
    fn one_definition_each_passes() {
        let other = "crates/libration-core/src/integrator/composition.rs";
        let text = "// impl Integrator for Euler\nimpl<I: Integrator> Integrator for Both<I> {}\n";
        assert_eq!(places(&[EULER, (other, text)]), []);
    }
}
