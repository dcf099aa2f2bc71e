//! What restricts an identification.

use libration::linear::{Matrix, solve_matrix};
use libration_report::notation::number;

use crate::arrivals::spread;
use crate::candidate::CandidateRow;
use crate::estimate::Estimate;
use crate::identification::Identification;
use crate::interval::Interval;
use crate::recording::Recording;
use crate::residuals::CONTRADICTION;
use crate::summary::seconds;

/// What warnings depend on, besides the result.
pub(crate) struct Context<'a> {
    pub(crate) estimate: &'a Estimate<'a>,
    pub(crate) recording: &'a Recording,
    /// The number of responses of the whole recording.
    pub(crate) all: usize,
    /// The longest lag that a dead time alone does not exclude, in s.
    pub(crate) longest_lag: Option<f64>,
    /// By how much the response leads the command, in s.
    pub(crate) lead: Option<f64>,
}

/// Models whose Bayesian criterion is larger by less than this may be the right ones.
const NEARLY_AS_GOOD: f64 = 20.0;

/// Sentences, the gravest first; the verdict is known, and with it whether the numbers have intervals.
pub(crate) fn warnings(found: &Identification, context: &Context<'_>) -> Vec<String> {
    let &Context { estimate, recording, all, longest_lag, lead } = context;
    let mut warnings = Vec::new();
    if is_controller(recording) {
        warnings.push(
            "the command is a function of the response: these are the numbers of the controller, not those of the plant; help: excite the reference".to_owned(),
        );
    }
    if let Some(lead) = lead {
        warnings.push(format!(
            "the response leads the command by {}: the clocks of both differ, a command is logged after it acts, or the signals are exchanged; help: `libration clock` compares the topics of a log",
            seconds(lead)
        ));
    }
    if !found.other_dead_times.is_empty() {
        warnings.push(other_dead_times(found, recording));
    }
    let missing = recording.missing_commands();
    if missing > 0 {
        warnings.push(format!(
            "{missing} commands seem to be missing from the log: the responses behind them follow commands that are unknown"
        ));
    }
    let of_intervals = |words: &'static str| if found.has_intervals() { words } else { "" };
    if let Some(other) = other_models(found).filter(|_| found.depends_on_command) {
        warnings.push(other + of_intervals("; intervals are those of the chosen model"));
    }
    if let Some(lag) = longest_lag.filter(|lag| found.depends_on_command && *lag > found.interval) {
        warnings.push(format!(
            "a shorter dead time with a lag fits as well: lags up to {} are not excluded; help: random steps",
            seconds(lag)
        ));
    }
    if all > recording.responses.len() {
        warnings.push(format!(
            "{} of {all} responses are used, during which the command changes most",
            recording.responses.len()
        ));
    }
    let tests = &found.residuals;
    if tests.whiteness < CONTRADICTION {
        warnings.push(format!(
            "the residuals are correlated (p = {}, neighbours {:+.2}): no candidate explains the correlation",
            number(tests.whiteness, 2),
            tests.correlation
        ));
    }
    if tests.command < CONTRADICTION {
        warnings.push(format!(
            "the residuals depend on earlier commands (p = {}): the response has other dynamics than each candidate",
            number(tests.command, 2)
        ));
    }
    if tests.excess_kurtosis > 1.5 && tests.normality < CONTRADICTION {
        warnings.push(format!(
            "the residuals have outliers (excess kurtosis {}): the {} normal noise",
            number(tests.excess_kurtosis, 2),
            if found.has_intervals() { "intervals are those of" } else { "model has" }
        ));
    }
    let dead_time = estimate.point.shape[0];
    if estimate.model.known[0].is_none() && dead_time > 0.98 * found.largest_dead_time {
        warnings.push(format!(
            "the dead time is at the largest one tried, {}; help: raise --largest-dead-time",
            seconds(found.largest_dead_time)
        ));
    }
    let reached = found.has_intervals()
        && found.likelihood.is_none()
        && found.parameters.iter().any(|p| p.interval.is_some_and(|i| i.high.is_none()));
    if reached {
        warnings.push("the upper end of a parameter is unknown".to_owned());
    }
    let known = estimate.model.response.parameters().iter().zip(&estimate.model.known);
    let known: Vec<&str> =
        known.filter(|(_, known)| known.is_some()).map(|(name, _)| name.key).collect();
    for parameter in found.parameters.iter().filter(|own| own.interval.is_none()) {
        let is_asked = matches!(
            &*parameter.key,
            "dead_time" | "lag" | "time_constant" | "jitter" | "loss" | "second_dead_time"
        );
        if is_asked && found.has_intervals() && !known.contains(&&*parameter.key) {
            warnings.push(format!(
                "the {} has no interval: the likelihood is not smooth enough here",
                parameter.name
            ));
        }
    }
    let dead_time = found.parameter("dead_time").and_then(|p| Some((p.value, p.interval?)));
    let is_vague = |(value, interval): (f64, Interval)| {
        value > found.interval
            && interval.high.is_some_and(|high| high - interval.low > 2.0 * value)
    };
    if dead_time.is_some_and(is_vague) {
        let width = of_intervals(": its interval is wider than twice the dead time");
        warnings.push(format!(
            "the dead time is hardly known{width}; help: commands that change less often"
        ));
    }
    if let Some(warning) = quantisation(estimate, recording) {
        warnings.push(warning + of_intervals(", and the intervals may be too narrow"));
    }
    for row in found.bootstrap.iter().filter(|_| found.has_intervals()) {
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

/// Models that fit nearly as well, with a dead time outside of the interval.
pub(crate) fn other_models(found: &Identification) -> Option<String> {
    let interval = found.parameter("dead_time")?.interval?;
    // Lines between commands always fit nearly as well: they count only if they fit far better.
    let is_near = |row: &&CandidateRow| match row.hold == found.hold {
        true => row.excess < NEARLY_AS_GOOD,
        false => row.excess < -NEARLY_AS_GOOD,
    };
    let rivals = found.candidates.iter().filter(is_near);
    let rival = rivals
        .filter(|row| !interval.contains(row.dead_time))
        .min_by(|a, b| a.excess.total_cmp(&b.excess))?;
    Some(format!(
        "another model fits as well and has a dead time of {}: {} response, {} hold, {} noise, {} arrivals",
        seconds(rival.dead_time),
        rival.response,
        rival.hold.name(),
        rival.noise.name(),
        rival.arrivals
    ))
}

/// Whether the command is a linear function of the last three responses, as in a loop whose reference rests.
pub(crate) fn is_controller(recording: &Recording) -> bool {
    let mut rows = Vec::new();
    let mut commands = Vec::new();
    for (time, command) in recording.command_times.iter().zip(&recording.commands) {
        let known = recording.response_times.partition_point(|other| other <= time);
        if known >= 3 {
            rows.push([0, 1, 2].map(|back| recording.responses[known - 1 - back]));
            commands.push(*command);
        }
    }
    let count = rows.len() as f64;
    if rows.len() < 30 {
        return false;
    }
    let mean = |of: &dyn Fn(&[f64; 3]) -> f64| rows.iter().map(of).sum::<f64>() / count;
    let means = [0, 1, 2].map(|i| mean(&|row| row[i]));
    let middle = commands.iter().sum::<f64>() / count;
    let product = |i: usize, j: usize| mean(&|row| (row[i] - means[i]) * (row[j] - means[j]));
    let mut normal = Matrix::from_fn(3, 3, product);
    let ridge = 1e-12 * normal.trace();
    (0..3).for_each(|i| normal[(i, i)] += ridge);
    let pairs = || rows.iter().zip(&commands);
    let right = Matrix::from_fn(3, 1, |i, _| {
        pairs().map(|(row, u)| (row[i] - means[i]) * (u - middle)).sum::<f64>() / count
    });
    let Some(gains) = solve_matrix(&normal, &right) else { return false };
    let left = pairs()
        .map(|(row, u)| {
            let fit: f64 = (0..3).map(|i| gains[(i, 0)] * (row[i] - means[i])).sum();
            (u - middle - fit).powi(2)
        })
        .sum::<f64>()
        / count;
    left < 1e-4 * spread(&commands).powi(2)
}

/// Which dead times fit as well, and what would decide.
pub(crate) fn other_dead_times(found: &Identification, recording: &Recording) -> String {
    let own = found.parameter("dead_time").map(|dead_time| seconds(dead_time.value));
    let mut all: Vec<String> = own.into_iter().collect();
    all.extend(found.other_dead_times.iter().map(|&dead_time| seconds(dead_time)));
    let why = period(recording).map_or_else(String::new, |period| {
        format!(", since the command repeats itself every {}", seconds(period))
    });
    format!(
        "dead times of {} fit alike{why}; help: command random steps, or state --dead-time or a lower --largest-dead-time",
        all.join(", ")
    )
}

/// The time after which the command repeats itself, in s; `None` if it does not.
pub(crate) fn period(recording: &Recording) -> Option<f64> {
    let count = recording.commands.len();
    let period = recording.command_times[count - 1] / (count - 1).max(1) as f64;
    let mean = recording.commands.iter().sum::<f64>() / count as f64;
    let centred: Vec<f64> = recording.commands.iter().map(|u| u - mean).collect();
    let longest = (count / 2).min(4000);
    let correlation = |lag: usize| {
        let square = |part: &[f64]| part.iter().map(|x| x * x).sum::<f64>();
        let (early, late) = (&centred[..count - lag], &centred[lag..]);
        let inner: f64 = early.iter().zip(late).map(|(x, y)| x * y).sum();
        inner / (square(early) * square(late)).sqrt()
    };
    // Behind the first fall: a slow command resembles itself at first.
    let fall = (1..=longest).find(|&lag| correlation(lag) < 0.5)?;
    let lag = (fall..=longest).find(|&lag| correlation(lag) > 0.99)?;
    Some(lag as f64 * period)
}

/// A warning if steps of an encoder are wider than the noise.
fn quantisation(estimate: &Estimate<'_>, recording: &Recording) -> Option<String> {
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
            "the responses have steps of {}, as of an encoder, and noise of {}: rounding errors are not independent",
            number(quantum, 3),
            number(deviation, 2)
        )
    })
}
