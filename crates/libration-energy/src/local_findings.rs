//! The findings about local deviations of an energy.

use libration_report::notation::number;

use crate::local_deviations::{LocalDeviation, Roughness};
use crate::{Finding, FindingKind, Run};

/// Part of the duration by which the same event of two runs may differ in time.
const SAME_TIME: f64 = 0.05;
/// Part of a deviation of the longest step that the shortest step keeps if it does not fall with the step.
const STAYS: f64 = 0.5;

/// That a run is out of line at a time, and others are not, or all by as much; else that the energy of a run jumps.
///
/// An event of the system is out of line in all runs at the same time, and by less with a shorter step.
pub(crate) fn local(runs: &[Run], roughness: &[Roughness]) -> Option<Finding> {
    deviation(runs, roughness).or_else(|| jump(runs))
}

fn deviation(runs: &[Run], roughness: &[Roughness]) -> Option<Finding> {
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
        Some(Finding::new(
            FindingKind::LocalDeviation,
            format!(
                "the energy of `{}` is out of line at t = {} s: {} off the curve through the neighbours, {} s apart, {} times as far as elsewhere; {others}",
                run.title,
                number(deviation.time, 6),
                number(deviation.size, 2),
                number(deviation.spacing, 2),
                number(deviation.ratio, 2)
            ),
        ))
    })
}

fn jump(runs: &[Run]) -> Option<Finding> {
    let time = |run: &Run| run.walk.and_then(|walk| walk.jump);
    let run = runs.iter().find(|run| time(run).is_some())?;
    let at = time(run)?;
    Some(Finding::new(
        FindingKind::LocalDeviation,
        format!(
            "the mean energy of `{}` jumps at about t = {} s, by more than it changes in the rest of the run",
            run.title,
            number(at, 3)
        ),
    ))
}
