//! Kinds of findings, and what answers them.

use core::fmt;

use serde::Serialize;

use crate::shorter_step::shorter_step;

/// The kind of a finding, the same word for the same thing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FindingKind {
    /// The same call gives other results.
    NotReproducible,
    /// Environments share a generator of random numbers.
    SharedGenerator,
    /// All environments draw the same random numbers.
    SameNoise,
    /// A batch, a restart or threads give other bits.
    BitsDiffer,
    /// The step, an action or its length is rounded to single precision.
    SinglePrecision,
    /// Results jump between close states.
    Rough,
    /// A command acts in a later call.
    LateCommand,
    /// The returned states are those of an earlier call.
    LateState,
    /// Observations do not respond to the states.
    ConstantObservation,
    /// Observations are older than the states.
    StaleObservation,
    /// The delay of a command changes from step to step.
    IrregularDelay,
    /// The step has a state that it does not return.
    HiddenState,
    /// Half a step has the result of a step.
    IgnoresDt,
    /// Steps below a length have no effect, or one that does not depend on their length.
    FixedInnerStep,
    /// A velocity accelerates itself.
    NegativeDamping,
    /// The energy of a conservative system changes.
    EnergyLeak,
    /// The energy changes too much in one direction, by the step.
    EnergyDrift,
    /// The step is longer than the longest stable one.
    UnstableStep,
    /// A mode grows with every length of the step.
    GrowsAlways,
    /// The result holds for a part of the states only.
    LimitedValidity,
    /// The state is not the requested one, or does not hold.
    OperatingPoint,
    /// The state is no equilibrium.
    NoEquilibrium,
    /// The step has no derivative at the state.
    NotDifferentiable,
    /// The linear prediction fails for small deviations.
    Nonlinear,
    /// Derivatives of the simulator are not those of its step.
    DerivativesDiffer,
}

impl FindingKind {
    /// All kinds.
    pub const ALL: [FindingKind; 25] = [
        FindingKind::NotReproducible,
        FindingKind::SharedGenerator,
        FindingKind::SameNoise,
        FindingKind::BitsDiffer,
        FindingKind::SinglePrecision,
        FindingKind::Rough,
        FindingKind::LateCommand,
        FindingKind::LateState,
        FindingKind::ConstantObservation,
        FindingKind::StaleObservation,
        FindingKind::IrregularDelay,
        FindingKind::HiddenState,
        FindingKind::IgnoresDt,
        FindingKind::FixedInnerStep,
        FindingKind::NegativeDamping,
        FindingKind::EnergyLeak,
        FindingKind::EnergyDrift,
        FindingKind::UnstableStep,
        FindingKind::GrowsAlways,
        FindingKind::LimitedValidity,
        FindingKind::OperatingPoint,
        FindingKind::NoEquilibrium,
        FindingKind::NotDifferentiable,
        FindingKind::Nonlinear,
        FindingKind::DerivativesDiffer,
    ];

