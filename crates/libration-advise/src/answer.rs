//! The answer, as it is printed.

use std::collections::BTreeMap;

use libration::Method;
use serde::Serialize;

use super::budget::{Budget, Failing};
use super::choice::{Choice, by_cost, evaluations};
use super::map::Map;
use super::remedies::Remedies;
use super::request::{Measure, Request, Tolerance};
use super::throughput::Throughput;
use super::together::Together;

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
    /// A command that takes the steps that are advised; none where none are.
    pub command: Option<String>,
    /// The shortest step that was tried, in s, where none meets the tolerance and a shorter one might.
    pub tried_down_to: Option<f64>,
    /// Why the second of them lost; none where there is no second.
    pub runner_up: Option<String>,
    /// What the float types lose with the first of them.
    pub floats: Vec<FloatChoice>,
    /// What rollouts take with it.
    pub throughput: Option<Throughput>,
    /// A command that says all of this again: what was simulated and measured, too.
    pub again: String,
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
    /// The quantity of commands: `force` where the mass of the system is given, else `acceleration`.
    pub command: &'static str,
    /// The unit of commands.
    pub command_unit: &'static str,
    /// Gains of position and velocity; of an observer those of what is estimated.
    pub gains: [f64; 2],
    /// Their units.
    pub gain_units: [&'static str; 2],
    /// The command that holds the operating point.
    pub held_command: f64,
    /// Between two samples, in s.
    pub period: f64,
    /// Whether anything is stated that is wrong with it.
    pub stated: bool,
    /// What it stands of each imperfection alone.
    pub budgets: Vec<Budget>,
    /// What is left where all that is stated acts together.
    pub together: Together,
    /// Which fails first, of those that are stated.
    pub fails_first: Option<Failing>,
    /// What would stabilise it, where it is unstable with what is stated.
    pub remedies: Option<Remedies>,
}

/// What a float type loses.
#[derive(Clone, Debug, Serialize)]
pub struct FloatChoice {
    /// Which.
    pub float: &'static str,
    /// What is lost with it.
    pub lost: f64,
    /// Of what: of what is tolerated, and of the trajectory where that is a cost.
    pub of: &'static str,
    /// Whether that is tolerated.
    pub meets: bool,
    /// A command that takes the steps in it.
    pub command: String,
}

impl LoopAdvice {
    /// Whether it costs more than is tolerated, if a cost is.
    pub(super) fn too_dear(&self, tolerance: &ToleranceAnswer) -> bool {
        let rise = self.together.cost_increase;
        tolerance.of == Measure::Cost.name() && rise.is_none_or(|rise| rise > tolerance.most)
    }
}

impl Advice {
    /// Whether all that is stated is stood and tolerated, and an integrator found.
    pub fn holds(&self) -> bool {
        let loop_holds = self.looped.as_ref().is_none_or(|looped| {
            let together = &looped.together;
            together.growth < 0.0 && !together.contradicted() && !looped.too_dear(&self.tolerance)
        });
        loop_holds && self.chosen().is_some()
    }

    pub(super) fn new(request: &Request) -> Self {
        let Tolerance { of, most } = request.tolerance;
        Advice {
            answer: String::new(),
            warnings: Vec::new(),
            system: request.system.name(),
            parameters: request.actuation.parameters(request.system).into_iter().collect(),
            q: request.q.clone(),
            v: request.v.clone(),
            tolerance: ToleranceAnswer { of: of.name(), most },
            horizon: request.horizon,
            looped: None,
            integrators: Vec::new(),
            command: None,
            tried_down_to: None,
            runner_up: None,
            floats: Vec::new(),
            throughput: None,
            again: request.asked_by.clone(),
            map: None,
        }
    }

    /// The integrator and the step that are advised, if any meet the tolerance.
    pub fn chosen(&self) -> Option<(&Choice, f64)> {
        self.integrators.first().and_then(|choice| Some((choice, choice.dt?)))
    }

    /// Says the answer, and how to take the steps that are advised.
    pub(super) fn conclude(&mut self, request: &Request, answer: String) {
        self.answer = answer;
        let listed =
            self.integrators.iter().filter_map(|choice| Method::from_name(choice.integrator));
        self.warnings.extend(listed.filter_map(|method| request.system.caveat(method)));
        let float = self.float().map_or("f64", |float| float.float);
        self.command =
            self.chosen().map(|(choice, dt)| request.command(choice.integrator, dt, float));
    }

    /// Sets the integrators in order, and says why the second lost.
    pub(super) fn choose(&mut self, request: &Request, mut choices: Vec<Choice>) {
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
            if let (Some(least), Some(shortest)) = (least, self.tried_down_to) {
                let loses = match least.lost.is_finite() {
                    true => format!(
                        "{} still loses less with each: {:.3e}",
                        least.integrator, least.lost
                    ),
                    false => "all lose the motion".to_owned(),
                };
                self.warnings.push(format!(
                    "over this horizon a search goes down to steps of {shortest:.4e} s, where {loses}; shorter ones may meet the \
                     tolerance of {:e}",
                    request.tolerance.most
                ));
            } else if let Some(least) = least {
                self.warnings.push(format!(
                    "no integrator meets the tolerance of {:e} with any step that was tried; the best possible is {:.3e}, \
                     with {} in steps of {:.4e} s",
                    request.tolerance.most,
                    least.lost,
                    least.integrator,
                    least.best_dt.unwrap_or(f64::NAN)
                ));
            }
        }
        self.integrators = choices;
    }

    /// The narrowest float that meets the tolerance.
    pub(super) fn float(&self) -> Option<&FloatChoice> {
        self.floats.iter().find(|float| float.meets)
    }
}
