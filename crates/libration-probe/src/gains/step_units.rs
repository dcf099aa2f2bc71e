//! Servos in units of a step and of their inertias, in which no product overflows.

use libration::Scalar;
use libration::linear::{Matrix, solve_matrix};
use libration::number::Wide;

use super::Servos;
use super::joint_step::JointNumbers;

impl Servos {
    /// The same with the unit of time `h` and masses of about 1: a step of `h` is one of 1, with the same factors of modes.
    ///
    /// Masses are divided by powers of two, without rounding.
    pub(super) fn in_steps_of(&self, h: f64) -> Self {
        let n = self.joints.len();
        let halves: Vec<i32> = (0..n).map(|i| exponent(self.mass[(i, i)]) / 2).collect();
        let (of_h, exponent_of_h) = (scaled(h, -exponent(h)), exponent(h));
        let in_units = |matrix: &Matrix, power: i32| {
            Matrix::from_fn(n, n, |i, j| {
                let shift = power * exponent_of_h - halves[i] - halves[j];
                scaled(matrix[(i, j)] * of_h.powi(power), shift)
            })
        };
        Servos {
            joints: self.joints.clone(),
            mass: in_units(&self.mass, 0),
            kp: in_units(&self.kp, 2),
            kv: in_units(&self.kv, 1),
            stiffness: in_units(&self.stiffness, 2),
            damping: in_units(&self.damping, 1),
            torque: self.torque,
        }
    }

    /// The units of the coordinates of [`Servos::in_steps_of`], as powers of two.
    pub(super) fn unit_exponents(&self) -> Vec<i32> {
        (0..self.joints.len()).map(|i| -(exponent(self.mass[(i, i)]) / 2)).collect()
    }

    /// Joint `i` alone in steps of `h`.
    pub(super) fn joint_numbers(&self, i: usize, h: f64) -> JointNumbers {
        let [h, mass] = [h, self.mass[(i, i)]].map(Wide::from_f64);
        let of = |matrix: &Matrix, units: Wide| Wide::from_f64(matrix[(i, i)]) * units / mass;
        JointNumbers {
            kp: of(&self.kp, h * h),
            kv: of(&self.kv, h),
            stiffness: of(&self.stiffness, h * h),
            damping: of(&self.damping, h),
            torque: self.torque,
        }
    }

    /// The largest gain of position in steps of `h`, in units of the one at which a step is about unstable.
    pub(super) fn size_of_gains(&self, h: f64) -> f64 {
        let own = self.in_steps_of(h);
        let size = solve_matrix(&own.mass, &own.kp).map_or(f64::NAN, |found| found.largest());
        match self.kp.largest() {
            0.0 => 0.0,
            _ if size.is_nan() => f64::MAX,
            _ => size.clamp(f64::MIN_POSITIVE, f64::MAX),
        }
    }

    /// The joints in parts between which nothing couples them.
    pub(super) fn parts(&self) -> Vec<Vec<usize>> {
        let n = self.joints.len();
        let all = [&self.mass, &self.kp, &self.kv, &self.stiffness, &self.damping];
        let is_coupled = |i: usize, j: usize| {
            all.iter().any(|matrix| matrix[(i, j)] != 0.0 || matrix[(j, i)] != 0.0)
        };
        let mut left: Vec<usize> = (0..n).collect();
        let mut found = Vec::new();
        while let Some(first) = left.first().copied() {
            let mut part = vec![first];
            let mut k = 0;
            while k < part.len() {
                let more = left.iter().copied().filter(|j| is_coupled(part[k], *j));
                let more: Vec<usize> = more.filter(|j| !part.contains(j)).collect();
                part.extend(more);
                k += 1;
            }
            part.sort_unstable();
            left.retain(|j| !part.contains(j));
            found.push(part);
        }
        found
    }

    /// These joints with all others at rest.
    pub(super) fn part(&self, places: &[usize]) -> Self {
        let n = places.len();
        let of = |matrix: &Matrix| Matrix::from_fn(n, n, |i, j| matrix[(places[i], places[j])]);
        Servos {
            joints: places.iter().map(|i| self.joints[*i].clone()).collect(),
            mass: of(&self.mass),
            kp: of(&self.kp),
            kv: of(&self.kv),
            stiffness: of(&self.stiffness),
            damping: of(&self.damping),
            torque: self.torque,
        }
    }
}

/// About the power of two of a positive number.
fn exponent(x: f64) -> i32 {
    x.log2().floor() as i32
}

/// `x · 2^power`, where `2^power` may be beyond the range of floats.
pub(super) fn scaled(x: f64, power: i32) -> f64 {
    const MOST: i32 = 1000;
    let (mut x, mut left) = (x, power);
    while left != 0 && x != 0.0 && x.is_finite() {
        let part = left.clamp(-MOST, MOST);
        x *= 2.0_f64.powi(part);
        left -= part;
    }
    x
}
