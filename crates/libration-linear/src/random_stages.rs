//! Second moments of a loop with random stages.

use crate::falling_root::falling_root;
use crate::krylov::{largest_eigenvalue, solve_fixed_point};
use crate::random_period::RandomPeriod;
use crate::random_schedule::RandomSchedule;
use crate::spread_map::SpreadMap;
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

/// Steps from the identity that give each number of `S` its scale.
const WARM_UP: usize = 6;

/// Part of the distance from 1 that the residual of an eigenvalue may have where only the side counts. The eigenvalue may be off by many
/// times the residual: the map is not symmetric.
const SIDE: f64 = 1e-6;

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
            falling_root(|lambda| self.returned(lambda), low, high)
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
            _ => self.spread_growth(&means, true) < 0.0,
        };
        is_schur_stable(&self.schedule.round(&means)) && drawn_decays()
    }

    /// Of all that is drawn: the logarithm of the factor with which it comes back, of moments that are divided by `e^λ` a step.
    fn returned(&self, lambda: f64) -> f64 {
        let means = self.schedule.means((-0.5 * lambda).exp());
        let grows = match self.is_written_out() {
            true => log_spectral_radius(&self.schedule.feedback(&means)),
            false => self.spread_growth(&means, false),
        };
        grows - lambda
    }

    /// The logarithm of the spectral radius of the map of `S`; if only its sign matters, with no more digits than that takes.
    fn spread_growth(&self, means: &[Matrix], sign_only: bool) -> f64 {
        let spreads: Vec<Matrix> =
            self.schedule.periods().map(|period| Matrix::identity(period.rows.len())).collect();
        let trace = |spreads: &[Matrix]| spreads.iter().map(Matrix::trace).sum::<f64>();
        let mut last = spreads;
        let mut logarithm = 0.0;
        for _ in 0..WARM_UP {
            let next = self.schedule.returned_spread(means, &last);
            let size = trace(&next);
            if !size.is_finite() {
                return f64::INFINITY;
            }
            if size == 0.0 {
                return f64::NEG_INFINITY;
            }
            logarithm += size.ln();
            // What comes of the identity is less than the identity: it decays, and so does all else.
            if sign_only && logarithm < 0.0 {
                return logarithm;
            }
            last = next.iter().map(|spread| spread.scaled(size.recip())).collect();
        }
        let map = SpreadMap::new(&self.schedule, means, &last);
        let settles =
            |value: f64, residual: f64| sign_only && residual <= SIDE * (value - 1.0).abs();
        largest_eigenvalue(|x| map.apply(x), &map.numbers(&last), settles).max(0.0).ln()
    }

    /// The stationary second moments under `noise`. They are meaningless for an unstable loop.
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
            let inflow: Vec<Matrix> =
                self.schedule.periods().zip(&moments).map(|(period, p)| period.spread(p)).collect();
            let map = SpreadMap::new(&self.schedule, &means, &inflow);
            let sums = map.spreads(&solve_fixed_point(|x| map.apply(x), &map.numbers(&inflow)));
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

    #[test]
    fn slow_motions_beside_slightly_slower_ones_decide_stability_and_moments() {
        // Eight motions, each times m(1 ± 1/8) in a period: their squares grow by m² (1 + 1/64).
        let factors = |slowest: f64| -> Vec<f64> {
            (0..8).map(|i| if i == 5 { slowest } else { 0.9995 - 1e-5 * f64::from(i) }).collect()
        };
        let stages = |slowest: f64| -> Vec<Stage> {
            let of = |sign: f64| {
                let m = |f: &f64| (f / (1.0 + 1.0 / 64.0)).sqrt() * (1.0 + sign / 8.0);
                let step = Matrix::diagonal(&factors(slowest).iter().map(m).collect::<Vec<_>>());
                let zero = Matrix::zeros(8, 8);
                Stage {
                    weight: 0.5,
                    step,
                    noise: zero.clone(),
                    cost: zero,
                    constant: 0.0,
                    length: 1.0,
                }
            };
            vec![of(1.0), of(-1.0)]
        };
        for (slowest, stable) in [(1.0 + 3e-5, false), (1.0 - 3e-5, true), (1.0 + 1e-9, false)] {
            let random = RandomStages::new(&stages(slowest));
            assert_eq!(random.is_stable(), stable, "{slowest}");
            let off = random.growth() - slowest.ln();
            assert!(off.abs() < 1e-13, "{slowest}: {off:e}");
        }
        // Noise of 1 for each: the sum of a geometric series. A rounding of the factor is divided by its distance from 1.
        let slowest = 1.0 - 1e-6;
        let moments = RandomStages::new(&stages(slowest)).moments(Matrix::identity(8));
        for (i, factor) in factors(slowest).into_iter().enumerate() {
            let wanted = 1.0 / (1.0 - factor);
            assert!(
                (moments[(i, i)] / wanted - 1.0).abs() < 1e-8,
                "{i}: {} {wanted}",
                moments[(i, i)]
            );
        }
    }
}
