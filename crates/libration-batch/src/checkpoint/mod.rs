//! Checkpoints: complete states as bytes, from which a run continues bit for bit.
//!
//! Ensembles, loops, environments and replay buffers provide their properties ([`Checkpoint::traits`]) and their state, to the last
//! bit. A run may continue with other threads and instructions. The caller stores the bytes.

mod error;
mod reader;

use core::convert::Infallible;

pub use error::CheckpointError;
pub(crate) use reader::Reader;

/// An object whose state can be saved and restored.
pub trait Checkpoint {
    /// The properties that must agree when the state is restored, by name: the kind, the float type, the numbers of things. Code
    /// (a system, a policy, a task) is not compared.
    fn traits(&self) -> Vec<Trait>;

    /// Passes all bytes of the state to `sink`, piece by piece.
    ///
    /// # Errors
    /// The error of `sink`.
    fn save<E>(&self, sink: impl FnMut(&[u8]) -> Result<(), E>) -> Result<(), E>
    where
        Self: Sized;

    /// All bytes of the state in one piece.
    fn to_bytes(&self) -> Vec<u8>
    where
        Self: Sized,
    {
        let mut bytes = Vec::new();
        let piece = |piece: &[u8]| -> Result<(), Infallible> {
            bytes.extend_from_slice(piece);
            Ok(())
        };
        match self.save(piece) {
            Ok(()) => bytes,
            Err(never) => match never {},
        }
    }

    /// Restores a state with the same traits.
    ///
    /// # Errors
    /// If the length is wrong or the state is inconsistent. The object is then unchanged.
    fn restore(&mut self, state: &[u8]) -> Result<(), CheckpointError>;
}

/// The name and the value of a property.
pub type Trait = (&'static str, String);

/// Compares the traits of a state with the required ones.
///
/// # Errors
/// The first trait that differs.
pub fn ensure_same_traits<'a>(
    found: impl IntoIterator<Item = (&'a str, &'a str)> + Clone,
    wanted: &[Trait],
) -> Result<(), CheckpointError> {
    for (name, wanted) in wanted {
        let value = found.clone().into_iter().find(|(other, _)| other == name);
        let value = value.map_or("missing", |(_, value)| value);
        if value != wanted {
            let (found, wanted) = (value.to_owned(), wanted.clone());
            return Err(CheckpointError::Other { name, found, wanted });
        }
    }
    Ok(())
}
