//! What answers a command: a dead time and a plant of unit gain.

use libration::linear::{LinearPlant, Matrix, eigenvalues, solve_matrix};
use serde::Serialize;

/// The form of a response to a command `u`. Each begins after a dead time `τ`.
#[derive(Clone, Debug, PartialEq)]
pub enum ResponseKind {
    /// `y(t) = K u(t − τ) + b`.
    Delay,
    /// `T ẏ = K u(t − τ) + b − y`: a servo or a filter of first order.
    Lag,
    /// `ÿ = ω² (K u(t − τ) + b − y) − 2ζω ẏ`: a servo with inertia.
    SecondOrder,
    /// `ẏ = w` and `T ẇ = K u(t − τ) + b − w`: the command is a rate.
    IntegratedLag,
    /// A known plant behind a lag: `T ẇ = K u(t − τ) + b − w`, with `w` on its input.
    Plant(Box<KnownPlant>),
}

/// A plant with one input and one output, by its matrices.
#[derive(Clone, Debug, PartialEq)]
pub struct KnownPlant {
    a: Matrix,
    b: Vec<f64>,
    c: Vec<f64>,
    d: f64,
}

impl KnownPlant {
    /// The plant between an input and an output of `plant`, which are numbered from 0; `None` if it has no such channel or is sampled.
    pub fn new(plant: &LinearPlant, input: usize, output: usize) -> Option<Self> {
        let is_inside = input < plant.inputs.len() && output < plant.outputs.len();
        (is_inside && plant.sampling_period.is_none()).then(|| {
            let n = plant.states.len();
            KnownPlant {
                a: plant.a.clone(),
                b: (0..n).map(|i| plant.b[(i, input)]).collect(),
                c: plant.c.row(output).to_vec(),
                d: plant.d[(output, input)],
            }
        })
    }
}

/// The meaning of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct ParameterName {
    /// The key in results.
    pub key: &'static str,
    /// The name in sentences.
    pub name: &'static str,
    /// The unit; empty if there is none.
    pub unit: &'static str,
}

const DEAD_TIME: ParameterName = ParameterName { key: "dead_time", name: "dead time", unit: "s" };
const LAG: ParameterName = ParameterName { key: "lag", name: "lag", unit: "s" };
const ROOT_TIME: ParameterName =
    ParameterName { key: "time_constant", name: "time constant 1/ω", unit: "s" };
const DAMPING: ParameterName =
    ParameterName { key: "damping_ratio", name: "damping ratio", unit: "" };

impl ResponseKind {
    /// The kinds that need no plant, by number of parameters.
    pub const SIMPLE: [ResponseKind; 4] = [
        ResponseKind::Delay,
        ResponseKind::Lag,
        ResponseKind::SecondOrder,
        ResponseKind::IntegratedLag,
    ];

    /// The name on the command line and in results.
    pub fn name(&self) -> &'static str {
        match self {
            ResponseKind::Delay => "delay",
            ResponseKind::Lag => "lag",
            ResponseKind::SecondOrder => "second-order",
            ResponseKind::IntegratedLag => "integrated-lag",
            ResponseKind::Plant(_) => "plant",
        }
    }

    /// The name in sentences.
    pub fn in_words(&self) -> &'static str {
        match self {
            ResponseKind::Delay => "a dead time alone",
            ResponseKind::Lag => "a lag of first order after a dead time",
            ResponseKind::SecondOrder => "a response of second order after a dead time",
            ResponseKind::IntegratedLag => "the integral of a lag of first order after a dead time",
            ResponseKind::Plant(_) => {
                "a lag of first order after a dead time, before the given plant"
            }
        }
    }

    /// The parameters that act nonlinearly, the dead time first.
    pub fn parameters(&self) -> &'static [ParameterName] {
        match self {
            ResponseKind::Delay => &[DEAD_TIME],
            ResponseKind::Lag | ResponseKind::IntegratedLag | ResponseKind::Plant(_) => {
                &[DEAD_TIME, LAG]
            }
            ResponseKind::SecondOrder => &[DEAD_TIME, ROOT_TIME, DAMPING],
        }
    }

    /// Whether it is a plant that grows by more than `e^10` within `span` seconds, so that none of its states is predicted without feedback.
    pub(crate) fn is_unstable(&self, span: f64) -> bool {
        let ResponseKind::Plant(plant) = self else { return false };
        let rates = eigenvalues(&plant.a).unwrap_or_default();
        rates.iter().any(|rate| rate.re * span > 10.0)
    }

    /// The plant behind the dead time, of unit gain, with the parameters behind the dead time.
    ///
    /// A time constant of zero is the limit: the plant loses a state.
    pub(crate) fn dynamics(&self, shape: &[f64]) -> UnitPlant {
        let time = shape.first().copied().unwrap_or(0.0);
        match self {
            ResponseKind::Delay => UnitPlant::direct(),
            ResponseKind::Lag if time == 0.0 => UnitPlant::direct(),
            ResponseKind::Lag => UnitPlant {
                a: Matrix::diagonal(&[-1.0 / time]),
                b: vec![1.0 / time],
                c: vec![1.0],
                d: 0.0,
            },
            ResponseKind::SecondOrder => {
                let (omega, zeta) = (1.0 / time, shape[1]);
                let rates = [[0.0, 1.0], [-omega * omega, -2.0 * zeta * omega]];
                UnitPlant {
                    a: Matrix::from_fn(2, 2, |i, j| rates[i][j]),
                    b: vec![0.0, omega * omega],
                    c: vec![1.0, 0.0],
                    d: 0.0,
                }
            }
            ResponseKind::IntegratedLag => UnitPlant::direct_rate().behind_lag(time),
            ResponseKind::Plant(plant) => {
                let KnownPlant { a, b, c, d } = (**plant).clone();
                UnitPlant { a, b, c, d }.behind_lag(time)
            }
        }
    }
}

