//! Bodies: masses, positions and velocities.

use super::BodiesError;
use super::closest_pair::ClosestPair;
use super::direct_sum::{Attraction, axes};
use super::forces::{Forces, PairForces};
use super::pair_potential::PairPotential;

/// Most bodies of a direct sum.
pub const MOST_BODIES: usize = 1 << 16;

/// Bodies in space: any number of them, as planes of coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct Bodies {
    masses: Vec<f64>,
    radii: Vec<f64>,
    charges: Vec<f64>,
    pair_potential: Option<PairPotential>,
    gravitational_constant: f64,
    softening: f64,
    /// `G·m`.
    strengths: Vec<f64>,
    /// Three planes: `x` of all bodies, then `y`, then `z`.
    positions: Vec<f64>,
    velocities: Vec<f64>,
}

/// One body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Body {
    /// At least zero; a body without mass feels the others, which do not feel it.
    pub mass: f64,
    /// Position.
    pub position: [f64; 3],
    /// Velocity.
    pub velocity: [f64; 3],
    /// At least zero. Two bodies whose distance is below the sum of their radii collide.
    pub radius: f64,
    /// A number of its own for a pair potential, of any sign.
    pub charge: f64,
}

impl Bodies {
    /// Bodies with `G = 1` and without softening.
    ///
    /// # Errors
    /// [`BodiesError`] if there are none or too many, if a number is not finite, or a mass or radius is negative.
    pub fn new(bodies: &[Body]) -> Result<Self, BodiesError> {
        if bodies.is_empty() || bodies.len() > MOST_BODIES {
            return Err(BodiesError::Count { count: bodies.len(), least: 1, most: MOST_BODIES });
        }
        for (body, properties) in bodies.iter().enumerate() {
            let coordinates = properties.position.iter().chain(&properties.velocity);
            let coordinates = coordinates.chain([&properties.charge]);
            let names = ["x", "y", "z", "vx", "vy", "vz", "charge"];
            if let Some((&value, field)) =
                coordinates.zip(names).find(|(value, _)| !value.is_finite())
            {
                return Err(BodiesError::NotFinite { body, field, value });
            }
            for (field, value) in [("mass", properties.mass), ("radius", properties.radius)] {
                if !(value >= 0.0 && value.is_finite()) {
                    return Err(BodiesError::Negative { body, field, value });
                }
            }
        }
        let plane = |of: fn(&Body) -> [f64; 3]| -> Vec<f64> {
            (0..3).flat_map(|axis| bodies.iter().map(move |body| of(body)[axis])).collect()
        };
        let masses: Vec<f64> = bodies.iter().map(|body| body.mass).collect();
        Ok(Bodies {
            radii: bodies.iter().map(|body| body.radius).collect(),
            charges: bodies.iter().map(|body| body.charge).collect(),
            pair_potential: None,
            gravitational_constant: 1.0,
            softening: 0.0,
            strengths: masses.clone(),
            positions: plane(|body| body.position),
            velocities: plane(|body| body.velocity),
            masses,
        })
    }

    /// Sets the constant of gravitation, in the units of the masses, positions and velocities.
    ///
    /// # Errors
    /// [`BodiesError::Constant`] unless it is at least zero and finite, and so are all products with masses.
    pub fn gravitational_constant(mut self, value: f64) -> Result<Self, BodiesError> {
        let strengths: Vec<f64> = self.masses.iter().map(|mass| value * mass).collect();
        let is_allowed = value >= 0.0 && value.is_finite();
        if !is_allowed || strengths.iter().any(|strength| !strength.is_finite()) {
            return Err(BodiesError::Constant { value });
        }
        (self.gravitational_constant, self.strengths) = (value, strengths);
        Ok(self)
    }

    /// Sets the softening length `ε` of the potential `−Gm/√(r² + ε²)`.
    ///
    /// # Errors
    /// [`BodiesError::Softening`] unless it is at least zero and its square is finite.
    pub fn softening(mut self, length: f64) -> Result<Self, BodiesError> {
        if !(length >= 0.0 && (length * length).is_finite()) {
            return Err(BodiesError::Softening { length });
        }
        self.softening = length;
        Ok(self)
    }

    /// Adds the forces of a potential between all pairs. Gravity stays unless its constant is zero.
    ///
    /// # Errors
    /// [`BodiesError::Massless`] if a body has no mass.
    pub fn pair_potential(mut self, potential: PairPotential) -> Result<Self, BodiesError> {
        if let Some(body) = self.masses.iter().position(|&mass| mass == 0.0) {
            return Err(BodiesError::Massless { body });
        }
        self.pair_potential = Some(potential);
        Ok(self)
    }

    /// Checks that softening and charges have an effect.
    ///
    /// # Errors
    /// [`BodiesError::NothingToSoften`] and [`BodiesError::Charge`].
    pub fn ensure_effects(&self) -> Result<(), BodiesError> {
        if self.softening > 0.0 && self.gravitational_constant == 0.0 {
            return Err(BodiesError::NothingToSoften);
        }
        match self.charges.iter().position(|&charge| charge != 0.0) {
            Some(body) if self.pair_potential.is_none() => {
                Err(BodiesError::Charge { body, value: self.charges[body] })
            }
            _ => Ok(()),
        }
    }

