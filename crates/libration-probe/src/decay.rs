//! The decay of distances.
//!
//! It uses nothing of the crate: the tests of `tests/probe` compile it alone, in place of the whole crate once more.

/// Distances in units of the scales that change no bit of a number of ordinary size.
pub(crate) const GONE: f64 = 1e-20;
/// Largest root mean square of the residuals of a decay in the logarithm, far below that of noise, which is about 1.
const RESIDUAL: f64 = 0.3;
/// Least decay of distances that are no single exponential, from their first to their last quarter.
const DECAY: f64 = 1.0 / 3.0;

pub(crate) fn is_gone(distance: f64) -> bool {
    distance < GONE
}

/// The factor by which distances fall behind the first `others`, which are other delays; none if they vary as noise does, or end at once
/// and leave fewer than those.
pub(crate) fn decay(distances: &[f64], others: usize) -> Option<f64> {
    let falling: Vec<f64> =
        distances.iter().skip(others).take_while(|d| !is_gone(**d)).map(|d| d.ln()).collect();
    let count = falling.len();
    if count < others {
        return None;
    }
    let middle = (count as f64 - 1.0) / 2.0;
    let mean = falling.iter().sum::<f64>() / count as f64;
    let moment = |f: &dyn Fn(f64, f64) -> f64| -> f64 {
        falling.iter().enumerate().map(|(k, y)| f(k as f64 - middle, y - mean)).sum()
    };
    let slope = moment(&|k, y| k * y) / moment(&|k, _| k * k);
    let residual = (moment(&|k, y| (y - slope * k).powi(2)) / count as f64).sqrt();
    let largest = |part: &[f64]| part.iter().copied().fold(f64::MIN, f64::max);
    let quarter = count / 4;
    let fall = largest(&falling[count - quarter..]) - largest(&falling[..quarter]);
    let is_steady = residual < RESIDUAL && slope * (count as f64) < -residual;
    (is_steady || fall < DECAY.ln()).then(|| slope.exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_decay_has_its_factor_and_noise_has_none() {
        let decaying: Vec<f64> = (0..63).map(|k| 0.3 * 0.98_f64.powi(k)).collect();
        assert!((decay(&decaying, 8).unwrap() - 0.98).abs() < 1e-12);
        let hash =
            |k: u64| (k.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 11) as f64 / (1_u64 << 53) as f64;
        let noise: Vec<f64> = (1..64).map(hash).collect();
        assert_eq!(decay(&noise, 8), None);
        assert_eq!(decay(&vec![0.5; 63], 8), None);
        assert_eq!(decay(&vec![0.0; 63], 8), None);
    }
}
