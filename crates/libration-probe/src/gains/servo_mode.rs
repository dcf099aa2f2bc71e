//! The modes of all joints together.

use libration::linear::{Complex64, eigenvalues};
use serde::Serialize;

use super::{ServoIntegrator, Servos};

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
    /// The factor `|z|` of a substep, of the mode of the step that is nearest.
    pub radius: f64,
    /// The damping ratio that the step adds.
    pub numerical_damping: Option<f64>,
}

/// The modes, the fastest first.
pub(super) fn modes(servos: &Servos, integrator: ServoIntegrator, h: f64) -> Vec<ServoMode> {
    let Ok(plant) = servos.plant() else { return Vec::new() };
    let factors: Vec<Complex64> =
        servos.step(integrator, h).and_then(|step| eigenvalues(&step)).unwrap_or_default();
    let n = servos.joints.len();
    let mut found: Vec<ServoMode> = plant
        .mode_details()
        .into_iter()
        .map(|mode| {
            let exact = (mode.value * h).exp();
            let nearest =
                factors.iter().min_by(|a, b| (*a - exact).norm().total_cmp(&(*b - exact).norm()));
            let radius = nearest.map_or(f64::NAN, |z| z.norm());
            let damping_ratio = mode.damping_ratio();
            let of_step = nearest.map(|z| z.ln()).map(|s| -s.re / s.norm());
            let numerical_damping = of_step
                .zip(damping_ratio)
                .map(|(step, exact)| step - exact)
                .filter(|added| added.is_finite());
            let size = |i: usize| mode.shape[i].norm();
            let largest = (0..n).map(size).fold(f64::MIN_POSITIVE, f64::max);
            let mut joints: Vec<(String, f64)> = (0..n)
                .map(|i| (servos.joints[i].name.clone(), size(i) / largest))
                .filter(|(_, size)| *size >= 0.1)
                .collect();
            joints.sort_by(|a, b| b.1.total_cmp(&a.1));
            joints.truncate(4);
            ServoMode {
                joints,
                frequency: mode.natural_frequency() / core::f64::consts::TAU,
                turn: mode.natural_frequency() * h,
                damping_ratio,
                radius,
                numerical_damping,
            }
        })
        .collect();
    found.sort_by(|a, b| b.turn.total_cmp(&a.turn));
    found
}
