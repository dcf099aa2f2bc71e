//! What restricts an identification.

use libration_report::notation::number;

use crate::estimate::Estimate;
use crate::identification::Identification;
use crate::recording::Recording;
use crate::residuals::CONTRADICTION;
use crate::summary::seconds;

/// Sentences, the gravest first.
pub(crate) fn warnings(
    found: &Identification,
    estimate: &Estimate,
    recording: &Recording,
) -> Vec<String> {
    let mut warnings = Vec::new();
    let tests = &found.residuals;
    if tests.whiteness < CONTRADICTION {
        warnings.push(format!(
            "the residuals are correlated (p = {}, neighbours {:+.2}): the noise has a colour that no tried model has, and the intervals are too narrow",
            number(tests.whiteness, 2),
            tests.correlation
        ));
    }
    if tests.command < CONTRADICTION {
        warnings.push(format!(
            "the residuals depend on earlier commands (p = {}): the response has dynamics that no tried model has",
            number(tests.command, 2)
        ));
    }
    if tests.excess_kurtosis > 1.5 && tests.normality < CONTRADICTION {
        warnings.push(format!(
            "the residuals have outliers (excess kurtosis {}): the intervals are those of normal noise",
            number(tests.excess_kurtosis, 2)
        ));
    }
    let dead_time = estimate.point.shape[0];
    if estimate.model.known[0].is_none() && dead_time > 0.98 * found.largest_dead_time {
        warnings.push(format!(
            "the dead time is at the largest one tried, {}; help: raise --largest-dead-time",
            seconds(found.largest_dead_time)
        ));
    }
    let reached = found.likelihood.is_none()
        && found.parameters.iter().any(|p| p.interval.is_some_and(|i| i.high.is_none()));
    if reached {
        warnings.push("the recording excludes no large value of a parameter".to_owned());
    }
    if let Some(warning) = quantisation(estimate, recording) {
        warnings.push(warning);
    }
    for row in &found.bootstrap {
        if row.ratio.is_some_and(|ratio| !(0.6..1.6).contains(&ratio)) {
            warnings.push(format!(
                "the standard error of `{}` by Fisher's information disagrees with simulated recordings by a factor of {}; its interval is that of the likelihood",
                row.key,
                number(row.ratio.unwrap_or(f64::NAN), 2)
            ));
        }
    }
    if tests.feedback < CONTRADICTION {
        warnings.push(format!(
            "commands depend on earlier residuals (p = {}): the recording is from inside a closed loop; the estimates hold if the noise is that of the model",
            number(tests.feedback, 2)
        ));
    }
    warnings
}

/// A warning if steps of an encoder are wider than the noise.
fn quantisation(estimate: &Estimate, recording: &Recording) -> Option<String> {
    let mut values = recording.responses.clone();
    values.sort_by(f64::total_cmp);
    values.dedup();
    if values.len() > recording.responses.len() / 4 {
        return None;
    }
    let mut gaps: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
    gaps.sort_by(f64::total_cmp);
    let quantum = *gaps.get(gaps.len() / 2)?;
    // The standard deviation of a uniform error is the width over √12.
    let deviation = estimate.white_deviation();
    (deviation < quantum).then(|| {
        format!(
            "the responses have steps of {}, as of an encoder, and noise of {}: rounding errors are not independent, and the intervals may be too narrow",
            number(quantum, 3),
            number(deviation, 2)
        )
    })
}
