//! Steps of oscillators by compiled kernels.

use core::ops::Range;

use bytemuck::Pod;
use libration_core::system::Oscillator;
use libration_core::{Integrator, Method, with_method};

use super::planes::Planes;
use super::{All, Execution, advance_share};
use crate::machine::MachineFloat;

/// Takes steps of `dt` seconds with every coordinate of an isotropic oscillator, as independent oscillators in one dimension; beside the
/// planes is its number of dimensions. Returns whether there are kernels for the method; if not, nothing has been done.
pub(super) fn advance<T: MachineFloat + Pod>(
    planes: (&mut Planes<T>, usize),
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
    (planes, dimension): (&mut Planes<T>, usize),
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
    for i in 0..dimension {
        let share = planes.coordinate(i, dimension);
        advance_share(share, execution, method, All(oscillator), All(dt), steps);
    }
    true
}
