//! The blocks of `libration analyze` for a control loop.

use std::fmt::Write as _;

use libration_analyze::{LoopAnalysis, LoopCost, LoopGrowth, StableLatencies, Timing};

use super::digits::{beside_one, exact, short, sum};

/// Appends a block for each set of conditions (feedback, latency, jitter, skew, losses), with the conditions as heading.
pub(super) fn describe_loop(answer: &LoopAnalysis, timing: &Timing, text: &mut String) {
    let late = answer.latency_steps.filter(|steps| *steps > 0.0);
    let drawn = [
        ("jitter", timing.jitter.is_some()),
        ("losses", timing.loss.is_some()),
        // Skew changes the cost only; the dephasing time has a row of its own.
        ("skew", timing.skew.is_some() && answer.cost.is_some()),
    ];
    let drawn: Vec<&str> = drawn.into_iter().filter_map(|(name, is)| is.then_some(name)).collect();
    let mut lines = Lines { text };
    let steady: Vec<&str> =
        [Some("feedback"), late.map(|_| "latency")].into_iter().flatten().collect();
    if answer.feedback.is_some() {
        lines.heading("Closed loop", &steady);
        describe_steady(answer, &mut lines);
    }
    match (&answer.feedback, drawn.is_empty()) {
        (_, true) => {}
        (Some(_), _) => lines.heading("Closed loop", &[steady, drawn].concat()),
        (None, _) => lines.heading("Open loop", &drawn),
    }
    if let Some(growth) = &answer.growth {
        describe_growth(growth, answer, timing, &mut lines);
    }
    if let Some(cost) = &answer.cost {
        describe_cost(cost, &mut lines);
    }
}

/// Returns the steps until the mean over clocks of different rates is 1/e.
pub(super) fn dephasing(steps: Option<f64>) -> String {
    number(steps, "steps")
}

/// Rows of a name and a value, under headings.
struct Lines<'a> {
    text: &'a mut String,
}

impl Lines<'_> {
    // Writing into a string cannot fail.
    fn row(&mut self, name: &str, value: &str) {
        let _ = writeln!(self.text, "  {name:<22} {value}");
    }

    fn heading(&mut self, name: &str, with: &[&str]) {
        let _ = writeln!(self.text, "{name}: with {}", with.join(", "));
    }
}

/// Appends the rows of even steps without losses.
fn describe_steady(answer: &LoopAnalysis, lines: &mut Lines<'_>) {
    if let (Some([kp, kd]), Some(steps)) = (answer.feedback, answer.latency_steps) {
        let [of_kp, of_kd] = answer.feedback_units.unwrap_or_default();
        let quantity = answer.command.unwrap_or("command");
        let law = format!("-({} {of_kp}) q - ({} {of_kd}) v", short(kp), short(kd));
        lines.row(quantity, &format!("{law}, latency {} steps", short(steps)));
    }
    if let (Some(radius), Some(excess)) =
        (answer.closed_loop_spectral_radius, answer.closed_loop_spectral_radius_minus_one)
    {
        lines.row("spectral radius", &beside_one(radius, excess));
    }
    if let Some(critical) = &answer.critical {
        describe_critical(critical, lines);
    }
}

fn describe_critical(critical: &StableLatencies, lines: &mut Lines<'_>) {
    let limit =
        |x: Option<f64>, unit| x.map_or("none".to_owned(), |x| format!("{} {unit}", exact(x)));
    lines.row("critical latency", &limit(critical.critical_latency_steps, "steps"));
    lines.row("", &limit(critical.critical_latency_seconds, "s"));
    lines.row("of split steps", &limit(critical.critical_latency_split_steps, "steps"));
    let end = |x: Option<f64>| x.map_or("∞".into(), exact);
    let windows = critical.latency_windows.iter();
    let shown: Vec<String> =
        windows.map(|&(from, to)| format!("{} to {}", exact(from), end(to))).collect();
    let shown = if shown.is_empty() { "none".into() } else { shown.join(", ") };
    lines.row("stable, steps late", &shown);
    lines.row("continuous margin", &number(critical.delay_margin_seconds, "s"));
}

fn describe_growth(
    growth: &LoopGrowth,
    answer: &LoopAnalysis,
    timing: &Timing,
    lines: &mut Lines<'_>,
) {
    let grown = growth.mean_square_radius.zip(growth.mean_square_growth);
    let shown =
        grown.map(|(radius, growth)| format!("{} a step  (1 {growth:+.6e})", short(radius)));
    lines.row("second moments grow by", shown.as_deref().unwrap_or(TOO_FAR));
    if answer.jitter_clips == Some(true) {
        lines.row("", CLIPPED);
    }
    let late = answer.latency_steps.is_some_and(|steps| steps > 0.0);
    let lost = timing.loss.is_some_and(|loss| loss > 0.0);
    let typical = match (late, lost) {
        (true, true) => "not known with a latency and losses".into(),
        (true, false) => "not known with a latency".into(),
        (false, true) => "not known with losses".into(),
        (false, false) => number(growth.lyapunov_exponent, "a step"),
    };
    lines.row("Lyapunov exponent", &typical);
    if timing.skew.is_some() {
        lines.row("", NOMINAL);
    }
}

fn describe_cost(cost: &LoopCost, lines: &mut Lines<'_>) {
    let [q, v, u] = cost.cost_weights;
    let of = sum(&[(q, "q²"), (v, "v²"), (u, "u²")]);
    let shown = match (cost.cost, cost.cost_infinite) {
        (Some(cost), _) => format!("{}, the mean of {of} under unit noise", short(cost)),
        (None, Some(_)) => "infinite: second moments grow".into(),
        (None, None) => "not known: the state of the loop has too many dimensions".into(),
    };
    lines.row("cost", &shown);
    if let Some(increase) = cost.cost_increase {
        lines.row("", &format!("{increase:+.6e} relative to a loop with an ideal clock and link"));
    }
}

fn number(x: Option<f64>, unit: &str) -> String {
    x.map_or_else(|| "none".to_owned(), |x| format!("{} {unit}", short(x)))
}

/// Reason for missing second moments.
pub(super) const TOO_FAR: &str =
    "not known: a deviation of the steps is too large, or the latency is above 90 steps";

/// Note on steps with a negative length.
pub(super) const CLIPPED: &str = "steps with a negative length are set to zero";

/// Note on growth with skew.
pub(super) const NOMINAL: &str = "both for a clock at its nominal rate, without the skew";
