//! Artefacts to put on a board: the toy's, another toy's, one of the size that flies in Meta-World, and any other size, in
//! both numbers.

use firmware_sim::plants::toy;
use ted_core::integer::{
    IntegerDense, IntegerMlp, IntegerPolicy, IntegerRange, IntegerRewardEnsemble,
};
use ted_core::{
    Dense, Mlp, Normaliser, Output, Policy, ReturnThreshold, RewardEnsemble, RewardInput,
    RewardRange, TedDiscount,
};
use ted_policy::{
    ActionChannel, ArtifactSpec, Contract, Digest, IntegerSpec, ObservationChannel, Provenance,
    SafeAction, write,
};

pub const OBSERVATION: usize = 39;
pub const ACTION: usize = 4;

/// The sizes of an artefact's networks.
#[derive(Clone, Copy, Debug)]
pub struct Shape {
    pub observation: usize,
    pub hidden: [usize; 2],
    pub action: usize,
    pub members: usize,
}

/// What flies in Meta-World.
const LARGE: Shape = Shape {
    observation: OBSERVATION,
    hidden: [256, 256],
    action: ACTION,
    members: 7,
};

pub fn toy() -> Vec<u8> {
    toy::artifact_bytes().expect("the toy is written")
}

/// Flies as the toy does, and is another file.
pub fn other_toy() -> Vec<u8> {
    let mut spec = toy::artifact_spec().expect("the toy is made");
    spec.provenance.seed = 1;
    write(&spec).expect("the toy is written")
}

/// Numbers without pattern; the same ones every time.
pub struct Numbers(u64);

impl Numbers {
    pub const fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn bits(&mut self) -> u64 {
        // Numerical Recipes' generator; the upper bits are good.
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 33
    }

    /// From -1 to 1.
    pub fn unit(&mut self) -> f32 {
        (self.bits() % 20_001) as f32 / 10_000.0 - 1.0
    }

    fn floats(&mut self, count: usize, scale: f32) -> Vec<f32> {
        (0..count).map(|_| scale * self.unit()).collect()
    }

    fn weights(&mut self, count: usize) -> Vec<i8> {
        (0..count)
            .map(|_| (self.bits() % 255) as i8)
            .map(|weight| weight.max(-127))
            .collect()
    }
}

/// The parameters of one layer in both numbers.
struct Layer {
    inputs: usize,
    outputs: usize,
    weights: Vec<f32>,
    bias: Vec<f32>,
    integer_weights: Vec<i8>,
    integer_bias: Vec<i32>,
    multipliers: Vec<i32>,
    shifts: Vec<i8>,
}

impl Layer {
    fn new(numbers: &mut Numbers, inputs: usize, outputs: usize) -> Self {
        Self {
            inputs,
            outputs,
            weights: numbers.floats(inputs * outputs, (6.0 / inputs as f32).sqrt()),
            bias: numbers.floats(outputs, 0.1),
            integer_weights: numbers.weights(inputs * outputs),
            integer_bias: (0..outputs)
                .map(|_| (100_000.0 * numbers.unit()) as i32)
                .collect(),
            multipliers: (0..outputs)
                .map(|_| (1 << 30) + numbers.bits() as i32 / 4)
                .collect(),
            shifts: vec![-9; outputs],
        }
    }

    fn network(numbers: &mut Numbers, widths: [usize; 4]) -> [Self; 3] {
        let [inputs, first, second, outputs] = widths;
        [(inputs, first), (first, second), (second, outputs)]
            .map(|(inputs, outputs)| Self::new(numbers, inputs, outputs))
    }

    fn dense(&self) -> Dense<'_> {
        Dense::new(self.inputs, self.outputs, &self.weights, &self.bias).expect("shapes agree")
    }

    fn integer(&self) -> IntegerDense<'_> {
        IntegerDense::new(
            self.inputs,
            &self.integer_weights,
            &self.integer_bias,
            &self.multipliers,
            &self.shifts,
        )
        .expect("no accumulator can overflow")
    }
}

