//! Ensembles of loops with all stated imperfections.

use libration::control::clock::{Jittered, Rates, Recorded};
use libration::control::delay::{Order, Packets};
use libration::control::{Delay, Jitter, Schedule, WhiteNoise};
use libration::ensemble::{All, EnsembleError, Loops, MeanCost, Setup};
use libration::integrator::{Exact, Rk4, Substeps};

use libration::{Integrator, Model, State};
pub(super) use libration_analyze::linear_analysis::MEMORIES;
use libration_work::Work;

use super::AdviseError;
use super::loops::{Loop, PlantModel};

/// Seed of all random numbers.
const SEED: u64 = 8;

/// Largest number of simulated periods.
pub(super) const MOST_PERIODS: f64 = 100_000.0;

/// Part of the memory that passes before costs are measured: the cost lacks `e⁻¹⁰` of its value then, less than 1/200 of its standard error.
pub(super) const FORGOTTEN: f64 = 0.5;

impl<M: PlantModel> Loop<M> {
    /// Runs loops with all stated imperfections; none if the latency is too long for losses, or a step too long for an exact one.
    pub(super) fn run(
        &self,
        work: &Work<'_>,
        run: EnsembleRun<'_>,
    ) -> Result<Option<EnsembleResult>, AdviseError> {
        let stated = self.stated()?;
        let latency = stated.latency;
        if stated.loss == 0.0 {
            return self.run_with(work, run, Schedule::late(latency));
        }
        let whole = latency.steps().trunc() as usize;
        let mut travels = vec![0.0; whole + 1];
        travels[whole] = 1.0 - stated.loss;
        let Ok(packets) = Packets::new(&travels, Order::NewestActs) else { return Ok(None) };
        let Ok(packets) = packets.longer_by(latency.steps().fract()) else { return Ok(None) };
        self.run_with(work, run, packets)
    }

    fn run_with(
        &self,
        work: &Work<'_>,
        run: EnsembleRun<'_>,
        delay: impl Delay<f64>,
    ) -> Result<Option<EnsembleResult>, AdviseError> {
        let varied = match &self.control.record {
            Some(record) => record.iter().copied().fold(1.0, f64::max),
            None => 1.0 + self.control.jitter.largest(),
        };
        let longest = varied * (1.0 + self.control.skew.abs());
        // Exact steps are compiled for linear models only, and others for no linear ones.
        if const { M::LINEAR } {
            let exact = Exact::new(self.model, self.control.period * longest);
            return exact.map(|exact| self.run_by(work, run, delay, exact)).transpose();
        }
        // Substeps of 0.05 rad with an error of order four of 10⁻⁶.
        let turn = self.plant().rate() * self.control.period * longest;
        let count = (turn / 0.05).ceil().clamp(4.0, 256.0) as i32;
        self.run_by(work, run, delay, Substeps { method: Rk4, count }).map(Some)
    }

    fn run_by(
        &self,
        work: &Work<'_>,
        run: EnsembleRun<'_>,
        delay: impl Delay<f64>,
        method: impl Integrator,
    ) -> Result<EnsembleResult, AdviseError> {
        let system = self.model.on::<f64>();
        let even = [1.0];
        let recorded = self.control.record.as_deref().unwrap_or(&even);
        let jitter = match self.control.record {
            Some(_) => Jitter::Gaussian(0.0),
            None => self.control.jitter,
        };
        // Loops begin at different places of a record: otherwise all would have the same clock.
        let groups = if recorded.len() > 1 { GROUPS } else { 1 };
        let mut all = EnsembleResult { costs: Vec::new(), last: Vec::new() };
        for (group, starts) in run.starts.chunks(run.starts.len().div_ceil(groups)).enumerate() {
            let rates = vec![1.0 + self.control.skew; starts.len()];
            let mut own = recorded.to_vec();
            own.rotate_left(group * recorded.len() / groups);
            let setup = Setup::new(All(system), method)
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

/// Number of places in a record at which loops begin.
pub(super) const GROUPS: usize = 8;

/// Steps between two checks of the stop flag.
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

/// A run of an ensemble of loops.
#[derive(Clone, Copy)]
pub(super) struct EnsembleRun<'a> {
    /// Periods before the measurement.
    pub(super) before: u64,
    /// Measured periods.
    pub(super) periods: u64,
    /// The initial states.
    pub(super) starts: &'a [State<f64, 1>],
    /// The intensity of the noise.
    pub(super) intensity: f64,
}

/// The result of a run.
pub(super) struct EnsembleResult {
    /// The mean cost of each loop.
    pub(super) costs: Vec<f64>,
    /// The final states.
    pub(super) last: Vec<State<f64, 1>>,
}
