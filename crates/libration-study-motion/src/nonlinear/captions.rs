//! Captions of the chapter, from the results of the runs.

use libration::Method;
use libration_report::notation::{list, number};
use libration_report::record::{Finding, Record, RecordError};

/// The powers of Δt by which theory lets the energy of each method drift in a turn of a closed orbit,
/// where that was found.
pub(super) fn rates(record: &Record) -> Option<String> {
    let rate = |m: Method| {
        let end = format!(".{}.rate-order", m.name());
        let mut found = record.findings.iter().filter(|f| f.id.ends_with(&end) && f.agrees());
        let power = match found.next()?.predicted? {
            1.0 => "Δt".to_owned(),
            power => format!("Δt^{{{}}}", number(power, 2)),
        };
        Some(format!("{power} with {}", m.title()))
    };
    let rates: Vec<String> = Method::ALL.into_iter().filter_map(rate).collect();
    let rates: Vec<&str> = rates.iter().map(String::as_str).collect();
    (!rates.is_empty()).then(|| list(&rates))
}

/// The measured behaviour of each method’s growth: that it stays in a band, climbs, or takes up as
/// much energy as there was.
pub(super) fn growths(record: &Record) -> Result<String, RecordError> {
    let of = |m: Method| {
        let end = format!(".{}.growth", m.name());
        record.findings.iter().filter(move |f| f.id.ends_with(&end))
    };
    let with = |keep: &dyn Fn(Method) -> bool| {
        let titles: Vec<&str> =
            Method::ALL.into_iter().filter(|&m| keep(m)).map(Method::title).collect();
        (!titles.is_empty()).then(|| list(&titles))
    };
    let as_promised = |f: &Finding, exponent: f64| f.predicted == Some(exponent) && f.agrees();
    let stays = |m| of(m).next().is_some() && of(m).all(|f| as_promised(f, 0.0));
    let climbs = |m| of(m).any(|f| as_promised(f, 1.0));
    let rows = &record.table("growth")?.rows;
    let taken_up = |m: Method| {
        let mut own = rows.iter().filter(|row| row[1].typeset(6) == m.title());
        own.any(|row| row[2].value().is_none_or(|drift| drift >= 1.0))
    };
    let sentences = [
        ("Drift within a band on every system", with(&stays)),
        ("Drift proportional to time on closed orbits", with(&climbs)),
        ("Drift of at least the initial energy on some system", with(&taken_up)),
    ];
    let sentences =
        sentences.into_iter().filter_map(|(what, who)| Some(format!("{what}: {}.", who?)));
    Ok(sentences.collect::<Vec<_>>().join(" "))
}

/// Returns the time step of the portraits and their interpretation.
pub(super) fn step_of_portraits(record: &Record, systems: &[(String, String)]) -> String {
    let shown = |m: Method| {
        let end = format!("-{}", m.name());
        record.series.iter().any(|s| s.name.starts_with("portrait-") && s.name.ends_with(&end))
    };
    let limit = |(name, _): &(String, String)| {
        let id = format!("nonlinear.{name}.{}.start-limit", Method::VelocityVerlet.name());
        record.finding(&id).is_ok_and(|f| f.measured > 0.0)
    };
    let found = systems.iter().filter(|system| limit(system)).count();
    let step = match found {
        0 => "Time step: a sixteenth of a turn.",
        all if all == systems.len() => {
            "Time step: half of the largest stable step of velocity Verlet."
        }
        _ => {
            "Time step: half of the largest stable step of velocity Verlet, or a sixteenth of a turn \
             if that is unknown."
        }
    };
    let mut words = step.to_owned();
    let keeps_areas = |(name, _): &(String, String)| {
        let id = format!("nonlinear.{name}.{}.symplecticity", Method::VelocityVerlet.name());
        record.finding(&id).is_ok_and(|f| f.agrees() && f.predicted == Some(0.0))
    };
    if shown(Method::VelocityVerlet) && systems.iter().all(keeps_areas) {
        words += " Verlet preserves areas of phase space: its orbit may rotate or scatter, but does \
                  not spiral.";
    }
    if shown(Method::Rk4) {
        words += " RK4 does not preserve them.";
    }
    words
}

#[cfg(test)]
mod tests {
    use libration_report::page::Page;
    use libration_report::record::{Cell, Relation, Table, Tolerance};

    use super::*;

    #[test]
    fn captions_are_put_together_from_what_was_found() {
        let mut record = Record::new("nonlinear", "?");
        let mut table = Table::new("growth", &["system", "integrator", "largest drift"]);
        table.push(["pendulum".into(), "leapfrog".into(), 1e-4.into()]);
        table.push(["pendulum".into(), "explicit Euler".into(), Cell::absent("overflows")]);
        record.tables.push(table);
        let bound = Tolerance::absolute(0.2, "");
        let id = "nonlinear.pendulum.leapfrog.growth";
        record.find(Finding::related(id, "", "1", Relation::AtMost, 0.0, 0.0, bound.clone()));
        let id = "nonlinear.pendulum.explicit-euler.rate-order";
        record.find(Finding::predicted(id, "", "1", 1.0, 1.01, bound));
        let caption = growths(&record).unwrap_or_default();
        assert_eq!(
            caption,
            "Drift within a band on every system: leapfrog. Drift of at least the initial energy on some \
             system: explicit Euler."
        );
        assert_eq!(rates(&record).as_deref(), Some("Δt with explicit Euler"));
        let systems = [("pendulum".to_owned(), "pendulum".to_owned())];
        let caption = step_of_portraits(&record, &systems);
        assert_eq!(caption, "Time step: a sixteenth of a turn.");
        let mut page = Page::default();
        assert!(super::super::render::summary(&record, &mut page, &systems).is_ok());
        assert!(page.answer.ends_with("pendulum: explicit Euler overflows, leapfrog 0.0001."));
    }
}
