//! A linear plant, steps on it and the loop around it.

use libration::linear::GROWTH_ROUNDING;
use libration_analyze::linear_analysis::{ClosedLoop, LinearAnalysis, Mode, NOT_SIMULATED};
use libration_report::verdict::{Outcome, Verdict};
use libration_settings::linear_loop::OperatingPoint;

use super::super::digits::{limit, significant};
use super::super::mode_text::{counted, shape};
use super::super::repeat_command::{of_subcommand, with_option};
use super::linear_steps::append_steps;
use super::{Summary, numbers, words};

/// Largest number of modes of a plant, of modes of a loop, and of states.
const MOST_MODES: usize = 5;
const MOST_LOOP_MODES: usize = 3;
const MOST_STATES: usize = 3;

/// Options of a loop around a plant.
const LOOP: [&str; 9] = [
    "--plant",
    "--config",
    "--lqr",
    "--gain",
    "--period",
    "--latency",
    "--output-latency",
    "--jitter",
    "--loss",
];

/// Returns a screen of an analysis; `is_one` is whether one integrator is analysed.
pub(crate) fn of_plant(analysis: &LinearAnalysis, is_one: bool) -> String {
    let plant = verdict(analysis);
    let of_loop = analysis.closed_loop.as_ref().map(verdict_of_loop);
    let of_step = analysis.verdicts.step.as_ref().zip(analysis.dt).map(|(verdict, dt)| {
        let name = analysis.steps.first().map_or("exact", |step| step.integrator);
        let step = format!("{name} in steps of {} s", significant(dt, 6));
        in_words(&step, &step, "on the plant", verdict)
    });
    let mut sentences: Vec<String> = of_loop.into_iter().chain(of_step).collect();
    // What is not good comes first.
    if !analysis.verdicts.step.as_ref().is_none_or(Verdict::is_good) {
        sentences.reverse();
    }
    sentences.push(plant);
    let mut summary = Summary::new(&sentences.join(" "));
    if let Some(note) = &analysis.note {
        summary.wrap("", &format!("note: {note}"), 2);
    }
    match &analysis.closed_loop {
        Some(own) => {
            append_loop_modes(own, &mut summary);
            append_faults(&analysis.modes, &mut summary);
        }
        None => append_modes(analysis, &mut summary),
    }
    summary.blank();
    append_steps(analysis, is_one, &mut summary);
    match &analysis.closed_loop {
        Some(own) => {
            append_noise(own, &mut summary);
            let limits = of_subcommand("advise", &LOOP, &[]);
            summary.command("Find the limits of each imperfection", &limits);
        }
        // A tenth of the fastest time.
        None if analysis.dt.is_none()
            && analysis.fastest_rate > 0.0
            && !analysis.steps.is_empty() =>
        {
            let dt = limit(0.1 / analysis.fastest_rate, 2);
            summary.command("Predict and measure steps", &with_option("--dt", &dt));
        }
        None if !is_one && !analysis.steps.is_empty() => {
            summary.command(
                "See each mode in steps of one integrator",
                &with_option("--integrator", "rk4"),
            );
        }
        None => {
            if let (true, Some(dt)) = (is_one, shorter_step(analysis)) {
                summary.command("Take shorter steps", &with_option("--dt", &limit(dt, 2)));
            }
        }
    }
    summary.finish(
        "all modes with natural frequencies and time constants, and what steps make of them",
    )
}

/// A stable step shorter than that of the analysis, which is not stable; none if it is.
fn shorter_step(analysis: &LinearAnalysis) -> Option<f64> {
    let windows = analysis.steps.first()?.stable_dt.as_ref()?;
    match windows.first()? {
        &[Some(0.0), Some(to)] if analysis.dt? > to => Some(0.9 * to),
        _ => None,
    }
}

/// Whether a mode of the plant grows.
pub(super) fn is_unstable(analysis: &LinearAnalysis) -> bool {
    analysis.verdicts.plant.outcome == Outcome::Unstable
}

