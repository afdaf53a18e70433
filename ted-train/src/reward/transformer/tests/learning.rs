//! What training does, and that a stopped training goes on to the bit.

use firmware_sim::progress::Audience;

use crate::dataset::{Dataset, Segment};
use crate::nn::Backend;
use crate::nn::fixtures::bits;
use crate::preferences::{Interview, LabelledPair, PreferenceLog, ScriptedTeacher};
use crate::reward::transformer::training::Training;
use crate::reward::transformer::{
    PtConfig, Trained, held_out_agreement, train, transformer_labels,
};
use crate::reward::{Material, RewardLearner, Saved};
use crate::rng::Seed;

use super::{HEADS, SEGMENT, SHAPE, config, dataset, transformer};

fn answers(config: &PtConfig, dataset: &Dataset) -> Vec<LabelledPair> {
    let folder = tempfile::tempdir().unwrap();
    let log = PreferenceLog::open(folder.path().join("log.jsonl"), dataset).unwrap();
    let mut teacher = ScriptedTeacher::truthful();
    let mut interview = Interview::new(dataset, &mut teacher, log);
    config
        .ask(on(dataset, Backend::Flex), &mut interview)
        .unwrap()
}

fn on(dataset: &Dataset, backend: Backend) -> Material<'_> {
    Material {
        dataset,
        seed: Seed::root(3),
        backend,
        audience: Audience::Nobody,
    }
}

fn run(
    config: &PtConfig,
    dataset: &Dataset,
    pairs: &[LabelledPair],
    backend: Backend,
    saved: Option<Saved>,
) -> Trained {
    let on = on(dataset, backend);
    train(config, pairs, on, saved, &mut |_| Ok(())).unwrap()
}

#[test]
fn with_many_answers_clips_are_ordered_that_nobody_was_asked_about() {
    let dataset = dataset();
    for head in HEADS {
        let config = PtConfig {
            queries: 60,
            width: 16,
            steps: 150,
            ..config(head)
        };
        for backend in [Backend::Flex, Backend::Ndarray] {
            let pairs = answers(&config, &dataset);
            let learned = run(&config, &dataset, &pairs, backend, None);
            assert!(
                learned.fits[0].agreement > 0.95,
                "{head:?}: {:?}",
                learned.fits
            );
            let agreement = |transformer: &super::RewardTransformer| {
                held_out_agreement(&config, transformer, &dataset, Seed::root(3)).unwrap()
            };
            let fresh = agreement(&transformer(&config, &dataset, backend));
            assert!(fresh.agreement < 0.7, "{head:?}, untrained: {fresh:?}");
            let trained = agreement(&learned.transformer);
            assert!(trained.agreement > 0.75, "{head:?}: {trained:?}");
        }
    }
}

#[test]
fn a_restored_training_goes_on_to_the_bit() {
    let dataset = dataset();
    for head in HEADS {
        let config = config(head);
        let pairs = answers(&config, &dataset);
        let whole = run(&config, &dataset, &pairs, Backend::Flex, None);

        // The same by hand, stopped after 23 steps.
        let statistics = dataset.observation_statistics();
        let fresh = |seed| {
            let transformer = super::RewardTransformer::new(
                &config,
                &statistics,
                SHAPE.action,
                seed,
                Backend::Flex,
            );
            Training::new(&config, transformer, &dataset, &pairs, Seed::root(3))
        };
        let mut stopped = fresh(Seed::root(3));
        (0..23).for_each(|_| {
            stopped.update();
        });
        let saved = stopped.checkpoint();
        let mut other_weights = fresh(Seed::root(4));
        other_weights.restore(&saved).unwrap();
        assert_eq!(other_weights.checkpoint(), saved);
        drop(other_weights);

        assert_ne!(saved.step, config.steps);
        let saved = Saved {
            checkpoint: saved,
            fits: Vec::new(),
        };
        let resumed = run(&config, &dataset, &pairs, Backend::Flex, Some(saved));
        assert_eq!((resumed.fits.len(), &resumed.fits), (1, &whole.fits));
        let labels = |learned: &Trained| {
            bits(&transformer_labels(&dataset, &learned.transformer, Audience::Nobody).unwrap())
        };
        assert_eq!(labels(&resumed), labels(&whole), "{head:?}");
    }
}

#[test]
fn a_saved_state_of_another_transformer_is_refused() {
    let dataset = dataset();
    let small = config(HEADS[0]);
    let large = PtConfig {
        width: 16,
        ..small.clone()
    };
    let segments = [0, 1].map(|episode| Segment::new(&dataset, episode, 0, SEGMENT).unwrap());
    let pairs = [LabelledPair {
        segments,
        label: 1.0,
    }];
    let training = |config| {
        let transformer = transformer(config, &dataset, Backend::Flex);
        Training::new(config, transformer, &dataset, &pairs, Seed::root(1))
    };
    let saved = training(&small).checkpoint();
    assert!(training(&large).restore(&saved).is_err());
}
