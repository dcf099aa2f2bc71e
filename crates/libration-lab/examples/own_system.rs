//! A system of one's own in the laboratory: a bead on a rotating hoop, with a report of its own.
//!
//! `own_system [configuration] [folder]` studies its order, energy, symmetry and stability under
//! every integrator of the configuration. No line of the laboratory knows of beads.

use std::error::Error;
use std::sync::atomic::AtomicBool;

use libration::{Elementary, Hamiltonian, Model, State, System};
use libration_lab::output::Output;
use libration_lab::{STUDIES, session};
use libration_report::Record;
use libration_study::{Lab, Silent};
use libration_study_motion::{Convergence, Nonlinear, Problem};

/// `θ̈ = (Ω² cos θ − ω²) sin θ`, with ω² = g/r and the hoop turning at Ω about its diameter.
///
/// Strogatz: Nonlinear Dynamics and Chaos, §3.5, without friction.
#[derive(Clone, Copy)]
struct Bead<S> {
    omega2: S,
    hoop2: S,
}

impl<S: Elementary> System<S, 1> for Bead<S> {
    fn acceleration(&self, state: &State<S, 1>) -> [S; 1] {
        let [angle] = state.q;
        [(self.hoop2 * angle.cos() - self.omega2) * angle.sin()]
    }
}

impl<S: Elementary> Hamiltonian<S, 1> for Bead<S> {
    fn energy(&self, state: &State<S, 1>) -> S {
        let ([angle], [v]) = (state.q, state.v);
        let sin = angle.sin();
        let potential =
            self.omega2 * (S::one() - angle.cos()) - (self.hoop2 * sin * sin).ratio(1, 2);
        (v * v).ratio(1, 2) + potential
    }
}

impl Model<1> for Bead<f64> {
    type On<S: Elementary> = Bead<S>;
    const LINEAR: bool = false;

    fn on<S: Elementary>(&self) -> Bead<S> {
        Bead { omega2: S::from_f64(self.omega2), hoop2: S::from_f64(self.hoop2) }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let config = match arguments.next() {
        Some(path) => STUDIES.parse_bytes(&libration_settings::read(path.as_ref())?, &path)?,
        None => STUDIES.parse(include_str!("own_system.toml"), "own_system.toml")?,
    };
    let output = Output::open(arguments.next().unwrap_or_else(|| "bead-report".into()))?;

    // The bead rests where cos θ = ω²/Ω², and turns about it with the frequency Ω sin θ.
    let bead = Bead { omega2: 9.81, hoop2: 25.0 };
    let rest = (9.81_f64 / 25.0).acos();
    let turn = std::f64::consts::TAU / (5.0 * rest.sin());
    let bead = Problem::new("bead", bead, State { q: [0.9], v: [0.0] }, turn)
        .titled("bead on a hoop")
        .with_equilibrium(State { q: [rest], v: [0.0] });

    let own = [bead];
    let stop = AtomicBool::new(false);
    let lab = Lab::new(&config, config.effort, &Silent, &stop);
    let results = session::run(&lab, &[&Convergence::of(&own), &Nonlinear::of(&own)], &output)?;

    let findings: usize = results.studies.iter().map(|record| record.findings.len()).sum();
    let broken: Vec<&str> = results
        .studies
        .iter()
        .flat_map(Record::disagreements)
        .map(|finding| finding.id.as_str())
        .collect();
    println!("{findings} findings in {}", output.path("report.html").display());
    if broken.is_empty() {
        Ok(())
    } else {
        Err(format!("theory and measurement disagree: {}", broken.join(", ")).into())
    }
}
