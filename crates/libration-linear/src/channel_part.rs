//! Lags and filters in the channels of a plant.

use core::f64::consts::{SQRT_2, TAU};

use thiserror::Error;

use crate::{LinearPlant, Matrix, Signal};

/// A lag or a filter in a channel, of gain 1 at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ChannelPart {
    /// A first-order lag of this time constant in s, `1/(τs + 1)`.
    Lag(f64),
    /// A second-order Butterworth filter of this cutoff frequency in Hz.
    Butterworth2(f64),
}

/// Error of a lag or a filter.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ChannelPartError {
    /// The time constant or the frequency is invalid.
    #[error("`{name}` has a {of} of {value}; expected a finite number above 0")]
    Value {
        /// The name of the part.
        name: String,
        /// `time constant` or `cutoff frequency`.
        of: &'static str,
        /// The value.
        value: f64,
    },
    /// The plant is sampled.
    #[error("`{name}` is a filter in continuous time, but the plant is sampled")]
    Sampled {
        /// The name of the part.
        name: String,
    },
    /// The plant would have too many states.
    #[error("with `{name}` the plant has more than {} states", crate::MOST_STATES)]
    Size {
        /// The name of the part.
        name: String,
    },
}

impl ChannelPart {
    /// The delay at low frequencies, in s: the time constant of a lag, and `√2/(2πf)` of a Butterworth filter.
    pub fn delay(self) -> f64 {
        match self {
            ChannelPart::Lag(time) => time,
            ChannelPart::Butterworth2(frequency) => SQRT_2 / (TAU * frequency),
        }
    }

    /// The phase in rad, at `omega` rad/s; negative.
    pub fn phase(self, omega: f64) -> f64 {
        match self {
            ChannelPart::Lag(time) => -(omega * time).atan(),
            ChannelPart::Butterworth2(frequency) => {
                let ratio = omega / (TAU * frequency);
                -(SQRT_2 * ratio).atan2(1.0 - ratio * ratio)
            }
        }
    }

    /// `A`, `B` and `C` in state space. The output is the first state.
    fn matrices(self) -> [Matrix; 3] {
        match self {
            ChannelPart::Lag(time) => {
                let rate = time.recip();
                [-rate, rate, 1.0].map(|x| Matrix::diagonal(&[x]))
            }
            ChannelPart::Butterworth2(frequency) => {
                let omega = TAU * frequency;
                // In units of time 1/ω both states have the size of the output.
                let a = [[0.0, omega], [-omega, -SQRT_2 * omega]];
                let b = [0.0, omega];
                [
                    Matrix::from_fn(2, 2, |i, j| a[i][j]),
                    Matrix::from_fn(2, 1, |i, _| b[i]),
                    Matrix::from_fn(1, 2, |_, j| [1.0, 0.0][j]),
                ]
            }
        }
    }

    fn check(self, name: &str, plant: &LinearPlant) -> Result<(), ChannelPartError> {
        let name = || name.to_owned();
        let (of, value) = match self {
            ChannelPart::Lag(time) => ("time constant", time),
            ChannelPart::Butterworth2(frequency) => ("cutoff frequency", frequency),
        };
        if !(value.is_finite() && value > 0.0) {
            return Err(ChannelPartError::Value { name: name(), of, value });
        }
        if plant.sampling_period.is_some() {
            return Err(ChannelPartError::Sampled { name: name() });
        }
        let [own, _, _] = self.matrices();
        match plant.states.len() + own.rows() > crate::MOST_STATES {
            true => Err(ChannelPartError::Size { name: name() }),
            false => Ok(()),
        }
    }

    /// The names of its states.
    fn states(self, name: &str, unit: &str) -> Vec<Signal> {
        match self {
            ChannelPart::Lag(_) => vec![Signal::new(name, unit)],
            ChannelPart::Butterworth2(_) => {
                vec![Signal::new(name, unit), Signal::new(&format!("{name} (rate)"), unit)]
            }
        }
    }
}

impl LinearPlant {
    /// The plant with a part before input `i`. Its states come last, named after it.
    ///
    /// # Errors
    /// [`ChannelPartError`].
    pub fn with_input_part(
        &self,
        i: usize,
        part: ChannelPart,
        name: &str,
    ) -> Result<Self, ChannelPartError> {
        part.check(name, self)?;
        let [own, drive, out] = part.matrices();
        let (n, more) = (self.states.len(), own.rows());
        let column = |matrix: &Matrix| Matrix::from_fn(matrix.rows(), 1, |k, _| matrix[(k, i)]);
        let mut plant = self.grown(&own, part.states(name, &self.inputs[i].unit));
        plant.a.set_block((0, n), &(&column(&self.b) * &out));
        plant.c.set_block((0, n), &(&column(&self.d) * &out));
        for k in 0..n {
            plant.b[(k, i)] = 0.0;
        }
        for k in 0..self.outputs.len() {
            plant.d[(k, i)] = 0.0;
        }
        for k in 0..more {
            plant.b[(n + k, i)] = drive[(k, 0)];
        }
        Ok(plant)
    }

