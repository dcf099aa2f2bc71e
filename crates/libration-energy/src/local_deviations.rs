//! Local deviations of an energy: samples, stretches and jumps that are out of line with all others.

use crate::EnergyTrace;
use crate::single_precision::{is_single_precision, quantum};

/// Blocks of a run, whose largest values are compared.
const BLOCKS: usize = 48;
/// The most blocks that may be out of line.
const MOST: usize = 6;
/// Numbers of the largest blocks below those, which show how the largest values scatter: few for events that are fewer than the blocks.
const TAILS: [usize; 2] = [10, 20];
/// Samples that a block must have at a scale.
const LEAST: usize = 3;
/// Roundings of the energies below which values do not differ: a difference of fourth order adds up 16 of them.
const ROUNDINGS: f64 = 16.0;
/// Samples for which any energy may be the same.
const REPEATS: f64 = 4.0;
/// The least ratio of values that are out of line to all others.
const RATIO: f64 = 3.0;
/// Part of the largest deviation of a run below which nothing matters.
const SMALL: f64 = 1e-3;
/// Probability of an honest gap in a test.
const LEVEL: f64 = 1e-6;

/// A local deviation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalDeviation {
    /// Its time.
    pub time: f64,
    /// Time between the values that are compared.
    pub spacing: f64,
    /// Distance from the curve through its neighbours.
    pub size: f64,
    /// How many times as large it is as the next largest.
    pub ratio: f64,
    /// How many times as large it is as the middle one of all blocks.
    pub prominence: f64,
}

/// Distances from the curves through neighbours, at samples and at means of 2, 4, … of them.
pub(crate) struct Roughness {
    scales: Vec<Scale>,
    /// Numbers of samples for which the energy is the same.
    repeats: Scale,
    floor: f64,
}

struct Scale {
    spacing: f64,
    /// The largest distance of each block, with its time.
    maxima: Vec<(f64, f64)>,
}

impl Roughness {
    pub(crate) fn of(trace: &EnergyTrace) -> Self {
        let largest = trace.energies.iter().fold(0.0_f64, |most, energy| most.max(energy.abs()));
        let precision = match is_single_precision(&trace.energies) {
            true => f64::from(f32::EPSILON),
            false => f64::EPSILON,
        };
        let start = trace.energies[0];
        let deviation = trace.energies.iter().map(|x| (x - start).abs()).fold(0.0, f64::max);
        let rounding = ROUNDINGS * quantum(&trace.energies).max(precision * largest);
        let floor = rounding.max(SMALL * deviation);
        let (mut times, mut energies) = (trace.times.clone(), trace.energies.clone());
        let mut scales = Vec::new();
        let repeats = Scale::of(&times, &repeats(&energies));
        while energies.len() >= LEAST * BLOCKS + 4 {
            scales.push(Scale::of(&times, &distances(&times, &energies)));
            let halve = |values: &[f64]| -> Vec<f64> {
                values.chunks_exact(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect()
            };
            (times, energies) = (halve(&times), halve(&energies));
        }
        Roughness { scales, repeats, floor }
    }

    /// The largest distance of a sample.
    pub(crate) fn largest(&self) -> f64 {
        self.scales.first().map_or(0.0, |scale| scale.maxima[0].0)
    }

    /// The largest deviation that is out of line, at the finest scale that shows one.
    pub(crate) fn out_of_line(&self) -> Option<LocalDeviation> {
        self.scales.iter().find_map(|scale| scale.outliers(self.floor, LEVEL).into_iter().next())
    }

    /// The longest time for which the energy is the same number, if it is out of line.
    pub(crate) fn repeated(&self) -> Option<LocalDeviation> {
        self.repeats.outliers(REPEATS, LEVEL).into_iter().next()
    }

    /// Whether the energy is the same for the time of another run, somewhere in the run.
    pub(crate) fn repeats_as(&self, other: &LocalDeviation) -> bool {
        2.0 * self.repeats.maxima[0].0 * self.repeats.spacing > other.size * other.spacing
    }

    /// The deviation of this run, at about the same time, that is as prominent as one of another run, but for the square root.
    pub(crate) fn same(&self, other: &LocalDeviation, within: f64) -> Option<LocalDeviation> {
        let distance = |scale: &Scale| (scale.spacing / other.spacing).ln().abs();
        let nearest = self.scales.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        let is_same = |own: &LocalDeviation| {
            (own.time - other.time).abs() <= within + own.spacing + other.spacing
                && own.prominence >= other.prominence.sqrt().max(RATIO)
        };
        (0..MOST).map(|k| nearest.deviation(k, MOST, self.floor)).find(is_same)
    }
}

impl Scale {
    fn of(times: &[f64], values: &[f64]) -> Self {
        let edge = |k: usize| k * values.len() / BLOCKS;
        let largest = |k| {
            let block = (edge(k)..edge(k + 1)).map(|i| (values[i], times[i]));
            block.fold((0.0, 0.0), |a, b| if b.0 > a.0 { b } else { a })
        };
        let mut maxima: Vec<(f64, f64)> = (0..BLOCKS).map(largest).collect();
        maxima.sort_by(|a, b| b.0.total_cmp(&a.0));
        let spacing = (times[times.len() - 1] - times[0]) / (times.len() - 1) as f64;
        Scale { spacing, maxima }
    }

