//! Simulations of bodies, with an audit of what they conserve: the output of `libration bodies`.

mod approach;
mod changes;
mod encounter;
mod energies;
mod field;
mod files;
mod hidden_change;
mod request;
mod verdict;
mod watch;

use libration::bodies::{BodiesError, BodySimulation};
use libration_report::verdict::Verdict;
use libration_settings::limits::TRAJECTORY_STEPS;
use serde::Serialize;

use crate::export::Rows;
use crate::trajectory::{Monitor, TrajectoryError};
pub use approach::ENCOUNTERS_AT_EACH_STEP;
use changes::{Changes, QUANTITIES, sizes};
use encounter::Closest;
pub use encounter::Encounter;
pub use energies::PartEnergy;
pub use files::write;
pub use request::BodiesRequest;
use verdict::Evidence;
pub use verdict::{FEW_OSCILLATION_STEPS, FEW_STEPS};
use watch::Watch;

/// Version of the JSON format.
pub const SCHEMA: &str = "libration.bodies/1";

/// The columns of the rows, one row for each body of a sample.
pub const COLUMNS: [&str; 9] = ["body", "step", "t", "x", "y", "z", "vx", "vy", "vz"];

/// A motion of bodies; the fields are the keys of `bodies --json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BodiesAudit {
    /// The version of this format.
    pub schema: &'static str,
    /// Whether the motion has a fault: a change of the energy by a tenth of its size, or an end before the last step.
    pub verdict: Verdict,
    /// The name of the system.
    pub system: String,
    /// The number of bodies.
    pub bodies: usize,
    /// The integrator.
    pub integrator: String,
    /// Its order.
    pub order: u32,
    /// The time step, or the first of adaptive steps.
    pub dt: f64,
    /// Steps taken.
    pub steps: u64,
    /// The time at the end.
    pub t: f64,
    /// Sums over all pairs in a step.
    pub evaluations: usize,
    /// The constant of gravitation.
    pub gravitational_constant: f64,
    /// The softening length.
    pub softening: f64,
    /// The potential between all pairs besides gravity, if there is one.
    pub pair_potential: Option<String>,
    /// Whether sums were compensated.
    pub is_compensated: bool,
    /// Whether steps followed the encounters.
    pub is_adaptive: bool,
    /// Samples of the conserved quantities.
    pub samples: u64,
    /// The energy at the start.
    pub energy: f64,
    /// The size of the energy that its changes are relative to, in words.
    pub energy_scale: &'static str,
    /// Changes of energy, momentum and angular momentum, measured and predicted.
    pub conserved: Vec<ConservedChange>,
    /// Changes of the energies of orbits and of bodies in none: of up to 16 bodies, and of more with up to 1024 pairs with a mass.
    pub energies: Vec<PartEnergy>,
    /// The closest encounter: of up to 16 bodies at all steps and between them, of up to 2048 at the samples; none of more or of a single body.
    pub encounter: Option<Encounter>,
    /// Why the motion ended before its last step, if it did.
    pub stopped: Option<String>,
}

/// The largest change of a conserved quantity.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ConservedChange {
    /// `energy`, `momentum` or `angular momentum`.
    pub quantity: &'static str,
    /// The largest change at the samples, relative to `size`.
    pub largest_change: f64,
    /// What the order predicts: the change with twice the time step, over the power of 2; zero where rounding hides it. None without
    /// that run, and for a motion that ended early or has fewer than 4 steps.
    pub predicted_by_order: Option<f64>,
    /// What rounding predicts: a random walk.
    pub predicted_by_rounding: f64,
    /// `|E|`, `Σ m|v|` or `Σ m|r||v|` at the start. With a pair potential, the energy that the motion exchanges in place of `|E|`.
    pub size: f64,
}

/// Force evaluations of pairs between two looks at the monitor.
const PAIRS_BETWEEN_LOOKS: u64 = 1 << 24;

