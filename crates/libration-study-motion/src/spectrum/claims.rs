//! The claims of the source report about one step.

use libration_report::notation::number;
use libration_report::record::{Finding, Judgement, Record, Ruling};

/// Judges them from the findings of the record.
pub(super) fn judge(record: &mut Record) {
    record.judge(
        Ruling {
            id: "C04",
            source: "2.3-2.5",
            text: "The exact oscillator has eigenvalues ±iω: bounded, periodic, of constant energy.",
            findings: &["spectrum.oscillator.growth", "spectrum.oscillator.frequency"],
        },
        |f| {
            Judgement::holds_if(
                f[0].measured == 0.0,
                format!(
                    "dual numbers in the force of the simulation give ±i·{} rad/s, with no real \
                     part",
                    number(f[1].measured, 6)
                ),
            )
        },
    );
    record.judge(
        Ruling {
            id: "C05",
            source: "2.5",
            text: "A spectral radius above one means exponential growth.",
            findings: &["spectrum.explicit-euler.radius"],
        },
        |f| {
            let excess = f[0].measured;
            Judgement::holds_if(
                excess > 0.0,
                format!(
                    "explicit Euler has ρ − 1 = {}, and its orbits grow by just that factor a step",
                    number(excess, 3)
                ),
            )
        },
    );
    record.judge(
        Ruling {
            id: "C06",
            source: "2.7, 4.1",
            text: "A spectral radius of at most one means that orbits stay bounded.",
            findings: &["spectrum.symplectic-euler.defective-growth"],
        },
        |f| {
            let grown = f[0].measured;
            let because = format!(
                "symplectic Euler at z = 2 has radius one, and takes x from 1 to {}: the \
                 eigenvalue −1 is double and has a single eigenvector. The claim holds if the \
                 eigenvalues on the unit circle are semi-simple",
                number(grown, 7)
            );
            Judgement::holds_if(grown <= 10.0, because)
        },
    );
    record.judge(
        Ruling {
            id: "C08",
            source: "2.8",
            text: "Explicit Euler has |λ| = √(1 + z²) and is unstable for every step.",
            findings: &[
                "spectrum.explicit-euler.radius",
                "spectrum.explicit-euler.imaginary-limit",
            ],
        },
        |f| {
            Judgement::holds_if(
                f[0].measured > 0.0 && f[1].measured == 0.0,
                "measured growth is that of √(1 + z²), and no step down to z = 0.01 is stable",
            )
        },
    );
    let euler =
        ["spectrum.symplectic-euler.symplecticity", "spectrum.symplectic-euler.imaginary-limit"];
    for (id, source, text) in [
        ("C09", "2.9", "Symplectic Euler has determinant one, and |λ| = 1 for ωΔt < 2."),
        ("C23", "3.6", "Symplectic Euler is stable for ωΔt < 2."),
    ] {
        record.judge(Ruling { id, source, text, findings: &euler }, |f| {
            Judgement::holds_if(
                (f[1].measured - 2.0).abs() < 1e-6,
                format!(
                    "the determinant is 1 within rounding, and stability ends at z = {}",
                    resolved(f[1])
                ),
            )
        });
    }
    record.judge(
        Ruling {
            id: "C11",
            source: "2.10",
            text: "Velocity Verlet is time-reversible and symplectic.",
            findings: &[
                "spectrum.velocity-verlet.symplecticity",
                "spectrum.velocity-verlet.reversibility",
                "spectrum.symplectic-euler.reversibility",
            ],
        },
        |f| {
            let [symplecticity, reversibility, euler] = [0, 1, 2].map(|i| f[i].measured);
            let rounding = |i: usize| f[i].tolerance.tolerance.unwrap_or(0.0);
            Judgement::holds_if(
                symplecticity <= rounding(0) && reversibility <= rounding(1),
                format!(
                    "both defects are zero within rounding. Symplectic Euler is symplectic but not \
                     reversible: its defect is {}, which the source does not say",
                    number(euler, 3)
                ),
            )
        },
    );
    record.judge(
        Ruling {
            id: "C13",
            source: "2.10, 3.7",
            text: "Velocity Verlet allows a larger stable step than symplectic Euler.",
            findings: &[
                "spectrum.velocity-verlet.imaginary-limit",
                "spectrum.symplectic-euler.imaginary-limit",
            ],
        },
        |f| {
            let (verlet, euler) = (f[0].measured, f[1].measured);
            let because = format!(
                "stability ends at z = {} for Verlet and at z = {} for Euler: they have the same \
                 eigenvalues. The claim holds if stability means a tolerance on the energy, since \
                 the energy of Verlet varies by z²/4 and that of Euler by about z/2. The source \
                 names no criterion; its own z = 0.00316 is far inside both limits",
                resolved(f[0]),
                resolved(f[1])
            );
            if verlet > euler + 1e-5 {
                Judgement::confirmed(because)
            } else {
                Judgement::conditional(because)
                    .only("where the energy must stay within a tolerance")
            }
        },
    );
    // Where the defect is no more than rounding it is no evidence.
    let seen = |f: &Finding| f.tolerance.tolerance.is_some_and(|rounding| f.measured > rounding);
    if record.finding("spectrum.rk4.symplecticity").is_ok_and(seen) {
        not_symplectic(record);
    }
    // Nor is a step that is unstable evidence of one that is stable with |λ| = 1.
    let on_circle = |f: &Finding| f.predicted == Some(0.0) && f.agrees();
    if record.finding("spectrum.velocity-verlet.radius").is_ok_and(on_circle) {
        strictly_inside(record);
    }
    record.judge(
        Ruling {
            id: "C18",
            source: "2.12",
            text: "The stability region of a symplectic method includes a piece of the imaginary \
                   axis.",
            findings: &["spectrum.velocity-verlet.imaginary-limit", "spectrum.rk4.imaginary-limit"],
        },
        |f| {
            Judgement::holds_if(
                f[0].measured > 0.0,
                format!(
                    "up to z = {}. This does not distinguish symplectic methods: the region of RK4 \
                     includes the axis up to {}",
                    resolved(f[0]),
                    resolved(f[1])
                ),
            )
        },
    );
    record.judge(
        Ruling {
            id: "C32",
            source: "4.5",
            text: "The stability region of explicit Euler excludes the imaginary axis.",
            findings: &["spectrum.explicit-euler.imaginary-limit"],
        },
        |f| Judgement::holds_if(f[0].measured == 0.0, "all of it, except the origin"),
    );
}

