//! The instruction sets that a kernel is compiled for.

use core::marker::PhantomData;

use pulp::{Simd, WithSimd};

/// An instruction set. The bits of a result do not depend on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum InstructionSet {
    /// The baseline of the architecture: SSE2 on x86-64, NEON on AArch64.
    Baseline,
    /// AVX2, 256 bits wide (x86-64-v3).
    Avx2,
    /// AVX-512, 512 bits wide (x86-64-v4).
    Avx512,
}

impl InstructionSet {
    /// All of them, by rising width.
    pub const ALL: [InstructionSet; 3] =
        [InstructionSet::Baseline, InstructionSet::Avx2, InstructionSet::Avx512];

    /// Name on the command line and in configurations.
    pub const fn name(self) -> &'static str {
        match self {
            InstructionSet::Baseline => "baseline",
            InstructionSet::Avx2 => "avx2",
            InstructionSet::Avx512 => "avx512",
        }
    }

    /// The instruction set of that name, if there is one.
    pub fn from_name(name: &str) -> Option<InstructionSet> {
        InstructionSet::ALL.into_iter().find(|set| set.name() == name)
    }

    /// Whether this processor has it.
    pub fn is_available(self) -> bool {
        match self {
            InstructionSet::Baseline => true,
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx2 => pulp::x86::V3::is_available(),
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx512 => pulp::x86::V4::is_available(),
            #[cfg(not(target_arch = "x86_64"))]
            InstructionSet::Avx2 | InstructionSet::Avx512 => false,
        }
    }

    /// Vector registers that it names.
    pub const fn registers(self) -> usize {
        match self {
            InstructionSet::Baseline => Baseline::REGISTERS,
            InstructionSet::Avx2 => 16,
            InstructionSet::Avx512 => 32,
        }
    }

    /// Bytes in one of them.
    pub const fn vector_bytes(self) -> usize {
        match self {
            InstructionSet::Baseline => Baseline::BYTES,
            InstructionSet::Avx2 => 32,
            InstructionSet::Avx512 => 64,
        }
    }

    /// The instruction sets of this processor, narrowest first.
    pub fn available() -> impl Iterator<Item = InstructionSet> {
        InstructionSet::ALL.into_iter().filter(|set| set.is_available())
    }

    /// The widest that this processor has.
    pub fn widest() -> InstructionSet {
        InstructionSet::available().last().unwrap_or(InstructionSet::Baseline)
    }
}

/// Work that gains from vector instructions, to be compiled for each instruction set.
///
/// [`InstructionSet::vectorize`] runs it. It must be `#[inline(always)]`, and all that it calls, or
/// the compiler may leave it outside the code that has the instructions.
pub trait Loop {
    /// The result.
    type Output;

    /// Does the work.
    fn run(self) -> Self::Output;

    /// Does it on vectors of so many bytes, a constant in the code of each instruction set.
    #[inline(always)]
    fn run_on(self, vector_bytes: usize) -> Self::Output
    where
        Self: Sized,
    {
        let _ = vector_bytes;
        self.run()
    }
}

/// A [`Loop`] and its instruction set, as `pulp` takes them.
struct Vectorized<L, I>(L, PhantomData<I>);

impl<L: Loop, I: Target> WithSimd for Vectorized<L, I> {
    type Output = L::Output;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> L::Output {
        self.0.run_on(I::BYTES)
    }
}

/// A [`Loop`] whose instruction set is known when the program runs.
struct Dispatched<L>(L);

impl<L: Loop> Targeted for Dispatched<L> {
    type Output = L::Output;

    fn on<I: Target>(self, target: I) -> L::Output {
        target.vectorize(self.0)
    }
}

/// An instruction set as a type, so that code compiled for it can depend on it.
pub(crate) trait Target: Copy + Send + Sync {
    /// Vector registers that the architecture names.
    const REGISTERS: usize;
    /// Bytes in one of them.
    const BYTES: usize;

    /// Runs `kernel`, compiled for this instruction set.
    fn run<K: WithSimd>(self, kernel: K) -> K::Output;

    /// Runs a loop, compiled for this instruction set.
    #[inline(always)]
    fn vectorize<L: Loop>(self, work: L) -> L::Output {
        self.run(Vectorized(work, PhantomData::<Self>))
    }
}

/// [`InstructionSet::Baseline`].
#[derive(Clone, Copy)]
pub(crate) struct Baseline;

impl Target for Baseline {
    const REGISTERS: usize = if cfg!(target_arch = "aarch64") { 32 } else { 16 };
    const BYTES: usize = 16;

    #[inline(always)]
    fn run<K: WithSimd>(self, kernel: K) -> K::Output {
        // A separate function, as on the other targets: if they were inlined, the kernels of all methods and systems
        // would be one function, and compile eight times as slowly.
        #[inline(never)]
        fn run_baseline<K: WithSimd>(kernel: K) -> K::Output {
            Simd::vectorize(pulp::Scalar::new(), kernel)
        }
        run_baseline(kernel)
    }
}

#[cfg(target_arch = "x86_64")]
impl Target for pulp::x86::V3 {
    const REGISTERS: usize = InstructionSet::Avx2.registers();
    const BYTES: usize = InstructionSet::Avx2.vector_bytes();

    #[inline(always)]
    fn run<K: WithSimd>(self, kernel: K) -> K::Output {
        Simd::vectorize(self, kernel)
    }
}

#[cfg(target_arch = "x86_64")]
impl Target for pulp::x86::V4 {
    const REGISTERS: usize = InstructionSet::Avx512.registers();
    const BYTES: usize = InstructionSet::Avx512.vector_bytes();

    #[inline(always)]
    fn run<K: WithSimd>(self, kernel: K) -> K::Output {
        Simd::vectorize(self, kernel)
    }
}

/// Work that is compiled for each instruction set, to be run on one of them.
pub(crate) trait Targeted {
    /// Whether it is compiled for the baseline alone.
    const BASELINE_ONLY: bool = false;

    /// The result.
    type Output;

    /// Runs on `target`.
    fn on<I: Target>(self, target: I) -> Self::Output;
}

impl InstructionSet {
    /// Runs a loop of the caller, compiled for this instruction set, or for the baseline where the
    /// processor lacks it.
    pub fn vectorize<L: Loop>(self, work: L) -> L::Output {
        self.run(Dispatched(work))
    }

    /// Runs `work` on this instruction set, or on the baseline where the processor lacks it or the work is compiled for no
    /// other.
    pub(crate) fn run<K: Targeted>(self, work: K) -> K::Output {
        if const { K::BASELINE_ONLY } {
            return work.on(Baseline);
        }
        match self {
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx512 if let Some(target) = pulp::x86::V4::try_new() => {
                work.on(target)
            }
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx2 if let Some(target) = pulp::x86::V3::try_new() => work.on(target),
            _ => work.on(Baseline),
        }
    }
}
