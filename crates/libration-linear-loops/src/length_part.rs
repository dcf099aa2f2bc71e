//! A part of a period whose length is drawn.

use core::ops::Range;

use libration_linear::{LinearLoop, Matrix, PartMotion};

use super::blocks::{beside, folded};
use super::error::LinearLoopsError;
use super::length_polynomials::{LengthPolynomials, interpolated};
use super::map::Map;
use super::row::{LANES, Row};

/// A part of a period as maps whose factors depend on the length of the period.
#[derive(Clone, Debug)]
pub(super) struct LengthPart {
    /// All factors: those of the maps in order, the constant cost, and the covariance.
    factors: LengthPolynomials,
    /// The next states, of states and inputs.
    step: Map,
    /// What held noise adds to them.
    held_noise: Map,
    /// The columns of the states of the upper half of a form of states and inputs.
    state_cost: Map,
    /// The columns of the inputs.
    input_cost: Map,
    /// The states that white noise reaches.
    reached: Vec<usize>,
    /// Variances below which a pivot of the covariance is rounding.
    least: Vec<f64>,
}

/// The share of the largest variance of a state that interpolation leaves uncertain.
const UNCERTAIN: f64 = 1e-14;

impl LengthPart {
    /// The part between two phases of a period of `lengths` seconds.
    ///
    /// # Errors
    /// [`LinearLoopsError::Lengths`]: the plant moves too fast.
    pub(super) fn new(
        linear: &LinearLoop,
        phases: [f64; 2],
        lengths: [f64; 2],
    ) -> Result<Self, LinearLoopsError> {
        let (n, m) = (linear.plant().states.len(), linear.plant().inputs.len());
        let held = linear.plant().g.columns() * usize::from(linear.holds_noise_and_cost());
        let listed = |seconds: f64| {
            let PartMotion { step, covariance, cost, constant } =
                linear.part_motion(seconds, phases);
            let (form, gamma) = (folded(&cost), step.gamma);
            let covariance = covariance.unwrap_or_else(|| Matrix::zeros(n, n));
            [
                &beside(&step.phi, &gamma.block((0, 0), (n, m))),
                &gamma.block((0, m), (n, held)),
                &form.block((0, 0), (n + m, n)),
                &form.block((0, n), (n + m, m)),
                &Matrix::diagonal(&[constant]),
                &covariance,
            ]
            .into_iter()
            .flat_map(|matrix| matrix.entries().to_vec())
            .collect::<Vec<f64>>()
        };
        let sizes = [n * (n + m), n * held, (n + m) * n, (n + m) * m, 1, n * n];
        let mut end = 0;
        let groups = sizes.map(|size| {
            end += size;
            end - size..end
        });
        let found = interpolated(&listed, &groups, lengths)
            .ok_or(LinearLoopsError::Lengths { shortest: lengths[0], longest: lengths[1] })?;
        // Terms without coefficients are zero.
        let map = |group: &Range<usize>, rows: usize| {
            let columns = group.len().checked_div(rows).unwrap_or(0);
            let kept = |i: usize, j: usize| !found[group.start + i * columns + j].is_empty();
            Map::new(&Matrix::from_fn(rows, columns, |i, j| f64::from(u8::from(kept(i, j)))))
        };
        let [step, held_noise, state_cost, input_cost, constant, covariance] = groups;
        let entry = |i: usize, j: usize| covariance.start + i * n + j;
        let reached: Vec<usize> = (0..n).filter(|&i| !found[entry(i, i)].is_empty()).collect();
        let lower = reached.iter().enumerate().flat_map(|(a, &i)| {
            reached[..=a].iter().map(move |&j| entry(i, j)).collect::<Vec<_>>()
        });
        let terms = [&step, &held_noise, &state_cost, &input_cost].into_iter().cloned().flatten();
        let terms = terms.filter(|&k| !found[k].is_empty());
        let order = terms.chain(constant).chain(lower);
        let at_most = listed(lengths[1]);
        Ok(LengthPart {
            factors: LengthPolynomials::new(order.map(|k| found[k].as_slice())),
            step: map(&step, n),
            held_noise: map(&held_noise, n),
            state_cost: map(&state_cost, n + m),
            input_cost: map(&input_cost, n + m),
            least: reached.iter().map(|&i| UNCERTAIN * at_most[entry(i, i)]).collect(),
            reached,
        })
    }

