//! Files of linear plants.

use std::collections::BTreeMap;
use std::path::Path;

use super::PlantTable;
use super::plant_table::Rows;
use crate::{Document, Number};

/// Reads a plant from a file.
///
/// `.toml` and `.json` have the keys of `[system.linear]`. A line of a `.csv` file has the name of a matrix and the numbers of one of
/// its rows.
///
/// # Errors
/// The error in words.
pub fn read(path: &Path) -> Result<PlantTable, String> {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    let text = || crate::read_text(path).map_err(|error| error.to_string());
    let table = match ending.as_deref() {
        Some("toml") => {
            let text = text()?;
            let name = path.to_string_lossy();
            let document = Document::parse(&text, &name).map_err(|error| error.to_string())?;
            toml::from_str(&text).map_err(|error| document.explain(&error).to_string())?
        }
        Some("json") => serde_json::from_str(&text()?).map_err(|error| error.to_string())?,
        Some("csv") => from_csv(&text()?)?,
        _ => {
            return Err(format!(
                "unknown kind of file `{}`; expected .toml, .json or .csv",
                path.display()
            ));
        }
    };
    let PlantTable { file: None, .. } = table else {
        return Err("it has the key `file`; expected a plant".to_owned());
    };
    Ok(table)
}

/// A matrix by lines: `A, 0, 1`.
fn from_csv(text: &str) -> Result<PlantTable, String> {
    let mut matrices: BTreeMap<String, Rows> = BTreeMap::new();
    let mut table = PlantTable::default();
    for (i, line) in text.lines().enumerate() {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
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
            "dt" => {
                let period = rows.first().and_then(|row| row.first()).copied();
                // A plant in continuous time has a period of zero.
                table.sampling_period = period.filter(|period| period.0 != 0.0);
                continue;
            }
            other => {
                return Err(format!(
                    "unknown matrix `{other}`; expected A, B, C, D, G, mass, damping, stiffness or dt"
                ));
            }
        };
        *place = Some(rows);
    }
    Ok(table)
}
