//! Networks of random weights, quantised on a small dataset: near to what they were, and the same every time.

use ted_core::{Dense, DiscountClass, Output, RewardInput, RewardRange};
use ted_policy::{ActionChannel, ObservationChannel, SafeAction};

use super::*;
use crate::dataset::fixtures::{SHAPE, records};
use crate::nn::fixtures::numbers;
use crate::reward::{Labels, ensemble_labels};

const WIDTH: usize = 32;

/// Weights and biases of a network with one hidden layer.
struct Network {
    arrays: [Vec<f32>; 4],
    inputs: usize,
    outputs: usize,
}

impl Network {
    fn random(inputs: usize, outputs: usize, stream: &str) -> Self {
        let of = |count, part: &str, size: f32| -> Vec<f32> {
            let numbers = numbers(count, &format!("{stream}/{part}"));
            numbers.into_iter().map(|number| number * size).collect()
        };
        let arrays = [
            of(inputs * WIDTH, "hidden", 1.0),
            of(WIDTH, "hidden bias", 1.0),
            // Small enough for a tanh that is not at its ends.
            of(WIDTH * outputs, "last", 0.2),
            of(outputs, "last bias", 0.2),
        ];
        Self {
            arrays,
            inputs,
            outputs,
        }
    }

    fn view(&self, output: Output) -> ted_core::Mlp<'_> {
        let [hidden, hidden_bias, last, last_bias] = &self.arrays;
        let layers = [
            Dense::new(self.inputs, WIDTH, hidden, hidden_bias).unwrap(),
            Dense::new(WIDTH, self.outputs, last, last_bias).unwrap(),
        ];
        ted_core::Mlp::new(&layers, output).unwrap()
    }
}

/// What a controller accepts: every channel up to this.
fn contract(largest: f32) -> Contract<'static> {
    let observation = ObservationChannel {
        name: "x".into(),
        unit: "m".into(),
        low: -largest,
        high: largest,
    };
    let action = ActionChannel {
        name: "dx".into(),
        unit: "cm".into(),
        low: -1.0,
        high: 1.0,
        slew_per_tick: 2.0,
        on_fault: SafeAction::Zero,
    };
    let (observation, action) = ([observation; SHAPE.observation], [action; SHAPE.action]);
    Contract::new("x", &observation, &action, 1, 1).unwrap()
}

fn dataset() -> Dataset {
    let lengths: Vec<usize> = (0..20).map(|i| 30 + i % 3).collect();
    Dataset::from_records("ted/x-v0", SHAPE, &records(&lengths)).unwrap()
}

#[test]
fn integers_stay_near_the_floats_and_their_border_keeps_the_share_k() {
    let dataset = dataset();
    let seen = SHAPE.observation + SHAPE.action;
    let (shift, scale) = (vec![0.1; seen], vec![1.5; seen]);
    let policy = Network::random(SHAPE.observation, SHAPE.action, "policy");
    let members = ["a", "b", "c"].map(|stream| Network::random(seen, 1, stream));
    let rule = DiscountConfig::TED;
    for output in [Output::Tanh, Output::Linear] {
        let normaliser =
            |channels| Normaliser::new(&shift[..channels], &scale[..channels]).unwrap();
        let ensemble = |range| {
            let views = members.each_ref().map(|member| member.view(output));
            RewardEnsemble::new(
                RewardInput::ObservationAction,
                normaliser(seen),
                &views,
                range,
            )
            .unwrap()
        };
        let raw = RewardRange {
            low: 0.0,
            high: 1.0,
        };
        let raw = ensemble_labels(&dataset, &ensemble(raw)).unwrap();
        let labels = Labels::unit(&dataset, raw);
        let returns_hat = labels.returns_hat.clone();
        let ted = rule.lookup(&returns_hat).unwrap().unwrap();
        let contract = contract(1.2);
        let originals = Originals {
            contract: &contract,
            policy: Policy::new(normaliser(SHAPE.observation), policy.view(output)).unwrap(),
            reward: Some(ensemble(labels.range)),
            ted: Some((ted, &rule)),
            returns_hat: &returns_hat,
        };
        let (quantised, report) = QuantisedNetworks::quantise(&originals, &dataset).unwrap();
        let (again, _) = QuantisedNetworks::quantise(&originals, &dataset).unwrap();
        assert_eq!(quantised, again);

        let rewards = report.rewards.clone().unwrap();
        // A weight is off by at most half of a 127th of its row's largest; evenly spread, that is 0.23 % of the largest, and 0.4 %
        // of a weight that is spread evenly below it. Two layers of that, and what the first does to the second.
        for network in rewards.members.iter().chain([&report.policy]) {
            assert_eq!(network.saturated_inputs, 0);
            for layer in &network.layers {
                assert!(layer.relative_error < 3.0 * 0.004, "{layer:?}");
                assert_eq!(layer.saturated, 0);
            }
        }
        // Eight bits of weights, and a range of 2 that a tanh bends or a linear output leaves to the bits.
        let largest = if output == Output::Tanh { 0.05 } else { 0.1 };
        assert!(
            report.actions.iter().all(|action| action.max < largest),
            "{report}"
        );
        assert!(quantised.view().is_ok());

        let kept = quantised.classes().unwrap();
        let kept = kept
            .iter()
            .filter(|class| **class == DiscountClass::TopK)
            .count();
        assert_eq!(kept, 14, "70 % of 20");
        assert!(rewards.class_changes.unwrap() <= 1, "{report}");
        // A reward of 1 is the same in both numbers, so returns are too, but for the quantisation.
        let view = quantised.view().unwrap().reward.unwrap();
        let span = f64::from(view.range().span());
        let integer = &quantised.rewards.as_ref().unwrap().returns_hat;
        for (float, &integer) in returns_hat.iter().zip(integer) {
            let difference = f64::from(*float) - integer as f64 / span;
            assert!(
                difference.abs() < 0.02 * f64::from(*float),
                "{float} {integer} {span}"
            );
        }
    }
}

