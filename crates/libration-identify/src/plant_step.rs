//! Exact steps of a plant under a command that is constant or linear in time.

use std::collections::HashMap;

use libration::linear::{Matrix, StepIntegrals, exponential};

use crate::response::UnitPlant;
use crate::small_step::small_step;

/// An exact step of `h` seconds: `x' = Φx + Γu + Γ₁s` for a command that begins at `u` and rises at the rate `s`.
#[derive(Clone, Debug)]
pub(crate) struct PlantStep {
    /// States × states, row by row.
    pub(crate) phi: Vec<f64>,
    /// `Γ`.
    pub(crate) gamma: Vec<f64>,
    /// `Γ₁`.
    pub(crate) slope: Vec<f64>,
    /// What white noise of unit intensity at the input adds to the covariance, row by row.
    pub(crate) noise: Vec<f64>,
}

/// Steps by their length.
pub(crate) struct PlantSteps<'a> {
    plant: &'a UnitPlant,
    with_noise: bool,
    steps: Vec<PlantStep>,
    by_length: HashMap<u64, usize>,
}

/// Lengths that agree to this many bits of the significand share a step: differences of time stamps differ by their rounding.
const DROPPED_BITS: u32 = 14;

/// A step of less than this in units of `1/‖A‖` is short.
const SHORT: f64 = 3.0;

/// Most steps in memory.
const MOST_STEPS: usize = 1 << 12;

impl<'a> PlantSteps<'a> {
    pub(crate) fn new(plant: &'a UnitPlant, with_noise: bool) -> Self {
        PlantSteps { plant, with_noise, steps: Vec::new(), by_length: HashMap::new() }
    }

    /// The step of `h` seconds.
    pub(crate) fn step(&mut self, h: f64) -> &PlantStep {
        let key = (h.to_bits() + (1 << (DROPPED_BITS - 1))) >> DROPPED_BITS;
        let found = self.by_length.get(&key).copied();
        let index = found.unwrap_or_else(|| {
            if self.steps.len() >= MOST_STEPS {
                self.steps.clear();
                self.by_length.clear();
            }
            let length = f64::from_bits(key << DROPPED_BITS);
            self.steps.push(PlantStep::new(self.plant, length, self.with_noise));
            self.by_length.insert(key, self.steps.len() - 1);
            self.steps.len() - 1
        });
        &self.steps[index]
    }
}

impl PlantStep {
    /// The states behind the step, under a command and its slope.
    pub(crate) fn moved(&self, states: &[f64], command: f64, slope: f64) -> Vec<f64> {
        let n = states.len();
        (0..n)
            .map(|i| {
                let free: f64 = (0..n).map(|j| self.phi[i * n + j] * states[j]).sum();
                free + self.gamma[i] * command + self.slope[i] * slope
            })
            .collect()
    }

    fn new(plant: &UnitPlant, h: f64, with_noise: bool) -> Self {
        match plant.states() {
            1 => Self::of_one_state(plant, h),
            2 => small_step::<2>(plant, h, with_noise),
            3 => small_step::<3>(plant, h, with_noise),
            _ => Self::of_any(plant, h, with_noise),
        }
    }

    /// The closed forms of `ẋ = ax + bu`.
    fn of_one_state(plant: &UnitPlant, h: f64) -> Self {
        let (a, b) = (plant.a[(0, 0)], plant.b[0]);
        let ah = a * h;
        // ∫e^{as}ds, and ∫(h − s)e^{as}ds by its series where the closed form cancels.
        let integral = if a == 0.0 { h } else { ah.exp_m1() / a };
        let second = match ah.abs() < 1e-2 {
            true => {
                h * h
                    * (0.5 + ah * (1.0 / 6.0 + ah * (1.0 / 24.0 + ah * (1.0 / 120.0 + ah / 720.0))))
            }
            false => (integral - h) / a,
        };
        let noise = if a == 0.0 { h } else { (2.0 * ah).exp_m1() / (2.0 * a) };
        PlantStep {
            phi: vec![ah.exp()],
            gamma: vec![b * integral],
            slope: vec![b * second],
            noise: vec![b * b * noise],
        }
    }

    fn of_any(plant: &UnitPlant, h: f64, with_noise: bool) -> Self {
        let n = plant.states();
        let b = Matrix::from_fn(n, 1, |i, _| plant.b[i]);
        // A command that rises is a coordinate that another drives.
        let mut all = Matrix::zeros(n + 2, n + 2);
        all.set_block((0, 0), &plant.a.scaled(h));
        all.set_block((0, n), &b.scaled(h));
        all[(n, n + 1)] = h;
        let power = exponential(&all);
        let noise = match with_noise {
            false => vec![0.0; n * n],
            true => {
                let intensity = Matrix::from_fn(n, n, |i, j| plant.b[i] * plant.b[j]);
                noise(&plant.a, &b, &intensity, h).entries().to_vec()
            }
        };
        PlantStep {
            phi: power.block((0, 0), (n, n)).entries().to_vec(),
            gamma: (0..n).map(|i| power[(i, n)]).collect(),
            slope: (0..n).map(|i| power[(i, n + 1)]).collect(),
            noise,
        }
    }
}

