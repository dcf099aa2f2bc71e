//! Settings of linear plants.

use libration_equations::{Definitions, Equations};
use libration_linear::Matrix;

use crate::Setting;

/// The largest entry that counts as zero, relative to those of its row, where a plant was measured.
const MEASURED: f64 = 1e-6;

impl Setting {
    /// A plant `ẋ = Ax + Bu` in continuous time, whose first state begins at 1. States and inputs have the given names, with `_dot` in
    /// place of a prime, or numbers if one of these is no name of an equation. Where the second half of the states are the velocities of
    /// the first, these are coordinates with accelerations.
    pub fn of_plant(
        system: &str,
        a: &Matrix,
        b: &Matrix,
        [states, inputs]: [Vec<String>; 2],
    ) -> Self {
        let own = |names: &[String]| -> Vec<String> {
            names.iter().map(|name| name.replace('\'', "_dot")).collect()
        };
        let numbered = |letter: &str, count: usize| {
            (1..=count).map(|i| format!("{letter}{i}")).collect::<Vec<_>>()
        };
        let given = definitions(a, b, &[own(&states), own(&inputs)]);
        let definitions = match Equations::new(&given) {
            Ok(_) => given,
            Err(_) => definitions(a, b, &[numbered("x", a.rows()), numbered("u", b.columns())]),
        };
        let first =
            definitions.coordinates.first().or(definitions.rates.first().map(|(name, _)| name));
        let start = first.map(|name| (name.clone(), 1.0)).into_iter().collect();
        Setting::of_equations(system, definitions, start)
    }
}

/// Whether the second half of the states are the velocities of the first.
fn is_mechanical(a: &Matrix, b: &Matrix) -> bool {
    let (n, half) = (a.rows(), a.rows() / 2);
    let near = |x: f64, expected: f64| (x - expected).abs() <= MEASURED;
    let rate = |i: usize, j: usize| f64::from(u8::from(j == i + half));
    n == 2 * half
        && (0..half).all(|i| {
            (0..n).all(|j| near(a[(i, j)], rate(i, j)))
                && (0..b.columns()).all(|j| near(b[(i, j)], 0.0))
        })
}

fn definitions(a: &Matrix, b: &Matrix, [states, inputs]: &[Vec<String>; 2]) -> Definitions {
    let half = if is_mechanical(a, b) { a.rows() / 2 } else { 0 };
    // A velocity is the prime of its coordinate.
    let state = |j: usize| match j.checked_sub(half).filter(|_| half > 0) {
        Some(j) => format!("{}'", states[j]),
        None => states[j].clone(),
    };
    let rate = |i: usize| {
        let of_states = (0..a.columns()).map(|j| (a[(i, j)], state(j)));
        let of_inputs = inputs.iter().enumerate().map(|(j, name)| (b[(i, j)], name.clone()));
        let terms = of_states.chain(of_inputs).filter(|(factor, _)| *factor != 0.0);
        let terms: Vec<String> =
            terms.map(|(factor, name)| format!("({factor:?})*{name}")).collect();
        if terms.is_empty() { "0".to_owned() } else { terms.join(" + ") }
    };
    let named = |from: usize, to: usize| -> Vec<(String, String)> {
        (from..to).map(|i| (states[i].clone(), rate(i + half))).collect()
    };
    let definitions = Definitions { inputs: inputs.clone(), ..Definitions::default() };
    match half {
        0 => Definitions { rates: named(0, a.rows()), ..definitions },
        half => Definitions {
            coordinates: states[..half].to_vec(),
            accelerations: named(0, half),
            ..definitions
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(rows: &[&[f64]]) -> Matrix {
        Matrix::from_rows(rows).unwrap()
    }

    fn names(given: [&str; 3]) -> [Vec<String>; 2] {
        let [first, second, input] = given.map(str::to_owned);
        [vec![first, second], vec![input]]
    }

    fn rates(setting: &Setting, at: &[f64]) -> Vec<f64> {
        let equations = Equations::new(&setting.definitions).unwrap();
        equations.dynamics().accelerations().on::<f64>().run(at).collect()
    }

    #[test]
    fn the_rates_of_a_plant_are_its_matrices() {
        let (a, b) = (rows(&[&[0.0, 1.5], &[-2.0, 0.0]]), rows(&[&[0.0], &[3.0]]));
        for (given, own) in [
            (["x", "x'", "force"], ["x", "x_dot", "force"]),
            (["x 1", "y", "u"], ["x1", "x2", "u1"]),
            (["x", "sin", "u"], ["x1", "x2", "u1"]),
        ] {
            let setting = Setting::of_plant("plant", &a, &b, names(given));
            let found: Vec<&str> =
                setting.definitions.rates.iter().map(|(x, _)| x.as_str()).collect();
            assert_eq!((found, &*setting.definitions.inputs[0]), (own[..2].to_vec(), own[2]));
            // States of first order are velocities of the program.
            assert_eq!(rates(&setting, &[0.0, 0.0, 0.5, 4.0, 10.0]), [6.0, 29.0]);
            assert_eq!(setting.to_string().parse::<Setting>().unwrap(), setting);
        }
    }

    #[test]
    fn states_that_are_velocities_are_those_of_coordinates() {
        let (a, b) = (rows(&[&[1e-9, 1.0], &[-2.0, -0.1]]), rows(&[&[0.0], &[3.0]]));
        let setting = Setting::of_plant("plant", &a, &b, names(["x", "x'", "force"]));
        assert_eq!(setting.definitions.coordinates, ["x"]);
        assert_eq!(rates(&setting, &[0.5, 4.0, 10.0]), [-1.0 - 0.4 + 30.0]);
        assert_eq!(setting.start, [("x".to_owned(), 1.0)]);
    }
}