/// Simulates bodies; each sample becomes a row of `rows` for each body.
///
/// A collision or an overflow ends the motion early, and [`BodiesAudit::stopped`] says why; that of the start is an error.
///
/// # Errors
/// [`TrajectoryError`], before any work if the request is invalid.
pub fn simulate(
    request: &BodiesRequest,
    rows: &mut dyn Rows<f64>,
    monitor: &dyn Monitor,
) -> Result<BodiesAudit, TrajectoryError> {
    check(request)?;
    let mut simulation = request.simulation(request.dt).map_err(|error| named(&error, request))?;
    let stride = request.stride();
    let mut closest = Closest::new(&request.system.bodies);
    let start = simulation.conserved();
    if !start.energy.is_finite() {
        return Err(named(&BodiesError::Energy { time: 0.0 }, request));
    }
    let mut watch = Watch::new(&simulation);
    let mut keep = |simulation: &BodySimulation| {
        for (i, body) in simulation.bodies().iter().enumerate() {
            let values: Vec<f64> = body.position.into_iter().chain(body.velocity).collect();
            rows.row(&[i as u64, simulation.steps()], simulation.time(), &values)?;
        }
        closest.sample(simulation);
        Ok::<(), TrajectoryError>(())
    };
    let (changes, samples, stopped) =
        run(&mut simulation, request.steps, stride, monitor, watch.as_mut(), &mut keep)?;
    let (sizes, energy_scale) = sizes(&request.system.bodies, &changes);
    let by_order = match &stopped {
        None if request.is_predicted && request.steps >= 4 => {
            by_order(request, stride, monitor, sizes)?
        }
        _ => None,
    };
    let by_rounding = changes.by_rounding(simulation.steps(), sizes);
    let conserved = (0..3).map(|i| ConservedChange {
        quantity: QUANTITIES[i],
        largest_change: relative(changes.largest()[i], sizes[i]),
        predicted_by_order: by_order.map(|by_order| relative(by_order[i], sizes[i])),
        predicted_by_rounding: relative(by_rounding[i], sizes[i]),
        size: sizes[i],
    });
    let mut audit = BodiesAudit {
        schema: SCHEMA,
        verdict: Verdict::unknown(""),
        system: request.system.name.clone(),
        bodies: request.system.bodies.count(),
        integrator: request.integrator.name(),
        order: request.integrator.order(),
        dt: request.dt,
        steps: simulation.steps(),
        t: simulation.time(),
        evaluations: request.integrator.evaluations(),
        gravitational_constant: request.system.bodies.constant(),
        softening: request.system.bodies.softening_length(),
        pair_potential: request.system.bodies.pairs().map(|pairs| pairs.text().to_owned()),
        is_compensated: request.is_compensated,
        is_adaptive: request.is_adaptive,
        samples,
        energy: changes.start_energy(),
        energy_scale,
        conserved: conserved.collect(),
        energies: watch
            .as_ref()
            .map_or_else(Vec::new, |watch| watch.energies(&request.system.names)),
        encounter: closest.encounter(watch.as_ref(), request),
        stopped: stopped.map(|error| named(&error, request).to_string()),
    };
    let pass = watch.as_ref().and_then(Watch::pass);
    audit.verdict = audit.judge(&Evidence {
        request,
        shortest: Encounter::shortest_orbit(request),
        pass: pass.map(|(pair, distance, t)| Encounter::new(request, pair, distance, t)),
        largest_kinetic: changes.exchange().largest_kinetic(),
        is_steady: changes.exchange().is_steady(),
        exchanged: changes.exchange().size(),
        rounding: changes.rounding(),
    });
    Ok(audit)
}

fn check(request: &BodiesRequest) -> Result<(), TrajectoryError> {
    let wrong = |name, value: u64, allowed: &str| TrajectoryError::Value {
        name,
        value: value.to_string(),
        allowed: allowed.to_owned(),
    };
    if !TRAJECTORY_STEPS.contains(&request.steps) {
        return Err(wrong("steps", request.steps, "a whole number from 1 to 2^53"));
    }
    match request.every {
        Some(0) => Err(wrong("every", 0, "a whole number of at least 1")),
        _ => Ok(()),
    }
}

