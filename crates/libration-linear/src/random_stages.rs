//! Second moments of a loop with random stages.

use crate::random_period::RandomPeriod;
use crate::random_schedule::RandomSchedule;
use crate::{Matrix, Stage, is_schur_stable, log_spectral_radius, solve};

/// The steps of a loop, each drawn for itself: their mean, and in which few rows and how far each is off.
///
/// Second moments obey `P = M̄ P M̄ᵀ + E S Eᵀ + W` with the mean `M̄`, what noise adds, `W`, and the covariance `S = E[Δ P Δᵀ]` of what
/// the rows `Δ` that are drawn add: those of the plant and of the command that acts. `S` has a handful of numbers
/// however many commands wait, and what comes of it is again some `S`: second moments decay if those of `M̄` do and those numbers
/// become less (J. C. Willems and G. L. Blankenship, *Frequency domain stability criteria for stochastic systems*, IEEE
/// Transactions on Automatic Control 16, 1971).
///
/// Where periods follow a schedule, each has its own `M̄`, `Δ` and `S`, and `P` goes from period to period once round.
pub struct RandomStages {
    schedule: RandomSchedule,
}

/// Most rows that are drawn, up to which the map of the numbers of `S` is written out.
const WRITTEN_OUT: usize = 6;

/// Most numbers of `S` of a schedule, up to which their map is written out.
const NUMBERS: usize = 128;
/// Iterations in a row that must agree on a sign.
const IN_A_ROW: usize = 6;

/// Most iterations of that map, where it is not.
const ITERATIONS: usize = 2000;

impl RandomStages {
    /// The mean and deviations of all possible steps.
    pub fn new(stages: &[Stage]) -> Self {
        RandomStages::of_schedule(&[stages.to_vec()], &[0])
    }

    /// The same of periods of several kinds, which follow each other in this order over and over.
    pub fn of_schedule(kinds: &[Vec<Stage>], order: &[usize]) -> Self {
        let kinds = kinds.iter().map(|stages| RandomPeriod::new(stages)).collect();
        RandomStages { schedule: RandomSchedule { kinds, order: order.to_vec() } }
    }

    fn is_written_out(&self) -> bool {
        self.schedule.kinds.iter().all(|period| period.rows.len() <= WRITTEN_OUT)
            && self.schedule.numbers() <= NUMBERS
    }

    /// The logarithm of the factor by which second moments grow in a step; of a schedule the mean.
    pub fn growth(&self) -> f64 {
        let (all, logarithm) = self.schedule.product(&self.schedule.means(1.0));
        let least =
            2.0 * (log_spectral_radius(&all) + logarithm) / self.schedule.order.len() as f64;
        if self.schedule.numbers() == 0 || least.is_nan() {
            return least;
        }
        // Moments that grow by λ a step and are divided by that stay as they are: what is drawn comes back as itself.
        let mut high = (least.max(0.0) + 1.0, self.returned(least.max(0.0) + 1.0));
        while high.1 > 0.0 {
            high = (2.0 * high.0, self.returned(2.0 * high.0));
        }
        let above = least + 1e-13 * least.abs().max(1.0);
        let low = (above, self.returned(above));
        // Where the mean grows fastest, what is drawn adds nothing.
        if low.1 > 0.0 && low.0 < high.0 {
            root(|lambda| self.returned(lambda), low, high)
        } else {
            least
        }
    }

    /// Whether second moments decay.
    pub fn is_stable(&self) -> bool {
        let means = self.schedule.means(1.0);
        let drawn_decays = || match self.schedule.numbers() {
            0 => true,
            _ if self.is_written_out() => is_schur_stable(&self.schedule.feedback(&means)),
            _ => self.iterated(&means, true) < 0.0,
        };
        is_schur_stable(&self.schedule.round(&means)) && drawn_decays()
    }

    /// Of all that is drawn: the logarithm of the factor with which it comes back, of moments that are divided by `e^λ` a step.
    fn returned(&self, lambda: f64) -> f64 {
        let means = self.schedule.means((-0.5 * lambda).exp());
        let grows = match self.is_written_out() {
            true => log_spectral_radius(&self.schedule.feedback(&means)),
            false => self.iterated(&means, false),
        };
        grows - lambda
    }

