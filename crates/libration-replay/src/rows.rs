//! Rows of numbers in flat memory, whose width is known at run time.

/// Copies the rows of these cells one after the other. All rows have `width` numbers, at least 1.
pub(super) fn gather<T: Copy>(to: &mut [T], from: &[T], cells: &[usize], width: usize) {
    // A copy of constant length takes a fraction of the time of a call that copies a few numbers.
    match width {
        1 => gather_arrays::<T, 1>(to, from, cells),
        2 => gather_arrays::<T, 2>(to, from, cells),
        3 => gather_arrays::<T, 3>(to, from, cells),
        4 => gather_arrays::<T, 4>(to, from, cells),
        _ => {
            for (to, &cell) in to.chunks_exact_mut(width).zip(cells) {
                to.copy_from_slice(&from[cell * width..][..width]);
            }
        }
    }
}

fn gather_arrays<T: Copy, const N: usize>(to: &mut [T], from: &[T], cells: &[usize]) {
    let (to, from) = (to.as_chunks_mut::<N>().0, from.as_chunks::<N>().0);
    to.iter_mut().zip(cells).for_each(|(to, &cell)| *to = from[cell]);
}

/// Writes rows of `width` numbers from planes: number `i` of row `l` is `from[i * plane + l]`.
pub(super) fn interleave<T: Copy>(to: &mut [T], from: &[T], plane: usize, width: usize) {
    match width {
        1 => interleave_arrays::<T, 1>(to, from, plane),
        2 => interleave_arrays::<T, 2>(to, from, plane),
        3 => interleave_arrays::<T, 3>(to, from, plane),
        4 => interleave_arrays::<T, 4>(to, from, plane),
        _ => {
            for (l, to) in to.chunks_exact_mut(width).enumerate() {
                to.iter_mut().enumerate().for_each(|(i, to)| *to = from[i * plane + l]);
            }
        }
    }
}

fn interleave_arrays<T: Copy, const N: usize>(to: &mut [T], from: &[T], plane: usize) {
    for (l, to) in to.as_chunks_mut::<N>().0.iter_mut().enumerate() {
        *to = core::array::from_fn(|i| from[i * plane + l]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_any_width_are_those_of_their_cells() {
        for width in 1..=9 {
            let from: Vec<usize> = (0..5 * width).collect();
            let cells = [4, 0, 3, 3];
            let mut to = vec![usize::MAX; 4 * width];
            gather(&mut to, &from, &cells, width);
            let all = cells.iter().flat_map(|cell| (0..width).map(move |i| cell * width + i));
            assert_eq!(to, all.collect::<Vec<_>>(), "{width}");
        }
    }

    #[test]
    fn rows_of_any_width_are_found_in_planes() {
        for width in 1..=9 {
            let from: Vec<usize> = (0..7 * width).collect();
            let mut to = vec![usize::MAX; 3 * width];
            interleave(&mut to, &from[2..], 7, width);
            let all = (0..3).flat_map(|l| (0..width).map(move |i| i * 7 + 2 + l));
            assert_eq!(to, all.collect::<Vec<_>>(), "{width}");
        }
    }
}
