//! How much of each imperfection a loop stands alone.

use libration::Model;
use libration::analysis::{CostError, Imperfections, Plant};

use super::control::Law;
use super::loops::{Loop, LoopError};
use super::request::{Measure, Tolerance};

/// What may be wrong with a loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// Commands arrive late; in periods of the loop.
    Latency,
    /// Sample times vary, each for itself; relative rms.
    Jitter,
    /// The clock is slow, or fast if that is stated; the part by which steps are longer or shorter.
    Skew,
    /// Commands are lost; probability.
    Loss,
}

impl Kind {
    /// All of them.
    pub const ALL: [Kind; 4] = [Kind::Latency, Kind::Jitter, Kind::Skew, Kind::Loss];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Latency => "latency",
            Kind::Jitter => "jitter",
            Kind::Skew => "clock",
            Kind::Loss => "lost commands",
        }
    }
}

/// Up to where a loop stands something.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Limit {
    /// Not even without it.
    None,
    /// Up to here.
    At(f64),
    /// Beyond this, the largest that is tried or makes sense.
    Beyond(f64),
}

/// Periods of latency that are tried at least.
const MOST_PERIODS: f64 = 160.0;

/// And at most, unless more are stated.
const TRIED_PERIODS: f64 = 240.0;

/// Sizes that are tried one by one, at least, before the first that is too large is narrowed down.
const TRIED: u32 = 64;

/// Periods of latency from which on nine digits are enough.
const LONG: f64 = 32.0;

/// How often it is halved: to the digits of a float.
const HALVINGS: u32 = 48;

impl<M: Model<1>> Loop<M> {
    /// This of it, and nothing else.
    pub(super) fn only(&self, kind: Kind, size: f64) -> Result<Imperfections, LoopError> {
        let none = Imperfections::NONE;
        Ok(match kind {
            Kind::Latency => Imperfections { latency: self.latency(size)?, ..none },
            Kind::Jitter => Imperfections { jitter: self.control.jitter.with_rms(size), ..none },
            // To the side that is stated; a slow clock if none is.
            Kind::Skew => Imperfections { skew: size.abs().copysign(self.control.skew), ..none },
            Kind::Loss => Imperfections { loss: size, ..none },
        })
    }

    /// The largest that makes sense, or is tried.
    pub(super) fn largest(&self, kind: Kind) -> f64 {
        match kind {
            // What is stated, and some more.
            Kind::Latency => {
                let stated = self.control.latency / self.control.period;
                (1.5 * stated).clamp(MOST_PERIODS, TRIED_PERIODS.max(stated))
            }
            // Beyond, most steps of a Gaussian law are of length zero or twice too long. A record may be worse.
            Kind::Jitter => (2.0 * self.control.jitter.rms()).max(1.0),
            Kind::Skew if self.control.skew < 0.0 => 0.999,
            Kind::Skew => 8.0,
            Kind::Loss => 1.0 - 1e-9,
        }
    }

    /// Up to where the loop is stable; in the mean square where something is drawn.
    pub(super) fn stable_up_to(&self, plant: &Plant<'_>, kind: Kind) -> Result<Limit, LoopError> {
        // Where a command is fed back from the state the crossings of the unit circle are known.
        if let (Kind::Latency, Law::Pd(_) | Law::Lqr(_)) = (kind, self.control.law) {
            let largest = self.largest(kind);
            let critical = plant.split_critical_latency(self.gains());
            return Ok(match critical.filter(|critical| *critical <= largest) {
                Some(critical) => Limit::At(critical),
                None => Limit::Beyond(largest),
            });
        }
        self.holds_up_to(kind, |with| self.decays(plant, with))
    }

    /// Up to where its cost is tolerated, if a cost is.
    pub(super) fn cheap_up_to(
        &self,
        plant: &Plant<'_>,
        kind: Kind,
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

    /// The sizes that are tried, upward; what is stated is one of them.
    pub(super) fn tried(&self, kind: Kind, largest: f64) -> Result<Vec<f64>, LoopError> {
        // Fine enough that the plant turns by a part of a radian between two: most windows of instability are wider.
        const PART: f64 = 0.25;
        let turn = self.plant().rate() * self.control.period;
        let even = |count: u32| (1..=count).map(move |i| largest * f64::from(i) / f64::from(count));
        let fine = ((turn * largest / PART).ceil() as u32).clamp(TRIED, 32 * TRIED);
        let mut sizes: Vec<f64> = match kind {
            Kind::Skew => even(fine).collect(),
            // Each goes through all of the record.
            Kind::Jitter if self.control.record.is_some() => even(TRIED / 4).collect(),
            Kind::Jitter | Kind::Loss => even(TRIED).collect(),
            // Quarters of a period, then whole ones.
            Kind::Latency => {
                let step = |at: f64| (PART / turn).clamp(0.01, if at < 8.0 { 0.25 } else { 1.0 });
                let next = |at: &f64| Some(at + step(*at)).filter(|next| *next < largest);
                core::iter::successors(Some(step(0.0)), next).chain([largest]).collect()
            }
        };
        let stated = match kind {
            Kind::Latency => self.late()?.steps(),
            Kind::Jitter => self.control.jitter.rms(),
            Kind::Skew => self.control.skew.abs(),
            Kind::Loss => self.control.loss,
        };
        sizes.extend(Some(stated).filter(|size| (0.0..largest).contains(size)));
        sizes.sort_by(f64::total_cmp);
        Ok(sizes)
    }

    fn holds_up_to(
        &self,
        kind: Kind,
        holds: impl Fn(&Imperfections) -> Result<bool, CostError>,
    ) -> Result<Limit, LoopError> {
        let at = |size: f64| -> Result<bool, LoopError> { Ok(holds(&self.only(kind, size)?)?) };
        if !at(0.0)? {
            return Ok(Limit::None);
        }
        let largest = self.largest(kind);
        let mut low = 0.0;
        for size in self.tried(kind, largest)? {
            if at(size)? {
                low = size;
                continue;
            }
            let mut high = size;
            let replays = kind == Kind::Jitter && self.control.record.is_some();
            for _ in 0..if replays { HALVINGS / 2 } else { HALVINGS } {
                // Long queues are costly.
                if kind == Kind::Latency && high > LONG && high - low < 1e-9 * high {
                    break;
                }
                let middle = 0.5 * (low + high);
                if at(middle)? { low = middle } else { high = middle }
            }
            return Ok(Limit::At(low));
        }
        Ok(Limit::Beyond(largest))
    }
}