    /// The number of bodies.
    pub fn count(&self) -> usize {
        self.masses.len()
    }

    /// The masses.
    pub fn masses(&self) -> &[f64] {
        &self.masses
    }

    /// The radii.
    pub fn radii(&self) -> &[f64] {
        &self.radii
    }

    /// The charges.
    pub fn charges(&self) -> &[f64] {
        &self.charges
    }

    /// The potential between all pairs besides gravity, if there is one.
    pub fn pairs(&self) -> Option<&PairPotential> {
        self.pair_potential.as_ref()
    }

    /// The energy of bodies `i` and `j` in the pair potential at a distance, and its derivative by the distance. Zero without a potential.
    pub fn pair_terms(&self, i: usize, j: usize, distance: f64) -> [f64; 2] {
        let pair = self.pair_at(i, j, distance);
        self.pair_potential.as_ref().map_or([0.0; 2], |potential| potential.terms(&pair))
    }

    /// The second derivative of that energy.
    pub fn pair_stiffness(&self, i: usize, j: usize, distance: f64) -> f64 {
        let pair = self.pair_at(i, j, distance);
        self.pair_potential.as_ref().map_or(0.0, |potential| potential.second_derivative(&pair))
    }

    fn pair_at(&self, i: usize, j: usize, distance: f64) -> [f64; 7] {
        let (a, b) = (i.min(j), i.max(j));
        let (masses, charges) = (&self.masses, &self.charges);
        [distance, 0.0, 0.0, masses[a], masses[b], charges[a], charges[b]]
    }

    /// The softening length.
    pub fn softening_length(&self) -> f64 {
        self.softening
    }

    /// The constant of gravitation.
    pub fn constant(&self) -> f64 {
        self.gravitational_constant
    }

    /// Body `i`.
    pub fn body(&self, i: usize) -> Body {
        Body {
            mass: self.masses[i],
            position: axes(&self.positions).map(|plane| plane[i]),
            velocity: axes(&self.velocities).map(|plane| plane[i]),
            radius: self.radii[i],
            charge: self.charges[i],
        }
    }

    /// All bodies.
    pub fn iter(&self) -> impl Iterator<Item = Body> + '_ {
        (0..self.count()).map(|i| self.body(i))
    }

    /// Three planes of positions: `x` of all bodies, then `y`, then `z`.
    pub fn positions(&self) -> &[f64] {
        &self.positions
    }

    /// Three planes of velocities.
    pub fn velocities(&self) -> &[f64] {
        &self.velocities
    }

    /// `G·m` of each body.
    pub(crate) fn strengths(&self) -> &[f64] {
        &self.strengths
    }

    /// Positions and velocities, to be moved.
    pub(crate) fn state_mut(&mut self) -> (&mut Vec<f64>, &mut Vec<f64>) {
        (&mut self.positions, &mut self.velocities)
    }

    pub(crate) fn forces(&self) -> Forces<'_> {
        let (masses, charges) = (&self.masses, &self.charges);
        let pairs = self.pair_potential.as_ref();
        let pairs = pairs.map(|potential| PairForces { potential, masses, charges });
        Forces { gravity: self.attraction(), pairs }
    }

    pub(crate) fn attraction(&self) -> Attraction<'_> {
        let last = self.strengths.iter().rposition(|&strength| strength > 0.0);
        Attraction {
            strengths: &self.strengths,
            sources: last.map_or(0, |last| last + 1),
            softening: self.softening * self.softening,
        }
    }

    /// Moves the centre of mass to the origin, at rest. Nothing changes if no body has a mass.
    pub fn centred(mut self) -> Self {
        let total: f64 = self.masses.iter().sum();
        if total > 0.0 {
            let count = self.count();
            for vectors in [&mut self.positions, &mut self.velocities] {
                for plane in vectors.chunks_mut(count) {
                    let weighted: f64 =
                        plane.iter().zip(&self.masses).map(|(x, mass)| x * mass).sum();
                    plane.iter_mut().for_each(|x| *x -= weighted / total);
                }
            }
        }
        self
    }

    /// The two bodies that are nearest to each other, and their distance. None for a single body.
    pub fn closest_pair(&self) -> Option<([usize; 2], f64)> {
        let mut closest = ClosestPair::default();
        closest.update(&self.positions, false, 0.0);
        closest.found().map(|(pair, distance, _)| (pair, distance))
    }

    /// The first two bodies whose distance is below the sum of their radii, and the distance.
    pub(crate) fn first_collision(&self) -> Option<(usize, usize, f64)> {
        let mut first = None;
        self.for_each_pair(|i, j, distance| {
            if first.is_none() && distance < self.radii[i] + self.radii[j] {
                first = Some((i, j, distance));
            }
        });
        first
    }

    /// Calls `visit` with each pair and its distance.
    pub(crate) fn for_each_pair(&self, mut visit: impl FnMut(usize, usize, f64)) {
        let planes = axes(&self.positions);
        for j in 1..self.count() {
            for i in 0..j {
                let square: f64 = planes.iter().map(|plane| (plane[j] - plane[i]).powi(2)).sum();
                visit(i, j, square.sqrt());
            }
        }
    }
}
