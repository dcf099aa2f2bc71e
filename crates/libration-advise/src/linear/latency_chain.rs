//! The latency of a loop, part by part.

use core::f64::consts::TAU;

use libration::linear::Signal;
use serde::Serialize;

use super::LinearRequest;
use crate::budget::Budget;
use crate::imperfection::Imperfection;

/// A part of the latency of a loop.
#[derive(Clone, Debug, Serialize)]
pub struct ChainLink {
    /// The name of the part.
    pub part: String,
    /// The input or output in which it stands.
    pub channel: String,
    /// The delay at low frequencies, in s.
    pub delay: f64,
    /// The phase in degrees at the frequency at which the loop oscillates at its limit of latency; none without oscillation.
    pub phase: Option<f64>,
    /// The delay over the latency that the channel still tolerates, with lags, filters and hold as they are; none without a limit.
    pub share: Option<f64>,
}

impl LinearRequest {
    /// All parts, from the outputs to the inputs.
    pub(super) fn latency_chain(&self, budgets: &[Budget]) -> Vec<ChainLink> {
        let plant = self.timed.linear.plant();
        let frequency = |angle: f64| angle / (TAU * self.timed.period());
        let mut chain = Vec::new();
        // Of a cascade, from the outputs over the references to the inputs.
        for (j, output) in plant.outputs.iter().enumerate() {
            let (limit, angle) = limit(budgets, Imperfection::OutputLatency, &output.name);
            let frequency = angle.map(frequency);
            self.add_parts(&mut chain, &output.name, None, Some(j), frequency, limit);
            let late = self.timed.timing.output_latency[j];
            add_delay(&mut chain, "measurement", &output.name, late, frequency, limit);
        }
        self.add_references(&mut chain);
        for (i, input) in plant.inputs.iter().enumerate() {
            let (limit, angle) = limit(budgets, Imperfection::Latency, &input.name);
            let frequency = angle.map(frequency);
            let late = self.timed.timing.input_latency[i];
            add_delay(&mut chain, "command", &input.name, late, frequency, limit);
            let every = self.design.cascade.as_ref().map_or(1, |cascade| cascade.inner_every);
            let half = self.timed.period() * every as f64 / 2.0;
            add_delay(&mut chain, &hold(every), &input.name, half, frequency, limit);
            self.add_parts(&mut chain, &input.name, Some(i), None, frequency, limit);
        }
        chain
    }

    /// The delays of the references of a cascade. They have no limit of their own, and so no phase and no share.
    fn add_references(&self, chain: &mut Vec<ChainLink>) {
        let Some(cascade) = &self.design.cascade else { return };
        let period = self.timed.period();
        for Signal { name, .. } in &cascade.references {
            let late = period * cascade.outer_latency as f64;
            add_delay(chain, "outer latency", name, late, None, None);
            let half = period * cascade.outer_every as f64 / 2.0;
            add_delay(chain, &hold(cascade.outer_every), name, half, None, None);
        }
    }

    fn add_parts(
        &self,
        chain: &mut Vec<ChainLink>,
        channel: &str,
        input: Option<usize>,
        output: Option<usize>,
        frequency: Option<f64>,
        limit: Option<f64>,
    ) {
        for part in self.parts.iter().filter(|part| part.input == input && part.output == output) {
            let period = self.timed.period();
            let delay = part.delay(period);
            chain.push(ChainLink {
                part: part.name.clone(),
                channel: channel.to_owned(),
                delay,
                phase: frequency.map(|f| part.phase(TAU * f, period).to_degrees()),
                share: limit.map(|limit| delay / limit),
            });
        }
    }
}

/// The hold of what is computed every so many periods, in words.
fn hold(every: usize) -> String {
    match every {
        1 => "hold (half a period)".to_owned(),
        every => format!("hold (half of {every} periods)"),
    }
}

/// The largest stable latency of a channel in s, and the angle per period by which the loop turns there.
fn limit(budgets: &[Budget], kind: Imperfection, channel: &str) -> (Option<f64>, Option<f64>) {
    let own = |budget: &&Budget| {
        budget.kind == kind && budget.channel.as_deref().is_none_or(|name| name == channel)
    };
    let Some(budget) = budgets.iter().find(own) else { return (None, None) };
    match budget.stable_up_to.filter(|limit| *limit > 0.0) {
        Some(limit) => (Some(limit), budget.crossing_angle),
        None => (None, None),
    }
}

fn add_delay(
    chain: &mut Vec<ChainLink>,
    part: &str,
    channel: &str,
    delay: f64,
    frequency: Option<f64>,
    limit: Option<f64>,
) {
    if delay > 0.0 {
        chain.push(ChainLink {
            part: part.to_owned(),
            channel: channel.to_owned(),
            delay,
            phase: frequency.map(|f| -360.0 * f * delay),
            share: limit.map(|limit| delay / limit),
        });
    }
}
