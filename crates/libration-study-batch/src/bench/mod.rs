//! Measurement of speed: a stopwatch, loops that are bound by one thing alone, and the
//! same simulation written in seven ways.

mod arithmetic;
mod chain;
mod faults;
mod float;
mod implementation;
mod memory;
mod oscillators;
mod passes;
mod peers;
mod platform;
mod rollouts;
mod rung;
mod stopwatch;
mod storage;
mod task;

pub(crate) use arithmetic::{Mix, VECTORS};
pub(crate) use chain::{CHAIN_LINKS, Chain, Link};
pub(crate) use faults::{PAGE, count_faults};
pub(crate) use float::with_float;
pub use float::{Bench, BenchFloat};
pub use implementation::Implementation;
pub(crate) use memory::{Triad, Update};
pub(crate) use oscillators::{oscillators, stepping};
pub(crate) use passes::{PASSES, Traffic};
pub(crate) use peers::{Peer, Peers, RolloutPeer, StoragePeer, check_peers};
pub(crate) use platform::PlatformPendulum;
pub(crate) use rollouts::{FEEDBACK, fill, regulating, regulating_from, rollout, suited};
pub use rollouts::{RolloutCase, RolloutRate, RolloutTask, rollouts};
pub(crate) use rung::prepare;
pub(crate) use stopwatch::{Contestant, Rates, Turns, race};
pub use storage::{StorageRate, Stored, storage};
pub(crate) use task::Task;
