//! Velocities that drive themselves.

use serde::Serialize;

use crate::Subject;
use crate::flow::Flow;

/// A velocity whose rate grows with it.
#[derive(Clone, Debug, Serialize)]
pub struct DrivenVelocity {
    /// Its name.
    pub state: String,
    /// `∂v̇/∂v` of this velocity `v`, in 1/s.
    pub rate: f64,
}

pub(crate) fn driven_velocities(
    flow: &Flow,
    pairs: Option<&[(usize, usize)]>,
    subject: &Subject,
) -> Vec<DrivenVelocity> {
    let velocities = pairs.unwrap_or_default().iter().map(|(_, v)| *v);
    let of = |v: usize| {
        let (rate, error) = (flow.a[(v, v)], flow.a_errors[(v, v)]);
        (rate > 10.0 * error + 1e-9)
            .then(|| DrivenVelocity { state: subject.states[v].name.clone(), rate })
    };
    velocities.filter_map(of).collect()
}