    /// The logarithm of the spectral radius of the map of `S`, by iteration; if only its sign matters, ended where ten times the estimated
    /// rest does not change it, some times in a row: a sequence that swings is slow where it turns back.
    ///
    /// The map takes positive semidefinite matrices to such, so that its spectral radius is an eigenvalue (M. G. Krein, M. A. Rutman,
    /// American Mathematical Society Translations 26, 1950). The rest is that of a sequence that settles in equal ratios.
    fn iterated(&self, means: &[Matrix], sign_only: bool) -> f64 {
        let mut spreads: Vec<Matrix> =
            self.schedule.periods().map(|period| Matrix::identity(period.rows.len())).collect();
        let trace = |spreads: &[Matrix]| spreads.iter().map(Matrix::trace).sum::<f64>();
        let (mut ratio, mut change) = (f64::NAN, f64::INFINITY);
        let mut decided = 0;
        for _ in 0..ITERATIONS {
            let next = self.schedule.returned_spread(means, &spreads);
            let size = trace(&next);
            let grown = size / trace(&spreads);
            if !grown.is_finite() {
                return f64::INFINITY;
            }
            if grown == 0.0 {
                return f64::NEG_INFINITY;
            }
            let moved = (grown - ratio).abs();
            let pace = (moved / change).clamp(0.0, 0.999);
            let rest = moved * pace / (1.0 - pace);
            (ratio, change) = (grown, moved);
            spreads = next.iter().map(|spread| spread.scaled(size.recip())).collect();
            let settled = moved <= 1e-14 * grown || rest <= 1e-13 * grown;
            decided = if 10.0 * rest < (grown - 1.0).abs() { decided + 1 } else { 0 };
            if settled || sign_only && decided >= IN_A_ROW {
                break;
            }
        }
        ratio.ln()
    }

    /// The stationary second moments under `noise`. They are meaningless for an unstable loop, and too small for one with many rows that
    /// are drawn and that needs more than 2000 periods to forget.
    pub fn moments(&self, noise: Matrix) -> Matrix {
        self.moments_by_period(&[noise]).remove(0)
    }

    /// The same at the beginning of each period of a schedule, whose kinds of periods have these noises.
    pub fn moments_by_period(&self, noises: &[Matrix]) -> Vec<Matrix> {
        let means = self.schedule.means(1.0);
        let inflow = self.schedule.order.iter().map(|&kind| Some(noises[kind].clone())).collect();
        let mut moments = self.schedule.carried(&means, &[inflow]).remove(0);
        if self.schedule.numbers() == 0 {
            return moments;
        }
        // S = S₀ + T S.
        if !self.is_written_out() {
            let spreads = self.schedule.periods().zip(&moments).map(|(period, p)| period.spread(p));
            let mut sums: Vec<Matrix> = spreads.collect();
            let mut more = sums.clone();
            let largest = |all: &[Matrix]| all.iter().map(Matrix::largest).fold(0.0, f64::max);
            for _ in 0..ITERATIONS {
                more = self.schedule.returned_spread(&means, &more);
                add(&mut sums, 1.0, &more);
                if largest(&more) <= 1e-15 * largest(&sums) {
                    break;
                }
            }
            let inflow =
                self.schedule.periods().zip(&sums).map(|(period, s)| Some(period.placed(s)));
            add(&mut moments, 1.0, &self.schedule.carried(&means, &[inflow.collect()])[0]);
            return moments;
        }
        let known = self.schedule.seen(&moments);
        let feedback = self.schedule.feedback(&means);
        let equation = |(i, known): (usize, f64)| -> Vec<f64> {
            let mut row: Vec<f64> = feedback.row(i).iter().map(|x| -x).collect();
            row[i] += 1.0;
            row.push(known);
            row
        };
        let equations = known.into_iter().enumerate().map(equation).collect();
        for (part, size) in self.schedule.added(&means).iter().zip(solve(equations, f64::abs)) {
            add(&mut moments, size, part);
        }
        moments
    }
}

fn add(sums: &mut [Matrix], factor: f64, more: &[Matrix]) {
    sums.iter_mut().zip(more).for_each(|(sum, more)| sum.add_scaled(factor, more));
}

