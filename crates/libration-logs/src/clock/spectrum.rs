//! Power spectra of jitter.

use std::f64::consts::TAU;

use serde::Serialize;

/// The power spectral density of relative deviations of intervals.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Spectrum {
    /// The bands by rising frequency.
    pub bands: Vec<Band>,
}

/// A band of a spectrum.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Band {
    /// The centre frequency, in Hz.
    pub frequency: f64,
    /// The density over that of white noise of the same variance.
    pub density: f64,
}

/// Number of intervals of a segment.
const SEGMENT: usize = 128;

impl Spectrum {
    /// The spectrum of deviations at `rate` samples per second: the mean of the periodograms of segments that overlap by half, with
    /// Hann's window (P. D. Welch, *The use of fast Fourier transform for the estimation of power spectra*, IEEE Transactions on Audio
    /// and Electroacoustics 15, 1967). None for fewer than two segments or without variance.
    pub fn of(deviations: &[f64], rate: f64) -> Option<Self> {
        if deviations.len() < 2 * SEGMENT {
            return None;
        }
        let mean = deviations.iter().sum::<f64>() / deviations.len() as f64;
        let square = |x: &f64| (x - mean).powi(2);
        let variance = deviations.iter().map(square).sum::<f64>() / deviations.len() as f64;
        if variance == 0.0 {
            return None;
        }
        let window: Vec<f64> = (0..SEGMENT)
            .map(|n| 0.5 - 0.5 * (TAU * (n as f64 + 0.5) / SEGMENT as f64).cos())
            .collect();
        let power: f64 = window.iter().map(|w| w * w).sum();
        let waves: Vec<(f64, f64)> =
            (0..SEGMENT).map(|n| (TAU * n as f64 / SEGMENT as f64).sin_cos()).collect();
        let mut sums = [0.0; SEGMENT / 2];
        let mut segments = 0.0;
        for start in (0..=deviations.len() - SEGMENT).step_by(SEGMENT / 2) {
            let segment = &deviations[start..start + SEGMENT];
            let shaped: Vec<f64> =
                segment.iter().zip(&window).map(|(x, w)| (x - mean) * w).collect();
            for (i, sum) in sums.iter_mut().enumerate() {
                let (mut re, mut im) = (0.0, 0.0);
                for (n, x) in shaped.iter().enumerate() {
                    let (sine, cosine) = waves[(i + 1) * n % SEGMENT];
                    re += x * cosine;
                    im += x * sine;
                }
                *sum += re * re + im * im;
            }
            segments += 1.0;
        }
        let band = |(i, sum): (usize, f64)| Band {
            frequency: (i + 1) as f64 * rate / SEGMENT as f64,
            density: sum / (segments * power * variance),
        };
        Some(Spectrum { bands: sums.into_iter().enumerate().map(band).collect() })
    }

    /// The densest band, if its density is above four times that of white noise.
    pub fn peak(&self) -> Option<Band> {
        let densest = self.bands.iter().copied().max_by(|a, b| a.density.total_cmp(&b.density));
        densest.filter(|band| band.density > 4.0)
    }
}

#[cfg(test)]
mod tests {
    use libration::random::{Address, Purpose};

    use super::*;

    fn noise(n: u64) -> f64 {
        Address { seed: 1, trajectory: 0, step: n, purpose: Purpose::StepTime }.gaussian()[0]
    }

    #[test]
    fn white_noise_is_flat_and_a_tone_is_found() {
        let white: Vec<f64> = (0..20_000).map(noise).collect();
        let spectrum = Spectrum::of(&white, 1000.0).unwrap();
        // 311 segments, of which neighbours share half: a band is off by 7 %.
        assert!(spectrum.bands.iter().all(|band| (band.density - 1.0).abs() < 0.4));
        assert_eq!(spectrum.peak(), None);
        let tone: Vec<f64> =
            (0..20_000).map(|n| noise(n) + 2.0 * (TAU * 0.2 * n as f64).sin()).collect();
        let peak = Spectrum::of(&tone, 1000.0).unwrap().peak().unwrap();
        assert!((peak.frequency - 200.0).abs() < 8.0, "{peak:?}");
    }

    #[test]
    fn what_is_late_each_for_itself_has_its_power_at_high_frequencies() {
        // Intervals are differences: their density is 1 − cos.
        let late: Vec<f64> = (0..20_000).map(|n| noise(n + 1) - noise(n)).collect();
        let spectrum = Spectrum::of(&late, 1.0).unwrap();
        let [low, high] = [spectrum.bands[2], spectrum.bands[60]];
        for band in [low, high] {
            let wanted = 1.0 - (TAU * band.frequency).cos();
            // The window mixes bands.
            assert!((band.density - wanted).abs() < 0.3, "{band:?} {wanted}");
        }
    }

    #[test]
    fn too_few_and_those_that_do_not_vary_have_none() {
        assert_eq!(Spectrum::of(&[0.5; 100], 1.0), None);
        assert_eq!(Spectrum::of(&[0.5; 1000], 1.0), None);
    }
}
