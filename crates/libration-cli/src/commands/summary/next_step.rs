//! The command that is recommended after an analysis of a step.

use libration_analyze::linear_analysis::StepAnalysis;
use libration_analyze::{Analysis, Request};
use libration_report::verdict::Verdict;

use super::super::digits::{limit, significant};
use super::super::repeat_command::{SYSTEM, of_subcommand, with_option};

/// The recommended command and its purpose.
pub(super) fn next(analysis: &Analysis, request: &Request) -> Option<(&'static str, String)> {
    if analysis.verdicts.closed_loop.is_some() {
        return after_loop(analysis);
    }
    let is_bad = |verdict: &Option<Verdict>| verdict.as_ref().is_some_and(|own| !own.is_good());
    if is_bad(&analysis.verdicts.step)
        && let Some(windows) = &analysis.stability_windows
    {
        return match windows.first() {
            Some(&[Some(0.0), Some(to)]) if analysis.dt > to => {
                Some(("Take shorter steps", with_option("--dt", &limit(0.9 * to, 2))))
            }
            Some(_) => None,
            None if analysis.integrator == "velocity-verlet" => None,
            None => Some((
                "Take an integrator that is stable",
                with_option("--integrator", "velocity-verlet"),
            )),
        };
    }
    let is_at_rest = analysis.verdicts.motion.is_none() && analysis.motion.is_some();
    match analysis.verdicts.all().all(Verdict::is_good) {
        // Nothing moves there, so that no error has a size.
        true if is_at_rest => None,
        // `advise` has systems by name of at most two degrees of freedom.
        true if request.system.twin.is_some() && request.system.q.len() > 2 => None,
        true => {
            let steps = analysis.motion.as_ref().map_or(request.steps, |own| own.error_steps);
            let horizon = significant(steps as f64 * analysis.dt, 4);
            let more = ["--tolerance", "trajectory=1e-6", "--horizon", &horizon];
            let command = of_subcommand("advise", &SYSTEM, &more);
            Some(("Find the cheapest integrator for an error", command))
        }
        false => {
            let dt = significant(shorter(analysis), 6);
            Some(("Take shorter steps", with_option("--dt", &dt)))
        }
    }
}

fn after_loop(analysis: &Analysis) -> Option<(&'static str, String)> {
    let timing = analysis.timing.as_ref()?;
    let late = timing.latency_steps? * analysis.dt;
    let critical = timing.critical.as_ref()?.critical_latency_seconds;
    Some(match critical.filter(|critical| *critical <= late && *critical > 0.0) {
        Some(critical) => {
            // Below it: at the limit itself the loop does not decay.
            ("Take a shorter latency", with_option("--latency", &limit(0.9 * critical, 2)))
        }
        None => {
            let period = format!("{}", analysis.dt);
            let options =
                [&SYSTEM[..], &["--feedback", "--latency", "--jitter", "--loss"]].concat();
            let command = of_subcommand("advise", &options, &["--period", &period]);
            ("Find the limits of each imperfection", command)
        }
    })
}

/// Half of the step, or of the largest stable one at the equilibrium and along the motion.
fn shorter(analysis: &Analysis) -> f64 {
    let own = |step: &&StepAnalysis| step.integrator == analysis.integrator;
    let linear = analysis.equilibrium.as_ref().and_then(|about| about.linear.as_ref());
    let step = linear.and_then(|linear| linear.steps.iter().find(own));
    let end = step.and_then(|step| step.stable_dt.as_deref()?.first()?[1]);
    let along = analysis.steps_along_motion.as_ref().and_then(|steps| steps.largest_stable_dt);
    let limits = [end, along].into_iter().flatten().filter(|limit| *limit > 0.0);
    0.5 * limits.fold(analysis.dt, f64::min)
}
