//! The claims of the source report about its own runs: a million steps of 1 ms.

use libration::Method;
use libration_report::notation::{number, seconds};
use libration_report::record::{Finding, Judgement, Record};
use libration_study::{Config, source_report};

use super::claims::{id, rule};
use super::tag;
use crate::drift::DriftSettings;

/// A claim about the source's own runs says nothing of other springs, starts, steps and horizons.
pub(super) fn is_run(config: &Config) -> bool {
    source_report::is_source_orbit(config)
        && config.get::<DriftSettings>().dt.contains(&source_report::DT)
        && config.get::<DriftSettings>().steps == source_report::STEPS
}

/// The claims about the source's own time step and horizon.
pub(super) fn judge(record: &mut Record) {
    let dt = source_report::DT;
    let of = |m: Method| id(m, dt, "largest");
    let leading = format!("drift.crossover.{}.leading-order", tag(dt));
    let pair = vec![of(Method::Rk4), of(Method::VelocityVerlet), leading];
    let compared = |f: &[&Finding]| {
        format!(
            "at Δt = {} RK4 has drifted by {} and velocity Verlet by {}",
            seconds(dt, 3),
            number(f[0].measured, 3),
            number(f[1].measured, 3)
        )
    };
    for (claim, source, text) in [
        ("C03", "2.6, 8.3", "Symplectic integrators are better over long horizons."),
        ("C16", "2.11, 4.4, 9.1", "RK4 fails a long-horizon test of a million steps."),
    ] {
        rule(record, (claim, source, text), &pair, |f| {
            let crossover = f[2].measured;
            let because = format!(
                "for the energy it holds only beyond 18/z⁴ steps, {} at this step; the source’s \
                 own setting, z = {} and a million steps, is only {} of that; {}",
                number(crossover, 2),
                number(source_report::OMEGA2.sqrt() * dt, 3),
                number(source_report::STEPS as f64 / crossover, 2),
                compared(f)
            );
            if f[0].measured < f[1].measured {
                Judgement::conditional(because).only("beyond 18/z⁴ steps")
            } else {
                Judgement::confirmed(because)
            }
        });
    }
    let text = "The drift of RK4 becomes evident in million-step tests.";
    rule(record, ("C25", "3.8", text), &pair[..2], |f| {
        Judgement::holds_if(f[0].measured > f[1].measured, compared(f))
    });
    let names = ["RK4", "velocity Verlet", "symplectic Euler"];
    let all = vec![of(Method::Rk4), of(Method::VelocityVerlet), of(Method::SymplecticEuler)];
    let text = "Of all methods velocity Verlet preserves the energy most effectively.";
    rule(record, ("C73", "9.1", text), &all, |f| {
        let best = names.iter().zip(f).min_by(|a, b| a.1.measured.total_cmp(&b.1.measured));
        let best = best.map_or("", |(name, _)| name);
        Judgement::holds_if(
            best == names[1],
            format!(
                "{}, symplectic Euler by {}: {best} preserves it best at this step and horizon",
                compared(f),
                number(f[2].measured, 3)
            ),
        )
    });
}
