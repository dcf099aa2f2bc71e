//! The steps of a block of trajectories: the scalar step in a loop over lanes.

use core::marker::PhantomData;

use libration_core::array::{each, rows};
use libration_core::{Float, Integrator, Scalar, State, System};
use pulp::{Simd, WithSimd};

use super::assign::Assign;
use super::planes::Share;

/// Takes `steps` steps with all trajectories of a block, which stays in registers where it fits.
///
/// A named struct rather than a closure: a closure is called through a shim that the compiler may
/// leave outside the vector code, which silently loses the vectors.
pub(super) struct Advance<
    'b,
    'a,
    T,
    M,
    A: Assign<Sys>,
    C: Assign<T>,
    Sys,
    const D: usize,
    const W: usize,
> {
    pub(super) block: &'b mut Share<'a, T, D>,
    pub(super) method: M,
    pub(super) systems: A::Lanes<W>,
    pub(super) dt: C::Lanes<W>,
    pub(super) steps: u64,
}

impl<T, M, A, C, Sys, const D: usize, const W: usize> WithSimd
    for Advance<'_, '_, T, M, A, C, Sys, D, W>
where
    T: Float,
    M: Integrator,
    A: Assign<Sys>,
    C: Assign<T>,
    Sys: System<T, D>,
{
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Advance { block, method, systems, dt, steps } = self;
        let (q, v) = block.load::<W>();
        let (q, v) = advanced::<T, M, A, C, Sys, D, W>(method, &systems, &dt, (q, v), steps);
        block.store(&q, &v);
    }
}

/// [`Advance`] for one block after the other, all of them full.
///
/// What [`Advance`] does between two blocks takes as long as a step: with few steps it is this that
/// keeps the memory busy.
pub(super) struct Pass<'a, T, M, A, C, Sys, const D: usize, const W: usize> {
    pub(super) share: Share<'a, T, D>,
    pub(super) method: M,
    pub(super) systems: A,
    pub(super) dt: C,
    pub(super) steps: u64,
    pub(super) system: PhantomData<Sys>,
}

impl<T, M, A, C, Sys, const D: usize, const W: usize> WithSimd for Pass<'_, T, M, A, C, Sys, D, W>
where
    T: Float,
    M: Integrator,
    A: Assign<Sys>,
    C: Assign<T>,
    Sys: System<T, D>,
{
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Pass { share, method, systems, dt, steps, .. } = self;
        let first = share.first;
        let count = share.len() / W;
        let (q, v) = share.full_blocks::<W>();
        for b in 0..count {
            let systems = systems.lanes::<W>(first + b * W, W);
            let dt = dt.lanes::<W>(first + b * W, W);
            let block = (rows(|i| q[i][b]), rows(|i| v[i][b]));
            let (next_q, next_v) =
                advanced::<T, M, A, C, Sys, D, W>(method, &systems, &dt, block, steps);
            for i in 0..D {
                q[i][b] = next_q[i];
                v[i][b] = next_v[i];
            }
        }
    }
}

/// The planes of positions and velocities of a block.
type Block<T, const D: usize, const W: usize> = ([[T; W]; D], [[T; W]; D]);

/// Advances a block by a number of steps: the only loop over lanes.
#[inline(always)]
fn advanced<T, M, A, C, Sys, const D: usize, const W: usize>(
    method: M,
    systems: &A::Lanes<W>,
    dt: &C::Lanes<W>,
    (q, v): Block<T, D, W>,
    steps: u64,
) -> Block<T, D, W>
where
    T: Float,
    M: Integrator,
    A: Assign<Sys>,
    C: Assign<T>,
    Sys: System<T, D>,
{
    let carries = const { M::CARRIES && Sys::POSITIONAL };
    // Locals of a fixed size: what the compiler can keep in registers.
    let (mut q, mut v) = (Lines(q), Lines(v));
    let mut a = Lines([[T::zero(); W]; D]);
    if carries {
        for l in 0..W {
            let state = State { q: at(&q.0, l), v: at(&v.0, l) };
            put(&mut a.0, l, A::lane(systems, l).acceleration(&state));
        }
    }
    for _ in 0..steps {
        for l in 0..W {
            let (system, dt) = (A::lane(systems, l), C::lane(dt, l));
            let state = State { q: at(&q.0, l), v: at(&v.0, l) };
            let state = if carries {
                let (state, acceleration) = method.carried(&system, state, at(&a.0, l), dt);
                put(&mut a.0, l, acceleration);
                state
            } else {
                method.step(&system, state, dt)
            };
            put(&mut q.0, l, state.q);
            put(&mut v.0, l, state.v);
        }
    }
    (q.0, v.0)
}

/// Planes that begin with a cache line: no vector that is kept in memory lies across two.
#[repr(align(64))]
pub(crate) struct Lines<P>(pub(crate) P);

/// Lane `l` of each plane.
#[inline(always)]
pub(crate) fn at<T: Scalar, const D: usize, const W: usize>(
    planes: &[[T; W]; D],
    l: usize,
) -> [T; D] {
    each(|i| planes[i][l])
}

/// Sets lane `l` of each plane.
#[inline(always)]
pub(crate) fn put<T: Copy, const D: usize, const W: usize>(
    planes: &mut [[T; W]; D],
    l: usize,
    values: [T; D],
) {
    for i in 0..D {
        planes[i][l] = values[i];
    }
}
