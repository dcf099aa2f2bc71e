//! Sizes of blocks and tiles of environments.

/// Environments of a block. A flag of each is a byte, and that many fill a line of the cache.
pub(super) const LANES: usize = 64;

/// Environments that go through the horizon together: their rows are long enough to be written at the speed of the memory, and
/// their states stay in the first cache.
pub(super) const TILE: usize = 8 * LANES;
