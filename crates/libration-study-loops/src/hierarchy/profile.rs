//! Effects of an imperfection on distance, energy and cost, and its share of the margin.

use libration_report::notation::{count, number};
use libration_report::record::{Cell, Finding, Record, Table, Tolerance};

use super::crossing::{FAR, crossing};
use super::disturbed_run::Effect;
use super::imperfection::{Kind, Profile};
use super::prediction;

/// The table, of which each imperfection in each size is a row.
pub(super) fn table(horizon: u64) -> Table {
    let energy = format!("rms of ln E/E₀ after {} steps", count(horizon));
    let columns = [
        "sizes",
        "imperfection",
        "size",
        "steps until 10 % off",
        "predicted",
        &energy,
        "predicted",
        "ΔJ/J₀",
        "predicted",
        "critical size",
        "margin used",
    ];
    Table::new("profile", &columns)
}

/// The steps until trajectories are [`FAR`] apart and the rms of `ln E/E₀` at the end; each found, and predicted.
pub(super) struct Found {
    steps: [Option<f64>; 2],
    energy: [Option<f64>; 2],
}

/// Leaves what is found beside what is predicted.
pub(super) fn find(
    record: &mut Record,
    kind: Kind,
    profile: &Profile,
    steps: &[u64],
    effect: &Effect,
) -> Found {
    let last = steps.last().copied().unwrap_or(0);
    let id = |what: &str| format!("hierarchy.{}.{}.{what}", profile.tag, kind.tag());
    let text = |what: &str| format!("{}, {}: {what}", profile.title, kind.title());
    let apart = crossing(steps, &effect.distance);
    let foreseen = prediction::horizon(kind, profile, FAR, last);
    if let Some((apart, foreseen)) = apart.zip(foreseen) {
        let share = 2.0 * prediction::tolerance(kind, profile).0 + 0.05;
        let why = "twice the tolerance of a distance, which grows at least like √n, and straight lines between six \
                   points of a decade";
        let text = text("steps until trajectories are a tenth of the orbit apart");
        let tolerance = Tolerance::relative(share, why);
        record.find(Finding::predicted(id("tenth"), text, "steps", foreseen, apart, tolerance));
    }
    let pumped = effect.energy.last().copied().unwrap_or(f64::NAN);
    let expected = prediction::energy(kind, profile, last);
    let what = text(&format!("rms of ln E/E₀ after {} steps", count(last)));
    record.find(match expected {
        Some(expected) => {
            let (size, why) = prediction::energy_tolerance(kind, profile, expected);
            let tolerance = Tolerance::absolute(size, why);
            Finding::predicted(id("energy"), what, "1", expected, pumped, tolerance)
        }
        None => Finding::measured(id("energy"), what, "1", pumped),
    });
    Found { steps: [apart, foreseen], energy: [Some(pumped), expected] }
}

/// A row of the table.
pub(super) fn row(
    kind: Kind,
    profile: &Profile,
    found: Found,
    cost: [Option<f64>; 2],
    margin: Option<f64>,
) -> Vec<Cell> {
    let size = kind.size(profile);
    let known = |x: Option<f64>| x.map_or_else(|| Cell::absent(""), Cell::from);
    let words: [Cell; 3] = [profile.title.into(), kind.title().into(), size.into()];
    let all = found.steps.into_iter().chain(found.energy).chain(cost).map(known);
    let margins = match (margin, kind) {
        (Some(margin), _) => [Cell::from(margin), Cell::from(size / margin)],
        // Beyond it steps would be negative, and none is tried.
        (None, Kind::Jitter) => {
            ["above 1/3".to_owned(), format!("below {}", number(3.0 * size, 2))].map(Cell::absent)
        }
        (None, _) => ["none known"; 2].map(Cell::absent),
    };
    words.into_iter().chain(all).chain(margins).collect()
}
