//! A linear loop with its stated timing: growth, cost and modes.

use libration::control::{Jitter, Latency};
use libration::linear::{
    Channels, LatencyWindow, LinearLoop, LinearLoopError, LoopMode, LoopStability, LoopTiming,
    MissingCommand,
};

use super::imperfection::Imperfection;
use super::subject::Subject;

/// The timing that a request states.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct StatedTiming {
    /// The latency of each input, in s.
    pub(super) input_latency: Vec<f64>,
    /// The latency of each output, in s.
    pub(super) output_latency: Vec<f64>,
    /// The law of the lengths of periods, with its relative rms.
    pub(super) jitter: Jitter,
    /// The relative error of the period: positive for a slow clock, negative for a fast one.
    pub(super) skew: f64,
    /// The probability that a command is lost.
    pub(super) loss: f64,
    /// What acts where a command is missing.
    pub(super) missing: MissingCommand,
    /// Recorded steps, as multiples of their mean. They replace the law of `jitter`, which has their rms.
    pub(super) record: Option<Vec<f64>>,
}

/// The smallest unstable latency of the only input in periods, in 1024 bits; none if there is none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CriticalLatency(pub(super) Option<f64>);

/// A linear loop with its stated timing.
#[derive(Clone, Debug)]
pub(super) struct TimedLoop {
    pub(super) linear: LinearLoop,
    pub(super) timing: StatedTiming,
    /// Whether the states of the plant have names of their own.
    pub(super) names_states: bool,
    /// The critical latency, where it is known exactly.
    pub(super) critical_latency: Option<CriticalLatency>,
    /// Whether a motion changes by less than rounding in each period, so that growth alone does not decide.
    pub(super) is_near_neutral: bool,
}

impl TimedLoop {
    /// The period, in s.
    pub(super) fn period(&self) -> f64 {
        self.linear.period()
    }

    /// No imperfections.
    pub(super) fn ideal(&self) -> LoopTiming {
        self.linear.ideal()
    }

    /// The stated imperfections.
    pub(super) fn stated(&self) -> Result<LoopTiming, LinearLoopError> {
        self.scaled(1.0)
    }

    /// The stated imperfections times `share`.
    pub(super) fn scaled(&self, share: f64) -> Result<LoopTiming, LinearLoopError> {
        let StatedTiming { input_latency, output_latency, jitter, skew, loss, missing, .. } =
            &self.timing;
        // A slow clock has fewer periods per second.
        let step = self.period() * (1.0 + share * skew);
        let late = |seconds: &f64| match share == 1.0 {
            true => self.exact_latency(seconds / step),
            false => self.latency(share * seconds / step),
        };
        Ok(LoopTiming {
            input_latency: input_latency.iter().map(late).collect::<Result<_, _>>()?,
            output_latency: output_latency.iter().map(late).collect::<Result<_, _>>()?,
            jitter: jitter.with_rms(share * jitter.rms()),
            skew: share * skew,
            loss: share * loss,
            missing: *missing,
        })
    }

    /// An imperfection of the given size without others.
    pub(super) fn single(
        &self,
        subject: Subject,
        size: f64,
    ) -> Result<LoopTiming, LinearLoopError> {
        let mut timing = LoopTiming { missing: self.timing.missing, ..self.ideal() };
        match subject.kind {
            Imperfection::Latency => self.delay(&mut timing.input_latency, subject, size)?,
            Imperfection::OutputLatency if self.delays_commands_instead(subject) => {
                self.delay(&mut timing.input_latency, subject, size)?;
            }
            Imperfection::OutputLatency => self.delay(&mut timing.output_latency, subject, size)?,
            Imperfection::Jitter => timing.jitter = self.timing.jitter.with_rms(size),
            // To the stated side; a slow clock if none is stated.
            Imperfection::Skew => timing.skew = size.abs() * self.side(),
            Imperfection::Loss => timing.loss = size,
        }
        Ok(timing)
    }

    /// The channels whose windows of stable latencies are searched; none for other imperfections, for a cascade, whose channels have
    /// several numbers per round, and where the critical latency is known.
    pub(super) fn searched_channels(&self, subject: Subject) -> Option<Channels> {
        let late = |count: usize| subject.channel.map_or_else(|| (0..count).collect(), |i| vec![i]);
        let StatedTiming { input_latency, output_latency, .. } = &self.timing;
        let channels = match subject.kind {
            Imperfection::OutputLatency if !self.delays_commands_instead(subject) => {
                Channels::Outputs(late(output_latency.len()))
            }
            Imperfection::Latency | Imperfection::OutputLatency => {
                Channels::Inputs(late(input_latency.len()))
            }
            _ => return None,
        };
        let stated = self.stated_size(subject) / self.period();
        let is_known = self
            .critical_latency
            .is_some_and(|CriticalLatency(end)| end.is_none_or(|end| stated < end));
        (self.linear.controllers().periods() == 1 && !is_known).then_some(channels)
    }

    /// The windows of stable latencies of channels, in periods; none if the search for them ends without an answer.
    pub(super) fn latency_windows(
        &self,
        subject: Subject,
        channels: &Channels,
    ) -> Result<Option<Vec<LatencyWindow>>, LinearLoopError> {
        let largest = self.largest(subject);
        match self.linear.latency_windows(&self.ideal(), channels, [largest; 2]) {
            Err(LinearLoopError::Search { .. }) => Ok(None),
            found => found.map(Some),
        }
    }

    /// The side of the skew: 1 for a slow clock, also if none is stated, −1 for a fast one.
    pub(super) fn side(&self) -> f64 {
        if self.timing.skew < 0.0 { -1.0 } else { 1.0 }
    }

