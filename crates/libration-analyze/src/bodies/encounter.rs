//! The closest encounter of a motion.

use libration::bodies::{Bodies, BodyIntegrator, BodySimulation};
use serde::Serialize;

use super::BodiesRequest;
use super::approach::ENCOUNTERS_AT_EACH_STEP;
use super::watch::Watch;

/// The two bodies of a motion that came nearest to each other.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Encounter {
    /// Their names.
    pub bodies: [String; 2],
    /// The distance of their centres.
    pub distance: f64,
    /// The time.
    pub t: f64,
    /// Steps of an orbit at that distance, `2π √(d³/G(m₁ + m₂))`, or of an oscillation in the pair potential there, over the time step. Of
    /// a splitting around the first body, kicks in that time. Below some 20 the step is too long for the encounter. None without masses,
    /// without forces, and for adaptive steps.
    pub steps_per_orbit: Option<f64>,
}

/// Bodies up to which they are taken at each sample.
pub(super) const MOST: usize = 2048;

/// The closest pair so far, of bodies that no watch looks at in each step.
#[derive(Debug)]
pub(super) struct Closest {
    count: usize,
    found: Option<([usize; 2], f64, f64)>,
}

impl Closest {
    pub(super) fn new(bodies: &Bodies) -> Self {
        Closest { count: bodies.count(), found: None }
    }

    pub(super) fn sample(&mut self, simulation: &BodySimulation) {
        if self.count <= ENCOUNTERS_AT_EACH_STEP || self.count > MOST {
            return;
        }
        if let Some((pair, distance)) = simulation.bodies().closest_pair()
            && self.found.is_none_or(|(_, least, _)| distance < least)
        {
            self.found = Some((pair, distance, simulation.time()));
        }
    }

    pub(super) fn encounter(
        &self,
        watch: Option<&Watch>,
        request: &BodiesRequest,
    ) -> Option<Encounter> {
        let (pair, distance, t) = watch.and_then(Watch::closest).or(self.found)?;
        Some(Encounter::new(request, pair, distance, t))
    }
}

impl Encounter {
    pub(super) fn new(request: &BodiesRequest, [i, j]: [usize; 2], distance: f64, t: f64) -> Self {
        let names = &request.system.names;
        Encounter {
            bodies: [names[i].clone(), names[j].clone()],
            distance,
            t,
            steps_per_orbit: steps_per_orbit(request, [i, j], distance),
        }
    }

    /// The pair with the fewest steps per orbit at the start: near a heavy body an orbit is short also far away. None of many bodies.
    pub(super) fn shortest_orbit(request: &BodiesRequest) -> Option<Self> {
        let places: Vec<[f64; 3]> =
            request.system.bodies.iter().map(|body| body.position).collect();
        if places.len() > MOST {
            return None;
        }
        let distance = |i: usize, j: usize| {
            let square = |k: usize| (places[i][k] - places[j][k]).powi(2);
            (0..3).map(square).sum::<f64>().sqrt()
        };
        let pairs = (0..places.len()).flat_map(|i| (i + 1..places.len()).map(move |j| [i, j]));
        let steps = |[i, j]: [usize; 2]| steps_per_orbit(request, [i, j], distance(i, j));
        let known = pairs.filter_map(|pair| Some((steps(pair)?, pair)));
        let (_, [i, j]) = known.min_by(|(a, _), (b, _)| a.total_cmp(b))?;
        Some(Encounter::new(request, [i, j], distance(i, j), 0.0))
    }
}

fn steps_per_orbit(request: &BodiesRequest, [i, j]: [usize; 2], distance: f64) -> Option<f64> {
    let bodies = &request.system.bodies;
    let (a, b) = (bodies.masses()[i], bodies.masses()[j]);
    let mut square = bodies.constant() * (a + b) / distance.powi(3);
    if bodies.pairs().is_some() {
        // The faster of a circle and of an oscillation along the line between the bodies.
        let [_, slope] = bodies.pair_terms(i, j, distance);
        let stiffness = bodies.pair_stiffness(i, j, distance);
        square += (slope / distance).max(stiffness).max(0.0) * (1.0 / a + 1.0 / b);
    }
    let kicks = match request.integrator {
        BodyIntegrator::WisdomHolman(_) => request.integrator.evaluations() as f64,
        BodyIntegrator::Method(_) => 1.0,
    };
    let steps = core::f64::consts::TAU / square.sqrt() / request.dt.abs() * kicks;
    (square > 0.0 && !request.is_adaptive).then_some(steps)
}
