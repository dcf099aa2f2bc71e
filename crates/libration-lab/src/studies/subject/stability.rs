//! The time step at which a method loses an orbit, searched for by simulation.

use libration::analysis::{Complex, Eigenvalues, Linearisation, Spectrum, eigenvalues};
use libration::{Float, Hamiltonian, Method, Model, State, integrator};

use super::{Problem, Subject};

/// `ωΔt` up to which a search goes; no integrator here is stable as far as that.
const FURTHEST: f64 = 8.0;

/// An orbit about an equilibrium is lost if it has grown by this factor.
const GROWN: f64 = 1e3;

/// The displacement of a small orbit, as a share of the configured start's.
const SMALL: f64 = 1e-6;

/// Steps between two looks at an orbit.
const STRIDE: u64 = 64;

/// From where an orbit starts that may be lost, and how one knows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Orbits {
    /// From the configured start: lost if the energy has changed by as much as there was, or is no
    /// number.
    Configured,
    /// Close to the equilibrium: lost if it has grown a thousandfold.
    Small,
}

/// The highest angular frequency of small oscillations about the equilibrium, in rad/s; none if
/// there is no equilibrium or nothing oscillates.
pub(super) fn frequency<M: Model<D>, const D: usize>(problem: &Problem<M, D>) -> Option<f64> {
    let at = problem.equilibrium?;
    // The generator does not depend on the integrator or the step.
    let any = Linearisation::new(integrator::Leapfrog, problem.model, &at, problem.turn());
    let imaginary: Vec<f64> = match any.generator.decoupled() {
        Some(modes) => modes
            .iter()
            .map(|mode| match Spectrum::new(mode).eigenvalues {
                Eigenvalues::Complex { im, .. } => im.to_f64(),
                _ => 0.0,
            })
            .collect(),
        None => eigenvalues(&any.generator).iter().map(|Complex { im, .. }| im.to_f64()).collect(),
    };
    imaginary.into_iter().reduce(f64::max).filter(|&omega| omega > 0.0)
}

/// Up to where orbits were not lost.
#[derive(Clone, Copy, Debug)]
pub struct Loss {
    /// The largest time step in s up to which no step that was tried lost its orbit; zero if the
    /// smallest did.
    pub dt: f64,
    /// How far apart the steps that were tried are, in s: of a narrower gap nothing is known.
    pub apart: f64,
}

/// Steps of the fine scan for each of the coarse one.
const FINER: f64 = 48.0;

/// The first loss of an orbit of `steps` steps as the time step rises; none if nothing is lost however
/// large the step.
///
/// A scan finds a first loss. Orbits from the configured start may be lost in gaps far below it: in
/// resonances, or in chaos that takes its time. A second scan begins at a hundredth of the first loss,
/// much finer and with runs four times as long. Then the last interval is narrowed down; bisection
/// alone would find some end of some gap.
pub(super) fn loss<M: Model<D>, const D: usize>(
    problem: &Problem<M, D>,
    orbits: Orbits,
    method: Method,
    steps: u64,
) -> Option<Loss> {
    let omega = match orbits {
        Orbits::Small => frequency(problem)?,
        Orbits::Configured => std::f64::consts::TAU / problem.turn(),
    };
    let start = match orbits {
        Orbits::Configured => problem.start,
        Orbits::Small => displaced(problem, omega)?,
    };
    let lost = |z: f64, steps: u64| is_lost(problem, orbits, &start, method, z / omega, steps);
    let scan = |from: f64, to: f64, width: f64, steps: u64| {
        let count = ((to - from) / width).round() as u32;
        (1..=count).map(|i| from + width * f64::from(i)).find(|&z| lost(z, steps))
    };
    let mut width = 0.05;
    let mut first = scan(0.0, FURTHEST, width, steps)?;
    if first <= width {
        return Some(Loss { dt: 0.0, apart: width / omega });
    }
    // About the equilibrium growth is monotone in the step: there are no gaps to be found.
    if orbits == Orbits::Configured {
        width /= FINER;
        let from = 0.01 * first;
        first = scan(from, first, width, 4 * steps).unwrap_or(first);
    }
    let steps = if orbits == Orbits::Configured { 4 * steps } else { steps };
    let (mut low, mut high) = (first - width, first);
    while high - low > 1e-6 * high {
        // The lowest of eight points that is lost, not the one in the middle.
        let part = (high - low) / 8.0;
        match (1..8).map(|i| low + part * f64::from(i)).find(|&z| lost(z, steps)) {
            Some(z) => (low, high) = (z - part, z),
            None => low = high - part,
        }
    }
    Some(Loss { dt: low / omega, apart: width / omega })
}

/// A state near the equilibrium, off it in every coordinate.
fn displaced<M: Model<D>, const D: usize>(
    problem: &Problem<M, D>,
    omega: f64,
) -> Option<State<f64, D>> {
    let at = problem.equilibrium?;
    let reach = distance(&problem.start, &at, omega).max(f64::MIN_POSITIVE) * SMALL;
    let off = |i: usize| reach * (1.0 + 0.3 * i as f64);
    Some(State {
        q: core::array::from_fn(|i| at.q[i] + off(i)),
        v: core::array::from_fn(|i| at.v[i] - omega * off(i + D)),
    })
}

/// The distance of two states, velocities divided by `omega`.
fn distance<const D: usize>(a: &State<f64, D>, b: &State<f64, D>, omega: f64) -> f64 {
    let square =
        |a: [f64; D], b: [f64; D]| -> f64 { a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum() };
    (square(a.q, b.q) + square(a.v, b.v) / (omega * omega)).sqrt()
}

fn is_lost<M: Model<D>, const D: usize>(
    problem: &Problem<M, D>,
    orbits: Orbits,
    start: &State<f64, D>,
    method: Method,
    dt: f64,
    steps: u64,
) -> bool {
    let system = problem.model.on::<f64>();
    let initial = system.energy(start);
    let at = problem.equilibrium.unwrap_or(*start);
    let omega = std::f64::consts::TAU / problem.turn();
    let reach = GROWN * distance(start, &at, omega);
    let mut state = *start;
    for _ in 0..steps.div_ceil(STRIDE) {
        let mut gone = false;
        let mut watch = |s: &libration::simulation::Sample<f64, D>| {
            gone |= match orbits {
                Orbits::Configured => {
                    let change = (system.energy(&s.state) - initial).abs();
                    !change.is_finite() || change > initial.abs().max(f64::MIN_POSITIVE)
                }
                Orbits::Small => distance(&s.state, &at, omega) > reach,
            };
        };
        match problem.run(method, state, dt, STRIDE, &mut watch) {
            Ok(next) if !gone => state = next,
            _ => return true,
        }
    }
    !state.coordinates().all(Float::is_finite)
}
