//! Files of bodies: TOML or CSV.

mod rows;

use std::collections::BTreeMap;
use std::io;
use std::ops::Range;
use std::path::Path;

use libration::bodies::{Bodies, BodiesError, Body, PairPotential};
use libration_data::read_text_bounded;
use serde::Deserialize;
use toml::Spanned;

use crate::equations::{help, inside};
use crate::{Document, Number, SettingsError};
use rows::of_rows;

/// Bodies with their names.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedBodies {
    /// The name of the system.
    pub name: String,
    /// The bodies.
    pub bodies: Bodies,
    /// A name for each body.
    pub names: Vec<String>,
}

/// Largest size of a file of bodies in bytes: 1000 for each of the most bodies.
const MOST_BYTES: u64 = 1 << 26;

/// The text of a file of bodies.
///
/// # Errors
/// If the file cannot be read, is longer than 64 MiB or is not UTF-8.
pub fn read_text(path: &Path) -> io::Result<String> {
    read_text_bounded(path, MOST_BYTES)
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    system: Option<SystemTable>,
    body: Vec<Spanned<BodyTable>>,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct SystemTable {
    name: Option<String>,
    gravitational_constant: Option<Spanned<Number>>,
    softening: Option<Spanned<Number>>,
    pair_potential: Option<Spanned<String>>,
    #[serde(default)]
    parameters: BTreeMap<String, Number>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BodyTable {
    name: Option<String>,
    mass: Spanned<Number>,
    position: Spanned<Vec<Number>>,
    velocity: Spanned<Vec<Number>>,
    radius: Option<Spanned<Number>>,
    charge: Option<Spanned<Number>>,
}

impl NamedBodies {
    /// Reads a file of bodies; `file` is its name in messages. A name that ends in `.csv` has rows, any other TOML.
    ///
    /// # Errors
    /// The first value that is wrong, with its place.
    pub fn parse(text: &str, file: &str) -> Result<Self, SettingsError> {
        if file.to_ascii_lowercase().ends_with(".csv") {
            return of_rows(text, file);
        }
        let document = Document::parse(text, file)?;
        let File { system, body } =
            toml::from_str(text).map_err(|error| document.explain(&error))?;
        let wrong =
            |span: Range<usize>, message| SettingsError::new(file, text, span, message, None);
        let mut bodies = Vec::with_capacity(body.len());
        for table in &body {
            bodies.push(table.get_ref().body().map_err(|(span, message)| wrong(span, message))?);
        }
        let names = body
            .iter()
            .enumerate()
            .map(|(i, table)| table.get_ref().name.clone().unwrap_or_else(|| i.to_string()));
        let names: Vec<String> = names.collect();
        if let Some(i) = repeated(&names) {
            return Err(wrong(body[i].span(), format!("two bodies have the name `{}`", names[i])));
        }
        let mut all = Bodies::new(&bodies).map_err(|error| {
            let span = body_of(&error).map(|i| body[i].get_ref().place(&error));
            wrong(span.unwrap_or_default(), error.to_string())
        })?;
        let system = system.unwrap_or_default();
        if let Some(text_of) = &system.pair_potential {
            let parameters: Vec<_> =
                system.parameters.iter().map(|(name, value)| (name.clone(), value.0)).collect();
            let potential =
                PairPotential::new(text_of.get_ref(), &parameters).map_err(|error| {
                    let span = inside(text_of, &error, text).unwrap_or_else(|| text_of.span());
                    SettingsError::new(file, text, span, error.to_string(), help(&error))
                })?;
            // Gravity besides must be asked for.
            all = all
                .gravitational_constant(0.0)
                .and_then(|all| all.pair_potential(potential))
                .map_err(|error| {
                    let span = body_of(&error).map(|i| body[i].get_ref().place(&error));
                    wrong(span.unwrap_or_default(), error.to_string())
                })?;
        } else if let Some(name) = system.parameters.keys().next() {
            let message = format!("parameter `{name}`; expected a `pair-potential` that has it");
            return Err(wrong(0..0, message));
        }
        if let Some(constant) = &system.gravitational_constant {
            all = all
                .gravitational_constant(constant.get_ref().0)
                .map_err(|error| wrong(constant.span(), error.to_string()))?;
        }
        if let Some(softening) = &system.softening {
            all = all
                .softening(softening.get_ref().0)
                .map_err(|error| wrong(softening.span(), error.to_string()))?;
        }
        Ok(NamedBodies { name: system.name.unwrap_or_else(|| stem(file)), bodies: all, names })
    }
}

impl BodyTable {
    fn body(&self) -> Result<Body, (Range<usize>, String)> {
        let vector = |key: &str, given: &Spanned<Vec<Number>>| match given.get_ref()[..] {
            [Number(x), Number(y), Number(z)] => Ok([x, y, z]),
            ref other => {
                let message = format!("`{key}` has {} numbers; expected 3", other.len());
                Err((given.span(), message))
            }
        };
        Ok(Body {
            mass: self.mass.get_ref().0,
            position: vector("position", &self.position)?,
            velocity: vector("velocity", &self.velocity)?,
            radius: self.radius.as_ref().map_or(0.0, |radius| radius.get_ref().0),
            charge: self.charge.as_ref().map_or(0.0, |charge| charge.get_ref().0),
        })
    }

    /// The place of the field of an error.
    fn place(&self, error: &BodiesError) -> Range<usize> {
        let (BodiesError::NotFinite { field, .. } | BodiesError::Negative { field, .. }) = error
        else {
            return self.mass.span();
        };
        match (*field, &self.radius, &self.charge) {
            ("mass", ..) => self.mass.span(),
            ("radius", Some(radius), _) => radius.span(),
            ("charge", _, Some(charge)) => charge.span(),
            ("x" | "y" | "z", ..) => self.position.span(),
            _ => self.velocity.span(),
        }
    }
}

/// The body that an error is about.
fn body_of(error: &BodiesError) -> Option<usize> {
    match error {
        BodiesError::NotFinite { body, .. }
        | BodiesError::Negative { body, .. }
        | BodiesError::Massless { body } => Some(*body),
        _ => None,
    }
}

/// The last of the first two equal names.
fn repeated(names: &[String]) -> Option<usize> {
    let mut seen = std::collections::HashSet::new();
    names.iter().position(|name| !seen.insert(name))
}

/// The name of a file without folder and extension.
fn stem(file: &str) -> String {
    Path::new(file)
        .file_stem()
        .map_or_else(|| file.to_owned(), |stem| stem.to_string_lossy().into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    const TWO: &str = "[system]\ngravitational-constant = 4\nsoftening = 0.5\n\
        [[body]]\nname = \"sun\"\nmass = 1\nposition = [0, 0, 0]\nvelocity = [0, 0, 0]\n\
        [[body]]\nmass = 0.5\nposition = [1, 2, 3]\nvelocity = [4, 5, 6]\nradius = 0.1\n";

    #[test]
    fn a_file_has_the_bodies_in_its_order() {
        let read = NamedBodies::parse(TWO, "folder/two.toml").unwrap();
        assert_eq!(read.name, "two");
        assert_eq!(read.names, ["sun", "1"]);
        assert_eq!((read.bodies.constant(), read.bodies.softening_length()), (4.0, 0.5));
        let second = Body {
            mass: 0.5,
            position: [1.0, 2.0, 3.0],
            velocity: [4.0, 5.0, 6.0],
            radius: 0.1,
            charge: 0.0,
        };
        assert_eq!(read.bodies.body(1), second);
        let rows =
            "name, mass, x,y,z, vy,vx,vz,radius\nsun,1,0,0,0,0,0,0,0\n\n1,0.5,1,2,3,5,4,6,.1\n";
        let rows = NamedBodies::parse(rows, "two.csv").unwrap();
        let quoted = "\u{feff}\"name\",mass,x,y,z,vx,vy,vz\r\n\"sun, our\",1,0,0,0,0,0,0\r\n,0,1,0,0,0,1,0\r\n";
        let quoted = NamedBodies::parse(quoted, "two.csv").unwrap();
        assert_eq!(quoted.names, ["sun, our", "1"]);
        assert_eq!(rows.names, read.names);
        assert!(rows.bodies.iter().eq(read.bodies.iter()));
    }

    #[test]
    fn what_is_wrong_is_shown_with_its_line() {
        let changed = |from: &str, to: &str| {
            NamedBodies::parse(&TWO.replace(from, to), "two.toml").unwrap_err().sentence()
        };
        let message = changed("mass = 0.5", "mass = -2");
        let expected = "line 10: body 1: mass = -2.0; expected a finite number of at least 0";
        assert_eq!(message, expected);
        assert_eq!(changed("[1, 2, 3]", "[1, 2]"), "line 11: `position` has 2 numbers; expected 3");
        assert!(changed("mass = 1\n", "mas = 1\n").contains("unknown key `mas`"));
        assert!(changed("= 4\n", "= -4\n").starts_with("line 2: gravitational constant -4"));
        let rows = |text: &str| NamedBodies::parse(text, "two.csv").unwrap_err().sentence();
        assert!(rows("mass,x,y,z,vx,vy\n").contains("no column `vz`"));
        assert!(rows("mass,x,y,z,vx,vy,vz,x\n").contains("two columns have the name `x`"));
        let message = rows("mass,x,y,z,vx,vy,vz\n1,0,0,0,0,0,0\n1,0,zero,0,0,0,0\n");
        assert_eq!(message, "line 3: y = `zero`; expected a number");
        let message = rows("mass,x,y,z,vx,vy,vz\n1,0,0,0,0,0,0\n1,0,0,0,0,inf,0\n");
        assert_eq!(message, "line 3: body 1: vy = inf; expected a finite number");
        assert!(rows("mass,x,y,z,vx,vy,vz\n").contains("0 bodies"));
    }

    const IONS: &str = "[system]\npair-potential = \"k*q1*q2/r\"\nparameters = { k = 2 }\n\
        [[body]]\nmass = 1\ncharge = -1\nposition = [0, 0, 0]\nvelocity = [0, 0, 0]\n\
        [[body]]\nmass = 2\nposition = [1, 0, 0]\nvelocity = [0, 0, 0]\n";

    #[test]
    fn a_pair_potential_replaces_gravity_unless_its_constant_is_given() {
        let read = NamedBodies::parse(IONS, "ions.toml").unwrap().bodies;
        let pairs = read.pairs().unwrap();
        assert_eq!((pairs.text(), pairs.parameters()), ("k*q1*q2/r", &[("k".to_owned(), 2.0)][..]));
        assert_eq!((read.constant(), read.charges()), (0.0, &[-1.0, 0.0][..]));
        let both = IONS.replace("[system]", "[system]\ngravitational-constant = 3");
        assert_eq!(NamedBodies::parse(&both, "ions.toml").unwrap().bodies.constant(), 3.0);
        let rows = NamedBodies::parse("charge,mass,x,y,z,vx,vy,vz\n-3,1,0,0,0,0,0,0\n", "i.csv");
        assert_eq!(rows.unwrap().bodies.charges(), [-3.0]);
    }

    #[test]
    fn what_is_wrong_with_a_pair_potential_is_shown_in_its_text() {
        let changed = |from: &str, to: &str| {
            NamedBodies::parse(&IONS.replace(from, to), "ions.toml").unwrap_err()
        };
        let unknown = changed("q2/r", "q3/r");
        assert!(
            unknown.sentence().starts_with("line 2: unknown name `q3`"),
            "{}",
            unknown.sentence()
        );
        assert!(
            changed("{ k = 2 }", "{ m1 = 2, k = 1 }").sentence().contains("`m1` is given twice")
        );
        let massless = changed("mass = 2", "mass = 0").sentence();
        assert_eq!(
            massless,
            "line 10: body 1: mass = 0; expected a mass above 0 with a pair potential"
        );
        let alone = changed("pair-potential = \"k*q1*q2/r\"\n", "").sentence();
        assert!(alone.contains("expected a `pair-potential` that has it"), "{alone}");
        let text = changed("charge = -1", "charge = nan").sentence();
        assert!(text.contains("charge = NaN; expected a finite number"), "{text}");
    }
}