/// Where a falling function passes zero, between a point where it is above and one where it is below: by secants, each end's value
/// halved where the other moved twice (M. Dowell and P. Jarratt, *A modified regula falsi method*, BIT 11, 1971), and by halving
/// where they are slow.
fn root(f: impl Fn(f64) -> f64, mut low: (f64, f64), mut high: (f64, f64)) -> f64 {
    let mut rose = None;
    for i in 0..100 {
        if high.0 - low.0 <= 1e-15 * high.0.abs().max(low.0.abs()).max(1e-3) {
            break;
        }
        let secant = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
        let inside = low.0 < secant && secant < high.0;
        let at = if inside && i % 4 != 3 { secant } else { 0.5 * (low.0 + high.0) };
        let value = f(at);
        let rises = value > 0.0;
        let again = rose == Some(rises);
        match rises {
            true => (low, high.1) = ((at, value), if again { 0.5 * high.1 } else { high.1 }),
            false => (high, low.1) = ((at, value), if again { 0.5 * low.1 } else { low.1 }),
        }
        rose = Some(rises);
    }
    high.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mean_square;

    /// Steps of `n` coordinates, all of which are drawn. Those of another kind do not commute with them.
    fn stages(n: usize, size: f64, kind: usize) -> Vec<Stage> {
        let noise = Matrix::zeros(n, n);
        let at = |k: usize| {
            let epsilon = 0.3 * (k as f64 - 2.0);
            let step = Matrix::from_fn(n, n, |i, j| {
                let place = ((3 * i + (5 + kind) * j + kind) % 11) as f64 - 5.0;
                let own = if i == j { size } else { 0.0 };
                own + 0.04 * place + 0.05 * epsilon * ((i + 2 * j) as f64).cos()
            });
            let (noise, cost) = (noise.clone(), noise.clone());
            Stage { weight: 0.2, step, noise, cost, constant: 0.0, length: 1.0 }
        };
        (0..5).map(at).collect()
    }

    #[test]
    fn where_many_rows_are_drawn_growth_and_moments_are_those_of_the_whole_operator() {
        for (n, size, stable) in [(8, 0.5, true), (8, 0.9, false), (12, 0.4, true)] {
            let stages = stages(n, size, 0);
            let random = RandomStages::new(&stages);
            assert!(random.schedule.kinds[0].rows.len() == n && n > WRITTEN_OUT);
            let wanted = log_spectral_radius(&mean_square(&stages));
            let found = random.growth();
            assert!((found - wanted).abs() < 1e-10, "{n} {size}: {found} {wanted}");
            assert_eq!((random.is_stable(), wanted < 0.0), (stable, stable), "{n} {size}");
            if stable {
                let noise = Matrix::identity(n);
                let moments = random.moments(noise.clone());
                let mut right = noise;
                for stage in &stages {
                    right.add_scaled(stage.weight, &stage.step.congruence(&moments));
                }
                right.add_scaled(-1.0, &moments);
                assert!(right.largest() < 1e-12 * moments.largest(), "{n}: {}", right.largest());
            }
        }
    }

    #[test]
    fn growth_and_moments_of_a_schedule_are_those_of_the_product_of_its_operators() {
        // Three rows that are drawn are written out; of eight the map is iterated.
        for (n, sizes, stable) in
            [(3, [0.4, 0.9, 0.6], true), (3, [1.1, 1.0, 1.3], false), (8, [0.3, 0.8, 0.2], true)]
        {
            let kinds: Vec<Vec<Stage>> = (0..3).map(|kind| stages(n, sizes[kind], kind)).collect();
            let order = [0, 1, 1, 2];
            let random = RandomStages::of_schedule(&kinds, &order);
            assert_eq!(random.is_written_out(), n == 3);
            let all = order.iter().fold(Matrix::identity(n * (n + 1) / 2), |all, &kind| {
                &mean_square(&kinds[kind]) * &all
            });
            let wanted = log_spectral_radius(&all) / order.len() as f64;
            let found = random.growth();
            assert!((found - wanted).abs() < 1e-10, "{n}: {found} {wanted}");
            assert_eq!((random.is_stable(), wanted < 0.0), (stable, stable), "{n}");
            if !stable {
                continue;
            }
            let noises: Vec<Matrix> =
                (1..=3).map(|k| Matrix::identity(n).scaled(f64::from(k))).collect();
            let moments = random.moments_by_period(&noises);
            assert_eq!(moments.len(), order.len());
            for (k, &kind) in order.iter().enumerate() {
                let mut next = noises[kind].clone();
                for stage in &kinds[kind] {
                    next.add_scaled(stage.weight, &stage.step.congruence(&moments[k]));
                }
                next.add_scaled(-1.0, &moments[(k + 1) % order.len()]);
                assert!(next.largest() < 1e-12 * moments[k].largest(), "{n} {k}");
            }
        }
    }
}
