//! Instability of two stable step lengths in alternation.

use libration::Method;
use libration::analysis::Plant;
use libration::control::Feedback;
use libration::control::clock::Recorded;
use libration::control::controller::StateFeedback;
use libration::ensemble::{All, Setup};
use libration::integrator::VelocityVerlet;
use libration::system::BaselineOnly;
use libration_report::record::{Finding, Record, Relation, Series, Tolerance};
use libration_study::{Lab, StudyError};

use super::{SEED, start};
use crate::loop_ensemble::run_snapshots;

/// `ωΔt` of a step on time.
const Z: f64 = 0.9;

/// `K_d` in units of `ω`: a damper.
const DAMPING: f64 = 0.15;

/// A step on time, and one after a tick that was missed.
const RATIOS: [f64; 2] = [1.0, 2.0];

/// Steps of the longest order that is tried.
const LONGEST: u32 = 12;

/// Finds the worst order and runs it, and each length alone.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    if !lab.config.integrators.contains(&Method::VelocityVerlet) {
        return Ok(());
    }
    let omega = lab.config.oscillator.omega();
    let (dt, model) = (Z / omega, lab.config.oscillator.system());
    let feedback = Feedback { position: 0.0, velocity: DAMPING * omega };
    let plant = Plant::new(VelocityVerlet, model, libration::State::origin(), dt);
    // It cannot fail: two lengths above zero, and a loop within the range of floats.
    let Ok(worst) = plant.switching(feedback, &RATIOS, LONGEST) else { return Ok(()) };
    let word: Vec<f64> = worst.word.iter().map(|&i| RATIOS[i]).collect();
    let told = word.iter().map(f64::to_string).collect::<Vec<_>>().join(", ");
    let orders = [("short", vec![RATIOS[0]]), ("long", vec![RATIOS[1]]), ("worst", word)];
    // Any number of steps that all orders divide.
    let block = orders.iter().map(|(_, order)| order.len() as u64).product::<u64>();
    let blocks = 600 / block + 1;
    for (name, order) in &orders {
        let radius = plant.periodic_radius(feedback, order).to_f64();
        let setup = Setup::new(All(BaselineOnly(model)), VelocityVerlet)
            .controller(StateFeedback::to_origin(feedback))
            .clock(Recorded::repeated(order));
        let at: Vec<u64> = (0..=2 * blocks).map(|n| n * block).collect();
        let seen = run_snapshots(lab, setup, (dt, SEED), &[start(lab)], &at)?;
        let size = |y: &libration::State<f64, 1>| model.omega2 * y.q[0] * y.q[0] + y.v[0] * y.v[0];
        let sizes: Vec<f64> = seen.iter().flat_map(|s| s.logarithms(size)).collect();
        let half = blocks as usize;
        let steps = (blocks * block) as f64;
        let growth = (sizes[2 * half] - sizes[half]) / 2.0 / steps;
        record.find(Finding::predicted(
            format!("jitter.switching.{name}"),
            match *name {
                "short" => {
                    "a damped oscillator in equal steps on time: growth of ln |y| in a step".into()
                }
                "long" => "the same in equal steps twice as long".into(),
                _ => format!(
                    "the same in steps that alternate in the worst order, {told} over and over"
                ),
            },
            "1",
            radius.ln(),
            growth,
            Tolerance::absolute(3.0 / steps, "where the state turns ln |y| swings, by less than 3"),
        ));
        record.series.push(
            Series::new(format!("switching-{name}"))
                .with("steps", "1", at.iter().map(|&n| n as f64).collect())
                .with("size", "1", sizes.iter().map(|x| ((x - sizes[0]) / 2.0).exp()).collect()),
        );
    }
    record.find(Finding::related(
        "jitter.switching.bound",
        format!("the largest growth in a step of any order of up to {LONGEST} steps, as a factor"),
        "1",
        Relation::AtMost,
        worst.upper,
        worst.lower,
        Tolerance::absolute(0.0, "what any order can reach, by the norms of all products"),
    ));
    Ok(())
}
