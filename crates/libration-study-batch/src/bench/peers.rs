//! Results of the programs in `benches/`: Libration compared with other programs.

use std::path::Path;

use libration_settings::Fault;
use libration_study::Machine;
use serde::Deserialize;
use serde::de::DeserializeOwned;

/// A ratio of such a file, and which file it is of.
pub(crate) trait PeerRow: DeserializeOwned {
    /// Version of the contract that the file keeps.
    const SCHEMA: &str;
    /// The program that writes it.
    const PROGRAM: &str;
}

/// Everything in the file.
#[derive(Clone, Debug, Deserialize, PartialEq)]
pub(crate) struct Peers<R> {
    schema: String,
    /// The processor.
    cpu: String,
    /// Versions and threads, in words.
    pub(crate) versions: String,
    /// Rounds in which each had its turn.
    pub(crate) rounds: u64,
    /// Who was compared, and what came out.
    pub(crate) rows: Vec<R>,
    /// Rates of rollouts, of Libration and of its peers.
    #[serde(default = "Vec::new")]
    pub(crate) rates: Vec<PeerRate>,
}

/// Libration over a peer, in steps a second.
#[derive(Clone, Debug, Deserialize, PartialEq)]
pub(crate) struct Peer {
    pub(crate) implementation: String,
    pub(crate) peer: String,
    pub(crate) dtype: String,
    pub(crate) count: u64,
    /// The median of the ratios of the rounds.
    pub(crate) ratio: f64,
    /// Between which half of them lie.
    pub(crate) quartiles: [f64; 2],
    /// Least ratio.
    pub(crate) wanted: f64,
    /// Limit by the arithmetic of the machine.
    pub(crate) most: f64,
}

impl PeerRow for Peer {
    const SCHEMA: &str = "libration.peers/2";
    const PROGRAM: &str = "benches/peers.py";
}

/// Libration over a peer, in transitions of rollouts a second.
#[derive(Clone, Debug, Deserialize, PartialEq)]
pub(crate) struct RolloutPeer {
    pub(crate) peer: String,
    pub(crate) task: String,
    pub(crate) num_envs: u64,
    /// None where it makes no difference.
    pub(crate) horizon: Option<u64>,
    /// Threads of Libration.
    pub(crate) threads: u64,
    /// The median of the ratios of the rounds.
    pub(crate) ratio: f64,
    /// Between which half of them lie.
    pub(crate) quartiles: [f64; 2],
    /// Least ratio.
    pub(crate) wanted: f64,
}

impl PeerRow for RolloutPeer {
    const SCHEMA: &str = "libration.rollouts/2";
    const PROGRAM: &str = "benches/rollouts.py";
}

/// Libration over a peer, in batches or rows a second.
#[derive(Clone, Debug, Deserialize, PartialEq)]
pub(crate) struct StoragePeer {
    pub(crate) peer: String,
    /// Description of the work.
    pub(crate) what: String,
    /// Threads of Libration, and of the peer.
    pub(crate) threads: [u64; 2],
    /// The median of the ratios of the rounds.
    pub(crate) ratio: f64,
    /// Between which half of them lie.
    pub(crate) quartiles: [f64; 2],
    /// Least ratio.
    pub(crate) wanted: f64,
}

impl PeerRow for StoragePeer {
    const SCHEMA: &str = "libration.storage/1";
    const PROGRAM: &str = "benches/storage.py";
}

/// Rate of a rollout.
#[derive(Clone, Debug, Deserialize, PartialEq)]
pub(crate) struct PeerRate {
    pub(crate) num_envs: u64,
    pub(crate) horizon: Option<u64>,
    /// Name of the program.
    pub(crate) name: String,
    pub(crate) transitions_per_second: f64,
}

impl<R: PeerRow> Peers<R> {
    /// Reads the file.
    ///
    /// # Errors
    /// If it is not there, is none of those, or is of another processor; in words.
    pub(crate) fn read(path: &Path) -> Result<Self, String> {
        let name = path.display();
        let text = libration_settings::read_text(path)
            .map_err(|error| format!("`{name}` cannot be read: {error}"))?;
        let not = |error| format!("`{name}` is not what {} writes: {error}", R::PROGRAM);
        let peers: Self = serde_json::from_str(&text).map_err(not)?;
        let here = Machine::detect().cpu;
        if peers.schema != R::SCHEMA {
            Err(format!("`{name}` has the schema `{}`; it must be `{}`", peers.schema, R::SCHEMA))
        } else if peers.cpu != here {
            Err(format!("`{name}` was measured on `{}`; this is `{here}`", peers.cpu))
        } else {
            Ok(peers)
        }
    }
}

impl Peers<RolloutPeer> {
    /// The best rate of a peer in so many environments and steps, in transitions a second.
    pub(crate) fn best(&self, name: &str, environments: u64, horizon: u64) -> Option<f64> {
        let size = (environments, Some(horizon));
        let own = self.rates.iter().filter(|r| r.name == name && (r.num_envs, r.horizon) == size);
        own.map(|rate| rate.transitions_per_second).max_by(f64::total_cmp)
    }
}

/// Checks a file of peers before any work.
///
/// # Errors
/// A [`Fault`] at `key`.
pub(crate) fn check_peers<R: PeerRow>(key: &'static str, path: Option<&Path>) -> Result<(), Fault> {
    match path.map(Peers::<R>::read) {
        Some(Err(message)) => Err(Fault::new(key, message)),
        _ => Ok(()),
    }
}
