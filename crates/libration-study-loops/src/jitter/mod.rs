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

/// Runs free trajectories of a setting under Gaussian jitter.
///
/// Loops of the symplectic methods are compiled for all instruction sets: they take most of the steps of the study. RK4
/// runs with few settings.
fn free(
    lab: &Lab<'_>,
    setting: &setting::Setting,
    model: libration::system::Oscillator<f64>,
    starts: &[libration::State<f64, 1>],
    at: &[u64],
) -> Result<Vec<super::loop_ensemble::Snapshot>, StudyError> {
    use super::loop_ensemble::run_snapshots;
    use libration::control::clock::{Gaussian, Jittered};
    use libration::ensemble::{All, Setup};
    use libration::integrator::{Rk4, SymplecticEuler, VelocityVerlet};
    use libration::system::BaselineOnly;

    let (clock, steps) = (Jittered(Gaussian(setting.rms)), (setting.dt, SEED));
    match setting.method {
        Method::SymplecticEuler => {
            let setup = Setup::new(All(model), SymplecticEuler).clock(clock);
            run_snapshots(lab, setup, steps, starts, at)
        }
        Method::VelocityVerlet => {
            let setup = Setup::new(All(model), VelocityVerlet).clock(clock);
            run_snapshots(lab, setup, steps, starts, at)
        }
        _ => {
            let setup = Setup::new(All(BaselineOnly(model)), Rk4).clock(clock);
            run_snapshots(lab, setup, steps, starts, at)
        }
    }
}

/// The start of the configuration.
fn start(lab: &Lab<'_>) -> libration::State<f64, 1> {
    libration::State { q: [lab.config.start.q], v: [lab.config.start.v] }
}
