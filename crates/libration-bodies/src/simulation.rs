//! A simulation of bodies.

use libration_batch::ensemble::Execution;
use libration_core::with_method;
use libration_equations::VectorStep;

use super::BodiesError;
use super::bodies::Bodies;
use super::body_integrator::BodyIntegrator;
use super::body_vectors::{self, BodyVector};
use super::closest_pair::ClosestPair;
use super::democratic_heliocentric::DemocraticHeliocentric;
use super::step_density::StepDensity;
use super::step_plan::{ACCELERATIONS, POSITIONS, StepPlan, VELOCITIES};

/// Bodies in motion, with a fixed time step.
#[derive(Clone, Debug)]
pub struct BodySimulation {
    pub(super) bodies: Bodies,
    integrator: BodyIntegrator,
    pub(super) dt: f64,
    pub(super) steps: u64,
    pub(super) on: Execution,
    pub(super) stepper: Stepper,
    pub(super) has_radii: bool,
    encounters: Option<ClosestPair>,
    time: f64,
    /// Of the last step; before the first its length.
    pub(super) length: f64,
    density: Option<StepDensity>,
}

/// What moves the bodies.
#[derive(Clone, Debug)]
pub(super) enum Stepper {
    Plan { plan: StepPlan, vectors: Vec<BodyVector> },
    Heliocentric(Box<DemocraticHeliocentric>),
}

impl BodySimulation {
    /// A simulation from time 0.
    ///
    /// With `compensated` sums, positions and velocities keep what their sums round off (Kahan 1965).
    ///
    /// # Errors
    /// [`BodiesError`] if `dt` is zero or not finite, two bodies touch, softening or charges have no effect, or the integrator does not apply.
    pub fn new(
        bodies: Bodies,
        integrator: BodyIntegrator,
        dt: f64,
        compensated: bool,
        on: Execution,
    ) -> Result<Self, BodiesError> {
        if dt == 0.0 || !dt.is_finite() {
            return Err(BodiesError::TimeStep { dt });
        }
        bodies.ensure_effects()?;
        let has_radii = bodies.radii().iter().any(|&radius| radius > 0.0);
        let stepper = match integrator {
            BodyIntegrator::Method(method) => {
                let plan = StepPlan::new(method, dt);
                let vector = || BodyVector::new(vec![0.0; 3 * bodies.count()], compensated);
                let mut vectors: Vec<_> = (0..plan.registers).map(|_| vector()).collect();
                vectors[POSITIONS].values.copy_from_slice(bodies.positions());
                vectors[VELOCITIES].values.copy_from_slice(bodies.velocities());
                Stepper::Plan { plan, vectors }
            }
            BodyIntegrator::WisdomHolman(_) if compensated => {
                let reason =
                    "sums are not compensated; expected an integrator in inertial coordinates";
                return Err(BodiesError::CentralBody { reason });
            }
            BodyIntegrator::WisdomHolman(order) => {
                Stepper::Heliocentric(Box::new(DemocraticHeliocentric::new(&bodies, order, &on)?))
            }
        };
        let mut simulation = BodySimulation {
            bodies,
            integrator,
            dt,
            steps: 0,
            on,
            stepper,
            has_radii,
            encounters: None,
            time: 0.0,
            length: dt,
            density: None,
        };
        simulation.check_distances()?;
        simulation.evaluate_start();
        Ok(simulation)
    }

    /// The accelerations with which a step begins that carries them.
    fn evaluate_start(&mut self) {
        if let Stepper::Plan { plan, vectors } = &mut self.stepper
            && plan.carries
        {
            let forces = self.bodies.forces();
            let mut out = core::mem::take(&mut vectors[ACCELERATIONS]);
            forces.accelerations(&vectors[POSITIONS].values, &mut out.values, &self.on);
            vectors[ACCELERATIONS] = out;
        }
    }

    /// Takes steps.
    ///
    /// # Errors
    /// [`BodiesError::Collision`] of bodies with radii, which are then where they collide; [`BodiesError::SamePlace`] and
    /// [`BodiesError::Overflow`], where the bodies are those before the step.
    pub fn advance(&mut self, steps: u64) -> Result<(), BodiesError> {
        self.advance_until(steps, &|| false)
    }

    /// Takes steps until `should_stop` returns true, which it is asked before each sum over all pairs.
    ///
    /// # Errors
    /// As for [`advance`](Self::advance), and [`BodiesError::Stopped`], after which the simulation is of no use.
    pub fn advance_until(
        &mut self,
        steps: u64,
        should_stop: &dyn Fn() -> bool,
    ) -> Result<(), BodiesError> {
        for _ in 0..steps {
            self.step(should_stop)?;
        }
        self.write();
        Ok(())
    }

