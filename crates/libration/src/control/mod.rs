//! Systems under control: clocks that are not exact, and commands that arrive late.

mod clock;
mod control_loop;

pub use clock::{Clock, Fixed, Jittered, Skewed};
pub use control_loop::{ControlLoop, Waiting};
