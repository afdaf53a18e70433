//! What training does to the ensemble, and that the controller's core computes the same rewards.

use crate::dataset::{Clip, Segment, SegmentSampler};
use crate::nn::fixtures::{BACKENDS, assert_close, tensor, values, wide};
use crate::nn::scalar::ScalarMlp;
use crate::preferences::{LabelledPair, RandomPair, ScriptedTeacher};
use crate::reward::oprl::{OprlConfig, held_out_agreement};
use crate::reward::{InputScaling, RewardInputs, ensemble_labels};
use crate::rng::Seed;
use ted_core::RewardRange;

use super::{SEGMENT, SHAPE, config, dataset, ensemble, learn};

#[test]
fn with_many_answers_the_ensemble_orders_segments_that_nobody_was_asked_about() {
    let dataset = dataset();
    let config = OprlConfig {
        rounds: 25,
        ..config()
    };
    for backend in BACKENDS {
        let folder = tempfile::tempdir().unwrap();
        let log = folder.path().join("log.jsonl");
        let mut teacher = ScriptedTeacher::truthful();
        let seed = Seed::root(3);
        let fresh = held_out_agreement(
            &config,
            &ensemble(&config, &dataset, backend),
            &dataset,
            seed,
        );
        let (learned, _) = learn(&config, &dataset, &mut teacher, &log, seed, backend);
        let held_out = held_out_agreement(&config, &learned.ensemble, &dataset, seed).unwrap();
        assert!(fresh.unwrap().agreement < 0.8);
        assert!(held_out.agreement > 0.85, "{held_out:?}");
        let (first, last) = (learned.fits[0], learned.fits[25]);
        assert!(first.loss < 0.6 && first.agreement > 0.9, "{first:?}");
        assert!(last.agreement > 0.9, "{last:?}");
    }
}

#[test]
fn an_equal_answer_pulls_the_two_returns_together() {
    let dataset = dataset();
    let sampler = SegmentSampler::new(&dataset, Clip::Steps(SEGMENT)).unwrap();
    let mut rng = Seed::root(4).rng();
    let segments = RandomPair.draw(&sampler, &mut rng);
    for backend in BACKENDS {
        let mut ensemble = ensemble(&config(), &dataset, backend);
        let gap = |ensemble: &super::Ensemble| -> f32 {
            let returns = ensemble.segment_returns(&dataset, &segments);
            returns.iter().map(|r| (r[1] - r[0]).abs()).sum()
        };
        let before = gap(&ensemble);
        let pair = LabelledPair {
            segments,
            label: 0.5,
        };
        ensemble.train(&dataset, &vec![vec![pair]; 7], &mut || true);
        let after = gap(&ensemble);
        assert!(after < 0.2 * before, "{after} from {before}");
    }
}

#[test]
fn returns_of_segments_are_sums_over_their_steps_for_each_member() {
    let dataset = dataset();
    // More segments than one forward pass takes.
    let sampler = SegmentSampler::new(&dataset, Clip::Steps(SEGMENT)).unwrap();
    let mut rng = Seed::root(5).rng();
    let segments: Vec<Segment> = (0..70).map(|_| sampler.sample(&mut rng)).collect();
    for backend in BACKENDS {
        let ensemble = ensemble(&config(), &dataset, backend);
        let returns = ensemble.segment_returns(&dataset, &segments);
        assert_eq!(returns.len(), 7);
        for (member, returns) in returns.iter().enumerate() {
            let scalar = ScalarMlp::member(&ensemble.network, member);
            let sum = |segment: &Segment| -> f64 {
                let input =
                    |step| wide(&[dataset.observation(step), dataset.action(step)].concat());
                segment
                    .steps(&dataset)
                    .map(|step| scalar.forward(&input(step))[0])
                    .sum()
            };
            let expected: Vec<f64> = segments.iter().map(sum).collect();
            assert_close(returns, &expected, 1e-5, "return");
        }
    }
}

#[test]
fn the_controller_s_core_labels_with_the_mean_of_the_members() {
    let dataset = dataset();
    let scalings = [InputScaling::Raw {}, InputScaling::Standard { floor: 0.7 }];
    let both = [RewardInputs::Observation, RewardInputs::ObservationAction];
    for (scaling, inputs) in scalings.into_iter().flat_map(|s| both.map(|i| (s, i))) {
        let config = OprlConfig {
            scaling,
            inputs,
            ..config()
        };
        for backend in BACKENDS {
            let ensemble = ensemble(&config, &dataset, backend);
            let mut rows = Vec::new();
            (0..dataset.step_count())
                .for_each(|step| ensemble.inputs.push(&dataset, step, &mut rows));
            let width = SHAPE.observation
                + if inputs == RewardInputs::Observation {
                    0
                } else {
                    2
                };
            let x = tensor(&rows, [1, dataset.step_count(), width], backend);
            let expected = values(ensemble.network.forward(x).mean_dim(0));
            let exported = ensemble.exported();
            let range = RewardRange {
                low: 0.0,
                high: 1.0,
            };
            let labels = ensemble_labels(&dataset, &exported.view(range).unwrap()).unwrap();
            assert_close(&labels, &wide(&expected), 1e-6, "label");
        }
    }
}
