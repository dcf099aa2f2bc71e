//! The exact solutions in `reference/systems.json`, made by `tools/reference.py`.

use libration::{AnySystem, State};
use serde_json::Value;

/// A system, a start, and the exact end.
pub(crate) struct Case {
    pub(crate) name: String,
    pub(crate) system: AnySystem,
    pub(crate) time: f64,
    pub(crate) start: Point,
    pub(crate) end: Point,
}

/// A state and its energy.
pub(crate) struct Point {
    pub(crate) q: Vec<f64>,
    pub(crate) v: Vec<f64>,
    pub(crate) energy: f64,
}

impl Case {
    pub(crate) fn all() -> Vec<Case> {
        let text = include_str!("../reference/systems.json");
        let file: Value = serde_json::from_str(text).unwrap();
        file["cases"].as_array().unwrap().iter().map(Case::read).collect()
    }

    fn read(case: &Value) -> Case {
        let parameters: Vec<(&str, f64)> = case["parameters"]
            .as_object()
            .unwrap()
            .iter()
            .map(|(name, value)| (name.as_str(), value.as_f64().unwrap()))
            .collect();
        Case {
            name: case["name"].as_str().unwrap().to_owned(),
            system: AnySystem::build(case["system"].as_str().unwrap(), &parameters).unwrap(),
            time: case["time"].as_f64().unwrap(),
            start: Point::read(&case["start"]),
            end: Point::read(&case["end"]),
        }
    }

    pub(crate) fn dimension(&self) -> usize {
        self.start.q.len()
    }

    /// Whether the force depends on the velocity.
    pub(crate) fn is_damped(&self) -> bool {
        self.system.parameters().iter().any(|&(name, value)| name == "gamma" && value != 0.0)
    }
}

impl Point {
    fn read(point: &Value) -> Point {
        let list = |name: &str| -> Vec<f64> {
            point[name].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
        };
        Point { q: list("q"), v: list("v"), energy: point["energy"].as_f64().unwrap() }
    }

    pub(crate) fn state<const D: usize>(&self) -> State<f64, D> {
        State { q: self.q.as_slice().try_into().unwrap(), v: self.v.as_slice().try_into().unwrap() }
    }
}