    /// The plant with a part behind output `j`. Its states come last, named after it.
    ///
    /// # Errors
    /// [`ChannelPartError`].
    pub fn with_output_part(
        &self,
        j: usize,
        part: ChannelPart,
        name: &str,
    ) -> Result<Self, ChannelPartError> {
        part.check(name, self)?;
        let [own, drive, out] = part.matrices();
        let n = self.states.len();
        let row = |matrix: &Matrix| Matrix::from_fn(1, matrix.columns(), |_, k| matrix[(j, k)]);
        let mut plant = self.grown(&own, part.states(name, &self.outputs[j].unit));
        plant.a.set_block((n, 0), &(&drive * &row(&self.c)));
        plant.b.set_block((n, 0), &(&drive * &row(&self.d)));
        plant.c.row_mut(j).fill(0.0);
        plant.d.row_mut(j).fill(0.0);
        plant.c.row_mut(j)[n..].copy_from_slice(out.row(0));
        Ok(plant)
    }

    /// The plant with more states that nothing drives yet.
    fn grown(&self, own: &Matrix, names: Vec<Signal>) -> Self {
        let (n, more) = (self.states.len(), own.rows());
        let padded = |matrix: &Matrix, rows: usize, columns: usize| {
            let mut all = Matrix::zeros(rows, columns);
            all.set_block((0, 0), matrix);
            all
        };
        let mut a = padded(&self.a, n + more, n + more);
        a.set_block((n, n), own);
        LinearPlant {
            a,
            b: padded(&self.b, n + more, self.b.columns()),
            c: padded(&self.c, self.c.rows(), n + more),
            g: padded(&self.g, n + more, self.g.columns()),
            states: self.states.iter().cloned().chain(names).collect(),
            ..self.clone()
        }
    }
}

#[cfg(test)]
mod tests {
    use num_complex::Complex64;

    use super::*;
    use crate::solve;

    /// `C(s − A)⁻¹B + D` at `s = iω`, from the first input to the first output.
    fn response(plant: &LinearPlant, omega: f64) -> Complex64 {
        let n = plant.states.len();
        let row = |i: usize| -> Vec<Complex64> {
            let entry = |j: usize| {
                let own = if i == j { Complex64::new(0.0, omega) } else { Complex64::ZERO };
                own - plant.a[(i, j)]
            };
            (0..n).map(entry).chain([Complex64::from(plant.b[(i, 0)])]).collect()
        };
        let x = solve((0..n).map(row).collect(), |x: Complex64| x.norm());
        let through: Complex64 = x.iter().zip(plant.c.row(0)).map(|(x, c)| x * c).sum();
        through + plant.d[(0, 0)]
    }

    #[test]
    fn a_part_multiplies_the_response_of_its_channel() {
        let a = Matrix::from_rows(&[[0.0, 1.0], [-9.0, -1.0]]).unwrap();
        let b = Matrix::from_rows(&[[0.0], [1.0]]).unwrap();
        let [c, d] = [[1.0, 0.5], [0.3, 0.0]].map(|row| row.to_vec());
        let c = Matrix::from_rows(&[c]).unwrap();
        let plant = LinearPlant::new(a, b, c, Matrix::diagonal(&d[..1])).unwrap();
        for part in [ChannelPart::Lag(0.02), ChannelPart::Butterworth2(30.0)] {
            let before = plant.with_input_part(0, part, "part").unwrap();
            let after = plant.with_output_part(0, part, "part").unwrap();
            for omega in [0.1, 3.0, 40.0, 500.0] {
                let s = Complex64::new(0.0, omega);
                let own = match part {
                    ChannelPart::Lag(time) => (s * time + 1.0).inv(),
                    ChannelPart::Butterworth2(frequency) => {
                        let s = s / (TAU * frequency);
                        (s * s + s * SQRT_2 + 1.0).inv()
                    }
                };
                assert!((own.arg() - part.phase(omega)).abs() < 1e-12);
                let wanted = own * response(&plant, omega);
                for found in [&before, &after].map(|plant| response(plant, omega)) {
                    assert!((found - wanted).norm() < 1e-13 * wanted.norm().max(1e-3));
                }
            }
            // The delay is the slope of the phase at rest.
            let slope = -part.phase(1e-6) / 1e-6;
            assert!((slope - part.delay()).abs() < 1e-9, "{slope}");
        }
    }

    #[test]
    fn delays_of_filters_are_those_that_the_guide_of_a_flight_controller_has() {
        // PX4's user guide: second-order Butterworth filters of 30, 60 and 120 Hz delay by 7.5, 3.75 and 1.88 ms.
        for (frequency, wanted) in [(30.0, 7.50e-3), (60.0, 3.75e-3), (120.0, 1.88e-3)] {
            let delay = ChannelPart::Butterworth2(frequency).delay();
            assert!((delay - wanted).abs() < 0.5e-5, "{frequency} {delay}");
        }
    }
}
