//! The study `asynchrony`: dephasing, energy and stability with clocks of different rates.

mod claims;
mod energy_band;
mod ensemble_mean;
mod render;
mod replay;
mod source_claims;
mod stable_clocks;

use libration::State;
use libration::analysis::Plant;
use libration::control::Jitter;
use libration::control::clock::{Gaussian, Jittered, Skewed};
use libration::ensemble::{All, Setup};
use libration::integrator::VelocityVerlet;
use libration::system::{BaselineOnly, Oscillator};
use libration_report::Record;
use libration_report::page::Page;
use libration_report::record::RecordError;
use libration_study::{Lab, SourceClaim, Study, StudyError};

use self::source_claims::SOURCE_CLAIMS;
use super::loop_ensemble::{Snapshot, run_snapshots};

/// The study `asynchrony`.
#[derive(Clone, Copy, Debug)]
pub struct Asynchrony;

impl Study for Asynchrony {
    fn name(&self) -> &'static str {
        "asynchrony"
    }

    fn question(&self) -> &'static str {
        "How fast do clocks of different rates drift apart?"
    }

    fn source_claims(&self) -> &'static [SourceClaim] {
        SOURCE_CLAIMS
    }

    fn run(&self, lab: &Lab<'_>) -> Result<Record, StudyError> {
        let mut record = Record::new(self.name(), self.question());
        if lab.config.integrators.contains(&libration::Method::VelocityVerlet) {
            ensemble_mean::measure(lab, &mut record)?;
            energy_band::measure(lab, &mut record)?;
            stable_clocks::measure(lab, &mut record)?;
            replay::measure(lab, &mut record)?;
        }
        claims::judge(&mut record);
        Ok(record)
    }

    fn render(&self, record: &Record, page: &mut Page) -> Result<(), RecordError> {
        render::render(record, page)
    }
}

/// The time step of which the source report speaks last, in s.
const DT: f64 = 0.01;

/// The seed of all that is random here.
const SEED: u64 = 11;

/// The rates of clocks, and the jitter of their steps.
#[derive(Clone, Copy, Debug)]
struct Clocks {
    skew: Jitter,
    jitter: f64,
}

impl Clocks {
    /// Clocks that differ, each of which is even.
    fn skewed(skew: Jitter) -> Self {
        Clocks { skew, jitter: 0.0 }
    }

    /// Clocks of one rate with uneven steps.
    fn jittered(rms: f64) -> Self {
        Clocks { skew: Jitter::Uniform(0.0), jitter: rms }
    }
}

/// Runs velocity Verlet under these clocks: one kernel for all of them.
fn run(
    lab: &Lab<'_>,
    model: Oscillator<f64>,
    clocks: Clocks,
    (dt, seed): (f64, u64),
    starts: &[State<f64, 1>],
    at: &[u64],
) -> Result<Vec<Snapshot>, StudyError> {
    let clock = (Skewed(clocks.skew), Jittered(Gaussian(clocks.jitter)));
    let setup = Setup::new(All(BaselineOnly(model)), VelocityVerlet).clock(clock);
    run_snapshots(lab, setup, (dt, seed), starts, at)
}

fn start(lab: &Lab<'_>) -> State<f64, 1> {
    State { q: [lab.config.start.q], v: [lab.config.start.v] }
}

fn plant(lab: &Lab<'_>, dt: f64) -> Plant<'static> {
    Plant::new(VelocityVerlet, lab.config.oscillator.system(), State::origin(), dt)
}
