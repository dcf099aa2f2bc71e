//! Velocities that drive themselves.

use serde::Serialize;

use crate::Subject;
use crate::flow::Flow;

/// Velocities in units of their scales at which nothing moves.
const AT_REST: f64 = 1e-9;

/// A velocity whose rate grows with it.
#[derive(Clone, Debug, Serialize)]
pub struct DrivenVelocity {
    /// Its name.
    pub state: String,
    /// `∂v̇/∂v` of this velocity `v`, in 1/s.
    pub rate: f64,
}

/// None on a motion.
pub(crate) fn driven_velocities(
    flow: &Flow,
    pairs: Option<&[(usize, usize)]>,
    subject: &Subject,
) -> Vec<DrivenVelocity> {
    // Where something moves, forces by its velocity also turn and couple: they need not be damping.
    let moves = |v: usize| subject.state[v].abs() > AT_REST * subject.state_scale[v];
    if pairs.unwrap_or_default().iter().any(|(_, v)| moves(*v)) {
        return Vec::new();
    }
    let velocities = pairs.unwrap_or_default().iter().map(|(_, v)| *v);
    let of = |v: usize| {
        let (rate, error) = (flow.a[(v, v)], flow.a_errors[(v, v)]);
        (rate > 10.0 * error + 1e-9)
            .then(|| DrivenVelocity { state: subject.states[v].name.clone(), rate })
    };
    velocities.filter_map(of).collect()
}
