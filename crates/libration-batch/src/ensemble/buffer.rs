//! Memory for many numbers.

use core::marker::PhantomData;
use core::ops::{Deref, DerefMut};

use bytemuck::Pod;
use memmap2::MmapMut;

use super::{EnsembleError, InsufficientMemory};

/// From so many bytes on huge pages are asked for: below, the last one would be half empty.
const HUGE: usize = 4 << 20;

/// From so many bytes on it is asked first whether there is room: what is never touched would be given
/// without a question, and what is touched then kills the process.
const ASKED: u128 = 64 << 20;

/// The pages that memory is to be made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pages {
    /// The default pages of the system, 4 KiB on most.
    Ordinary,
    /// Huge ones where the system has them and the buffer is large: a wish, since without them all is
    /// the same, but slower.
    #[default]
    Huge,
}

/// Numbers in separate memory that begins on a page.
///
/// They are zero at first, and nobody has touched them: a page comes to be where it is first
/// written, by the thread that writes it. An allocation that is aligned *and* zeroed would be written
/// by the thread that asks.
#[derive(Debug)]
pub struct Buffer<T> {
    memory: MmapMut,
    len: usize,
    number: PhantomData<T>,
}

impl<T: Pod> Buffer<T> {
    /// `len` zeros.
    ///
    /// # Errors
    /// [`EnsembleError::Memory`] if there is not so much, or the system refuses it.
    pub fn new(len: usize, pages: Pages) -> Result<Self, EnsembleError> {
        let bytes = len as u128 * size_of::<T>() as u128;
        if bytes >= ASKED {
            InsufficientMemory::check(bytes)?;
        }
        let refused = || InsufficientMemory { needed: bytes, available: None };
        let size = usize::try_from(bytes).ok().filter(|&size| size < isize::MAX as usize);
        let memory = MmapMut::map_anon(size.ok_or_else(refused)?).map_err(|_| refused())?;
        #[cfg(target_os = "linux")]
        if pages == Pages::Huge && memory.len() >= HUGE {
            // The wish may be refused.
            let _ = memory.advise(memmap2::Advice::HugePage);
        }
        #[cfg(not(target_os = "linux"))]
        let _ = (pages, HUGE);
        Ok(Buffer { memory, len, number: PhantomData })
    }

    /// The memory itself.
    pub fn into_map(self) -> MmapMut {
        self.memory
    }
}

impl<T: Pod> Deref for Buffer<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        &bytemuck::cast_slice(&self.memory)[..self.len]
    }
}

impl<T: Pod> DerefMut for Buffer<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        &mut bytemuck::cast_slice_mut(&mut self.memory)[..self.len]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_buffer_holds_zeros_and_then_what_was_written() {
        for len in [0, 1, 1000, 2_000_000] {
            let mut buffer = Buffer::<f32>::new(len, Pages::Huge).expect("a few megabytes");
            assert_eq!(buffer.len(), len);
            assert!(buffer.iter().all(|&x| x == 0.0));
            buffer.fill(1.5);
            assert!(buffer.iter().all(|&x| x == 1.5));
        }
    }

    #[test]
    fn more_than_there_is_is_refused_and_says_how_much() {
        let refused = Buffer::<f64>::new(usize::MAX / 2, Pages::Ordinary).map(drop);
        let needed = (usize::MAX / 2) as u128 * 8;
        assert!(
            matches!(refused, Err(EnsembleError::Memory(no)) if no.needed == needed),
            "{refused:?}"
        );
    }
}
