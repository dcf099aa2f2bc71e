//! Advice on simulations and loops.

use std::sync::atomic::AtomicBool;

use libration::analysis::Imperfections;
use libration::{Float, Method, State, System};
use libration_analyze::comparison::missed_force;
use libration_analyze::motion::narrow_force;
use libration_work::Work;

use super::advice::{Advice, FloatChoice, LoopAdvice};
use super::combined_effect::CombinedEffect;
use super::control::Control;
use super::free_motion::FreeMotion;
use super::integrator_choice::{
    IntegratorChoice, SearchExtent, StepTrial, best_possible, largest_step, offered_methods,
};
use super::loop_check::UnstableLoop;
use super::loop_simulation::{LoopSimulation, simulated_horizon};
use super::loops::{Loop, LoopError, PlantModel};
use super::request::{Measure, Request, Tolerance};
use super::summary::{describe_integrator, describe_loop, loop_warnings};
use super::system_programs::SystemPrograms;
use super::{AdviseError, Budget, Throughput};

/// The advice on a system without a controller.
pub(super) fn advise_simulation(
    work: &Work<'_>,
    system: &SystemPrograms<'_>,
    request: &Request,
) -> Result<Advice, AdviseError> {
    let free = FreeMotion::new(work, system, request)?;
    let mut advice = Advice::new(request);
    let most = request.tolerance.most;
    let is_short = |method: &Method| free.steps_of(*method).is_sorted();
    let methods: Vec<Method> = offered_methods(system.is_positional()).filter(is_short).collect();
    advice.tolerance.scale = free.energy_scale;
    let mut choices = work.sweep("the largest step of each integrator", &methods, |&method| {
        largest_step(work, &free, method, most, free.steps_of(method))
    })?;
    if choices.iter().all(|choice| choice.dt.is_none()) {
        choices = work.sweep("the smallest error of each integrator", &methods, |&method| {
            best_possible(work, &free, method, free.steps_of(method))
        })?;
        // If the search does not end by rounding, shorter steps have smaller errors.
        let [shortest, _] = free.steps();
        let best = choices.iter().min_by(|a, b| a.lost.total_cmp(&b.lost));
        let ends = best.and_then(|best| best.best_dt).is_none_or(|dt| dt < 2.0 * shortest);
        advice.tried_down_to = Some(shortest).filter(|_| ends);
    }
    let too_long: Vec<&str> = offered_methods(system.is_positional())
        .filter(|method| !is_short(method))
        .map(Method::name)
        .collect();
    let mut not_tried =
        vec!["implicit integrators".to_owned(), "steps of variable length".to_owned()];
    if !too_long.is_empty() {
        not_tried.push(format!("{}, which takes too long over this horizon", too_long.join(", ")));
    }
    let tried = |least: f64, choice: &IntegratorChoice| {
        choice
            .tried_down_to
            .into_iter()
            .chain(choice.dt)
            .chain(choice.best_dt)
            .fold(least, f64::min)
    };
    let longest = choices.iter().filter_map(|choice| choice.dt).fold(free.steps()[1], f64::max);
    advice.search = Some(SearchExtent {
        integrators: choices.len(),
        steps: [choices.iter().fold(f64::INFINITY, tried), longest],
        not_tried,
    });
    advice.choose(request, choices);
    advice.warn_of_limits(free.longest_step());
    if let Some(scale) = free.energy_scale.filter(|_| free.is_relative_to_start) {
        advice.warnings.push(format!(
            "the motion has no kinetic energy: errors of the energy are relative to {scale:.4e}, the energy at the start, which depends on its \
             constant"
        ));
    }
    if !system.is_smooth() {
        advice.warnings.push(
            "the equations have kinks or jumps: errors are those of the steps that were tried, a shorter step may have a larger one, and \
             what acts for less than a step may be missed"
                .to_owned(),
        );
    }
    if let Some((_, dt)) = advice.chosen()
        && free.turn(dt) > 1.0
    {
        let turn = free.turn(dt);
        advice.warnings.push(format!(
            "a step is {turn:.2} rad of the fastest rate of the equations: it meets the tolerance, but may not resolve the motion"
        ));
    }
    if let Some((choice, dt)) = advice.chosen() {
        let method = Method::from_name(choice.integrator).unwrap_or(Method::Rk4);
        let narrow = free.lost_in(work, true, method, dt, f64::INFINITY)?;
        let wide = free.lost_in(work, false, method, dt, f64::INFINITY)?;
        advice.floats = floats(request, method, dt, [narrow, wide]);
        let narrow = advice.float().is_some_and(|float| float.float == f32::NAME);
        advice.throughput = Some(Throughput::measure(work, request, method, dt, narrow)?);
    }
    advice.verdict = advice.judge_integrators();
    let dynamics = request.system.equations.dynamics();
    let never = AtomicBool::new(false);
    let missed = narrow_force(dynamics, &free.start, request.horizon, &never);
    if let Some(time) = missed.ok().flatten().filter(|_| advice.verdict.is_good()) {
        advice.verdict = missed_force(time);
    }
    let answer = describe_integrator(&advice, request);
    advice.finish(request, answer);
    Ok(advice)
}

