//! The answer, as it is printed.

use std::collections::BTreeMap;

use libration::analysis::Imperfections;
use libration::{Float, Method, Model, State, System};
use serde::Serialize;

use super::choice::{Choice, by_cost, evaluations, largest_step};
use super::free::Free;
use super::limits::{Kind, Limit};
use super::loops::{Loop, LoopError};
use super::map::Map;
use super::request::{Control, Law, Measure, Request, Tolerance};
use super::stepped::Stepped;
use super::together::Together;
use super::{AdviseError, Throughput};
use crate::Lab;
use crate::study::StudyError;

/// The budget of a simulation or a loop; the fields are the keys of `advise --json`.
#[derive(Clone, Debug, Serialize)]
pub struct Advice {
    /// The answer in a sentence or two.
    pub answer: String,
    /// What must be known besides, most urgent first.
    pub warnings: Vec<String>,
    /// The system.
    pub system: &'static str,
    /// Its parameters.
    pub parameters: BTreeMap<&'static str, f64>,
    /// Positions at the start, or at the operating point.
    pub q: Vec<f64>,
    /// Velocities there.
    pub v: Vec<f64>,
    /// What is tolerated.
    pub tolerance: ToleranceAnswer,
    /// For how long, in s.
    pub horizon: f64,
    /// The loop, if there is one.
    #[serde(rename = "loop")]
    pub looped: Option<LoopAdvice>,
    /// Every integrator with its largest step, the cheapest first.
    pub integrators: Vec<Choice>,
    /// Why the second of them lost; none where there is no second.
    pub runner_up: Option<String>,
    /// What the float types lose with the first of them.
    pub floats: Vec<FloatChoice>,
    /// What rollouts take with it.
    pub throughput: Option<Throughput>,
    /// Where a loop is stable, if that was asked for.
    #[serde(skip)]
    pub map: Option<Map>,
}

/// What is tolerated.
#[derive(Clone, Debug, Serialize)]
pub struct ToleranceAnswer {
    /// Of what.
    pub of: &'static str,
    /// How much.
    pub most: f64,
}

/// What a loop stands.
#[derive(Clone, Debug, Serialize)]
pub struct LoopAdvice {
    /// Who commands, with its gains.
    pub controller: String,
    /// Gains of position and velocity; of an observer those of what is estimated.
    pub gains: [f64; 2],
    /// The command that holds the operating point, in m/s².
    pub held_command: f64,
    /// Between two samples, in s.
    pub period: f64,
    /// What it stands of each imperfection alone.
    pub budgets: Vec<Budget>,
    /// What is left where all that is stated acts together.
    pub together: Together,
    /// Which fails first, of those that are stated.
    pub fails_first: Option<Failing>,
}

/// What a loop stands of an imperfection alone.
#[derive(Clone, Debug, Serialize)]
pub struct Budget {
    /// Which.
    pub kind: Kind,
    /// The unit of its sizes.
    pub unit: &'static str,
    /// How much of it is stated.
    pub stated: f64,
    /// Up to here the loop is stable; none where no end was found.
    pub stable_up_to: Option<f64>,
    /// Up to here the cost is tolerated, if a cost is; none where no end was found.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerated_up_to: Option<Option<f64>>,
    /// The largest that was tried.
    pub tried_up_to: f64,
    /// What is stated over the smaller of the two limits; none without one.
    pub used: Option<f64>,
    /// How it was obtained.
    pub how: &'static str,
    /// A command that shows it.
    pub command: String,
}

/// What fails first, and how that looks.
#[derive(Clone, Debug, Serialize)]
pub struct Failing {
    /// Which.
    pub kind: Kind,
    /// The part of its budget that is used.
    pub used: f64,
    /// With which frequency the loop swings at the limit, in Hz; none where it does not, or where nothing is told of it.
    pub frequency: Option<f64>,
    /// In words.
    pub how: String,
}

/// What a float type loses.
#[derive(Clone, Debug, Serialize)]
pub struct FloatChoice {
    /// Which.
    pub float: &'static str,
    /// What is lost with it, in the measure of the tolerance.
    pub lost: f64,
    /// Whether that is tolerated.
    pub meets: bool,
}

impl Advice {
    fn new(request: &Request) -> Self {
        let Tolerance { of, most } = request.tolerance;
        Advice {
            answer: String::new(),
            warnings: Vec::new(),
            system: request.system.name(),
            parameters: request.system.parameters().into_iter().collect(),
            q: request.q.clone(),
            v: request.v.clone(),
            tolerance: ToleranceAnswer { of: of.name(), most },
            horizon: request.horizon,
            looped: None,
            integrators: Vec::new(),
            runner_up: None,
            floats: Vec::new(),
            throughput: None,
            map: None,
        }
    }

