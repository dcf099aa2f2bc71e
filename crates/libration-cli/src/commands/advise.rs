//! `libration advise`.

use std::fmt::Write as _;
use std::ops::RangeInclusive;

use libration_advise as advise;
use libration_advise::{Advice, AdviseError, Budget, Doubt, LoopAdvice, Request, linear, rounded};
use libration_report::Verdict;
use libration_report::notation::cut_off;
use libration_settings::ConfigCommand;
use libration_work::Work;

use super::advice_output::{AdviceOutput, failure};
use super::repeat_command::command_line;
use super::time_stamps::RecordNotes;
use super::{config_file, equation_file, summary, time_stamps};
use crate::args::AdviseArgs;
use crate::error::Failure;
use crate::progress::Reporter;
use crate::{interrupt, terminal};

/// Mean intervals of time stamps over the period. Others are those of another loop, or in another unit: units differ by 1000.
const INTERVALS: RangeInclusive<f64> = 0.5..=2.0;

/// Computes the limits of a loop or a simulation and prints them.
pub(crate) fn run(args: &AdviseArgs, quiet: bool) -> Result<(), Failure> {
    if args.print_config {
        return Ok(terminal::print(advise::DEFAULT)?);
    }
    args.topic.ensure_file("--jitter-file", args.jitter_file.as_deref())?;
    if let Some((request, notes)) = super::advise_linear::load_request(args)? {
        return super::advise_linear::run(args, request, notes, quiet);
    }
    let (request, notes) = load_request(args, quiet)?;
    let compute = |work: &Work<'_>| advise::advise(work, &request);
    let output = AdviceOutput {
        describe,
        summarise: summary::of_advice,
        page: advise::page,
        verdict: |advice| &advice.verdict,
        warnings: |advice| &mut advice.warnings,
        doubt: Advice::doubt,
    };
    output.deliver(args, quiet, notes, compute)
}

/// The part of advice on a loop that a clock changes.
pub(super) struct ClockAdvice {
    pub(super) answer: String,
    pub(super) verdict: Verdict,
    pub(super) warnings: Vec<String>,
    pub(super) budgets: Vec<Budget>,
}

/// Computes advice on a loop, without printing it; `command` repeats it. It decides nothing if the record is not the clock of the loop, or
/// if the latency `is_changing`.
pub(super) fn of_clock(
    args: &AdviseArgs,
    command: &str,
    is_changing: bool,
    quiet: bool,
) -> Result<ClockAdvice, Failure> {
    let doubt = |notes: &RecordNotes| match notes.doubt {
        Some((doubt, _)) => Some(doubt),
        None => is_changing.then_some(Doubt::ChangingLatency),
    };
    // `clock` prints the other warnings about its file itself.
    if let Some((mut request, notes)) = super::advise_linear::load_request(args)? {
        command.clone_into(&mut request.invocation);
        let advice = computed(quiet, |work| linear::advise(work, &request));
        let mut advice = advice?;
        doubt(&notes).into_iter().for_each(|doubt| advice.doubt(doubt));
        let linear::LinearAdvice { answer, verdict, mut warnings, budgets, .. } = advice;
        warnings.splice(0..0, notes.doubt.map(|(_, warning)| warning));
        return Ok(ClockAdvice { answer, verdict, warnings, budgets });
    }
    let (mut request, notes) = load_request(args, quiet)?;
    command.clone_into(&mut request.invocation);
    let mut advice = computed(quiet, |work| advise::advise(work, &request))?;
    doubt(&notes).into_iter().for_each(|doubt| advice.doubt(doubt));
    let Advice { answer, verdict, mut warnings, looped, .. } = advice;
    warnings.splice(0..0, notes.doubt.map(|(_, warning)| warning));
    let budgets = looped.map_or_else(Vec::new, |looped| looped.budgets);
    Ok(ClockAdvice { answer, verdict, warnings, budgets })
}

