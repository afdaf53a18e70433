//! ted-core's policies, whole: standardisation, every layer, the final tanh.

use alloc::vec;
use alloc::vec::Vec;
use core::hint::black_box;

use ted_core::integer::{
    IntegerDense, IntegerMlp, IntegerPolicy, IntegerRange, IntegerRewardEnsemble, IntegerScratch,
};
use ted_core::quantised::{QuantisedPolicy, QuantisedRewardEnsemble};
use ted_core::{Dense, Mlp, Normaliser, Output, Policy, RewardInput, Scratch};

use crate::network::{FRACTION_BITS, Layer, REWARD_WIDTHS, WIDTHS};
use crate::section;

/// The action in f32.
#[inline(never)]
pub fn f32(layers: &[Layer], x: &[f32]) -> Vec<f32> {
    let (shift, scale) = ([0.0; WIDTHS[0]], [1.0; WIDTHS[0]]);
    let layers: Vec<Dense<'_>> = layers.iter().map(Layer::dense).collect();
    let mlp = Mlp::new(&layers, Output::Tanh).expect("the layers chain");
    let policy =
        Policy::new(Normaliser::new(&shift, &scale).expect("finite"), mlp).expect("it fits");
    let mut scratch = Scratch::new();
    let mut action = vec![0.0; WIDTHS[3]];
    let (policy, x) = black_box((&policy, x));
    section::rest();
    let done = policy.act(x, &mut scratch, &mut action);
    section::ours_f32();
    done.expect("the sizes fit");
    action
}

/// The action in integers for a raw observation.
#[inline(never)]
pub fn integer(layers: &[Layer], obs_raw: &[f32]) -> Vec<f32> {
    let (shift, scale) = ([0.0; WIDTHS[0]], [1.0; WIDTHS[0]]);
    let policy = IntegerPolicy::new(FRACTION_BITS, FRACTION_BITS, mlp(layers)).expect("it fits");
    let normaliser = Normaliser::new(&shift, &scale).expect("finite");
    let policy = QuantisedPolicy::new(normaliser, policy).expect("it fits");
    let mut scratch = IntegerScratch::new();
    let mut action = vec![0.0; WIDTHS[3]];
    let (policy, obs_raw) = black_box((&policy, obs_raw));
    section::rest();
    let done = policy.act(obs_raw, &mut scratch, &mut action);
    section::ours_integer();
    done.expect("the sizes fit");
    action
}

/// What is added to the sum of the reward models to make a reward.
pub const REWARD_OF_ZERO: i32 = 1 << 20;

/// Everything that a control period asks for, in integers: the action for a raw observation, and the reward of the two by the
/// whole ensemble.
#[inline(never)]
pub fn period(layers: &[Layer], members: &[Vec<Layer>], obs_raw: &[f32]) -> i32 {
    let (shift, scale) = ([0.0; REWARD_WIDTHS[0]], [1.0; REWARD_WIDTHS[0]]);
    let normaliser =
        |inputs: usize| Normaliser::new(&shift[..inputs], &scale[..inputs]).expect("finite");
    let policy = IntegerPolicy::new(FRACTION_BITS, FRACTION_BITS, mlp(layers)).expect("it fits");
    let policy = QuantisedPolicy::new(normaliser(WIDTHS[0]), policy).expect("it fits");
    let members: Vec<IntegerMlp<'_>> = members.iter().map(|member| mlp(member)).collect();
    let range = IntegerRange {
        low: -REWARD_OF_ZERO,
        high: REWARD_OF_ZERO,
    };
    let ensemble = IntegerRewardEnsemble::new(FRACTION_BITS, FRACTION_BITS, &members, range);
    let reward = QuantisedRewardEnsemble::new(
        RewardInput::ObservationAction,
        normaliser(REWARD_WIDTHS[0]),
        ensemble.expect("it fits"),
    )
    .expect("it fits");
    let mut scratch = IntegerScratch::new();
    let mut action = vec![0.0; WIDTHS[3]];
    let (policy, reward, obs_raw) = black_box((&policy, &reward, obs_raw));
    section::rest();
    let done = policy
        .act(obs_raw, &mut scratch, &mut action)
        .and_then(|()| reward.reward_hat(obs_raw, &action, &mut scratch));
    section::ours_period();
    done.expect("the sizes fit")
}

fn mlp(layers: &[Layer]) -> IntegerMlp<'_> {
    let layers: Vec<IntegerDense<'_>> = layers.iter().map(Layer::integer).collect();
    IntegerMlp::new(&layers, Output::Tanh).expect("the layers chain")
}
