//! A pendulum with the sine of the platform.

use libration::{State, System};

/// The pendulum with the sine of the platform's mathematics library: other bits on other machines,
/// and a call for each lane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlatformPendulum {
    pub(crate) omega2: f32,
}

impl System<f32, 1> for PlatformPendulum {
    const POSITIONAL: bool = true;

    #[inline(always)]
    fn acceleration(&self, state: &State<f32, 1>) -> [f32; 1] {
        state.q.map(|q| -self.omega2 * f32::sin(q))
    }
}
