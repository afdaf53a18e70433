//! Labels against the slow and plain way: each window by itself, all of its tokens through the whole network.

use firmware_sim::progress::Audience;

use crate::dataset::Dataset;
use crate::nn::Backend;
use crate::nn::fixtures::{assert_close, numbers, tensor, values, wide};
use crate::reward::transformer::{PtConfig, RewardTransformer, transformer_labels};

use super::{HEADS, SEGMENT, config, dataset, transformer};

/// A transformer whose gains and biases are not those of a fresh one.
fn disturbed(config: &PtConfig, dataset: &Dataset, backend: Backend) -> RewardTransformer {
    let mut transformer = transformer(config, dataset, backend);
    for (i, parameter) in transformer.network.tensors().into_iter().enumerate() {
        let dims = parameter.dims();
        let noise = numbers(dims.iter().product(), &format!("noise/{i}"));
        *parameter = parameter.clone() + tensor(&noise, dims, backend).mul_scalar(0.3);
    }
    transformer
}

#[test]
fn the_label_of_a_transition_is_the_last_reward_of_the_window_that_ends_with_it() {
    let dataset = dataset();
    for head in HEADS {
        for layers in [1, 2] {
            let config = PtConfig {
                layers,
                ..config(head)
            };
            for backend in [Backend::Flex, Backend::Ndarray] {
                let transformer = disturbed(&config, &dataset, backend);
                let labels = transformer_labels(&dataset, &transformer, Audience::Nobody).unwrap();
                let mut expected = Vec::new();
                for episode in dataset.episodes() {
                    for step in 0..episode.len {
                        let first = (step + 1).saturating_sub(SEGMENT as usize);
                        let window = episode.first_step + first..=episode.first_step + step;
                        let clips = transformer.clips(&dataset, window, 1);
                        let rewards = values(transformer.network.rewards(&clips));
                        expected.push(f64::from(*rewards.last().unwrap()));
                    }
                }
                assert_close(
                    &labels,
                    &expected,
                    1e-5,
                    &format!("{head:?}, {layers} layers"),
                );
            }
        }
    }
}

#[test]
fn windows_that_slide_have_the_rewards_that_each_has_by_itself() {
    let dataset = dataset();
    for head in HEADS {
        let transformer = disturbed(&config(head), &dataset, Backend::Flex);
        let labels = transformer_labels(&dataset, &transformer, Audience::Nobody).unwrap();
        for episode in dataset.episodes() {
            let expected = transformer.windows(&dataset, episode);
            let first = episode.first_step + SEGMENT as usize;
            let slid = &labels[first..episode.first_step + episode.len];
            assert_close(slid, &wide(&expected), 1e-5, "rewards");
        }
    }
}

#[test]
fn at_the_start_of_an_episode_windows_are_the_beginnings_of_one_clip() {
    let dataset = dataset();
    for head in HEADS {
        let transformer = disturbed(&config(head), &dataset, Backend::Flex);
        let labels = transformer_labels(&dataset, &transformer, Audience::Nobody).unwrap();
        for episode in dataset.episodes() {
            let steps = episode.first_step..episode.first_step + SEGMENT as usize;
            let clips = transformer.clips(&dataset, steps.clone(), 1);
            let rewards = values(transformer.network.rewards(&clips));
            assert_close(&labels[steps], &wide(&rewards), 1e-5, "first steps");
        }
    }
}

#[test]
fn a_reward_depends_on_what_came_before_as_far_as_a_window_reaches() {
    let dataset = dataset();
    let config = config(HEADS[0]);
    let transformer = transformer(&config, &dataset, Backend::Flex);
    let labels = |dataset: &_| transformer_labels(dataset, &transformer, Audience::Nobody).unwrap();
    let mut records: Vec<_> = (0..12).map(super::episode).collect();
    // The action of the third step of the first episode.
    records[0].actions[2 * super::SHAPE.action] *= 0.5;
    let changed = Dataset::from_records("ted/x-v0", super::SHAPE, &records).unwrap();
    let (before, after) = (labels(&dataset), labels(&changed));
    let differs: Vec<usize> = (0..before.len())
        .filter(|&i| before[i] != after[i])
        .collect();
    assert_eq!(differs, [2, 3, 4, 5]);
}
