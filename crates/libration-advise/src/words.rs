//! The answer in sentences.

use libration::Model;

use super::answer::{Advice, LoopAdvice, ToleranceAnswer};
use super::budget::Budget;
use super::control::Control;
use super::loops::Loop;
use super::regained::Regained;
use super::request::{Measure, Request, Tolerance};
use super::stepped::MOST_PERIODS;
use super::together::Together;

/// Which integrator is advised, in a sentence.
pub(super) fn advised(advice: &Advice, request: &Request) -> String {
    let Tolerance { of, most } = request.tolerance;
    // A loop is followed for so many periods; its cost is that of for ever.
    let horizon = match &request.control {
        Some(control) => request.horizon.min(MOST_PERIODS as f64 * control.period),
        None => request.horizon,
    };
    let over = match of {
        Measure::Cost => String::new(),
        _ => format!(" over {horizon} s"),
    };
    match advice.chosen() {
        None => {
            let steps = advice.tried_down_to.map_or_else(String::new, |shortest| {
                format!(" with steps of {shortest:.4e} s or more, and shorter ones were not tried")
            });
            format!("No integrator keeps the {} below {most:e}{over}{steps}.", of.title())
        }
        Some((choice, dt)) => {
            let float = advice.float().map_or("no float type", |float| float.float);
            format!(
                "{} in steps of {dt:.4e} s, in {float}: the cheapest that keeps the {} below {most:e}{over}.",
                choice.integrator,
                of.title()
            )
        }
    }
}

/// Whether a loop stands what is stated, in a sentence or two.
pub(super) fn stands(looped: &LoopAdvice, tolerance: &ToleranceAnswer) -> String {
    let Together { growth, room, room_tried, cost_increase, .. } = looped.together;
    if growth >= 0.0 {
        let remedies = looped.remedies.as_ref();
        return format!(
            "The loop is unstable with what is stated: its second moments grow by {} % a period. {}",
            percent(growth.exp_m1()),
            remedies.map_or_else(String::new, |remedies| remedies.sentence(looped.gain_units))
        );
    }
    let regained = looped.budgets.iter().find_map(|budget| Some((budget, budget.regained?)));
    let mut text = match (room, room_tried) {
        _ if looped.together.contradicted() => {
            "The simulation contradicts what theory says of the loop: see below.".to_owned()
        }
        _ if looped.too_dear(tolerance) => {
            "The loop is stable with what is stated, but costs more than is tolerated.".to_owned()
        }
        _ if let Some((budget, window)) = regained => alone_in(budget, window),
        (Some(room), _) => {
            format!(
                "The loop stands what is stated, and all of it may become {room:.3} times as large."
            )
        }
        (None, Some(tried)) => format!(
            "The loop stands what is stated, and all of it may become at least {tried:.3} times as large, as far as was tried."
        ),
        (None, None) => {
            "The loop stands; nothing is stated that could be wrong with it.".to_owned()
        }
    };
    if let Some(failing) = &looped.fails_first {
        text += &format!(
            " {} fails first, of whose budget {:.1} % is used; {}.",
            capital(failing.kind.name()),
            100.0 * failing.used,
            failing.how
        );
    }
    if let Some(increase) = cost_increase {
        let tolerated = match looped.too_dear(tolerance) {
            true => format!(", more than the {:.3} % that are tolerated", 100.0 * tolerance.most),
            false => String::new(),
        };
        text +=
            &format!(" It costs {:.3} % more than the ideal loop{tolerated}.", 100.0 * increase);
    }
    text
}

/// A share in percent, of which digits are shown however small it is.
fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    if percent < 0.01 { format!("{percent:.2e}") } else { format!("{percent:.3}") }
}

/// That a loop is stable in a window that is regained, and where it is not.
fn alone_in(budget: &Budget, Regained { from, to }: Regained) -> String {
    let (kind, unit) = (budget.kind.name(), budget.unit);
    let limit = budget.stable_up_to.unwrap_or(0.0);
    let end = match to {
        Some(to) => format!("from {from:.6} to {to:.6}"),
        None => format!("from {from:.6}"),
    };
    format!(
        "The loop is stable with what is stated, but only in a window that is regained: {kind} alone is stable {end} {unit} again, \
         and unstable in between from {limit:.6} {unit}. Do not rely on it: less {kind} makes the loop unstable as well as more."
    )
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// What must be said loudly.
pub(super) fn warnings<M: Model<1>>(one: &Loop<M>, together: &Together) -> Vec<String> {
    let mut warnings = Vec::new();
    if let Some(returns) = &together.returns {
        let [back, all] = returns.of_asked;
        if back < all {
            warnings.push(format!(
                "the simulation contradicts the linearisation: of {all} starts {} from the operating point only {back} return; \
                 all do from up to {:.4}",
                returns.asked, returns.up_to
            ));
        }
    }
    if let Some(simulated) = &together.simulated {
        if !simulated.agrees() {
            warnings.push(format!(
                "the simulation contradicts the theory: it costs {:.5e} ± {:.1e}, and {:.5e} is predicted",
                simulated.cost, simulated.error, simulated.predicted
            ));
        } else if simulated.outbursts {
            warnings.push(
                "rare outbursts make up much of the cost: a simulation meets too few of them, and a typical run costs less"
                    .into(),
            );
        }
    } else if together.growth < 0.0 {
        let why = match together.slow() {
            true => "it decays too slowly",
            false => "its commands are too late for losses",
        };
        warnings.push(format!(
            "the loop was not simulated, for {why}: what is said follows from theory alone"
        ));
    }
    let Control { period, .. } = one.control;
    let turn = (2.0 * one.plant().energy().position).sqrt() * period;
    if turn > 1.0 {
        warnings.push(format!(
            "the plant turns by {turn:.2} rad in a period: the loop samples it sparsely"
        ));
    }
    if let Some(record) = &one.control.record {
        let gaps = record.iter().filter(|step| **step * (1.0 + one.control.skew) > 1.5).count();
        let repeats = record.iter().filter(|step| **step == 0.0).count();
        if gaps + repeats > 0 {
            warnings.push(format!(
                "of the {} time stamps, which are replayed as they are, {gaps} come after a gap of more than one and a half periods, and \
                 {repeats} repeat",
                record.len() + 1
            ));
        }
        let skew = one.control.skew;
        if skew.abs() > 1e-3 {
            warnings.push(format!(
                "the time stamps are {:.3} % apart from the period: counted as skew",
                100.0 * skew
            ));
        }
    }
    warnings
}

/// The frequency of a motion that turns by `angle` in a period, and how it looks.
pub(super) fn swings(angle: f64, period: f64) -> (Option<f64>, String) {
    let frequency = angle / (std::f64::consts::TAU * period);
    match angle {
        0.0 => (None, "it runs away without a swing".into()),
        angle if angle > 3.1 => (
            Some(frequency),
            format!("it changes its sign with every period, at {frequency:.4} Hz"),
        ),
        _ => (Some(frequency), format!("it swings at {frequency:.4} Hz with growing amplitude")),
    }
}
