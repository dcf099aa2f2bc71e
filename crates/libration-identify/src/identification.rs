//! The result of an identification.

use libration_report::Verdict;
use serde::Serialize;

use crate::bootstrap::BootstrapRow;
use crate::candidate::CandidateRow;
use crate::excitation::ExcitationRow;
use crate::hold::Hold;
use crate::likelihood_map::LikelihoodMap;
use crate::linearity::LinearityTests;
use crate::noise::NoiseKind;
use crate::parameters::Estimated;
use crate::residuals::ResidualTests;
use crate::start::Start;

/// How the response follows the command over time.
#[derive(Clone, Debug, Serialize)]
pub struct FitSeries {
    /// Times of the responses from the first command, in s.
    pub time: Vec<f64>,
    /// The responses.
    pub response: Vec<f64>,
    /// The response of the model to the commands alone.
    pub model: Vec<f64>,
    /// Innovations over their standard deviation.
    pub residual: Vec<f64>,
}

/// What a recording tells of a loop.
#[derive(Clone, Debug, Serialize)]
pub struct Identification {
    /// The answer in words.
    pub answer: String,
    /// Whether the residuals contradict the model, with the evidence and what was not examined.
    pub verdict: Verdict,
    /// What restricts it.
    pub warnings: Vec<String>,
    /// The name of the form of the response.
    pub response: &'static str,
    /// What the receiver makes of commands between their times.
    pub hold: Hold,
    /// The kind of noise.
    pub noise: NoiseKind,
    /// How commands arrive: `certain`, `jitter`, `loss` or `two-delays`.
    pub arrivals: &'static str,
    /// What is assumed before the first response.
    pub start: Start,
    /// Dead time, lag, their sum, gain, load and noise.
    pub parameters: Vec<Estimated>,
    /// The correlation of the errors of dead time and lag; `null` without a lag.
    pub correlation: Option<f64>,
    /// Tests of the residuals.
    pub residuals: ResidualTests,
    /// Tests of the residuals for levels and directions on which those of a linear plant do not depend.
    pub linearity: LinearityTests,
    /// Dead times that fit as well and are far from the estimate, in s: the nearest first.
    pub other_dead_times: Vec<f64>,
    /// Whether the residuals contradict the model, or more than 5 % of the commands are missing, so that its intervals cannot be trusted.
    pub is_contradicted: bool,
    /// All tried models, the best first.
    pub candidates: Vec<CandidateRow>,
    /// What simulated recordings of the fit give.
    pub bootstrap: Vec<BootstrapRow>,
    /// What other commands would tell.
    pub excitations: Vec<ExcitationRow>,
    /// The likelihood over dead time and lag.
    pub likelihood: Option<LikelihoodMap>,
    /// The fit over time; at most 4000 responses.
    pub fit: FitSeries,
    /// Whether the response depends on the command.
    pub depends_on_command: bool,
    /// The dead times that commands may have, in s: the interval of the dead time, with two standard deviations of jitter and the longer of
    /// two dead times; `null` if the recording excludes no long dead time, or the verdict is not good.
    pub delay_range: Option<[f64; 2]>,
    /// The plant behind the dead time, with its gain.
    pub state_space: StateSpace,
    /// The number of commands.
    pub commands: usize,
    /// The number of responses that were used.
    pub responses: usize,
    /// The median time between commands, in s.
    pub period: f64,
    /// The median time between responses, in s.
    pub interval: f64,
    /// The largest dead time that was tried, in s.
    pub largest_dead_time: f64,
    /// Evaluations of the likelihood that the search of a model may take.
    pub budget: u64,
    /// A command that repeats this identification.
    pub repeat_command: String,
    /// The version of Libration.
    pub libration_version: &'static str,
}

/// `ẋ = a x + b u`, `y = c x + d u`.
#[derive(Clone, Debug, Serialize)]
pub struct StateSpace {
    /// States × states.
    pub a: Vec<Vec<f64>>,
    /// One number for each state.
    pub b: Vec<f64>,
    /// One number for each state.
    pub c: Vec<f64>,
    /// The direct path.
    pub d: f64,
}

impl Identification {
    /// Whether numbers have intervals: those of a model that is contradicted, or not known to be right, would say nothing.
    pub fn has_intervals(&self) -> bool {
        self.verdict.is_good()
    }

    /// The range of dead times; of a dead time that is not known, only with its interval.
    pub(crate) fn dead_times(&self, known: Option<f64>) -> Option<[f64; 2]> {
        let value = |key: &str| self.parameter(key).map_or(0.0, |parameter| parameter.value);
        let dead_time = self.parameter("dead_time")?;
        let [low, high] = match dead_time.interval {
            Some(interval) => [interval.low, interval.high?],
            None => [known?; 2],
        };
        let jitter = 2.0 * value("jitter");
        Some([(low - jitter).max(0.0), (high + jitter).max(value("second_dead_time"))])
    }

    /// Whether the residuals contradict the model.
    pub(crate) fn contradicts_model(&self) -> bool {
        self.residuals.contradict() || self.linearity.contradict()
    }

    /// Whether there is a loop with a dead time that the recording decides.
    pub fn has_loop(&self) -> bool {
        self.depends_on_command && self.other_dead_times.is_empty() && !self.allows_any_delay()
    }

    /// Whether the likelihood excludes no large dead time.
    pub(crate) fn allows_any_delay(&self) -> bool {
        let own = self.parameter("dead_time");
        let interval = own.and_then(|own| own.interval.or(own.likelihood_interval));
        interval.is_some_and(|interval| interval.high.is_none())
    }

    /// The parameter of this key.
    pub fn parameter(&self, key: &str) -> Option<&Estimated> {
        self.parameters.iter().find(|parameter| parameter.key == key)
    }
}
