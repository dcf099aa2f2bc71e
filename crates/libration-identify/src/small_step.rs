//! Exact steps of plants with few states, without matrices on the heap: stamps that are not regular need one for each response.

use crate::plant_step::PlantStep;
use crate::response::UnitPlant;

/// A step is halved until its norm is below this.
const SMALL: f64 = 1.0 / 16.0;
/// Terms of the series: of `8⁻ᵏ/k!` the next is below 10⁻¹⁹.
const TERMS: usize = 11;

type Square<const N: usize> = [[f64; N]; N];
type Vector<const N: usize> = [f64; N];

/// The step of `h` seconds of a plant with `N` states, by series and doubling (C. Moler and C. F. Van Loan, SIAM Review 45, 2003, method 3).
pub(crate) fn small_step<const N: usize>(plant: &UnitPlant, h: f64, with_noise: bool) -> PlantStep {
    let a: Square<N> = std::array::from_fn(|i| std::array::from_fn(|j| plant.a[(i, j)]));
    let b: Vector<N> = std::array::from_fn(|i| plant.b[i]);
    let norm = a.iter().map(|row| row.iter().map(|x| x.abs()).sum::<f64>()).fold(0.0, f64::max);
    // A norm without bound gives steps without bound, as any method would.
    let doublings = (norm * h / SMALL).log2().ceil().clamp(0.0, 1000.0) as i32;
    let mut h = h / 2.0_f64.powi(doublings);
    let mut step = series(&a, &b, h, with_noise);
    for _ in 0..doublings {
        step.double(h);
        h *= 2.0;
    }
    (0..N).for_each(|i| step.grown[i][i] += 1.0);
    PlantStep {
        phi: step.grown.concat(),
        gamma: step.gamma.to_vec(),
        slope: step.slope.to_vec(),
        noise: step.noise.concat(),
    }
}

struct Step<const N: usize> {
    /// `Φ − 1`: in the square of `Φ` a slow mode of a stiff plant would lose the digits of its small rate beside 1.
    grown: Square<N>,
    gamma: Vector<N>,
    slope: Vector<N>,
    noise: Square<N>,
}

impl<const N: usize> Step<N> {
    /// The step of twice the length `h`.
    #[allow(clippy::needless_range_loop, reason = "an index of rows and of columns")]
    fn double(&mut self, h: f64) {
        let moved = times(&self.grown, &self.slope);
        // A command that rises has risen to `h` when the second half begins.
        self.slope = std::array::from_fn(|i| moved[i] + h * self.gamma[i] + 2.0 * self.slope[i]);
        let moved = times(&self.grown, &self.gamma);
        self.gamma = std::array::from_fn(|i| moved[i] + 2.0 * self.gamma[i]);
        // `Q + ΦQΦᵀ = 2Q + EQ + (EQ)ᵀ + EQEᵀ`.
        let half = product(&self.grown, &self.noise);
        for i in 0..N {
            for j in 0..N {
                let full: f64 = (0..N).map(|k| half[i][k] * self.grown[j][k]).sum();
                self.noise[i][j] += self.noise[i][j] + half[i][j] + half[j][i] + full;
            }
        }
        let square = product(&self.grown, &self.grown);
        for (grown, square) in self.grown.iter_mut().flatten().zip(square.iter().flatten()) {
            *grown = 2.0 * *grown + square;
        }
    }
}

/// `Σ Aᵏhᵏ/k!`, its integrals, and `Σ Dᵏ(bbᵀ) hᵏ⁺¹/(k+1)!` with `D(Q) = AQ + QAᵀ`.
fn series<const N: usize>(a: &Square<N>, b: &Vector<N>, h: f64, with_noise: bool) -> Step<N> {
    let mut power: Square<N> = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(i == j)));
    let mut vector = *b;
    let (mut grown, mut noise) = ([[0.0; N]; N], [[0.0; N]; N]);
    let (mut gamma, mut slope) = ([0.0; N], [0.0; N]);
    let mut spread: Square<N> = std::array::from_fn(|i| std::array::from_fn(|j| b[i] * b[j]));
    for k in 1..=TERMS {
        let (own, next) = (h / k as f64, h / (k + 1) as f64);
        power = product(a, &power);
        power.iter_mut().flatten().for_each(|x| *x *= own);
        vector.iter_mut().for_each(|x| *x *= own);
        for i in 0..N {
            gamma[i] += vector[i];
            slope[i] += next * vector[i];
            (0..N).for_each(|j| grown[i][j] += power[i][j]);
        }
        vector = times(a, &vector);
        if with_noise {
            spread.iter_mut().flatten().for_each(|x| *x *= own);
            for (sum, x) in noise.iter_mut().flatten().zip(spread.iter().flatten()) {
                *sum += x;
            }
            let half = product(a, &spread);
            spread = std::array::from_fn(|i| std::array::from_fn(|j| half[i][j] + half[j][i]));
        }
    }
    Step { grown, gamma, slope, noise }
}

fn product<const N: usize>(x: &Square<N>, y: &Square<N>) -> Square<N> {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..N).map(|k| x[i][k] * y[k][j]).sum()))
}

fn times<const N: usize>(x: &Square<N>, y: &Vector<N>) -> Vector<N> {
    std::array::from_fn(|i| (0..N).map(|k| x[i][k] * y[k]).sum())
}
