//! The report on gains.

use libration::Elementary;
use libration::linear::eigenvalues;
use libration::number::Wide;
use libration_report::verdict::Verdict;
use serde::Serialize;

use super::growth::Growth;
use super::integrator_row::IntegratorRow;
use super::limit_in_json::limit;
use super::measured::MeasuredGains;
use super::servo_mode::{ServoMode, modes};
use super::servo_step::ServoStep;
use super::stable_factors::{StableFactors, largest_gain, resolution_of};
use super::{OtherForces, ServoIntegrator, Servos, Torque};

/// Most substeps that are tried.
pub(super) const MOST_SUBSTEPS: u32 = 1000;
/// Distance from the limit, as part of the gains, up to which they are said to be at it.
const AT_LIMIT: f64 = 1e-12;
/// Part of the fastest rate below which growth is rounding.
const ROUNDING: f64 = 1e-7;
/// The results; the fields are the keys of `gains --json`. Infinite limits are `null` there.
#[derive(Clone, Debug, Serialize)]
pub struct GainReport {
    /// The answer in a few sentences.
    pub answer: String,
    /// Whether the step is stable with these gains: by the measured step, if there is one, else by the servo model.
    pub verdict: Verdict,
    /// Whether the verdict is good.
    pub holds: bool,
    /// The growth rate in 1/s of a motion that grows in continuous time, whatever the step; none if no motion does.
    pub growth_in_continuous_time: Option<f64>,
    /// The length of a step of the simulator, in s.
    pub dt: f64,
    /// Steps of the integrator in it.
    pub substeps: u32,
    /// When torques are computed.
    pub torque: Torque,
    /// The step of the simulator itself; none of a servo model alone.
    pub measured: Option<MeasuredGains>,
    /// Whether the step is unstable without any gain, by springs or damping of the joints.
    pub unstable_without_servos: bool,
    /// The integrator.
    pub integrator: &'static str,
    /// The same in running text.
    pub integrator_title: String,
    /// The largest factor of a mode per substep; per step with held torques.
    pub spectral_radius: f64,
    /// The same less 1, of the servo model without cancellation.
    pub spectral_radius_minus_one: f64,
    /// Whether the gains of the servo model do not hold since they are at their limit.
    #[serde(skip)]
    pub(super) is_at_limit: bool,
    /// Whether the gains of the servo model hold.
    #[serde(skip)]
    pub(super) holds_in_model: bool,
    /// Whether it is known if a motion of the servo model grows.
    #[serde(skip)]
    pub(super) is_known: bool,
    /// Forces at a limit, where gains have no derivative, in words.
    #[serde(skip)]
    pub(super) saturated: Vec<String>,
    /// Servos that do not act, in words.
    #[serde(skip)]
    pub(super) idle: Vec<String>,
    /// Whether a gain of position is not 0, so that they have a common factor.
    #[serde(skip)]
    pub(super) has_kp: bool,
    /// What acts besides the servos.
    #[serde(skip)]
    pub(super) others: OtherForces,
    /// Whether limits were removed, since nothing is known of the gains.
    #[serde(skip)]
    pub(super) is_withheld: bool,
    /// The largest factor of all gains of position, with the same gains of velocity.
    #[serde(serialize_with = "limit")]
    pub largest_factor: f64,
    /// The least factor, if the given gains are too small; else 0.
    pub least_factor: f64,
    /// The fewest substeps with which the gains hold; none up to 1000.
    pub fewest_substeps: Option<u32>,
    /// The joints.
    pub joints: Vec<JointRow>,
    /// The modes of all joints together, the fastest first.
    pub modes: Vec<ServoMode>,
    /// All integrators.
    pub integrators: Vec<IntegratorRow>,
    /// Facts that limit the validity.
    pub notes: Vec<String>,
    /// The command that repeats the report.
    pub repeat_command: String,
}

