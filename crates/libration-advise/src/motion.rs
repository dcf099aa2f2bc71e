//! Motions of a loop in words.

/// The frequency in Hz of a motion that turns by `angle` rad in a period of `period` s, and the motion in words. The frequency is
/// none if the motion does not oscillate.
pub(super) fn describe_motion(angle: f64, period: f64) -> (Option<f64>, String) {
    let frequency = angle / (std::f64::consts::TAU * period);
    let shown = four_digits(frequency);
    match angle {
        0.0 => (None, "it diverges without oscillation".into()),
        angle if angle > 3.1 => {
            (Some(frequency), format!("it changes sign every period, at {shown} Hz"))
        }
        _ => (Some(frequency), format!("it oscillates at {shown} Hz with growing amplitude")),
    }
}

/// A number with four digits, without zeros at its end.
pub(super) fn four_digits(x: f64) -> f64 {
    format!("{x:.3e}").parse().unwrap_or(x)
}
