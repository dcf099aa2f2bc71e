//! A simulation with array operations: one operation per pass over the memory.

use libration::Float;
use libration::ensemble::{Buffer, EnsembleError, InstructionSet, Loop, Pages};

use super::Bench;
use super::rung::{Rung, doubles};

/// An operation on whole arrays, as one pass over the memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Traffic {
    /// `out = s·a`: reads one array, writes one.
    Scale,
    /// `out = a + b`: reads two, writes one.
    Add,
}

impl Traffic {
    /// Arrays that are read or written.
    pub(crate) const fn arrays(self) -> usize {
        match self {
            Traffic::Scale => 2,
            Traffic::Add => 3,
        }
    }
}

/// The passes of one step: `a = −ω²x`, `d = Δt·a`, `v += d`, `d = Δt·v`, `x += d`.
pub(crate) const PASSES: [Traffic; 5] =
    [Traffic::Scale, Traffic::Scale, Traffic::Add, Traffic::Scale, Traffic::Add];

/// Arrays of positions and velocities.
pub(super) struct Passes<T> {
    x: Array<T>,
    v: Array<T>,
    /// Room for a result; none if each is to have a new array.
    scratch: Option<Array<T>>,
    stiffness: T,
    dt: T,
    set: InstructionSet,
}

/// An array: memory of its own for the length of the run, or from the allocator.
enum Array<T> {
    Kept(Buffer<T>),
    Fresh(Vec<T>),
}

impl<T: Bench> Array<T> {
    fn slice(&self) -> &[T] {
        match self {
            Array::Kept(buffer) => buffer,
            Array::Fresh(vec) => vec,
        }
    }

    fn slice_mut(&mut self) -> &mut [T] {
        match self {
            Array::Kept(buffer) => buffer,
            Array::Fresh(vec) => vec,
        }
    }
}

impl<T: Bench> Passes<T> {
    /// `stiffness` is `−ω²`; results go to arrays that are there already if `reuse`.
    ///
    /// # Errors
    /// If the memory is refused.
    pub(super) fn new(
        count: usize,
        start: impl Fn(usize) -> [T; 2],
        stiffness: T,
        dt: T,
        set: InstructionSet,
        reuse: bool,
    ) -> Result<Self, EnsembleError> {
        let zeros = || Buffer::<T>::new(count, Pages::Huge);
        let (mut x, mut v) = (zeros()?, zeros()?);
        for n in 0..count {
            [x[n], v[n]] = start(n);
        }
        let scratch = if reuse { Some(Array::Kept(zeros()?)) } else { None };
        Ok(Passes { x: Array::Kept(x), v: Array::Kept(v), scratch, stiffness, dt, set })
    }

    /// A step that makes a new array of each result, as `v = v + dt * (-w2 * x)` does.
    fn with_temporaries(&mut self) {
        let set = self.set;
        let scaled = |s: T, a: &[T]| set.vectorize(Scaled { s, a });
        let sum = |a: &[T], b: &[T]| Array::Fresh(set.vectorize(Sum { a, b }));
        let a = scaled(self.stiffness, self.x.slice());
        self.v = sum(self.v.slice(), &scaled(self.dt, &a));
        self.x = sum(self.x.slice(), &scaled(self.dt, self.v.slice()));
    }
}

/// A step whose results go to `scratch`, or to where they belong.
fn in_place<T: Float>(arrays: [&mut [T]; 3], stiffness: T, dt: T, set: InstructionSet) {
    let [x, v, scratch] = arrays;
    set.vectorize(Scale { s: stiffness, a: &*x, out: &mut *scratch });
    set.vectorize(Rescale { s: dt, out: &mut *scratch });
    set.vectorize(Increase { a: &*scratch, out: &mut *v });
    set.vectorize(Scale { s: dt, a: &*v, out: &mut *scratch });
    set.vectorize(Increase { a: &*scratch, out: &mut *x });
}

impl<T: Bench> Rung for Passes<T> {
    fn advance(&mut self, steps: u64) {
        for _ in 0..steps {
            match &mut self.scratch {
                Some(scratch) => {
                    let arrays = [self.x.slice_mut(), self.v.slice_mut(), scratch.slice_mut()];
                    in_place(arrays, self.stiffness, self.dt, self.set);
                }
                None => self.with_temporaries(),
            }
        }
    }

    fn state(&self, n: usize) -> [f64; 2] {
        doubles(self.x.slice()[n], self.v.slice()[n])
    }
}

/// `out = s·a`.
struct Scale<'a, T> {
    s: T,
    a: &'a [T],
    out: &'a mut [T],
}

impl<T: Float> Loop for Scale<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        for (out, &a) in self.out.iter_mut().zip(self.a) {
            *out = self.s * a;
        }
    }
}

/// `out = s·out`.
struct Rescale<'a, T> {
    s: T,
    out: &'a mut [T],
}

impl<T: Float> Loop for Rescale<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        for out in self.out {
            *out = self.s * *out;
        }
    }
}

/// `s·a`, in a new array.
struct Scaled<'a, T> {
    s: T,
    a: &'a [T],
}

impl<T: Float> Loop for Scaled<'_, T> {
    type Output = Vec<T>;

    #[inline(always)]
    fn run(self) -> Vec<T> {
        self.a.iter().map(|&a| self.s * a).collect()
    }
}

/// `a + b`, in a new array.
struct Sum<'a, T> {
    a: &'a [T],
    b: &'a [T],
}

impl<T: Float> Loop for Sum<'_, T> {
    type Output = Vec<T>;

    #[inline(always)]
    fn run(self) -> Vec<T> {
        self.a.iter().zip(self.b).map(|(&a, &b)| a + b).collect()
    }
}

/// `out = out + a`.
struct Increase<'a, T> {
    a: &'a [T],
    out: &'a mut [T],
}

impl<T: Float> Loop for Increase<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        for (out, &a) in self.out.iter_mut().zip(self.a) {
            *out = *out + a;
        }
    }
}
