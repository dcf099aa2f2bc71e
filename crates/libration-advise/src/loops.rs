//! The loop of a request, with its controller as a linear map.

use libration::analysis::{CostError, Imperfections, LinearController, LqrError, NotLinear, Plant};
use libration::control::controller::{Luenberger, Pid, PidGains, StateFeedback};
use libration::control::{ControlError, Controller, Feedback, Latency, LqrWeights};
use libration::linear::{
    LinearLoop, LinearLoopError, LoopTiming, Matrix, MissingCommand, RedesignError,
};
use libration::{Float, Model, State, System};
use libration_settings::units::Units;

use super::control::{Control, Correction, Law, Regulator};
use super::operating_point::ModelAtOperatingPoint;
use super::request::Request;
use super::timed_loop::{CriticalLatency, StatedTiming, TimedLoop};

/// A controller chosen at run time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum AnyController {
    Feedback(StateFeedback<1>),
    Pid(Pid<1>),
    Observer(Luenberger<1>),
}

impl<T: Float> Controller<T, 1> for AnyController {
    /// The memory of the controller with the largest memory.
    type Memory = ([T; 1], ([T; 1], [T; 1]));

    fn check(&self, period: f64) -> Result<(), ControlError> {
        match self {
            AnyController::Feedback(own) => Controller::<T, 1>::check(own, period),
            AnyController::Pid(own) => Controller::<T, 1>::check(own, period),
            AnyController::Observer(own) => Controller::<T, 1>::check(own, period),
        }
    }

    fn start(&self, state: &State<T, 1>) -> Self::Memory {
        let none = [T::zero()];
        match self {
            AnyController::Feedback(_) => (none, (none, none)),
            AnyController::Pid(own) => own.start(state),
            AnyController::Observer(own) => {
                let (far, speed) = own.start(state);
                (far, (speed, none))
            }
        }
    }

    fn command(&self, memory: &mut Self::Memory, observed: &State<T, 1>, period: T) -> [T; 1] {
        match self {
            AnyController::Feedback(own) => own.command(&mut [], observed, period),
            AnyController::Pid(own) => own.command(memory, observed, period),
            AnyController::Observer(own) => {
                let mut estimated = (memory.0, memory.1.0);
                let command = own.command(&mut estimated, observed, period);
                (memory.0, memory.1.0) = estimated;
                command
            }
        }
    }
}

impl AnyController {
    /// The linear map of the controller at a period of `period` seconds.
    pub(super) fn linear(&self, period: f64) -> Result<LinearController, NotLinear> {
        match self {
            AnyController::Feedback(own) => LinearController::of(own, period),
            AnyController::Pid(own) => LinearController::of(own, period),
            AnyController::Observer(own) => LinearController::of(own, period),
        }
    }
}

/// A loop about its operating point.
pub(super) struct Loop<M> {
    pub(super) model: ModelAtOperatingPoint<M, 1>,
    pub(super) controller: AnyController,
    pub(super) linear: LinearController,
    pub(super) timed: TimedLoop,
    pub(super) control: Control,
    pub(super) weights: LqrWeights,
    /// The mass that a command of the request moves, in kg; the other numbers are per unit mass.
    mass: f64,
    pub(super) units: Units,
}