    /// The integrator and the step that are advised, if any meet the tolerance.
    pub fn chosen(&self) -> Option<(&Choice, f64)> {
        self.integrators.first().and_then(|choice| Some((choice, choice.dt?)))
    }

    /// Sets the integrators in order, and says why the second lost.
    fn choose(&mut self, request: &Request, mut choices: Vec<Choice>) {
        for choice in &mut choices {
            let method = Method::from_name(choice.integrator);
            let each = method.and_then(|m| evaluations(request.system, &request.q, &request.v, m));
            choice.evaluations = each.zip(choice.dt).map(|(each, dt)| each as f64 / dt);
        }
        by_cost(&mut choices);
        self.runner_up = match &choices[..] {
            [first, second, ..] => first.evaluations.zip(second.evaluations).map(|(a, b)| {
                format!(
                    "{} would take {:.3} times as many force evaluations, in steps of {:.4e} s",
                    second.integrator,
                    b / a,
                    second.dt.unwrap_or(f64::NAN)
                )
            }),
            _ => None,
        };
        if choices.first().is_some_and(|best| best.dt.is_none()) {
            let least = choices.iter().min_by(|a, b| a.lost.total_cmp(&b.lost));
            if let Some(least) = least {
                self.warnings.push(format!(
                    "no integrator meets the tolerance of {:e} with any step that was tried; the best possible is {:.3e}, \
                     with {}",
                    request.tolerance.most, least.lost, least.integrator
                ));
            }
        }
        self.integrators = choices;
    }

    /// The narrowest float that meets the tolerance.
    fn float(&self) -> Option<&FloatChoice> {
        self.floats.iter().find(|float| float.meets)
    }
}

/// The advice on a system that nobody controls.
pub(super) fn free<M: Model<D>, const D: usize>(
    lab: &Lab<'_>,
    model: M,
    request: &Request,
) -> Result<Advice, AdviseError> {
    let free = Free::new(model, request)?;
    let mut advice = Advice::new(request);
    let most = request.tolerance.most;
    let choices = lab.sweep("the largest step of each integrator", &Method::ALL, |&method| {
        largest_step(lab, &free, method, most, free.steps()).map_err(unwrapped)
    })?;
    advice.choose(request, choices);
    if let Some((choice, dt)) = advice.chosen() {
        let method = Method::from_name(choice.integrator).unwrap_or(Method::Rk4);
        let narrow = free.lost_in::<f32>(lab, method, dt, f64::INFINITY)?;
        let wide = free.lost_in::<f64>(lab, method, dt, f64::INFINITY)?;
        advice.floats = floats([narrow, wide], most);
        let narrow = advice.float().is_some_and(|float| float.float == f32::NAME);
        advice.throughput = Some(Throughput::measure(lab, request, method, dt, narrow)?);
    }
    advice.answer = advised(&advice, request);
    Ok(advice)
}

/// Errors of a search, as a sweep hands them on.
fn unwrapped(error: AdviseError) -> StudyError {
    match error {
        AdviseError::Study(error) => error,
        error => StudyError::Exact(format!("searching for a step: {error}")),
    }
}

fn floats(lost: [f64; 2], most: f64) -> Vec<FloatChoice> {
    let all = [f32::NAME, f64::NAME].into_iter().zip(lost);
    all.map(|(float, lost)| FloatChoice { float, lost, meets: lost <= most }).collect()
}

/// Which integrator is advised, in a sentence.
fn advised(advice: &Advice, request: &Request) -> String {
    let Tolerance { of, most } = request.tolerance;
    match advice.chosen() {
        None => format!(
            "No integrator keeps the {} below {most:e} over {} s.",
            of.title(),
            request.horizon
        ),
        Some((choice, dt)) => {
            let float = advice.float().map_or("no float type", |float| float.float);
            format!(
                "{} in steps of {dt:.4e} s, in {float}: the cheapest that keeps the {} below {most:e} over {} s.",
                choice.integrator,
                of.title(),
                request.horizon
            )
        }
    }
}