/// `ẋ = A x + B u`, `y = C x + D u`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct UnitPlant {
    pub(crate) a: Matrix,
    pub(crate) b: Vec<f64>,
    pub(crate) c: Vec<f64>,
    pub(crate) d: f64,
}

impl UnitPlant {
    fn direct() -> Self {
        UnitPlant { a: Matrix::zeros(0, 0), b: Vec::new(), c: Vec::new(), d: 1.0 }
    }

    fn direct_rate() -> Self {
        UnitPlant { a: Matrix::zeros(1, 1), b: vec![1.0], c: vec![1.0], d: 0.0 }
    }

    /// The number of states.
    pub(crate) fn states(&self) -> usize {
        self.b.len()
    }

    /// Whether a constant input has no state at rest, unless it is zero.
    pub(crate) fn integrates(&self) -> bool {
        let n = self.states();
        n > 0 && solve_matrix(&self.a, &Matrix::from_fn(n, 1, |i, _| self.b[i])).is_none()
    }

    /// The states in which the plant rests under a command of one; of a plant that does not come to rest, that of the lag on its input.
    pub(crate) fn rest(&self) -> Vec<Option<f64>> {
        let n = self.states();
        let a = |i: usize, j: usize| self.a[(i, j)];
        let is_stable = match n {
            0 => true,
            1 => a(0, 0) < 0.0,
            2 => a(0, 0) + a(1, 1) <= 0.0 && a(0, 0) * a(1, 1) - a(0, 1) * a(1, 0) > 0.0,
            _ => eigenvalues(&self.a).is_some_and(|rates| rates.iter().all(|rate| rate.re < 0.0)),
        };
        let b = Matrix::from_fn(n, 1, |i, _| -self.b[i]);
        match solve_matrix(&self.a, &b).filter(|_| is_stable) {
            Some(rest) => (0..n).map(|i| Some(rest[(i, 0)])).collect(),
            None => {
                let is_lag =
                    |i: usize| i + 1 == n && a(i, i) < 0.0 && (0..i).all(|j| a(i, j) == 0.0);
                (0..n).map(|i| is_lag(i).then(|| -self.b[i] / a(i, i))).collect()
            }
        }
    }

    /// The plant behind a lag of unit gain, whose state comes last.
    fn behind_lag(self, time: f64) -> Self {
        if time == 0.0 {
            return self;
        }
        let n = self.states();
        let mut a = Matrix::zeros(n + 1, n + 1);
        a.set_block((0, 0), &self.a);
        for i in 0..n {
            a[(i, n)] = self.b[i];
        }
        a[(n, n)] = -1.0 / time;
        let mut b = vec![0.0; n + 1];
        b[n] = 1.0 / time;
        let mut c = self.c;
        c.push(self.d);
        UnitPlant { a, b, c, d: 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pendulum_upside_down_is_unstable_over_a_time_in_which_it_falls_and_one_that_hangs_never() {
        let response = |stiffness: f64| {
            let rates = [[0.0, 1.0], [stiffness, 0.0]];
            let a = Matrix::from_fn(2, 2, |i, j| rates[i][j]);
            let plant = KnownPlant { a, b: vec![0.0, 1.0], c: vec![1.0, 0.0], d: 0.0 };
            ResponseKind::Plant(Box::new(plant))
        };
        // It falls at the rate 3/s: by e^10 within 3.33 s.
        assert!(response(9.0).is_unstable(3.4) && !response(9.0).is_unstable(3.3));
        assert!(!response(-9.0).is_unstable(1e6));
        assert!(!ResponseKind::IntegratedLag.is_unstable(1e6));
    }
}
