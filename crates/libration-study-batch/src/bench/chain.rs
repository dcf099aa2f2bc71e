//! The latency of arithmetic: chains of dependent operations.

use std::hint::black_box;

use libration::Float;

/// The operation of a chain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Link {
    /// A multiplication.
    Product,
    /// An addition.
    Sum,
    /// A multiplication and an addition.
    ProductAndSum,
}

/// A chain of dependent operations.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Chain(pub(crate) Link);

/// Links that are passed between two looks at the counter.
pub(crate) const CHAIN_LINKS: u64 = 16;

impl Chain {
    /// Passes `CHAIN_LINKS · rounds` links; what comes out is of no use, but must not be lost.
    pub(crate) fn run<T: Float>(self, rounds: u64) -> T {
        let (factor, term) = (black_box(T::one()), black_box(T::zero()));
        let mut x = black_box(T::one());
        for _ in 0..rounds {
            for _ in 0..CHAIN_LINKS {
                x = match self.0 {
                    Link::Product => x * factor,
                    Link::Sum => x + term,
                    Link::ProductAndSum => x * factor + term,
                };
            }
        }
        x
    }
}
