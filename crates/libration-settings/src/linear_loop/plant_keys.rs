//! The keys that each form of plant takes.

use crate::Fault;

/// What a table of a plant requires.
pub(super) const ONE_FORM: &str =
    "a plant requires one of `of`, `a`, `mass`, `numerator` and `file`";

/// The key of each form of plant, and the other keys that the form takes.
const FORMS: [(&str, &[&str]); 4] = [
    ("of", &["at", "command", "parameters"]),
    ("a", &["b", "c", "d", "sampling-period"]),
    ("mass", &["damping", "stiffness", "b", "c", "d"]),
    ("numerator", &["denominator", "sampling-period"]),
];

/// Checks that the given keys are those of one form of plant. Keys of noise and names belong to every form; `given` is without them.
///
/// # Errors
/// [`Fault`]: no form, several forms, or a key of another form.
pub(super) fn check(given: &[&str]) -> Result<(), Fault> {
    let forms: Vec<_> = FORMS.iter().filter(|(form, _)| given.contains(form)).collect();
    let [(form, others)] = forms[..] else {
        let names: Vec<&str> = forms.iter().map(|(form, _)| *form).collect();
        let found = match names.is_empty() {
            true => "none is given".to_owned(),
            false => format!("`{}` are given", names.join("` and `")),
        };
        return Err(Fault::new("system.linear", format!("{ONE_FORM}, but {found}")));
    };
    if let Some(key) = given.iter().find(|key| *key != form && !others.contains(key)) {
        let message = format!("`{key}` is given, but it is no key of a plant by `{form}`");
        return Err(Fault::new("system.linear", message));
    }
    Ok(())
}
