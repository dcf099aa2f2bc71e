//! The study `jitter`: energy, phase and stability with jittered steps.

mod claims;
mod energy;
mod figures;
mod host;
mod map;
mod maps;
mod margin;
mod moments;
mod phase;
mod render;
mod replay;
mod resonance;
mod setting;
mod settings;
mod source_claims;
mod spectrum;
mod switching;

use libration_study::SourceClaim;

pub use self::settings::JitterSettings;
use self::source_claims::SOURCE_CLAIMS;
use libration::Method;
use libration_report::Record;
use libration_report::page::Page;
use libration_report::record::RecordError;
use libration_study::{Lab, Section, Study, StudyError};

/// The study `jitter`.
#[derive(Clone, Copy, Debug)]
pub struct Jitter;

impl Study for Jitter {
    fn name(&self) -> &'static str {
        "jitter"
    }

    fn question(&self) -> &'static str {
        "What does jitter of the clock do to energy and phase?"
    }

    fn source_claims(&self) -> &'static [SourceClaim] {
        SOURCE_CLAIMS
    }

    fn settings(&self) -> Option<Section> {
        Some(Section::of::<JitterSettings>())
    }

    fn run(&self, lab: &Lab<'_>) -> Result<Record, StudyError> {
        let mut record = Record::new(self.name(), self.question());
        energy::measure(lab, &mut record)?;
        phase::measure(lab, &mut record)?;
        replay::measure(lab, &mut record)?;
        moments::measure(lab, &mut record)?;
        spectrum::measure(lab, &mut record)?;
        resonance::measure(lab, &mut record)?;
        switching::measure(lab, &mut record)?;
        margin::measure(lab, &mut record)?;
        map::measure(lab, &mut record)?;
        host::measure(lab, &mut record)?;
        claims::judge(&mut record, energy::horizon(lab));
        Ok(record)
    }

    fn render(&self, record: &Record, page: &mut Page) -> Result<(), RecordError> {
        render::render(record, page)
    }
}

/// The methods that are jittered: two that keep areas, and one whose steps commute. Kernels of others would only be
/// compiled.
const METHODS: [Method; 3] = [Method::SymplecticEuler, Method::VelocityVerlet, Method::Rk4];

/// The seed of all that is random here; another gives other numbers within the same errors.
const SEED: u64 = 7;

/// `$body` with one of [`METHODS`] bound to `$m`.
macro_rules! with_jittered {
    ($method:expr, |$m:ident| $body:expr) => {
        match $method {
            libration::Method::SymplecticEuler => {
                let $m = libration::integrator::SymplecticEuler;
                $body
            }
            libration::Method::VelocityVerlet => {
                let $m = libration::integrator::VelocityVerlet;
                $body
            }
            _ => {
                let $m = libration::integrator::Rk4;
                $body
            }
        }
    };
}

/// Runs free trajectories of a setting under Gaussian jitter.
fn free(
    lab: &Lab<'_>,
    setting: &setting::Setting,
    model: libration::system::Oscillator<f64>,
    starts: &[libration::State<f64, 1>],
    at: &[u64],
) -> Result<Vec<super::loop_ensemble::Snapshot>, StudyError> {
    use libration::control::clock::{Gaussian, Jittered};
    use libration::ensemble::{All, Setup};
    use libration::system::BaselineOnly;
    with_jittered!(setting.method, |m| {
        let setup = Setup::new(All(BaselineOnly(model)), m).clock(Jittered(Gaussian(setting.rms)));
        super::loop_ensemble::run_snapshots(lab, setup, (setting.dt, SEED), starts, at)
    })
}

/// The start of the configuration.
fn start(lab: &Lab<'_>) -> libration::State<f64, 1> {
    libration::State { q: [lab.config.start.q], v: [lab.config.start.v] }
}
