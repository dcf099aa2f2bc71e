//! The largest time step that meets a criterion, exactly.

use libration_core::number::{Ratio, Wide};
use libration_core::{Elementary, Scalar};

use super::orbit_start::{NEGLIGIBLE, OrbitStart};
use super::roots::IntegerPoly;
use super::stability_window::Cells;
use super::{SymbolicStep, UnknownStep};

/// The criterion for a time step.
#[derive(Clone, Copy, Debug)]
pub enum Criterion {
    /// Every orbit stays bounded for ever.
    Bounded,
    /// The length of `q` stays below `limit` at all phases of the curve that the orbit fills.
    Amplitude {
        /// The largest `|q|` allowed.
        limit: f64,
        /// Number of steps.
        steps: u64,
        /// The start of the orbit.
        start: OrbitStart,
    },
    /// The relative energy drift stays below `tolerance`.
    EnergyDrift {
        /// The largest drift allowed.
        tolerance: f64,
        /// Number of steps.
        steps: u64,
        /// The start of the orbit; none for the worst start.
        start: Option<OrbitStart>,
    },
}

impl SymbolicStep {
    /// The largest `z = ωΔt` such that this step and every smaller one meets `criterion`: to 96
    /// digits, zero if no step does, infinite (none within) if all do.
    ///
    /// Energy and amplitude are taken over the whole curve that an orbit fills, not over the points
    /// that a short one happens to visit. The criterion then is a set of polynomial inequalities in
    /// `z`, and the answer the first root at which one of them changes its sign; so a narrow gap is
    /// never stepped over. None where there is no such form: for a step that neither conserves areas
    /// nor commutes with the exact flow; nor where the polynomials outgrow their exact arithmetic, or
    /// a limit or tolerance is not positive and finite.
    pub fn largest_step(&self, criterion: &Criterion) -> Option<LargestStep> {
        let bound = match criterion {
            Criterion::Bounded => return Some(self.end_of_first_window()),
            Criterion::Amplitude { limit, .. } => *limit,
            Criterion::EnergyDrift { tolerance, .. } => *tolerance,
        };
        if !(bound > 0.0 && bound.is_finite()) {
            return None;
        }
        if matches!(criterion, Criterion::Amplitude { start, .. } if start.size().is_zero()) {
            return Some(LargestStep::Unlimited);
        }
        let conditions = if self.is_symplectic() {
            self.conserving(criterion)?
        } else if self.commutes_with_rotation() {
            self.scaling(criterion)?
        } else {
            return None;
        };
        let polynomials: Option<Vec<IntegerPoly>> =
            conditions.iter().map(IntegerPoly::of).collect();
        let found = first_violation(&polynomials?);
        // A conserved form bounds orbits only as long as it is definite.
        Some(if self.is_symplectic() { found.min(self.end_of_first_window()) } else { found })
    }

    fn end_of_first_window(&self) -> LargestStep {
        match self.stability_windows().first() {
            Some(window) if window.from.is_zero() => {
                window.to.map_or(LargestStep::Unlimited, LargestStep::Limit)
            }
            _ => LargestStep::Limit(Wide::ZERO),
        }
    }

    /// Whether the step is `c + s·J`, as that of a Runge–Kutta method is on the oscillator.
    fn commutes_with_rotation(&self) -> bool {
        let m = &self.matrix;
        m.entry(0, 0) == m.entry(1, 1) && m.entry(0, 1) == -m.entry(1, 0)
    }