    /// The deviations that are out of line, the largest first.
    ///
    /// Of values with a tail of any power law, the logarithm of the ratio of the j-th largest to the next is exponential with the mean ξ/j,
    /// and ξ is the mean logarithm of the ratios of the next to the smallest of the tail (Hill 1975; Rényi 1953). Tails that fall faster
    /// have smaller ratios.
    fn outliers(&self, floor: f64, level: f64) -> Vec<LocalDeviation> {
        let value = |k: usize| self.maxima[k].0.max(floor);
        let is_gap = |below: usize, tail: usize| {
            let base = value(below + tail).ln();
            let logs: f64 = (below..below + tail).map(|k| value(k).ln() - base).sum();
            // The quantile of the ratio of an exponential number to the mean of as many others as the tail has.
            let quantile = level.powf(-1.0 / tail as f64) - 1.0;
            let allowed = (logs * quantile / below as f64).exp().max(RATIO);
            value(below - 1) > allowed * value(below)
        };
        let is_gap = |below: &usize| TAILS.into_iter().any(|tail| is_gap(*below, tail));
        let Some(count) = (1..=MOST).rev().find(is_gap) else { return Vec::new() };
        (0..count).map(|k| self.deviation(k, count, floor)).collect()
    }

    /// The largest value but `k`, with that number of values which are out of line.
    fn deviation(&self, k: usize, count: usize, floor: f64) -> LocalDeviation {
        let (size, time) = self.maxima[k];
        let value = |k: usize| self.maxima[k].0.max(floor);
        LocalDeviation {
            time,
            spacing: self.spacing,
            size,
            ratio: value(k) / value(count),
            prominence: value(k) / value(BLOCKS / 2),
        }
    }
}

/// The number of samples before each that have the same energy.
fn repeats(energies: &[f64]) -> Vec<f64> {
    let mut count = 0.0;
    let mut last = f64::NAN;
    let next = |energy: &f64| {
        count = if *energy == last { count + 1.0 } else { 0.0 };
        last = *energy;
        count
    };
    energies.iter().map(next).collect()
}

/// The distance of each sample from the curve through its neighbours; 0 for two at each end.
fn distances(times: &[f64], energies: &[f64]) -> Vec<f64> {
    let mut all = vec![0.0; times.len()];
    for i in 2..times.len() - 2 {
        all[i] = off_curve(&times[i - 2..i + 3], &energies[i - 2..i + 3]);
    }
    all
}

/// The distance of the middle one of five values from the cubic curve through the others.
fn off_curve(times: &[f64], energies: &[f64]) -> f64 {
    let others = [0, 1, 3, 4];
    let weight = |i: usize| -> f64 {
        let factor = |j: usize| (times[2] - times[j]) / (times[i] - times[j]);
        others.into_iter().filter(|j| *j != i).map(factor).product()
    };
    // Differences first: energies share most of their digits.
    let distance: f64 = others.into_iter().map(|i| weight(i) * (energies[i] - energies[2])).sum();
    distance.abs()
}
