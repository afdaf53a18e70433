//! What training does, and that a stopped one goes on to the bit.

use firmware_sim::progress::Audience;

use crate::dataset::SegmentSampler;
use crate::nn::Backend;
use crate::nn::fixtures::numbers;
use crate::oppo::{Oppo, OppoConfig, OppoError, Player, learn};
use crate::preferences::{
    Answer, PreferenceError, PreferenceLog, Query, ReplayTeacher, ScriptedTeacher, Teacher,
};
use crate::rng::Seed;
use crate::run::Checkpoint;

use super::{SEGMENT, config, dataset};
use crate::dataset::Dataset;

/// Prefers what the scripted teacher does not.
struct Contrary;

impl Teacher for Contrary {
    fn name(&self) -> &str {
        "contrary"
    }

    fn answer(&mut self, dataset: &Dataset, query: &Query) -> Result<Answer, PreferenceError> {
        let [first, second] = query.segments;
        let turned = Query {
            segments: [second, first],
        };
        ScriptedTeacher::new(0.0)?.answer(dataset, &turned)
    }
}

#[test]
fn the_policy_goes_the_way_that_is_preferred() {
    let dataset = dataset();
    let config = OppoConfig {
        width: 16,
        layers: 1,
        steps: 300,
        learning_rate: 3e-3,
        latent_rate: 3e-2,
        ..config()
    };
    let mean_action = |teacher: &mut dyn Teacher| {
        let folder = tempfile::tempdir().unwrap();
        let mut log = PreferenceLog::open(folder.path().join("log.jsonl"), &dataset).unwrap();
        let learned = learn(
            &config,
            &dataset,
            teacher,
            &mut log,
            Seed::root(1),
            Backend::Flex,
            None,
            &mut |_| Ok(()),
            Audience::Nobody,
        )
        .unwrap();
        assert_eq!(log.entries().len(), 10);
        let mut player = Player::new(&learned.oppo);
        // Longer than a clip, and than the longest episode.
        let actions = (0..9).map(|i| player.act(&numbers(2, &format!("seen/{i}")))[0]);
        actions.sum::<f32>() / 9.0
    };
    let up = mean_action(&mut ScriptedTeacher::new(0.0).unwrap());
    let down = mean_action(&mut Contrary);
    assert!(up > 0.25 && down < -0.25, "{up} and {down}");
}

#[test]
fn a_restored_learner_goes_on_to_the_bit() {
    let dataset = dataset();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.jsonl");
    let run = |teacher: &mut dyn Teacher, name: &str, saved: Option<&Checkpoint>| {
        let mut log = PreferenceLog::open(folder.path().join(name), &dataset).unwrap();
        let learned = learn(
            &config(),
            &dataset,
            teacher,
            &mut log,
            Seed::root(3),
            Backend::Flex,
            saved,
            &mut |_| Ok(()),
            Audience::Nobody,
        )
        .unwrap();
        learned.oppo.checkpoint()
    };
    let whole = run(&mut ScriptedTeacher::new(0.0).unwrap(), "log.jsonl", None);
    let log = PreferenceLog::open(&path, &dataset).unwrap();
    let pairs: Vec<_> = log
        .entries()
        .iter()
        .map(|entry| crate::reward::oprl::LabelledPair {
            segments: entry.query.segments,
            label: entry.answer.label(),
        })
        .collect();
    let sampler = SegmentSampler::new(&dataset, SEGMENT).unwrap();
    // After an odd and an even number of updates.
    for updates in [7, 12] {
        let mut stopped = Oppo::new(&config(), &dataset, Seed::root(3), Backend::Flex);
        for _ in 0..updates {
            stopped.update(&dataset, &sampler, &pairs);
        }
        let saved = stopped.checkpoint();
        let teacher = &mut ReplayTeacher::open(&path, &dataset).unwrap();
        let resumed = run(teacher, &format!("{updates}.jsonl"), Some(&saved));
        assert!(resumed == whole, "after {updates} updates");
    }
}

#[test]
fn a_saved_state_of_another_learner_is_refused() {
    let dataset = dataset();
    let saved = Oppo::new(&config(), &dataset, Seed::root(3), Backend::Flex).checkpoint();
    let other = OppoConfig {
        latent: 4,
        ..config()
    };
    let folder = tempfile::tempdir().unwrap();
    let mut log = PreferenceLog::open(folder.path().join("log.jsonl"), &dataset).unwrap();
    let refused = learn(
        &other,
        &dataset,
        &mut Contrary,
        &mut log,
        Seed::root(3),
        Backend::Flex,
        Some(&saved),
        &mut |_| Ok(()),
        Audience::Nobody,
    );
    assert!(matches!(refused, Err(OppoError::Foreign(_))));
}