/// A joint.
#[derive(Clone, Debug, Serialize)]
pub struct JointRow {
    /// Its name.
    pub name: String,
    /// Its inertia with all other joints at rest.
    pub inertia: f64,
    /// Its gain of position.
    pub kp: f64,
    /// Its gain of velocity.
    pub kv: f64,
    /// `ωh` of the joint alone.
    pub turn: f64,
    /// The damping ratio of the joint alone.
    pub damping_ratio: Option<f64>,
    /// The largest `ωh` of the joint alone with the same damping; not a number if ω is 0.
    #[serde(serialize_with = "limit")]
    pub largest_turn: f64,
    /// Its largest gain of position, with all others as they are and with all couplings; 0 if none is stable.
    #[serde(serialize_with = "limit")]
    pub largest_kp: f64,
    /// The same of its gain of velocity.
    #[serde(serialize_with = "limit")]
    pub largest_kv: f64,
}

/// Whether the gains of servos hold at steps of `dt` seconds in `substeps` parts, by the servo model.
pub fn gains(
    servos: &Servos,
    dt: f64,
    substeps: u32,
    integrator: ServoIntegrator,
    notes: Vec<String>,
) -> GainReport {
    let size = servos.size_of_gains(dt / f64::from(substeps));
    let resolution = resolution_of(servos.parts().iter().map(Vec::len).max().unwrap_or(1));
    let row = |integrator: ServoIntegrator| {
        let step = ServoStep::new(integrator);
        let growth = |factor: f64| step.growth(&servos.with_factor(factor), dt, substeps);
        let factor = StableFactors::search(size, resolution, growth);
        let own = step.growth_beside_limit(servos, dt, substeps);
        let excess = step.radius_minus_one(servos, dt, substeps);
        IntegratorRow {
            name: integrator.name(),
            title: integrator.title(),
            holds: own == Growth::None,
            is_known: own != Growth::Unknown,
            largest_factor: if own == Growth::Unknown { f64::NAN } else { factor.most },
            least_factor: factor.least,
            fewest_substeps: fewest_substeps(servos, dt, &step),
            spectral_radius: 1.0 + excess,
            spectral_radius_minus_one: excess,
        }
    };
    let integrators: Vec<IntegratorRow> = ServoIntegrator::all().map(row).collect();
    let known = integrators.iter().find(|row| row.name == integrator.name());
    let own = known.cloned().unwrap_or_else(|| row(integrator));
    let length = match servos.torque {
        Torque::EachSubstep => dt / f64::from(substeps),
        Torque::Held => dt,
    };
    let parts = if servos.torque == Torque::Held { substeps } else { 1 };
    let step = ServoStep::new(integrator);
    // Servos may hold what grows without them in continuous time.
    let passive = step.growth(&servos.passive(), dt, substeps) != Growth::Some
        || continuous_growth(&servos.passive(), length).is_some();
    let shorter = step.growth(servos, dt * (1.0 - AT_LIMIT), substeps);
    let mut report = GainReport {
        answer: String::new(),
        verdict: Verdict::unknown("no step was examined"),
        holds: own.holds,
        growth_in_continuous_time: continuous_growth(servos, length),
        dt,
        substeps,
        torque: servos.torque,
        measured: None,
        unstable_without_servos: !own.holds && own.is_known && !passive,
        integrator: own.name,
        integrator_title: own.title,
        spectral_radius: own.spectral_radius,
        spectral_radius_minus_one: own.spectral_radius_minus_one,
        is_at_limit: !own.holds && own.is_known && shorter == Growth::None,
        holds_in_model: own.holds,
        is_known: own.is_known,
        saturated: Vec::new(),
        idle: Vec::new(),
        has_kp: servos.kp.largest() > 0.0,
        others: OtherForces {
            without_gains: servos.kp.largest() == 0.0 && servos.kv.largest() == 0.0,
            ..OtherForces::default()
        },
        is_withheld: false,
        largest_factor: own.largest_factor,
        least_factor: own.least_factor,
        fewest_substeps: own.fewest_substeps,
        joints: (0..servos.joints.len())
            .map(|i| joint_row(servos, i, &step, length, parts))
            .collect(),
        modes: modes(servos, |length| servos.period(integrator, length, parts), length),
        integrators,
        notes,
        repeat_command: String::new(),
    };
    if !report.is_known {
        // Limits beside gains of which nothing is known would be read as gains that hold.
        (report.largest_factor, report.fewest_substeps) = (f64::NAN, None);
        for joint in &mut report.joints {
            (joint.largest_kp, joint.largest_kv) = (f64::NAN, f64::NAN);
        }
    }
    report.conclude();
    report
}

