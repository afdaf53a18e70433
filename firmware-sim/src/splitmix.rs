//! SplitMix64 (Steele, Lea and Flood 2014): a stateless mix of numbers, for everything here that is drawn from a seed.

const GOLDEN_GAMMA: u64 = 0x9e37_79b9_7f4a_7c15;

/// A well mixed function of two numbers.
#[must_use]
pub(crate) const fn mix(root: u64, index: u64) -> u64 {
    let mut z = root.wrapping_add(index.wrapping_add(1).wrapping_mul(GOLDEN_GAMMA));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// The number as a fraction in [0, 1), exact in `f32`.
#[must_use]
pub(crate) fn fraction(bits: u64) -> f32 {
    const STEPS: f32 = (1_u32 << 24) as f32;
    (bits >> 40) as f32 / STEPS
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_sequence_of_seed_1234567_comes_out() {
        let first: Vec<u64> = (0..3).map(|index| mix(1_234_567, index)).collect();
        assert_eq!(
            first,
            [
                6_457_827_717_110_365_317,
                3_203_168_211_198_807_973,
                9_817_491_932_198_370_423
            ]
        );
    }

    #[test]
    fn fractions_stay_below_one() {
        assert_eq!(fraction(0), 0.0);
        assert!(fraction(u64::MAX) < 1.0);
    }
}
