//! Settings of linear plants.

use libration_equations::{Definitions, Equations};
use libration_linear::Matrix;

use crate::Setting;

impl Setting {
    /// A plant `ẋ = Ax + Bu` in continuous time, each state of which begins at 1. States and inputs have the given names, with `_dot` in
    /// place of a prime, or numbers if one of these is no name of an equation.
    pub fn of_plant(
        system: &str,
        a: &Matrix,
        b: &Matrix,
        [states, inputs]: [Vec<String>; 2],
    ) -> Self {
        let own =
            |names: Vec<String>| names.iter().map(|name| name.replace('\'', "_dot")).collect();
        let named = definitions(a, b, &[own(states), own(inputs)]);
        let numbered = |letter: &str, count: usize| {
            (1..=count).map(|i| format!("{letter}{i}")).collect::<Vec<_>>()
        };
        let definitions = match Equations::new(&named) {
            Ok(_) => named,
            Err(_) => definitions(a, b, &[numbered("x", a.rows()), numbered("u", b.columns())]),
        };
        let start = definitions.rates.iter().map(|(name, _)| (name.clone(), 1.0)).collect();
        Setting::of_equations(system, definitions, start)
    }
}

fn definitions(a: &Matrix, b: &Matrix, [states, inputs]: &[Vec<String>; 2]) -> Definitions {
    let rate = |i: usize| {
        let of_states = states.iter().enumerate().map(|(j, name)| (a[(i, j)], name));
        let of_inputs = inputs.iter().enumerate().map(|(j, name)| (b[(i, j)], name));
        let terms = of_states.chain(of_inputs).filter(|(factor, _)| *factor != 0.0);
        let terms: Vec<String> =
            terms.map(|(factor, name)| format!("({factor:?})*{name}")).collect();
        if terms.is_empty() { "0".to_owned() } else { terms.join(" + ") }
    };
    Definitions {
        rates: states.iter().enumerate().map(|(i, name)| (name.clone(), rate(i))).collect(),
        inputs: inputs.clone(),
        ..Definitions::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rates_of_a_plant_are_its_matrices() {
        let rows = |rows: &[&[f64]]| Matrix::from_rows(rows).unwrap();
        let (a, b) = (rows(&[&[0.0, 1.5], &[-2.0, 0.0]]), rows(&[&[0.0], &[3.0]]));
        let names = |given: [&str; 3]| {
            let [first, second, input] = given.map(str::to_owned);
            [vec![first, second], vec![input]]
        };
        for (given, own) in [
            (["x", "x'", "force"], ["x", "x_dot", "force"]),
            (["x 1", "y", "u"], ["x1", "x2", "u1"]),
            (["x", "sin", "u"], ["x1", "x2", "u1"]),
        ] {
            let setting = Setting::of_plant("plant", &a, &b, names(given));
            let found: Vec<&str> =
                setting.definitions.rates.iter().map(|(x, _)| x.as_str()).collect();
            assert_eq!((found, &*setting.definitions.inputs[0]), (own[..2].to_vec(), own[2]));
            let equations = Equations::new(&setting.definitions).unwrap();
            // States of first order are velocities of the program.
            let mut rates = equations.dynamics().accelerations().on::<f64>();
            assert!(rates.run(&[0.0, 0.0, 0.5, 4.0, 10.0]).eq([6.0, 29.0]));
            assert_eq!(setting.to_string().parse::<Setting>().unwrap(), setting);
        }
    }
}
