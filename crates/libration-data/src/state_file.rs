//! State files: checkpoints with a note and a checksum.

use std::convert::Infallible;
use std::io::{BufWriter, IntoInnerError, Write};
use std::path::Path;

use libration::checkpoint::{Checkpoint, CheckpointError, ensure_same_traits};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::DataError;
use crate::bounded_read::read_regular;
use crate::checksum::{ChecksumWriter, checksum_at_once};
use crate::durable_file::{make, named, sync_folder};
use crate::regular_file::create_file;

/// The first bytes of a state file.
const MAGIC: &[u8; 8] = b"LIBRTNCP";

/// The header of a state file, as JSON.
#[derive(Deserialize, Serialize)]
struct Head {
    /// The version of the format.
    format: u64,
    /// The version of the program that wrote it. Another version may continue differently.
    version: String,
    /// The traits of the state.
    traits: Map<String, Value>,
    /// The note of the caller.
    note: Value,
    bytes: u64,
}

const FORMAT: u64 = 1;
/// The version of this program. Another version may continue differently.
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Bytes of the longest state file.
const LIMIT: u64 = 1 << 36;

/// Bytes of the checksum at the end, over all before it.
const SUM: usize = 64;

/// Bytes that are gathered before they are written.
const GATHERED: usize = 1 << 20;

/// What a state file survives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Durability {
    /// The death of its process. After a failure of the system the file may be damaged, which [`load_state`] finds.
    Process,
    /// Also a failure of the system: the disk is waited for.
    System,
}

/// Writes a state and a note to a file. The file is complete or absent after what `durability` says.
///
/// # Errors
/// If the system reports an error.
pub fn save_state(
    path: &Path,
    of: &impl Checkpoint,
    note: &Value,
    durability: Durability,
) -> Result<(), DataError> {
    let mut bytes = 0;
    let count = |piece: &[u8]| -> Result<(), Infallible> {
        bytes += piece.len() as u64;
        Ok(())
    };
    let Ok(()) = of.save(count);
    let text = |(name, value): (&'static str, String)| (name.to_owned(), Value::String(value));
    let head = Head {
        format: FORMAT,
        version: VERSION.to_owned(),
        traits: of.traits().into_iter().map(text).collect(),
        note: note.clone(),
        bytes,
    };
    let head =
        serde_json::to_vec(&head).map_err(|error| DataError::io("write", path)(error.into()))?;
    // Through the system's cache: who goes on from a state often does so soon.
    make(path, |part| {
        let mut file = BufWriter::with_capacity(GATHERED, ChecksumWriter::new(create_file(part)?));
        for piece in [&MAGIC[..], &(head.len() as u64).to_le_bytes(), &head] {
            file.write_all(piece)?;
        }
        of.save(|piece| file.write_all(piece))?;
        let file = file.into_inner().map_err(IntoInnerError::into_error)?;
        let sum = file.sum();
        let mut file = file.into_inner();
        file.write_all(sum.as_bytes())?;
        if durability == Durability::System { file.sync_data() } else { Ok(()) }
    })?;
    if durability == Durability::Process {
        return Ok(());
    }
    path.parent().map_or(Ok(()), |folder| sync_folder(named(folder)))
}

/// Restores a state from a file. Returns the note.
///
/// # Errors
/// If the file cannot be read, is of another version or damaged, or its state does not match. The object is then unchanged.
pub fn load_state(path: &Path, into: &mut impl Checkpoint) -> Result<Value, DataError> {
    let bytes = read_regular(path, LIMIT).map_err(DataError::io("read", path))?;
    let damaged = |what: &str| DataError::Damaged { path: path.to_owned(), what: what.to_owned() };
    if !bytes.starts_with(MAGIC) {
        return Err(damaged("it is not a state file"));
    }
    let whole = bytes.len().checked_sub(SUM).filter(|&len| len >= MAGIC.len() + 8);
    let (told, sum) = bytes.split_at(whole.ok_or_else(|| damaged("it is truncated"))?);
    if checksum_at_once(told).as_bytes() != sum {
        return Err(damaged("its checksum does not match: it was truncated or changed"));
    }
    let (len, rest) = told[MAGIC.len()..].split_first_chunk().unwrap_or((&[0; 8], &[]));
    let len = usize::try_from(u64::from_le_bytes(*len)).unwrap_or(usize::MAX);
    let (head, state) = rest.split_at_checked(len).ok_or_else(|| damaged("it is truncated"))?;
    let head: Head = serde_json::from_slice(head)
        .map_err(|error| damaged(&format!("its header cannot be read: {error}")))?;
    if head.format != FORMAT || head.version != VERSION {
        let what = format!(
            "version {} wrote it in format {}; this is version {VERSION}, which reads format {FORMAT} of the same version",
            head.version, head.format
        );
        return Err(damaged(&what));
    }
    let refused = |source: CheckpointError| DataError::State { path: path.to_owned(), source };
    let found = head.traits.iter();
    let found = found.map(|(name, value)| (name.as_str(), value.as_str().unwrap_or_default()));
    ensure_same_traits(found, &into.traits()).map_err(refused)?;
    into.restore(state).map_err(refused)?;
    Ok(head.note)
}
