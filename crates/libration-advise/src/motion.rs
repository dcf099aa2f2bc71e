//! Motions of a loop in words.

/// The frequency in Hz of a motion that turns by `angle` rad in a period of `period` s, and the motion in words. The frequency is
/// none if the motion does not oscillate.
pub(super) fn describe_motion(angle: f64, period: f64) -> (Option<f64>, String) {
    let frequency = angle / (std::f64::consts::TAU * period);
    match angle {
        0.0 => (None, "it diverges without oscillation".into()),
        angle if angle > 3.1 => {
            (Some(frequency), format!("it changes sign every period, at {frequency:.4} Hz"))
        }
        _ => {
            (Some(frequency), format!("it oscillates at {frequency:.4} Hz with growing amplitude"))
        }
    }
}