fn floats(request: &Request, method: Method, dt: f64, lost: [f64; 2]) -> Vec<FloatChoice> {
    let most = request.tolerance.most;
    let of = |(float, lost): (&'static str, f64)| {
        let command = request.simulation(method.name(), dt, float);
        let of = match request.tolerance.of {
            Measure::Cost => Measure::Trajectory,
            of => of,
        };
        FloatChoice { float, lost, of: of.name(), meets: lost <= most, command }
    };
    [f32::NAME, f64::NAME].into_iter().zip(lost).map(of).collect()
}

impl<M: PlantModel> LoopSimulation<'_, M> {
    /// The errors of the float types with `substeps` steps per period.
    fn floats(
        &self,
        work: &Work<'_>,
        request: &Request,
        method: Method,
        substeps: u64,
    ) -> Result<Vec<FloatChoice>, AdviseError> {
        // A cost depends on steps alone; rounding affects the trajectory.
        let tolerance = Tolerance { of: Measure::Trajectory, ..request.tolerance };
        let course = LoopSimulation { tolerance, ..*self };
        let reference = course.reference(work)?;
        let lost = [
            course.lost::<f32>(work, method, substeps, &reference)?,
            course.lost::<f64>(work, method, substeps, &reference)?,
        ];
        let dt = self.one.control.period / substeps as f64;
        let mut all = floats(request, method, dt, lost);
        if request.tolerance.of == Measure::Cost {
            // The tolerance does not include the error of the integrator in the trajectory.
            for float in &mut all {
                float.meets = float.lost <= lost[1] + request.tolerance.most;
            }
        }
        Ok(all)
    }
}

/// Adds the largest step of each integrator for a loop, and the float types for the best.
fn integrators<M: PlantModel>(
    work: &Work<'_>,
    one: &Loop<M>,
    request: &Request,
    advice: &mut Advice,
) -> Result<(), AdviseError> {
    let stepped = LoopSimulation { one, horizon: request.horizon, tolerance: request.tolerance };
    let reference = stepped.reference(work)?;
    // With an infinite cost the errors of integrators are undefined.
    let methods = if stepped.has_finite_cost()? { &Method::ALL[..] } else { &[] };
    let choices = work.sweep("the largest step of each integrator", methods, |&method| {
        stepped.choose(work, method, &reference)
    })?;
    advice.choose(request, choices);
    if let Some((choice, dt)) = advice.chosen() {
        let method = Method::from_name(choice.integrator).unwrap_or(Method::Rk4);
        advice.floats = stepped.floats(work, request, method, choice.substeps.unwrap_or(1))?;
        let narrow = advice.float().is_some_and(|float| float.float == f32::NAME);
        advice.throughput = Some(Throughput::measure(work, request, method, dt, narrow)?);
    }
    Ok(())
}

