//! The splitting of Wisdom and Holman in democratic heliocentric coordinates.

use libration_batch::ensemble::Execution;
use libration_equations::{Flow, VectorStep};

use super::BodiesError;
use super::bodies::Bodies;
use super::body_integrator::OrbitsAndKicks;
use super::direct_sum::{Attraction, axes, axes_mut};
use super::kepler_flow::kepler_flow;

/// Orbits around the first body as positions relative to it and velocities relative to the centre of mass.
///
/// M. J. Duncan, H. F. Levison, M. H. Lee, *The Astronomical Journal* 116, 1998; J. Wisdom, M. Holman, ibid. 102, 1991.
/// A step is half a kick by the forces between the others, half a drift of all by the momentum of the first, an orbit of each around
/// the first, and the same backwards; or a table says how orbits and kicks follow each other.
#[derive(Clone, Debug)]
pub(crate) struct DemocraticHeliocentric {
    order: OrbitsAndKicks,
    /// Of a table: drifts are orbits.
    flows: Vec<Flow>,
    /// `G·m` of the first body.
    central: f64,
    /// `m/m₀` of the others, and `G·m`.
    ratios: Vec<f64>,
    strengths: Vec<f64>,
    sources: usize,
    /// Three planes of the others.
    positions: Vec<f64>,
    velocities: Vec<f64>,
    accelerations: Vec<f64>,
    /// Positions and velocities before the step.
    last: [Vec<f64>; 2],
    /// Of the centre of mass.
    centre: [f64; 3],
    centre_velocity: [f64; 3],
}

impl DemocraticHeliocentric {
    /// # Errors
    /// [`BodiesError::CentralBody`] if the first body has no mass, is not the heaviest, or forces are not gravity or softened.
    pub(crate) fn new(
        bodies: &Bodies,
        order: OrbitsAndKicks,
        on: &Execution,
    ) -> Result<Self, BodiesError> {
        let [central, ref others @ ..] = *bodies.masses() else {
            return Err(BodiesError::CentralBody { reason: "there is no body" });
        };
        let heaviest = others.iter().copied().fold(0.0, f64::max);
        let reason = if bodies.pairs().is_some() {
            Some("orbits are solved for gravity alone; expected no pair potential")
        } else if bodies.constant() == 0.0 {
            Some("orbits need gravity; expected a gravitational constant above 0")
        } else if bodies.softening_length() > 0.0 {
            Some("orbits are solved without softening; expected softening 0")
        } else if others.is_empty() {
            Some("no body besides the first; expected at least 2 bodies")
        } else if central == 0.0 {
            Some("the first body has no mass; expected a mass above 0")
        } else if heaviest > central {
            Some("a body is heavier than the first; expected the heaviest body first")
        } else {
            None
        };
        if let Some(reason) = reason {
            return Err(BodiesError::CentralBody { reason });
        }
        let total: f64 = bodies.masses().iter().sum();
        let mean = |vectors: &[f64]| {
            axes(vectors).map(|plane| {
                let weighted = plane.iter().zip(bodies.masses()).map(|(x, mass)| x * mass);
                weighted.sum::<f64>() / total
            })
        };
        let (centre, centre_velocity) = (mean(bodies.positions()), mean(bodies.velocities()));
        let relative = |vectors: &[f64], to: [f64; 3]| -> Vec<f64> {
            let planes = axes(vectors).into_iter().zip(to);
            planes.flat_map(|(plane, to)| plane[1..].iter().map(move |x| x - to)).collect()
        };
        let first = bodies.body(0);
        let last = others.iter().rposition(|&mass| mass > 0.0);
        let mut new = DemocraticHeliocentric {
            order,
            flows: match order {
                OrbitsAndKicks::Leapfrog => Vec::new(),
                OrbitsAndKicks::Table(table) => VectorStep::flows(table).unwrap_or_default(),
            },
            central: bodies.strengths()[0],
            ratios: others.iter().map(|mass| mass / central).collect(),
            strengths: bodies.strengths()[1..].to_vec(),
            sources: last.map_or(0, |last| last + 1),
            positions: relative(bodies.positions(), first.position),
            velocities: relative(bodies.velocities(), centre_velocity),
            accelerations: vec![0.0; 3 * others.len()],
            last: [Vec::new(), Vec::new()],
            centre,
            centre_velocity,
        };
        new.evaluate(on);
        Ok(new)
    }