/// The advice on a loop.
pub(super) fn looped<M: Model<1>>(
    lab: &Lab<'_>,
    model: M,
    control: &Control,
    request: &Request,
) -> Result<Advice, AdviseError> {
    let one = Loop::new(model, request.q[0], control)?;
    let plant = one.plant();
    let none = Imperfections::NONE;
    let growth = plant.mean_square_growth(&one.linear, &none).map_err(LoopError::from)?;
    if growth >= 0.0 {
        let mode = plant.slowest_mode(&one.linear, &none).map_err(LoopError::from)?;
        let how = swings(mode.angle, control.period).1;
        return Err(AdviseError::Unstable { growth: mode.radius, how });
    }
    let mut advice = Advice::new(request);
    let stepped = Stepped { one: &one, horizon: request.horizon, tolerance: request.tolerance };
    let truth = stepped.truth(lab)?;
    let choices = lab.sweep("the largest step of each integrator", &Method::ALL, |&method| {
        stepped.choose(lab, method, &truth).map_err(unwrapped)
    })?;
    advice.choose(request, choices);
    if let Some((choice, dt)) = advice.chosen() {
        let method = Method::from_name(choice.integrator).unwrap_or(Method::Rk4);
        let substeps = choice.substeps.unwrap_or(1);
        // A cost follows from steps alone; what rounding does is seen in the course.
        let tolerance = Tolerance { of: Measure::Trajectory, ..request.tolerance };
        let course = Stepped { tolerance, ..stepped };
        let truth = course.truth(lab)?;
        let lost = [
            course.lost::<f32>(lab, method, substeps, &truth)?,
            course.lost::<f64>(lab, method, substeps, &truth)?,
        ];
        advice.floats = floats(lost, request.tolerance.most);
        if request.tolerance.of == Measure::Cost {
            // The integrator's own error of the course is no part of what is tolerated.
            for float in &mut advice.floats {
                float.meets = float.lost <= lost[1] + request.tolerance.most;
            }
        }
        let narrow = advice.float().is_some_and(|float| float.float == f32::NAME);
        advice.throughput = Some(Throughput::measure(lab, request, method, dt, narrow)?);
    }
    let budgets = lab.sweep("what the loop stands", &Kind::ALL, |&kind| {
        one.budget(kind, request).map_err(unwrapped)
    })?;
    let together = one.together(lab, &plant)?;
    let fails_first = one.fails_first(&budgets)?;
    let rest = State { q: [request.q[0]], v: [0.0] };
    let [held] = model.on::<f64>().acceleration(&rest);
    advice.warnings.splice(0..0, warnings(&one, request, &together));
    let looped = LoopAdvice {
        controller: one.told(),
        gains: {
            let gains = one.gains();
            [gains.position, gains.velocity]
        },
        held_command: -held,
        period: control.period,
        budgets,
        together,
        fails_first,
    };
    advice.answer = format!("{} {}", stands(&looped, request), advised(&advice, request));
    if request.map {
        advice.map = Some(one.map(lab, looped.budgets[0].stable_up_to)?);
    }
    advice.looped = Some(looped);
    Ok(advice)
}

/// Whether a loop stands what is stated, in a sentence or two.
fn stands(looped: &LoopAdvice, request: &Request) -> String {
    let Together { growth, room, cost_increase, .. } = looped.together;
    if growth >= 0.0 {
        return format!(
            "The loop does not stand what is stated: its second moments grow by {:.3} % a period.",
            100.0 * growth.exp_m1()
        );
    }
    let mut text = match (room, &looped.fails_first) {
        (Some(room), _) => {
            format!(
                "The loop stands what is stated, and all of it may become {room:.3} times as large."
            )
        }
        (None, Some(_)) => "The loop stands what is stated, and sixteen times as much.".to_owned(),
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
        let tolerated = match request.tolerance {
            Tolerance { of: Measure::Cost, most } if increase > most => {
                format!(", more than the {:.3} % that are tolerated", 100.0 * most)
            }
            _ => String::new(),
        };
        text +=
            &format!(" It costs {:.3} % more than the ideal loop{tolerated}.", 100.0 * increase);
    }
    text
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// What must be said loudly.
fn warnings<M: Model<1>>(one: &Loop<M>, request: &Request, together: &Together) -> Vec<String> {
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
        let off = (simulated.cost - simulated.predicted) / simulated.error;
        if off.abs() > 4.0 {
            warnings.push(format!(
                "the simulation contradicts the theory: it costs {:.5e} ± {:.1e}, and {:.5e} is predicted",
                simulated.cost, simulated.error, simulated.predicted
            ));
        }
    } else if together.growth < 0.0 {
        warnings.push(
            "the loop decays too slowly to be simulated: what is said follows from theory alone"
                .into(),
        );
    }
    let Control { period, .. } = one.control;
    let turn = (2.0 * one.plant().energy().position).sqrt() * period;
    if turn > 1.0 {
        warnings.push(format!(
            "the plant turns by {turn:.2} rad in a period: the loop samples it sparsely"
        ));
    }
    if one.control.record.is_some() {
        warnings.push(
            "the budget of jitter is that of a law with the rms of the time stamps, drawn anew for each step; the simulation \
             replays them as they are"
                .into(),
        );
    }
    let _ = request;
    warnings
}

