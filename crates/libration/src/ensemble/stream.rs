//! Stores that go past the caches.

use bytemuck::Pod;

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
    let (from, to): (&[u8], &mut [u8]) = (bytemuck::cast_slice(from), bytemuck::cast_slice_mut(to));
    let head = to.as_ptr().align_offset(LINE).min(to.len());
    let body = (to.len() - head) / LINE * LINE;
    let (from_head, from) = from.split_at(head);
    let (to_head, to) = to.split_at_mut(head);
    let (from_body, from_tail) = from.split_at(body);
    let (to_body, to_tail) = to.split_at_mut(body);
    to_head.copy_from_slice(from_head);
    lines(from_body, to_body);
    to_tail.copy_from_slice(from_tail);
}

/// Bytes that the processor writes to memory at once.
const LINE: usize = 64;

/// Whole cache lines, of which those of `to` are aligned.
#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code)]
fn lines(from: &[u8], to: &mut [u8]) {
    use core::arch::x86_64::{__m128i, _mm_loadu_si128, _mm_sfence, _mm_stream_si128};

    const VECTOR: usize = size_of::<__m128i>();
    for (from, to) in from.chunks_exact(LINE).zip(to.chunks_exact_mut(LINE)) {
        for (from, to) in from.chunks_exact(VECTOR).zip(to.chunks_exact_mut(VECTOR)) {
            // SAFETY: both slices have the 16 bytes of a vector; `to` begins on a multiple of 16,
            // since `stream` aligned it to a cache line and every chunk before it is a multiple.
            // SSE2 belongs to x86-64.
            unsafe {
                _mm_stream_si128(to.as_mut_ptr().cast(), _mm_loadu_si128(from.as_ptr().cast()))
            }
        }
    }
    // Streamed stores are ordered with no others: without the fence a thread that is told of them
    // might see what was there before.
    // SAFETY: SSE belongs to x86-64.
    unsafe { _mm_sfence() }
}

/// Other processors stream by themselves, or not at all.
#[cfg(not(target_arch = "x86_64"))]
fn lines(from: &[u8], to: &mut [u8]) {
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
