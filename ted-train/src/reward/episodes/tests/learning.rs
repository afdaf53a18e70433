//! From questions to a reward, with teachers of all kinds.

use std::path::Path;

use nalgebra::DVector;

use crate::dataset::Dataset;
use crate::nn::Backend;
use crate::preferences::{
    Answer, Interview, PreferenceError, PreferenceLog, Query, ReplayTeacher, ScriptedTeacher,
    Teacher,
};
use crate::reward::episodes::EpisodesConfig;
use crate::reward::quality::RewardQuality;
use crate::reward::{Labels, LearnError, Learned, Material, RewardLearner};

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
    fn name(&self) -> &str {
        "teacher:odd"
    }

    fn answer(&mut self, dataset: &Dataset, query: &Query) -> Result<Answer, PreferenceError> {
        let truth = ScriptedTeacher::new(0.0)?.answer(dataset, query)?;
        Ok((self.0)(truth))
    }
}

#[test]
fn the_reward_that_a_controller_computes_orders_episodes_as_their_quality_and_their_truth() {
    let dataset = mixed();
    let folder = tempfile::tempdir().unwrap();
    let mut teacher = ScriptedTeacher::new(0.0).unwrap();
    let learned = learn(&config(), &dataset, &mut teacher, &folder.path().join("a")).unwrap();
    assert!(learned.held_out.agreement > 0.7, "{:?}", learned.held_out);
    let raw = learned.model.raw_rewards(&dataset).unwrap();
    let labels = Labels::unit(&dataset, raw);
    let truth = RewardQuality::measure(&dataset, &labels);
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
    let mut teacher = ScriptedTeacher::new(0.0).unwrap();
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

#[test]
fn answers_that_say_nothing_leave_numbers_that_are_numbers() {
    let dataset = mixed();
    for (index, odd) in [(|_| Answer::Equal) as fn(Answer) -> Answer, |_| {
        Answer::First
    }]
    .into_iter()
    .enumerate()
    {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(index.to_string());
        let learned = learn(&config(), &dataset, &mut Odd(odd), &path).unwrap();
        assert!(quality(&learned).iter().all(|q| q.is_finite()));
        let raw = learned.model.raw_rewards(&dataset).unwrap();
        assert!(raw.iter().all(|r| r.is_finite()));
    }
}

#[test]
fn one_episode_alone_cannot_be_compared_and_two_equal_ones_can() {
    let folder = tempfile::tempdir().unwrap();
    let mut teacher = ScriptedTeacher::new(0.0).unwrap();
    let alone = logs(&[1.0]);
    let error = learn(&config(), &alone, &mut teacher, &folder.path().join("a")).unwrap_err();
    assert!(matches!(error, LearnError::TooFewEpisodes), "{error}");
    let two = logs(&[1.0, 1.0]);
    let learned = learn(&config(), &two, &mut teacher, &folder.path().join("b")).unwrap();
    assert!(quality(&learned).iter().all(|q| q.is_finite()));
}