    fn evaluate(&mut self, on: &Execution) {
        let attraction =
            Attraction { strengths: &self.strengths, sources: self.sources, softening: 0.0 };
        attraction.accelerations(&self.positions, &mut self.accelerations, on);
    }

    pub(crate) fn step(&mut self, dt: f64, on: &Execution) {
        self.last[0].clone_from(&self.positions);
        self.last[1].clone_from(&self.velocities);
        match self.order {
            OrbitsAndKicks::Leapfrog => {
                self.kick(0.5 * dt);
                self.jump(0.5 * dt);
                self.orbit(dt);
                self.jump(0.5 * dt);
                self.evaluate(on);
                self.kick(0.5 * dt);
            }
            OrbitsAndKicks::Table(_) => {
                for i in 0..self.flows.len() {
                    match self.flows[i] {
                        Flow::Drift(fraction) => self.orbit(dt * fraction),
                        // They commute: the drift moves all others by the same, and their forces on each other add up to nothing.
                        Flow::Kick(fraction) => {
                            let part = dt * fraction;
                            self.jump(part);
                            self.evaluate(on);
                            self.kick(part);
                        }
                    }
                }
            }
        }
        for (centre, velocity) in self.centre.iter_mut().zip(self.centre_velocity) {
            *centre += dt * velocity;
        }
    }

    fn kick(&mut self, h: f64) {
        self.velocities.iter_mut().zip(&self.accelerations).for_each(|(v, a)| *v += h * a);
    }

    fn jump(&mut self, h: f64) {
        let momenta = axes(&self.velocities).map(|plane| weighted(plane, &self.ratios));
        for (plane, momentum) in axes_mut(&mut self.positions).into_iter().zip(momenta) {
            plane.iter_mut().for_each(|x| *x += h * momentum);
        }
    }

    fn orbit(&mut self, h: f64) {
        let [x, y, z] = axes_mut(&mut self.positions);
        let [vx, vy, vz] = axes_mut(&mut self.velocities);
        for i in 0..x.len() {
            let start = [[x[i], y[i], z[i]], [vx[i], vy[i], vz[i]]];
            [[x[i], y[i], z[i]], [vx[i], vy[i], vz[i]]] = kepler_flow(self.central, start, h);
        }
    }

    /// Writes the bodies before the last step.
    pub(crate) fn write_last(&self, bodies: &mut Bodies) {
        let [positions, velocities] = self.last.clone();
        DemocraticHeliocentric { positions, velocities, ..self.clone() }.write(bodies);
    }

    /// Positions and velocities of all bodies in inertial coordinates.
    pub(crate) fn write(&self, bodies: &mut Bodies) {
        let total: f64 = 1.0 + self.ratios.iter().sum::<f64>();
        let (positions, velocities) = bodies.state_mut();
        let planes = axes_mut(positions).into_iter().zip(axes(&self.positions)).zip(self.centre);
        for ((out, others), centre) in planes {
            let first = centre - weighted(others, &self.ratios) / total;
            out[0] = first;
            for (out, other) in out[1..].iter_mut().zip(others) {
                *out = first + other;
            }
        }
        let velocities = axes_mut(velocities).into_iter().zip(axes(&self.velocities));
        for ((out, others), centre) in velocities.zip(self.centre_velocity) {
            out[0] = centre - weighted(others, &self.ratios);
            for (out, other) in out[1..].iter_mut().zip(others) {
                *out = centre + other;
            }
        }
    }

    /// Sums of velocities and positions in a step, where an orbit has two of each, whose increments are as large as the state.
    pub(crate) fn sums(&self) -> [f64; 2] {
        let orbits = self.flows.iter().filter(|flow| matches!(flow, Flow::Drift(_))).count() as f64;
        let kicks = self.flows.len() as f64 - orbits;
        match self.order {
            OrbitsAndKicks::Leapfrog => [4.0, 4.0],
            OrbitsAndKicks::Table(_) => [2.0 * orbits + kicks; 2],
        }
    }

    /// Positions of the others relative to the first body.
    pub(crate) fn positions(&self) -> &[f64] {
        &self.positions
    }

    pub(crate) fn is_finite(&self) -> bool {
        self.positions.iter().chain(&self.velocities).all(|x| x.is_finite())
    }
}

fn weighted(plane: &[f64], weights: &[f64]) -> f64 {
    plane.iter().zip(weights).map(|(x, weight)| x * weight).sum()
}
