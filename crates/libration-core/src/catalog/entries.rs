//! The catalogue's table.

use super::entry::Values;
use super::{Actuation, Allowed, AnySystem, CatalogError, Entry, Parameter};
use crate::system::{
    DampedOscillator, DrivenOscillator, Duffing, HenonHeiles, Kepler, Oscillator, Pendulum,
};

const MASS: Parameter = Parameter {
    name: "m",
    unit: "kg",
    summary: "mass; with `k`, commands are forces in N",
    default: 1.0,
    allowed: Allowed::Positive,
};
const STIFFNESS: Parameter = Parameter {
    name: "k",
    unit: "N/m",
    summary: "stiffness of the spring; 0 for a free mass",
    default: 10.0,
    allowed: Allowed::NonNegative,
};
const OMEGA2: Parameter = Parameter {
    name: "omega2",
    unit: "s^-2",
    summary: "squared natural frequency k/m, instead of m and k: commands are then accelerations",
    default: 10.0,
    allowed: Allowed::NonNegative,
};
const GAMMA: Parameter = Parameter {
    name: "gamma",
    unit: "s^-1",
    summary: "damping rate: damping coefficient per mass",
    default: 0.2,
    allowed: Allowed::NonNegative,
};
const AMPLITUDE: Parameter = Parameter {
    name: "amplitude",
    unit: "m s^-2",
    summary: "amplitude of the driving force per mass",
    default: 1.0,
    allowed: Allowed::Finite,
};
const DRIVE: Parameter = Parameter {
    name: "drive",
    unit: "rad/s",
    summary: "angular frequency of the driving force",
    default: 3.0,
    allowed: Allowed::NonNegative,
};
const SMALL_SWING: Parameter = Parameter {
    name: "omega2",
    unit: "s^-2",
    summary: "squared frequency of small swings g/l",
    default: 9.81,
    allowed: Allowed::Positive,
};
const ALPHA: Parameter = Parameter {
    name: "alpha",
    unit: "s^-2",
    summary: "linear stiffness per mass; negative for a double well",
    default: -1.0,
    allowed: Allowed::Finite,
};
const BETA: Parameter = Parameter {
    name: "beta",
    unit: "m^-2 s^-2",
    summary: "cubic stiffness per mass",
    default: 1.0,
    allowed: Allowed::Finite,
};
const MU: Parameter = Parameter {
    name: "mu",
    unit: "m^3 s^-2",
    summary: "gravitational parameter G M",
    default: 1.0,
    allowed: Allowed::Positive,
};
const LAMBDA: Parameter = Parameter {
    name: "lambda",
    unit: "1",
    summary: "strength of the cubic coupling",
    default: 1.0,
    allowed: Allowed::Finite,
};

/// `ω²`, given as such or as `k/m`.
fn omega2(values: &Values<'_>) -> Result<f64, CatalogError> {
    let system = values.entry.name;
    if let Some(omega2) = values.given(&OMEGA2) {
        return match [MASS, STIFFNESS].iter().find(|p| values.given(p).is_some()) {
            Some(other) => Err(CatalogError::Conflict { system, name: other.name }),
            None => Ok(omega2),
        };
    }
    if values.given(&MASS).is_some() && values.given(&STIFFNESS).is_none() {
        return Err(CatalogError::NoStiffness { system });
    }
    let (m, k) = (values.get(&MASS), values.get(&STIFFNESS));
    let Oscillator { omega2 } = Oscillator::from_mass_and_stiffness(m, k);
    // A quotient that rounds to zero is no free mass.
    if omega2.is_finite() && (omega2 > 0.0) == (k > 0.0) {
        Ok(omega2)
    } else {
        Err(CatalogError::Quotient { system, m, k, omega2 })
    }
}

/// Whether commands are forces: where mass or stiffness is given.
pub(super) fn actuation(values: &Values<'_>) -> Actuation {
    match [MASS, STIFFNESS].iter().any(|p| values.given(p).is_some()) {
        true => Actuation::Force { mass: values.get(&MASS), stiffness: values.get(&STIFFNESS) },
        false => Actuation::Acceleration,
    }
}

