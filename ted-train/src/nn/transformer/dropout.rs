//! Dropout (Srivastava et al. 2014) whose masks are functions of a stream, the number of the update, and a place.

use burn::tensor::{Device, Tensor, TensorData};
use rand::Rng;
use rayon::prelude::*;

use crate::rng::Seed;

/// What one update drops: each number with the same probability, the others being scaled up to keep the mean.
#[derive(Clone, Debug)]
pub struct Dropout {
    update: Option<Update>,
}

#[derive(Clone, Debug)]
struct Update {
    /// The probability in 65,536ths.
    threshold: u16,
    stream: Seed,
    number: u64,
    copies: usize,
}

/// Numbers drawn by one job; each has 16 bits of its own.
const CHUNK: usize = 1 << 15;

impl Dropout {
    /// Nothing is dropped: a trained network at work.
    #[must_use]
    pub fn none() -> Self {
        Self { update: None }
    }

    /// The masks of update `number`. The probability is rounded to a 65,536th. A batch consists of `copies` equal parts
    /// that share their masks, such as the two sides of a comparison.
    #[must_use]
    pub fn of_update(rate: f64, stream: Seed, number: u64, copies: usize) -> Self {
        let threshold = (rate * 65_536.0).round() as u16;
        let update = Update {
            threshold,
            stream,
            number,
            copies,
        };
        Self {
            update: (threshold > 0).then_some(update),
        }
    }

    /// Factors 0 and 1 / (1 - rate) for a tensor of this shape at `place`; none where nothing is dropped. Sequences are
    /// the outermost axis of the shape that is longer than 1.
    pub(crate) fn mask<const D: usize>(
        &self,
        place: &str,
        shape: [usize; D],
        device: &Device,
    ) -> Option<Tensor<D>> {
        let update = self.update.as_ref()?;
        let stream = update.stream.child(place);
        let count = shape.iter().product::<usize>();
        let own = count / update.copies;
        let keep = 65_536.0 / (65_536.0 - f32::from(update.threshold));
        let mut mask = vec![0.0f32; count];
        let (first, rest) = mask.split_at_mut(own);
        let jobs = first.par_chunks_mut(CHUNK).enumerate();
        jobs.for_each(|(chunk, mask)| {
            let mut rng = stream.rng_at(update.number);
            // Two numbers a word of the generator's stream.
            rng.set_word_pos((chunk * CHUNK / 2) as u128);
            let mut bytes = [0u8; 2 * CHUNK];
            let bytes = &mut bytes[..2 * mask.len()];
            rng.fill_bytes(bytes);
            for (mask, bytes) in mask.iter_mut().zip(bytes.as_chunks::<2>().0) {
                *mask = if u16::from_le_bytes(*bytes) < update.threshold {
                    0.0
                } else {
                    keep
                };
            }
        });
        for copy in rest.chunks_mut(own) {
            copy.copy_from_slice(first);
        }
        Some(Tensor::from_data(TensorData::new(mask, shape), device))
    }
}

/// Applies a mask, to values or to their gradients.
pub(super) fn masked<const D: usize>(x: Tensor<D>, mask: Option<&Tensor<D>>) -> Tensor<D> {
    match mask {
        Some(mask) => x * mask.clone(),
        None => x,
    }
}
