//! The results of advice.

use std::collections::BTreeMap;

use libration::Method;
use libration::live::Setting;
use libration_report::verdict::Verdict;
use serde::Serialize;

use super::budget::{Budget, FirstFailure};
use super::combined_effect::CombinedEffect;
use super::integrator_choice::{IntegratorChoice, SearchExtent, evaluations, sort_by_cost};
use super::live_setting;
use super::request::{Measure, Request, Tolerance};
use super::stabilising_changes::StabilisingChanges;
use super::stability_map::StabilityMap;
use super::throughput::Throughput;

/// The advice on a simulation or a loop; the fields are the keys of `advise --json`.
#[derive(Clone, Debug, Serialize)]
pub struct Advice {
    /// The answer in a sentence or two.
    pub answer: String,
    /// Whether the loop is stable and within the tolerance, and an integrator keeps it.
    pub verdict: Verdict,
    /// The warnings, most urgent first.
    pub warnings: Vec<String>,
    /// The system.
    pub system: String,
    /// Its parameters.
    pub parameters: BTreeMap<String, f64>,
    /// Initial positions, or those of the operating point.
    pub q: Vec<f64>,
    /// Initial velocities.
    pub v: Vec<f64>,
    /// The tolerance.
    pub tolerance: ToleranceAnswer,
    /// The horizon, in s.
    pub horizon: f64,
    /// The advice on the loop, if there is one.
    #[serde(rename = "loop")]
    pub looped: Option<LoopAdvice>,
    /// Every integrator with its largest step, cheapest first.
    pub integrators: Vec<IntegratorChoice>,
    /// A command that takes the advised steps; none without advised steps.
    pub command: Option<String>,
    /// What the search of integrators covers; none for a loop.
    pub search: Option<SearchExtent>,
    /// The shortest tried step, in s, if no step meets the tolerance and a shorter one may.
    pub tried_down_to: Option<f64>,
    /// The disadvantage of the second integrator; none without one.
    pub runner_up: Option<String>,
    /// The errors of the float types with the first integrator.
    pub floats: Vec<FloatChoice>,
    /// Memory and speed of rollouts with it.
    pub throughput: Option<Throughput>,
    /// A command that repeats this advice, with its simulations and measurements.
    pub repeat_command: String,
    /// The stability map of the loop, if the request asks for it.
    #[serde(skip)]
    pub map: Option<StabilityMap>,
    /// The setting of the live section of the page; none where the loop has none.
    #[serde(skip)]
    pub live: Option<Setting>,
}

/// A tolerance.
#[derive(Clone, Debug, Serialize)]
pub struct ToleranceAnswer {
    /// The name of the measure.
    pub of: &'static str,
    /// The largest allowed value.
    pub most: f64,
    /// What an error of the energy is relative to, in its unit: the mean kinetic energy of the motion; none for other measures.
    pub scale: Option<f64>,
}

/// The advice on a loop.
#[derive(Clone, Debug, Serialize)]
pub struct LoopAdvice {
    /// The controller with its gains, in words.
    pub controller: String,
    /// The quantity of commands: `force` if the mass of the system is given, else `acceleration`.
    pub command: &'static str,
    /// The unit of commands.
    pub command_unit: &'static str,
    /// Gains of position and velocity; with an observer those of the estimates.
    pub gains: [f64; 2],
    /// Their units.
    pub gain_units: [&'static str; 2],
    /// The command that holds the operating point.
    pub held_command: f64,
    /// The sampling period, in s.
    pub period: f64,
    /// Whether the request states any imperfection.
    pub stated: bool,
    /// The budget of each imperfection.
    pub budgets: Vec<Budget>,
    /// The effect of all stated imperfections together.
    pub combined: CombinedEffect,
    /// The stated imperfection that fails first.
    pub fails_first: Option<FirstFailure>,
    /// Changes that stabilise the loop, if it is unstable.
    pub remedies: Option<StabilisingChanges>,
}

/// The error of a float type.
#[derive(Clone, Debug, Serialize)]
pub struct FloatChoice {
    /// The float type.
    pub float: &'static str,
    /// The error with it.
    pub lost: f64,
    /// The measure of the error: that of the tolerance, or the trajectory if that is a cost.
    pub of: &'static str,
    /// Whether the error meets the tolerance.
    pub meets: bool,
    /// A command that takes the steps in this float type.
    pub command: String,
}

impl LoopAdvice {
    /// Whether the loop is stable as stated, and unstable with less of an imperfection.
    pub fn is_in_window(&self) -> bool {
        let is_stable = self.combined.growth < 0.0;
        // A loop that is unstable without imperfections has no budgets.
        is_stable
            && (self.budgets.is_empty() || self.budgets.iter().any(|own| own.regained.is_some()))
    }

