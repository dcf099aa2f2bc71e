//! The audit of a step, and its results.

use libration::analysis::positions_and_velocities;
use libration_report::verdict::Verdict;
use serde::Serialize;

use crate::action_response::uneven_response;
use crate::driven_velocity::{DrivenVelocity, driven_velocities};
use crate::finding::Finding;
use crate::flow::Flow;
use crate::hidden_latency::{HiddenLatency, hidden_latencies};
use crate::linear_candidates::match_matrices;
use crate::linearised_step::LinearisedStep;
use crate::matrices::{Matrices, modified_flow};
use crate::modes::{ProbedMode, modes};
use crate::prober::Prober;
use crate::reference_check::ReferenceCheck;
use crate::rest::Rest;
use crate::{
    Bits, BlackBoxError, Confirmation, Convergence, Defects, DelayAudit, InnerStep, LargestStep,
    Match, Memory, OperatingPoint, Recognition, Subject,
};

/// Largest relative error of a row at which the step counts as differentiable.
const DIFFERENTIABLE: f64 = 0.01;

/// The results of an audit; the fields are the keys of `probe --json`.
#[derive(Clone, Debug, Serialize)]
pub struct ProbeReport {
    /// The answer in a few sentences.
    pub answer: String,
    /// Whether the step has a fault, with the evidence and what was not examined.
    pub verdict: Verdict,
    /// Faults of the step, and facts without which its numbers mislead. A clean step has none.
    pub findings: Vec<Finding>,
    /// The simulator.
    pub title: String,
    /// The simulator with its version, if it is known.
    pub version: Option<String>,
    /// The version of libration.
    pub libration_version: &'static str,
    /// The length of a step, in s.
    pub dt: f64,
    /// Names of the states with units.
    pub states: Vec<String>,
    /// Names of the inputs.
    pub inputs: Vec<String>,
    /// The state at which the step is linearised.
    pub state: Vec<f64>,
    /// The action there.
    pub action: Vec<f64>,
    /// What the simulator says of itself, such as its integrator and its contacts.
    pub notes: Vec<String>,
    /// Whether its author says that the system conserves energy.
    pub is_conservative: bool,
    /// Whether the state is an equilibrium.
    pub equilibrium: Rest,
    /// Where it is from the requested state, if it was searched for.
    pub operating_point: Option<OperatingPoint>,
    /// Whether half a step gives the same bits as a step.
    pub ignores_dt: bool,
    /// Inner steps of a fixed length; none if there is no evidence of them.
    pub inner_step: Option<InnerStep>,
    /// The matrices of the step; none if it is not reproducible.
    pub step: Option<Matrices>,
    /// The largest estimated error of an entry, relative to the largest entry of its row in units of the scales.
    pub jacobian_error: f64,
    /// That of derivatives by states only.
    #[serde(skip)]
    pub(crate) state_error: f64,
    /// Inputs by which the step has no derivative at the action.
    pub unclear_inputs: Vec<String>,
    /// Why the effects of inputs are not known: the step does not respond to them, or not in proportion.
    pub uneven_responses: Vec<String>,
    /// The rates in the limit of small steps; none if the step has one length only.
    pub flow: Option<Matrices>,
    /// The system in continuous time whose exact flow the step is, with all its numerical damping: the logarithm of the step. None if a
    /// mode changes its sign from step to step, or ends in one.
    pub modified_flow: Option<Matrices>,
    /// A short run beside the linear prediction.
    pub confirmation: Option<Confirmation>,
    /// Derivatives of the simulator beside differences of its step.
    pub reference: Option<ReferenceCheck>,
    /// The modes, the one that grows fastest first.
    pub modes: Vec<ProbedMode>,
    /// The largest factor of a mode per step.
    pub spectral_radius: f64,
    /// The longest stable step.
    pub largest_dt: Option<LargestStep>,
    /// Velocities whose rates grow with them.
    pub driven_velocities: Vec<DrivenVelocity>,
    /// The latency of each input.
    pub hidden_latency: Vec<HiddenLatency>,
    /// What results depend on besides the given state and action.
    pub memory: Option<Memory>,
    /// Which command each step uses, of inputs whose commands wait in a queue.
    pub delays: Vec<DelayAudit>,
    /// The order of convergence.
    pub order: Option<Convergence>,
    /// The integrator, by its results.
    pub recognition: Option<Recognition>,
    /// Defects of volume, symplecticity, reversibility and energy.
    pub defects: Option<Defects>,
    /// Whether the same call gives the same bits.
    pub bits: Bits,
    /// States that were stepped.
    pub calls: u64,
    /// The command that repeats the audit.
    pub repeat_command: String,
}

