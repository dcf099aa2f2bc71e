//! The study `hierarchy`: profile of latency, jitter, asynchrony and precision.

mod claims;
mod cost;
mod crossing;
mod disturbed_run;
mod figures;
mod imperfection;
mod prediction;
mod profile;
mod render;
mod source_claims;

use imperfection::{Kind, PROFILES, Profile};
use libration_report::Record;
use libration_report::notation::count;
use libration_report::page::Page;
use libration_report::record::{Cell, Finding, RecordError, Series, Table, Tolerance};
use libration_study::{Lab, SourceClaim, Study, StudyError};

use self::source_claims::SOURCE_CLAIMS;

/// The study `hierarchy`.
#[derive(Clone, Copy, Debug)]
pub struct Hierarchy;

impl Study for Hierarchy {
    fn name(&self) -> &'static str {
        "hierarchy"
    }

    fn question(&self) -> &'static str {
        "Which imperfection matters most?"
    }

    fn source_claims(&self) -> &'static [SourceClaim] {
        SOURCE_CLAIMS
    }

    fn run(&self, lab: &Lab<'_>) -> Result<Record, StudyError> {
        let mut record = Record::new(self.name(), self.question());
        let mut table = Table::new(
            "divergence",
            &["sizes", "imperfection", "size", "after (steps)", "predicted", "measured"],
        );
        let mut whole = profile::table(horizon(lab));
        let margins = Kind::ALL.map(prediction::critical);
        let steps = checkpoints(horizon(lab));
        for profile in PROFILES {
            let effects = lab.sweep(profile.title, &Kind::ALL, |&kind| {
                Ok((
                    disturbed_run::run(lab, kind, profile, &steps)?,
                    cost::measured(lab, kind, profile)?,
                ))
            })?;
            let mut series = Series::new(format!("profile-{}", profile.tag)).with(
                "step",
                "1",
                steps.iter().map(|&n| n as f64).collect(),
            );
            for ((kind, margin), effect) in Kind::ALL.into_iter().zip(margins).zip(effects) {
                let (effect, rise) = effect;
                let found = profile::find(&mut record, kind, profile, &steps, &effect);
                let dearer = cost::predicted(kind, profile)?;
                cost::find(&mut record, kind, profile, rise, dearer);
                whole.push(profile::row(kind, profile, found, [Some(rise[0]), dearer], margin));
                let measured = effect.distance;
                let expected: Vec<f64> = steps
                    .iter()
                    .map(|&n| prediction::divergence(kind, profile, n).unwrap_or(f64::NAN))
                    .collect();
                for n in [SHORT, horizon(lab)] {
                    let Some(i) = steps.iter().position(|&step| step == n) else { continue };
                    find(&mut record, kind, profile, n, [expected[i], measured[i]]);
                    table.push([
                        profile.title.into(),
                        kind.title().into(),
                        kind.size(profile).into(),
                        n.into(),
                        if expected[i].is_nan() { Cell::absent("") } else { expected[i].into() },
                        measured[i].into(),
                    ]);
                }
                series = series.with(format!("{}_predicted", kind.tag()), "1", expected).with(
                    kind.tag(),
                    "1",
                    measured,
                );
            }
            record.series.push(series);
        }
        record.tables.push(whole);
        record.tables.push(table);
        claims::judge(&mut record, horizon(lab));
        Ok(record)
    }

    fn render(&self, record: &Record, page: &mut Page) -> Result<(), RecordError> {
        render::render(record, page)
    }
}

/// The short horizon of the source, in steps.
const SHORT: u64 = 1000;

/// The long one.
fn horizon(lab: &Lab<'_>) -> u64 {
    lab.effort.choose(10_000, 100_000, 1_000_000)
}

/// Steps at which trajectories are looked at: six in a decade, and both horizons.
fn checkpoints(last: u64) -> Vec<u64> {
    let mut steps: Vec<u64> = (0..)
        .map(|i| 10_f64.powf(f64::from(i) / 6.0).round() as u64)
        .take_while(|&n| n < last)
        .chain([SHORT, last])
        .collect();
    steps.sort_unstable();
    steps.dedup();
    steps
}

/// The identifier of a divergence.
fn id(kind: Kind, profile: &Profile, steps: u64) -> String {
    format!("hierarchy.{}.{}.{steps}", profile.tag, kind.tag())
}

fn find(
    record: &mut Record,
    kind: Kind,
    profile: &Profile,
    n: u64,
    [expected, measured]: [f64; 2],
) {
    let text = format!(
        "{}, {}: rms distance from the undisturbed orbit, in units of its size, after {} steps",
        profile.title,
        kind.title(),
        count(n)
    );
    let id = id(kind, profile, n);
    record.find(if expected.is_nan() {
        Finding::measured(id, text, "1", measured)
    } else {
        let (share, reason) = prediction::tolerance(kind, profile);
        Finding::predicted(id, text, "1", expected, measured, Tolerance::relative(share, reason))
    });
}
