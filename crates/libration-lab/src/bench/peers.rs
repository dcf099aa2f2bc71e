//! What `benches/peers.py` measured: Libration beside programs that cannot run within it.

use std::path::Path;

use serde::Deserialize;

use crate::machine::Machine;

/// Version of the contract that the file keeps.
const SCHEMA: &str = "libration.peers/1";

/// Everything in the file.
#[derive(Clone, Debug, Deserialize, PartialEq)]
pub(crate) struct Peers {
    schema: String,
    /// The processor.
    cpu: String,
    /// Versions and threads, in words.
    pub(crate) versions: String,
    /// Rounds in which each had its turn.
    pub(crate) rounds: u64,
    /// Who was compared, and what came out.
    pub(crate) rows: Vec<Peer>,
}

/// Libration over a peer.
#[derive(Clone, Debug, Deserialize, PartialEq)]
pub(crate) struct Peer {
    pub(crate) implementation: String,
    pub(crate) peer: String,
    pub(crate) float: String,
    pub(crate) count: u64,
    /// The median of the ratios of the rounds.
    pub(crate) ratio: f64,
    /// Between which half of them lie.
    pub(crate) quartiles: [f64; 2],
    /// What is to be reached.
    pub(crate) wanted: f64,
    /// What the arithmetic of the machine would reach.
    pub(crate) most: f64,
}

impl Peers {
    /// Reads the file.
    ///
    /// # Errors
    /// If it is not there, is none of those, or is of another processor; in words.
    pub(crate) fn read(path: &Path) -> Result<Peers, String> {
        let name = path.display();
        let text = std::fs::read_to_string(path)
            .map_err(|error| format!("`{name}` cannot be read: {error}"))?;
        let peers: Peers = serde_json::from_str(&text)
            .map_err(|error| format!("`{name}` is not what benches/peers.py writes: {error}"))?;
        let here = Machine::detect().cpu;
        if peers.schema != SCHEMA {
            Err(format!("`{name}` has the schema `{}`; it must be `{SCHEMA}`", peers.schema))
        } else if peers.cpu != here {
            Err(format!("`{name}` was measured on `{}`; this is `{here}`", peers.cpu))
        } else {
            Ok(peers)
        }
    }
}
