//! Random bits by address: a bijection of counters that no two addresses share.

/// Philox4x32 with ten rounds: four random words for a counter and a key.
///
/// The same words on every machine, without a state that would tie one to the order of asking. It passes
/// the known answers of Random123.
///
/// J. K. Salmon, M. A. Moraes, R. O. Dror, D. E. Shaw, *Parallel random numbers: as easy as 1, 2, 3*,
/// SC 2011, section 3.3 and table 2.
#[inline(always)]
pub fn philox4x32(counter: [u32; 4], key: [u32; 2]) -> [u32; 4] {
    // Words of which the low half counts: 64 bits are what a product fills, also in vectors.
    let [a, b, c, d] = counter;
    let (mut counter, mut key) = ([a.into(), b.into(), c.into(), d.into()], key);
    for _ in 0..ROUNDS {
        counter = round(counter, key);
        key = [key[0].wrapping_add(WEYL[0]), key[1].wrapping_add(WEYL[1])];
    }
    let [a, b, c, d]: [u64; 4] = counter;
    [a as u32, b as u32, c as u32, d as u32]
}

const ROUNDS: usize = 10;

/// The multipliers of a round.
const MULTIPLIERS: [u32; 2] = [0xD251_1F53, 0xCD9E_8D57];

/// The increments of the key after each round: the golden ratio and √3 − 1, as fractions of 2³².
const WEYL: [u32; 2] = [0x9E37_79B9, 0xBB67_AE85];

#[inline(always)]
fn round([a, b, c, d]: [u64; 4], key: [u32; 2]) -> [u64; 4] {
    let product = |x: u64, multiplier: u32| (x & u64::from(u32::MAX)) * u64::from(multiplier);
    let (near, far) = (product(a, MULTIPLIERS[0]), product(c, MULTIPLIERS[1]));
    let [first, second] = [u64::from(key[0]), u64::from(key[1])];
    [(far >> 32) ^ b ^ first, far, (near >> 32) ^ d ^ second, near]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_answers_are_those_of_random123() {
        // The file kat_vectors of Random123 1.14, lines `philox4x32 10`.
        let ones = u32::MAX;
        for (counter, key, answer) in [
            ([0; 4], [0; 2], [0x6627_E8D5, 0xE169_C58D, 0xBC57_AC4C, 0x9B00_DBD8]),
            ([ones; 4], [ones; 2], [0x408F_276D, 0x41C8_3B0E, 0xA20B_C7C6, 0x6D54_51FD]),
            (
                [0x243F_6A88, 0x85A3_08D3, 0x1319_8A2E, 0x0370_7344],
                [0xA409_3822, 0x299F_31D0],
                [0xD16C_FE09, 0x94FD_CCEB, 0x5001_E420, 0x2412_6EA1],
            ),
        ] {
            assert_eq!(philox4x32(counter, key), answer, "{counter:08x?} {key:08x?}");
        }
    }
}
