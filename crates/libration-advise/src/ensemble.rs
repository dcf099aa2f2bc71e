//! Many loops with all that is stated.

use libration::control::clock::{Jittered, Rates, Recorded};
use libration::control::delay::{Order, Packets};
use libration::control::{Delay, Jitter, Schedule, WhiteNoise};
use libration::ensemble::{All, EnsembleError, Loops, MeanCost, Setup};
use libration::integrator::{Exact, Rk4, Substeps};
use libration::system::DynSystem;
use libration::{Integrator, Model, State, System};
use libration_work::Work;

use super::AdviseError;
use super::loops::Loop;

/// The seed of all that is random.
const SEED: u64 = 8;

impl<M: Model<1>> Loop<M> {
    /// Runs loops with all that is stated.
    pub(super) fn run(&self, work: &Work<'_>, run: Run<'_>) -> Result<Option<Ran>, AdviseError> {
        let stated = self.stated()?;
        let latency = stated.latency;
        if stated.loss == 0.0 {
            return self.run_with(work, run, Schedule::late(latency)).map(Some);
        }
        let whole = latency.steps().trunc() as usize;
        let mut travels = vec![0.0; whole + 1];
        travels[whole] = 1.0 - stated.loss;
        let Ok(packets) = Packets::new(&travels, Order::NewestActs) else { return Ok(None) };
        let Ok(packets) = packets.longer_by(latency.steps().fract()) else { return Ok(None) };
        self.run_with(work, run, packets).map(Some)
    }

    fn run_with(
        &self,
        work: &Work<'_>,
        run: Run<'_>,
        delay: impl Delay<f64>,
    ) -> Result<Ran, AdviseError> {
        let varied = match &self.control.record {
            Some(record) => record.iter().copied().fold(1.0, f64::max),
            None => 1.0 + self.control.jitter.largest(),
        };
        let longest = varied * (1.0 + self.control.skew.abs());
        match Exact::new(self.model, self.control.period * longest) {
            Some(exact) => self.run_by(work, run, delay, exact),
            // Parts of a radian, of which the error of order four is a part in 10⁶.
            None => {
                let turn = self.plant().rate() * self.control.period * longest;
                let count = (turn / 0.05).ceil().clamp(4.0, 256.0) as i32;
                self.run_by(work, run, delay, Substeps { method: Rk4, count })
            }
        }
    }

    fn run_by(
        &self,
        work: &Work<'_>,
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
        // Loops under one record begin at different places of it: else all would have the same clock.
        let groups = if recorded.len() > 1 { GROUPS } else { 1 };
        let mut all = Ran { costs: Vec::new(), last: Vec::new() };
        for (group, starts) in run.starts.chunks(run.starts.len().div_ceil(groups)).enumerate() {
            let rates = vec![1.0 + self.control.skew; starts.len()];
            let mut own = recorded.to_vec();
            own.rotate_left(group * recorded.len() / groups);
            let setup = Setup::new(All(DynSystem(&acceleration)), method)
                .controller(self.controller)
                .clock((Rates(&rates), (Recorded::repeated(&own), Jittered(jitter))))
                .delay(delay)
                .disturbance(WhiteNoise(run.intensity));
            let (period, seed) = (self.control.period, SEED + group as u64);
            let mut loops = Loops::new(setup, period, seed, [0.0], starts, work.serial()?)?;
            advance(work, run.before, |steps| loops.advance(steps))?;
            let mut sums = vec![0.0; starts.len()];
            let mut counted = 0;
            while counted < run.periods {
                work.check()?;
                let steps = LEG.min(run.periods - counted);
                let seen = loops.observe(steps, 1, |range| MeanCost::new(range, self.weights))?;
                let means = seen.iter().flat_map(MeanCost::means);
                sums.iter_mut().zip(means).for_each(|(sum, mean)| *sum += mean * steps as f64);
                counted += steps;
            }
            all.costs.extend(sums.into_iter().map(|sum| sum / run.periods as f64));
            all.last.extend((0..starts.len()).filter_map(|n| loops.state(n)));
        }
        Ok(all)
    }
}

/// Places in a record at which loops begin.
pub(super) const GROUPS: usize = 8;

/// Steps between two looks at whether to stop.
const LEG: u64 = 4096;

fn advance(
    work: &Work<'_>,
    steps: u64,
    mut by: impl FnMut(u64) -> Result<(), EnsembleError>,
) -> Result<(), AdviseError> {
    let mut left = steps;
    while left > 0 {
        work.check()?;
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