#[test]
fn a_channel_that_leaves_the_range_is_cut_off_and_counted() {
    let dataset = dataset();
    // Deviations of a hundredth: values of 1 are 100 of them, and the resolution keeps ten fraction bits.
    let (shift, scale) = (vec![0.0; SHAPE.observation], vec![100.0; SHAPE.observation]);
    let policy = Network::random(SHAPE.observation, SHAPE.action, "policy");
    let contract = contract(1.0);
    let originals = Originals {
        contract: &contract,
        policy: Policy::new(
            Normaliser::new(&shift, &scale).unwrap(),
            policy.view(Output::Tanh),
        )
        .unwrap(),
        reward: None,
        ted: None,
        returns_hat: &[],
    };
    let (_, report) = QuantisedNetworks::quantise(&originals, &dataset).unwrap();
    assert_eq!(report.input_fraction_bits, 10);
    let beyond = dataset
        .episodes()
        .iter()
        .flat_map(|e| e.first_step..e.first_step + e.len)
        .flat_map(|step| dataset.observation(step))
        .filter(|v| 100.0 * v.abs() * 1024.0 > 32767.5)
        .count();
    assert!(beyond > 0);
    assert_eq!(report.policy.saturated_inputs, beyond);
}

#[test]
fn a_position_that_is_resolved_too_coarsely_is_called_that() {
    let network = Network::random(SHAPE.observation, SHAPE.action, "policy");
    let with = |resolution_mm| QuantisationReport {
        coarsest: Some(Coarsest {
            channel: "hand_x".to_owned(),
            resolution_mm,
        }),
        ..report_of(&network.view(Output::Tanh))
    };
    assert!(with(0.2).to_string().contains("coarser than"));
    assert!(!with(0.09).to_string().contains("coarser than"));
}

#[test]
fn one_layer_and_a_layer_that_is_never_active_are_quantised_too() {
    let (weights, bias) = (
        numbers(SHAPE.observation * SHAPE.action, "one"),
        [0.1; SHAPE.action],
    );
    let one = Dense::new(SHAPE.observation, SHAPE.action, &weights, &bias).unwrap();
    let report = report_of(&ted_core::Mlp::new(&[one], Output::Tanh).unwrap());
    assert!(
        report.actions.iter().all(|action| action.max < 0.02),
        "{report}"
    );

    let hidden_weights = [0.0; SHAPE.observation];
    let dead = Dense::new(SHAPE.observation, 1, &hidden_weights, &[-1.0]).unwrap();
    let last_weights = [1.0; SHAPE.action];
    let last = Dense::new(1, SHAPE.action, &last_weights, &bias).unwrap();
    let report = report_of(&ted_core::Mlp::new(&[dead, last], Output::Tanh).unwrap());
    // The bias alone is left of it, in units of 2^-12.
    assert!(
        report.actions.iter().all(|action| action.max < 2e-4),
        "{report}"
    );
}

fn report_of(mlp: &ted_core::Mlp<'_>) -> QuantisationReport {
    let dataset = dataset();
    let (shift, scale) = ([0.0; SHAPE.observation], [1.0; SHAPE.observation]);
    let contract = contract(1.0);
    let originals = Originals {
        contract: &contract,
        policy: Policy::new(Normaliser::new(&shift, &scale).unwrap(), mlp.clone()).unwrap(),
        reward: None,
        ted: None,
        returns_hat: &[],
    };
    let (quantised, report) = QuantisedNetworks::quantise(&originals, &dataset).unwrap();
    assert!(quantised.view().is_ok());
    report
}
