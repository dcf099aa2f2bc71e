//! Controllers of least cost for a loop with its timing.

use libration_core::control::Latency;
use thiserror::Error;

use crate::augmented_plant::AugmentedPlant;
use crate::compensator::{Compensator, Unsolved};
use crate::{
    DesignError, DiscreteController, LinearLoop, LinearLoopError, LoopTiming, Matrix, PlantMode,
};

/// Part of the variance that the noise of the plant adds to an output in a period, which a filter assumes as the noise of a measurement
/// that has none.
///
/// Without any, what a sample shows of several states at once has a singular covariance. The standard deviation is a part of 10⁻⁴.
pub const ASSUMED_NOISE: f64 = 1e-8;

/// A controller of least cost for a loop with its timing.
#[derive(Clone, Debug)]
pub struct Redesign {
    /// The controller.
    pub controller: DiscreteController,
    /// Its kind.
    pub kind: RedesignKind,
    /// The outputs without noise in which the filter assumes [`ASSUMED_NOISE`].
    pub assumed_noise: Vec<usize>,
    /// The cost per second (of a sampled plant: per sample) that its equations predict.
    pub cost: f64,
}

/// The kind of a redesigned controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RedesignKind {
    /// Feedback of all states, which are measured, and of the commands under way.
    StateFeedback,
    /// The same for periods and losses that are drawn, by a coupled Riccati equation.
    RandomStateFeedback,
    /// A Kalman filter and a regulator.
    Lqg,
    /// The optimal compensator for periods and losses that are drawn: filter and regulator by coupled equations.
    Compensator,
}

/// Error of a redesign.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum RedesignError {
    /// The timing is invalid, or the loop would be too large.
    #[error(transparent)]
    Loop(#[from] LinearLoopError),
    /// The design failed.
    #[error(transparent)]
    Design(#[from] DesignError),
    /// Nothing disturbs the loop.
    #[error(
        "no noise drives the plant, so that a filter has nothing to estimate; expected `g` with an entry that is not zero"
    )]
    NoNoise,
    /// A motion that the filter must know is not disturbed.
    #[error(
        "the filter is on the edge of stability: no noise drives {0}; help: let a column of `g` drive one of its states"
    )]
    Undisturbed(PlantMode),
    /// No controller of the kind is stable in the mean square.
    #[error(
        "no controller was found with which second moments decay: the equations for jitter of {jitter} (relative rms) and a loss \
         probability of {loss} have no solution, or one too close to the edge of stability; help: lower them"
    )]
    NotStabilised {
        /// The relative rms of the jitter.
        jitter: f64,
        /// The probability of a loss.
        loss: f64,
    },
}

impl LinearLoop {
    /// The controller of least cost for the loop with this timing.
    ///
    /// The commands and the measurements under way are states of a larger plant, exactly also for parts of a period (K. J. Åström, B.
    /// Wittenmark, *Computer-Controlled Systems*, 3rd ed., 1997). If all states are known, it is a feedback of them. Else a
    /// filter estimates them: the controller does not know the lengths of periods, nor which of its commands are lost.
    ///
    /// # Errors
    /// [`RedesignError`].
    pub fn redesign(&self, timing: &LoopTiming) -> Result<Redesign, RedesignError> {
        let knows = self.knows_states(timing);
        if !knows && self.plant().g.largest() == 0.0 {
            return Err(RedesignError::NoNoise);
        }
        let (assumed_noise, variances) = self.filter_noise();
        let own = if knows { self.output_noise() } else { &variances };
        let augmented = AugmentedPlant::new(self, timing, own)?;
        let size = augmented.a.rows();
        let memory = if knows { size - augmented.plant_states } else { size };
        let most = timing.most_states();
        if size + memory > most {
            return Err(LinearLoopError::Size { size: size + memory, most }.into());
        }
        let (n, m) = (self.plant().states.len(), self.plant().inputs.len());
        // Commands that act later cost nothing at once.
        let price = self.cost_form().block((n, n), (m, m)).scaled(augmented.length);
        let found = match knows {
            true => augmented.state_feedback(&price),
            false => augmented.output_feedback([&price, &Matrix::diagonal(&variances)]),
        };
        let found = found.map_err(|unsolved| self.unsolved(unsolved, timing))?;
        let kind = match (knows, augmented.is_random) {
            (true, false) => RedesignKind::StateFeedback,
            (true, true) => RedesignKind::RandomStateFeedback,
            (false, false) => RedesignKind::Lqg,
            (false, true) => RedesignKind::Compensator,
        };
        let redesign = Redesign {
            controller: controller(&augmented, &found),
            kind,
            assumed_noise: if knows { Vec::new() } else { assumed_noise },
            cost: found.cost / augmented.length,
        };
        let closed = self.with_controller(redesign.controller.clone())?;
        match closed.is_stable(timing)? {
            true => Ok(redesign),
            false => Err(self.unsolved(Unsolved::Random, timing)),
        }
    }

