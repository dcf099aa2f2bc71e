//! Files of linear plants.

use std::collections::BTreeMap;
use std::path::Path;

use libration_data::{ArrayValues, NamedArray, read_mat, read_npz};

use super::PlantTable;
use super::plant_table::Rows;
use crate::limits::SETTINGS_BYTES;
use crate::{Document, Number, SettingsError, equations};

/// All arrays of a file together are as long as its text could be.
const ARRAY_BYTES: usize = SETTINGS_BYTES as usize;

/// Reads a plant from a file.
///
/// `.toml` and `.json` have the keys of `[system.linear]`; a `.toml` file with equations is linearised at an equilibrium. A line of a `.csv` file has the name of a matrix and the numbers of one of
/// its rows. `.npz` (NumPy) and `.mat` (MATLAB 5 to 7) have the matrices as arrays.
///
/// # Errors
/// The error in words, without the name of the file.
pub fn read(path: &Path) -> Result<PlantTable, String> {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    let text = || crate::read_text(path).map_err(|error| error.to_string());
    let bytes = || crate::read(path).map_err(|error| error.to_string());
    let table = match ending.as_deref() {
        Some("toml") => {
            let text = text()?;
            let name = path.to_string_lossy();
            let document = Document::parse(&text, &name).map_err(|error| error.sentence())?;
            if equations::is_system(&text) {
                return Ok(PlantTable { of: Some(name.into_owned()), ..PlantTable::default() });
            }
            if document.has_key("system") {
                let message = "it is a request with the table [system.linear]; expected --config, or a file with the keys of that table alone";
                return Err(message.to_owned());
            }
            table(&text, &document).map_err(|error| error.sentence())?
        }
        Some("json") => serde_json::from_str(&text()?).map_err(|error| error.to_string())?,
        Some("csv") => from_csv(&text()?)?,
        Some("npz") => from_arrays(read_npz(&bytes()?, ARRAY_BYTES)?)?,
        Some("mat") => from_arrays(read_mat(&bytes()?, ARRAY_BYTES)?)?,
        _ => {
            return Err(format!(
                "unknown kind of file `{}`; expected .toml, .json, .csv, .npz or .mat",
                path.display()
            ));
        }
    };
    let PlantTable { file: None, .. } = table else {
        return Err("it has the key `file`; expected a plant".to_owned());
    };
    Ok(table)
}

/// Parses the keys of `[system.linear]`; `file` is the name in messages.
///
/// # Errors
/// [`SettingsError`] with the position of the error.
pub fn parse(text: &str, file: &str) -> Result<PlantTable, SettingsError> {
    table(text, &Document::parse(text, file)?)
}

fn table(text: &str, document: &Document<'_>) -> Result<PlantTable, SettingsError> {
    toml::from_str(text).map_err(|error| document.explain(&error))
}

/// A matrix by lines: `A, 0, 1`.
fn from_csv(text: &str) -> Result<PlantTable, String> {
    let mut matrices: BTreeMap<String, Rows> = BTreeMap::new();
    let mut table = PlantTable::default();
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    for (i, line) in text.lines().enumerate() {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        if line.contains(';') {
            return Err(format!(
                "line {} has a semicolon; expected commas between its cells",
                i + 1
            ));
        }
        let mut cells = line.split(',').map(str::trim);
        let name = cells.next().unwrap_or_default().to_lowercase();
        let cells: Vec<&str> = cells.collect();
        let names = || Some(cells.iter().map(|&name| name.to_owned()).collect());
        match &*name {
            "states" => table.states = names(),
            "inputs" => table.inputs = names(),
            "outputs" => table.outputs = names(),
            _ => {
                let number = |cell: &&str| {
                    let value = cell.parse().map(Number);
                    value.map_err(|_| format!("line {}: `{cell}` is no number", i + 1))
                };
                let row = cells.iter().map(number).collect::<Result<Vec<_>, _>>()?;
                matrices.entry(name).or_default().push(row);
            }
        }
    }
    fill(table, matrices)
}

/// A matrix by an array.
fn from_arrays(arrays: Vec<NamedArray>) -> Result<PlantTable, String> {
    let mut matrices: BTreeMap<String, Rows> = BTreeMap::new();
    let mut table = PlantTable::default();
    for NamedArray { name, values } in arrays {
        let key = name.to_lowercase();
        match (&*key, values) {
            ("states", ArrayValues::Text(names)) => table.states = Some(names),
            ("inputs", ArrayValues::Text(names)) => table.inputs = Some(names),
            ("outputs", ArrayValues::Text(names)) => table.outputs = Some(names),
            (_, ArrayValues::Text(_)) => {
                return Err(format!("array `{name}`: it has strings; expected numbers"));
            }
            (_, ArrayValues::Integers { .. }) => {
                return Err(format!(
                    "array `{name}`: it has integers above 2^53; expected numbers"
                ));
            }
            (_, ArrayValues::Numbers { shape, entries }) => {
                let rows = rows(&key, &shape, &entries).map_err(|why| format!("`{name}` {why}"))?;
                if matrices.insert(key, rows).is_some() {
                    return Err(format!("it has `{name}` in capital and in small letters"));
                }
            }
        }
    }
    fill(table, matrices)
}

/// The rows of an array. One of a single dimension is a column of B and G, with a row for each state, and a row of others.
fn rows(key: &str, shape: &[usize], entries: &[f64]) -> Result<Rows, String> {
    let columns = match (shape, key) {
        (&[_, n], _) => n,
        ([_], "b" | "g") => 1,
        _ => entries.len(),
    };
    if entries.is_empty() {
        return Err("is empty; expected numbers".to_owned());
    }
    if matches!(key, "dt" | "ts") && entries.len() != 1 {
        return Err(format!("has {} numbers; expected one", entries.len()));
    }
    Ok(entries.chunks(columns).map(|row| row.iter().copied().map(Number).collect()).collect())
}

/// Puts the matrices into the table by their names.
fn fill(mut table: PlantTable, matrices: BTreeMap<String, Rows>) -> Result<PlantTable, String> {
    let has = |name: &str| matrices.contains_key(name);
    if has("d") && !has("c") && (has("m") || has("mass")) {
        return Err("`D` beside a mass matrix and without `C` may be damping or a direct path; expected `damping`, or `C` and `D`".to_owned());
    }
    for (name, rows) in matrices {
        let place = match &*name {
            "a" => &mut table.a,
            "b" => &mut table.b,
            "c" => &mut table.c,
            "d" => &mut table.d,
            "g" => &mut table.g,
            "mass" | "m" => &mut table.mass,
            "damping" => &mut table.damping,
            "stiffness" | "k" => &mut table.stiffness,
            "dt" | "ts" => {
                let period = rows.first().and_then(|row| row.first()).copied();
                // A plant in continuous time has a period of zero.
                table.sampling_period = period.filter(|period| period.0 != 0.0);
                continue;
            }
            other => {
                return Err(format!(
                    "unknown matrix `{other}`; expected A, B, C, D, G, mass, damping, stiffness, dt or Ts"
                ));
            }
        };
        *place = Some(rows);
    }
    Ok(table)
}