    /// Its name in text and in JSON.
    pub const fn name(self) -> &'static str {
        match self {
            FindingKind::NotReproducible => "not-reproducible",
            FindingKind::SharedGenerator => "shared-generator",
            FindingKind::SameNoise => "same-noise",
            FindingKind::BitsDiffer => "bits-differ",
            FindingKind::SinglePrecision => "single-precision",
            FindingKind::Rough => "rough",
            FindingKind::LateCommand => "late-command",
            FindingKind::LateState => "late-state",
            FindingKind::ConstantObservation => "constant-observation",
            FindingKind::StaleObservation => "stale-observation",
            FindingKind::IrregularDelay => "irregular-delay",
            FindingKind::HiddenState => "hidden-state",
            FindingKind::IgnoresDt => "ignores-dt",
            FindingKind::FixedInnerStep => "fixed-inner-step",
            FindingKind::NegativeDamping => "negative-damping",
            FindingKind::EnergyLeak => "energy-leak",
            FindingKind::EnergyDrift => "energy-drift",
            FindingKind::UnstableStep => "unstable-step",
            FindingKind::GrowsAlways => "grows-always",
            FindingKind::LimitedValidity => "limited-validity",
            FindingKind::OperatingPoint => "operating-point",
            FindingKind::NoEquilibrium => "no-equilibrium",
            FindingKind::NotDifferentiable => "not-differentiable",
            FindingKind::Nonlinear => "nonlinear",
            FindingKind::DerivativesDiffer => "derivatives-differ",
        }
    }

    /// What the reader should change, in a sentence. `dt` and `longest_dt` are the step and the longest stable one, in s.
    pub(crate) fn help(self, dt: f64, longest_dt: Option<f64>) -> String {
        if let (FindingKind::UnstableStep, Some(longest)) = (self, longest_dt) {
            return shorter_step(dt, longest);
        }
        let text = match self {
            FindingKind::NotReproducible => {
                "seed the generator in each call, return all states, and read no clock; or audit the step without its noise"
            }
            FindingKind::SharedGenerator => {
                "give each environment its own generator, seeded by the seed and its number"
            }
            FindingKind::SameNoise => {
                "seed the generator of each environment differently, by the seed and its number"
            }
            FindingKind::BitsDiffer => {
                "sum in one order for every batch and number of threads, and initialise all memory; else compare results with a tolerance"
            }
            FindingKind::SinglePrecision => {
                "compute in f64 (JAX: `jax_enable_x64`, PyTorch: `torch.float64`), or compare results to six digits only"
            }
            FindingKind::Rough => {
                "tighten the tolerance of iterative solvers or fix the number of their iterations, interpolate tables smoothly, and print 17 digits"
            }
            FindingKind::LateCommand => {
                "use the command in the call that receives it, or design the controller for this latency (`report.advise` in Python adds it)"
            }
            FindingKind::LateState => {
                "return the state at the end of the call, not one of an earlier call"
            }
            FindingKind::ConstantObservation => {
                "compute the observation from the state, and check that the function is given the right one"
            }
            FindingKind::StaleObservation => {
                "compute the observation from the state after the step"
            }
            FindingKind::IrregularDelay => {
                "count the delay in whole steps; a comparison of rounded times requires a margin of half a step"
            }
            FindingKind::HiddenState => {
                "return every state that the next step uses, such as filters, or reset it in each call"
            }
            FindingKind::IgnoresDt => {
                "pass dt to the integrator; if the step has one length only, audit with `--fixed-dt` (Python: `fixed_dt=True`)"
            }
            FindingKind::FixedInnerStep => {
                "divide each step into equal parts of at most the inner step; if the inner step is meant, keep dt a multiple of it"
            }
            FindingKind::NegativeDamping => {
                "reverse the sign of the force that grows with this velocity, unless it is a drive"
            }
            FindingKind::EnergyLeak => {
                "remove damping, friction and forces without a potential; if they are meant, audit without `--conservative` (Python: `conservative`)"
            }
            FindingKind::EnergyDrift => {
                "shorten the step, or use a symplectic integrator such as velocity Verlet"
            }
            FindingKind::UnstableStep => "shorten the step, or use an implicit integrator",
            FindingKind::GrowsAlways => {
                "replace the integrator, e.g. by symplectic Euler: the new velocity first, and with it the position"
            }
            FindingKind::LimitedValidity => {
                "audit again at each other state in which the simulator runs, such as without these contacts"
            }
            FindingKind::OperatingPoint => {
                "raise the gains of position, or give commands that hold the requested state; if the state that was found is meant, make it a keyframe"
            }
            FindingKind::NoEquilibrium => {
                "audit at an equilibrium (MuJoCo: `--settle`); if the motion is meant, add `--moving` (Python: `equilibrium=False`)"
            }
            FindingKind::NotDifferentiable => {
                "audit at a state off the contact, the limit or the standstill of friction; a program must print 17 digits, and scales must be typical deviations (`--state-scale`)"
            }
            FindingKind::Nonlinear => {
                "use the modes for smaller deviations only, and audit again at the other states of the motion"
            }
            FindingKind::DerivativesDiffer => {
                "use the matrices of this audit, and look for terms that the derivatives of the simulator leave out"
            }
        };

        text.to_owned()
    }
}

impl fmt::Display for FindingKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
