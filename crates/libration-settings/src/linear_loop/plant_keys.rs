//! The keys that each form of plant takes.

use super::PlantTable;
use crate::Fault;

/// What a table of a plant requires.
pub(super) const ONE_FORM: &str =
    "a plant requires one of `of`, `a`, `mass`, `numerator` and `file`";

impl PlantTable {
    /// Fails if keys of another form of plant are given beside those of one.
    pub(super) fn check_keys(&self) -> Result<(), Fault> {
        let given = [
            ("of", self.of.is_some()),
            ("a", self.a.is_some()),
            ("mass", self.mass.is_some()),
            ("numerator", self.numerator.is_some()),
        ];
        let forms: Vec<&str> =
            given.iter().filter(|(_, given)| *given).map(|(key, _)| *key).collect();
        let [form] = forms[..] else {
            let found = match &forms[..] {
                [] => "none is given".to_owned(),
                several => format!("`{}` are given", several.join("` and `")),
            };
            let message = format!("{ONE_FORM}, but {found}");
            return Err(Fault::new("system.linear", message));
        };
        let others: [(&str, bool, &[&str]); 10] = [
            ("b", self.b.is_some(), &["a", "mass"]),
            ("c", self.c.is_some(), &["a", "mass"]),
            ("d", self.d.is_some(), &["a", "mass"]),
            ("damping", self.damping.is_some(), &["mass"]),
            ("stiffness", self.stiffness.is_some(), &["mass"]),
            ("denominator", self.denominator.is_some(), &["numerator"]),
            ("sampling-period", self.sampling_period.is_some(), &["a", "numerator"]),
            ("at", self.at.is_some(), &["of"]),
            ("command", self.command.is_some(), &["of"]),
            ("parameters", !self.parameters.is_empty(), &["of"]),
        ];
        let foreign = others.iter().find(|(_, given, forms)| *given && !forms.contains(&form));
        if let Some((key, _, _)) = foreign {
            let message = format!("`{key}` is given, but it is no key of a plant by `{form}`");
            return Err(Fault::new("system.linear", message));
        }
        if form == "mass" && self.d.is_some() && self.c.is_none() {
            let message = "`d` is given without `c`: it is the direct path to the outputs; the damping matrix is `damping`";
            return Err(Fault::new("system.linear.d", message));
        }
        Ok(())
    }
}
