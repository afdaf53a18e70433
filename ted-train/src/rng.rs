//! Named streams of randomness: one root seed, and children such as `"reward/3"` or `"iql/batch"`.
//!
//! A child depends only on its parent and its name, never on how much was drawn elsewhere, so adding a consumer of
//! randomness changes no other one.

use rand::rngs::ChaCha8Rng;
use rand::{Rng, RngExt, SeedableRng};

/// A seed from which named child seeds and generators are derived.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seed(u64);

impl Seed {
    /// The root of a run's randomness: the number a person gives as `--seed`.
    #[must_use]
    pub fn root(seed: u64) -> Self {
        Self(seed)
    }

    /// The child stream of this name.
    #[must_use]
    pub fn child(self, name: &str) -> Self {
        let mut hasher = blake3::Hasher::new();
        hasher.update(&self.0.to_le_bytes());
        hasher.update(name.as_bytes());
        let mut first = [0; 8];
        first.copy_from_slice(&hasher.finalize().as_bytes()[..8]);
        Self(u64::from_le_bytes(first))
    }

    /// The seed as a number, for consumers outside this process (Meta-World episodes).
    #[must_use]
    pub fn value(self) -> u64 {
        self.0
    }

    /// A generator that starts at the beginning of this stream.
    #[must_use]
    pub fn rng(self) -> ChaCha8Rng {
        ChaCha8Rng::seed_from_u64(self.0)
    }

    /// The generator of one step of this stream: drawing for step `step` needs no state from the steps before it, so a
    /// resumed run draws what an uninterrupted one would have.
    #[must_use]
    pub fn rng_at(self, step: u64) -> ChaCha8Rng {
        let mut rng = self.rng();
        rng.set_stream(step);
        rng
    }
}

/// One draw of N(0, 1) by Box and Muller: two uniforms for each, nothing kept between calls.
pub fn standard_normal(rng: &mut impl Rng) -> f64 {
    let radius: f64 = 1.0 - rng.random::<f64>();
    let angle: f64 = rng.random::<f64>() * std::f64::consts::TAU;
    (-2.0 * radius.ln()).sqrt() * angle.cos()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn children_depend_on_parent_and_name_only() {
        let root = Seed::root(7);
        assert_eq!(root.child("reward/3"), Seed::root(7).child("reward/3"));
        assert_ne!(root.child("reward/3"), root.child("reward/4"));
        assert_ne!(root.child("reward/3"), Seed::root(8).child("reward/3"));
    }

    #[test]
    fn steps_of_a_stream_are_independent_of_the_steps_before() {
        use rand::RngExt;
        let stream = Seed::root(7).child("iql/batch");
        let mut earlier = stream.rng_at(1);
        let _: u64 = earlier.random();
        let (a, b): (u64, u64) = (stream.rng_at(2).random(), stream.rng_at(2).random());
        assert_eq!(a, b);
        assert_ne!(a, stream.rng_at(3).random::<u64>());
    }
}
