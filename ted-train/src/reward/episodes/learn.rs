//! The procedure: look at the logs, ask and update what is believed, and give every transition its share.

use nalgebra::DVector;

use crate::dataset::{Clip, Dataset, Segment, SegmentSampler};
use crate::nn::ExportedMlp;
use crate::preferences::Interview;
use crate::reward::{
    ExportedEnsemble, Fit, HeldOut, InputMap, LearnError, Learned, Material, RewardInputs,
    RewardModel,
};
use crate::rng::Seed;

use super::belief::Belief;
use super::descriptors::{Descriptors, Steps, scaling};
use super::fitting::{Rows, answers, fit};
use super::interrogation::Interrogation;
use super::posterior::{Evidence, second_better};
use super::{EpisodeModel, EpisodesConfig, words};

/// What can be said of a dataset before anybody is asked.
pub struct Look<'a> {
    steps: Steps<'a>,
    descriptors: Descriptors,
}

impl<'a> Look<'a> {
    /// Clones the logs and describes every episode.
    ///
    /// # Errors
    /// When the clone's loss is not finite, or somebody asks to stop.
    pub fn at(config: &EpisodesConfig, on: Material<'a>) -> Result<Self, LearnError> {
        let dataset = on.dataset;
        let [shift, scale] = scaling(dataset);
        let seen = |step: usize, out: &mut Vec<f32>| {
            let raw = dataset.observation(step).iter();
            let scaled = raw.zip(&shift).zip(&scale);
            out.extend(scaled.map(|((x, shift), scale)| (x - shift) * scale));
        };
        let said = |step: usize, out: &mut Vec<f32>| out.extend(dataset.action(step));
        let rows = Rows {
            count: dataset.step_count(),
            inputs: dataset.observation_dim(),
            outputs: dataset.action_dim(),
            seen: &seen,
            said: &said,
        };
        let progress = on
            .audience
            .start("look at the logs", config.clone.steps, "steps");
        let seed = on.seed.child("clone");
        let clone = fit(&config.clone, &rows, seed, on.backend, &progress)?;
        let cloned = answers(&clone, &rows, 0..rows.count, on.backend);
        progress.finish();
        let steps = Steps::new(dataset, &cloned, config.clip);
        let descriptors = Descriptors::of(&steps, config.directions, config.block);
        Ok(Self { steps, descriptors })
    }

    /// The descriptors of the episodes.
    #[must_use]
    pub fn descriptors(&self) -> &Descriptors {
        &self.descriptors
    }
}

/// Asks, and learns what the answers say about episodes.
///
/// # Errors
/// When there are fewer than two episodes, an answer cannot be had or kept, a loss is not finite, or somebody asks to stop.
pub(super) fn learn(
    config: &EpisodesConfig,
    on: Material<'_>,
    interview: &mut Interview<'_>,
) -> Result<Learned, LearnError> {
    let asking = Interrogation::begin(config, on)?;
    let (evidence, samples) = asking.hold(interview, config.queries)?;
    let Interrogation { look, prior, .. } = &asking;
    let Belief {
        weights,
        quality,
        confidence,
    } = Belief::new(config, look, &evidence, &samples);
    if let Some(moved) = words::moved(prior, &weights).filter(|_| confidence.answers > 0) {
        on.audience.note(&moved);
    }
    on.audience.note(&confidence.in_words());
    let network = network(config, look, &weights, on)?;
    let held_out = held_out(config, &quality, on.dataset, on.seed)?;
    Ok(Learned {
        model: RewardModel::Episodes(EpisodeModel {
            network,
            confidence,
            quality: quality.iter().map(|&quality| quality as f32).collect(),
        }),
        fits: vec![fit_of(config, &evidence, &weights)],
        held_out,
    })
}

/// How the mean weights fit the answers.
fn fit_of(config: &EpisodesConfig, evidence: &Evidence, weights: &DVector<f64>) -> Fit {
    let said = evidence.differences.iter().zip(&evidence.labels);
    let pairs: Vec<(f64, f64)> = said
        .map(|(difference, &label)| (weights.dot(difference), label))
        .collect();
    let loss: f64 = pairs
        .iter()
        .map(|&(difference, label)| {
            let p = second_better(config, difference);
            -(label * p.ln() + (1.0 - label) * (1.0 - p).ln())
        })
        .sum();
    let order = pairs
        .iter()
        .map(|&(difference, label)| (label as f32, difference > 0.0));
    Fit::new((loss / pairs.len().max(1) as f64) as f32, order)
}

/// A network that gives every transition its share of its episode's quality: what a controller computes, and what labels the
/// dataset.
fn network(
    config: &EpisodesConfig,
    look: &Look<'_>,
    weights: &DVector<f64>,
    on: Material<'_>,
) -> Result<ExportedEnsemble, LearnError> {
    let dataset = on.dataset;
    let mut shares = look.descriptors.shares(&look.steps, weights);
    unit_deviation(&mut shares);
    let inputs = InputMap {
        inputs: RewardInputs::ObservationAction,
        shift: [&look.steps.shift[..], &vec![0.0; dataset.action_dim()]].concat(),
        scale: (look.steps.scale.iter().map(|&scale| positive(scale)))
            .chain(std::iter::repeat_n(1.0, dataset.action_dim()))
            .collect(),
    };
    let seen = |step: usize, out: &mut Vec<f32>| inputs.push(dataset, step, out);
    let said = |step: usize, out: &mut Vec<f32>| out.push(shares[step]);
    let rows = Rows {
        count: dataset.step_count(),
        inputs: inputs.width(),
        outputs: 1,
        seen: &seen,
        said: &said,
    };
    let progress = on
        .audience
        .start("learn a reward", config.network.steps, "steps");
    let seed = on.seed.child("network");
    let network = fit(&config.network, &rows, seed, on.backend, &progress)?;
    progress.finish();
    Ok(ExportedEnsemble {
        members: ExportedMlp::members(&network),
        inputs,
    })
}

/// The scale of a channel for a controller, which wants one above 0: of a channel that does not move it does not matter.
fn positive(scale: f32) -> f32 {
    if scale > 0.0 { scale } else { 1.0 }
}

/// Divides numbers by their root mean square, so that what a network is fitted to has one size whatever the answers were.
fn unit_deviation(numbers: &mut [f32]) {
    let squares: f64 = numbers.iter().map(|&x| f64::from(x * x)).sum();
    let root = (squares / numbers.len().max(1) as f64).sqrt() as f32;
    if root > 1e-12 {
        numbers.iter_mut().for_each(|x| *x /= root);
    }
}

/// Agreement of the quality with true returns on random pairs.
fn held_out(
    config: &EpisodesConfig,
    quality: &DVector<f64>,
    dataset: &Dataset,
    seed: Seed,
) -> Result<HeldOut, LearnError> {
    let sampler = SegmentSampler::new(dataset, Clip::Episode)?;
    let order = |pairs: &[[Segment; 2]]| {
        let of = |segment: Segment| quality[segment.episode() as usize];
        let order = pairs.iter().map(|&[first, second]| of(second) > of(first));
        order.collect()
    };
    Ok(HeldOut::measure(
        config.held_out,
        dataset,
        &sampler,
        seed,
        order,
    ))
}
