//! How well a fit of random arrivals is known.

use libration::linear::{Matrix, solve_matrix};

use crate::arrivals::{ArrivalFit, ArrivalLaw, ArrivalSearch};
use crate::estimate::Estimate;
use crate::information::information;

impl ArrivalSearch<'_> {
    /// The covariance of the coordinates: by the curvature of the likelihood, or where that is none, as at a kink or at a bound, by the
    /// scatter of its slopes. NaN for coordinates without influence. Nothing is known better than if each arrival were observed.
    pub(crate) fn covariance(&self, fit: &ArrivalFit) -> Option<Matrix> {
        let floors = self.floors(fit);
        let steps = self.steps(fit, &floors);
        let mut found = self.by_curvature(fit, &steps).or_else(|| self.by_slopes(fit, &steps))?;
        for (i, floor) in floors.iter().enumerate() {
            if found[(i, i)] < floor * floor {
                found[(i, i)] = floor * floor;
            }
        }
        Some(found)
    }

    /// The standard errors that the coordinates would have if each arrival were observed.
    fn floors(&self, fit: &ArrivalFit) -> Vec<f64> {
        let free = self.model.free_shape();
        // Each change of the command tells of one arrival at most.
        let changes =
            self.recording.commands.windows(2).filter(|pair| pair[0] != pair[1]).count().max(1)
                as f64;
        let mut floors: Vec<f64> = self.scales.iter().map(|scale| 1e-3 * scale.abs()).collect();
        let observed = Estimate::at(&self.model, self.recording, &fit.coordinates[..free]);
        let known = observed.and_then(|observed| {
            let scale = fit.model.deviation / observed.variance().sqrt();
            Some((information(&observed, self.recording)?, scale))
        });
        if let Some((known, scale)) = known {
            let coordinates = self.model.coordinates();
            let mut set = |i: usize, place: usize| {
                let error = scale * known.covariance[(place, place)].sqrt();
                if error.is_finite() && error > 0.0 {
                    floors[i] = error;
                }
            };
            (0..free).for_each(|i| set(i, i));
            for (place, &column) in known.coefficients.iter().enumerate() {
                if column < 2 {
                    set(free + column, coordinates + place);
                }
            }
        }
        floors[free + 2] = (2.0 * self.count() as f64).sqrt().recip();
        let of_share = |share: f64| (changes * share * (1.0 - share)).max(1e-3).sqrt().recip();
        let law = &fit.model;
        match fit.law {
            ArrivalLaw::Certain => {}
            ArrivalLaw::Jitter => {
                floors[free + 3] = law.jitter / (2.0 * changes).sqrt();
                if self.model.known[0].is_none() {
                    floors[0] = floors[0].max(law.jitter / changes.sqrt());
                }
            }
            ArrivalLaw::Loss => floors[free + 3] = of_share(law.loss),
            ArrivalLaw::TwoDelays => floors[free + 4] = of_share(law.second.1),
        }
        floors
    }

    /// Steps over which the likelihood falls by a tenth or more. Merged hypotheses make it rough: smaller steps than these errors would
    /// measure the roughness.
    fn steps(&self, fit: &ArrivalFit, floors: &[f64]) -> Vec<f64> {
        let centre = -fit.log_likelihood;
        let grown = |(i, &floor): (usize, &f64)| {
            let at = |step: f64| {
                let mut coordinates = fit.coordinates.clone();
                coordinates[i] += step;
                self.cost(&coordinates)
            };
            let mut step = floor;
            for _ in 0..12 {
                if 0.5 * (at(step) + at(-step)) - centre >= 0.1 {
                    break;
                }
                step *= 1.7;
            }
            step
        };
        floors.iter().enumerate().map(grown).collect()
    }

    fn by_curvature(&self, fit: &ArrivalFit, steps: &[f64]) -> Option<Matrix> {
        let n = fit.coordinates.len();
        let centre = -fit.log_likelihood;
        let at = |moves: &[(usize, f64)]| {
            let mut coordinates = fit.coordinates.clone();
            moves.iter().for_each(|&(i, step)| coordinates[i] += step);
            self.cost(&coordinates)
        };
        let hessian = Matrix::from_fn(n, n, |i, j| {
            let (a, b) = (steps[i], steps[j]);
            match i == j {
                true => (at(&[(i, a)]) + at(&[(i, -a)]) - 2.0 * centre) / (a * a),
                false => {
                    let (a, b) = (0.7 * a, 0.7 * b);
                    (at(&[(i, a), (j, b)]) + at(&[(i, -a), (j, -b)])
                        - at(&[(i, a), (j, -b)])
                        - at(&[(i, -a), (j, b)]))
                        / (4.0 * a * b)
                }
            }
        });
        let is_given = self.model.gain.is_some();
        let gain = self.model.free_shape();
        let hessian = Matrix::from_fn(n, n, |i, j| match is_given && (i == gain || j == gain) {
            true => f64::from(u8::from(i == j)),
            false => hessian[(i, j)],
        });
        let covariance = solve_matrix(&hessian, &Matrix::identity(n))?;
        (0..n).all(|i| covariance[(i, i)] > 0.0).then_some(covariance)
    }

    /// The inverse of the sum of squares of the slopes of each response (E. K. Berndt, B. H. Hall, R. E. Hall and J. A. Hausman, Annals of
    /// Economic and Social Measurement 3, 1974), which is a covariance everywhere.
    fn by_slopes(&self, fit: &ArrivalFit, steps: &[f64]) -> Option<Matrix> {
        let n = fit.coordinates.len();
        let given = self.model.gain.map(|_| self.model.free_shape());
        let centre = self.trace(&fit.coordinates)?.terms;
        let slopes: Vec<Vec<f64>> = (0..n)
            .map(|i| {
                if Some(i) == given {
                    return vec![0.0; centre.len()];
                }
                let at = |step: f64| {
                    let mut coordinates = fit.coordinates.clone();
                    coordinates[i] += step;
                    self.trace(&coordinates).map(|trace| trace.terms)
                };
                let sides = [at(-steps[i]), at(steps[i])];
                let width = steps[i] * sides.iter().flatten().count() as f64;
                let [below, above] = sides.map(|side| side.unwrap_or_else(|| centre.clone()));
                above.iter().zip(&below).map(|(a, b)| (a - b) / width).collect()
            })
            .collect();
        let inner = |i: usize, j: usize| -> f64 {
            slopes[i].iter().zip(&slopes[j]).map(|(x, y)| x * y).sum()
        };
        let kept: Vec<usize> =
            (0..n).filter(|&i| inner(i, i) > 0.0 && inner(i, i).is_finite()).collect();
        let root = |i: usize| inner(i, i).sqrt();
        let scaled = Matrix::from_fn(kept.len(), kept.len(), |i, j| {
            inner(kept[i], kept[j]) / (root(kept[i]) * root(kept[j]))
        });
        let inverse = solve_matrix(&scaled, &Matrix::identity(kept.len()))?;
        if (0..kept.len()).any(|i| inverse[(i, i)].is_nan() || inverse[(i, i)] <= 0.0) {
            return None;
        }
        let mut covariance = Matrix::from_fn(n, n, |_, _| f64::NAN);
        for (i, &row) in kept.iter().enumerate() {
            for (j, &column) in kept.iter().enumerate() {
                covariance[(row, column)] = inverse[(i, j)] / (root(row) * root(column));
            }
        }
        Some(covariance)
    }
}
