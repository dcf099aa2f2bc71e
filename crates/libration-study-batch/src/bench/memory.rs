//! Loops that only move memory.

use libration::Float;
use libration::ensemble::Loop;

/// `a = b + s·c` (J. D. McCalpin's triad, of the STREAM benchmark): three planes.
pub(crate) struct Triad<'a, T> {
    pub(crate) a: &'a mut [T],
    pub(crate) b: &'a [T],
    pub(crate) c: &'a [T],
    pub(crate) s: T,
}

impl<T: Float> Loop for Triad<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        for ((a, &b), &c) in self.a.iter_mut().zip(self.b).zip(self.c) {
            *a = b + self.s * c;
        }
    }
}

/// `y += s·x`, then `x += t·y`: reads and writes two planes, as one step of an oscillator must.
pub(crate) struct Update<'a, T> {
    pub(crate) x: &'a mut [T],
    pub(crate) y: &'a mut [T],
    pub(crate) s: T,
    pub(crate) t: T,
}

impl<T: Float> Loop for Update<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        for (x, y) in self.x.iter_mut().zip(self.y) {
            *y = *y + self.s * *x;
            *x = *x + self.t * *y;
        }
    }
}