    /// Whether the cost of the loop exceeds a tolerance of the cost.
    pub(super) fn exceeds_tolerated_cost(&self, tolerance: &ToleranceAnswer) -> bool {
        let rise = self.combined.cost_increase;
        tolerance.of == Measure::Cost.name() && rise.is_none_or(|rise| rise > tolerance.most)
    }
}

impl Advice {
    /// Whether the loop is stable within the tolerance, and an integrator meets it.
    pub fn holds(&self) -> bool {
        self.verdict.is_good()
    }

    pub(super) fn new(request: &Request) -> Self {
        let Tolerance { of, most } = request.tolerance;
        Advice {
            answer: String::new(),
            verdict: Verdict::unknown("not computed"),
            warnings: Vec::new(),
            system: request.system.name.clone(),
            parameters: request.system.definitions.parameters.iter().cloned().collect(),
            q: request.system.q.clone(),
            v: request.system.v.clone(),
            tolerance: ToleranceAnswer { of: of.name(), most, scale: None },
            horizon: request.horizon,
            looped: None,
            integrators: Vec::new(),
            command: None,
            search: None,
            tried_down_to: None,
            runner_up: None,
            floats: Vec::new(),
            throughput: None,
            repeat_command: request.invocation.clone(),
            map: None,
            live: live_setting::of_request(request),
        }
    }

    /// The advised integrator and step, if any meets the tolerance.
    pub fn chosen(&self) -> Option<(&IntegratorChoice, f64)> {
        self.integrators.first().and_then(|choice| Some((choice, choice.dt?)))
    }

    /// Sets the answer, the caveats of the integrators, and the command.
    pub(super) fn finish(&mut self, request: &Request, answer: String) {
        self.answer = answer;
        let listed =
            self.integrators.iter().filter_map(|choice| Method::from_name(choice.integrator));
        self.warnings.extend(listed.filter_map(|method| request.system.caveat(method)));
        let float = self.float().map_or("f64", |float| float.float);
        self.command =
            self.chosen().map(|(choice, dt)| request.command(choice.integrator, dt, float));
    }

    /// Sorts the integrators by cost, and sets the runner-up and warnings.
    pub(super) fn choose(&mut self, request: &Request, mut choices: Vec<IntegratorChoice>) {
        let dynamics = request.system.equations.dynamics();
        for choice in &mut choices {
            let method = Method::from_name(choice.integrator);
            let each = method.map(|method| evaluations(method, dynamics));
            choice.evaluations = each.zip(choice.dt).map(|(each, dt)| each as f64 / dt);
        }
        sort_by_cost(&mut choices);
        self.runner_up = match &choices[..] {
            [
                IntegratorChoice { evaluations: Some(first), .. },
                IntegratorChoice { integrator, evaluations: Some(second), dt: Some(dt), .. },
                ..,
            ] => Some(format!(
                "{integrator} would take {:.3} times as many force evaluations, in steps of {dt:.4e} s",
                second / first
            )),
            _ => None,
        };
        if choices.first().is_some_and(|best| best.dt.is_none()) {
            let least = choices.iter().min_by(|a, b| a.lost.total_cmp(&b.lost));
            if let (Some(least), Some(shortest)) = (least, self.tried_down_to) {
                let loses = match least.lost.is_finite() {
                    true => format!(
                        "the error of {} still decreases ({:.3e})",
                        least.integrator, least.lost
                    ),
                    false => "no integrator follows the motion".to_owned(),
                };
                self.warnings.push(format!(
                    "over this horizon the search ends at steps of {shortest:.4e} s, where {loses}; shorter steps may meet the \
                     tolerance of {:e}",
                    request.tolerance.most
                ));
            } else if let Some(least) = least {
                let most = request.tolerance.most;
                let best = match least.best_dt.filter(|_| least.lost.is_finite()) {
                    Some(dt) => format!(
                        "the best possible is {:.3e}, with {} in steps of {dt:.4e} s",
                        least.lost, least.integrator
                    ),
                    None => "each tried step loses the motion".to_owned(),
                };
                self.warnings.push(format!(
                    "no integrator meets the tolerance of {most:e} with any tried step; {best}"
                ));
            }
        }
        self.integrators = choices;
    }

    /// Warns of integrators that meet the tolerance with the longest step that was tried.
    pub(super) fn warn_of_limits(&mut self, longest: f64) {
        let most = self.tolerance.most;
        let ended =
            |choice: &&IntegratorChoice| choice.lost_beyond.is_some_and(|lost| lost <= most);
        let names: Vec<&str> =
            self.integrators.iter().filter(ended).map(|c| c.integrator).collect();
        if !names.is_empty() {
            self.warnings.push(format!(
                "steps of more than {longest:.4e} s were not tried: 4 rad of the motion, or the horizon; longer ones of {} may meet the \
                 tolerance, too",
                names.join(", ")
            ));
        }
    }

    /// The narrowest float that meets the tolerance.
    pub(super) fn float(&self) -> Option<&FloatChoice> {
        self.floats.iter().find(|float| float.meets)
    }
}