fn float(layers: &[Layer; 3], output: Output) -> Mlp<'_> {
    Mlp::new(&layers.each_ref().map(Layer::dense), output).expect("the layers chain")
}

fn integer(layers: &[Layer; 3], output: Output) -> IntegerMlp<'_> {
    IntegerMlp::new(&layers.each_ref().map(Layer::integer), output).expect("the layers chain")
}

/// A policy of 39-256-256-4 and seven reward models of 43-256-256-1.
pub fn large() -> Vec<u8> {
    random(LARGE, 39)
}

/// Another one of the same size, and of the same contract.
pub fn other_large() -> Vec<u8> {
    random(LARGE, 40)
}

/// A policy and its reward models, in floats and in integers. Nothing was trained, and the integers have nothing to do with
/// the floats.
pub fn random(shape: Shape, seed: u64) -> Vec<u8> {
    let Shape {
        observation,
        hidden: [first, second],
        action,
        members,
    } = shape;
    let mut numbers = Numbers::new(seed);
    let policy = Layer::network(&mut numbers, [observation, first, second, action]);
    let input = observation + action;
    let members: Vec<_> = (0..members)
        .map(|_| Layer::network(&mut numbers, [input, first, second, 1]))
        .collect();
    let (shift, scale) = (vec![0.0; input], vec![1.0; input]);
    let of = |width: usize| Normaliser::new(&shift[..width], &scale[..width]);
    let normaliser = of(observation).expect("they are as many");
    let reward_normaliser = of(input).expect("they are as many");
    let golden: Vec<f32> = numbers.floats(4 * observation, 1.0);
    let floats: Vec<_> = members.iter().map(|it| float(it, Output::Linear)).collect();
    let reward = RewardEnsemble::new(
        RewardInput::ObservationAction,
        reward_normaliser,
        &floats,
        RewardRange {
            low: -3.0,
            high: 3.0,
        },
    );
    let integer_members: Vec<_> = members
        .iter()
        .map(|it| integer(it, Output::Linear))
        .collect();
    let integer_reward = IntegerRewardEnsemble::new(
        12,
        12,
        &integer_members,
        IntegerRange {
            low: -100_000,
            high: 100_000,
        },
    );
    let threshold = ReturnThreshold {
        return_hat: 3.0,
        last_tied_episode: 3,
    };
    let integers = IntegerSpec {
        policy: IntegerPolicy::new(12, 12, integer(&policy, Output::Tanh)).expect("bits fit"),
        reward: Some(integer_reward.expect("the members agree")),
        threshold: Some(ReturnThreshold {
            return_hat: 600_000,
            last_tied_episode: 3,
        }),
    };
    write(&ArtifactSpec {
        contract: contract(observation, action),
        provenance: provenance(),
        policy: Policy::new(normaliser, float(&policy, Output::Tanh)).expect("shapes agree"),
        reward: Some(reward.expect("the members agree")),
        ted: Some(TedDiscount::new(0.99, 0.7, threshold).expect("in range")),
        integers: Some(integers),
        golden_obs_raw: &golden,
    })
    .expect("the artefact is written")
}

fn contract(observation: usize, action: usize) -> Contract<'static> {
    let observation = vec![
        ObservationChannel {
            name: "somewhere".into(),
            unit: "m".into(),
            low: -1.0,
            high: 1.0,
        };
        observation
    ];
    let action = vec![
        ActionChannel {
            name: "somehow".into(),
            unit: "cm".into(),
            low: -1.0,
            high: 1.0,
            slew_per_tick: 2.0,
            on_fault: SafeAction::Zero,
        };
        action
    ];
    Contract::new("drawer-open-v3", &observation, &action, 12_500, 12_500)
        .expect("the contract can be kept")
}

fn provenance() -> Provenance<'static> {
    Provenance {
        trainer_version: "0.1.0",
        preset: "random",
        seed: 39,
        steps: 0,
        config_digest: Digest([1; 32]),
        dataset_id: "ted/none-v0",
        dataset_digest: Digest([2; 32]),
        preferences_digest: None,
        dataset_return_mean: 1.0,
        dataset_return_max: 2.0,
    }
}
