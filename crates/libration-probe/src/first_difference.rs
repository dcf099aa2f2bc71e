//! Where two recordings differ first.

use serde::Serialize;

/// The first number that differs between two recordings of the same shape.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FirstDifference {
    /// Its index along each axis, such as step, environment and component.
    pub index: Vec<usize>,
    /// The number of the first recording.
    pub first: f64,
    /// The number of the second recording.
    pub second: f64,
    /// Floats between the two, in units in the last place; none if one of them is NaN.
    pub ulps: Option<u64>,
    /// Numbers that differ in all.
    pub differing: usize,
}

impl FirstDifference {
    /// The first difference of two recordings with these lengths of their axes, the last axis being contiguous; none if all bits agree.
    ///
    /// Two NaN with different bits differ, and so do `0` and `−0`.
    pub fn find(first: &[f64], second: &[f64], shape: &[usize]) -> Option<Self> {
        let differs = |k: &usize| first[*k].to_bits() != second[*k].to_bits();
        let count = first.len().min(second.len());
        let at = (0..count).find(differs)?;
        let mut index = vec![0; shape.len()];
        let mut rest = at;
        for (place, length) in index.iter_mut().zip(shape).rev() {
            *place = rest % length;
            rest /= length;
        }
        let (a, b) = (first[at], second[at]);
        let differing = (0..count).filter(differs).count();
        Some(FirstDifference { index, first: a, second: b, ulps: ulps(a, b), differing })
    }
}

impl FirstDifference {
    /// The place in words, for axes of steps, environments and components.
    pub fn place(&self) -> String {
        match self.index[..] {
            [step, environment, component] => {
                format!("step {step}, environment {environment}, component {component}")
            }
            [environment, component] => format!("environment {environment}, component {component}"),
            _ => format!("place {:?}", self.index),
        }
    }
}

/// Floats from one number to the other.
pub fn ulps(a: f64, b: f64) -> Option<u64> {
    // Bits in the order of the numbers.
    let ordered = |x: f64| {
        let bits = x.to_bits().cast_signed();
        if bits < 0 { i64::MIN.wrapping_sub(bits) } else { bits }
    };
    (!a.is_nan() && !b.is_nan()).then(|| ordered(a).abs_diff(ordered(b)))
}
