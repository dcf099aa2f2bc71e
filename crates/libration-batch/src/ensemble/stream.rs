//! Stores that go past the caches.

use bytemuck::Pod;
use pulp::{Simd, WithSimd};

use super::InstructionSet;
use super::instructions::{Target, Targeted};

/// Copies `from` to `to` past the caches, where the processor can; its caches keep what they hold.
///
/// A plain store first reads the line that it is about to overwrite. A stream saves that read, a third of
/// the traffic of a copy, but what it wrote is in no cache. It is visible to other threads as after
/// any copy.
///
/// # Panics
/// If the lengths differ.
pub fn stream<T: Pod>(from: &[T], to: &mut [T]) {
    assert_eq!(from.len(), to.len(), "lengths of source and destination");
    stream_repeatedly(from, to);
}

/// Fills `to` with one copy of `from` after the other, past the caches as [`stream`] does: where `from` fits the first cache,
/// nothing but the memory takes time.
///
/// # Panics
/// If there is something to fill and nothing to fill it with.
pub fn stream_repeatedly<T: Pod>(from: &[T], to: &mut [T]) {
    InstructionSet::widest().run(Copy { from, to });
}

/// A copy by the widest stores: narrow ones are gathered to lines on their way, which takes the processor longer than the memory.
struct Copy<'a, T> {
    from: &'a [T],
    to: &'a mut [T],
}

impl<T: Pod> Targeted for Copy<'_, T> {
    type Output = ();

    fn on<I: Target>(self, target: I) {
        target.run(Widest(self, target));
    }
}

struct Widest<C, I>(C, I);

impl<T: Pod, I: Target> WithSimd for Widest<Copy<'_, T>, I> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let streaming = Streaming::on(self.1);
        let Copy { from, to } = self.0;
        assert!(to.is_empty() || !from.is_empty(), "nothing to fill it with");
        for to in to.chunks_mut(from.len().max(1)) {
            streaming.copy(&from[..to.len()], to);
        }
    }
}

/// Copies past the caches, which are visible to other threads once it is dropped.
pub(crate) struct Streaming<I: Target>(I);

impl<I: Target> Streaming<I> {
    /// With the vectors of this instruction set.
    pub(crate) fn on(target: I) -> Self {
        Streaming(target)
    }

    /// Copies `from` to `to`.
    ///
    /// # Panics
    /// If the lengths differ.
    #[inline(always)]
    pub(crate) fn copy<T: Pod>(&self, from: &[T], to: &mut [T]) {
        assert_eq!(from.len(), to.len(), "lengths of source and destination");
        let from: &[u8] = bytemuck::cast_slice(from);
        let to: &mut [u8] = bytemuck::cast_slice_mut(to);
        let head = to.as_ptr().align_offset(LINE).min(to.len());
        let body = (to.len() - head) / LINE * LINE;
        let (from_head, from) = from.split_at(head);
        let (to_head, to) = to.split_at_mut(head);
        let (from_body, from_tail) = from.split_at(body);
        let (to_body, to_tail) = to.split_at_mut(body);
        to_head.copy_from_slice(from_head);
        pieces::<I, LINE>(from_body, to_body);
        to_tail.copy_from_slice(from_tail);
    }

    /// Whether it can stream into all of this.
    #[inline(always)]
    pub(crate) fn takes<T: Pod, const N: usize>(&self, to: &[T; N]) -> bool {
        let piece = const { piece(I::BYTES, size_of::<[T; N]>()) };
        piece > 0 && to.as_ptr().cast::<u8>().align_offset(piece) == 0
    }

    /// Copies numbers of which there are few, without a call; a line that is written in pieces is gathered on its way.
    ///
    /// # Panics
    /// If it does not [take](Self::takes) them.
    #[inline(always)]
    pub(crate) fn block<T: Pod, const N: usize>(&self, from: &[T; N], to: &mut [T; N]) {
        assert!(self.takes(to), "not in pieces");
        let (from, to): (&[u8], &mut [u8]) =
            (bytemuck::cast_slice(from), bytemuck::cast_slice_mut(to));
        match const { piece(I::BYTES, size_of::<[T; N]>()) } {
            64 => pieces::<I, 64>(from, to),
            32 => pieces::<I, 32>(from, to),
            _ => pieces::<I, 16>(from, to),
        }
    }
}

/// The largest piece that so many bytes are made of, where vectors have so many; 0 if they are made of none.
const fn piece(vector: usize, bytes: usize) -> usize {
    let mut piece = vector;
    while piece >= 16 {
        if bytes.is_multiple_of(piece) {
            return piece;
        }
        piece /= 2;
    }
    0
}

/// Streamed stores are ordered with no others: without the fence a thread that is told of them might see what was there before.
impl<I: Target> Drop for Streaming<I> {
    #[allow(unsafe_code)]
    fn drop(&mut self) {
        // SAFETY: SSE belongs to x86-64.
        #[cfg(target_arch = "x86_64")]
        unsafe {
            core::arch::x86_64::_mm_sfence()
        }
    }
}

/// Bytes that the processor writes to memory at once.
const LINE: usize = 64;

/// Whole pieces of `N` bytes, of which those of `to` are aligned, and no vector is shorter.
#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code)]
#[inline(always)]
fn pieces<I: Target, const N: usize>(from: &[u8], to: &mut [u8]) {
    use core::arch::x86_64 as x86;

    let (from, to) = (from.as_chunks::<N>().0, to.as_chunks_mut::<N>().0);
    for (from, to) in from.iter().zip(to) {
        let (from, to) = (from.as_ptr(), to.as_mut_ptr());
        // SAFETY: both have the bytes of a piece, and `to` begins with one, as the callers saw to. An instruction set that can be
        // named as a type is there, since a value of it was needed to ask for a stream; SSE2 belongs to x86-64.
        unsafe {
            match const { if N < I::BYTES { N } else { I::BYTES } } {
                64 => x86::_mm512_stream_si512(to.cast(), x86::_mm512_loadu_si512(from.cast())),
                32 => {
                    for at in (0..N).step_by(32) {
                        let vector = x86::_mm256_loadu_si256(from.add(at).cast());
                        x86::_mm256_stream_si256(to.add(at).cast(), vector);
                    }
                }
                _ => {
                    for at in (0..N).step_by(16) {
                        let vector = x86::_mm_loadu_si128(from.add(at).cast());
                        x86::_mm_stream_si128(to.add(at).cast(), vector);
                    }
                }
            }
        }
    }
}

/// Other processors stream by themselves, or not at all.
#[cfg(not(target_arch = "x86_64"))]
#[inline(always)]
fn pieces<I: Target, const N: usize>(from: &[u8], to: &mut [u8]) {
    to.copy_from_slice(from);
}

#[cfg(test)]
mod tests {
    use super::stream;

    #[test]
    fn a_stream_copies_every_byte_and_no_other_whatever_the_alignment() {
        let from: Vec<u8> = (0..=255).cycle().take(1000).collect();
        for start in 0..70 {
            for len in [0, 1, 15, 63, 64, 65, 127, 500] {
                let mut to = vec![7u8; 1000];
                stream(&from[start..start + len], &mut to[start..start + len]);
                assert_eq!(to[start..start + len], from[start..start + len]);
                assert!(to[..start].iter().chain(&to[start + len..]).all(|&byte| byte == 7));
            }
        }
    }

    #[test]
    #[should_panic(expected = "lengths")]
    fn lengths_that_differ_are_refused() {
        stream(&[1.0f32], &mut [0.0; 2]);
    }
}
