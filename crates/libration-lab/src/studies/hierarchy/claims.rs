//! The claim of the source report about the order of imperfections.

use super::imperfection::{Kind, PROFILES};
use super::{SHORT, id};
use crate::notation::{count, list};
use crate::record::{Finding, Judgement, Record, Ruling};

/// Judges it from the findings of the record.
pub(super) fn judge(record: &mut Record, long: u64) {
    let settings: Vec<(String, Vec<String>)> = PROFILES
        .iter()
        .flat_map(|profile| [SHORT, long].map(|steps| (profile, steps)))
        .map(|(profile, steps)| {
            let ids = Kind::ALL.map(|kind| id(kind, profile, steps)).to_vec();
            (format!("{} after {} steps", profile.title, count(steps)), ids)
        })
        .collect();
    let ids: Vec<&str> = settings.iter().flat_map(|(_, ids)| ids).map(String::as_str).collect();
    let ruling = Ruling {
        id: "C67",
        source: "7.7, 9.6",
        text: "Latency matters more than jitter, jitter more than asynchrony, and that more than precision.",
        findings: &ids,
    };
    record.judge(ruling, |findings| {
        let falls = |f: &[&Finding]| f.windows(2).all(|pair| pair[0].measured > pair[1].measured);
        let holds: Vec<&str> = settings
            .iter()
            .zip(findings.chunks(Kind::ALL.len()))
            .filter(|(_, f)| falls(f))
            .map(|((title, _), _)| title.as_str())
            .collect();
        let because = format!(
            "measured as the distance from the undisturbed orbit, that is the order in {} of {} settings: \
             the sizes and the horizon decide, of which the source names none",
            holds.len(),
            settings.len()
        );
        match holds.len() {
            0 => Judgement::refuted(because),
            n if n == settings.len() => Judgement::confirmed(because),
            _ => Judgement::conditional(because).only(format!("at {}", list(&holds))),
        }
    });
}