/// A change over a size; of something that has no size, the change.
fn relative(change: f64, size: f64) -> f64 {
    if size > 0.0 { change / size } else { change }
}

/// Runs to the end, or to a collision or overflow, and samples on the way. A watch looks at each step.
fn run(
    simulation: &mut BodySimulation,
    steps: u64,
    stride: u64,
    monitor: &dyn Monitor,
    mut watch: Option<&mut Watch>,
    keep: &mut dyn FnMut(&BodySimulation) -> Result<(), TrajectoryError>,
) -> Result<(Changes, u64, Option<BodiesError>), TrajectoryError> {
    let mut changes = Changes::new(simulation);
    let count = simulation.bodies().count() as u64;
    let pairs = (count * count * simulation.integrator().evaluations() as u64).max(1);
    let look = (PAIRS_BETWEEN_LOOKS / pairs).max(1);
    let mut samples = 0;
    loop {
        let step = simulation.steps();
        if step.is_multiple_of(stride) || step == steps {
            if !changes.sample(simulation, &|| monitor.should_stop()) {
                let error = BodiesError::Energy { time: simulation.time() };
                return Ok((changes, samples, Some(error)));
            }
            keep(simulation)?;
            samples += 1;
        }
        if step == steps {
            return Ok((changes, samples, None));
        }
        if monitor.should_stop() {
            return Err(TrajectoryError::Interrupted);
        }
        monitor.on_step(step);
        let next = (step / stride + 1).saturating_mul(stride).min(steps);
        let steps = (next - step).min(look);
        let should_stop = || monitor.should_stop();
        let taken = match watch.as_deref_mut() {
            Some(watch) => (0..steps).try_for_each(|_| {
                simulation.advance_until(1, &should_stop)?;
                watch.step(simulation);
                Ok(())
            }),
            None => simulation.advance_until(steps, &should_stop),
        };
        match taken {
            Ok(()) => {}
            Err(BodiesError::Stopped) => return Err(TrajectoryError::Interrupted),
            Err(error) => return Ok((changes, samples, Some(error))),
        }
    }
}

/// The changes that follow from a motion with twice the time step and the order of the integrator. None if that motion ends early.
fn by_order(
    request: &BodiesRequest,
    stride: u64,
    monitor: &dyn Monitor,
    sizes: [f64; 3],
) -> Result<Option<[f64; 3]>, TrajectoryError> {
    let Ok(mut coarse) = request.simulation(2.0 * request.dt) else { return Ok(None) };
    let steps = request.steps / 2;
    let stride = stride.div_ceil(2);
    let (changes, _, stopped) =
        run(&mut coarse, steps, stride, &Quiet(monitor), None, &mut |_| Ok(()))?;
    if stopped.is_some() {
        return Ok(None);
    }
    let rounding = changes.by_rounding(steps, sizes);
    let power = 2.0_f64.powi(i32::try_from(request.integrator.order()).unwrap_or(i32::MAX));
    Ok(Some(core::array::from_fn(|i| {
        let largest = changes.largest()[i];
        // A change that rounding may have made says nothing about the order.
        if largest <= HIDDEN * rounding[i] { 0.0 } else { largest / power }
    })))
}

/// Changes up to this many times that of rounding may be rounding.
const HIDDEN: f64 = 4.0;

/// A monitor without progress.
struct Quiet<'a>(&'a dyn Monitor);

impl Monitor for Quiet<'_> {
    fn should_stop(&self) -> bool {
        self.0.should_stop()
    }
}

/// The error with the names of the bodies.
fn named(error: &BodiesError, request: &BodiesRequest) -> TrajectoryError {
    let name = |body: usize| format!("`{}`", request.system.names[body]);
    TrajectoryError::Bodies(error.with_names(name))
}
