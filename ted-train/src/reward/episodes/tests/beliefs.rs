//! What is believed before and after answers, and what is asked.

use std::collections::HashSet;

use nalgebra::{DMatrix, DVector};

use crate::dataset::{Clip, Segment, SegmentSampler};
use crate::preferences::{Answer, Context, LogEntry, Query, QueryStrategy, Question, Said, Untold};
use crate::reward::episodes::EpisodesConfig;
use crate::reward::episodes::confidence::Confidence;
use crate::reward::episodes::interrogation::whole_episodes;
use crate::reward::episodes::posterior::{Evidence, Prior, posterior};
use crate::reward::episodes::questions::MostInformative;
use crate::rng::Seed;

use super::logs;

fn prior() -> Prior {
    Prior::new(&EpisodesConfig::default(), &[1.0, 1.0])
}

fn believed(evidence: &Evidence, samples: usize) -> DMatrix<f64> {
    let config = EpisodesConfig {
        samples,
        ..EpisodesConfig::default()
    };
    posterior(&config, &prior(), evidence, Seed::root(5))
}

fn said(answers: &[([f64; 2], f32)]) -> Evidence {
    let mut evidence = Evidence::default();
    for &(difference, label) in answers {
        evidence.push(DVector::from_row_slice(&difference), label);
    }
    evidence
}

#[test]
fn without_answers_the_samples_are_those_of_what_was_believed_beforehand() {
    let samples = believed(&Evidence::default(), 4000);
    let (mean, variance) = (samples.row_mean(), samples.row_variance());
    for (j, [m, s]) in [[2.0, 1.0], [0.0, 0.5]].into_iter().enumerate() {
        assert!((mean[j] - m).abs() < 0.08, "mean {j}: {}", mean[j]);
        assert!((variance[j].sqrt() - s).abs() < 0.05, "deviation {j}");
    }
}

#[test]
fn the_samples_have_the_mean_that_summing_over_a_grid_gives() {
    let evidence = said(&[([0.5, 1.0], 0.0), ([-0.3, 0.8], 0.0), ([1.0, 0.2], 1.0)]);
    let (config, prior) = (EpisodesConfig::default(), prior());
    let (mut total, mut sums) = (0.0, [0.0; 2]);
    for i in -80..=80 {
        for j in -80..=80 {
            let w = [2.0 + f64::from(i) * 0.05, f64::from(j) * 0.025];
            let far = (0..2).map(|k| ((w[k] - prior.mean[k]) / prior.std[k]).powi(2));
            let mut weight = (-0.5 * far.sum::<f64>()).exp();
            for (difference, label) in evidence.differences.iter().zip(&evidence.labels) {
                let u = w[0] * difference[0] + w[1] * difference[1];
                let sure = 1.0 / (1.0 + (-config.slope * u).exp());
                let p = config.lapse / 2.0 + (1.0 - config.lapse) * sure;
                weight *= if *label == 1.0 { p } else { 1.0 - p };
            }
            total += weight;
            sums[0] += weight * w[0];
            sums[1] += weight * w[1];
        }
    }
    let mean = believed(&evidence, 6000).row_mean();
    for k in 0..2 {
        let exact = sums[k] / total;
        assert!((mean[k] - exact).abs() < 0.06, "{k}: {} {exact}", mean[k]);
    }
}

#[test]
fn answers_against_what_was_believed_turn_it_round_and_one_slip_does_not() {
    let against = said(&[([1.0, 0.0], 0.0); 8]);
    assert!(believed(&against, 400).row_mean()[0] < 0.3);
    let mut slip = said(&[([1.0, 0.0], 1.0); 8]);
    slip.push(DVector::from_row_slice(&[1.0, 0.0]), 0.0);
    assert!(believed(&slip, 400).row_mean()[0] > 1.0);
}

#[test]
fn answers_that_are_all_ties_leave_finite_beliefs_near_no_difference() {
    let ties = said(&[([1.0, 0.5], 0.5); 10]);
    let samples = believed(&ties, 400);
    assert!(samples.iter().all(|w| w.is_finite()));
    assert!(samples.row_mean()[0] < 1.0);
}

#[test]
fn what_means_nothing_is_given_no_weight_whatever_is_said() {
    let evidence = said(&[([1.0, 3.0], 0.0); 5]);
    let prior = Prior::new(&EpisodesConfig::default(), &[1.0, 0.0]);
    let samples = posterior(&EpisodesConfig::default(), &prior, &evidence, Seed::root(1));
    assert!(samples.column(1).iter().all(|&w| w == 0.0));
}

