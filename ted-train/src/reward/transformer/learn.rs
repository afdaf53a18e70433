//! The procedure: train on all answers at once.

use firmware_sim::interrupt;

use crate::dataset::{Clip, Dataset, Segment, SegmentError, SegmentSampler};
use crate::nn::transformer::Dropout;
use crate::preferences::LabelledPair;
use crate::reward::{Fit, HeldOut, LearnError, Material, Save, Saved};
use crate::rng::Seed;

use super::config::PtConfig;
use super::network::RewardTransformer;
use super::training::{Training, numbers, pair_clips};

/// Steps between two looks at the fit, after each of which the state is saved: two minutes of work with the default
/// configuration.
pub const LOOK_EVERY: u64 = 500;

/// A trained transformer and how the training went.
pub struct Trained {
    /// The transformer.
    pub transformer: RewardTransformer,
    /// Fit of the training pairs after every [`LOOK_EVERY`] steps and at the end.
    pub fits: Vec<Fit>,
}

/// Learns from these answers. Goes on from `saved`, the state that was last given to `save`, with the bits of a training that
/// was never stopped.
///
/// # Errors
/// When `save` fails, the saved state does not fit, a loss is not finite, or somebody asks to stop.
pub fn train(
    config: &PtConfig,
    pairs: &[LabelledPair],
    on: Material<'_>,
    saved: Option<Saved>,
    save: Save<'_>,
) -> Result<Trained, LearnError> {
    let Material {
        dataset,
        seed,
        backend,
        audience,
    } = on;
    let statistics = dataset.observation_statistics();
    let actions = dataset.action_dim();
    let transformer = RewardTransformer::new(config, &statistics, actions, seed, backend);
    let mut training = Training::new(config, transformer, dataset, pairs, seed);
    let mut fits = Vec::new();
    if let Some(saved) = saved {
        training.restore(&saved.checkpoint)?;
        fits = saved.fits;
    }
    let progress = audience.start("learn a reward", config.steps, "steps");
    progress.skip(training.step);
    while training.step < config.steps {
        let loss = training.update();
        let step = training.step;
        if !loss.is_finite() {
            return Err(LearnError::Diverged {
                after: format!("{step} steps"),
            });
        }
        progress.advance(1);
        let look = step.is_multiple_of(LOOK_EVERY);
        if look || step == config.steps {
            fits.push(training.fit());
            progress.message(&format!("loss {loss:.3}"));
        }
        let stop = interrupt::requested();
        if stop || look {
            let checkpoint = training.checkpoint();
            let saved = Saved { checkpoint, fits };
            save(&saved)?;
            fits = saved.fits;
        }
        if stop {
            return Err(LearnError::Interrupted);
        }
    }
    progress.finish();
    let transformer = training.transformer;
    Ok(Trained { transformer, fits })
}

/// Measures the transformer's scores on random pairs, against true returns.
///
/// # Errors
/// When the dataset has no segment of the configured length.
pub fn held_out_agreement(
    config: &PtConfig,
    transformer: &RewardTransformer,
    dataset: &Dataset,
    seed: Seed,
) -> Result<HeldOut, SegmentError> {
    /// Pairs in one forward pass.
    const CHUNK: usize = 20;
    let sampler = SegmentSampler::new(dataset, Clip::Steps(config.segment))?;
    let order = |pairs: &[[Segment; 2]]| {
        let second_first = pairs.chunks(CHUNK).flat_map(|pairs| {
            let clips = pair_clips(transformer, dataset, pairs);
            let (scores, _) = transformer.network.scores(&clips, &Dropout::none());
            let scores = numbers(&scores);
            let (first, second) = scores.split_at(pairs.len());
            let both = first.iter().zip(second);
            both.map(|(first, second)| second > first)
                .collect::<Vec<_>>()
        });
        second_first.collect()
    };
    let held_out = HeldOut::measure(config.held_out, dataset, &sampler, seed, order);
    Ok(held_out)
}