/// Mass 1 kg on a spring of 10 N/m, released at rest 1 m from equilibrium.
pub(super) const OSCILLATOR: Entry = Entry {
    name: "oscillator",
    summary: "harmonic oscillator, q'' = -omega2 q in each dimension",
    dimensions: 1..=8,
    parameters: &[MASS, STIFFNESS, OMEGA2],
    q: &[1.0],
    v: &[0.0],
    build: |values| Ok(AnySystem::Oscillator(Oscillator { omega2: omega2(values)? })),
};

pub(super) const DAMPED_OSCILLATOR: Entry = Entry {
    name: "damped-oscillator",
    summary: "oscillator with viscous damping, q'' = -omega2 q - gamma v",
    dimensions: 1..=1,
    parameters: &[MASS, STIFFNESS, OMEGA2, GAMMA],
    q: &[1.0],
    v: &[0.0],
    build: |values| {
        Ok(AnySystem::DampedOscillator(DampedOscillator {
            omega2: omega2(values)?,
            gamma: values.get(&GAMMA),
        }))
    },
};

/// The second coordinate is time, hence its velocity 1.
pub(super) const DRIVEN_OSCILLATOR: Entry = Entry {
    name: "driven-oscillator",
    summary: "damped oscillator under amplitude cos(drive t); q[1] is time t and v[1] is 1",
    dimensions: 2..=2,
    parameters: &[MASS, STIFFNESS, OMEGA2, GAMMA, AMPLITUDE, DRIVE],
    q: &[1.0, 0.0],
    v: &[0.0, 1.0],
    build: |values| {
        Ok(AnySystem::DrivenOscillator(DrivenOscillator {
            omega2: omega2(values)?,
            gamma: values.get(&GAMMA),
            amplitude: values.get(&AMPLITUDE),
            drive: values.get(&DRIVE),
        }))
    },
};

pub(super) const PENDULUM: Entry = Entry {
    name: "pendulum",
    summary: "mathematical pendulum, q'' = -omega2 sin q, q in rad",
    dimensions: 1..=1,
    parameters: &[SMALL_SWING],
    q: &[2.0],
    v: &[0.0],
    build: |values| Ok(AnySystem::Pendulum(Pendulum { omega2: values.get(&SMALL_SWING) })),
};

/// An orbit about both wells.
pub(super) const DUFFING: Entry = Entry {
    name: "duffing",
    summary: "Duffing oscillator, q'' = -alpha q - beta q^3",
    dimensions: 1..=1,
    parameters: &[ALPHA, BETA],
    q: &[1.5],
    v: &[0.0],
    build: |values| {
        Ok(AnySystem::Duffing(Duffing { alpha: values.get(&ALPHA), beta: values.get(&BETA) }))
    },
};

/// For the default `mu`, [`Kepler::perihelion`] at eccentricity 0.6; the period is then 2π.
pub(super) const KEPLER: Entry = Entry {
    name: "kepler",
    summary: "planar Kepler problem, q'' = -mu q/|q|^3",
    dimensions: 2..=2,
    parameters: &[MU],
    q: &[0.4, 0.0],
    v: &[0.0, 2.0],
    build: |values| Ok(AnySystem::Kepler(Kepler { mu: values.get(&MU) })),
};

/// The energy is 1/8: regular and chaotic orbits coexist.
pub(super) const HENON_HEILES: Entry = Entry {
    name: "henon-heiles",
    summary: "Henon-Heiles system of a star in a galaxy, in reduced units",
    dimensions: 2..=2,
    parameters: &[LAMBDA],
    q: &[0.0, 0.0],
    v: &[0.4, 0.3],
    build: |values| Ok(AnySystem::HenonHeiles(HenonHeiles { lambda: values.get(&LAMBDA) })),
};
