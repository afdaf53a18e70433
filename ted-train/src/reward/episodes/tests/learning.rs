//! From questions to a reward, with teachers of all kinds.

use std::path::Path;

use nalgebra::DVector;

use crate::dataset::{Dataset, EpisodeRecord};
use crate::nn::Backend;
use crate::preferences::{
    Answer, Interview, LogEntry, PreferenceError, PreferenceLog, Question, ReplayTeacher, Said,
    Says, ScriptedTeacher, Teacher, TeacherConfig, Untold,
};
use crate::reward::episodes::EpisodesConfig;
use crate::reward::quality::RewardQuality;
use crate::reward::{Labels, LearnError, Learned, Material, RewardLearner};
use crate::rng::Seed;

use super::looks::material;
use super::{KNOWING, config, logs, mixed};

fn learn(
    config: &EpisodesConfig,
    dataset: &Dataset,
    teacher: &mut dyn Teacher,
    path: &Path,
) -> Result<Learned, LearnError> {
    let log = PreferenceLog::open(path, dataset).unwrap();
    let mut interview = Interview::new(dataset, teacher, log);
    let on = Material {
        backend: Backend::Fused,
        ..material(dataset)
    };
    let answers = config.ask(on, &mut interview)?;
    config.learn(&answers, on, &mut interview, &mut |_| Ok(()))
}

fn quality(learned: &Learned) -> Vec<f32> {
    let crate::reward::RewardModel::Episodes(model) = &learned.model else {
        panic!("a model of episodes");
    };
    model.quality.clone()
}

/// Says the opposite of the truth, or the same always.
struct Odd(fn(Answer) -> Answer);

impl Teacher for Odd {
    fn answer(
        &mut self,
        dataset: &Dataset,
        asked: &[LogEntry],
        question: &Question,
    ) -> Result<Said, PreferenceError> {
        let truth = ScriptedTeacher::truthful().answer(dataset, asked, question)?;
        Ok(Said {
            answer: truth.answer.map(self.0),
            later: false,
            by: "teacher:odd".to_owned(),
            ..truth
        })
    }
}

#[test]
fn the_reward_that_a_controller_computes_orders_episodes_as_their_quality_and_their_truth() {
    let dataset = mixed();
    let folder = tempfile::tempdir().unwrap();
    let mut teacher = ScriptedTeacher::truthful();
    let learned = learn(&config(), &dataset, &mut teacher, &folder.path().join("a")).unwrap();
    assert!(learned.held_out.agreement > 0.7, "{:?}", learned.held_out);
    let raw = learned.model.raw_rewards(&dataset).unwrap();
    let labels = Labels::unit(&dataset, raw);
    let truth = RewardQuality::measure(&dataset, &labels).unwrap();
    assert!(truth.spearman > 0.5, "{truth:?}");
    let quality = DVector::from_iterator(60, quality(&learned).into_iter().map(f64::from));
    let returns = DVector::from_iterator(60, labels.returns_hat.iter().copied().map(f64::from));
    let [q, r] = [quality, returns].map(|it| it.add_scalar(-it.mean()));
    let correlation = q.dot(&r) / (q.norm() * r.norm());
    assert!(correlation > 0.95, "{correlation}");
    let confidence = learned.model.confidence().unwrap();
    assert!(
        confidence.leaves_the_logs && confidence.answers == 10,
        "{confidence:?}"
    );
}

#[test]
fn the_log_alone_gives_the_same_model_and_no_question_is_asked_twice() {
    let dataset = mixed();
    let folder = tempfile::tempdir().unwrap();
    let [first, second] = ["a", "b"].map(|name| folder.path().join(name));
    let mut teacher = ScriptedTeacher::truthful();
    let straight = learn(&config(), &dataset, &mut teacher, &first).unwrap();
    let mut replay = ReplayTeacher::open(&first, &dataset).unwrap();
    let replayed = learn(&config(), &dataset, &mut replay, &second).unwrap();
    assert_eq!(quality(&straight), quality(&replayed));
    assert_eq!(
        std::fs::read(&first).unwrap(),
        std::fs::read(&second).unwrap()
    );
    // A second run on the same log asks nobody.
    let again = learn(&config(), &dataset, &mut Odd(|_| Answer::Equal), &first).unwrap();
    assert_eq!(quality(&straight), quality(&again));
}

