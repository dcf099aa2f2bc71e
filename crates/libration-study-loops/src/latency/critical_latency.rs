//! The latency at which a loop begins to grow.

use libration::Method;
use libration::analysis::Plant;
use libration::control::Feedback;
use libration::number::Wide;
use libration_report::Record;
use libration_report::notation::{number, seconds};
use libration_report::record::{Cell, Finding, Table, Tolerance};
use libration_study::{Lab, StudyError};

use super::loop_simulation::{Loop, ORIGIN, SPRING};

/// The time step of the loops, in s.
pub(super) const DT: f64 = 0.01;

/// Their gains.
pub(super) const GAINS: Feedback = Feedback { position: 10.0, velocity: 2.0 };

/// Simulated methods; exact steps are theory only.
const METHODS: [Method; 3] = [Method::SymplecticEuler, Method::VelocityVerlet, Method::Rk4];

/// By which the gains of a loop of velocity Verlet are multiplied.
pub(super) const FACTORS: [f64; 4] = [0.5, 1.0, 2.0, 4.0];

/// Steps of a run that tells growth from decay.
const STEPS: u64 = 6000;

/// A bisection ends here, in steps.
const WIDTH: f64 = 1e-7;

/// Critical latencies of a loop, by theory and simulation.
struct CriticalLatency {
    /// By the characteristic polynomial with `λᵈ` for any `d`: right for whole latencies.
    polynomial: f64,
    /// With the step split where the command arrives.
    predicted: f64,
    measured: f64,
    /// The last whole latency before a loop grows.
    whole: f64,
}

/// Examines the loop under each method, and with each factor of its gains.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let loops = METHODS.map(|method| Loop { method, dt: DT, gains: GAINS });
    let onsets = lab.sweep("critical latencies", &loops, |case| onset(lab, case))?;
    let margin = loops[0].plant().delay_margin(GAINS).map_or(f64::NAN, Wide::to_f64);
    let mut table = table();
    let columns = ["integrator", "of the position (steps)", "of the velocity (steps)"];
    let mut hides = Table::new("hidden latency", &columns);
    for (case, onset) in loops.iter().zip(&onsets) {
        let title = format!("{}, Δt = {}", case.method.title(), seconds(DT, 3));
        find(record, case.method.name(), &title, onset);
        let [position, velocity] = hidden(&case.plant());
        // What the loop has lost counts for position and velocity alike only if both lose the same.
        if (position - velocity).abs() < 1e-3 {
            record.find(lost(case.method, &title, margin / DT - onset.measured, velocity));
        }
        table.push(row(case.method.title(), Some(onset), margin));
        hides.push([case.method.title().into(), position.into(), velocity.into()]);
    }
    let exact = Plant::exact(SPRING, ORIGIN, DT);
    let [position, velocity] = hidden(&exact);
    hides.push(["exact steps".into(), position.into(), velocity.into()]);
    let critical = exact.latency_windows(GAINS).critical().unwrap_or(f64::NAN);
    let mut exact = row("exact steps", None, margin);
    exact[1] = critical.into();
    table.push(exact);
    record.tables.push(table);
    record.tables.push(hides);
    damping(lab, record)?;
    gains(lab, record)
}

/// Steps that integrator and hold hide of the feedback of position and velocity.
fn hidden(plant: &Plant<'_>) -> [f64; 2] {
    // What is left of a limit is none.
    let number = |x: Wide| Some(x.to_f64()).filter(|x| x.abs() > 1e-50).unwrap_or(0.0);
    plant.hidden_latency().map_or([f64::NAN; 2], |h| [h.position, h.velocity].map(number))
}

/// The column of the delay margin.
pub(super) const MARGIN: usize = 5;

fn table() -> Table {
    let columns = [
        "integrator",
        "critical latency of whole steps, predicted (steps)",
        "of split steps, predicted (steps)",
        "of split steps, measured (steps)",
        "measured (s)",
        "delay margin of the continuous loop (s)",
    ];
    Table::new("critical latencies", &columns)
}

fn row(title: &str, onset: Option<&CriticalLatency>, margin: f64) -> Vec<Cell> {
    let of = |value: fn(&CriticalLatency) -> f64| Cell::from(onset.map(value));
    vec![
        title.into(),
        of(|o| o.polynomial),
        of(|o| o.predicted),
        of(|o| o.measured),
        of(|o| o.measured * DT),
        margin.into(),
    ]
}

