//! Files of bodies: TOML or CSV.

use std::io;
use std::ops::Range;
use std::path::Path;

use csv::{ReaderBuilder, Trim};
use libration::bodies::{Bodies, BodiesError, Body};
use libration_data::read_text_bounded;
use serde::Deserialize;
use toml::Spanned;

use crate::{Document, Number, SettingsError, suggestions};

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
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BodyTable {
    name: Option<String>,
    mass: Spanned<Number>,
    position: Spanned<Vec<Number>>,
    velocity: Spanned<Vec<Number>>,
    radius: Option<Spanned<Number>>,
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
        })
    }

    /// The place of the field of an error.
    fn place(&self, error: &BodiesError) -> Range<usize> {
        let (BodiesError::NotFinite { field, .. } | BodiesError::Negative { field, .. }) = error
        else {
            return self.mass.span();
        };
        match (*field, &self.radius) {
            ("mass", _) => self.mass.span(),
            ("radius", Some(radius)) => radius.span(),
            ("x" | "y" | "z", _) => self.position.span(),
            _ => self.velocity.span(),
        }
    }
}

/// The body that an error is about.
fn body_of(error: &BodiesError) -> Option<usize> {
    match error {
        BodiesError::NotFinite { body, .. } | BodiesError::Negative { body, .. } => Some(*body),
        _ => None,
    }
}

/// Columns that a CSV file must have.
const COLUMNS: [&str; 7] = ["mass", "x", "y", "z", "vx", "vy", "vz"];

/// Reads rows with the columns `mass, x, y, z, vx, vy, vz`, in any order, and perhaps `name` and `radius`.
fn of_rows(text: &str, file: &str) -> Result<NamedBodies, SettingsError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let wrong = |span: Range<usize>, message: String, help: Option<String>| {
        SettingsError::new(file, text, span, message, help)
    };
    let mut reader =
        ReaderBuilder::new().trim(Trim::All).flexible(true).from_reader(text.as_bytes());
    let unreadable = |error: csv::Error| {
        let at = error.position().map_or(0, |position| position.byte() as usize);
        wrong(at..at, error.to_string(), None)
    };
    let heads = reader.headers().map_err(unreadable)?.clone();
    let head = 0..text.lines().next().map_or(0, str::len);
    if heads.is_empty() {
        return Err(wrong(head, "the file is empty; expected a line of names".to_owned(), None));
    }
    let known: Vec<&str> = COLUMNS.into_iter().chain(["name", "radius"]).collect();
    if let Some(other) = heads.iter().find(|head| !known.contains(head)) {
        let help = suggestions::suggest("columns", other, known.iter().copied());
        return Err(wrong(head, format!("unknown column `{other}`"), Some(help)));
    }
    let names_of_columns: Vec<String> = heads.iter().map(str::to_owned).collect();
    if let Some(i) = repeated(&names_of_columns) {
        let message = format!("two columns have the name `{}`", names_of_columns[i]);
        return Err(wrong(head, message, None));
    }
    let column = |name: &str| heads.iter().position(|head| head == name);
    if let Some(missing) = COLUMNS.into_iter().find(|name| column(name).is_none()) {
        let message = format!("no column `{missing}`; expected {}", COLUMNS.join(", "));
        return Err(wrong(head, message, None));
    }
    let (mut bodies, mut names, mut places) = (Vec::new(), Vec::new(), Vec::new());
    for cells in reader.records() {
        let cells = cells.map_err(unreadable)?;
        let start = cells.position().map_or(0, |position| position.byte() as usize);
        // A record starts after the end of the line before it.
        let blank = text[start..].len() - text[start..].trim_start().len();
        let start = start + blank;
        let span = start..start + text[start..].lines().next().map_or(0, str::len);
        if cells.len() != heads.len() {
            let message = format!("{} cells; expected {}", cells.len(), heads.len());
            return Err(wrong(span, message, None));
        }
        let number = |name: &str| {
            let Some(place) = column(name) else { return Ok(0.0) };
            let message = || format!("{name} = `{}`; expected a number", &cells[place]);
            cells[place].parse::<f64>().map_err(|_| wrong(span.clone(), message(), None))
        };
        let body = Body {
            mass: number("mass")?,
            position: [number("x")?, number("y")?, number("z")?],
            velocity: [number("vx")?, number("vy")?, number("vz")?],
            radius: number("radius")?,
        };
        let name = column("name").map(|place| &cells[place]).filter(|name| !name.is_empty());
        names.push(name.map_or_else(|| bodies.len().to_string(), str::to_owned));
        bodies.push(body);
        places.push(span);
    }
    if let Some(i) = repeated(&names) {
        let message = format!("two bodies have the name `{}`", names[i]);
        return Err(wrong(places[i].clone(), message, None));
    }
    let all = Bodies::new(&bodies).map_err(|error| {
        let place = body_of(&error).map_or(head, |i| places[i].clone());
        wrong(place, error.to_string(), None)
    });
    Ok(NamedBodies { name: stem(file), bodies: all?, names })
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
        let second =
            Body { mass: 0.5, position: [1.0, 2.0, 3.0], velocity: [4.0, 5.0, 6.0], radius: 0.1 };
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
        assert!(changed("= 4\n", "= 0\n").starts_with("line 2: gravitational constant 0"));
        let rows = |text: &str| NamedBodies::parse(text, "two.csv").unwrap_err().sentence();
        assert!(rows("mass,x,y,z,vx,vy\n").contains("no column `vz`"));
        assert!(rows("mass,x,y,z,vx,vy,vz,x\n").contains("two columns have the name `x`"));
        let message = rows("mass,x,y,z,vx,vy,vz\n1,0,0,0,0,0,0\n1,0,zero,0,0,0,0\n");
        assert_eq!(message, "line 3: y = `zero`; expected a number");
        let message = rows("mass,x,y,z,vx,vy,vz\n1,0,0,0,0,0,0\n1,0,0,0,0,inf,0\n");
        assert_eq!(message, "line 3: body 1: vy = inf; expected a finite number");
        assert!(rows("mass,x,y,z,vx,vy,vz\n").contains("0 bodies"));
    }
}