fn not_symplectic(record: &mut Record) {
    record.judge(
        Ruling {
            id: "C14",
            source: "2.11",
            text: "RK4 is not symplectic.",
            findings: &["spectrum.rk4.symplecticity", "spectrum.rk4.sweep"],
        },
        |f| {
            Judgement::confirmed(format!(
                "its determinant is 1 − z⁶/72 + z⁸/576, derived from the step: a defect of {} was \
                 measured, which is more than rounding. It is a loss of area, never a gain, below \
                 z = 2√2",
                number(f[0].measured, 3)
            ))
        },
    );
}

fn strictly_inside(record: &mut Record) {
    record.judge(
        Ruling {
            id: "C17",
            source: "2.12",
            text: "Stability requires |R(z)| < 1.",
            findings: &[
                "spectrum.velocity-verlet.radius",
                "spectrum.velocity-verlet.imaginary-limit",
            ],
        },
        |f| {
            Judgement::holds_if(
                f[1].measured == 0.0,
                format!(
                    "velocity Verlet has a radius of one, measured within {}, and is stable up to \
                     z = {}: with `<` no conservative method would be stable. The source itself \
                     has ≤ in §2.7, and a splitting method has no stability function R(z)",
                    number(f[0].measured.abs(), 2),
                    resolved(f[1])
                ),
            )
        },
    );
}

/// A measured value in the digits that its tolerance leaves: the others are the search's.
fn resolved(finding: &Finding) -> String {
    let size = finding.measured.abs().log10().floor();
    let digits = match finding.tolerance.tolerance {
        // Half a unit of the last digit is at least the tolerance.
        Some(tolerance) if tolerance > 0.0 => (size + 1.0 - (2.0 * tolerance).log10()).floor(),
        _ => MOST_DIGITS,
    };
    number(finding.measured, digits.clamp(1.0, MOST_DIGITS) as usize)
}

/// As many digits as a limit is ever shown with.
const MOST_DIGITS: f64 = 8.0;

#[cfg(test)]
mod tests {
    use libration_report::record::Tolerance;

    use super::*;

    #[test]
    fn a_limit_is_shown_with_the_digits_that_its_search_resolves() {
        let shown = |predicted: f64, measured: f64, tolerance: f64| {
            let tolerance = Tolerance::absolute(tolerance, "");
            resolved(&Finding::predicted("a.b", "", "1", predicted, measured, tolerance))
        };
        assert_eq!(shown(8_f64.sqrt(), 2.828_428_7, 4e-6), "2.82843");
        assert_eq!(shown(2.0, 1.999_999_9, 4e-6), "2");
        assert_eq!(shown(8_f64.sqrt(), 8_f64.sqrt(), 0.0), "2.8284271");
        assert_eq!(shown(0.0, 0.0, 0.01), "0");
    }
}
