//! Minima of functions without derivatives.

/// A point and its value.
#[derive(Clone, Debug)]
pub(crate) struct Minimum {
    pub(crate) point: Vec<f64>,
    pub(crate) value: f64,
}

/// Most calls per coordinate.
const MOST_CALLS: usize = 250;

/// The minimum near `start` that a simplex of the size `scales` finds (J. A. Nelder and R. Mead, *A simplex method for function
/// minimization*, Computer Journal 7, 1965), until its values differ by less than `tolerance`, and its points by little.
pub(crate) fn simplex(
    f: &mut dyn FnMut(&[f64]) -> f64,
    start: &[f64],
    scales: &[f64],
    tolerance: f64,
) -> Minimum {
    within(f, start, scales, tolerance, MOST_CALLS)
}

/// The same with at most this many calls per coordinate.
pub(crate) fn within(
    f: &mut dyn FnMut(&[f64]) -> f64,
    start: &[f64],
    scales: &[f64],
    tolerance: f64,
    most: usize,
) -> Minimum {
    let n = start.len();
    let mut value = |point: &[f64]| {
        let found = f(point);
        if found.is_nan() { f64::INFINITY } else { found }
    };
    let mut points: Vec<Minimum> = vec![Minimum { point: start.to_vec(), value: value(start) }];
    if n == 0 {
        return points.remove(0);
    }
    for i in 0..n {
        let mut point = start.to_vec();
        point[i] += scales[i];
        points.push(Minimum { value: value(&point), point });
    }
    // The cost of a minimum rises with the square of the distance.
    let size = tolerance.sqrt().clamp(1e-5, 0.05);
    let mut calls = 0;
    while calls < most * n {
        points.sort_by(|a, b| a.value.total_cmp(&b.value));
        let spread = points[n].value - points[0].value;
        let is_small = (0..n).all(|i| {
            let differs =
                |p: &Minimum| (p.point[i] - points[0].point[i]).abs() > size * scales[i].abs();
            !points.iter().any(differs)
        });
        if spread <= tolerance && (is_small || spread == 0.0) || is_small && spread.is_nan() {
            break;
        }
        let centre: Vec<f64> = (0..n)
            .map(|i| points[..n].iter().map(|p| p.point[i]).sum::<f64>() / n as f64)
            .collect();
        let along = |factor: f64| -> Vec<f64> {
            (0..n).map(|i| centre[i] + factor * (points[n].point[i] - centre[i])).collect()
        };
        let mut tried = |point: Vec<f64>| {
            calls += 1;
            Minimum { value: value(&point), point }
        };
        let reflected = tried(along(-1.0));
        if reflected.value < points[0].value {
            let expanded = tried(along(-2.0));
            points[n] = if expanded.value < reflected.value { expanded } else { reflected };
        } else if reflected.value < points[n - 1].value {
            points[n] = reflected;
        } else {
            let inside = reflected.value >= points[n].value;
            let contracted = tried(along(if inside { 0.5 } else { -0.5 }));
            if contracted.value < points[n].value.min(reflected.value) {
                points[n] = contracted;
            } else {
                let best = points[0].point.clone();
                for p in &mut points[1..] {
                    let halved = p.point.iter().zip(&best).map(|(x, b)| 0.5 * (x + b)).collect();
                    *p = tried(halved);
                }
            }
        }
    }
    points.sort_by(|a, b| a.value.total_cmp(&b.value));
    points.remove(0)
}

/// Most restarts of a search.
const MOST_RESTARTS: usize = 3;

/// The minimum of simplexes of at most `most` calls per coordinate that begin where the one before collapsed, until another gains less than
/// `10 · tolerance` or a tenth.
pub(crate) fn restarted(
    f: &mut dyn FnMut(&[f64]) -> f64,
    start: &[f64],
    scales: &[f64],
    tolerance: f64,
    most: usize,
) -> Minimum {
    let mut best = within(f, start, scales, tolerance, most);
    for round in 0..MOST_RESTARTS {
        let sign = if round % 2 == 0 { -0.6 } else { 0.6 };
        let fresh: Vec<f64> = scales.iter().map(|scale| sign * scale).collect();
        let found = within(f, &best.point, &fresh, tolerance, most);
        let gained = best.value - found.value;
        if gained > 0.0 {
            best = found;
        }
        if gained.is_nan() || gained <= (10.0 * tolerance).max(0.1) {
            break;
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_simplex_finds_the_minimum_of_rosenbrock_and_of_a_kink() {
        let mut rosenbrock =
            |x: &[f64]| 100.0 * (x[1] - x[0] * x[0]).powi(2) + (1.0 - x[0]).powi(2);
        let found = simplex(&mut rosenbrock, &[-1.2, 1.0], &[0.5, 0.5], 1e-14);
        assert!(found.point.iter().all(|x| (x - 1.0).abs() < 1e-4), "{found:?}");
        let mut kink = |x: &[f64]| (x[0] - 0.3).abs() + 2.0 * (x[1] + 0.7).abs();
        let found = simplex(&mut kink, &[0.0, 0.0], &[0.1, 0.1], 1e-12);
        assert!((found.point[0] - 0.3).abs() < 1e-5 && (found.point[1] + 0.7).abs() < 1e-5);
    }
}
