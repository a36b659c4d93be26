//! Hashing numbers to random numbers.

/// A 64-bit hash of two numbers (the finaliser of SplitMix64 over a Weyl step; Steele et al. 2014).
pub(crate) fn mix(seed: u64, value: u64) -> u64 {
    let mut z = finalise(seed).wrapping_add(value.wrapping_mul(0x9e37_79b9_7f4a_7c15));
    z = z.wrapping_add(0x9e37_79b9_7f4a_7c15);
    finalise(z)
}

fn finalise(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
