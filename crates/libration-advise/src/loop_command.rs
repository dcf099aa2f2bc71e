//! Commands that reproduce the analysis of a loop.

use libration::analysis::Imperfections;
use libration::control::{Jitter, Latency};
use libration::linear::LoopTiming;

use super::control::Law;
use super::loops::{Loop, PlantModel};
use super::request::Request;

impl<M: PlantModel> Loop<M> {
    /// A command that analyses the loop with `imperfections`.
    pub(super) fn command(&self, timing: &LoopTiming, request: &Request) -> String {
        let LoopTiming { ref input_latency, jitter, skew, loss, .. } = *timing;
        let imperfections = &Imperfections { latency: input_latency[0], jitter, skew, loss };
        let gains = match self.control.law {
            _ if self.control.record.is_some() && imperfections.jitter.rms() > 0.0 => {
                return format!("{} --json", request.invocation);
            }
            Law::Pd(_) | Law::Lqr(_) if M::LINEAR => self.given_gains(),
            // `analyze` takes neither controllers with memory nor exact steps of a linearisation.
            _ => return self.rerun_command(imperfections, request),
        };
        let latency = imperfections.latency;
        // Latencies are parts of steps, which the clock stretches.
        let latency = match (latency == Latency::NONE, skew == 0.0) {
            (true, _) => String::new(),
            (_, true) => format!(" --latency {}", latency.steps() * self.control.period),
            (_, false) => format!(" --latency {}steps", latency.steps()),
        };
        let jitter = match jitter.rms() {
            0.0 => String::new(),
            _ => format!(" --jitter {}", law_flag(jitter)),
        };
        let loss = if loss == 0.0 { String::new() } else { format!(" --loss {loss}") };
        let weights = self.control.weights.map_or_else(String::new, |w| {
            format!(" --cost-weights {},{},{}", w.position, w.velocity, w.command)
        });
        format!(
            "libration analyze {} --q {} --integrator exact --dt {} --feedback {},{}{latency}{jitter}{loss}{weights}",
            request.name_and_parameters(),
            request.system.q[0],
            self.control.period * (1.0 + skew),
            gains.position,
            gains.velocity
        )
    }

    /// The invocation, for the loop with `imperfections`.
    fn rerun_command(&self, imperfections: &Imperfections, request: &Request) -> String {
        // A flag cannot remove a record.
        if self.control.record.is_some() || request.invocation.contains("--jitter-file") {
            return format!("{} --json", request.invocation);
        }
        let Imperfections { latency, jitter, skew, loss } = *imperfections;
        let law = law_flag(jitter);
        let seconds = latency.steps() * self.control.period * (1.0 + skew);
        format!(
            "{} --latency {seconds} --jitter {law} --skew {skew} --loss {loss} --json",
            request.invocation
        )
    }
}

/// A law of step times in the syntax of flags.
fn law_flag(law: Jitter) -> String {
    match law {
        Jitter::Gaussian(rms) => format!("gaussian:{rms}"),
        Jitter::Uniform(rms) => format!("uniform:{rms}"),
    }
}
