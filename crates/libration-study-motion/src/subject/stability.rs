//! The stability limit of a method, by simulation.

use libration::Method;
use libration::analysis::{jacobian, rate_derivative};
use libration::ensemble::Execution;
use libration::linear::{Matrix, eigenvalues};

use super::sweep::{distance, first_unstable};
use super::{Orbits, Problem};

/// `ωΔt` up to which a search goes; no integrator here is stable as far as that.
const FURTHEST: f64 = 8.0;

/// The displacement of a small orbit, as a share of the configured start's.
const SMALL: f64 = 1e-6;

/// The highest angular frequency of small oscillations about the equilibrium, in rad/s; none if
/// there is no equilibrium or nothing oscillates.
pub(super) fn frequency(problem: &Problem) -> Option<f64> {
    let slopes = jacobian(&problem.dynamics, problem.equilibrium.as_ref()?);
    let n = 2 * problem.degrees();
    let rates = Matrix::from_fn(n, n, |i, j| rate_derivative(&slopes, i, j));
    let imaginary = eigenvalues(&rates)?.into_iter().map(|value| value.im);
    imaginary.reduce(f64::max).filter(|&omega| omega > 0.0)
}

/// A stability limit from a search.
#[derive(Clone, Copy, Debug)]
pub struct StabilityLimit {
    /// The largest time step in s up to which no step that was tried lost its orbit; zero if the
    /// smallest did.
    pub dt: f64,
    /// How far apart the steps that were tried are, in s: of a narrower gap nothing is known.
    pub spacing: f64,
}

/// Time steps of the fine scan.
const FINE: u32 = 8192;

/// Parts into which the interval of the first loss is cut, again and again.
const PARTS: u32 = 64;

/// The first loss of an orbit of `steps` steps as the time step rises; none if nothing is lost however
/// large the step.
///
/// A scan finds a first loss. Orbits from the configured start may be lost far below it: in gaps about
/// resonances, or at single steps in chaos that takes its time. A second scan begins at a hundredth of
/// the first loss, much finer and with runs four times as long. Then the last interval is narrowed
/// down; bisection alone would find some end of some gap.
pub(super) fn stability_limit(
    problem: &Problem,
    execution: &Execution,
    orbits: Orbits,
    method: Method,
    steps: u64,
) -> Option<StabilityLimit> {
    let (omega, start) = begin(problem, orbits)?;
    // The first of `count` equidistant steps that loses the orbit.
    let scan = |from: f64, width: f64, count: u32, steps: u64| {
        let z = |i: u32| from + width * f64::from(i);
        let dts: Vec<f64> = (1..=count).map(|i| z(i) / omega).collect();
        let lost = first_unstable(execution, problem, orbits, &start, method, &dts, steps);
        lost.map(|i| z(i as u32 + 1))
    };
    let mut width = 0.05;
    let mut first = scan(0.0, width, (FURTHEST / width).round() as u32, steps)?;
    if first <= width {
        return Some(StabilityLimit { dt: 0.0, spacing: width / omega });
    }
    // About the equilibrium growth is monotone in the step: there are no gaps to be found.
    let steps = if orbits == Orbits::Configured { 4 * steps } else { steps };
    if orbits == Orbits::Configured {
        let from = 0.01 * first;
        width = (first - from) / f64::from(FINE);
        first = scan(from, width, FINE, steps).unwrap_or(first);
    }
    let (mut low, mut high) = (first - width, first);
    while high - low > 1e-6 * high {
        // The lowest of many points that is lost, not the one in the middle.
        let part = (high - low) / f64::from(PARTS);
        match scan(low, part, PARTS - 1, steps) {
            Some(z) => (low, high) = (z - part, z),
            None => low = high - part,
        }
    }
    Some(StabilityLimit { dt: low / omega, spacing: width / omega })
}

/// The frequency in which time steps are counted, and a start; none of small orbits without an
/// equilibrium about which something oscillates.
fn begin(problem: &Problem, orbits: Orbits) -> Option<(f64, Vec<f64>)> {
    match orbits {
        Orbits::Configured => Some((problem.omega(), problem.start.clone())),
        Orbits::Small => {
            let omega = frequency(problem)?;
            Some((omega, displaced(problem, omega)?))
        }
    }
}

/// A state near the equilibrium, off it in every coordinate.
fn displaced(problem: &Problem, omega: f64) -> Option<Vec<f64>> {
    let at = problem.equilibrium.as_ref()?;
    let reach = distance(&problem.start, at, omega).max(f64::MIN_POSITIVE) * SMALL;
    let off = |i: usize| reach * (1.0 + 0.3 * i as f64);
    let shift = |i: usize| if i < problem.degrees() { off(i) } else { -omega * off(i) };
    Some(at.iter().enumerate().map(|(i, x)| x + shift(i)).collect())
}

#[cfg(test)]
mod tests {
    use libration::State;
    use libration::system::{Kepler, Pendulum};

    use super::*;

    /// Velocity Verlet loses single orbits in gaps of about 10⁻⁵ s, which a scan in steps of 1 ms and
    /// of 0.3 ms does not see: such scans find 0.2046 s and 0.3919 s.
    #[test]
    fn narrow_gaps_are_seen() {
        let (orbits, method) = (Orbits::Configured, Method::VelocityVerlet);
        let start = State { q: [0.4, 0.0], v: [0.0, 2.0] };
        let kepler = Problem::new("kepler", Kepler { mu: 1.0 }, start, std::f64::consts::TAU);
        let found = stability_limit(&kepler, &Execution::serial(), orbits, method, 1_000).unwrap();
        assert!(found.dt < 0.2010 && found.spacing < 4e-5, "{found:?}");

        let start = State { q: [2.0], v: [0.0] };
        let turn = std::f64::consts::TAU / 9.81_f64.sqrt();
        let pendulum = Problem::new("pendulum", Pendulum { omega2: 9.81 }, start, turn);
        let found =
            stability_limit(&pendulum, &Execution::serial(), orbits, method, 1_000).unwrap();
        assert!(found.dt < 0.3903 && found.spacing < 1e-4, "{found:?}");
    }
}
