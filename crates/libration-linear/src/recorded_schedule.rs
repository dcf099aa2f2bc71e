//! Loops whose periods repeat a record.

use std::collections::HashMap;

use crate::{Matrix, Stage, log_spectral_radius, mean_square, solve_stein};

/// Steps are rounded to such a part of a period: those of a clock are not known better, and thousands of them are few then.
const PART: f64 = 1.0 / 16_384.0;

/// The periods of a record: what each may be, with probabilities.
pub struct RecordedSchedule {
    order: Vec<usize>,
    kinds: Vec<Vec<Stage>>,
    draws: bool,
}

/// Steps after which passes through a record are no longer repeated.
const MOST_STEPS: usize = 4_000_000;

impl RecordedSchedule {
    /// The schedule of periods of these lengths, relative to the mean, over and over. `stages` has the possible periods of a relative
    /// length, and `draws` says whether there are several. Lengths are rounded to 2⁻¹⁴.
    pub fn new(lengths: &[f64], draws: bool, stages: impl Fn(f64) -> Vec<Stage>) -> Self {
        Self::with_controllers(lengths, &[0], draws, |length, _| stages(length))
    }

    /// The same where a period also has a controller, whose numbers are those of `order`, over and over: of a length and a number
    /// `stages` has the possible periods. Lengths and controllers together repeat after the least common multiple of both.
    pub(crate) fn with_controllers(
        lengths: &[f64],
        order: &[usize],
        draws: bool,
        stages: impl Fn(f64, usize) -> Vec<Stage>,
    ) -> Self {
        let mut kinds = Vec::new();
        let mut known = HashMap::new();
        let kind = |(length, controller): (&f64, &usize)| {
            let parts = (length / PART).round();
            *known.entry((parts.to_bits(), *controller)).or_insert_with(|| {
                kinds.push(stages(parts * PART, *controller));
                kinds.len() - 1
            })
        };
        let passes = (1..=order.len()).find(|k| (k * lengths.len()).is_multiple_of(order.len()));
        let count = passes.unwrap_or(1) * lengths.len();
        let both = lengths.iter().cycle().zip(order.iter().cycle());
        let order = both.take(count).map(kind).collect();
        RecordedSchedule { order, kinds, draws }
    }

    fn steps(&self) -> impl Iterator<Item = &Vec<Stage>> {
        self.order.iter().map(|&kind| &self.kinds[kind])
    }

    /// The product of all steps, where nothing is drawn; else of what they make of second moments. It is divided by a factor whose
    /// logarithm comes with it.
    fn product(&self) -> (Matrix, f64) {
        let of = |stages: &Vec<Stage>| match self.draws {
            true => mean_square(stages),
            false => stages[0].step.clone(),
        };
        // Most entries are zero, of steps that hand commands on.
        let sparse = |matrix: Matrix| -> Vec<Vec<(usize, f64)>> {
            let entries = |i| matrix.row(i).iter().copied().enumerate();
            let row = |i| entries(i).filter(|(_, x)| *x != 0.0).collect();
            (0..matrix.rows()).map(row).collect()
        };
        let kinds: Vec<Vec<Vec<(usize, f64)>>> =
            self.kinds.iter().map(|stages| sparse(of(stages))).collect();
        let mut all = Matrix::identity(kinds[0].len());
        let mut next = all.clone();
        let mut logarithm = 0.0;
        for &kind in &self.order {
            for (i, entries) in kinds[kind].iter().enumerate() {
                let row = next.row_mut(i);
                row.fill(0.0);
                for (column, entry) in entries {
                    row.iter_mut().zip(all.row(*column)).for_each(|(x, y)| *x += entry * y);
                }
            }
            core::mem::swap(&mut all, &mut next);
            logarithm += normalise(&mut all);
        }
        (all, logarithm)
    }

    /// The mean growth rate of second moments per period, over all of them.
    ///
    /// Without losses it follows from the product of all periods, as G. Floquet has it for what is periodic (*Sur les équations
    /// différentielles linéaires à coefficients périodiques*, Annales scientifiques de l'École normale supérieure 12, 1883).
    pub fn growth(&self) -> f64 {
        let (product, logarithm) = self.product();
        let power = if self.draws { 1.0 } else { 2.0 };
        power * (log_spectral_radius(&product) + logarithm) / self.order.len() as f64
    }

    /// The mean stationary cost; infinite where second moments grow.
    pub fn cost(&self) -> f64 {
        let growth = self.growth();
        if growth.is_nan() || growth >= 0.0 {
            return f64::INFINITY;
        }
        let size = self.kinds[0][0].step.rows();
        let mut moments = Matrix::zeros(size, size);
        let pass = |moments: &mut Matrix| {
            let (mut cost, mut length) = (0.0, 0.0);
            for stages in self.steps() {
                for stage in stages {
                    cost += stage.weight * stage.expected(moments);
                    length += stage.weight * stage.length;
                }
                *moments = moved(stages, moments);
                for stage in stages {
                    moments.add_scaled(stage.weight, &stage.noise);
                }
            }
            cost / length
        };
        pass(&mut moments);
        if self.draws {
            let count = self.order.len();
            let lasts = (36.0 / (-growth * count as f64)).ceil();
            let passes = (lasts as usize).min(MOST_STEPS / count).max(1);
            for _ in 0..passes {
                pass(&mut moments);
            }
        } else {
            let (all, logarithm) = self.product();
            moments = solve_stein(&all.scaled(logarithm.exp()), vec![moments]).remove(0);
        }
        pass(&mut moments)
    }
}

/// Divides by the largest size of an entry, whose logarithm it returns.
fn normalise(matrix: &mut Matrix) -> f64 {
    let norm = matrix.largest();
    if norm == 0.0 {
        return f64::NEG_INFINITY;
    }
    matrix.normalise(norm);
    norm.ln()
}

/// `E[M P Mᵀ]`.
fn moved(stages: &[Stage], moments: &Matrix) -> Matrix {
    let mut sum = Matrix::zeros(moments.rows(), moments.rows());
    for stage in stages {
        sum.add_scaled(stage.weight, &stage.step.congruence(moments));
    }
    sum
}