/// Error of the design of a loop.
#[derive(Debug, thiserror::Error)]
pub enum LoopError {
    /// The LQR design failed.
    #[error(transparent)]
    Lqr(#[from] LqrError),
    /// A number of the controller is invalid.
    #[error(transparent)]
    Control(#[from] ControlError),
    /// The controller is not linear.
    #[error(transparent)]
    NotLinear(#[from] NotLinear),
    /// The loop is too large, or a number of its timing is invalid.
    #[error(transparent)]
    Cost(#[from] CostError),
    /// The redesign failed.
    #[error(transparent)]
    Redesign(#[from] RedesignError),
    /// As for [`LoopError::Cost`].
    #[error(transparent)]
    Linear(#[from] LinearLoopError),
    /// The limit of the command is too low.
    #[error(
        "the operating point requires a command of {held} {unit}, but the limit is {most} {unit}"
    )]
    Weak {
        /// The limit.
        most: f64,
        /// The command that holds the operating point.
        held: f64,
        /// The unit of both.
        unit: &'static str,
    },
}

pub(super) const ORIGIN: State<f64, 1> = State { q: [0.0], v: [0.0] };

/// A model of a plant whose simulations may run on several threads.
pub(super) trait PlantModel: Model<1, On<f64>: Send + Sync> {}

impl<M: Model<1, On<f64>: Send + Sync>> PlantModel for M {}

impl<M: PlantModel> Loop<M> {
    /// The loop of `request` with its designed gains.
    pub(super) fn new(model: M, request: &Request, control: &Control) -> Result<Self, LoopError> {
        let at = request.system.q[0];
        let (mass, units) = (request.actuation().mass(), request.units());
        let model = ModelAtOperatingPoint { model, at: [at] };
        let plant = Plant::exact(model, ORIGIN, control.period);
        let [held] = model.model.on::<f64>().acceleration(&State { q: [at], v: [0.0] });
        let feedback = |gains: Feedback| AnyController::Feedback(StateFeedback::to_origin(gains));
        let controller = match control.law.per_mass(mass) {
            Law::Pd(gains) => feedback(gains),
            Law::Pid(gains) => {
                // The constant command at the operating point reduces the available command.
                let most = gains.most - held.abs();
                if most <= 0.0 {
                    let (most, held, unit) = (gains.most * mass, -held * mass, units.command);
                    return Err(LoopError::Weak { most, held, unit });
                }
                AnyController::Pid(Pid::new(PidGains { most, ..gains })?)
            }
            Law::Lqr(weights) => feedback(plant.lqr(weights)?),
            Law::Observer { feedback, correction } => {
                let gains = match feedback {
                    Regulator::Gains(gains) => gains,
                    Regulator::Lqr(weights) => plant.lqr(weights)?,
                };
                let observer = match correction {
                    Correction::Gains(correction) => plant.observer_with(correction),
                    Correction::Kalman(noise) => plant.observer(noise)?,
                };
                AnyController::Observer(Luenberger::to_origin(gains, observer))
            }
        };
        Controller::<f64, 1>::check(&controller, control.period)?;
        let linear = controller.linear(control.period)?;
        let weights = control.weights.map(|weights| weights.per_mass(mass));
        let weights = weights.unwrap_or_else(|| plant.energy());
        let timed = timed(&plant, &linear, control, weights)?;
        let control = control.clone();
        Ok(Loop { model, controller, linear, timed, control, weights, mass, units })
    }

    /// This, with its exact critical latency, which is known for state feedback.
    pub(super) fn with_critical_latency(mut self) -> Self {
        if let AnyController::Feedback(own) = self.controller {
            let critical = self.plant().split_critical_latency(own.gains);
            self.timed.critical_latency = Some(CriticalLatency(critical));
        }
        self
    }

    /// The theory of the same loop with another period.
    pub(super) fn with_period(&self, period: f64) -> Result<TimedLoop, LoopError> {
        let linear = self.controller.linear(period)?;
        let control = Control { period, ..self.control.clone() };
        Ok(timed(&Plant::exact(self.model, ORIGIN, period), &linear, &control, self.weights)?)
    }

    /// The plant in exact steps of a period, linearised.
    pub(super) fn plant(&self) -> Plant<'_> {
        Plant::exact(self.model, ORIGIN, self.control.period)
    }

    /// The stated imperfections.
    pub(super) fn stated(&self) -> Result<Imperfections, LoopError> {
        let LoopTiming { input_latency, jitter, skew, loss, .. } = self.timed.stated()?;
        Ok(Imperfections { latency: input_latency[0], jitter, skew, loss })
    }

    /// The stationary cost with these weights; infinite where second moments grow.
    pub(super) fn cost(&self, with: &LoopTiming, weights: LqrWeights) -> Result<f64, LoopError> {
        let linear = self.timed.linear.with_cost(form(weights))?;
        Ok(TimedLoop { linear, ..self.timed.clone() }.cost(with)?)
    }

    /// The stated latency for an even clock.
    pub(super) fn stated_latency(&self) -> Result<Latency, LoopError> {
        Ok(self.timed.latency(self.control.latency / self.control.period)?)
    }
}

/// The theory of a loop around a linearised plant.
fn timed(
    plant: &Plant<'_>,
    controller: &LinearController,
    control: &Control,
    weights: LqrWeights,
) -> Result<TimedLoop, LinearLoopError> {
    let linear = LinearLoop::new(
        plant.linear(),
        controller.discrete(),
        control.period,
        form(weights),
        vec![0.0; 2],
    )?;
    let Control { latency, jitter, skew, loss, .. } = *control;
    let timing = StatedTiming {
        input_latency: vec![latency],
        output_latency: vec![0.0; 2],
        jitter,
        skew,
        loss,
        missing: MissingCommand::Hold,
        record: control.record.clone(),
    };
    Ok(TimedLoop {
        linear,
        timing,
        names_states: false,
        critical_latency: None,
        is_near_neutral: false,
    })
}

fn form(LqrWeights { position, velocity, command }: LqrWeights) -> Matrix {
    Matrix::diagonal(&[position, velocity, command])
}

impl<M> Loop<M> {
    /// The gains of position and velocity for commands as accelerations.
    pub(super) fn gains(&self) -> Feedback {
        match &self.controller {
            AnyController::Feedback(own) => own.gains,
            AnyController::Observer(own) => own.gains,
            AnyController::Pid(_) => self.linear.gains(),
        }
    }

    /// The gains of position and velocity, in the units of the request.
    pub(super) fn given_gains(&self) -> Feedback {
        match self.control.law {
            Law::Pd(gains) => gains,
            _ => self.gains().times_mass(self.mass),
        }
    }

    /// The controller in words.
    pub(super) fn describe_controller(&self) -> String {
        let Feedback { position, velocity } = self.given_gains();
        let Units { command, gains: [of_position, of_velocity, of_integral], .. } = self.units;
        let gains = format!("K_p = {position:.6} {of_position}, K_d = {velocity:.6} {of_velocity}");
        match (self.control.law, &self.controller) {
            (Law::Pd(_), _) => format!("PD, {gains}"),
            (Law::Lqr(_), _) => format!("LQR, designed: {gains}"),
            (Law::Pid(g), _) => format!(
                "PID, K_p = {} {of_position}, K_i = {} {of_integral}, K_d = {} {of_velocity}, filter {} s, limit {} {command}",
                g.proportional, g.integral, g.derivative, g.filter, g.most
            ),
            (Law::Observer { feedback, correction }, AnyController::Observer(own)) => {
                let [q, v] = own.observer.correction;
                let designed = |is: bool| if is { ", designed" } else { "" };
                format!(
                    "feedback of an estimate{}: {gains}; observer{}: L = ({q:.6}, {v:.6} s⁻¹)",
                    designed(matches!(feedback, Regulator::Lqr(_))),
                    designed(matches!(correction, Correction::Kalman(_)))
                )
            }
            (Law::Observer { .. }, _) => gains,
        }
    }
}