#[test]
fn without_a_question_the_competent_are_held_to_be_the_best() {
    let dataset = mixed();
    let folder = tempfile::tempdir().unwrap();
    let config = EpisodesConfig {
        queries: 0,
        ..config()
    };
    let mut teacher = Odd(|answer| answer);
    let learned = learn(&config, &dataset, &mut teacher, &folder.path().join("a")).unwrap();
    let quality = quality(&learned);
    let knowing = quality[..KNOWING]
        .iter()
        .copied()
        .fold(f32::INFINITY, f32::min);
    let other = quality[KNOWING..]
        .iter()
        .copied()
        .fold(f32::NEG_INFINITY, f32::max);
    assert!(knowing > other, "{knowing} {other}");
}

#[test]
fn where_nothing_is_believed_beforehand_answers_decide_the_order_and_reversed_ones_reverse_it() {
    let dataset = mixed();
    let folder = tempfile::tempdir().unwrap();
    let config = EpisodesConfig {
        competence: 0.0,
        competence_std: 2.0,
        direction_std: 0.0,
        ..config()
    };
    let agreement = |turn: fn(Answer) -> Answer, name: &str| {
        let path = folder.path().join(name);
        let learned = learn(&config, &dataset, &mut Odd(turn), &path).unwrap();
        learned.held_out.agreement
    };
    let straight = agreement(|answer| answer, "straight");
    let reversed = agreement(
        |answer| match answer {
            Answer::First => Answer::Second,
            Answer::Second => Answer::First,
            Answer::Equal => Answer::Equal,
        },
        "reversed",
    );
    assert!(straight > 0.6 && reversed < 0.4, "{straight} {reversed}");
}

/// Fails unless everything that is left is a number.
#[track_caller]
fn assert_numbers(learned: &Learned, dataset: &Dataset) {
    assert!(quality(learned).iter().all(|it| it.is_finite()));
    let raw = learned.model.raw_rewards(dataset).unwrap();
    assert!(raw.iter().all(|it| it.is_finite()));
    let confidence = learned.model.confidence().unwrap();
    let [low, high] = confidence.range;
    let numbers = [confidence.gain, low, high, confidence.better];
    assert!(numbers.iter().all(|it| it.is_finite()), "{confidence:?}");
    assert!(learned.fits.iter().all(|fit| fit.loss.is_finite()));
}

fn teacher(config: TeacherConfig) -> ScriptedTeacher {
    ScriptedTeacher::new(config, Seed::root(6))
}

#[test]
fn answers_that_say_nothing_or_contradict_each_other_leave_numbers_that_are_numbers() {
    let dataset = mixed();
    for says in [Says::Equal, Says::First, Says::Random, Says::Reversed] {
        let folder = tempfile::tempdir().unwrap();
        let mut teacher = teacher(TeacherConfig {
            says,
            ..TeacherConfig::default()
        });
        let learned = learn(&config(), &dataset, &mut teacher, &folder.path().join("a")).unwrap();
        assert_numbers(&learned, &dataset);
    }
}

