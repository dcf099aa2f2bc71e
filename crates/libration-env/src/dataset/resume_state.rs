//! The state of an unfinished data set, from which a run with `resume` continues.

use std::fs;
use std::path::Path;

use libration::checkpoint::{Checkpoint, CheckpointError, Trait};
use libration_data::{DataError, Durability, checksum, load_state, save_state};
use serde_json::{Map, Value, json};

/// The file of the state in the folder of a data set. A finished data set has none.
pub(super) const NAME: &str = "resume.state";

/// The state of a group of environments after a chunk.
pub(super) struct ResumeState {
    /// The checksum of the first line of the manifest.
    settings: String,
    /// The number of the group.
    pub(super) group: usize,
    /// The number of chunks before the state.
    pub(super) chunks: u64,
    bytes: Vec<u8>,
}

impl ResumeState {
    /// The state `bytes` after `chunks` chunks of a group; `head` is the first line of the manifest.
    pub(super) fn new(
        head: &Map<String, Value>,
        group: usize,
        chunks: u64,
        bytes: Vec<u8>,
    ) -> Self {
        let head = Value::Object(head.clone()).to_string();
        ResumeState { settings: checksum([head.as_bytes()]), group, chunks, bytes }
    }

    /// Writes the state in place of an older one.
    ///
    /// # Errors
    /// If the system reports an error.
    pub(super) fn save(&self, folder: &Path) -> Result<(), DataError> {
        let note = json!({ "group": self.group, "chunks": self.chunks });
        // Without a wait for the disk: a state that a failure of the system damages is recognised by its checksum.
        save_state(&folder.join(NAME), self, &note, Durability::Process)
    }

    /// Reads the state in a folder. None if there is none that is whole, of this version and of these settings: what cannot be
    /// trusted is computed again.
    pub(super) fn load(folder: &Path, head: &Map<String, Value>) -> Option<Self> {
        let path = folder.join(NAME);
        // To open a named pipe waits for its writer, and a device may have no end.
        fs::symlink_metadata(&path).ok().filter(fs::Metadata::is_file)?;
        let mut state = ResumeState::new(head, 0, 0, Vec::new());
        let note = load_state(&path, &mut state).ok()?;
        state.group = usize::try_from(note["group"].as_u64()?).ok()?;
        state.chunks = note["chunks"].as_u64()?;
        Some(state)
    }

    /// Removes the state in a folder, if there is one.
    ///
    /// # Errors
    /// If the system reports an error.
    pub(super) fn remove(folder: &Path) -> Result<(), DataError> {
        let path = folder.join(NAME);
        match fs::remove_file(&path) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                Err(DataError::io("remove", &path)(error))
            }
            _ => Ok(()),
        }
    }

    /// The state of the environments and of what belongs to them.
    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes
    }
}

impl Checkpoint for ResumeState {
    fn traits(&self) -> Vec<Trait> {
        vec![("kind", "data set".to_owned()), ("settings", self.settings.clone())]
    }

    fn save<E>(&self, mut sink: impl FnMut(&[u8]) -> Result<(), E>) -> Result<(), E> {
        sink(&self.bytes)
    }

    fn restore(&mut self, state: &[u8]) -> Result<(), CheckpointError> {
        self.bytes = state.to_vec();
        Ok(())
    }
}
