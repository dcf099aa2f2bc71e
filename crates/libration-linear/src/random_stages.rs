//! Second moments of a loop with random stages.

use crate::deviations::Deviations;
use crate::{Matrix, Stage, is_schur_stable, log_spectral_radius, solve, solve_stein};

/// The steps of a loop, each drawn for itself: their mean, and in which few rows and how far each is off.
///
/// Second moments obey `P = M̄ P M̄ᵀ + E S Eᵀ + W` with the mean `M̄`, what noise adds, `W`, and the covariance `S = E[Δ P Δᵀ]` of what
/// the rows `Δ` that are drawn add: those of the plant and of the command that acts. `S` has a handful of numbers
/// however many commands wait, and what comes of it is again some `S`: second moments decay if those of `M̄` do and those numbers
/// become less (J. C. Willems and G. L. Blankenship, *Frequency domain stability criteria for stochastic systems*, IEEE
/// Transactions on Automatic Control 16, 1971).
pub struct RandomStages {
    mean: Matrix,
    /// Rows in which steps differ.
    rows: Vec<usize>,
    /// The deviations of these rows from the mean.
    off: Deviations,
}

/// Most rows that are drawn, up to which the map of the numbers of `S` is written out.
const WRITTEN_OUT: usize = 6;

/// Most iterations of that map, where it is not.
const ITERATIONS: usize = 2000;

impl RandomStages {
    /// The mean and deviations of all possible steps.
    pub fn new(stages: &[Stage]) -> Self {
        // What all have in common, and to that the mean of what they have not: rows that do not differ are kept bit for bit.
        let mut mean = stages.first().map_or(Matrix::zeros(0, 0), |stage| stage.step.clone());
        let differs = |i: &usize| stages.iter().any(|stage| stage.step.row(*i) != mean.row(*i));
        let rows: Vec<usize> = (0..mean.rows()).filter(differs).collect();
        for &i in &rows {
            for (j, x) in mean.row_mut(i).iter_mut().enumerate() {
                *x = stages.iter().map(|stage| stage.weight * stage.step[(i, j)]).sum();
            }
        }
        let of = |stage: &Stage| {
            Matrix::from_fn(rows.len(), mean.columns(), |k, j| {
                stage.step[(rows[k], j)] - mean[(rows[k], j)]
            })
        };
        let off: Vec<(f64, Matrix)> =
            stages.iter().map(|stage| (stage.weight, of(stage))).collect();
        RandomStages { mean, rows, off: Deviations::new(&off) }
    }

