//! The two doors: each system of the catalogue by its name and by its equations, and what their answers have in common.
//!
//! `tests/doors/table.txt` has the keys of both JSON documents, and the values that differ. One value for a system makes the last three
//! columns zero; until then a change shows which way it goes. `LIBRATION_RENEW_SNAPSHOTS=1` writes the table anew.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;
use std::{env, fs};

use serde_json::Value;

const FOLDER: &str = "tests/doors";
const SYSTEMS: [&str; 7] = [
    "oscillator",
    "damped-oscillator",
    "driven-oscillator",
    "pendulum",
    "duffing",
    "kepler",
    "henon-heiles",
];

/// The name of a row, a command, and its words by name and by equations.
const COMMANDS: [(&str, &str, &str, &str); 5] = [
    ("analyze", "analyze", "--integrator velocity-verlet --dt 0.05 --steps 100 --json", ""),
    ("simulate", "simulate", "--integrator velocity-verlet --dt 0.05 --steps 3 --format json", ""),
    (
        "advise",
        "advise",
        "--period 0.01 --latency 0.015 --json --feedback 10,2",
        "--period 0.01 --latency 0.015 --json --gain 10,2",
    ),
    (
        "adaptive",
        "simulate",
        "--integrator velocity-verlet --dt 0.05 --steps 3 --adaptive integrating --format json",
        "",
    ),
    ("langevin", "analyze", "--temperature 0.1 --friction 0.5 --steps 3200 --json", ""),
];

/// The values of a document by their paths, such as `rows[0][1]`; none if the command refuses.
fn answer(command: &str, system: &str, words: &str) -> Option<BTreeMap<String, Value>> {
    let output = Command::new(env!("CARGO_BIN_EXE_libration"))
        .args(["-q", command, "--system", system])
        .args(words.split_whitespace())
        .output()
        .expect("the program runs");
    let document = serde_json::from_slice(&output.stdout).ok()?;
    let mut values = BTreeMap::new();
    collect("", &document, &mut values);
    Some(values)
}

fn collect(path: &str, value: &Value, values: &mut BTreeMap<String, Value>) {
    match value {
        Value::Object(map) => {
            map.iter().for_each(|(key, value)| collect(&format!("{path}.{key}"), value, values));
        }
        Value::Array(items) => {
            let items = items.iter().enumerate();
            items.for_each(|(i, value)| collect(&format!("{path}[{i}]"), value, values));
        }
        other => {
            values.insert(path.to_owned(), other.clone());
        }
    }
}

fn row(command: &str, system: &str, doors: [Option<BTreeMap<String, Value>>; 2]) -> String {
    let [Some(name), Some(file)] = &doors else {
        let told = |door: &Option<_>| if door.is_some() { "answers" } else { "refuses" };
        return format!(
            "{command:<10}{system:<20}{:>10}{:>10}\n",
            told(&doors[0]),
            told(&doors[1])
        );
    };
    let same = name.iter().filter(|(path, value)| file.get(*path) == Some(value)).count();
    let both = name.keys().filter(|path| file.contains_key(*path)).count();
    let (differ, by_name, by_file) = (both - same, name.len() - both, file.len() - both);
    format!("{command:<10}{system:<20}{same:>10}{differ:>10}{by_name:>10}{by_file:>10}\n")
}

#[test]
fn systems_by_name_and_by_equations_have_as_much_in_common_as_is_kept() {
    let columns = ["same", "differ", "by name", "by file"];
    let mut table = format!("{:<10}{:<20}", "command", "system");
    columns.iter().for_each(|column| table += &format!("{column:>10}"));
    table.push('\n');
    for (label, command, by_name, by_file) in COMMANDS {
        for system in SYSTEMS {
            let by_file = if by_file.is_empty() { by_name } else { by_file };
            let doors = [
                answer(command, system, by_name),
                answer(command, &format!("{FOLDER}/{system}.toml"), by_file),
            ];
            table += &row(label, system, doors);
        }
    }
    let path = Path::new(FOLDER).join("table.txt");
    if env::var_os("LIBRATION_RENEW_SNAPSHOTS").is_some() {
        fs::write(path, table).unwrap();
        return;
    }
    assert_eq!(table, fs::read_to_string(path).unwrap());
}