    fn step(&mut self, should_stop: &dyn Fn() -> bool) -> Result<(), BodiesError> {
        let (length, scale) = self.next_length()?;
        let is_finite = match &mut self.stepper {
            Stepper::Plan { plan, vectors } => {
                // The state before the step names the bodies of a failure.
                let (positions, velocities) = self.bodies.state_mut();
                positions.copy_from_slice(&vectors[POSITIONS].values);
                velocities.copy_from_slice(&vectors[VELOCITIES].values);
                let forces = self.bodies.forces();
                if !body_vectors::run(plan, scale, vectors, &forces, &self.on, should_stop) {
                    return Err(BodiesError::Stopped);
                }
                is_finite(&vectors[VELOCITIES].values) && is_finite(&vectors[POSITIONS].values)
            }
            Stepper::Heliocentric(orbits) => {
                orbits.step(self.dt, &self.on);
                let is_finite = orbits.is_finite();
                if !is_finite {
                    orbits.write_last(&mut self.bodies);
                }
                is_finite
            }
        };
        if !is_finite {
            return Err(self.failure());
        }
        self.steps += 1;
        self.length = length;
        self.time = match self.density {
            Some(_) => self.time + length,
            None => self.steps as f64 * self.dt,
        };
        if self.has_radii {
            // Distances are those of the bodies that were written.
            self.write();
            self.check_distances()?;
        }
        if let Some(mut closest) = self.encounters.take() {
            self.look(&mut closest);
            self.encounters = Some(closest);
        }
        Ok(())
    }

    /// Looks for the closest encounter at each step from now on: for few bodies, as it takes the distances of all pairs.
    pub fn watch_encounters(&mut self) {
        let mut closest = ClosestPair::default();
        self.look(&mut closest);
        self.encounters = Some(closest);
    }

    fn look(&self, closest: &mut ClosestPair) {
        let (positions, is_relative) = match &self.stepper {
            Stepper::Plan { vectors, .. } => (&vectors[POSITIONS].values[..], false),
            Stepper::Heliocentric(orbits) => (orbits.positions(), true),
        };
        closest.update(positions, is_relative, self.time());
    }

    /// The two bodies that came nearest to each other since [`watch_encounters`](Self::watch_encounters), their distance and the time.
    pub fn closest_encounter(&self) -> Option<([usize; 2], f64, f64)> {
        self.encounters.as_ref().and_then(ClosestPair::found)
    }

    /// The length of the next step, and that over the time step of the plan.
    fn next_length(&mut self) -> Result<(f64, f64), BodiesError> {
        let (Some(density), Stepper::Plan { vectors, .. }) = (&mut self.density, &self.stepper)
        else {
            return Ok((self.dt, 1.0));
        };
        let (q, v) = (&vectors[POSITIONS].values, &vectors[VELOCITIES].values);
        match density.next_length(&self.bodies, q, v) {
            Some(length) => Ok((length, length / self.dt)),
            None => Err(BodiesError::Density { time: self.time }),
        }
    }

    /// The same bodies with steps that follow their encounters and stay reversible: `dt` is the length of the first. The distances of all
    /// pairs at each step take time of their own.
    ///
    /// # Errors
    /// [`BodiesError::Adaptive`] unless the integrator is a symmetric sequence of kicks and drifts, a pair attracts, and gravity is all there is.
    pub fn adaptive(mut self) -> Result<Self, BodiesError> {
        let flows = match self.integrator {
            BodyIntegrator::Method(method) => {
                with_method!(method, |integrator| VectorStep::flows(integrator))
            }
            BodyIntegrator::WisdomHolman(_) => None,
        };
        if !flows.is_some_and(|flows| flows.iter().eq(flows.iter().rev())) {
            let reason = "requires a symmetric integrator of kicks and drifts, such as leapfrog";
            return Err(BodiesError::Adaptive { reason });
        }
        if self.bodies.pairs().is_some() {
            let reason = "steps follow gravity alone; expected no pair potential";
            return Err(BodiesError::Adaptive { reason });
        }
        let density = StepDensity::new(&self.bodies, self.dt);
        let reason = "requires two bodies, one of them with a mass";
        self.density = Some(density.ok_or(BodiesError::Adaptive { reason })?);
        Ok(self)
    }

    /// Writes the state of the stepper to the bodies.
    fn write(&mut self) {
        match &self.stepper {
            Stepper::Plan { vectors, .. } => {
                let (positions, velocities) = self.bodies.state_mut();
                positions.copy_from_slice(&vectors[POSITIONS].values);
                velocities.copy_from_slice(&vectors[VELOCITIES].values);
            }
            Stepper::Heliocentric(orbits) => orbits.write(&mut self.bodies),
        }
    }

    /// The bodies after the steps so far.
    pub fn bodies(&self) -> &Bodies {
        &self.bodies
    }

    /// The integrator.
    pub fn integrator(&self) -> BodyIntegrator {
        self.integrator
    }

    /// Steps so far.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// The time step.
    pub fn dt(&self) -> f64 {
        self.dt
    }

    /// The time: steps times `dt`, or the sum of the lengths of adaptive steps.
    pub fn time(&self) -> f64 {
        self.time
    }
}

fn is_finite(values: &[f64]) -> bool {
    // A product with zero is zero, but for infinities and NaN: a sum without branches.
    values.iter().map(|x| x * 0.0).sum::<f64>() == 0.0
}