/// `∫₀ʰ e^{As} V e^{Aᵀs} ds` for the intensity `V`.
fn noise(a: &Matrix, b: &Matrix, intensity: &Matrix, h: f64) -> Matrix {
    let n = a.rows();
    if h * a.row_sum_norm() > SHORT {
        let cost = Matrix::zeros(n + 1, n + 1);
        return StepIntegrals::new(a, b, intensity, &cost, h).noise;
    }
    // C. F. Van Loan, IEEE Transactions on Automatic Control 23, 1978: cheaper, and accurate as long as nothing grows much backwards.
    let mut all = Matrix::zeros(2 * n, 2 * n);
    all.set_block((0, 0), &a.scaled(-h));
    all.set_block((0, n), &intensity.scaled(h));
    all.set_block((n, n), &a.transposed().scaled(h));
    let power = exponential(&all);
    &power.block((n, n), (n, n)).transposed() * &power.block((0, n), (n, n))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ways_to_the_noise_of_a_step_agree() {
        let a = Matrix::from_rows(&[[0.0, 1.0], [-30.0, -2.0]]).unwrap();
        let b = Matrix::from_rows(&[[0.0], [5.0]]).unwrap();
        let intensity = Matrix::diagonal(&[0.0, 25.0]);
        for h in [1e-4, 0.02, 0.09] {
            assert!(h * a.row_sum_norm() < SHORT);
            let short = noise(&a, &b, &intensity, h);
            let long = StepIntegrals::new(&a, &b, &intensity, &Matrix::zeros(3, 3), h).noise;
            // e³ roundings of the largest entry.
            let off = short.plus(&long.scaled(-1.0)).largest();
            assert!(off < 20.0 * f64::EPSILON * long.largest(), "{h}: {off:e}");
        }
    }

    #[test]
    fn steps_of_few_states_are_the_general_ones() {
        let oscillator = |omega: f64, zeta: f64| {
            let rates = [[0.0, 1.0], [-omega * omega, -2.0 * zeta * omega]];
            let a = Matrix::from_rows(&rates).unwrap();
            UnitPlant { a, b: vec![0.0, omega * omega], c: vec![1.0, 0.0], d: 0.0 }
        };
        let rates = [[0.0, 1.0, 0.0], [9.0, -0.3, 2.0], [0.0, 0.0, -20.0]];
        let a = Matrix::from_rows(&rates).unwrap();
        let falling = UnitPlant { a, b: vec![0.0, 0.0, 20.0], c: vec![1.0, 0.0, 0.0], d: 0.0 };
        let integrator = UnitPlant {
            a: Matrix::from_rows(&[[0.0, 1.0], [0.0, -5.0]]).unwrap(),
            b: vec![0.0, 5.0],
            c: vec![1.0, 0.0],
            d: 0.0,
        };
        let plants = [
            oscillator(20.0, 0.3),
            oscillator(3.0, 1.0),
            oscillator(50.0, 4.0),
            falling,
            integrator,
        ];
        for plant in &plants {
            for h in [1e-5, 3e-3, 0.02, 0.3] {
                let one = PlantStep::new(plant, h, true);
                let any = PlantStep::of_any(plant, h, true);
                for (one, any) in [
                    (&one.phi, &any.phi),
                    (&one.gamma, &any.gamma),
                    (&one.slope, &any.slope),
                    (&one.noise, &any.noise),
                ] {
                    let size = any.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
                    // Up to ten doublings, each of which doubles an error of a few roundings.
                    let off =
                        one.iter().zip(any).fold(0.0_f64, |most, (x, y)| most.max((x - y).abs()));
                    assert!(off <= 1e-12 * size, "{h}: {one:?} {any:?}");
                }
            }
        }
    }

    #[test]
    fn closed_forms_of_a_lag_are_the_general_ones() {
        for (a, h) in [(-7.0, 0.3), (-0.01, 0.2), (0.0, 0.5), (2.0, 0.1), (-40.0, 1e-5)] {
            let plant = UnitPlant { a: Matrix::diagonal(&[a]), b: vec![3.0], c: vec![1.0], d: 0.0 };
            let [one, any] =
                [PlantStep::of_one_state(&plant, h), PlantStep::of_any(&plant, h, true)];
            for (one, any) in [
                (&one.phi, &any.phi),
                (&one.gamma, &any.gamma),
                (&one.slope, &any.slope),
                (&one.noise, &any.noise),
            ] {
                // A few roundings; the general form adds a dozen terms.
                assert!(
                    (one[0] - any[0]).abs() <= 1e-13 * any[0].abs(),
                    "{a} {h}: {one:?} {any:?}"
                );
            }
        }
    }
}
