//! Discrete controllers in state space.

use crate::{LinearLoopError, Matrix};

/// `m' = A·m + B·y` and `u = C·m + D·y`: a controller with memory `m`, measurements `y` and commands `u`, once per period.
#[derive(Clone, Debug, PartialEq)]
pub struct DiscreteController {
    /// Memory × memory.
    pub a: Matrix,
    /// Memory × measurements.
    pub b: Matrix,
    /// Commands × memory.
    pub c: Matrix,
    /// Commands × measurements.
    pub d: Matrix,
}

impl DiscreteController {
    /// `u = D·y`, without memory.
    pub fn gain(d: Matrix) -> Self {
        let (commands, measurements) = (d.rows(), d.columns());
        let [a, b] = [Matrix::zeros(0, 0), Matrix::zeros(0, measurements)];
        DiscreteController { a, b, c: Matrix::zeros(commands, 0), d }
    }

    /// Fails if the controller does not fit so many inputs and outputs.
    pub(crate) fn fits(&self, [m, p]: [usize; 2]) -> Result<(), LinearLoopError> {
        for (of, given, expected, side) in [
            ("commands", self.commands(), m, "inputs"),
            ("measurements", self.measurements(), p, "outputs"),
        ] {
            if given != expected {
                return Err(LinearLoopError::Channels { of, given, expected, side });
            }
        }
        let memory = self.memory();
        let DiscreteController { a, b, c, d } = self;
        for (name, matrix, shape) in [
            ("controller A", a, [memory, memory]),
            ("controller B", b, [memory, p]),
            ("controller C", c, [m, memory]),
            ("controller D", d, [m, p]),
        ] {
            if [matrix.rows(), matrix.columns()] != shape || !matrix.is_finite() {
                return Err(LinearLoopError::Matrix(name));
            }
        }
        Ok(())
    }

    /// The size of the memory.
    pub fn memory(&self) -> usize {
        self.a.rows()
    }

    /// The number of measurements.
    pub fn measurements(&self) -> usize {
        self.d.columns()
    }

    /// The number of commands.
    pub fn commands(&self) -> usize {
        self.d.rows()
    }

    /// The controller with its commands times `factor`.
    pub fn amplified(&self, factor: f64) -> Self {
        let [c, d] = [&self.c, &self.d].map(|m| m.scaled(factor));
        DiscreteController { c, d, ..self.clone() }
    }
    /// This controller, whose commands are the measurements of `next` in the same period.
    pub fn then(&self, next: &DiscreteController) -> Self {
        let (own, more) = (self.memory(), next.memory());
        let mut a = Matrix::zeros(own + more, own + more);
        a.set_block((0, 0), &self.a);
        a.set_block((own, 0), &(&next.b * &self.c));
        a.set_block((own, own), &next.a);
        let mut b = Matrix::zeros(own + more, self.measurements());
        b.set_block((0, 0), &self.b);
        b.set_block((own, 0), &(&next.b * &self.d));
        let mut c = Matrix::zeros(next.commands(), own + more);
        c.set_block((0, 0), &(&next.d * &self.c));
        c.set_block((0, own), &next.c);
        DiscreteController { a, b, c, d: &next.d * &self.d }
    }
}
