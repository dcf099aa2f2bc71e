//! Seven implementations of one simulation.

use serde::{Serialize, Serializer};

/// A way to write a simulation of many oscillators, from the one that first comes to mind to the one
/// that is fastest. All of them give the same bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Implementation {
    /// Each trajectory by itself, each step through a function that is known at run time alone.
    Dynamic,
    /// Each trajectory by itself, each step in line.
    Scalar,
    /// One operation at a time on whole arrays, each result in a new array.
    Temporaries,
    /// One operation at a time on whole arrays, results in arrays that are there already.
    InPlace,
    /// One step at a time on blocks of trajectories.
    OneStep,
    /// All steps at once on a block of trajectories, then on the next block.
    Fused,
    /// As `Fused`, with trajectories divided among threads.
    Threads,
}

impl Implementation {
    /// All implementations, from the slowest to the fastest.
    pub const ALL: [Implementation; 7] = [
        Implementation::Dynamic,
        Implementation::Scalar,
        Implementation::Temporaries,
        Implementation::InPlace,
        Implementation::OneStep,
        Implementation::Fused,
        Implementation::Threads,
    ];

    /// Name on the command line, in configurations and in identifiers.
    pub const fn name(self) -> &'static str {
        match self {
            Implementation::Dynamic => "dynamic",
            Implementation::Scalar => "scalar",
            Implementation::Temporaries => "temporaries",
            Implementation::InPlace => "in-place",
            Implementation::OneStep => "one-step",
            Implementation::Fused => "fused",
            Implementation::Threads => "threads",
        }
    }

    /// The implementation of that name, if there is one.
    pub fn from_name(name: &str) -> Option<Implementation> {
        Implementation::ALL.into_iter().find(|one| one.name() == name)
    }

    /// Name on the page.
    pub const fn title(self) -> &'static str {
        match self {
            Implementation::Dynamic => "dynamic dispatch",
            Implementation::Scalar => "scalar loop",
            Implementation::Temporaries => "arrays, temporaries",
            Implementation::InPlace => "arrays, in place",
            Implementation::OneStep => "one step a pass",
            Implementation::Fused => "fused steps",
            Implementation::Threads => "fused, threads",
        }
    }

    /// Returns a description.
    pub const fn summary(self) -> &'static str {
        match self {
            Implementation::Dynamic => "each trajectory alone, each step through a virtual call",
            Implementation::Scalar => "each trajectory alone, step after step",
            Implementation::Temporaries => {
                "one operation at a time on arrays, a new array for each"
            }
            Implementation::InPlace => "one operation at a time on arrays that are reused",
            Implementation::OneStep => "all operations of a step in one pass over the memory",
            Implementation::Fused => {
                "all steps of a block of trajectories while it is in registers"
            }
            Implementation::Threads => "the same on all cores, each with its own trajectories",
        }
    }

    /// Whether it takes many steps with a block of trajectories before the next block.
    pub const fn is_fused(self) -> bool {
        matches!(self, Implementation::Fused | Implementation::Threads)
    }

    /// Whether it takes the trajectories one by one, at a rate that does not depend on their number.
    pub const fn is_lone(self) -> bool {
        matches!(self, Implementation::Dynamic | Implementation::Scalar)
    }
}

impl Serialize for Implementation {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}