/// The advice on a loop.
pub(super) fn advise_loop<M: PlantModel>(
    work: &Work<'_>,
    model: M,
    control: &Control,
    request: &Request,
) -> Result<Advice, AdviseError> {
    let of = request.tolerance.of;
    if !matches!(of, Measure::Trajectory | Measure::Cost) {
        let why = "a loop does not conserve it; set a tolerance of trajectory or cost".into();
        return Err(AdviseError::Tolerance { of, why });
    }
    let one = Loop::new(model, request, control)?;
    let unstable = one.unstable()?;
    let one = one.with_critical_latency();
    let mut advice = Advice::new(request);
    if let Some(unstable) = unstable {
        let combined = one.combined_effect_unstable(request, &unstable)?;
        (advice.verdict, advice.answer) =
            unstable.judged(&one.timed, combined.growth, request.tolerance)?;
        let looped = LoopAdvice { remedies: unstable.remedies, ..one.advice(request, combined)? };
        if request.map {
            advice.map = Some(one.timed.map(work, None)?);
        }
        advice.looped = Some(looped);
        return Ok(advice);
    }
    let budgets = one.budgets(work, request)?;
    let combined = one.combined_effect(work, request, &budgets)?;
    let fails_first =
        one.timed.fails_first(&one.timed.subjects(false), &budgets).map_err(LoopError::from)?;
    let remedies = if combined.growth < 0.0 {
        integrators(work, &one, request, &mut advice)?;
        None
    } else {
        // No integrator follows a growing motion for long.
        Some(one.stabilising_changes(&one.timed.stated().map_err(LoopError::from)?))
    };
    advice.warnings.splice(0..0, loop_warnings(&one, &combined));
    let looped = LoopAdvice { budgets, fails_first, remedies, ..one.advice(request, combined)? };
    advice.verdict = looped.judged(&advice.tolerance, advice.chosen().is_some());
    if !request.system.is_linear() {
        let part = "motions so large that the linearisation at the start does not hold";
        advice.verdict = advice.verdict.without(part);
    }
    let mut answer = describe_loop(&looped, &advice.tolerance);
    if !advice.integrators.is_empty() {
        answer += &format!(" {}", describe_integrator(&advice, request));
    }
    let followed = simulated_horizon(request.horizon, control.period);
    let stable = looped.remedies.is_none();
    if stable && request.tolerance.of == Measure::Trajectory && request.horizon != followed {
        advice.warnings.push(format!(
            "the loop was simulated for {followed} s instead of the {} s of the request",
            request.horizon
        ));
    }
    advice.finish(request, answer);
    if request.map {
        advice.map = Some(one.timed.map(work, looped.budgets[0].stable_up_to)?);
    }
    advice.looped = Some(looped);
    Ok(advice)
}

impl<M: PlantModel> Loop<M> {
    /// The loop with the effect of its imperfections, without limits.
    fn advice(
        &self,
        request: &Request,
        combined: CombinedEffect,
    ) -> Result<LoopAdvice, AdviseError> {
        let rest = State { q: [request.system.q[0]], v: [0.0] };
        let [held] = self.model.model.on::<f64>().acceleration(&rest);
        let (actuation, units) = (request.actuation(), request.units());
        let gains = self.given_gains();
        Ok(LoopAdvice {
            controller: self.describe_controller(),
            command: actuation.name(),
            command_unit: units.command,
            gains: [gains.position, gains.velocity],
            gain_units: [units.gains[0], units.gains[1]],
            held_command: -held * actuation.mass(),
            period: self.control.period,
            stated: self.stated()? != Imperfections::NONE || self.control.record.is_some(),
            budgets: Vec::new(),
            combined,
            fails_first: None,
            remedies: None,
        })
    }
}

/// The budget of each imperfection of a loop.
pub(super) fn loop_budgets<M: PlantModel>(
    work: &Work<'_>,
    model: M,
    control: &Control,
    request: &Request,
) -> Result<Vec<Budget>, AdviseError> {
    let one = Loop::new(model, request, control)?;
    if let Some(UnstableLoop { motions: modes, help, .. }) = one.unstable()? {
        return Err(AdviseError::Unstable { modes, help });
    }
    one.with_critical_latency().budgets(work, request)
}