/// The growth rate of a motion that grows beyond rounding, which parts a repeated eigenvalue by its root.
fn continuous_growth(servos: &Servos, h: f64) -> Option<f64> {
    let values = eigenvalues(&servos.in_steps_of(h).plant().ok()?.a)?;
    let size = values.iter().map(|s| s.norm()).fold(0.0, f64::max);
    let growth = values.iter().map(|s| s.re).fold(f64::NEG_INFINITY, f64::max);
    (growth > ROUNDING * size).then_some(growth / h)
}

fn fewest_substeps(servos: &Servos, dt: f64, step: &ServoStep) -> Option<u32> {
    let holds = |substeps: u32| step.growth_beside_limit(servos, dt, substeps) == Growth::None;
    // Doubling finds a number that holds, bisection the fewest.
    let mut high = 1;
    while !holds(high) {
        if high == MOST_SUBSTEPS {
            return None;
        }
        high = (2 * high).min(MOST_SUBSTEPS);
    }
    let mut low = high / 2;
    while high - low > 1 {
        let middle = u32::midpoint(low, high);
        if holds(middle) { high = middle } else { low = middle }
    }
    Some(high)
}

/// The row of a joint in steps of `length` seconds, in parts if torques are held over them.
fn joint_row(servos: &Servos, i: usize, step: &ServoStep, length: f64, parts: u32) -> JointRow {
    let alone = servos.alone(i);
    let (inertia, kp, kv) = (alone.mass[(0, 0)], alone.kp[(0, 0)], alone.kv[(0, 0)]);
    let in_steps = alone.joint_numbers(0, length);
    let stiffness = in_steps.kp + in_steps.stiffness;
    let squared = if stiffness.is_negative() { Wide::ZERO } else { stiffness };
    let turn = squared.sqrt().to_f64();
    let damping = (in_steps.kv + in_steps.damping).to_f64();
    // Longer steps change ωh at the same damping ratio.
    let longest = StableFactors::search(turn.max(damping.abs()), resolution_of(1), |factor| {
        step.growth(&alone, length * factor, parts)
    });
    let growth = |servos: &Servos| step.growth(servos, length, parts);
    let resolution = resolution_of(servos.parts().iter().map(Vec::len).max().unwrap_or(1));
    let [kp_in_steps, kv_in_steps] = [in_steps.kp, in_steps.kv].map(|x| x.abs().to_f64());
    // The whole row of a gain that is there; the entry of the joint of one that is not.
    let largest_kp = match kp {
        0.0 => {
            let unit = inertia / length / length;
            largest_gain(kp, [0.0, unit], resolution, |kp| growth(&servos.with_kp(i, kp)))
        }
        kp => {
            let of = |factor: f64| growth(&servos.with_joint_factor(i, factor));
            kp * StableFactors::search(kp_in_steps.max(f64::MIN_POSITIVE), resolution, of).most
        }
    };
    let of_kv = |kv: f64| growth(&servos.with_kv(i, kv));
    JointRow {
        name: servos.joints[i].name.clone(),
        inertia,
        kp,
        kv,
        turn,
        damping_ratio: (turn > 0.0).then(|| damping / (2.0 * turn)),
        largest_turn: if turn == 0.0 { f64::NAN } else { turn * longest.most },
        largest_kp: largest_kp.max(0.0),
        largest_kv: largest_gain(kv, [kv_in_steps, inertia / length], resolution, of_kv),
    }
}