    /// Whether the controller knows all states, and all commands that matter.
    ///
    /// With losses it does not know the command that acts. Without latency the feedback of least cost does not depend on it: a new
    /// command that arrives replaces it at once, and one that is lost changes nothing.
    fn knows_states(&self, timing: &LoopTiming) -> bool {
        let plant = self.plant();
        let states = plant.c == Matrix::identity(plant.states.len()) && plant.d.largest() == 0.0;
        let exact = self.output_noise().iter().all(|variance| *variance == 0.0);
        let at_once =
            |channels: &[Latency]| channels.iter().all(|latency| *latency == Latency::NONE);
        let known = timing.loss == 0.0 || at_once(&timing.input_latency);
        states && exact && at_once(&timing.output_latency) && known
    }

    /// The outputs in whose measurements a filter assumes noise, and the variances of all.
    fn filter_noise(&self) -> (Vec<usize>, Vec<f64>) {
        let plant = self.plant();
        let added = plant.c.congruence(&plant.step_noise(self.period()));
        let given = self.output_noise();
        // No noise reaches an output whose motion is known without measuring it: any variance is as good.
        let assumed = |j: usize| match ASSUMED_NOISE * added[(j, j)] {
            variance if variance > 0.0 => variance,
            _ => 1.0,
        };
        let variance = |j: usize| if given[j] > 0.0 { given[j] } else { assumed(j) };
        let without = (0..given.len()).filter(|&j| given[j] == 0.0).collect();
        (without, (0..given.len()).map(variance).collect())
    }

    fn unsolved(&self, unsolved: Unsolved, timing: &LoopTiming) -> RedesignError {
        let plant = self.plant();
        let n = plant.states.len();
        let (jitter, loss) = (timing.jitter.rms(), timing.loss);
        match unsolved {
            Unsolved::Filter if let Some(mode) = plant.unobservable_mode() => {
                DesignError::Unobservable(mode).into()
            }
            Unsolved::Filter if let Some(mode) = plant.undisturbed_mode() => {
                RedesignError::Undisturbed(mode)
            }
            Unsolved::Filter => DesignError::Unsettled("filter").into(),
            Unsolved::Random if jitter > 0.0 || loss > 0.0 => {
                RedesignError::NotStabilised { jitter, loss }
            }
            _ if let Some(mode) = plant.unreachable_mode() => DesignError::Unreachable(mode).into(),
            _ if let Some(mode) =
                plant.mode_without_cost(&self.cost_form().block((0, 0), (n, n))) =>
            {
                DesignError::Unseen(mode).into()
            }
            _ => DesignError::Unsettled("regulator").into(),
        }
    }
}

/// The controller in state space. Its memory is the predicted state, or the part of it that its commands depend on.
fn controller(plant: &AugmentedPlant, compensator: &Compensator) -> DiscreteController {
    let AugmentedPlant { a, b, c, .. } = plant;
    let (size, p) = (a.rows(), c.rows());
    let mut gain = compensator.gain.clone();
    // x̂ over the prediction and the measurement.
    let (mut kept, mut received) = (Matrix::identity(size), Matrix::zeros(size, p));
    match &compensator.filter {
        Some(filter) => {
            kept.add_scaled(-1.0, &(filter * c));
            received = filter.clone();
        }
        None => {
            for i in 0..plant.plant_states {
                (kept[(i, i)], received[(i, i)]) = (0.0, 1.0);
            }
            // The command that acts, if it is not known, has no part in it but by rounding.
            for &place in &plant.unknown {
                (0..gain.rows()).for_each(|i| gain[(i, place)] = 0.0);
            }
        }
    }
    let mut closed = a.clone();
    closed.add_scaled(-1.0, &(b * &gain));
    let whole = DiscreteController {
        a: &closed * &kept,
        b: &closed * &received,
        c: (&gain * &kept).scaled(-1.0),
        d: (&gain * &received).scaled(-1.0),
    };
    without_unused(&whole)
}

/// The same controller without memory that its commands do not depend on, now or later.
fn without_unused(whole: &DiscreteController) -> DiscreteController {
    let memory = whole.memory();
    let read = |matrix: &Matrix, j: usize| (0..matrix.rows()).any(|i| matrix[(i, j)] != 0.0);
    let mut used: Vec<bool> = (0..memory).map(|j| read(&whole.c, j)).collect();
    let mut found = used.iter().filter(|used| **used).count();
    loop {
        let next = |j: usize| used[j] || (0..memory).any(|i| used[i] && whole.a[(i, j)] != 0.0);
        used = (0..memory).map(next).collect();
        let count = used.iter().filter(|used| **used).count();
        if count == found {
            break;
        }
        found = count;
    }
    let places: Vec<usize> = (0..memory).filter(|&j| used[j]).collect();
    let count = places.len();
    let DiscreteController { a, b, c, d } = whole;
    DiscreteController {
        a: Matrix::from_fn(count, count, |i, j| a[(places[i], places[j])]),
        b: Matrix::from_fn(count, b.columns(), |i, j| b[(places[i], j)]),
        c: Matrix::from_fn(c.rows(), count, |i, j| c[(i, places[j])]),
        d: d.clone(),
    }
}
