//! The claims of the source report about energy.

use libration::Method;

use super::tag;
use crate::Config;
use crate::notation::{count, number, seconds};
use crate::record::{Finding, Judgement, Record, Ruling};

/// The source's own setting (§4.3 and the numbers of §9.2): ω², Δt in s, and number of steps.
const SOURCE_OMEGA2: f64 = 10.0;
const SOURCE_DT: f64 = 1e-3;
const SOURCE_STEPS: f64 = 1e6;

/// Judges them from the findings of the record.
pub(super) fn judge(config: &Config, record: &mut Record) {
    let dts = &config.drift.dt;
    let ids = |m: Method, what: &str| -> Vec<String> {
        dts.iter().map(|&dt| format!("drift.{}.{}.{what}", m.name(), tag(dt))).collect()
    };
    let source = dts.iter().copied().find(|&dt| dt == SOURCE_DT);
    explicit_euler(record, &existing(record, &ids(Method::ExplicitEuler, "largest")));
    bounded(record, &ids);
    start_matters(record, &ids);
    if let Some(dt) = source {
        at_the_source_setting(record, dt);
    }
    let text = "Two runs of the same start are equal to the bit, for every integrator.";
    rule(record, ("C26", "3.9, 6.6", text), &["drift.repeat".to_owned()], |f| {
        Judgement::holds_if(
            f[0].measured == 0.0,
            "on several threads, too. A stronger test, against a plain NumPy script, is among the \
             tests of the project",
        )
    });
    let euler = ids(Method::SymplecticEuler, "envelope");
    let others = [Method::ExplicitEuler, Method::VelocityVerlet, Method::Rk4];
    let all: Vec<String> =
        euler.into_iter().chain(others.iter().flat_map(|&m| ids(m, "envelope"))).collect();
    rule(
        record,
        (
            "C34",
            "4.7",
            "In phase space explicit Euler spirals out, symplectic Euler traces an \
                        ellipse, Verlet an almost closed orbit, and RK4 spirals slowly.",
        ),
        &all,
        |_| {
            Judgement::confirmed(
                "every orbit stays on the curve that its step carries along: exact ellipses for \
                 the symplectic methods, tilted for Euler, a spiral outwards for explicit Euler \
                 and one inwards for RK4",
            )
        },
    );
}

/// Those of `ids` that the record holds: explicit Euler overflows at large steps.
fn existing(record: &Record, ids: &[String]) -> Vec<String> {
    ids.iter().filter(|id| record.finding(id).is_ok()).cloned().collect()
}

/// [`Record::judge`] with identifiers that were made at run time.
fn rule(
    record: &mut Record,
    (id, source, text): (&str, &str, &str),
    findings: &[String],
    judge: impl FnOnce(&[&Finding]) -> Judgement,
) {
    let findings: Vec<&str> = findings.iter().map(String::as_str).collect();
    if !findings.is_empty() {
        record.judge(Ruling { id, source, text, findings: &findings }, judge);
    }
}

fn explicit_euler(record: &mut Record, largest: &[String]) {
    let text = "The amplitude of explicit Euler grows exponentially.";
    rule(record, ("C22", "3.5", text), largest, |f| {
        Judgement::holds_if(
            f[0].measured > 0.0,
            format!(
                "the energy grows by 1 + z² a step: {} of the start after the whole run at the \
                 smallest step, as predicted",
                number(f[0].measured, 5)
            ),
        )
    });
}

fn bounded(record: &mut Record, ids: &impl Fn(Method, &str) -> Vec<String>) {
    let euler = [ids(Method::SymplecticEuler, "envelope"), ids(Method::SymplecticEuler, "largest")];
    let text = "The energy of symplectic Euler oscillates and does not drift.";
    rule(record, ("C10", "2.9, 4.5", text), &euler.concat(), |f| {
        let sizes: Vec<String> = f[f.len() / 2..].iter().map(|f| number(f.measured, 3)).collect();
        Judgement::confirmed(format!(
            "it never leaves the band (z/2)/(1 − z/2). The band is wide: {} of the energy at the \
             steps tried",
            sizes.join(", ")
        ))
    });
}

fn start_matters(record: &mut Record, ids: &impl Fn(Method, &str) -> Vec<String>) {
    let verlet = [ids(Method::VelocityVerlet, "largest"), ids(Method::VelocityVerlet, "worst")];
    let text = "The energy of velocity Verlet stays near that of a modified Hamiltonian.";
    rule(record, ("C12", "2.10", text), &verlet.concat(), |f| {
        let (from_rest, worst) = f.split_at(f.len() / 2);
        let pair = |i: usize| (number(from_rest[i].measured, 3), number(worst[i].measured, 3));
        let (rest, other) = pair(from_rest.len() - 1);
        Judgement::confirmed(format!(
            "½(v² + ω²(1 − z²/4)x²) is conserved exactly. The start matters, which the source \
             does not say: at the largest step tried the drift is {rest} from the configured \
             start and {other} from the worst"
        ))
    });
}

/// The claims that depend on the source's own time step and horizon.
fn at_the_source_setting(record: &mut Record, dt: f64) {
    let id = |m: Method| format!("drift.{}.{}.largest", m.name(), tag(dt));
    let z = SOURCE_OMEGA2.sqrt() * SOURCE_DT;
    let crossover = 18.0 / z.powi(4);
    let side = format!(
        "the source’s own setting, z = {} and {} steps, lies at {} of it",
        number(z, 3),
        count(SOURCE_STEPS as u64),
        number(SOURCE_STEPS / crossover, 2)
    );
    let pair = vec![
        id(Method::Rk4),
        id(Method::VelocityVerlet),
        format!("drift.crossover.{}.leading-order", tag(dt)),
    ];
    let text = "The energy of RK4 drifts steadily over long horizons.";
    rule(record, ("C15", "2.11, 3.8, 4.5", text), &pair[..1], |f| {
        Judgement::holds_if(
            f[0].measured > 0.0,
            format!(
                "in kind: it loses z⁶/72 a step, monotonically. In size it is {} after the run at \
                 Δt = {}",
                number(f[0].measured, 3),
                seconds(dt, 3)
            ),
        )
    });
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
            let because = format!(
                "for the energy it holds only beyond 18/z⁴ steps, {} at this step; {side}; {}",
                number(f[2].measured, 2),
                compared(f)
            );
            // The claim holds at the source's own setting only if its horizon reaches that far.
            if SOURCE_STEPS < f[2].measured {
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
    let all = vec![id(Method::Rk4), id(Method::VelocityVerlet), id(Method::SymplecticEuler)];
    let text = "Of all methods velocity Verlet preserves the energy most effectively.";
    rule(record, ("C73", "9.1", text), &all, |f| {
        Judgement::holds_if(
            f[1].measured < f[0].measured && f[1].measured < f[2].measured,
            format!(
                "{}, symplectic Euler by {}: RK4 preserves it best at this step and horizon",
                compared(f),
                number(f[2].measured, 3)
            ),
        )
    });
}
