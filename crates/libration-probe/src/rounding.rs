//! Roundings of a step: of its results, its actions and its length.

use libration::linear::Matrix;
use serde::Serialize;

use crate::BlackBoxError;
use crate::convergence::displaced;
use crate::prober::Prober;

/// Roundings that single precision leaves: a few of 6·10⁻⁸, or a part of one.
const SINGLE: core::ops::Range<f64> = 3e-10..1e-6;
/// Part of a power of two by which points are apart: a whole number of no unit in the last place, so that no rounding is the same at all.
const APART: f64 = 2.0 / 3.0;
/// Points of a line whose differences show rounding.
const CLOSE: usize = 24;
/// Distances of the points in units of the scale, as powers of two.
///
/// At the first the points are so far apart that single precision parts them, and so close that a smooth function has no fourth
/// difference. At the second rounding is the same, while a bend is smaller. At the last all points are the same in single precision.
const DISTANCES: [i32; 3] = [-20, -22, -40];
/// Least roundings at the second distance, in parts of those at the first: a kink has a fourth, a smooth function far less.
const AS_ROUGH: f64 = 1.0 / 3.0;
/// Roundings of an action or a length must be so far above those of the results, which else look like them where the effect is weak.
const ABOVE: f64 = 100.0;

/// Roundings of a step.
#[derive(Clone, Debug, Serialize)]
pub struct Rounding {
    /// That of the results, relative to their size; that of `f64` is 2·10⁻¹⁶.
    pub results: f64,
    /// What the step computes in single precision: `the step`, names of actions, `dt`.
    pub single_precision: Vec<String>,
}

/// A line of points along which one thing changes.
#[derive(Clone, Copy)]
enum Line {
    States,
    Action(usize),
    Length,
}

impl Rounding {
    /// `results` are those of many points.
    pub(crate) fn measure(
        prober: &mut Prober<'_>,
        results: &Matrix,
    ) -> Result<Self, BlackBoxError> {
        let subject = prober.subject;
        let mut found = Rounding { results: 0.0, single_precision: Vec::new() };
        let is_single = |x: &f64| f64::from(*x as f32).to_bits() == x.to_bits();
        let is_whole = results.entries().iter().all(is_single);
        let nothing = vec![0.0; subject.state.len()];
        let far = Line::States.results(prober, DISTANCES[0])?;
        let (rounding, is_coarse) = Line::States.is_single(prober, &far, &nothing)?;
        found.results = rounding;
        if is_whole || is_coarse {
            found.single_precision.push("the step".into());
            return Ok(found);
        }
        let noises = Line::States.noises(&far);
        let rounded = |i: usize| f64::EPSILON * far[(0, i)].abs().max(far[(CLOSE - 1, i)].abs());
        let floor: Vec<f64> =
            (0..noises.len()).map(|i| ABOVE * noises[i].max(rounded(i))).collect();
        for (j, input) in subject.inputs.iter().enumerate() {
            let along = Line::Action(j).results(prober, DISTANCES[0])?;
            if Line::Action(j).is_single(prober, &along, &floor)?.1 {
                found.single_precision.push(format!("`{}`", input.name));
            }
        }
        if !subject.has_fixed_dt {
            let along = Line::Length.results(prober, DISTANCES[0])?;
            if Line::Length.is_single(prober, &along, &floor)?.1 {
                found.single_precision.push("dt".into());
            }
        }
        Ok(found)
    }
}

impl Line {
    /// From the results at the first distance: the rounding along the line in units of its sizes, and whether it is that of single precision. Noise below `floor` is none.
    fn is_single(
        self,
        prober: &mut Prober<'_>,
        far: &Matrix,
        floor: &[f64],
    ) -> Result<(f64, bool), BlackBoxError> {
        let sizes = self.sizes(prober, far);
        let relative = |results: &Matrix| {
            let noises = self.noises(results);
            let known = (0..sizes.len()).filter(|i| sizes[*i] > 0.0 && noises[*i] > floor[*i]);
            known.map(|i| noises[i] / sizes[i]).fold(0.0, f64::max)
        };
        let rounding = relative(far);
        let is_single = SINGLE.contains(&rounding)
            && relative(&self.results(prober, DISTANCES[1])?) > rounding * AS_ROUGH
            && relative(&self.results(prober, DISTANCES[2])?) < SINGLE.start / 10.0;
        Ok((rounding, is_single))
    }

    fn results(self, prober: &mut Prober<'_>, exponent: i32) -> Result<Matrix, BlackBoxError> {
        let subject = prober.subject;
        // Off the point of the subject, where a function may have a kink.
        let shift = |k: usize| 0.013 + (k as f64 + 0.3) * APART * 2.0_f64.powi(exponent);
        let held = |values: &[f64]| Matrix::from_fn(CLOSE, values.len(), |_, j| values[j]);
        let (x, scale, u) = (&subject.state, &subject.state_scale, &subject.action);
        match self {
            Line::States => {
                let states = Matrix::from_fn(CLOSE, x.len(), |k, i| {
                    x[i] + scale[i] * (shift(k) + 0.013 * i as f64 / 7.0)
                });
                prober.step(&states, &held(u), subject.dt)
            }
            Line::Action(input) => {
                let actions = Matrix::from_fn(CLOSE, u.len(), |k, j| {
                    let part = if j == input { shift(k) } else { 0.0 };
                    u[j] + part * subject.action_scale[j]
                });
                prober.step(&held(x), &actions, subject.dt)
            }
            Line::Length => {
                let start = displaced(prober, 0.1);
                let mut rows = Matrix::zeros(CLOSE, x.len());
                for k in 0..CLOSE {
                    let next = prober.step_one(&start, u, subject.dt * (1.0 + shift(k)))?;
                    rows.row_mut(k).copy_from_slice(&next);
                }
                Ok(rows)
            }
        }
    }

    /// The sizes that roundings are relative to: those of the results, or those of the effects of an action or of the length.
    fn sizes(self, prober: &Prober<'_>, far: &Matrix) -> Vec<f64> {
        let subject = prober.subject;
        let span = (CLOSE - 1) as f64 * APART * 2.0_f64.powi(DISTANCES[0]);
        let effect =
            |i: usize, value: f64| value * (far[(CLOSE - 1, i)] - far[(0, i)]).abs() / span;
        let size = |i: usize| match self {
            Line::States => far[(0, i)].abs().max(0.01 * subject.state_scale[i]),
            Line::Action(j) => {
                let scale = subject.action_scale[j];
                effect(i, (subject.action[j] / scale + 0.013).abs())
            }
            Line::Length => effect(i, 1.013),
        };
        (0..far.columns()).map(size).collect()
    }

    /// The fourth differences of each state along the line, over the root of the sum of their squared coefficients: along states the
    /// largest, since rounding inside may show seldom; else one that is exceeded by few.
    fn noises(self, results: &Matrix) -> Vec<f64> {
        let fourth = |k: usize, i: usize| {
            [1.0, -4.0, 6.0, -4.0, 1.0]
                .iter()
                .zip(k..)
                .map(|(c, k)| c * results[(k, i)])
                .sum::<f64>()
        };
        let of_state = |i: usize| {
            let mut all: Vec<f64> = (0..CLOSE - 4).map(|k| fourth(k, i).abs()).collect();
            all.sort_by(f64::total_cmp);
            // A single jump or kink is in five of the differences.
            let typical = if matches!(self, Line::States) { all.len() - 1 } else { all.len() - 6 };
            all[typical] / 70.0_f64.sqrt()
        };
        (0..results.columns()).map(of_state).collect()
    }
}
