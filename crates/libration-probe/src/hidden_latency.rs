//! Latency of commands that nobody stated: by calls that come late, and by the phase of the step.

use libration::linear::{Complex64, Discretisation, Matrix, solve};
use serde::Serialize;

use crate::flow::Flow;
use crate::linearised_step::LinearisedStep;
use crate::{DelayAudit, MeasuredDelay, Memory, Subject};

/// Steps per period of the frequencies at which phases are compared; the result is the middle one, as one may be at a resonance.
const STEPS_PER_PERIOD: [f64; 3] = [12.0, 20.0, 33.0];

/// The latency of one input.
#[derive(Clone, Debug, Serialize)]
pub struct HiddenLatency {
    /// The name of the input.
    pub input: String,
    /// Steps by which a command is used late, on average; 0: by the step that gets it. None if this was not examined.
    pub late_steps: Option<f64>,
    /// The same in s.
    pub late: Option<f64>,
    /// The state that responds most, whose phase is compared.
    pub state: Option<String>,
    /// The delay in s beyond that of the flow under the same held command, by the phase of the step; negative: it is early. None
    /// without the flow, or without an effect.
    pub integrator_delay: Option<f64>,
    /// The sum of both in s.
    pub total: Option<f64>,
}

/// The inputs that the adapter has measured, unless the audit of many steps knows more of a delay that changes.
pub(crate) fn measured_inputs<'a>(
    subject: &'a Subject,
    delays: &[DelayAudit],
) -> impl Iterator<Item = &'a MeasuredDelay> {
    let is_known = delays.iter().any(|audit| audit.first_change.is_some());
    subject.measured_inputs.iter().filter(move |input| !(is_known && input.varies))
}

/// The latency of each input.
pub(crate) fn hidden_latencies(
    step: &LinearisedStep,
    flow: Option<&Flow>,
    memory: &Memory,
    delays: &[DelayAudit],
    pairs: Option<&[(usize, usize)]>,
    subject: &Subject,
) -> Vec<HiddenLatency> {
    let exact = flow.map(|flow| Discretisation::exact(&flow.a, &flow.b, step.dt));
    let of = |j: usize| {
        let by_phase = exact.as_ref().and_then(|exact| delay(step, exact, pairs, subject, j));
        let name = &subject.inputs[j].name;
        let is_known = !subject.direct_inputs.contains(name);
        let late_steps = is_known.then(|| memory.latency(j, delays));
        let integrator_delay = by_phase.as_ref().map(|(_, delay)| *delay);
        HiddenLatency {
            input: name.clone(),
            late_steps,
            late: late_steps.map(|late| late * step.dt),
            state: by_phase.map(|(i, _)| subject.states[i].name.clone()),
            integrator_delay,
            total: late_steps.map(|late| late * step.dt + integrator_delay.unwrap_or(0.0)),
        }
    };
    let measured = measured_inputs(subject, delays).map(|input| HiddenLatency {
        input: input.name.clone(),
        late_steps: Some(input.late_steps),
        late: Some(input.late_steps * step.dt),
        state: None,
        integrator_delay: None,
        total: Some(input.late_steps * step.dt),
    });
    (0..subject.inputs.len()).map(of).chain(measured).collect()
}

/// The state that responds most to an input, and by how much it is later than in an exact step.
fn delay(
    step: &LinearisedStep,
    exact: &Discretisation,
    pairs: Option<&[(usize, usize)]>,
    subject: &Subject,
    input: usize,
) -> Option<(usize, f64)> {
    let turn = |steps: f64| core::f64::consts::TAU / steps;
    let respond = |a: &Matrix, b: &Matrix, angle: f64| response(a, b, input, angle);
    let middle = respond(&exact.phi, &exact.gamma, turn(STEPS_PER_PERIOD[1]));
    let candidates: Vec<usize> = match pairs {
        Some(pairs) => pairs.iter().map(|(q, _)| *q).collect(),
        None => (0..step.a.rows()).collect(),
    };
    let size = |i: usize| middle[i].norm() / subject.state_scale[i];
    let state = candidates.into_iter().max_by(|&i, &j| size(i).total_cmp(&size(j)))?;
    let mut delays: Vec<f64> = STEPS_PER_PERIOD
        .iter()
        .map(|steps| {
            let angle = turn(*steps);
            let own = respond(&step.a, &step.b, angle)[state];
            let wanted = respond(&exact.phi, &exact.gamma, angle)[state];
            (wanted / own).arg() / angle * step.dt
        })
        .filter(|delay| delay.is_finite())
        .collect();
    delays.sort_by(f64::total_cmp);
    delays.get(delays.len() / 2).map(|delay| (state, *delay))
}

/// `(z − A)⁻¹ b` at `z = e^{iφ}`.
fn response(a: &Matrix, b: &Matrix, input: usize, angle: f64) -> Vec<Complex64> {
    let z = Complex64::from_polar(1.0, angle);
    let row = |i: usize| -> Vec<Complex64> {
        let entry =
            |j: usize| (if i == j { z } else { Complex64::ZERO }) - Complex64::from(a[(i, j)]);
        (0..a.rows()).map(entry).chain([Complex64::from(b[(i, input)])]).collect()
    };
    solve((0..a.rows()).map(row).collect(), |x: Complex64| x.norm())
}