    /// The logarithm of the factor by which second moments grow in a step.
    pub fn growth(&self) -> f64 {
        let least = 2.0 * log_spectral_radius(&self.mean);
        if self.rows.is_empty() || least.is_nan() {
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
        let drawn_decays = || match self.rows.len() {
            0 => true,
            1..=WRITTEN_OUT => is_schur_stable(&self.feedback(&self.mean)),
            _ => self.iterated(&self.mean, true) < 0.0,
        };
        is_schur_stable(&self.mean) && drawn_decays()
    }

    /// Of all that is drawn: the logarithm of the factor with which it comes back, of moments that are divided by `e^λ` a step.
    fn returned(&self, lambda: f64) -> f64 {
        let mean = self.mean.scaled((-0.5 * lambda).exp());
        let grows = match self.rows.len() <= WRITTEN_OUT {
            true => log_spectral_radius(&self.feedback(&mean)),
            false => self.iterated(&mean, false),
        };
        grows - lambda
    }

    /// What the covariance `S` of what is drawn comes back as.
    fn returned_spread(&self, mean: &Matrix, spread: &Matrix) -> Matrix {
        self.off.spread(&solve_stein(mean, vec![self.placed(spread)]).remove(0))
    }

    /// `E S Eᵀ`: the numbers of `S` in the rows that are drawn.
    fn placed(&self, spread: &Matrix) -> Matrix {
        let n = self.mean.rows();
        let mut placed = Matrix::zeros(n, n);
        for (a, &i) in self.rows.iter().enumerate() {
            for (b, &j) in self.rows.iter().enumerate() {
                placed[(i, j)] = spread[(a, b)];
            }
        }
        placed
    }

    /// The logarithm of the spectral radius of the map of `S`, by iteration; if only its sign matters, ended where ten times the estimated
    /// rest does not change it.
    ///
    /// The map takes positive semidefinite matrices to such, so that its spectral radius is an eigenvalue (M. G. Krein, M. A. Rutman,
    /// American Mathematical Society Translations 26, 1950). The rest is that of a sequence that settles in equal ratios.
    fn iterated(&self, mean: &Matrix, sign_only: bool) -> f64 {
        let mut spread = Matrix::identity(self.rows.len());
        let (mut ratio, mut change) = (f64::NAN, f64::INFINITY);
        for _ in 0..ITERATIONS {
            let next = self.returned_spread(mean, &spread);
            let grown = next.trace() / spread.trace();
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
            spread = next.scaled(next.trace().recip());
            let settled = moved <= 1e-14 * grown || rest <= 1e-13 * grown;
            if settled || sign_only && 10.0 * rest < (grown - 1.0).abs() {
                break;
            }
        }
        ratio.ln()
    }

    /// The stationary second moments under `noise`. They are meaningless for an unstable loop, and too small for one with many rows that
    /// are drawn and that needs more than 2000 periods to forget.
    pub fn moments(&self, noise: Matrix) -> Matrix {
        let mut moments = solve_stein(&self.mean, vec![noise]).remove(0);
        if self.rows.is_empty() {
            return moments;
        }
        // S = S₀ + T S.
        if self.rows.len() > WRITTEN_OUT {
            let mut sum = self.off.spread(&moments);
            let mut more = sum.clone();
            for _ in 0..ITERATIONS {
                more = self.returned_spread(&self.mean, &more);
                sum.add_scaled(1.0, &more);
                if more.largest() <= 1e-15 * sum.largest() {
                    break;
                }
            }
            moments.add_scaled(1.0, &solve_stein(&self.mean, vec![self.placed(&sum)])[0]);
            return moments;
        }
        let known = self.seen(&moments);
        let feedback = self.feedback(&self.mean);
        let equation = |(i, known): (usize, f64)| -> Vec<f64> {
            let mut row: Vec<f64> = feedback.row(i).iter().map(|x| -x).collect();
            row[i] += 1.0;
            row.push(known);
            row
        };
        let equations = known.into_iter().enumerate().map(equation).collect();
        for (part, size) in self.added(&self.mean).iter().zip(solve(equations, f64::abs)) {
            moments.add_scaled(size, part);
        }
        moments
    }

    /// Pairs of rows that are drawn.
    fn pairs(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let count = self.rows.len();
        (0..count).flat_map(move |a| (a..count).map(move |b| (a, b)))
    }

    /// The second moments of a unit of each number of `S`.
    fn added(&self, mean: &Matrix) -> Vec<Matrix> {
        let n = mean.rows();
        let unit = |(a, b): (usize, usize)| {
            let (i, j) = (self.rows[a], self.rows[b]);
            let mut unit = Matrix::zeros(n, n);
            (unit[(i, j)], unit[(j, i)]) = (1.0, 1.0);
            unit
        };
        solve_stein(mean, self.pairs().map(unit).collect())
    }

    /// The map of the numbers of `S`, row by row.
    fn feedback(&self, mean: &Matrix) -> Matrix {
        let columns: Vec<Vec<f64>> = self.added(mean).iter().map(|p| self.seen(p)).collect();
        Matrix::from_fn(columns.len(), columns.len(), |i, j| columns[j][i])
    }

    /// `E[Δ P Δᵀ]`, pair by pair.
    fn seen(&self, moments: &Matrix) -> Vec<f64> {
        let spread = self.off.spread(moments);
        self.pairs().map(|pair| spread[pair]).collect()
    }
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

    /// Steps of `n` coordinates, all of which are drawn.
    fn stages(n: usize, size: f64) -> Vec<Stage> {
        let noise = Matrix::zeros(n, n);
        let at = |k: usize| {
            let epsilon = 0.3 * (k as f64 - 2.0);
            let step = Matrix::from_fn(n, n, |i, j| {
                let place = ((3 * i + 5 * j) % 11) as f64 - 5.0;
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
            let stages = stages(n, size);
            let random = RandomStages::new(&stages);
            assert!(random.rows.len() == n && n > WRITTEN_OUT);
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
}