/// The stability of a plant in a sentence, with the point at which it is a linearisation.
pub(super) fn verdict(analysis: &LinearAnalysis) -> String {
    let counts = [
        (analysis.states.len(), "state"),
        (analysis.inputs.len(), "input"),
        (analysis.outputs.len(), "output"),
    ]
    .map(|(count, noun)| counted(count, noun));
    let clock = analysis
        .sampling_period
        .map_or_else(String::new, |period| format!(", sampled every {} s", significant(period, 6)));
    let point = analysis.operating_point.as_ref();
    let place = point.map(|point| format!(", linearised at {},", point.place()));
    let place = place.unwrap_or_default();
    let about = format!("plant ({}{clock}){place}", counts.join(", "));
    let Verdict { outcome, evidence, .. } = &analysis.verdicts.plant;
    let sentence = match outcome {
        Outcome::Unknown if analysis.decides_nothing => {
            format!("The stability of the {about} is unknown: {evidence}.")
        }
        Outcome::Unknown => format!("The {about} is neither stable nor unstable: {evidence}."),
        outcome => format!("The {about} is {outcome}: {evidence}."),
    };
    let remarks = point.map(OperatingPoint::remarks).unwrap_or_default();
    format!("{sentence} {remarks}").trim_end().to_owned()
}

fn verdict_of_loop(own: &ClosedLoop) -> String {
    let period = significant(own.period, 6);
    let Verdict { outcome, evidence, not_examined } = &own.verdict;
    let subject = match not_examined.iter().any(|part| part == NOT_SIMULATED) {
        true => "The linearised loop",
        false => "The loop",
    };
    let first = match outcome {
        Outcome::Stable | Outcome::Unstable => {
            format!("{subject} is {outcome} with a period of {period} s")
        }
        _ => format!("It is unknown whether the loop is stable with a period of {period} s"),
    };
    if own.stable && !own.verdict.is_good() {
        return format!("{first}: {evidence}. Its linearisation is stable.");
    }
    let moments = 100.0 * own.mean_square_growth.exp_m1().abs();
    let verb = if own.stable { "fall" } else { "grow" };
    let is_known = own.verdict.outcome != Outcome::Unknown;
    let second_moments = match is_known && own.mean_square_growth.abs() > GROWTH_ROUNDING {
        true => format!("second moments {verb} by {} % per period", significant(moments, 4)),
        false => evidence.clone(),
    };
    let motion =
        own.motion.as_ref().map_or_else(String::new, |own| format!("; {}", own.in_words()));
    let limits = own.verdict.limits();
    format!("{first}: {second_moments}{motion}. {limits}").trim_end().to_owned()
}

/// A verdict as a sentence about `subject`, which is `inside` of a sentence.
fn in_words(subject: &str, inside: &str, scope: &str, verdict: &Verdict) -> String {
    let Verdict { outcome, evidence, .. } = verdict;
    match outcome {
        Outcome::Unknown => {
            format!("Whether {inside} is stable {scope} is not known: {evidence}.")
        }
        Outcome::NotResolved => {
            format!("{subject} does not resolve the motion {scope}: {evidence}.")
        }
        outcome => format!("{subject} is {outcome} {scope}: {evidence}."),
    }
}

fn append_modes(analysis: &LinearAnalysis, summary: &mut Summary) {
    let row = |(i, mode): (usize, &Mode)| {
        let damping = mode.damping_ratio.map_or("none".to_owned(), |x| significant(x, 4));
        vec![
            (i + 1).to_string(),
            significant(mode.growth_rate, 5),
            damping,
            significant(mode.frequency, 5),
            shape(&mode.states),
        ]
    };
    let rows: Vec<Vec<String>> =
        analysis.modes.iter().enumerate().take(MOST_MODES).map(row).collect();
    let heads = [
        numbers("mode"),
        numbers("growth (1/s)"),
        numbers("damping"),
        numbers("frequency (Hz)"),
        words("states that move most"),
    ];
    summary.blank();
    summary.table(&heads, &rows);
    summary.rest(analysis.modes.len() - rows.len());
    append_faults(&analysis.modes, summary);
}

