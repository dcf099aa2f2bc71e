//! The latency of a loop, part by part.

use core::f64::consts::TAU;

use libration::linear::Signal;
use serde::Serialize;

use super::LinearRequest;
use crate::budget::{Budget, rounded};
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
    /// The reason for a phase or a share that is missing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
}

/// The limit of the latency of a channel.
#[derive(Clone, Debug)]
struct ChannelLimit {
    /// The largest stable latency in s; none without a limit.
    latency: Option<f64>,
    /// The frequency in Hz at which the loop oscillates there; none without oscillation.
    frequency: Option<f64>,
    /// The reason for what is missing.
    note: Option<String>,
}

impl ChainLink {
    /// Why phases and shares of a chain are missing: a sentence for each reason, with its channels.
    pub fn notes(chain: &[ChainLink]) -> Vec<String> {
        let mut notes: Vec<(&str, Vec<&str>)> = Vec::new();
        for link in chain {
            let Some(note) = &link.note else { continue };
            let channel = link.channel.as_str();
            match notes.iter_mut().find(|(own, _)| own == note) {
                Some((_, channels)) if channels.contains(&channel) => {}
                Some((_, channels)) => channels.push(channel),
                None => notes.push((note, vec![channel])),
            }
        }
        notes.iter().map(|(note, channels)| format!("{}: {note}", channels.join(", "))).collect()
    }
}

impl LinearRequest {
    /// All parts, from the outputs to the inputs.
    pub(super) fn latency_chain(&self, budgets: &[Budget]) -> Vec<ChainLink> {
        let plant = self.timed.linear.plant();
        let period = self.timed.period();
        let mut chain = Vec::new();
        // Of a cascade, from the outputs over the references to the inputs.
        for (j, output) in plant.outputs.iter().enumerate() {
            let limit = channel_limit(budgets, Imperfection::OutputLatency, &output.name, period);
            self.add_parts(&mut chain, &output.name, None, Some(j), &limit);
            let late = self.timed.timing.output_latency[j];
            add_delay(&mut chain, "measurement", &output.name, late, &limit);
        }
        self.add_references(&mut chain);
        for (i, input) in plant.inputs.iter().enumerate() {
            let limit = channel_limit(budgets, Imperfection::Latency, &input.name, period);
            let late = self.timed.timing.input_latency[i];
            add_delay(&mut chain, "command", &input.name, late, &limit);
            let every = self.design.cascade.as_ref().map_or(1, |cascade| cascade.inner_every);
            let half = period * every as f64 / 2.0;
            add_delay(&mut chain, &hold(every), &input.name, half, &limit);
            self.add_parts(&mut chain, &input.name, Some(i), None, &limit);
        }
        chain
    }

    /// The delays of the references of a cascade. They have no limit of their own, and so no phase and no share.
    fn add_references(&self, chain: &mut Vec<ChainLink>) {
        let Some(cascade) = &self.design.cascade else { return };
        let period = self.timed.period();
        let none = ChannelLimit {
            latency: None,
            frequency: None,
            note: Some(
                "no phase and no share, because references of a cascade have no limit of their own"
                    .into(),
            ),
        };
        for Signal { name, .. } in &cascade.references {
            let late = period * cascade.outer_latency as f64;
            add_delay(chain, "outer latency", name, late, &none);
            let half = period * cascade.outer_every as f64 / 2.0;
            add_delay(chain, &hold(cascade.outer_every), name, half, &none);
        }
    }

    fn add_parts(
        &self,
        chain: &mut Vec<ChainLink>,
        channel: &str,
        input: Option<usize>,
        output: Option<usize>,
        limit: &ChannelLimit,
    ) {
        for part in self.parts.iter().filter(|part| part.input == input && part.output == output) {
            let period = self.timed.period();
            let delay = part.delay(period);
            chain.push(ChainLink {
                part: part.name.clone(),
                channel: channel.to_owned(),
                delay,
                phase: limit.frequency.map(|f| part.phase(TAU * f, period).to_degrees()),
                share: limit.latency.map(|limit| delay / limit),
                note: limit.note.clone(),
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

/// The limit of the latency of a channel, from its budget.
fn channel_limit(
    budgets: &[Budget],
    kind: Imperfection,
    channel: &str,
    period: f64,
) -> ChannelLimit {
    let own = |budget: &&Budget| {
        budget.kind == kind && budget.channel.as_deref().is_none_or(|name| name == channel)
    };
    let missing = |note: &str| ChannelLimit {
        latency: None,
        frequency: None,
        note: Some(format!("no phase and no share, because {note}")),
    };
    let Some(budget) = budgets.iter().find(own) else { return missing("no limit is known") };
    match (budget.stable_up_to, budget.crossing_angle) {
        (None, _) => missing(&format!(
            "no limit was found: the loop is stable with all tried latencies, up to {} s",
            rounded(budget.tried_up_to)
        )),
        (Some(limit), _) if limit <= 0.0 => {
            missing("the limit is 0: the loop is unstable with the shortest latencies")
        }
        (latency, Some(angle)) => {
            ChannelLimit { latency, frequency: Some(angle / (TAU * period)), note: None }
        }
        (latency, None) => ChannelLimit {
            latency,
            frequency: None,
            note: Some("no phase, because at the limit the loop grows without oscillation".into()),
        },
    }
}

fn add_delay(
    chain: &mut Vec<ChainLink>,
    part: &str,
    channel: &str,
    delay: f64,
    limit: &ChannelLimit,
) {
    if delay > 0.0 {
        chain.push(ChainLink {
            part: part.to_owned(),
            channel: channel.to_owned(),
            delay,
            phase: limit.frequency.map(|f| -360.0 * f * delay),
            share: limit.latency.map(|limit| delay / limit),
            note: limit.note.clone(),
        });
    }
}