    /// The polynomials that must not be negative if the form `Q` is conserved.
    ///
    /// In coordinates in which the step is a rotation, a form is a mean plus a part that turns at
    /// twice the angle; over the degrees of freedom the means add up, and of the turning parts what
    /// the angular momentum `L² = Σq²·Σv² − (Σqv)²` leaves: with `a = det Q` and `b` the mixed
    /// determinant, the energies `E` on the orbit fill the interval in which
    /// `a·E² − 2b·E·Q + ¼Q² + (4b² − a)·L²` is not positive.
    fn conserving(&self, criterion: &Criterion) -> Option<Vec<UnknownStep>> {
        let form = self.invariant();
        let (a, b) = (form.determinant(), (form.qq + form.vv).ratio(1, 4));
        let number = UnknownStep::from_f64;
        // Q, ½(q² + v²) and L² of a start.
        let values = |start: &OrbitStart| {
            let [qq, qv, vv] = [constant(start.qq)?, constant(start.qv)?, constant(start.vv)?];
            let level = form.qq * qq + (form.qv * qv).ratio(2, 1) + form.vv * vv;
            Some((level, (qq + vv).ratio(1, 2), qq * vv - qv * qv))
        };
        Some(match criterion {
            Criterion::Bounded => return None,
            // The squares of q fill the interval in which a·s² − s·vv·Q + vv²·L² is not positive.
            Criterion::Amplitude { limit, start, .. } => {
                if wide(*limit).exponent() > start.size().exponent().map(|e| e / 2 + NEGLIGIBLE) {
                    return Some(vec![a]);
                }
                let (level, _, momentum) = values(start)?;
                let square = number(*limit) * number(*limit);
                vec![
                    a * square * square - square * form.vv * level + form.vv * form.vv * momentum,
                    (a * square).ratio(2, 1) - form.vv * level,
                ]
            }
            // At (1 ± ε)·E(start).
            Criterion::EnergyDrift { tolerance, start: Some(start), .. } => {
                let (level, energy, momentum) = values(start)?;
                let side = |tolerance: f64| {
                    let reached = (UnknownStep::one() + number(tolerance)) * energy;
                    a * reached * reached - (b * reached * level).ratio(2, 1)
                        + (level * level).ratio(1, 4)
                        + ((b * b).ratio(4, 1) - a) * momentum
                };
                vec![side(*tolerance), side(-*tolerance)]
            }
            // r₊/r₋ ≤ 1 + ε, by their sum 2b/a and product 1/(4a).
            Criterion::EnergyDrift { tolerance, start: None, .. } => {
                let one = UnknownStep::one();
                let (sum, ratio) = (one + one + number(*tolerance), one + number(*tolerance));
                vec![(sum * sum * a).ratio(1, 4) - (b * b * ratio).ratio(4, 1)]
            }
        })
    }

    /// The polynomials that must not be negative if each step scales the energy by `det M`.
    fn scaling(&self, criterion: &Criterion) -> Option<Vec<UnknownStep>> {
        let determinant = self.determinant();
        let at_most = |factor: Wide, steps| Some(constant(root(factor, steps))? - determinant);
        let at_least = |factor: Wide, steps| Some(determinant - constant(root(factor, steps))?);
        let (one, number) = (Wide::one(), Wide::from_f64);
        Some(match criterion {
            Criterion::Bounded => return None,
            Criterion::Amplitude { limit, steps, start } => {
                vec![at_most(number(*limit) * number(*limit) / start.reach(), *steps)?]
            }
            Criterion::EnergyDrift { tolerance, steps, .. } => {
                let mut conditions = vec![at_most(one + number(*tolerance), *steps)?];
                if *tolerance < 1.0 {
                    conditions.push(at_least(one - number(*tolerance), *steps)?);
                }
                conditions
            }
        })
    }
}

/// The largest step that meets a criterion.
#[derive(Clone, Copy, Debug)]
pub enum LargestStep {
    /// This one; zero if no step meets it.
    Limit(Wide),
    /// Every step meets it.
    Unlimited,
}

impl LargestStep {
    /// The step in `f64`; infinite if every step meets the criterion.
    pub fn to_f64(self) -> f64 {
        match self {
            LargestStep::Limit(z) => z.to_f64(),
            LargestStep::Unlimited => f64::INFINITY,
        }
    }

    fn min(self, other: Self) -> Self {
        match (self, other) {
            (LargestStep::Limit(a), LargestStep::Limit(b)) => {
                LargestStep::Limit(if b < a { b } else { a })
            }
            (LargestStep::Unlimited, limit) | (limit, LargestStep::Unlimited) => limit,
        }
    }
}

/// The first time step at which one of the polynomials is negative.
fn first_violation(conditions: &[IntegerPoly]) -> LargestStep {
    let ends = conditions.iter().map(first_negative);
    ends.fold(LargestStep::Unlimited, LargestStep::min)
}

/// The left end of the first cell in which `p` is negative.
fn first_negative(p: &IntegerPoly) -> LargestStep {
    let (p, squares) = IntegerPoly::in_squares([p]);
    let cells = Cells::of(&p.each_ref());
    match (0..=cells.roots.len()).find(|&i| p[0].sign_at(&cells.sample(i)) < 0) {
        None => LargestStep::Unlimited,
        Some(0) => LargestStep::Limit(Wide::ZERO),
        Some(i) if squares => LargestStep::Limit(cells.roots[i - 1].value().sqrt()),
        Some(i) => LargestStep::Limit(cells.roots[i - 1].value()),
    }
}