/// The findings about the onset of one loop.
fn find(record: &mut Record, name: &str, title: &str, onset: &CriticalLatency) {
    let Feedback { position, velocity } = GAINS;
    let gains = format!("K = ({}, {})", number(position, 3), number(velocity, 3));
    record.find(Finding::predicted(
        format!("latency.onset.{name}.whole"),
        format!("{title}, {gains}: the longest latency in whole steps before the loop grows"),
        "steps",
        onset.polynomial.floor(),
        onset.whole,
        Tolerance::exact("whole latencies are tried one by one"),
    ));
    record.find(at_any_part(name, &format!("{title}, {gains}"), onset));
}

fn at_any_part(name: &str, title: &str, onset: &CriticalLatency) -> Finding {
    Finding::predicted(
        format!("latency.onset.{name}"),
        format!(
            "{title}: latency at which the loop begins to grow, with steps that split where the command arrives"
        ),
        "steps",
        onset.predicted,
        onset.measured,
        Tolerance::absolute(
            1e-5,
            "a rate of growth is measured to 10⁻⁸ a step, and changes by 10⁻³ with a step of latency",
        ),
    )
}

fn lost(method: Method, title: &str, measured: f64, predicted: f64) -> Finding {
    // Ω, where the continuous loop begins to swing.
    let half = SPRING.omega2 + GAINS.velocity * GAINS.velocity / 2.0;
    let rest = SPRING.omega2 * SPRING.omega2 - GAINS.position * GAINS.position;
    let square = half + (half * half - rest).sqrt();
    Finding::predicted(
        format!("latency.onset.{}.lost", method.name()),
        format!(
            "{title}: what the simulated loop lacks of the delay margin, beside what integrator and hold hide"
        ),
        "steps",
        predicted,
        measured,
        Tolerance::absolute(
            square * DT * DT,
            "the hidden latency is the first term; the next is (ΩΔt)² where the loop swings with Ω",
        ),
    )
}

/// Returns the critical latencies by theory and simulation.
fn onset(lab: &Lab<'_>, case: &Loop) -> Result<CriticalLatency, StudyError> {
    let polynomial = case.windows().critical().unwrap_or(f64::NAN);
    let (low, high) = ((polynomial - 1.0).max(0.0), polynomial + 1.0);
    let predicted = bisect(low, high, |d| Ok(case.predicted(d) > 0.0))?;
    let measured = bisect(low, high, |d| Ok(case.measured(lab, d, STEPS)? > 0.0))?;
    let mut whole = f64::NAN;
    for d in 0..=polynomial.min(1e3) as u32 + 3 {
        if case.measured(lab, d.into(), STEPS)? >= 0.0 {
            break;
        }
        whole = d.into();
    }
    Ok(CriticalLatency { polynomial, predicted, measured, whole })
}

/// The middle of the last interval in which `grows` changes from no to yes.
fn bisect(
    mut low: f64,
    mut high: f64,
    grows: impl Fn(f64) -> Result<bool, StudyError>,
) -> Result<f64, StudyError> {
    while high - low > WIDTH {
        let middle = 0.5 * (low + high);
        if grows(middle)? { high = middle } else { low = middle }
    }
    Ok(0.5 * (low + high))
}

/// How fast the loop is damped, in time and half of what it bears late.
fn damping(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let case = Loop { method: Method::VelocityVerlet, dt: DT, gains: GAINS };
    let half = (case.windows().critical().unwrap_or(f64::NAN) / 2.0).round();
    for (name, late) in [("in-time", 0.0), ("late", half)] {
        record.find(Finding::predicted(
            format!("latency.damping.{name}"),
            format!(
                "{}, Δt = {}, K = (10, 2): growth a step of the amplitude, {} steps late",
                case.method.title(),
                seconds(DT, 3),
                number(late, 3)
            ),
            "1",
            case.predicted(late),
            case.measured(lab, late, STEPS)?,
            Tolerance::absolute(1e-11, "what a mean over the run leaves of the swing of the orbit"),
        ));
    }
    Ok(())
}

/// Larger and smaller gains.
fn gains(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let loops = FACTORS.map(|factor| {
        let gains =
            Feedback { position: factor * GAINS.position, velocity: factor * GAINS.velocity };
        Loop { method: Method::VelocityVerlet, dt: DT, gains }
    });
    let onsets = lab.sweep("critical latencies by gain", &loops, |case| onset(lab, case))?;
    for (factor, onset) in FACTORS.iter().zip(&onsets) {
        let title = format!(
            "velocity Verlet, Δt = {}, gains {} times (10, 2)",
            seconds(DT, 3),
            number(*factor, 3)
        );
        record.find(at_any_part(&format!("gains-{factor}"), &title, onset));
    }
    Ok(())
}
