//! The claim of the source report about the order of imperfections.

use libration_report::notation::count;
use libration_report::record::{Finding, Judgement, Record, Ruling};

use super::imperfection::{Kind, PROFILES};
use super::{SHORT, id};

/// Judges it from the findings of the record.
pub(super) fn judge(record: &mut Record, long: u64) {
    let settings = PROFILES.iter().flat_map(|profile| [SHORT, long].map(|steps| (profile, steps)));
    let ids: Vec<String> = settings
        .flat_map(|(profile, steps)| Kind::ALL.map(|kind| id(kind, profile, steps)))
        .collect();
    let ids: Vec<&str> = ids.iter().map(String::as_str).collect();
    let ruling = Ruling {
        id: "C67",
        source: "7.7, 9.6",
        text: "Latency matters more than jitter, jitter more than asynchrony, and that more than precision.",
        findings: &ids,
    };
    record.judge(ruling, |findings| {
        let falls = |f: &[&Finding]| f.windows(2).all(|pair| pair[0].measured > pair[1].measured);
        let orders: Vec<bool> = findings.chunks(Kind::ALL.len()).map(falls).collect();
        // Two horizons each.
        let named = PROFILES.iter().zip(orders.chunks(2)).filter_map(|(profile, order)| {
            let after = match *order {
                [true, true] => format!("{SHORT} and {} steps", count(long)),
                [true, _] => format!("{SHORT} steps"),
                [_, true] => format!("{} steps", count(long)),
                _ => return None,
            };
            Some(format!("({}) after {after}", profile.title))
        });
        let named: Vec<String> = named.collect();
        let holds = orders.iter().filter(|&&order| order).count();
        let because = format!(
            "measured as the distance from the undisturbed orbit, this is the order in {holds} of \
             {} settings. It depends on the sizes and the horizon, and the source states neither",
            orders.len()
        );
        match holds {
            0 => Judgement::refuted(because),
            n if n == orders.len() => Judgement::confirmed(because),
            _ => Judgement::conditional(because).only(format!("at {}", named.join(" and at "))),
        }
    });
}