fn wide(x: f64) -> Wide {
    Wide::from_f64(x)
}

fn constant(x: Wide) -> Option<UnknownStep> {
    Some(UnknownStep::constant(Ratio::from_wide(x)?))
}

/// The `n`-th root of a positive number, by Newton's iteration from its `f64`.
fn root(x: Wide, n: u64) -> Wide {
    let guess = x.ln().to_f64() / n as f64;
    let mut r = Wide::from_f64(guess.exp());
    let count = Wide::from_f64(n as f64);
    // Each iteration doubles the digits: 53 bits become 1024 in five.
    for _ in 0..6 {
        r = r * (Wide::one() + (x / r.powi(n) - Wide::one()) / count);
    }
    r
}

#[cfg(test)]
mod tests {
    use libration_core::{Method, with_method};

    use super::*;

    fn rest() -> OrbitStart {
        OrbitStart::new(&[1.0], &[0.0])
    }

    fn largest(method: Method, criterion: Criterion) -> f64 {
        let step = with_method!(method, |m| SymbolicStep::new(m)).unwrap();
        step.largest_step(&criterion).unwrap().to_f64()
    }

    fn drift(tolerance: f64, steps: u64, start: Option<OrbitStart>) -> Criterion {
        Criterion::EnergyDrift { tolerance, steps, start }
    }

    #[test]
    fn closed_forms_of_the_energy_criterion_are_met() {
        for e in [1e-8, 1e-3, 0.01, 0.1, 0.5] {
            let close = |got: f64, want: f64| {
                assert!((got / want - 1.0).abs() < 1e-15, "{e}: {got:?}, not {want:?}");
            };
            let at_rest = |m| largest(m, drift(e, 1000, Some(rest())));
            close(at_rest(Method::VelocityVerlet), 2.0 * e.sqrt());
            close(at_rest(Method::SymplecticEuler), 2.0 * e / (1.0 + e));
            let worst = largest(Method::VelocityVerlet, drift(e, 1000, None));
            close(worst, 2.0 * (e / (1.0 + e)).sqrt());
        }
    }

    #[test]
    fn the_table_of_largest_steps_is_met_to_its_last_digit() {
        // ω² = 10, from (1, 0): an independent brute-force search in NumPy printed six decimals.
        let amplitude = |limit, steps| Criterion::Amplitude { limit, steps, start: rest() };
        use Method::ExplicitEuler as E;
        use Method::Rk4 as R;
        use Method::SymplecticEuler as S;
        use Method::VelocityVerlet as V;
        for (method, criterion, dt) in [
            (E, Criterion::Bounded, 0.0),
            (S, Criterion::Bounded, 0.632456),
            (V, Criterion::Bounded, 0.632456),
            (R, Criterion::Bounded, 0.894427),
            (E, amplitude(1.1, 10_000), 0.001381),
            (S, amplitude(1.1, 10_000), 0.263480),
            (V, amplitude(1.1, 10_000), 0.632456),
            (R, amplitude(1.1, 10_000), 0.894428),
            (S, amplitude(10.0, 10_000), 0.629285),
            (R, amplitude(10.0, 10_000), 0.894456),
            (R, amplitude(1e6, 10_000), 0.894601),
            (E, drift(0.01, 1000, Some(rest())), 0.000998),
            (R, drift(1e-3, 1_000_000, Some(rest())), 0.020400),
            (R, drift(0.01, 1_000_000, Some(rest())), 0.029969),
            (S, drift(0.1, 10_000, Some(rest())), 0.057496),
            (V, drift(1.0, 10_000, Some(rest())), 0.632456),
            (S, drift(10.0, 10_000, Some(rest())), 0.574960),
            (R, drift(10.0, 10_000, Some(rest())), 0.894442),
        ] {
            let got = largest(method, criterion) / 10.0_f64.sqrt();
            assert!((got - dt).abs() <= 5.1e-7, "{} {criterion:?}: {got}", method.name());
        }
    }

    #[test]
    fn a_start_beyond_the_limit_has_no_step_at_all() {
        let beyond = Criterion::Amplitude { limit: 0.5, steps: 10, start: rest() };
        for method in [Method::VelocityVerlet, Method::Rk4] {
            assert_eq!(largest(method, beyond), 0.0, "{}", method.name());
        }
    }
}
