//! Files of bodies in rows.

use std::ops::Range;

use csv::{ReaderBuilder, Trim};
use libration::bodies::{Bodies, Body};

use super::{NamedBodies, body_of, repeated, stem};
use crate::{SettingsError, suggestions};

/// Columns that a CSV file must have.
const COLUMNS: [&str; 7] = ["mass", "x", "y", "z", "vx", "vy", "vz"];

/// Reads rows with the columns `mass, x, y, z, vx, vy, vz`, in any order, and perhaps `name`, `radius` and `charge`.
pub(super) fn of_rows(text: &str, file: &str) -> Result<NamedBodies, SettingsError> {
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
    let known: Vec<&str> = COLUMNS.into_iter().chain(["name", "radius", "charge"]).collect();
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
            charge: number("charge")?,
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