impl ProbeReport {
    pub(crate) fn empty(subject: &Subject, bits: Bits) -> Self {
        let mut notes = subject.notes.clone();
        if let Some(integrator) = &subject.integrator {
            notes.insert(0, format!("the simulator calls its integrator {integrator}"));
        }
        ProbeReport {
            answer: String::new(),
            verdict: Verdict::unknown(String::new()),
            findings: Vec::new(),
            title: subject.title.clone(),
            version: subject.version.clone(),
            libration_version: env!("CARGO_PKG_VERSION"),
            dt: subject.dt,
            states: (0..subject.states.len()).map(|i| subject.state_name(i)).collect(),
            inputs: subject.inputs.iter().map(crate::subject::with_unit).collect(),
            state: subject.state.clone(),
            action: subject.action.clone(),
            notes,
            is_conservative: subject.is_conservative,
            equilibrium: Rest {
                holds: false,
                stated: None,
                change: f64::NAN,
                state: String::new(),
            },
            operating_point: subject.operating_point.clone(),
            ignores_dt: false,
            inner_step: None,
            step: None,
            jacobian_error: f64::INFINITY,
            state_error: f64::INFINITY,
            unclear_inputs: Vec::new(),
            uneven_responses: Vec::new(),
            flow: None,
            modified_flow: None,
            confirmation: None,
            reference: None,
            modes: Vec::new(),
            spectral_radius: f64::NAN,
            largest_dt: None,
            driven_velocities: Vec::new(),
            hidden_latency: Vec::new(),
            memory: None,
            delays: Vec::new(),
            order: None,
            recognition: None,
            defects: None,
            bits,
            calls: 0,
            repeat_command: subject.invocation.clone(),
        }
    }

    /// All measurements of a step that is reproducible.
    pub(crate) fn audit(
        &mut self,
        prober: &mut Prober<'_>,
        memory: &Memory,
    ) -> Result<(), BlackBoxError> {
        let subject = prober.subject;
        self.equilibrium = Rest::measure(prober)?;
        let has_fixed_dt = subject.has_fixed_dt || {
            self.inner_step = InnerStep::measure(prober)?;
            self.ignores_dt = self.inner_step.is_none() && ignores_dt(prober)?;
            self.ignores_dt || self.inner_step.is_some()
        };
        let mut step = LinearisedStep::at(prober, subject.dt)?;
        self.jacobian_error = step.relative_error(subject);
        self.state_error = step.relative_error_of_states(subject);
        if !step.is_finite() {
            return Ok(());
        }
        let unclear = step.unclear_inputs(subject).into_iter();
        self.unclear_inputs = unclear.map(|j| subject.inputs[j].name.clone()).collect();
        for j in 0..subject.inputs.len() {
            self.uneven_responses.extend(uneven_response(prober, &step, j)?);
        }
        for (j, input) in memory.inputs.iter().enumerate().take(subject.inputs.len()) {
            let is_late = input.last.unwrap_or(0) > 0;
            let audit = DelayAudit::run(prober, &step, j, is_late)?;
            // A command that is always in time needs no table.
            self.delays.extend(audit.filter(|audit| is_late || audit.first_change.is_some()));
        }
        self.reference = ReferenceCheck::of(subject, &step);
        if let Some(reference) = &self.reference {
            reference.refine(subject, &mut step);
            self.jacobian_error = step.relative_error(subject);
        }
        let flow = if has_fixed_dt { None } else { Flow::of(prober, &step)? };
        let detected = flow.as_ref().and_then(|flow| positions_and_velocities(&flow.cleaned()));
        let pairs = subject.pairs.clone().or(detected);
        let pairs = pairs.as_deref();
        self.modes = modes(&step, flow.as_ref(), subject);
        self.spectral_radius = self.modes.iter().map(|mode| mode.radius).fold(0.0, f64::max);
        self.confirmation = Some(Confirmation::run(prober, &step)?);
        if let Some(flow) = &flow {
            self.largest_dt = Some(LargestStep::search(prober, flow, self.equilibrium.holds)?);
            self.driven_velocities = driven_velocities(flow, pairs, subject);
        }
        self.hidden_latency =
            hidden_latencies(&step, flow.as_ref(), memory, &self.delays, pairs, subject);
        if !has_fixed_dt {
            let order = Convergence::measure(prober)?;
            let by_results = Match::by_results(prober, pairs, order.order)?;
            let known_order = order.order;
            self.order = Some(order);
            let by_matrix = flow.as_ref().filter(|_| self.equilibrium.holds).and_then(|flow| {
                match_matrices(&step, flow, &flow.cleaned(), pairs, subject, known_order)
            });
            self.recognition = Some(Recognition { by_results, by_matrix });
        }
        self.defects =
            Some(Defects::measure(prober, &step, flow.as_ref(), pairs, self.equilibrium.holds)?);
        self.modified_flow = modified_flow(&step);
        self.flow = flow.map(|flow| Matrices { a: flow.a, b: flow.b, a_errors: flow.a_errors });
        self.step = Some(Matrices { a: step.a, b: step.b, a_errors: step.a_errors });
        Ok(())
    }

    /// Whether the step has a derivative by the states.
    pub fn is_differentiable(&self) -> bool {
        self.state_error <= DIFFERENTIABLE
    }

    /// Whether the verdict is good: what was examined has no fault, and decides.
    pub fn holds(&self) -> bool {
        self.verdict.is_good()
    }
}

fn ignores_dt(prober: &mut Prober<'_>) -> Result<bool, BlackBoxError> {
    let subject = prober.subject;
    let start = crate::convergence::displaced(prober, 0.1);
    let full = prober.step_one(&start, &subject.action, subject.dt)?;
    let half = prober.step_one(&start, &subject.action, subject.dt / 2.0)?;
    Ok(full == half && full != start)
}
