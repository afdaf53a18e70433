//! Which questions are asked: the most disputed ones, and ten in all.

use rand::RngExt;

use crate::dataset::{Clip, Dataset, Segment, SegmentSampler, fixtures};
use crate::nn::Backend;
use crate::nn::fixtures::tensor;
use crate::nn::{Activation, Linear, Mlp};
use crate::preferences::{
    Answer, Context, LogEntry, PreferenceError, QueryStrategy, Question, RandomPair, ReplayTeacher,
    Said, ScriptedTeacher, Teacher, Untold,
};
use crate::reward::RewardLearner;
use crate::reward::oprl::{Ensemble, MostDisputed, OprlConfig};
use crate::rng::Seed;

use super::{SEGMENT, SHAPE, config, dataset, ensemble, learn};

const POOL: usize = 40;

/// An ensemble of linear rewards: member `m` likes the observation's channel `m`.
fn linear(dataset: &Dataset, likes: &[[f32; 3]]) -> Ensemble {
    let config = OprlConfig {
        members: likes.len(),
        hidden: vec![],
        ..config()
    };
    let mut ensemble = ensemble(&config, dataset, Backend::Flex);
    let weights: Vec<f32> = likes
        .iter()
        .flat_map(|w| [&w[..], &[0.0; SHAPE.action]].concat())
        .collect();
    let inputs = SHAPE.observation + SHAPE.action;
    let layer = Linear {
        weight: tensor(&weights, [likes.len(), inputs, 1], Backend::Flex),
        bias: tensor(&vec![0.0; likes.len()], [likes.len(), 1, 1], Backend::Flex),
    };
    ensemble.network = Mlp::from_layers(vec![layer], Activation::Linear, Backend::Flex);
    ensemble
}

fn most_disputed<'a>(ensemble: &'a Ensemble, dataset: &'a Dataset) -> MostDisputed<'a> {
    MostDisputed {
        ensemble,
        dataset,
        pool: POOL,
    }
}

/// p (1 - p) by plain sums over the segments' observations.
fn dispute(dataset: &Dataset, likes: &[[f32; 3]], pair: &[Segment; 2]) -> f64 {
    let score = |w: &[f32; 3], segment: &Segment| -> f64 {
        segment
            .steps(dataset)
            .flat_map(|step| dataset.observation(step).iter().zip(w))
            .map(|(x, w)| f64::from(*x) * f64::from(*w))
            .sum()
    };
    let second = likes
        .iter()
        .filter(|w| score(w, &pair[1]) > score(w, &pair[0]))
        .count();
    let p = second as f64 / likes.len() as f64;
    p * (1.0 - p)
}

#[test]
fn the_question_is_one_with_the_largest_dispute_of_the_pool() {
    let dataset = dataset();
    let sampler = SegmentSampler::new(&dataset, Clip::Steps(SEGMENT)).unwrap();
    let likes = [
        [1.0, 0.0, 0.0],
        [0.9, 0.3, 0.0],
        [0.8, 0.0, 0.5],
        [1.0, -0.4, 0.2],
        [0.7, 0.5, -0.3],
    ];
    let ensemble = linear(&dataset, &likes);
    let mut unanimous = 0;
    for seed in 0..20 {
        let stream = Seed::root(seed);
        let mut rng = stream.rng();
        let pool: Vec<_> = (0..POOL)
            .map(|_| RandomPair.draw(&sampler, &mut rng))
            .collect();
        let disputes: Vec<f64> = pool.iter().map(|p| dispute(&dataset, &likes, p)).collect();
        unanimous += disputes.iter().filter(|&&d| d == 0.0).count();
        let chosen = most_disputed(&ensemble, &dataset);
        let chosen = chosen.choose(&sampler, Untold::of(&[]), &mut stream.rng());
        let chosen = chosen.unwrap();
        assert!(pool.contains(&chosen), "the pool is the stream's");
        let largest = disputes.iter().copied().fold(0.0, f64::max);
        assert_eq!(dispute(&dataset, &likes, &chosen), largest, "seed {seed}");
    }
    assert!(
        unanimous > 20 * POOL / 4,
        "a random pair would often do worse"
    );
}

#[test]
fn among_equals_the_stream_draws() {
    let dataset = dataset();
    let sampler = SegmentSampler::new(&dataset, Clip::Steps(SEGMENT)).unwrap();
    // One member never disagrees with itself: all pairs tie.
    let ensemble = linear(&dataset, &[[1.0, 0.0, 0.0]]);
    let place = |seed: u64| {
        let mut rng = Seed::root(seed).rng();
        let chosen = most_disputed(&ensemble, &dataset);
        let chosen = chosen.choose(&sampler, Untold::of(&[]), &mut Seed::root(seed).rng());
        let chosen = chosen.unwrap();
        let pool: Vec<_> = (0..POOL)
            .map(|_| RandomPair.draw(&sampler, &mut rng))
            .collect();
        assert_eq!(chosen, pool[rng.random_range(0..POOL)]);
        pool.iter().position(|pair| *pair == chosen).unwrap()
    };
    let mut places: Vec<usize> = (0..20).map(place).collect();
    places.sort_unstable();
    places.dedup();
    assert!(places.len() > 5, "not always the same place: {places:?}");
}

