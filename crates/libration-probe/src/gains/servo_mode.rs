//! The modes of all joints together.

use libration::linear::{Complex64, Matrix, eigenvalues};
use serde::Serialize;

use super::Servos;
use super::step_units::scaled;
use crate::modes::matched;

/// Halvings of the step through which the factors of a mode are followed.
const HALVINGS: i32 = 12;
/// Relative difference of two factors that are one, apart from rounding.
const SAME: f64 = 1e-6;

/// A mode of all joints.
#[derive(Clone, Debug, Serialize)]
pub struct ServoMode {
    /// The joints that move most, with their sizes relative to the largest.
    pub joints: Vec<(String, f64)>,
    /// Frequency `|s|/2π` in Hz.
    pub frequency: f64,
    /// `|s|h`.
    pub turn: f64,
    /// The damping ratio in continuous time.
    pub damping_ratio: Option<f64>,
    /// The sizes `|z|` of the factors of a substep, the largest first: two where a pair is real.
    pub radii: Vec<f64>,
    /// The largest of them.
    pub radius: f64,
    /// The damping ratio that the step adds, by the largest factor.
    pub numerical_damping: Option<f64>,
}

/// The modes, the fastest first. `step` is the matrix of a step of a length, and `h` the length.
pub(super) fn modes(
    servos: &Servos,
    step: impl Fn(f64) -> Option<Matrix>,
    h: f64,
) -> Vec<ServoMode> {
    // In units of the step, in which no number overflows.
    let Ok(plant) = servos.in_steps_of(h).plant() else { return Vec::new() };
    let units = servos.unit_exponents();
    let details = plant.mode_details();
    // Each mode with its place among all eigenvalues; of a pair both.
    let mut rates: Vec<Complex64> = Vec::new();
    let mut places: Vec<Vec<usize>> = Vec::new();
    for mode in &details {
        let pair = if mode.value.im == 0.0 { 1 } else { 2 };
        places.push((rates.len()..rates.len() + pair).collect());
        rates.extend([mode.value, mode.value.conj()].into_iter().take(pair));
    }
    let factors = factors(&rates, step, h);
    let n = servos.joints.len();
    let mut found: Vec<ServoMode> = details
        .into_iter()
        .zip(places)
        .map(|(mode, places)| {
            let mut own: Vec<Complex64> =
                places.iter().filter_map(|k| factors.get(*k)).copied().collect();
            own.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
            let damping_ratio = mode.damping_ratio();
            let of_step = own.first().map(|z| z.ln()).map(|s| -s.re / s.norm());
            let numerical_damping = of_step
                .zip(damping_ratio)
                .map(|(step, exact)| step - exact)
                .filter(|added| added.is_finite());
            let mut radii: Vec<f64> = own.iter().map(|z| z.norm()).collect();
            radii.dedup_by(|a, b| (*a - *b).abs() <= SAME * b.abs());
            let unit = units.iter().copied().max().unwrap_or(0);
            let size = |i: usize| scaled(mode.shape[i].norm(), units[i] - unit);
            let largest = (0..n).map(size).fold(f64::MIN_POSITIVE, f64::max);
            let mut joints: Vec<(String, f64)> = (0..n)
                .map(|i| (servos.joints[i].name.clone(), size(i) / largest))
                .filter(|(_, size)| *size >= 0.1)
                .collect();
            joints.sort_by(|a, b| b.1.total_cmp(&a.1));
            joints.truncate(4);
            ServoMode {
                joints,
                frequency: mode.natural_frequency() / h / core::f64::consts::TAU,
                turn: mode.natural_frequency(),
                damping_ratio,
                radius: radii.first().copied().unwrap_or(f64::NAN),
                radii,
                numerical_damping,
            }
        })
        .collect();
    found.sort_by(|a, b| b.turn.total_cmp(&a.turn));
    found
}

/// The factors of a step of `h` in the order of the rates, followed from short steps; each is that of one rate.
fn factors(rates: &[Complex64], step: impl Fn(f64) -> Option<Matrix>, h: f64) -> Vec<Complex64> {
    let mut current: Option<Vec<Complex64>> = None;
    for halvings in (0..=HALVINGS).rev() {
        let part = 2.0_f64.powi(-halvings);
        let Some(found) = step(h * part).and_then(|step| eigenvalues(&step)) else { continue };
        let expected = match current {
            None => rates.iter().map(|s| (s * part).exp()).collect(),
            // A factor of a step twice as long is about the square.
            Some(before) => before.iter().map(|z: &Complex64| z * z).collect::<Vec<_>>(),
        };
        current = Some(matched(&expected, &found));
    }
    current.unwrap_or_default()
}
