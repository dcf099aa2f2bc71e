//! Damaged logs: one bad sample, a bump, a jump at the end. Means and standard deviations hide them.

use libration_energy::{EnergyTrace, Requirement, audit};
use libration_report::verdict::{Outcome, Verdict};

use crate::honest::{pendulum, verlet};
use crate::programs::{self, Noise, oscillator};

fn verdict(traces: &[EnergyTrace]) -> Verdict {
    match audit(traces, Requirement::default()) {
        Ok(report) => report.verdict,
        Err(error) => panic!("{error}"),
    }
}

/// Multiplies energies by a factor that depends on the part of the duration.
fn scale(trace: &mut EnergyTrace, factor: impl Fn(f64) -> f64) {
    let duration = trace.duration();
    for (time, energy) in trace.times.iter().zip(&mut trace.energies) {
        *energy *= factor(time / duration);
    }
}

/// A bump by a factor of 1.01 at 60 % of the duration.
fn bump(trace: &mut EnergyTrace, width: f64) {
    scale(trace, |part| 1.0 + 0.01 * (-0.5 * ((part - 0.6) / width).powi(2)).exp());
}

fn at(trace: &EnergyTrace, part: f64) -> usize {
    (part * trace.energies.len() as f64) as usize
}

fn sample(trace: &mut EnergyTrace, part: f64) -> &mut f64 {
    let at = at(trace, part);
    &mut trace.energies[at]
}

/// A name and a damage.
type Damage = (&'static str, fn(&mut EnergyTrace));

const DAMAGES: [Damage; 21] = [
    ("sample of +1 %", |t| *sample(t, 0.3) *= 1.01),
    ("sample of +0.1 %", |t| *sample(t, 0.3) *= 1.001),
    ("first sample", |t| t.energies[0] *= 1.01),
    ("second sample", |t| t.energies[1] *= 1.01),
    ("last sample", |t| *sample(t, 0.99999) *= 1.01),
    ("two samples", |t| {
        [0.3, 0.7].into_iter().for_each(|part| *sample(t, part) *= 1.0 + 0.01 * part)
    }),
    ("sign of a sample", |t| *sample(t, 0.3) *= -1.0),
    ("zero row", |t| *sample(t, 0.3) = 0.0),
    ("mark of a missing value", |t| *sample(t, 0.3) = -999.0),
    ("jump in the last 0.1 s", |t| {
        let part = 1.0 - 0.1 / t.duration();
        scale(t, |x| if x > part { 1.01 } else { 1.0 });
    }),
    ("jump in the last per cent", |t| scale(t, |x| if x > 0.99 { 1.01 } else { 1.0 })),
    ("jump midway", |t| scale(t, |x| if x > 0.4 { 1.01 } else { 1.0 })),
    ("change of the unit midway", |t| scale(t, |x| if x > 0.5 { 1000.0 } else { 1.0 })),
    ("pump in the last per cent", |t| scale(t, |x| 1.0 + (x - 0.99).max(0.0))),
    ("pump that begins smoothly", |t| scale(t, |x| 1.0 + 100.0 * (x - 0.99).max(0.0).powi(2))),
    ("narrow bump", |t| bump(t, 0.0005)),
    ("bump", |t| bump(t, 0.005)),
    ("wide bump", |t| bump(t, 0.05)),
    ("energy that stands still", |t| {
        let (from, to) = (at(t, 0.5), at(t, 0.55));
        let energy = t.energies[from];
        t.energies[from..to].fill(energy);
    }),
    ("rows that change places", |t| {
        let (from, to) = (at(t, 0.33) + 7, at(t, 0.5));
        t.energies.swap(from, to);
    }),
    ("noise for 2 %", |t| {
        let mut noise = Noise(9);
        let (from, to) = (at(t, 0.5), at(t, 0.52));
        t.energies[from..to].iter_mut().for_each(|energy| *energy *= 1.0 + 0.01 * noise.normal());
    }),
];

#[test]
fn damage_of_one_run_is_no_clean_bill_whichever_the_run() {
    let oscillators = [0.01, 0.005, 0.0025].map(|dt| oscillator(programs::verlet, dt, 30.0));
    let pendulums = [0.02, 0.01, 0.005].map(|dt| verlet(&pendulum(2.5), dt, 60.0, 1));
    for clean in [oscillators, pendulums] {
        assert_eq!(verdict(&clean).outcome, Outcome::NoFault);
        for (name, damage) in DAMAGES {
            for run in 0..3 {
                let mut traces = clean.clone();
                damage(&mut traces[run]);
                let verdict = verdict(&traces);
                assert!(!verdict.is_good(), "{name} of run {run}: {verdict}");
            }
        }
    }
}

#[test]
fn one_bad_sample_among_a_million_is_told_with_its_time() {
    let clean = [0.02, 0.01, 0.005].map(|dt| oscillator(programs::verlet, dt, 5000.0));
    let mut traces = clean;
    traces[2].energies[123_456] *= 1.01;
    let verdict = verdict(&traces);
    assert_eq!(verdict.outcome, Outcome::Unknown);
    // 123,456 steps of 5 ms.
    assert!(
        verdict.evidence.contains("`oscillator 0.005` is out of line at t = 617.28 s"),
        "{verdict}"
    );
}

#[test]
fn a_jump_of_all_runs_at_one_time_is_told_if_it_does_not_fall_with_the_step() {
    let jumps = |power: i32| {
        let traces = [0.01, 0.005, 0.0025].map(|dt| {
            let mut trace = oscillator(programs::verlet, dt, 30.0);
            let size = 1e-4 * (dt / 0.01_f64).powi(power);
            scale(&mut trace, |part| if part > 0.7 { 1.0 + size } else { 1.0 });
            trace
        });
        verdict(&traces)
    };
    let verdict = jumps(0);
    assert_eq!(verdict.outcome, Outcome::Unknown);
    assert!(verdict.evidence.contains("it does not fall with the step"), "{verdict}");
    // As of a contact whose stiffness jumps: truncation.
    assert_eq!(jumps(2).outcome, Outcome::NoFault, "{}", jumps(2));
}

#[test]
fn missing_samples_are_named_as_not_examined() {
    let mut traces = [0.01, 0.005].map(|dt| oscillator(programs::verlet, dt, 30.0));
    traces[0].times.drain(1001..1201);
    traces[0].energies.drain(1001..1201);
    let verdict = verdict(&traces);
    let expected = "10 to 12.01 s of `oscillator 0.01`, where samples are missing";
    assert!(verdict.not_examined.contains(&expected.to_owned()), "{verdict}");
}