/// Counts the questions that somebody else answers.
struct Counting<T> {
    teacher: T,
    asked: usize,
}

impl<T: Teacher> Teacher for Counting<T> {
    fn answer(
        &mut self,
        dataset: &Dataset,
        asked: &[LogEntry],
        question: &Question,
    ) -> Result<Said, PreferenceError> {
        self.asked += 1;
        self.teacher.answer(dataset, asked, question)
    }
}

#[test]
fn ten_questions_are_asked_seven_of_one_member_and_three_of_all() {
    let dataset = dataset();
    let folder = tempfile::tempdir().unwrap();
    let mut teacher = Counting {
        teacher: ScriptedTeacher::truthful(),
        asked: 0,
    };
    let config = config();
    let seed = Seed::root(2);
    let log = folder.path().join("log.jsonl");
    let (learned, entries) = learn(&config, &dataset, &mut teacher, &log, seed, Backend::Flex);
    assert_eq!((teacher.asked, config.queries()), (10, 10));
    let contexts: Vec<_> = entries.iter().map(|entry| entry.question.context).collect();
    let own = (0..7).map(|m| Context {
        round: 0,
        member: Some(m),
    });
    let shared = (1..=3).map(|round| Context {
        round,
        member: None,
    });
    assert_eq!(contexts, own.chain(shared).collect::<Vec<_>>());
    assert_eq!(learned.fits.len(), 4);
}

#[test]
fn whole_episodes_are_asked_about_and_learned_from_where_all_are_as_long_as_each_other() {
    let dataset = dataset();
    let folder = tempfile::tempdir().unwrap();
    let mut teacher = ScriptedTeacher::truthful();
    let config = OprlConfig {
        segment: Clip::Episode,
        ..config()
    };
    config.check(&dataset).unwrap();
    let log = folder.path().join("log.jsonl");
    let seed = Seed::root(2);
    let (learned, entries) = learn(&config, &dataset, &mut teacher, &log, seed, Backend::Flex);
    let mut segments = entries
        .iter()
        .flat_map(|entry| entry.question.query.segments);
    assert!(segments.all(|it| (it.start(), it.len()) == (0, 9)));
    assert!(learned.fits.iter().all(|fit| fit.loss.is_finite()));

    let unequal = fixtures::records(&[9, 8]);
    let unequal = Dataset::from_records("ted/x-v0", fixtures::SHAPE, &unequal).unwrap();
    let refused = config.check(&unequal).unwrap_err().to_string();
    assert!(refused.contains("episodes have 8 to 9 steps"), "{refused}");
}

#[test]
fn a_shared_answer_is_learned_by_every_member() {
    let dataset = dataset();
    let folder = tempfile::tempdir().unwrap();
    let mut teacher = ScriptedTeacher::truthful();
    let config = OprlConfig {
        epochs: 150,
        ..config()
    };
    let seed = Seed::root(2);
    let log = folder.path().join("log.jsonl");
    let (learned, entries) = learn(&config, &dataset, &mut teacher, &log, seed, Backend::Flex);
    for entry in &entries[7..] {
        let returns = learned
            .ensemble
            .segment_returns(&dataset, &entry.question.query.segments);
        for (member, r) in returns.iter().enumerate() {
            let prefers_second = r[1] > r[0];
            let wanted = entry.said.answer == Some(Answer::Second);
            assert_eq!(prefers_second, wanted, "member {member}, {entry:?}");
        }
    }
}

#[test]
fn the_log_alone_replays_the_run_to_the_bit() {
    let dataset = dataset();
    let folder = tempfile::tempdir().unwrap();
    let run = |name: &str, teacher: &mut dyn Teacher| {
        let path = folder.path().join(name);
        let (learned, _) = learn(
            &config(),
            &dataset,
            teacher,
            &path,
            Seed::root(2),
            Backend::Flex,
        );
        (std::fs::read(&path).unwrap(), learned.ensemble.exported())
    };
    let (log, ensemble) = run("first.jsonl", &mut ScriptedTeacher::truthful());
    let mut replay = ReplayTeacher::open(folder.path().join("first.jsonl"), &dataset).unwrap();
    let (copy, replayed) = run("second.jsonl", &mut replay);
    assert_eq!(copy, log);
    assert_eq!(replayed, ensemble);
    // The answers matter: somebody who says the opposite gets another ensemble.
    let (_, contrary) = run("third.jsonl", &mut Contrary);
    assert_ne!(contrary, ensemble);
}

/// Prefers what the scripted teacher does not.
struct Contrary;

impl Teacher for Contrary {
    fn answer(
        &mut self,
        dataset: &Dataset,
        asked: &[LogEntry],
        question: &Question,
    ) -> Result<Said, PreferenceError> {
        let truth = ScriptedTeacher::truthful().answer(dataset, asked, question)?;
        Ok(Said {
            answer: truth.answer.map(Answer::turned),
            later: false,
            by: "contrary".to_owned(),
            ..truth
        })
    }
}
