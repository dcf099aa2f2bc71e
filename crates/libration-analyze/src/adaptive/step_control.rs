//! Ways to choose the length of a step.

/// How the length of a step follows the motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepControl {
    /// From the state before the step alone. The energy drifts.
    Naive,
    /// From the mean of the states at both ends, an equation for one number: P. Hut, J. Makino, S. McMillan, *The Astrophysical Journal*
    /// 443, 1995.
    Symmetric,
    /// From a density of steps with an equation of motion of its own, without equations to solve: E. Hairer, G. Söderlind, *SIAM Journal on
    /// Scientific Computing* 26, 2005.
    Integrating,
}

impl StepControl {
    /// All of them.
    pub const ALL: [StepControl; 3] =
        [StepControl::Naive, StepControl::Symmetric, StepControl::Integrating];

    /// Name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            StepControl::Naive => "naive",
            StepControl::Symmetric => "symmetric",
            StepControl::Integrating => "integrating",
        }
    }

    /// A description in one line.
    pub const fn summary(self) -> &'static str {
        match self {
            StepControl::Naive => "from the state before the step; the energy drifts",
            StepControl::Symmetric => {
                "from both ends of the step, by iteration; reversible to rounding"
            }
            StepControl::Integrating => {
                "from a density of steps that is integrated; reversible, without iteration"
            }
        }
    }

    /// The control of that name, if there is one.
    pub fn from_name(name: &str) -> Option<Self> {
        StepControl::ALL.into_iter().find(|control| control.name() == name)
    }
}
