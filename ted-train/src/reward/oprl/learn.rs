//! The procedure: ask each member's own question, train, then ask, train, ask, train what is most disputed.

use firmware_sim::interrupt;
use firmware_sim::progress::Audience;
use serde::{Deserialize, Serialize};

use crate::dataset::{Dataset, SegmentError, SegmentSampler};
use crate::nn::Backend;
use crate::preferences::{Context, PreferenceError, PreferenceLog, Query, Teacher};
use crate::rng::Seed;

use super::config::OprlConfig;
use super::disagreement::{most_disputed, random_pair};
use super::ensemble::{Ensemble, Fit, LabelledPair};

/// A trained ensemble and how the training went.
pub struct Learned {
    /// The ensemble.
    pub ensemble: Ensemble,
    /// Fit of the training pairs after the first queries and after each round.
    pub fits: Vec<Fit>,
}

/// Why no ensemble was learned.
#[derive(Debug, thiserror::Error)]
pub enum LearnError {
    /// The dataset has no segment of the length asked for.
    #[error(transparent)]
    Segment(#[from] SegmentError),
    /// An answer could not be had or kept.
    #[error(transparent)]
    Preference(#[from] PreferenceError),
    /// A loss is no longer a number.
    #[error(
        "the reward loss is not finite after round {round}: the learning rate or the inputs are too large"
    )]
    Diverged {
        /// The round, 0 being the first questions.
        round: u32,
    },
    /// Somebody asked to stop.
    #[error("stopped while learning a reward: every answer is kept and the same command goes on")]
    Interrupted,
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
        let answer = log.ask(dataset, teacher, context, Query { segments })?;
        Ok(LabelledPair {
            segments,
            label: answer.label(),
        })
    };

    let mut pairs = Vec::with_capacity(config.members);
    for member in 0..config.members {
        let mut rng = seed.child(&format!("query/member/{member}")).rng();
        let context = Context {
            round: 0,
            member: u32::try_from(member).ok(),
        };
        pairs.push(vec![ask(context, random_pair(&sampler, &mut rng))?]);
    }
    let epochs = u64::from(config.epochs) * u64::from(1 + config.rounds);
    let progress = audience.start("learn a reward", epochs, "epochs");
    let mut going_on = || {
        progress.advance(1);
        !interrupt::requested()
    };
    let finite = |round, fit: Option<Fit>| match fit.ok_or(LearnError::Interrupted)? {
        fit if fit.loss.is_finite() => Ok(fit),
        _ => Err(LearnError::Diverged { round }),
    };
    let mut fits = vec![finite(0, ensemble.train(dataset, &pairs, &mut going_on))?];
    for round in 1..=config.rounds {
        let mut rng = seed.child(&format!("query/round/{round}")).rng();
        let segments = most_disputed(&ensemble, dataset, &sampler, config.pool, &mut rng);
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

/// Agreement of the ensemble with true returns on pairs that it was not trained on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct HeldOut {
    /// Pairs with different true returns.
    pub pairs: usize,
    /// Share of them that the ensemble's mean return orders as the true return does.
    pub agreement: f64,
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
    let mut rng = seed.child("held-out").rng();
    let pairs: Vec<_> = (0..config.held_out)
        .map(|_| random_pair(&sampler, &mut rng))
        .collect();
    let returns = ensemble.segment_returns(dataset, pairs.as_flattened());
    let mean = |segment: usize| {
        returns
            .iter()
            .map(|member| f64::from(member[segment]))
            .sum::<f64>()
    };
    let (mut strict, mut agree) = (0, 0);
    for (i, pair) in pairs.iter().enumerate() {
        let truth = pair[1].return_true(dataset) - pair[0].return_true(dataset);
        if truth != 0.0 {
            strict += 1;
            agree += usize::from((mean(2 * i + 1) > mean(2 * i)) == (truth > 0.0));
        }
    }
    Ok(HeldOut {
        pairs: strict,
        agreement: agree as f64 / strict.max(1) as f64,
    })
}
