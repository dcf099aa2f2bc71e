//! Energies of a run of any program.

use crate::TraceError;

/// The fewest samples of a trace: four in each of the fewest batches.
const LEAST_SAMPLES: usize = 128;
/// The most traces of an audit.
const MOST_TRACES: usize = 64;
/// Relative difference below which two time steps are the same.
const SAME_STEP: f64 = 1e-3;
/// Largest relative difference of durations.
const SAME_DURATION: f64 = 0.05;
/// Largest relative rms deviation of sampling intervals for which their mean is taken for the time step.
const UNEVEN: f64 = 0.03;
/// Part of a sampling interval by which distances of samples without gaps differ at most.
const GAP: f64 = 0.5;
/// Part of a sampling interval by which printed times may err.
const PRINTED: f64 = 1e-3;

/// The energies of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct EnergyTrace {
    /// Name of the run, such as that of its file.
    pub title: String,
    /// The time step in s; none for the spacing of the samples.
    pub dt: Option<f64>,
    /// Times in s.
    pub times: Vec<f64>,
    /// Energies at these times.
    pub energies: Vec<f64>,
}

impl EnergyTrace {
    /// Duration of the run in s.
    pub fn duration(&self) -> f64 {
        match (self.times.first(), self.times.last()) {
            (Some(first), Some(last)) => last - first,
            _ => 0.0,
        }
    }

    /// Mean time between samples in s.
    pub fn spacing(&self) -> f64 {
        self.duration() / self.times.len().saturating_sub(1).max(1) as f64
    }

    /// The longest time without samples, from and to, if most samples are at equal distances and those are not.
    pub(crate) fn gap(&self) -> Option<[f64; 2]> {
        let mut distances: Vec<f64> = self.times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        distances.sort_by(f64::total_cmp);
        let [low, middle, high] =
            [0.1, 0.5, 0.9].map(|part: f64| distances[(part * distances.len() as f64) as usize]);
        let longest =
            self.times.windows(2).max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0])))?;
        let is_even = high - low < GAP * middle;
        (is_even && longest[1] - longest[0] > (1.0 + GAP) * middle)
            .then(|| [longest[0], longest[1]])
    }

    /// The time step in s.
    pub fn step(&self) -> f64 {
        self.dt.unwrap_or_else(|| self.spacing())
    }

    /// Relative rms deviation of the times between samples from their mean.
    fn unevenness(&self) -> f64 {
        let spacing = self.spacing();
        let square = |pair: &[f64]| ((pair[1] - pair[0]) / spacing - 1.0).powi(2);
        let intervals = self.times.len().saturating_sub(1).max(1) as f64;
        (self.times.windows(2).map(square).sum::<f64>() / intervals).sqrt()
    }

    /// Checks the trace.
    fn check(&self) -> Result<(), TraceError> {
        let title = || self.title.clone();
        let (times, energies) = (self.times.len(), self.energies.len());
        if times != energies {
            return Err(TraceError::Lengths { title: title(), times, energies });
        }
        if times < LEAST_SAMPLES {
            return Err(TraceError::Short { title: title(), samples: times, least: LEAST_SAMPLES });
        }
        for (what, values) in [("time", &self.times), ("energy", &self.energies)] {
            if let Some(i) = values.iter().position(|x| !x.is_finite()) {
                let value = values[i];
                return Err(TraceError::NotFinite { title: title(), what, sample: i + 1, value });
            }
        }
        if let Some(i) = self.times.windows(2).position(|pair| pair[0] >= pair[1]) {
            return Err(TraceError::NotIncreasing {
                title: title(),
                sample: i + 2,
                before: self.times[i],
                after: self.times[i + 1],
            });
        }
        let value = self.energies[0];
        if self.energies.iter().all(|energy| *energy == value) {
            return Err(TraceError::Constant { title: title(), samples: energies, value });
        }
        let (dt, spacing) = (self.step(), self.spacing());
        if !(dt.is_finite() && dt > 0.0) {
            return Err(TraceError::TimeStep { title: title(), dt });
        }
        if dt > spacing * (1.0 + PRINTED) {
            return Err(TraceError::LongStep { title: title(), dt, spacing });
        }
        let unevenness = self.unevenness();
        if self.dt.is_none() && unevenness > UNEVEN {
            return Err(TraceError::Uneven { title: title(), percent: 100.0 * unevenness });
        }
        Ok(())
    }
}

/// Checks all traces and returns them with the shortest time step first.
pub(crate) fn checked(traces: &[EnergyTrace]) -> Result<Vec<&EnergyTrace>, TraceError> {
    match traces.len() {
        count @ 0..2 => return Err(TraceError::Few(count)),
        count if count > MOST_TRACES => return Err(TraceError::Many(count)),
        _ => {}
    }
    traces.iter().try_for_each(EnergyTrace::check)?;
    let mut sorted: Vec<&EnergyTrace> = traces.iter().collect();
    sorted.sort_by(|a, b| a.step().total_cmp(&b.step()));
    for pair in sorted.windows(2) {
        if pair[1].step() <= pair[0].step() * (1.0 + SAME_STEP) {
            return Err(TraceError::EqualSteps {
                first: pair[0].title.clone(),
                second: pair[1].title.clone(),
                dt: pair[0].step(),
            });
        }
    }
    let by_duration = |a: &&&EnergyTrace, b: &&&EnergyTrace| a.duration().total_cmp(&b.duration());
    if let (Some(short), Some(long)) =
        (sorted.iter().min_by(by_duration), sorted.iter().max_by(by_duration))
        && long.duration() > short.duration() * (1.0 + SAME_DURATION)
    {
        return Err(TraceError::Durations {
            longer: long.title.clone(),
            shorter: short.title.clone(),
            long: long.duration(),
            short: short.duration(),
        });
    }
    Ok(sorted)
}
