//! Many loops with all that is stated.

use libration::analysis::Jitter;
use libration::control::clock::{Jittered, Rates, Recorded};
use libration::control::delay::{Order, Packets};
use libration::control::{Delay, Schedule, WhiteNoise};
use libration::ensemble::{All, EnsembleError, Loops, MeanCost, Setup};
use libration::integrator::{Exact, Rk4};
use libration::system::Chosen;
use libration::{Integrator, Model, State, System};

use super::AdviseError;
use super::loops::Loop;
use crate::Lab;

/// The seed of all that is random.
const SEED: u64 = 8;

impl<M: Model<1>> Loop<M> {
    /// Runs loops with all that is stated.
    pub(super) fn run(&self, lab: &Lab<'_>, run: Run<'_>) -> Result<Option<Ran>, AdviseError> {
        let stated = self.stated()?;
        let latency = stated.latency;
        if stated.loss == 0.0 {
            return self.run_with(lab, run, Schedule::late(latency)).map(Some);
        }
        let whole = latency.steps().trunc() as usize;
        let mut travels = vec![0.0; whole + 1];
        travels[whole] = 1.0 - stated.loss;
        let Ok(packets) = Packets::new(&travels, Order::NewestActs) else { return Ok(None) };
        let Ok(packets) = packets.longer_by(latency.steps().fract()) else { return Ok(None) };
        self.run_with(lab, run, packets).map(Some)
    }

    fn run_with(
        &self,
        lab: &Lab<'_>,
        run: Run<'_>,
        delay: impl Delay<f64>,
    ) -> Result<Ran, AdviseError> {
        let longest = (1.0 + self.control.jitter.largest()) * (1.0 + self.control.skew.abs());
        match Exact::new(self.model, self.control.period * longest) {
            Some(exact) => self.run_by(lab, run, delay, exact),
            None => self.run_by(lab, run, delay, Rk4),
        }
    }

    fn run_by(
        &self,
        lab: &Lab<'_>,
        run: Run<'_>,
        delay: impl Delay<f64>,
        method: impl Integrator,
    ) -> Result<Ran, AdviseError> {
        let acceleration = |state: &State<f64, 1>| self.model.on::<f64>().acceleration(state);
        let even = [1.0];
        let recorded = self.control.record.as_deref().unwrap_or(&even);
        let jitter = match self.control.record {
            Some(_) => Jitter::Gaussian(0.0),
            None => self.control.jitter,
        };
        let rates = vec![1.0 + self.control.skew; run.starts.len()];
        let setup = Setup::new(All(Chosen(&acceleration)), method)
            .controller(self.controller)
            .clock((Rates(&rates), (Recorded::repeated(recorded), Jittered(jitter))))
            .delay(delay)
            .disturbance(WhiteNoise(run.intensity));
        let period = self.control.period;
        let mut loops = Loops::new(setup, period, SEED, [0.0], run.starts, lab.alone()?)?;
        advance(lab, run.before, |steps| loops.advance(steps))?;
        let mut sums = vec![0.0; run.starts.len()];
        let mut counted = 0;
        while counted < run.periods {
            lab.check()?;
            let steps = LEG.min(run.periods - counted);
            let seen = loops.observe(steps, 1, |range| MeanCost::new(range, self.weights))?;
            let means = seen.iter().flat_map(MeanCost::means);
            sums.iter_mut().zip(means).for_each(|(sum, mean)| *sum += mean * steps as f64);
            counted += steps;
        }
        let costs = sums.into_iter().map(|sum| sum / run.periods as f64).collect();
        let last = (0..run.starts.len()).filter_map(|n| loops.state(n)).collect();
        Ok(Ran { costs, last })
    }
}

/// Steps between two looks at whether to stop.
const LEG: u64 = 4096;

fn advance(
    lab: &Lab<'_>,
    steps: u64,
    mut by: impl FnMut(u64) -> Result<(), EnsembleError>,
) -> Result<(), AdviseError> {
    let mut left = steps;
    while left > 0 {
        lab.check()?;
        let leg = LEG.min(left);
        by(leg)?;
        left -= leg;
    }
    Ok(())
}

/// What is run.
#[derive(Clone, Copy)]
pub(super) struct Run<'a> {
    /// Periods that do not count.
    pub(super) before: u64,
    /// Periods that do.
    pub(super) periods: u64,
    /// Where the loops start.
    pub(super) starts: &'a [State<f64, 1>],
    /// Of the noise.
    pub(super) intensity: f64,
}

/// What came of it.
pub(super) struct Ran {
    /// The mean cost of each loop.
    pub(super) costs: Vec<f64>,
    /// The states in the end.
    pub(super) last: Vec<State<f64, 1>>,
}
