//! Limits of each imperfection of a loop.

use libration::analysis::{CostError, Imperfections, Plant};

use super::control::Law;
use super::loops::{Loop, LoopError, PlantModel};
use super::request::{Measure, Tolerance};

/// A timing imperfection of a loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Imperfection {
    /// Latency of commands, in periods of the loop.
    Latency,
    /// Independent jitter of sample times, as relative rms.
    Jitter,
    /// Relative error of the period, to the stated side: slow or fast.
    Skew,
    /// Loss of commands, as a probability.
    Loss,
}

impl Imperfection {
    /// All imperfections.
    pub const ALL: [Imperfection; 4] =
        [Imperfection::Latency, Imperfection::Jitter, Imperfection::Skew, Imperfection::Loss];

    /// The name in output.
    pub fn name(self) -> &'static str {
        match self {
            Imperfection::Latency => "latency",
            Imperfection::Jitter => "jitter",
            Imperfection::Skew => "clock",
            Imperfection::Loss => "lost commands",
        }
    }
}

/// The limit of an imperfection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Limit {
    /// The loop is unstable without the imperfection.
    None,
    /// The largest stable size.
    Value(f64),
    /// No limit up to this size, the largest tried.
    Beyond(f64),
}

/// Smallest largest tried latency, in periods.
const MOST_PERIODS: f64 = 160.0;

/// Largest tried latency, in periods, unless more is stated.
const TRIED_PERIODS: f64 = 240.0;

/// Smallest number of tried sizes before the first unstable one is bisected.
const TRIED: u32 = 64;

/// Latency in periods above which nine digits suffice.
const LONG: f64 = 32.0;

/// Number of bisections: to the digits of a float.
const HALVINGS: u32 = 48;

impl<M: PlantModel> Loop<M> {
    /// An imperfection of the given size without others.
    pub(super) fn single(&self, kind: Imperfection, size: f64) -> Result<Imperfections, LoopError> {
        let none = Imperfections::NONE;
        Ok(match kind {
            Imperfection::Latency => Imperfections { latency: self.latency(size)?, ..none },
            Imperfection::Jitter => {
                Imperfections { jitter: self.control.jitter.with_rms(size), ..none }
            }
            // To the stated side; a slow clock if none is stated.
            Imperfection::Skew => {
                Imperfections { skew: size.abs().copysign(self.control.skew), ..none }
            }
            Imperfection::Loss => Imperfections { loss: size, ..none },
        })
    }

    /// The largest tried size.
    pub(super) fn largest(&self, kind: Imperfection) -> f64 {
        match kind {
            // The stated size and some more.
            Imperfection::Latency => {
                let stated = self.control.latency / self.control.period;
                (1.5 * stated).clamp(MOST_PERIODS, TRIED_PERIODS.max(stated))
            }
            // Above it, most steps of a Gaussian law are zero or twice too long. A record may exceed it.
            Imperfection::Jitter => (2.0 * self.control.jitter.rms()).max(1.0),
            Imperfection::Skew if self.control.skew < 0.0 => 0.999,
            Imperfection::Skew => 8.0,
            Imperfection::Loss => 1.0 - 1e-9,
        }
    }

    /// The largest size with which the loop is stable, in the mean square for random imperfections.
    pub(super) fn stable_up_to(
        &self,
        plant: &Plant<'_>,
        kind: Imperfection,
    ) -> Result<Limit, LoopError> {
        // For state feedback the crossings of the unit circle are known.
        if let (Imperfection::Latency, Law::Pd(_) | Law::Lqr(_)) = (kind, self.control.law) {
            let largest = self.largest(kind);
            let critical = plant.split_critical_latency(self.gains());
            return Ok(match critical.filter(|critical| *critical <= largest) {
                Some(critical) => Limit::Value(critical),
                None => Limit::Beyond(largest),
            });
        }
        self.holds_up_to(kind, |with| self.decays(plant, with))
    }

    /// The largest size with a tolerated cost; none without a tolerance of the cost.
    pub(super) fn tolerated_up_to(
        &self,
        plant: &Plant<'_>,
        kind: Imperfection,
        tolerance: Tolerance,
    ) -> Result<Option<Limit>, LoopError> {
        if tolerance.of != Measure::Cost {
            return Ok(None);
        }
        let ideal = self.cost(plant, &Imperfections::NONE, self.weights)?;
        let limit = self.holds_up_to(kind, |with| {
            Ok(self.cost(plant, with, self.weights)? <= (1.0 + tolerance.most) * ideal)
        })?;
        Ok(Some(limit))
    }

    /// The tried sizes in rising order, including the stated one.
    pub(super) fn tried_sizes(
        &self,
        kind: Imperfection,
        largest: f64,
    ) -> Result<Vec<f64>, LoopError> {
        // The plant turns by a part of a radian between two sizes: most windows of instability are wider.
        const PART: f64 = 0.25;
        let turn = self.plant().rate() * self.control.period;
        let even = |count: u32| (1..=count).map(move |i| largest * f64::from(i) / f64::from(count));
        let fine = ((turn * largest / PART).ceil() as u32).clamp(TRIED, 32 * TRIED);
        let mut sizes: Vec<f64> = match kind {
            Imperfection::Skew => even(fine).collect(),
            // Each trial passes through the whole record.
            Imperfection::Jitter if self.control.record.is_some() => even(TRIED / 4).collect(),
            Imperfection::Jitter | Imperfection::Loss => even(TRIED).collect(),
            // Quarters of a period, then whole ones.
            Imperfection::Latency => {
                let step = |at: f64| (PART / turn).clamp(0.01, if at < 8.0 { 0.25 } else { 1.0 });
                let next = |at: &f64| Some(at + step(*at)).filter(|next| *next < largest);
                core::iter::successors(Some(step(0.0)), next).chain([largest]).collect()
            }
        };
        let stated = match kind {
            Imperfection::Latency => self.stated_latency()?.steps(),
            Imperfection::Jitter => self.control.jitter.rms(),
            Imperfection::Skew => self.control.skew.abs(),
            Imperfection::Loss => self.control.loss,
        };
        sizes.extend(Some(stated).filter(|size| (0.0..largest).contains(size)));
        sizes.sort_by(f64::total_cmp);
        Ok(sizes)
    }

    fn holds_up_to(
        &self,
        kind: Imperfection,
        holds: impl Fn(&Imperfections) -> Result<bool, CostError>,
    ) -> Result<Limit, LoopError> {
        let at = |size: f64| -> Result<bool, LoopError> { Ok(holds(&self.single(kind, size)?)?) };
        if !at(0.0)? {
            return Ok(Limit::None);
        }
        let largest = self.largest(kind);
        let mut low = 0.0;
        for size in self.tried_sizes(kind, largest)? {
            if at(size)? {
                low = size;
                continue;
            }
            let mut high = size;
            let replays = kind == Imperfection::Jitter && self.control.record.is_some();
            for _ in 0..if replays { HALVINGS / 2 } else { HALVINGS } {
                // Long queues are costly.
                if kind == Imperfection::Latency && high > LONG && high - low < 1e-9 * high {
                    break;
                }
                let middle = 0.5 * (low + high);
                if at(middle)? { low = middle } else { high = middle }
            }
            return Ok(Limit::Value(low));
        }
        Ok(Limit::Beyond(largest))
    }
}
