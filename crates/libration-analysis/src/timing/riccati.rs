//! The discrete Riccati equation.

use libration_core::number::Wide;
use libration_core::{Elementary, Scalar, State};

use crate::UpdateMatrix;
use crate::spectrum::negligible;

/// Doublings of the horizon: enough for a loop whose deviations fall by 10⁻¹⁵ a step.
pub(super) const DOUBLINGS: usize = 64;

pub(super) type Matrix = UpdateMatrix<Wide>;

/// The solution of `X = Q + ΦᵀXΦ − ΦᵀXΓ(r + ΓᵀXΓ)⁻¹ΓᵀXΦ` that is approached from a finite horizon, if the iteration
/// settles.
///
/// By doubling, which converges quadratically (E. K.-W. Chu, H.-Y. Fan, W.-W. Lin, C.-S. Wang, *Structure-preserving
/// algorithms for periodic discrete-time algebraic Riccati equations*, International Journal of Control 77, 2004).
pub(super) fn riccati(phi: Matrix, gamma: State<Wide, 1>, q: Matrix, r: Wide) -> Option<Matrix> {
    let one = Wide::one();
    let share = r.recip();
    let mut a = phi;
    let mut g = Matrix::from_map(|e| State::origin().plus(dot(&gamma, &e) * share, gamma));
    let mut h = q;
    for _ in 0..DOUBLINGS {
        let inverse = Matrix::identity().plus(one, &g.after(&h)).inverse();
        let (moved, back) = (inverse.after(&a), a.transposed());
        let more = back.after(&h).after(&moved);
        g = g.plus(one, &a.after(&inverse).after(&g).after(&back));
        h = h.plus(one, &more);
        a = a.after(&moved);
        if negligible(size(&more), size(&h)) {
            return (!size(&h).is_nan()).then_some(h);
        }
    }
    None
}

pub(super) fn dot(a: &State<Wide, 1>, b: &State<Wide, 1>) -> Wide {
    a.q[0] * b.q[0] + a.v[0] * b.v[0]
}

/// The sum of the sizes of all entries.
fn size(matrix: &Matrix) -> Wide {
    matrix.rows().concat().into_iter().fold(Wide::ZERO, |sum, x| sum + x.abs())
}

#[cfg(test)]
mod tests {
    use libration_core::system::{DampedOscillator, Oscillator};

    use super::super::ZohStep;
    use super::super::sample::all;
    use super::*;

    #[test]
    fn the_solution_solves_the_equation() {
        let weight = |x: f64, y: f64| {
            Matrix::from_map(|e| State {
                q: [Wide::from_f64(x) * e.q[0]],
                v: [Wide::from_f64(y) * e.v[0]],
            })
        };
        let (q, r) = (weight(50.0, 2.0), Wide::from_f64(0.5));
        let stable = all(Oscillator { omega2: 10.0 }, 0.1);
        let unstable = all(DampedOscillator { omega2: -4.0, gamma: -0.5 }, 0.2);
        for (name, plant) in stable.into_iter().chain(unstable) {
            let ZohStep { phi, gamma } = (plant.step)(plant.dt);
            let x = riccati(phi, gamma, q, r).unwrap();
            // With the row ΓᵀXΦ and the number r + ΓᵀXΓ.
            let row = phi.transposed().after(&x).apply(&gamma);
            let price = r + dot(&gamma, &x.apply(&gamma));
            let saved = Matrix::from_map(|e| State::origin().plus(dot(&row, &e) / price, row));
            let right = q.plus(Wide::one(), &phi.transposed().after(&x).after(&phi));
            let rest = x.plus(-Wide::one(), &right.plus(-Wide::one(), &saved));
            // What 1024 bits leave of an iteration that ends at 2⁻⁹⁰⁰.
            assert!((size(&rest) / size(&x)).to_f64() < 1e-265, "{name}");
        }
    }
}
