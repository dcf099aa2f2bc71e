//! Second moments of a loop with random stages.

use super::dense_matrix::{
    Matrix, is_schur_stable, log_spectral_radius, product, scale, transpose,
};
use super::linear::solved;
use super::stage::Stage;

/// The steps of a loop, each drawn for itself: their mean, and in which few rows and how far each is off.
///
/// Second moments obey `P = M̄ P M̄ᵀ + E S Eᵀ + W` with the mean `M̄`, what noise adds, `W`, and the covariance `S = E[Δ P Δᵀ]` of what
/// the rows `Δ` that are drawn add: those of the position, the velocity and the command that acts. `S` has a handful of numbers
/// however many commands wait, and what comes of it is again some `S`: second moments decay if those of `M̄` do and those numbers
/// become less (J. C. Willems and G. L. Blankenship, *Frequency domain stability criteria for stochastic systems*, IEEE
/// Transactions on Automatic Control 16, 1971).
pub(super) struct RandomStages {
    mean: Matrix,
    /// Rows in which steps differ.
    rows: Vec<usize>,
    /// The deviations of these rows from the mean, with probabilities.
    off: Vec<(f64, Matrix)>,
}

impl RandomStages {
    /// The mean and deviations of all possible steps.
    pub(super) fn new(stages: &[Stage]) -> Self {
        let n = stages.first().map_or(0, |stage| stage.step.len());
        // What all have in common, and to that the mean of what they have not: rows that do not differ are kept bit for bit.
        let mut mean = stages.first().map_or_else(Vec::new, |stage| stage.step.clone());
        let differs = |i: &usize| stages.iter().any(|stage| stage.step[*i] != mean[*i]);
        let rows: Vec<usize> = (0..n).filter(differs).collect();
        for &i in &rows {
            for (j, x) in mean[i].iter_mut().enumerate() {
                *x = stages.iter().map(|stage| stage.weight * stage.step[i][j]).sum();
            }
        }
        let of = |stage: &Stage| -> Matrix {
            let row = |&i: &usize| stage.step[i].iter().zip(&mean[i]).map(|(x, y)| x - y).collect();
            rows.iter().map(row).collect()
        };
        let off = stages.iter().map(|stage| (stage.weight, of(stage))).collect();
        RandomStages { mean, rows, off }
    }

