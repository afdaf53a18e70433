//! The procedure: ask each member's own question, train, then ask, train, ask, train what is most disputed.

use firmware_sim::interrupt;
use firmware_sim::progress::Audience;

use crate::dataset::{Dataset, Segment, SegmentError, SegmentSampler};
use crate::nn::Backend;
use crate::preferences::{
    Context, LabelledPair, PreferenceLog, Query, QueryStrategy, RandomPair, Teacher,
};
use crate::reward::{Fit, HeldOut, LearnError};
use crate::rng::Seed;

use super::config::OprlConfig;
use super::disagreement::MostDisputed;
use super::ensemble::Ensemble;

/// A trained ensemble and how the training went.
pub struct Learned {
    /// The ensemble.
    pub ensemble: Ensemble,
    /// Fit of the training pairs after the first queries and after each round.
    pub fits: Vec<Fit>,
}

/// Learns a reward ensemble from exactly `members + rounds` answers, each appended to `log` before it is used.
///
/// # Errors
/// When the dataset has no segment that long, the teacher or the log fails, a loss is not finite, or
/// somebody asks to stop.
pub fn learn(
    config: &OprlConfig,
    dataset: &Dataset,
    teacher: &mut dyn Teacher,
    log: &mut PreferenceLog,
    seed: Seed,
    backend: Backend,
    audience: Audience,
) -> Result<Learned, LearnError> {
    let sampler = SegmentSampler::new(dataset, config.segment)?;
    let mut ensemble = Ensemble::new(
        config,
        &dataset.observation_statistics(),
        dataset.action_dim(),
        seed,
        backend,
    );
    let mut ask = |context, segments| -> Result<LabelledPair, LearnError> {
        let query = Query { segments };
        let answer = log.ask(dataset, teacher, context, query)?;
        Ok(LabelledPair::new(query, answer))
    };

    let mut pairs = Vec::with_capacity(config.members);
    for member in 0..config.members {
        let mut rng = seed.child(&format!("query/member/{member}")).rng();
        let context = Context {
            round: 0,
            member: u32::try_from(member).ok(),
        };
        pairs.push(vec![ask(context, RandomPair.choose(&sampler, &mut rng))?]);
    }
    let epochs = u64::from(config.epochs) * u64::from(1 + config.rounds);
    let progress = audience.start("learn a reward", epochs, "epochs");
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
        let segments = disputed.choose(&sampler, &mut rng);
        let pair = ask(
            Context {
                round,
                member: None,
            },
            segments,
        )?;
        pairs.iter_mut().for_each(|own| own.push(pair));
        fits.push(finite(
            round,
            ensemble.train(dataset, &pairs, &mut going_on),
        )?);
    }
    progress.finish();
    Ok(Learned { ensemble, fits })
}

/// Measures the ensemble on random pairs, against true returns.
///
/// # Errors
/// When the dataset has no segment of the configured length.
pub fn held_out_agreement(
    config: &OprlConfig,
    ensemble: &Ensemble,
    dataset: &Dataset,
    seed: Seed,
) -> Result<HeldOut, SegmentError> {
    let sampler = SegmentSampler::new(dataset, config.segment)?;
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