/// The frequency of a motion that turns by `angle` in a period, and how it looks.
fn swings(angle: f64, period: f64) -> (Option<f64>, String) {
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

impl<M: Model<1>> Loop<M> {
    fn budget(&self, kind: Kind, request: &Request) -> Result<Budget, AdviseError> {
        let plant = self.plant();
        let Control { period, latency, jitter, skew, loss, .. } = self.control;
        let (unit, scale, stated) = match kind {
            Kind::Latency => ("s", period, latency),
            Kind::Jitter => ("relative rms", 1.0, jitter.rms()),
            Kind::Skew => ("part of a period", 1.0, skew.max(0.0)),
            Kind::Loss => ("probability", 1.0, loss),
        };
        let end = |limit: Limit| match limit {
            Limit::None => (Some(0.0), 0.0),
            Limit::At(size) => (Some(scale * size), scale * size),
            Limit::Beyond(size) => (None, scale * size),
        };
        let (stable, tried) = end(self.stable_up_to(&plant, kind)?);
        let tolerated =
            self.cheap_up_to(&plant, kind, request.tolerance)?.map(|limit| end(limit).0);
        let limit = [stable, tolerated.flatten()].into_iter().flatten().reduce(f64::min);
        Ok(Budget {
            kind,
            unit,
            stated,
            stable_up_to: stable,
            tolerated_up_to: tolerated,
            tried_up_to: tried,
            used: limit.filter(|&limit| limit > 0.0).map(|limit| stated / limit),
            how: match kind {
                Kind::Latency | Kind::Skew => {
                    "exact: the spectral radius of the sampled loop passes 1"
                }
                Kind::Jitter | Kind::Loss => "exact: second moments, E[M ⊗ M], begin to grow",
            },
            command: self.command(kind, limit, request),
        })
    }

    /// A command that shows a limit.
    fn command(&self, kind: Kind, limit: Option<f64>, request: &Request) -> String {
        let gains = match self.control.law {
            Law::Pd(gains) => gains,
            Law::Lqr(_) => self.gains(),
            _ => return "libration advise --config FILE --json".to_owned(),
        };
        let set: String = request
            .system
            .parameters()
            .into_iter()
            .map(|(name, value)| format!(" --set {name}={value}"))
            .collect();
        let law = match self.control.jitter {
            libration::analysis::Jitter::Gaussian(_) => "gaussian",
            libration::analysis::Jitter::Uniform(_) => "uniform",
        };
        let period = self.control.period;
        let (dt, flag) = match (kind, limit) {
            (Kind::Skew, Some(limit)) => (period * (1.0 + limit), String::new()),
            (Kind::Latency, Some(limit)) => (period, format!(" --latency {limit}")),
            (Kind::Jitter, Some(limit)) => (period, format!(" --jitter {law}:{limit}")),
            (Kind::Loss, Some(limit)) => (period, format!(" --loss {limit}")),
            (_, None) => (period, String::new()),
        };
        let integrator = if M::LINEAR { "exact" } else { "rk4" };
        format!(
            "libration analyze --system {}{set} --q {} --integrator {integrator} --dt {dt} --feedback {},{}{flag}",
            request.system.name(),
            request.q[0],
            gains.position,
            gains.velocity
        )
    }

    fn fails_first(&self, budgets: &[Budget]) -> Result<Option<Failing>, AdviseError> {
        let used = |budget: &&Budget| budget.used.is_some_and(|used| used > 0.0);
        let most =
            |a: &&Budget, b: &&Budget| a.used.unwrap_or(0.0).total_cmp(&b.used.unwrap_or(0.0));
        let Some(first) = budgets.iter().filter(used).max_by(most) else { return Ok(None) };
        let period = self.control.period;
        let (frequency, how) = match (first.kind, first.stable_up_to) {
            (Kind::Latency | Kind::Skew, Some(limit)) => {
                let size = if first.kind == Kind::Latency { limit / period } else { limit };
                let at = self.only(first.kind, size)?;
                let mode = self.plant().slowest_mode(&self.linear, &at).map_err(LoopError::from)?;
                let longer = 1.0 + at.skew;
                let (frequency, how) = swings(mode.angle, period * longer);
                (frequency, format!("at its limit {how}"))
            }
            (Kind::Jitter | Kind::Loss, Some(_)) => (
                None,
                "beyond its limit rare outbursts become so large that the mean square grows, while a typical run may still \
                 decay"
                    .to_owned(),
            ),
            _ => (None, "it costs too much before it becomes unstable".to_owned()),
        };
        let used = first.used.unwrap_or(0.0);
        Ok(Some(Failing { kind: first.kind, used, frequency, how }))
    }
}
