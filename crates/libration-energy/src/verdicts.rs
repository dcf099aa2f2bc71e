//! The verdicts of an audit.

use libration_report::notation::{number, plural};
use libration_report::verdict::{Outcome, Verdict};

use crate::cause::OscillationCause;
use crate::{EnergyReport, EnergyTrace, Finding, FindingKind, LargestDt};

/// Part of an energy below which its digits are those of double precision.
const FINE: f64 = 1e-12;

/// Whether the runs show a fault. What they do not tell is unknown, and no success.
pub(crate) fn of_faults(report: &EnergyReport) -> Verdict {
    let faults: Vec<&str> = report
        .findings
        .iter()
        .filter(|finding| finding.is_fault)
        .map(|finding| finding.kind.name())
        .collect();
    let reasons = unclear(report);
    let verdict = match (faults.is_empty(), reasons.is_empty()) {
        (false, _) => Verdict::new(Outcome::Fault, faults.join(", ")),
        (true, false) => Verdict::unknown(reasons.join("; ")),
        (true, true) => Verdict::new(Outcome::NoFault, plural(report.runs.len(), "run")),
    };
    let coarse = report
        .runs
        .iter()
        .filter(|run| !run.resolves_oscillation())
        .map(|run| run.resolution)
        .fold(0.0, f64::max);
    // Double precision has more digits than anybody asks for.
    let digits = report.runs.iter().map(|run| run.largest_energy).fold(0.0, f64::max);
    let verdict = match coarse > FINE * digits {
        true => verdict
            .without(format!("fluctuations below {}, the digits of a run", number(coarse, 2))),
        false => verdict,
    };
    let gaps = report.runs.iter().filter_map(|run| run.gap.map(|gap| (run, gap)));
    let verdict = gaps.fold(verdict, |verdict, (run, [from, to])| {
        let [from, to] = [from, to].map(|time| number(time, 6));
        verdict.without(format!("{from} to {to} s of `{}`, where samples are missing", run.title))
    });
    match report.is_dt_assumed {
        true => verdict.without("time steps, taken from the spacing of the samples"),
        false => verdict,
    }
}

/// Why the runs do not tell whether there is a fault.
fn unclear(report: &EnergyReport) -> Vec<&str> {
    let has = |kind| report.findings.iter().any(|finding| finding.kind == kind);
    let reasons = [
        (
            report.oscillation_cause == OscillationCause::Unclear,
            "how the oscillation depends on the step is unclear",
        ),
        (has(FindingKind::UnclearDrift), "how the drift depends on the step is unclear"),
        (has(FindingKind::UnclearWalk), "how the random walk depends on the step is unclear"),
        (has(FindingKind::DifferentStart), "the runs start at different energies"),
    ];
    let named = reasons.into_iter().filter(|(holds, _)| *holds).map(|(_, reason)| reason);
    let is_told = |finding: &&Finding| {
        matches!(finding.kind, FindingKind::NotConverged | FindingKind::LocalDeviation)
    };
    named.chain(report.findings.iter().filter(is_told).map(|own| own.text.as_str())).collect()
}

/// The deviation of a run over the horizon, relative to the allowed one: as measured, or at both ends of its interval.
struct Deviation {
    low: f64,
    high: f64,
}

impl Deviation {
    fn outcome(&self) -> Outcome {
        match self {
            Deviation { low, .. } if *low > 1.0 => Outcome::Exceeds,
            Deviation { high, .. } if *high <= 1.0 => Outcome::Within,
            _ => Outcome::Unknown,
        }
    }
}

/// Whether all runs keep the tolerance over the horizon; `predicted` are their deviations at the favourable and the unfavourable ends of
/// all intervals.
///
/// Up to its end a run is measured. Beyond, what it does is predicted; a run that exceeds the tolerance before its end does so in any case.
pub(crate) fn of_tolerance(
    report: &EnergyReport,
    traces: &[&EnergyTrace],
    largest: &LargestDt,
    predicted: &[[f64; 2]],
) -> Verdict {
    let allowed = largest.tolerance * largest.scale;
    let all: Vec<Deviation> = traces
        .iter()
        .zip(predicted)
        .map(|(trace, [low, high])| {
            let measured = measured(trace, largest.horizon) / allowed;
            match measured > 1.0 || largest.horizon <= trace.duration() {
                true => Deviation { low: measured, high: measured },
                false => Deviation { low: low / allowed, high: high / allowed },
            }
        })
        .collect();
    let is_predicted = report.runs.iter().any(|run| largest.horizon > run.duration);
    let converges = report.findings.iter().all(|own| own.kind != FindingKind::NotConverged);
    let count = |outcome| all.iter().filter(|own| own.outcome() == outcome).count();
    let (exceeding, unknown) = (count(Outcome::Exceeds), count(Outcome::Unknown));
    let of = format!("{} over {} s", largest.allowed_in_words(), number(largest.horizon, 4));
    let runs = plural(all.len(), "run");
    if exceeding > 0 {
        let sizes = all.iter().filter(|own| own.outcome() == Outcome::Exceeds).map(|own| own.low);
        let evidence = format!("{exceeding} of {runs} deviate by {} times {of}", range(sizes));
        let within: Vec<String> = all
            .iter()
            .zip(&report.runs)
            .filter(|(own, _)| own.outcome() == Outcome::Within)
            .map(|(_, run)| format!("{} s", number(run.dt, 4)))
            .collect();
        let evidence = match within.is_empty() {
            true => evidence,
            false => format!("{evidence}; those with a step of {} keep it", within.join(" and ")),
        };
        return Verdict::new(Outcome::Exceeds, evidence);
    }
    if unknown > 0 {
        return Verdict::unknown(format!(
            "{unknown} of {runs} may deviate by up to {} times {of}: their intervals beyond the end of the runs are too wide",
            range(all.iter().map(|own| own.high).filter(|high| *high > 1.0))
        ));
    }
    if is_predicted && !converges {
        return Verdict::unknown("the horizon is beyond the end of runs that do not converge");
    }
    let sizes = all.iter().map(|own| own.high);
    Verdict::new(
        Outcome::Within,
        format!("{runs} deviate by at most {} of {of}", number(sizes.fold(0.0, f64::max), 3)),
    )
}

/// The largest deviation from the energy at the start up to the horizon.
fn measured(trace: &EnergyTrace, horizon: f64) -> f64 {
    let (Some(start), Some(begin)) = (trace.energies.first(), trace.times.first()) else {
        return f64::INFINITY;
    };
    trace
        .times
        .iter()
        .zip(&trace.energies)
        .take_while(|(t, _)| *t - begin <= horizon)
        .fold(0.0, |most, (_, energy)| most.max((energy - start).abs()))
}

/// The smallest and the largest of some sizes, in words.
fn range(sizes: impl Iterator<Item = f64>) -> String {
    let (least, most) = sizes
        .fold((f64::INFINITY, 0.0_f64), |(least, most), size| (least.min(size), most.max(size)));
    let [least, most] = [least, most].map(|size| number(size, 2));
    if least == most { most } else { format!("{least} to {most}") }
}
