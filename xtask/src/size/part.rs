//! A crate, or the Python package.

use std::collections::BTreeSet;

/// The size of a crate, or of the Python package.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Part {
    pub(super) name: String,
    /// Lines of its sources, with those of tests in them.
    pub(super) lines: usize,
    /// Names of the public types and traits.
    pub(super) types: BTreeSet<String>,
    /// Its part of the release program; none if it is no library of it.
    pub(super) compiled: Option<Compiled>,
}

/// The code of a library: generic functions belong to the crate that needs them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Compiled {
    pub(super) functions: usize,
    /// Those of them that are batch kernels.
    pub(super) kernels: usize,
    pub(super) bytes: usize,
}

impl Compiled {
    pub(super) fn plus(self, other: Compiled) -> Compiled {
        Compiled {
            functions: self.functions + other.functions,
            kernels: self.kernels + other.kernels,
            bytes: self.bytes + other.bytes,
        }
    }
}