#[test]
fn a_question_is_about_two_episodes_one_of_which_may_be_the_best() {
    let dataset = logs(&[0.5; 30]);
    let whole = whole_episodes(&dataset).unwrap();
    let sampler = SegmentSampler::new(&dataset, Clip::Episode).unwrap();
    let config = EpisodesConfig {
        candidates: 2,
        ..EpisodesConfig::default()
    };
    // Descriptor 0 is sure to be good, descriptor 1 may be either.
    let descriptors = DMatrix::from_fn(30, 2, |episode, j| match j {
        0 => episode as f64 / 10.0,
        _ => f64::from(episode as u32 % 2) - 0.5,
    });
    let samples = DMatrix::from_row_slice(2, 2, &[1.0, 2.0, 1.0, -2.0]);
    let strategy = MostInformative::new(&config, &descriptors, &samples, &whole);
    for seed in 0..20 {
        let mut rng = Seed::root(seed).rng();
        let segments = strategy
            .choose(&sampler, Untold::of(&[]), &mut rng)
            .unwrap();
        let pair = segments.map(|it| it.episode());
        assert_ne!(pair[0], pair[1]);
        assert!(pair.iter().any(|&episode| episode >= 26), "{pair:?}");
        // The two samples disagree on it.
        assert_ne!(pair[0] % 2, pair[1] % 2, "{pair:?}");
        let why = strategy.why(segments).unwrap();
        assert!(why.contains("may be among the best"), "{why}");
        let about = "and the answer says most about how far whereabouts 1 counts";
        assert!(why.ends_with(about), "{why}");
    }
}

/// A question about this pair that got an answer.
fn answered(segments: [Segment; 2]) -> LogEntry {
    LogEntry {
        question: Question {
            context: Context {
                round: 0,
                member: None,
            },
            query: Query { segments },
            why: None,
        },
        said: Said {
            answer: Some(Answer::First),
            later: false,
            by: "me".to_owned(),
            at: None,
        },
    }
}

#[test]
fn what_was_answered_is_not_asked_again_while_there_is_anything_else() {
    let dataset = logs(&[0.5; 4]);
    let whole = whole_episodes(&dataset).unwrap();
    let sampler = SegmentSampler::new(&dataset, Clip::Episode).unwrap();
    // Two of the four are the best of no sample, and their pair is one of six.
    let config = EpisodesConfig {
        candidates: 1,
        ..EpisodesConfig::default()
    };
    let descriptors = DMatrix::from_fn(4, 1, |episode, _| episode as f64);
    let samples = DMatrix::from_row_slice(2, 1, &[1.0, -1.0]);
    let strategy = MostInformative::new(&config, &descriptors, &samples, &whole);
    let mut asked: Vec<LogEntry> = Vec::new();
    let mut pairs = HashSet::new();
    for seed in 0..6 {
        let mut rng = Seed::root(seed).rng();
        let segments = strategy
            .choose(&sampler, Untold::of(&asked), &mut rng)
            .unwrap();
        let mut pair = segments.map(|it| it.episode());
        pair.sort_unstable();
        assert!(pairs.insert(pair), "{pair:?} twice");
        asked.push(answered(segments));
    }
    // There are no more pairs than that, and who wants to answer more may.
    let mut rng = Seed::root(6).rng();
    assert!(
        strategy
            .choose(&sampler, Untold::of(&asked), &mut rng)
            .is_some()
    );
}

#[test]
fn confidence_is_high_where_all_samples_agree_and_low_where_they_do_not() {
    let descriptors = DMatrix::from_column_slice(4, 1, &[2.0, -1.0, -0.5, -0.5]);
    let sure = DMatrix::from_column_slice(4, 1, &[1.0, 2.0, 1.5, 0.5]);
    let confidence = Confidence::new([0, 0], &sure, &descriptors, &[0], 0.8);
    assert_eq!((confidence.better, confidence.leaves_the_logs), (1.0, true));
    let unsure = DMatrix::from_column_slice(4, 1, &[1.0, -2.0, 1.5, -0.1]);
    let confidence = Confidence::new([0, 0], &unsure, &descriptors, &[0], 0.8);
    assert_eq!(
        (confidence.better, confidence.leaves_the_logs),
        (0.5, false)
    );
    assert!(confidence.in_words().ends_with("answer five questions"));
    let after = |answers, agreeing| {
        let confidence = Confidence {
            answers,
            agreeing,
            ..confidence.clone()
        };
        confidence.in_words()
    };
    assert!(after(10, 7).ends_with("answer five more questions"));
    assert!(after(2, 0).ends_with("answer five more questions"));
    // Ties, or answers of which half go against the other half: more of these would not help.
    assert!(after(10, 4).contains("look at them again before"));
}
