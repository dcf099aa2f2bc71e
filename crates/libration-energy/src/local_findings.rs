//! The findings about local deviations of an energy.

use libration_report::notation::number;

use crate::local_deviations::{LocalDeviation, Roughness};
use crate::{Finding, FindingKind, Run};

/// Part of the duration by which the same event of two runs may differ in time.
const SAME_TIME: f64 = 0.05;
/// Part of a deviation of the longest step that the shortest step keeps if it does not fall with the step.
const STAYS: f64 = 0.5;

/// That a run is out of line at a time, and others are not, or all by as much; else that its energy stands still alone.
///
/// An event of the system is out of line in all runs at the same time, and by less with a shorter step.
pub(crate) fn local(runs: &[Run], roughness: &[Roughness]) -> Option<Finding> {
    let found = deviation(runs, roughness).or_else(|| repeated(runs, roughness));
    found.map(|text| Finding::new(FindingKind::LocalDeviation, text))
}

fn repeated(runs: &[Run], roughness: &[Roughness]) -> Option<String> {
    runs.iter().zip(roughness).find_map(|(run, own)| {
        let repeated = own.repeated()?;
        roughness.iter().any(|other| !other.repeats_as(&repeated)).then(|| {
            format!(
                "the energy of `{}` is the same number in {} samples up to t = {} s, and another run does not stand still for as long",
                run.title,
                number(repeated.size + 1.0, 4),
                number(repeated.time, 6)
            )
        })
    })
}

fn deviation(runs: &[Run], roughness: &[Roughness]) -> Option<String> {
    let deviations = roughness.iter().map(Roughness::out_of_line);
    runs.iter().zip(deviations).find_map(|(run, deviation)| {
        let deviation = deviation?;
        let same = |other: &Roughness| other.same(&deviation, SAME_TIME * run.duration);
        let all: Option<Vec<LocalDeviation>> = roughness.iter().map(same).collect();
        let others = match all {
            None => "another run has nothing like it there",
            Some(all) if all[0].size > STAYS * all[all.len() - 1].size => {
                "all runs have it there, and it does not fall with the step"
            }
            Some(_) => return None,
        };
        Some(format!(
            "the energy of `{}` is out of line at t = {} s: {} off the curve through the neighbours, {} s apart, {} times as far as elsewhere; {others}",
            run.title,
            number(deviation.time, 6),
            number(deviation.size, 2),
            number(deviation.spacing, 2),
            number(deviation.ratio, 2)
        ))
    })
}
