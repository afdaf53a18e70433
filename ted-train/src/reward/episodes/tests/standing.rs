//! What answers did so far, from their log alone.

use std::path::Path;

use crate::dataset::Dataset;
use crate::preferences::{
    Answer, Interview, LogEntry, PreferenceLog, Said, ScriptedTeacher, Teacher,
};
use crate::reward::episodes::EpisodesConfig;
use crate::reward::{RewardLearner, RewardModel, Standing};

use super::looks::material;
use super::{KNOWING, config, mixed};

/// What somebody says who knows the truth.
fn said(dataset: &Dataset, path: &Path) -> Vec<LogEntry> {
    let log = PreferenceLog::open(path, dataset).unwrap();
    let teacher: &mut dyn Teacher = &mut ScriptedTeacher::truthful();
    let mut interview = Interview::new(dataset, teacher, log);
    let config = config();
    let questions = config.questions(material(dataset)).unwrap();
    questions.ask(&mut interview, config.queries).unwrap();
    interview.entries().to_vec()
}

fn standing(config: &EpisodesConfig, dataset: &Dataset, said: &[LogEntry]) -> Standing {
    let questions = config.questions(material(dataset)).unwrap();
    questions.standing(said).unwrap()
}

#[test]
fn it_is_what_the_reward_is_learned_from_to_the_bit() {
    let dataset = mixed();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log");
    let said = said(&dataset, &path);
    let log = PreferenceLog::open(&path, &dataset).unwrap();
    let mut nobody = ScriptedTeacher::truthful();
    let mut interview = Interview::new(&dataset, &mut nobody, log);
    let save = &mut |_: &_| Ok(());
    let learned = config().learn(&[], material(&dataset), &mut interview, save);
    let RewardModel::Episodes(model) = learned.unwrap().model else {
        panic!("a model of episodes");
    };
    let standing = standing(&config(), &dataset, &said);
    assert_eq!(standing.confidence, model.confidence);
    let order = standing.ranking.iter();
    let order: Vec<usize> = order.map(|it| it.segment.episode() as usize).collect();
    let quality: Vec<f32> = order.iter().map(|&it| model.quality[it]).collect();
    assert!(quality.is_sorted_by(|one, other| one >= other));
    assert_eq!(order.len(), dataset.episodes().len());
    let mut knowing = order[..KNOWING].to_vec();
    knowing.sort_unstable();
    assert_eq!(knowing, Vec::from_iter(0..KNOWING));
    // In deviations from the mean.
    let above: Vec<f64> = standing.ranking.iter().map(|it| it.above).collect();
    let squares: f64 = above.iter().map(|it| it * it).sum();
    assert!(above.iter().sum::<f64>().abs() < 1e-6);
    assert!((squares / above.len() as f64 - 1.0).abs() < 0.02);
}

#[test]
fn an_answer_that_the_others_speak_against_is_a_slip_in_its_place_in_the_log() {
    let dataset = mixed();
    let folder = tempfile::tempdir().unwrap();
    let mut said = said(&dataset, &folder.path().join("log"));
    let straight = standing(&config(), &dataset, &said);
    let above = |episode: u32| {
        let mut ranking = straight.ranking.iter();
        let found = ranking.find(|it| it.segment.episode() == episode);
        found.unwrap().above
    };
    let clearest = (0..said.len()).filter(|place| !straight.slips.contains(place));
    let clearest = clearest.max_by(|&one, &other| {
        let apart = |place: usize| {
            let [first, second] = said[place].question.query.segments;
            (above(first.episode()) - above(second.episode())).abs()
        };
        apart(one).total_cmp(&apart(other))
    });
    let turned = clearest.unwrap();
    said[turned].said.answer = said[turned].said.answer.map(Answer::turned);
    // Whoever could not tell says nothing, but has a place.
    let silent = LogEntry {
        said: Said {
            answer: None,
            ..said[0].said.clone()
        },
        ..said[0].clone()
    };
    said.insert(0, silent);
    let wrong = standing(&config(), &dataset, &said);
    assert!(wrong.slips.contains(&(turned + 1)), "{:?}", wrong.slips);
    let Standing {
        confidence, slips, ..
    } = &wrong;
    assert_eq!(confidence.answers, config().queries);
    assert_eq!(confidence.agreeing + slips.len(), confidence.answers);
}

#[test]
fn answers_against_what_was_believed_move_the_ranking_and_no_answer_moves_nothing() {
    let dataset = mixed();
    let folder = tempfile::tempdir().unwrap();
    let mut said = said(&dataset, &folder.path().join("log"));
    let moved = |config: &EpisodesConfig, said: &[LogEntry]| {
        let standing = standing(config, &dataset, said);
        standing.like_before
    };
    let [nothing, straight] = [&[][..], &said].map(|it| moved(&config(), it).unwrap());
    assert!(nothing > 0.95, "{nothing}");
    for entry in &mut said {
        entry.said.answer = entry.said.answer.map(Answer::turned);
    }
    let reversed = moved(&config(), &said).unwrap();
    assert!(reversed < straight - 0.2, "{reversed} {straight}");
    let unbelieving = EpisodesConfig {
        competence: 0.0,
        ..config()
    };
    assert_eq!(moved(&unbelieving, &said), None);
}
