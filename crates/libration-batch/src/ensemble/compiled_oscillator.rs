//! Steps of oscillators by compiled kernels.

use core::ops::Range;

use bytemuck::Pod;
use libration_core::system::Oscillator;
use libration_core::{Integrator, Method, with_method};

use super::planes::{Planes, Share};
use super::{All, Execution, advance_share};
use crate::machine::MachineFloat;

/// Takes steps of `dt` seconds with every coordinate of an isotropic oscillator, as independent oscillators in one dimension. Returns
/// whether there are kernels for the method; if not, nothing has been done.
pub(super) fn advance<T: MachineFloat + Pod>(
    planes: &mut Planes<T>,
    oscillator: Oscillator<T>,
    method: Method,
    dt: T,
    steps: &Range<u64>,
    execution: &Execution,
) -> bool {
    // The one place where kernels of an ensemble are made for all methods.
    with_method!(method, |m| by_kernels(planes, oscillator, m, dt, steps, execution))
}

fn by_kernels<T: MachineFloat + Pod, M: Integrator>(
    planes: &mut Planes<T>,
    oscillator: Oscillator<T>,
    method: M,
    dt: T,
    steps: &Range<u64>,
    execution: &Execution,
) -> bool {
    // Kernels of published tables loop over coefficients, which takes 20 times as long as a program.
    if const { M::BASELINE_ONLY } {
        return false;
    }
    let mut positions: Vec<&mut [T]> = planes.planes_mut().collect();
    let velocities = positions.split_off(positions.len() / 2);
    for (q, v) in positions.into_iter().zip(velocities) {
        let share = Share::<T, 1> { first: 0, q: [q], v: [v] };
        advance_share(share, execution, method, All(oscillator), All(dt), steps);
    }
    true
}
