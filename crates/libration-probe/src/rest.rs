//! Whether a state is an equilibrium.

use serde::Serialize;

use crate::BlackBoxError;
use crate::prober::Prober;

/// Largest change per step in units of the scales at which a state counts as an equilibrium.
const AT_REST: f64 = 1e-8;

/// Whether a state is an equilibrium.
#[derive(Clone, Debug, Serialize)]
pub struct Rest {
    /// Whether its change in a step is a rounding.
    pub holds: bool,
    /// What the author of the simulator says.
    pub stated: Option<bool>,
    /// The largest change of a state in a step, in its unit.
    pub change: f64,
    /// The state that changes most.
    pub state: String,
}

impl Rest {
    pub(crate) fn measure(prober: &mut Prober<'_>) -> Result<Self, BlackBoxError> {
        let subject = prober.subject;
        let next = prober.step_one(&subject.state, &subject.action, subject.dt)?;
        let change = |i: usize| (next[i] - subject.state[i]).abs();
        let scaled = |i: usize| change(i) / subject.state_scale[i];
        let most = (0..next.len()).max_by(|&i, &j| scaled(i).total_cmp(&scaled(j))).unwrap_or(0);
        Ok(Rest {
            holds: scaled(most) <= AT_REST,
            stated: subject.equilibrium,
            change: change(most),
            state: subject.states[most].name.clone(),
        })
    }
}
