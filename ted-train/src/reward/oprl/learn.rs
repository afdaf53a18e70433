//! The procedure: ask each member's own question, train, then ask, train, ask, train what is most disputed.

use firmware_sim::interrupt;

use crate::dataset::{Dataset, Segment, SegmentError, SegmentSampler};
use crate::preferences::{Context, Interview, LabelledPair, RandomPair};
use crate::reward::{Fit, HeldOut, LearnError, Material};
use crate::rng::Seed;

use super::config::OprlConfig;
use super::disagreement::MostDisputed;
use super::ensemble::Ensemble;

/// A trained ensemble and how the training went.
pub struct Trained {
    /// The ensemble.
    pub ensemble: Ensemble,
    /// Fit of the training pairs after the first queries and after each round.
    pub fits: Vec<Fit>,
}

/// Asks the first question of each member.
///
/// # Errors
/// When the dataset has no such segments, all of one length, or an answer cannot be had or kept.
pub fn ask(
    config: &OprlConfig,
    on: Material<'_>,
    interview: &mut Interview<'_>,
) -> Result<Vec<LabelledPair>, LearnError> {
    let sampler = SegmentSampler::of_one_length(on.dataset, config.segment)?;
    let ask = |member| {
        let mut rng = on.seed.child(&format!("query/member/{member}")).rng();
        let context = Context {
            round: 0,
            member: u32::try_from(member).ok(),
        };
        Ok(interview.ask(context, &RandomPair, &sampler, &mut rng)?)
    };
    (0..config.members).map(ask).collect()
}

/// Learns a reward ensemble from an answer for each member, and from one more in each round.
///
/// # Errors
/// When the dataset has no such segments, all of one length, an answer cannot be had or kept, a loss is not finite, or
/// somebody asks to stop.
pub fn train(
    config: &OprlConfig,
    own: &[LabelledPair],
    on: Material<'_>,
    interview: &mut Interview<'_>,
) -> Result<Trained, LearnError> {
    let (dataset, seed) = (on.dataset, on.seed);
    let sampler = SegmentSampler::of_one_length(dataset, config.segment)?;
    let mut ensemble = Ensemble::new(
        config,
        &dataset.observation_statistics(),
        dataset.action_dim(),
        seed,
        on.backend,
    );
    let mut pairs: Vec<_> = own.iter().map(|&pair| vec![pair]).collect();
    let epochs = u64::from(config.epochs) * u64::from(1 + config.rounds);
    let progress = on.audience.start("learn a reward", epochs, "epochs");
    let mut going_on = || {
        progress.advance(1);
        !interrupt::requested()
    };
    let finite = |round, fit: Option<Fit>| match fit.ok_or(LearnError::Interrupted)? {
        fit if fit.loss.is_finite() => Ok(fit),
        _ => Err(LearnError::Diverged {
            after: format!("round {round}"),
        }),
    };
    let mut fits = vec![finite(0, ensemble.train(dataset, &pairs, &mut going_on))?];
    for round in 1..=config.rounds {
        let mut rng = seed.child(&format!("query/round/{round}")).rng();
        let disputed = MostDisputed {
            ensemble: &ensemble,
            dataset,
            pool: config.pool,
        };
        let context = Context {
            round,
            member: None,
        };
        let pair = interview.ask(context, &disputed, &sampler, &mut rng)?;
        pairs.iter_mut().for_each(|own| own.push(pair));
        fits.push(finite(
            round,
            ensemble.train(dataset, &pairs, &mut going_on),
        )?);
    }
    progress.finish();
    Ok(Trained { ensemble, fits })
}

/// Measures the ensemble's mean return on random pairs, against true returns.
///
/// # Errors
/// When the dataset has no such segments, all of one length.
pub fn held_out_agreement(
    config: &OprlConfig,
    ensemble: &Ensemble,
    dataset: &Dataset,
    seed: Seed,
) -> Result<HeldOut, SegmentError> {
    let sampler = SegmentSampler::of_one_length(dataset, config.segment)?;
    let order = |pairs: &[[Segment; 2]]| {
        let returns = ensemble.segment_returns(dataset, pairs.as_flattened());
        let mean = |segment: usize| {
            returns
                .iter()
                .map(|member| f64::from(member[segment]))
                .sum::<f64>()
        };
        let second_first = |pair: usize| mean(2 * pair + 1) > mean(2 * pair);
        (0..pairs.len()).map(second_first).collect()
    };
    let held_out = HeldOut::measure(config.held_out, dataset, &sampler, seed, order);
    Ok(held_out)
}
