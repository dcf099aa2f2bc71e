//! Random latencies, drawn for every step.

use libration::Method;
use libration::analysis::Plant;
use libration::control::RandomLatency;
use libration::control::controller::StateFeedback;
use libration::control::delay::Random;
use libration::ensemble::{All, Loops, Setup};
use libration::system::BaselineOnly;
use libration_report::Record;
use libration_report::notation::{count, number, seconds};
use libration_report::record::{Finding, Table, Tolerance};
use libration_study::{Lab, StudyError};

use super::critical_latency::GAINS;
use super::loop_simulation::{ORIGIN, SPRING, START};

/// The time step, in s.
const DT: f64 = 0.1;

/// Probabilities that a latency stays for another step.
const HOLDS: [f64; 2] = [0.0, 0.5];

/// The integrators of the loops.
const METHODS: [Method; 2] = [Method::VelocityVerlet, Method::Rk4];

/// Steps after which moments are compared.
const AFTER: [u64; 3] = [10, 30, 60];

/// Where growth is measured from, and where to at the latest: moments swing, so it ends where they grow by theory as
/// they do in the long run.
const SLOPE: [u64; 2] = [20, 70];

/// Of the latencies; another gives other numbers within the same errors.
const SEED: u64 = 20;

/// Tolerance of a mean in standard errors.
const SIGMAS: f64 = 3.0;

/// Parts of the loops whose scatter gives the standard error of a growth.
const PARTS: usize = 32;

/// Two latencies, equally probable, that are drawn independently or stay for a while.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let mut table = Table::new(
        "random latency",
        &[
            "integrator",
            "a latency stays with probability",
            "ρ of the second moments, predicted",
            "measured",
            "standard error",
        ],
    );
    let cases: Vec<(Method, f64)> =
        METHODS.iter().flat_map(|&method| HOLDS.map(|hold| (method, hold))).collect();
    let found = lab.sweep("random latencies", &cases, |&(method, hold)| one(lab, method, hold))?;
    for ((method, hold), (findings, row)) in cases.into_iter().zip(found) {
        findings.into_iter().for_each(|finding| record.find(finding));
        table.push([
            method.title().into(),
            hold.into(),
            row[0].into(),
            row[1].into(),
            row[2].into(),
        ]);
    }
    let exact = Plant::exact(SPRING, ORIGIN, DT);
    for hold in HOLDS {
        let Ok(latency) = RandomLatency::new(vec![(0.0, 0.5), (2.0, 0.5)], hold) else { continue };
        let radius = exact.mean_square_late(GAINS, &latency);
        table.push(["exact steps".into(), hold.into(), radius.into(), None.into(), None.into()]);
    }
    record.tables.push(table);
    Ok(())
}

/// The findings for a hold probability; growth as predicted and measured, and its standard error.
fn one(lab: &Lab<'_>, method: Method, hold: f64) -> Result<(Vec<Finding>, [f64; 3]), StudyError> {
    // Of valid probabilities.
    let Ok(latency) = RandomLatency::new(vec![(0.0, 0.5), (2.0, 0.5)], hold) else {
        return Ok((Vec::new(), [f64::NAN; 3]));
    };
    let name = method.name();
    let loops = PARTS * lab.effort.choose(400, 1000, 8000);
    let plant = Plant::new(method, SPRING, ORIGIN, DT);
    let setup = Setup::new(All(BaselineOnly(SPRING)), method)
        .controller(StateFeedback::to_origin(GAINS))
        .delay(Random(&latency));
    let starts = vec![START; loops];
    let mut all = Loops::new(setup, DT, SEED, [0.0], &starts, lab.alone()?)?;
    let title = format!(
        "{}, Δt = {}, K = (10, 2), 0 or 2 steps late, held with probability {}",
        method.title(),
        seconds(DT, 3),
        number(hold, 2)
    );
    let predicted = plant.mean_square_late(GAINS, &latency);
    let energy = |step| {
        let [qq, _, vv] = plant.moments_late(GAINS, &latency, &START, step);
        SPRING.omega2 * qq + vv
    };
    let [from, latest] = SLOPE;
    let early = energy(from);
    let slope = |to: u64| (energy(to) / early).powf(1.0 / (to - from) as f64);
    let (mut to, mut over_the_same_steps) = (latest, f64::INFINITY);
    for step in latest - 40..=latest {
        let now = slope(step);
        if (now - predicted).abs() < (over_the_same_steps - predicted).abs() {
            (to, over_the_same_steps) = (step, now);
        }
    }
    let span = (to - from) as f64;
    let mut findings = Vec::new();
    let mut sizes: Vec<Vec<f64>> = Vec::new();
    for step in 1..=latest {
        all.advance(1)?;
        let trajectories = all.trajectories();
        let squares: Vec<f64> = trajectories.q(0).iter().map(|q| q * q).collect();
        if AFTER.contains(&step) {
            let [wanted, ..] = plant.moments_late(GAINS, &latency, &START, step);
            let [mean, error] = mean(&squares);
            findings.push(Finding::predicted(
                format!("latency.random.{name}.hold-{hold}.after-{step}"),
                format!(
                    "{title}: mean of q² over {} loops after {step} steps",
                    count(loops as u64)
                ),
                "m²",
                wanted,
                mean,
                Tolerance::absolute(
                    SIGMAS * error,
                    "three standard errors of the mean, from the loops themselves",
                ),
            ));
        }
        if [from, to].contains(&step) {
            // Without the swing that q² alone has.
            let v = trajectories.v(0).iter();
            let energy = |(q, v): (&f64, &f64)| SPRING.omega2 * q + v * v;
            sizes.push(squares.iter().zip(v).map(energy).collect());
        }
    }
    let [measured, error] = match sizes.as_slice() {
        [early, late] => slope_of(early, late, span),
        _ => [f64::NAN; 2],
    };
    findings.push(Finding::predicted(
        format!("latency.random.{name}.hold-{hold}.radius"),
        format!("{title}: factor of the second moments a step, from step {from} to {to}"),
        "1",
        predicted,
        measured,
        Tolerance::absolute(
            SIGMAS * error + (predicted - over_the_same_steps).abs(),
            "three standard errors, and what theory says that moments still swing over the same steps",
        ),
    ));
    Ok((findings, [predicted, measured, error]))
}

/// The growth a step of the sum of some numbers over `span` steps, and its standard error, from that of the ratio of both
/// sums in parts.
fn slope_of(early: &[f64], late: &[f64], span: f64) -> [f64; 2] {
    let ratio = late.iter().sum::<f64>() / early.iter().sum::<f64>();
    let size = early.iter().sum::<f64>() / PARTS as f64;
    let part = early.len() / PARTS;
    let pairs = early.chunks(part).zip(late.chunks(part));
    let strays = pairs.map(|(a, b)| (b.iter().sum::<f64>() - ratio * a.iter().sum::<f64>()) / size);
    let [_, error] = mean(&strays.collect::<Vec<_>>());
    let slope = ratio.powf(1.0 / span);
    [slope, slope * error / ratio / span]
}

/// The mean of some numbers, and its standard error.
fn mean(numbers: &[f64]) -> [f64; 2] {
    let count = numbers.len() as f64;
    let mean = numbers.iter().sum::<f64>() / count;
    let variance = numbers.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (count - 1.0);
    [mean, (variance / count).sqrt()]
}
