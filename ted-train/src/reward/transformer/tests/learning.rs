//! What training does, what it asks, and that a stopped training goes on to the bit.

use firmware_sim::progress::Audience;

use crate::dataset::{Dataset, Segment};
use crate::nn::Backend;
use crate::nn::fixtures::bits;
use crate::preferences::{Context, PreferenceLog, ReplayTeacher, ScriptedTeacher, Teacher};
use crate::reward::oprl::LabelledPair;
use crate::reward::transformer::training::Training;
use crate::reward::transformer::{
    Learned, PtConfig, held_out_agreement, learn, transformer_labels,
};
use crate::rng::Seed;
use crate::run::Checkpoint;

use super::{HEADS, SEGMENT, SHAPE, config, dataset, transformer};

fn run(
    config: &PtConfig,
    dataset: &Dataset,
    teacher: &mut dyn Teacher,
    log: &mut PreferenceLog,
    backend: Backend,
) -> Learned {
    let (seed, audience) = (Seed::root(3), Audience::Nobody);
    let save = &mut |_: &str, _: &Checkpoint| Ok(());
    learn(
        config, dataset, teacher, log, seed, backend, None, save, audience,
    )
    .unwrap()
}

fn open(folder: &tempfile::TempDir, dataset: &Dataset) -> PreferenceLog {
    PreferenceLog::open(folder.path().join("log.jsonl"), dataset).unwrap()
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
            let folder = tempfile::tempdir().unwrap();
            let mut log = open(&folder, &dataset);
            let mut teacher = ScriptedTeacher::new(0.0).unwrap();
            let learned = run(&config, &dataset, &mut teacher, &mut log, backend);
            assert!(learned.fit.agreement > 0.95, "{head:?}: {:?}", learned.fit);
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
fn ten_random_pairs_are_asked_about_and_the_log_alone_replays_the_run_to_the_bit() {
    let dataset = dataset();
    let config = config(HEADS[1]);
    let labels = |folder: &tempfile::TempDir, teacher: &mut dyn Teacher| {
        let mut log = open(folder, &dataset);
        let learned = run(&config, &dataset, teacher, &mut log, Backend::Flex);
        let labels = transformer_labels(&dataset, &learned.transformer, Audience::Nobody);
        (log.entries().to_vec(), bits(&labels.unwrap()))
    };
    let [first, second] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    let (asked, expected) = labels(&first, &mut ScriptedTeacher::new(0.0).unwrap());
    assert_eq!(asked.len(), 10);
    let shared = Context {
        round: 0,
        member: None,
    };
    assert!(asked.iter().all(|entry| entry.context == shared));
    let path = first.path().join("log.jsonl");
    let (replayed, actual) = labels(&second, &mut ReplayTeacher::open(path, &dataset).unwrap());
    assert_eq!(replayed, asked);
    assert_eq!(actual, expected);
}

#[test]
fn a_restored_training_goes_on_to_the_bit() {
    let dataset = dataset();
    for head in HEADS {
        let config = config(head);
        let folder = tempfile::tempdir().unwrap();
        let mut log = open(&folder, &dataset);
        let mut teacher = ScriptedTeacher::new(0.0).unwrap();
        let whole = run(&config, &dataset, &mut teacher, &mut log, Backend::Flex);

        // The same by hand, stopped after 23 steps.
        let pairs: Vec<_> = log
            .entries()
            .iter()
            .map(|entry| LabelledPair {
                segments: entry.query.segments,
                label: entry.answer.label(),
            })
            .collect();
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

        let teacher = &mut ReplayTeacher::open(folder.path().join("log.jsonl"), &dataset).unwrap();
        let again = tempfile::tempdir().unwrap();
        let resumed = learn(
            &config,
            &dataset,
            teacher,
            &mut open(&again, &dataset),
            Seed::root(3),
            Backend::Flex,
            Some(&saved),
            &mut |_, _| Ok(()),
            Audience::Nobody,
        )
        .unwrap();
        let labels = |learned: &Learned| {
            bits(&transformer_labels(&dataset, &learned.transformer, Audience::Nobody).unwrap())
        };
        assert_eq!(labels(&resumed), labels(&whole), "{head:?}");
        assert_ne!(saved.step, config.steps);
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