/// Computes advice, with its progress on stderr.
fn computed<A: Send>(
    quiet: bool,
    compute: impl FnOnce(&Work<'_>) -> Result<A, AdviseError>,
) -> Result<A, Failure> {
    let reporter = Reporter::new(quiet);
    let advice = interrupt::compute(|stop| compute(&Work::new(&reporter, stop)));
    reporter.clear();
    advice.map_err(failure)
}

/// Returns the request of the file or of the options, and what is to be said of its record.
fn load_request(args: &AdviseArgs, quiet: bool) -> Result<(Request, RecordNotes), Failure> {
    args.ensure_no_linear_options()?;
    let mut request = match &args.config {
        Some(path) => {
            let request = config_file::read(path, |text, name| {
                advise::parse(text, name).inspect(|_| {
                    config_file::note_ignored_keys(text, ConfigCommand::ADVISE, quiet);
                })
            })?;
            args.with_timing(request)?
        }
        None => {
            let options = args.system_and_start()?;
            args.request(equation_file::any_system(&options)?, &options)?
        }
    };
    request.map = args.page.is_some();
    request.invocation = command_line();
    let mut notes = RecordNotes::default();
    if let Some(path) = &args.jitter_file {
        let Some(control) = request.control.take() else {
            return Err(Failure::usage(
                "--jitter-file is given, but there is no loop; expected --feedback, or a controller in the file",
            ));
        };
        let (options, period) = (args.topic.options(), control.period);
        let replay = |stamps: &[f64]| control.with_time_stamps(stamps);
        let (replaying, own) =
            time_stamps::read_for_period(path, &options, period, INTERVALS, replay)?;
        request.control = Some(replaying);
        notes = own;
    }
    Ok((request, notes))
}

/// Returns the answer as text.
fn describe(advice: &Advice) -> String {
    let mut text = format!("{}\n", advice.answer);
    for warning in &advice.warnings {
        let _ = writeln!(text, "warning: {warning}");
    }
    let _ = writeln!(text, "verdict: {}", advice.verdict);
    if let Some(looped) = &advice.looped {
        describe_loop(looped, &advice.repeat_command, &mut text);
    }
    if !advice.integrators.is_empty() {
        let _ = writeln!(
            text,
            "\n{:<34} {:>15} {:>12} {:>12} {:>12} {:>14}",
            "integrator", "largest dt/s", "steps/period", "error", "next longer", "evaluations/s"
        );
    }
    let shown = |x: Option<f64>| match x {
        Some(x) if x.is_finite() => format!("{x:.4e}"),
        Some(_) => "lost".into(),
        None => "none".into(),
    };
    // Limits are not rounded beyond themselves.
    let longest = |x: Option<f64>| shown(x.map(|x| cut_off(x, 5)));
    for choice in &advice.integrators {
        let _ = writeln!(
            text,
            "{:<34} {:>15} {:>12} {:>12} {:>12} {:>14}",
            choice.integrator,
            match (choice.dt, choice.tried_down_to) {
                (None, Some(shortest)) => format!("none to {shortest:.1e}"),
                (dt, _) => longest(dt),
            },
            choice.substeps.map_or_else(String::new, |count| count.to_string()),
            if choice.lost.is_finite() {
                format!("{:.3e}", choice.lost)
            } else {
                "above tolerance".into()
            },
            shown(choice.lost_beyond),
            shown(choice.evaluations)
        );
    }
    if let Some(command) = advice.command.as_ref().filter(|_| advice.looped.is_none()) {
        let _ = writeln!(text, "  {command}");
    }
    if let Some(why) = &advice.runner_up {
        let _ = writeln!(text, "runner-up: {why}");
    }
    for float in &advice.floats {
        let meets = if float.meets { "within" } else { "above" };
        let _ = writeln!(
            text,
            "in {}: error {:.3e} of the {}, {meets} the tolerance (simulated)",
            float.float, float.lost, float.of
        );
        if advice.looped.is_none() {
            let _ = writeln!(text, "  {}", float.command);
        }
    }
    if let Some(t) = &advice.throughput {
        let _ = writeln!(
            text,
            "one core: {:.3e} steps of the plant per second with {} trajectories (measured now); {} steps of each: \
             {:.1} MB of rollouts in f32",
            t.steps_a_second,
            t.trajectories,
            t.steps,
            t.bytes as f64 / 1e6
        );
    }
    let _ = writeln!(text, "repeat with: {}", advice.repeat_command);
    text
}

/// Appends the budgets of a loop.
fn describe_loop(looped: &LoopAdvice, again: &str, text: &mut String) {
    let _ = writeln!(text, "\n{}; a sample every {} s", looped.controller, looped.period);
    if looped.held_command != 0.0 {
        let _ = writeln!(
            text,
            "command at the operating point: {} of {:.6} {}",
            looped.command, looped.held_command, looped.command_unit
        );
    }
    if looped.budgets.is_empty() {
        // A loop that is unstable without imperfections has no limits.
        return;
    }
    let _ = writeln!(
        text,
        "\n{:<14} {:>12} {:>14} {:>14} {:>8}  {:<17} how",
        "alone", "stated", "stable up to", "tolerated", "used", "unit"
    );
    for budget in &looped.budgets {
        let _ = writeln!(
            text,
            "{:<14} {:>12} {:>14} {:>14} {:>8}  {:<17} {}",
            budget.kind.name(),
            rounded(budget.stated),
            budget.limit_in_words(budget.stable_up_to),
            budget.tolerated_up_to.map_or_else(String::new, |limit| budget.limit_in_words(limit)),
            budget.used_in_percent(),
            budget.unit,
            budget.how
        );
    }
    let own = format!("{again} --json");
    for budget in looped.budgets.iter().filter(|budget| budget.command != own) {
        let _ = writeln!(text, "  {}", budget.command);
    }
    let combined = &looped.combined;
    let _ = writeln!(
        text,
        "\nall imperfections together: second moments change by {:+.4e} per period (exact)",
        combined.growth.exp_m1()
    );
    if let Some(cost) = combined.cost {
        let _ = writeln!(
            text,
            "cost under unit noise: {cost:.6e}, without imperfections {:.6e} (exact: Lyapunov equation)",
            combined.ideal_cost
        );
    }
    if combined.command != own {
        let _ = writeln!(text, "  {}", combined.command);
    }
    if let Some(s) = &combined.simulated {
        let _ = writeln!(
            text,
            "cost of {} simulated loops, {} periods, constant noise in each period, without the cost of commands: {:.5e} ± {:.1e}, predicted {:.5e}",
            s.loops, s.periods, s.cost, s.error, s.predicted
        );
    }
    if let Some(r) = &combined.region_of_attraction {
        let [back, all] = r.returned;
        let _ = writeln!(
            text,
            "{back} of {all} loops return from a deviation of {}; all return from {}{} (simulated)",
            r.deviation,
            if r.up_to < r.tried_up_to { "up to " } else { "as far as was tried, " },
            cut_off(r.up_to, 4)
        );
    }
}