/// Appends the modes that no input reaches, and those that no output shows.
fn append_faults(modes: &[Mode], summary: &mut Summary) {
    let list = |is: fn(&Mode) -> bool| {
        let numbers = modes.iter().enumerate().filter(|(_, mode)| is(mode));
        numbers.map(|(i, _)| (i + 1).to_string()).collect::<Vec<_>>().join(", ")
    };
    // The least change of the plant that hides one of the modes.
    let change = |is: fn(&Mode) -> bool, of: fn(&Mode) -> f64| {
        let least = modes.iter().filter(|mode| is(mode)).map(of).fold(f64::INFINITY, f64::min);
        significant(least, 2)
    };
    for (faulty, why) in [
        (
            list(|mode| !mode.controllable),
            "of the plant not controllable: no input reaches all of its motions".to_owned(),
        ),
        (
            list(|mode| mode.weakly_controllable),
            format!(
                "of the plant weakly controllable: a change of the plant's numbers by a part of {} hides it from the inputs",
                change(|mode| mode.weakly_controllable, |mode| mode.controllability)
            ),
        ),
        (
            list(|mode| !mode.observable),
            "of the plant not observable: no output shows all of its motions".to_owned(),
        ),
        (
            list(|mode| mode.weakly_observable),
            format!(
                "of the plant weakly observable: a change of the plant's numbers by a part of {} hides it from the outputs",
                change(|mode| mode.weakly_observable, |mode| mode.observability)
            ),
        ),
    ] {
        if !faulty.is_empty() {
            summary.wrap("", &format!("warning: mode {faulty} {why}"), 2);
        }
    }
}

fn append_loop_modes(own: &ClosedLoop, summary: &mut Summary) {
    let rows: Vec<Vec<String>> = own
        .modes
        .iter()
        .enumerate()
        .take(MOST_LOOP_MODES)
        .map(|(i, mode)| {
            vec![
                (i + 1).to_string(),
                growth(mode.growth),
                mode.damping_ratio.map_or("none".to_owned(), |x| significant(x, 4)),
                significant(mode.frequency, 4),
                shape(&mode.states),
            ]
        })
        .collect();
    let heads = [
        numbers("mode"),
        numbers("growth/period"),
        numbers("damping"),
        numbers("frequency (Hz)"),
        words("states that move most"),
    ];
    summary.blank();
    summary.table(&heads, &rows);
    summary.rest(own.modes.len() + own.vanishing_modes - rows.len());
}

/// A factor; near one with its difference from it, which decides.
fn growth(factor: f64) -> String {
    let excess = factor - 1.0;
    match excess != 0.0 && excess.abs() < 1e-4 {
        true => {
            format!("1 {} {}", if excess < 0.0 { "−" } else { "+" }, significant(excess.abs(), 2))
        }
        false => significant(factor, 6),
    }
}

fn append_noise(own: &ClosedLoop, summary: &mut Summary) {
    let cost = own.cost.map(|cost| format!("{} per second", significant(cost, 5)));
    summary.row("cost under noise", cost.as_deref().unwrap_or("infinite: second moments grow"));
    let shown = own.deviations.iter().take(MOST_STATES).map(|deviation| {
        format!("{} {} {}", deviation.state, significant(deviation.deviation, 3), deviation.unit)
            .trim_end()
            .to_owned()
    });
    let mut shown: Vec<String> = shown.collect();
    let more = own.deviations.len().saturating_sub(MOST_STATES);
    if more > 0 {
        shown.push(format!("and {more} more"));
    }
    if !shown.is_empty() {
        summary.row("rms under noise", &shown.join(", "));
    }
}