#[test]
fn logs_in_which_nothing_differs_leave_numbers_and_a_policy_that_stays_with_them() {
    let mut rewarded = 0.0;
    let mut still = || EpisodeRecord {
        observations: vec![0.25; super::SHAPE.observation * 31],
        actions: vec![0.5; 30],
        rewards: (0..30)
            .map(|_| {
                rewarded += 0.01;
                rewarded
            })
            .collect(),
        terminations: vec![false; 30],
        truncations: (1..=30).map(|step| step == 30).collect(),
        success: vec![false; 30],
        ..EpisodeRecord::default()
    };
    let episodes: Vec<_> = (0..5).map(|_| still()).collect();
    let still = Dataset::from_records("ted/still-v0", super::SHAPE, &episodes).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a");
    let mut truthful = ScriptedTeacher::truthful();
    let learned = learn(&config(), &still, &mut truthful, &path).unwrap();
    assert_numbers(&learned, &still);
    let confidence = learned.model.confidence().unwrap();
    assert!(!confidence.leaves_the_logs, "{confidence:?}");
    let words = confidence.in_words();
    assert!(words.ends_with("so answers cannot help"), "{words}");
    // Nobody says of a question what its answer cannot say.
    let log = std::fs::read_to_string(path).unwrap();
    assert!(!log.contains("counts"), "{log}");
}

#[test]
fn a_pair_that_nobody_can_tell_apart_is_asked_about_once_and_costs_no_answer() {
    let dataset = mixed();
    let folder = tempfile::tempdir().unwrap();
    let [straight, resumed, replayed] = ["a", "b", "c"].map(|name| folder.path().join(name));
    let half = TeacherConfig {
        cannot_tell: 0.5,
        ..TeacherConfig::default()
    };
    let of = |path: &Path| learn(&config(), &dataset, &mut teacher(half), path).unwrap();
    let learned = of(&straight);
    assert_eq!(learned.model.confidence().unwrap().answers, 10);
    let entries = PreferenceLog::read(&straight, &dataset).unwrap();
    let told = entries.iter().filter(|entry| entry.said.answer.is_some());
    assert_eq!(told.count(), 10);
    assert!(entries.len() > 10, "{}", entries.len());
    for (at, entry) in entries.iter().enumerate() {
        let segments = entry.question.query.segments;
        assert!(!Untold::of(&entries[..at]).contains(segments), "{at}");
        assert!(entry.question.why.is_some());
    }
    // Stopped after five questions, whatever was said to them.
    let text = std::fs::read_to_string(&straight).unwrap();
    let five: String = text.split_inclusive('\n').take(5).collect();
    std::fs::write(&resumed, five).unwrap();
    assert_eq!(quality(&of(&resumed)), quality(&learned));
    assert_eq!(std::fs::read_to_string(&resumed).unwrap(), text);
    let mut replay = ReplayTeacher::open(&straight, &dataset).unwrap();
    let again = learn(&config(), &dataset, &mut replay, &replayed).unwrap();
    assert_eq!(quality(&again), quality(&learned));
    assert_eq!(std::fs::read_to_string(&replayed).unwrap(), text);
}

#[test]
fn where_nobody_can_tell_anything_the_questions_end_with_a_word_about_it() {
    let folder = tempfile::tempdir().unwrap();
    let mut silent = teacher(TeacherConfig {
        cannot_tell: 1.0,
        ..TeacherConfig::default()
    });
    for (dataset, questions) in [(mixed(), 10), (logs(&[1.0, 0.5]), 1)] {
        let path = folder.path().join(questions.to_string());
        for _ in 0..2 {
            let error = learn(&config(), &dataset, &mut silent, &path).unwrap_err();
            let said = format!("{questions} of {questions} questions got no answer");
            assert!(error.to_string().starts_with(&said), "{error}");
            let kept = PreferenceLog::read(&path, &dataset).unwrap();
            assert_eq!(kept.len(), questions, "nothing is lost or asked again");
        }
    }
}

#[test]
fn one_episode_alone_cannot_be_compared_and_two_equal_ones_can() {
    let folder = tempfile::tempdir().unwrap();
    let mut teacher = ScriptedTeacher::truthful();
    let alone = logs(&[1.0]);
    let error = learn(&config(), &alone, &mut teacher, &folder.path().join("a")).unwrap_err();
    assert!(matches!(error, LearnError::TooFewEpisodes), "{error}");
    let two = logs(&[1.0, 1.0]);
    let learned = learn(&config(), &two, &mut teacher, &folder.path().join("b")).unwrap();
    assert!(quality(&learned).iter().all(|q| q.is_finite()));
}