    /// The logarithm of the factor by which second moments grow in a step.
    pub(super) fn growth(&self) -> f64 {
        let least = 2.0 * log_spectral_radius(self.mean.clone());
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
    pub(super) fn is_stable(&self) -> bool {
        is_schur_stable(&self.mean)
            && (self.rows.is_empty() || is_schur_stable(&self.feedback(&self.mean)))
    }

    /// Of all that is drawn: the logarithm of the factor with which it comes back, of moments that are divided by `e^λ` a step.
    fn returned(&self, lambda: f64) -> f64 {
        let factor = (-0.5 * lambda).exp();
        let mean = self.mean.iter().map(|row| row.iter().map(|x| factor * x).collect()).collect();
        log_spectral_radius(self.feedback(&mean)) - lambda
    }

    /// The stationary second moments under `noise`. They are meaningless for an unstable loop.
    pub(super) fn moments(&self, noise: Matrix) -> Matrix {
        let mut moments = solve_stein(&self.mean, vec![noise]).remove(0);
        if self.rows.is_empty() {
            return moments;
        }
        // S = S₀ + T S.
        let known = self.seen(&moments);
        let mut equations = self.feedback(&self.mean);
        for (i, (row, known)) in equations.iter_mut().zip(known).enumerate() {
            row.iter_mut().for_each(|x| *x = -*x);
            row[i] += 1.0;
            row.push(known);
        }
        for (part, size) in self.added(&self.mean).iter().zip(solved(equations, f64::abs)) {
            for (row, part) in moments.iter_mut().zip(part) {
                row.iter_mut().zip(part).for_each(|(x, part)| *x += size * part);
            }
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
        let n = mean.len();
        let unit = |(a, b): (usize, usize)| {
            let (i, j) = (self.rows[a], self.rows[b]);
            let mut unit = vec![vec![0.0; n]; n];
            (unit[i][j], unit[j][i]) = (1.0, 1.0);
            unit
        };
        solve_stein(mean, self.pairs().map(unit).collect())
    }

    /// The map of the numbers of `S`, row by row.
    fn feedback(&self, mean: &Matrix) -> Matrix {
        let columns: Vec<Vec<f64>> = self.added(mean).iter().map(|p| self.seen(p)).collect();
        transpose(&columns)
    }

    /// `E[Δ P Δᵀ]`, pair by pair.
    fn seen(&self, moments: &Matrix) -> Vec<f64> {
        let mut sums = vec![0.0; self.pairs().count()];
        for (weight, off) in &self.off {
            let moved = product(off, moments);
            for (sum, (a, b)) in sums.iter_mut().zip(self.pairs()) {
                *sum += weight * moved[a].iter().zip(&off[b]).map(|(x, y)| x * y).sum::<f64>();
            }
        }
        sums
    }
}

/// `P = M P Mᵀ + W` for each `W`, as the sum of all that ever came in, doubled again and again (R. A. Smith, *Matrix equation XA + BX
/// = C*, SIAM Journal on Applied Mathematics 16, 1968).
pub(super) fn solve_stein(step: &Matrix, mut sums: Vec<Matrix>) -> Vec<Matrix> {
    let mut power = step.clone();
    // A loop whose moments fall by 10⁻¹⁵ a step has forgotten after 2⁵⁶.
    for _ in 0..56 {
        let back = transpose(&power);
        for sum in &mut sums {
            let more = product(&product(&power, sum), &back);
            for (row, more) in sum.iter_mut().zip(more) {
                row.iter_mut().zip(more).for_each(|(x, more)| *x += more);
            }
        }
        power = product(&power, &power);
        scale(&mut power, 1.0);
        let n = power.len() as f64;
        let most = power.iter().flatten().fold(0.0, |most: f64, x| most.max(x.abs()));
        // What would still be added is less than a rounding of the whole.
        if n * most < 1e-20 {
            break;
        }
    }
    sums
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
    use libration_core::control::{Feedback, Jitter, Latency, LqrWeights};
    use libration_core::system::Oscillator;

    use super::super::sample::textbook;
    use super::super::stage::mean_square;
    use super::super::{Imperfections, LinearController, Plant};
    use super::*;

    const MODEL: Oscillator<f64> = Oscillator { omega2: 10.0 };
    const GAINS: Feedback = Feedback { position: 4.0, velocity: 1.0 };

    fn stages(plant: &Plant<'_>, imperfections: &Imperfections) -> Vec<Stage> {
        let weights = LqrWeights { position: 5.0, velocity: 0.5, command: 0.1 };
        plant.stages(&LinearController::from(GAINS), imperfections, Some(weights)).unwrap()
    }

    #[test]
    fn growth_and_moments_are_those_of_the_whole_operator() {
        for (name, plant) in textbook(MODEL, 0.1) {
            for steps in [0.0, 0.3, 1.0, 2.6, 4.0] {
                for (jitter, loss) in [
                    (Jitter::Gaussian(0.0), 0.2),
                    (Jitter::Uniform(0.3), 0.0),
                    (Jitter::Gaussian(0.2), 0.1),
                    (Jitter::Gaussian(0.8), 0.6),
                ] {
                    let latency = Latency::of_steps(steps).unwrap();
                    let stages =
                        stages(&plant, &Imperfections { latency, jitter, skew: 0.1, loss });
                    let drawn = RandomStages::new(&stages);
                    let wanted = log_spectral_radius(mean_square(&stages));
                    let found = drawn.growth();
                    // Both are right to some 13 digits, where no eigenvalues meet.
                    let what = format!("{name} {steps} {jitter:?} {loss}: {found} {wanted}");
                    assert!((found - wanted).abs() < 1e-11, "{what}");
                    assert_eq!(drawn.is_stable(), wanted < 0.0, "{what}");
                    if wanted >= 0.0 {
                        continue;
                    }
                    // P = E[M P Mᵀ] + W, put in.
                    let n = stages[0].step.len();
                    let mut noise = vec![vec![0.0; n]; n];
                    (noise[0][0], noise[1][1], noise[0][1], noise[1][0]) = (0.3, 1.0, 0.1, 0.1);
                    let moments = drawn.moments(noise.clone());
                    let mut again = noise;
                    for stage in &stages {
                        let moved =
                            product(&product(&stage.step, &moments), &transpose(&stage.step));
                        for (row, moved) in again.iter_mut().zip(moved) {
                            row.iter_mut().zip(moved).for_each(|(x, y)| *x += stage.weight * y);
                        }
                    }
                    let size = moments.iter().flatten().fold(0.0, |most: f64, x| most.max(x.abs()));
                    for (found, again) in moments.iter().flatten().zip(again.iter().flatten()) {
                        assert!((found - again).abs() < 1e-12 * size, "{what}: {found} {again}");
                    }
                }
            }
        }
    }

    #[test]
    fn without_latency_growth_is_that_of_exact_moments() {
        for (name, plant) in textbook(MODEL, 0.1) {
            for law in [Jitter::Gaussian(0.1), Jitter::Uniform(0.3), Jitter::Gaussian(0.5)] {
                let exact = plant.mean_square(GAINS, law).radius.to_f64().ln();
                let drawn = Imperfections { jitter: law, ..Imperfections::NONE };
                let found = plant.mean_square_growth(&GAINS.into(), &drawn).unwrap();
                assert!((found - exact).abs() < 1e-13, "{name} {law:?}: {found} {exact}");
            }
        }
    }

    #[test]
    fn without_anything_drawn_it_is_twice_the_growth_of_the_loop() {
        for (name, plant) in textbook(MODEL, 0.1) {
            for steps in [1.0, 2.5, 3.0] {
                let latency = Latency::of_steps(steps).unwrap();
                let exact = 2.0 * plant.spectral_radius(GAINS, latency).to_f64().ln();
                for law in [Jitter::Uniform(0.0), Jitter::Uniform(1e-12)] {
                    let late = Imperfections { latency, jitter: law, ..Imperfections::NONE };
                    let found = plant.mean_square_growth(&GAINS.into(), &late).unwrap();
                    assert!((found - exact).abs() < 1e-12, "{name} {steps}: {found} {exact}");
                }
            }
        }
    }

    #[test]
    fn a_queue_of_sixty_commands_turns_damping_into_its_opposite() {
        let plant = Plant::exact(MODEL, super::super::sample::ORIGIN, 0.01);
        let latency = Latency::of_steps(60.5).unwrap();
        let late = Imperfections { latency, jitter: Jitter::Gaussian(0.1), skew: 0.0, loss: 0.05 };
        // The spring turns by √10·0.61 = 1.9 rad meanwhile, more than a quarter of a turn.
        for (velocity, stable) in [(0.1, false), (-0.1, true)] {
            let gains = Feedback { position: 0.0, velocity };
            assert_eq!(plant.mean_square_stable(&gains.into(), &late), Ok(stable));
        }
    }
}