    /// Whether measurements of all outputs that are late may be replaced by commands to all inputs that are late: without a direct path
    /// only the time from sample to command matters, and there are fewer inputs.
    fn delays_commands_instead(&self, subject: Subject) -> bool {
        let StatedTiming { input_latency, output_latency, .. } = &self.timing;
        let fewer = input_latency.len() < output_latency.len();
        subject.channel.is_none() && fewer && self.linear.plant().d.largest() == 0.0
    }

    fn delay(
        &self,
        channels: &mut [Latency],
        subject: Subject,
        periods: f64,
    ) -> Result<(), LinearLoopError> {
        let latency = self.latency(periods)?;
        match subject.channel {
            Some(i) => channels[i] = latency,
            None => channels.fill(latency),
        }
        Ok(())
    }

    /// The stated size of an imperfection: in s for a latency. Of all channels it is the latency that they have in common, the smallest, or
    /// the largest where no channel has a budget of its own.
    pub(super) fn stated_size(&self, subject: Subject) -> f64 {
        let StatedTiming { input_latency, output_latency, jitter, skew, loss, .. } = &self.timing;
        let lone = !self.is_joint(subject);
        let late = |channels: &[f64]| match subject.channel {
            Some(i) => channels[i],
            None if lone => channels.iter().copied().fold(0.0, f64::max),
            None => channels.iter().copied().reduce(f64::min).unwrap_or(0.0),
        };
        match subject.kind {
            Imperfection::Latency => late(input_latency),
            Imperfection::OutputLatency => late(output_latency),
            Imperfection::Jitter => jitter.rms(),
            Imperfection::Skew => *skew,
            Imperfection::Loss => *loss,
        }
    }

    /// Whether the plant is sampled, so that latencies are whole periods.
    pub(super) fn is_sampled(&self) -> bool {
        self.linear.plant().sampling_period.is_some()
    }

    /// Whether an output shows commands at once, between samples as well.
    pub(super) fn has_direct_path(&self) -> bool {
        self.linear.plant().d.largest() > 0.0 && !self.is_sampled()
    }

    /// The latency of `periods` periods; of a sampled plant that of the whole ones.
    pub(super) fn latency(&self, periods: f64) -> Result<Latency, LinearLoopError> {
        let exact = self.exact_latency(periods)?;
        match self.is_sampled() {
            true => self.exact_latency(exact.whole() as f64),
            false => Ok(exact),
        }
    }

    fn exact_latency(&self, periods: f64) -> Result<Latency, LinearLoopError> {
        // The same conversion from seconds as elsewhere.
        let period = self.period();
        Latency::of_seconds(periods * period, period).ok_or(LinearLoopError::Latency { periods })
    }

    /// The steps of the record with deviations scaled to `rms`; none without a record or without jitter. Negative steps are set
    /// to zero, as for a law.
    pub(super) fn replayed(&self, rms: f64) -> Option<Vec<f64>> {
        let record = self.timing.record.as_ref().filter(|_| rms > 0.0)?;
        let share = rms / self.timing.jitter.rms();
        Some(record.iter().map(|step| (1.0 + share * (step - 1.0)).max(0.0)).collect())
    }

    /// The growth rate of second moments per period, under the law of steps or the record.
    pub(super) fn growth(&self, with: &LoopTiming) -> Result<f64, LinearLoopError> {
        match self.replayed(with.jitter.rms()) {
            Some(steps) => self.linear.recorded_growth(with, &steps),
            None => self.linear.growth(with),
        }
    }

    /// Whether second moments decay.
    pub(super) fn decays(&self, with: &LoopTiming) -> Result<bool, LinearLoopError> {
        match self.replayed(with.jitter.rms()) {
            _ if self.is_near_neutral => Ok(self.stability(with)?.is_stable()),
            Some(steps) => Ok(self.linear.recorded_growth(with, &steps)? < 0.0),
            None => self.linear.is_stable(with),
        }
    }

    /// Whether the loop is stable, by the function that decides for all commands.
    pub(super) fn stability(&self, with: &LoopTiming) -> Result<LoopStability, LinearLoopError> {
        self.linear.decided(LoopStability::of_growth(self.growth(with)?), with)
    }

    /// The stationary cost of the loop; infinite where second moments grow.
    pub(super) fn cost(&self, with: &LoopTiming) -> Result<f64, LinearLoopError> {
        match self.replayed(with.jitter.rms()) {
            Some(steps) => self.linear.recorded_cost(with, &steps),
            None => Ok(self.linear.stationary(with)?.map_or(f64::INFINITY, |found| found.cost)),
        }
    }

    /// The mode that decays last.
    pub(super) fn slowest_mode(&self, with: &LoopTiming) -> Result<LoopMode, LinearLoopError> {
        let none = LoopMode { radius: 0.0, angle: 0.0, states: Vec::new() };
        Ok(self.linear.modes(with, 1)?.into_iter().next().unwrap_or(none))
    }

    /// The same loop with all gains times `factor`.
    pub(super) fn amplified(&self, factor: f64) -> Result<Self, LinearLoopError> {
        let linear = self.linear.amplified(factor)?;
        Ok(TimedLoop { linear, critical_latency: None, ..self.clone() })
    }

    /// The same loop with noise that is held through each period, as simulated.
    pub(super) fn with_held_noise(&self) -> Self {
        TimedLoop { linear: self.linear.with_held_noise(), ..self.clone() }
    }

    /// The fastest motion of the plant, in rad/s.
    pub(super) fn rate(&self) -> f64 {
        self.linear.rate()
    }
}
