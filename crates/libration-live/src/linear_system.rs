//! Settings of linear plants.

use libration_equations::Definitions;
use libration_linear::LinearPlant;

use crate::Setting;

impl Setting {
    /// A plant in continuous time with states of first order `x1`, `x2`, … and inputs `u1`, `u2`, …. Each state begins at 1.
    pub fn of_plant(name: &str, plant: &LinearPlant) -> Self {
        let (n, m) = (plant.a.rows(), plant.b.columns());
        let rate = |i: usize| {
            let states = (0..n).map(|j| (plant.a[(i, j)], format!("x{}", j + 1)));
            let inputs = (0..m).map(|j| (plant.b[(i, j)], format!("u{}", j + 1)));
            let terms = states.chain(inputs).filter(|(factor, _)| *factor != 0.0);
            let terms: Vec<String> =
                terms.map(|(factor, name)| format!("({factor:?})*{name}")).collect();
            if terms.is_empty() { "0".to_owned() } else { terms.join(" + ") }
        };
        let definitions = Definitions {
            rates: (0..n).map(|i| (format!("x{}", i + 1), rate(i))).collect(),
            inputs: (0..m).map(|j| format!("u{}", j + 1)).collect(),
            ..Definitions::default()
        };
        let start = (0..n).map(|i| (format!("x{}", i + 1), 1.0)).collect();
        Setting::of_equations(name, definitions, start)
    }
}

#[cfg(test)]
mod tests {
    use libration_equations::Equations;
    use libration_linear::Matrix;

    use super::*;

    #[test]
    fn the_rates_of_a_plant_are_its_matrices() {
        let rows = |rows: &[&[f64]]| Matrix::from_rows(rows).unwrap();
        let (a, b) = (rows(&[&[0.0, 1.5], &[-2.0, 0.0]]), rows(&[&[0.0], &[3.0]]));
        let plant = LinearPlant::new(a, b, Matrix::identity(2), Matrix::zeros(2, 1)).unwrap();
        let setting = Setting::of_plant("plant", &plant);
        let equations = Equations::new(&setting.definitions).unwrap();
        // States of first order are velocities of the program.
        let rates = equations
            .dynamics()
            .accelerations()
            .on::<f64>()
            .run(&[0.0, 0.0, 0.5, 4.0, 10.0])
            .collect::<Vec<_>>();
        assert_eq!(rates, [6.0, 29.0]);
        assert_eq!(setting.to_string().parse::<Setting>().unwrap(), setting);
    }
}
