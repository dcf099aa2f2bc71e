//! A finding of an audit.

use core::fmt;

use serde::Serialize;

/// The kind of a finding, the same word for the same thing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FindingKind {
    /// The energy drifts at a rate that does not depend on the step.
    StepIndependentDrift,
    /// The energy fluctuates by an amount that does not fall with the step.
    StepIndependentOscillation,
    /// The energy drifts at a rate that grows as the step falls.
    RoundingDrift,
    /// The energy wanders the more, the shorter the step.
    RoundingWalk,
    /// The energy wanders as far with each step.
    StepIndependentWalk,
    /// The energy drifts at a rate of first order.
    FirstOrderDrift,
    /// The energy drifts at a rate that falls with the step.
    TruncationDrift,
    /// The energy drifts, and the runs do not tell why.
    UnclearDrift,
    /// The energy wanders, and the runs do not tell why.
    UnclearWalk,
    /// A run is too short for the memory of its energy, or the runs do not tell how the oscillation depends on the step.
    UnclearOscillation,
    /// The oscillation has order 1.
    FirstOrderOscillation,
    /// The runs are too short for the tolerance over the horizon.
    ShortRun,
    /// The runs start at different energies.
    DifferentStart,
    /// Samples are probably further apart than a time step.
    Thinned,
    /// Energies have too few digits.
    CoarseEnergy,
    /// A sample, a stretch or a jump of a run is out of line with all others.
    LocalDeviation,
    /// The runs do not converge, so that their energies are no evidence.
    NotConverged,
}

impl FindingKind {
    /// All kinds.
    pub const ALL: [FindingKind; 17] = [
        FindingKind::StepIndependentDrift,
        FindingKind::StepIndependentOscillation,
        FindingKind::RoundingDrift,
        FindingKind::RoundingWalk,
        FindingKind::StepIndependentWalk,
        FindingKind::FirstOrderDrift,
        FindingKind::TruncationDrift,
        FindingKind::UnclearDrift,
        FindingKind::UnclearWalk,
        FindingKind::UnclearOscillation,
        FindingKind::FirstOrderOscillation,
        FindingKind::ShortRun,
        FindingKind::DifferentStart,
        FindingKind::Thinned,
        FindingKind::CoarseEnergy,
        FindingKind::LocalDeviation,
        FindingKind::NotConverged,
    ];

    /// Its name in text and in JSON.
    pub const fn name(self) -> &'static str {
        match self {
            FindingKind::StepIndependentDrift => "step-independent-drift",
            FindingKind::StepIndependentOscillation => "step-independent-oscillation",
            FindingKind::RoundingDrift => "rounding-drift",
            FindingKind::RoundingWalk => "rounding-walk",
            FindingKind::StepIndependentWalk => "step-independent-walk",
            FindingKind::FirstOrderDrift => "first-order-drift",
            FindingKind::TruncationDrift => "truncation-drift",
            FindingKind::UnclearDrift => "unclear-drift",
            FindingKind::UnclearWalk => "unclear-walk",
            FindingKind::UnclearOscillation => "unclear-oscillation",
            FindingKind::FirstOrderOscillation => "first-order-oscillation",
            FindingKind::ShortRun => "short-run",
            FindingKind::DifferentStart => "different-start",
            FindingKind::Thinned => "thinned",
            FindingKind::CoarseEnergy => "coarse-energy",
            FindingKind::LocalDeviation => "local-deviation",
            FindingKind::NotConverged => "not-converged",
        }
    }

    /// Whether it is a fault of the simulation; else a fact that a reader of the numbers must know.
    pub const fn is_fault(self) -> bool {
        matches!(
            self,
            FindingKind::StepIndependentDrift
                | FindingKind::StepIndependentOscillation
                | FindingKind::RoundingDrift
                | FindingKind::RoundingWalk
                | FindingKind::StepIndependentWalk
                | FindingKind::FirstOrderDrift
        )
    }

    /// What to change, in a sentence.
    pub const fn help(self) -> &'static str {
        match self {
            FindingKind::StepIndependentDrift => {
                "check that each force is the negative gradient of the energy that is written, and that no thermostat, friction or drive acts; a shorter step does not help"
            }
            FindingKind::StepIndependentOscillation => {
                "write the energy whose gradient the force is: shift or switch a truncated potential, and include the energy of thermostats, barostats and constraints; a shorter step does not help"
            }
            FindingKind::RoundingDrift | FindingKind::RoundingWalk => {
                "accumulate positions and velocities in double precision or with compensated sums, tighten tolerances of constraints and solvers, or lengthen the step"
            }
            FindingKind::StepIndependentWalk => {
                "switch off thermostats, random forces and dropout, and tighten tolerances of iterative solvers"
            }
            FindingKind::FirstOrderDrift => {
                "use a symplectic integrator, such as velocity Verlet; check that positions and velocities belong to the same time"
            }
            FindingKind::TruncationDrift => {
                "shorten the step, or use a symplectic integrator, whose energy does not drift"
            }
            FindingKind::UnclearDrift | FindingKind::UnclearWalk => {
                "add a run with a step at least four times as short, or make all runs longer"
            }
            FindingKind::UnclearOscillation => {
                "make the runs longer; if the fluctuation still does not fall with the step, the force is not the gradient of the energy that is written"
            }
            FindingKind::FirstOrderOscillation => {
                "compute kinetic and potential energies at the same time; velocity Verlet has order 2"
            }
            FindingKind::ShortRun => "make the runs longer, or lower the horizon",
            FindingKind::DifferentStart => {
                "start all runs from the same positions and velocities, at the same time"
            }
            FindingKind::Thinned => "give the time steps with --dt",
            FindingKind::CoarseEnergy => "write energies with all digits",
            FindingKind::LocalDeviation => {
                "look at the run at that time: a damaged or missing row, a restart, a change of units, or an event that happens once"
            }
            FindingKind::NotConverged => {
                "repeat the runs with steps at least four times as short, or write the energies of each step; of an energy with an arbitrary constant state the scale (--scale)"
            }
        }
    }
}

impl fmt::Display for FindingKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A finding.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// Its kind.
    pub kind: FindingKind,
    /// Whether it is a fault.
    pub is_fault: bool,
    /// The finding in a sentence, with its evidence.
    pub text: String,
    /// What to change.
    pub help: String,
}

impl Finding {
    pub(crate) fn new(kind: FindingKind, text: String) -> Self {
        Finding { kind, is_fault: kind.is_fault(), text, help: kind.help().to_owned() }
    }
}