    /// The normal numbers of white noise.
    pub(super) fn normals(&self) -> usize {
        self.reached.len()
    }

    /// The number of coefficients.
    pub(super) fn work(&self) -> usize {
        self.factors.work() + self.reached.len().pow(3) / 6
    }

    /// The most coefficients of a factor.
    pub(super) fn order(&self) -> usize {
        self.factors.order()
    }

    /// The number of factors.
    pub(super) fn len(&self) -> usize {
        self.factors.len()
    }

    /// The cost and the next states at the lengths of `basis`.
    #[inline(always)]
    #[expect(clippy::too_many_arguments, reason = "rows of one tile")]
    pub(super) fn move_on(
        &self,
        basis: &[Row],
        factors: &mut [Row],
        z: &[Row],
        counted: &[Row],
        normals: &[Row],
        next: &mut [Row],
        cost: &mut Row,
    ) {
        self.factors.evaluate(basis, factors);
        let (inputs, factors) = (&z[next.len()..], &mut factors[..self.factors.len()]);
        let (step, rest) = factors.split_at_mut(self.step.len());
        let (held, rest) = rest.split_at_mut(self.held_noise.len());
        let (of_states, rest) = rest.split_at_mut(self.state_cost.len());
        let (of_inputs, rest) = rest.split_at_mut(self.input_cost.len());
        let Some((constant, covariance)) = rest.split_first_mut() else { return };
        for l in 0..LANES {
            cost[l] += constant[l];
        }
        for (i, z) in counted.iter().chain(inputs).enumerate() {
            let row = self.state_cost.row_by(i, counted, of_states, [0.0; LANES]);
            let row = self.input_cost.row_by(i, inputs, of_inputs, row);
            for l in 0..LANES {
                cost[l] += z[l] * row[l];
            }
        }
        for (i, next) in next.iter_mut().enumerate() {
            let row = self.step.row_by(i, z, step, [0.0; LANES]);
            *next = self.held_noise.row_by(i, normals, held, row);
        }
        self.add_white_noise(covariance, normals, next);
    }

    /// Adds noise with this covariance, whose lower half becomes its Cholesky factor.
    #[inline(always)]
    fn add_white_noise(&self, covariance: &mut [Row], normals: &[Row], next: &mut [Row]) {
        let at = |i: usize, j: usize| i * (i + 1) / 2 + j;
        let count = self.reached.len();
        for j in 0..count {
            let mut pivot = covariance[at(j, j)];
            for k in 0..j {
                let x = covariance[at(j, k)];
                for l in 0..LANES {
                    pivot[l] -= x[l] * x[l];
                }
            }
            let (mut root, mut share) = ([0.0; LANES], [0.0; LANES]);
            for l in 0..LANES {
                let counts = pivot[l] > self.least[j];
                root[l] = if counts { pivot[l].sqrt() } else { 0.0 };
                share[l] = if counts { 1.0 / root[l] } else { 0.0 };
            }
            covariance[at(j, j)] = root;
            for i in j + 1..count {
                let mut entry = covariance[at(i, j)];
                for k in 0..j {
                    let (a, b) = (covariance[at(i, k)], covariance[at(j, k)]);
                    for l in 0..LANES {
                        entry[l] -= a[l] * b[l];
                    }
                }
                for l in 0..LANES {
                    entry[l] *= share[l];
                }
                covariance[at(i, j)] = entry;
            }
        }
        for (i, &state) in self.reached.iter().enumerate() {
            let mut sum = next[state];
            for j in 0..=i {
                let (factor, normal) = (covariance[at(i, j)], normals[j]);
                for l in 0..LANES {
                    sum[l] += factor[l] * normal[l];
                }
            }
            next[state] = sum;
        }
    }
}
