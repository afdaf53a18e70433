//! Integer inference against plain arithmetic in wider numbers, and its table against the exact function.

use proptest::prelude::*;
use ted_core::Output;
use ted_core::integer::{
    IntegerDense, IntegerMlp, IntegerPolicy, IntegerScratch, MAX_ACTIVATION, bias_limit, tanh_q15,
};

/// Parameters of a layer, owned.
#[derive(Clone, Debug)]
struct Layer {
    inputs: usize,
    weights: Vec<i8>,
    bias: Vec<i32>,
    multipliers: Vec<i32>,
    shifts: Vec<i8>,
}

impl Layer {
    fn view(&self) -> IntegerDense<'_> {
        IntegerDense::new(
            self.inputs,
            &self.weights,
            &self.bias,
            &self.multipliers,
            &self.shifts,
        )
        .unwrap()
    }

    /// The definition in the module's documentation, in 128 bits.
    fn plain(&self, x: &[i16]) -> Vec<i16> {
        (0..self.bias.len())
            .map(|o| {
                let row = &self.weights[o * self.inputs..(o + 1) * self.inputs];
                let products = row
                    .iter()
                    .zip(x)
                    .map(|(&w, &x)| i128::from(w) * i128::from(x));
                let acc = i128::from(self.bias[o]) + products.sum::<i128>();
                assert!(
                    i32::try_from(acc).is_ok(),
                    "the bound on the bias was too large"
                );
                let right = (31 - i32::from(self.shifts[o])) as u32;
                let half = (1_i128 << right) >> 1;
                let y = (acc * i128::from(self.multipliers[o]) + half) >> right;
                let limit = i128::from(MAX_ACTIVATION);
                y.clamp(-limit, limit) as i16
            })
            .collect()
    }
}

fn layer(inputs: usize, outputs: usize) -> impl Strategy<Value = Layer> {
    let limit = bias_limit(inputs);
    let extreme = prop_oneof![3 => -127..=127_i8, 1 => Just(127_i8), 1 => Just(-127_i8)];
    (
        prop::collection::vec(extreme, inputs * outputs),
        prop::collection::vec(
            prop_oneof![-limit..=limit, Just(limit), Just(-limit)],
            outputs,
        ),
        prop::collection::vec(1 << 30..=i32::MAX, outputs),
        prop::collection::vec(prop_oneof![4 => -18..=-6_i8, 1 => -31..=31_i8], outputs),
    )
        .prop_map(move |(weights, bias, multipliers, shifts)| Layer {
            inputs,
            weights,
            bias,
            multipliers,
            shifts,
        })
}

fn network() -> impl Strategy<Value = (Vec<Layer>, Vec<i16>)> {
    let width = prop_oneof![1..=9_usize, Just(64_usize)];
    prop::collection::vec(width, 2..=5)
        .prop_map(|mut widths| {
            let last = widths.len() - 1;
            widths[last] = widths[last].min(16);
            widths
        })
        .prop_flat_map(|widths| {
            let layers: Vec<_> = widths
                .windows(2)
                .map(|pair| layer(pair[0], pair[1]))
                .collect();
            let x = prop_oneof![
                3 => -MAX_ACTIVATION..=MAX_ACTIVATION,
                1 => Just(MAX_ACTIVATION),
                1 => Just(-MAX_ACTIVATION)
            ];
            (layers, prop::collection::vec(x, widths[0]))
        })
}

proptest! {
    #[test]
    fn a_network_computes_what_wide_arithmetic_gives((layers, x) in network(), bits in 0..=15_u8) {
        let views: Vec<_> = layers.iter().map(Layer::view).collect();
        let mut plain = x.clone();
        for (index, layer) in layers.iter().enumerate() {
            plain = layer.plain(&plain);
            if index + 1 < layers.len() {
                plain.iter_mut().for_each(|y| *y = (*y).max(0));
            }
        }
        // What an earlier pass left behind must not matter.
        let mut scratch = IntegerScratch::new();
        for output in [Output::Linear, Output::Tanh] {
            let mlp = IntegerMlp::new(&views, output).unwrap();
            let policy = IntegerPolicy::new(12, bits, mlp).unwrap();
            let mut computed = vec![7; plain.len()];
            policy.act(&x, &mut scratch, &mut computed).unwrap();
            let expected: Vec<i16> = match output {
                Output::Linear => plain.clone(),
                Output::Tanh => plain.iter().map(|&y| tanh_q15(y, bits)).collect(),
            };
            prop_assert_eq!(computed, expected);
        }
    }
}

#[test]
fn the_widest_layer_at_its_worst_does_not_overflow() {
    // Hands the one input on, 256 times.
    let fan = Layer {
        inputs: 1,
        weights: vec![1; 256],
        bias: vec![0; 256],
        multipliers: vec![1 << 30; 256],
        shifts: vec![1; 256],
    };
    for sign in [1, -1] {
        let wide = Layer {
            inputs: 256,
            weights: vec![127 * sign; 256],
            bias: vec![bias_limit(256) * i32::from(sign)],
            multipliers: vec![1 << 30],
            shifts: vec![-15],
        };
        let mlp = IntegerMlp::new(&[fan.view(), wide.view()], Output::Linear).unwrap();
        let policy = IntegerPolicy::new(15, 15, mlp).unwrap();
        let mut out = [0];
        policy
            .act(&[MAX_ACTIVATION], &mut IntegerScratch::new(), &mut out)
            .unwrap();
        assert_eq!(fan.plain(&[MAX_ACTIVATION]), [MAX_ACTIVATION; 256]);
        assert_eq!(out[..], wide.plain(&[MAX_ACTIVATION; 256]));
        // (2^31 - 1) / 2^16, rounded.
        assert_eq!(out[0], 32767 * i16::from(sign));
    }
}

#[test]
fn another_length_is_refused() {
    let one = Layer {
        inputs: 2,
        weights: vec![1, 1],
        bias: vec![0],
        multipliers: vec![1 << 30],
        shifts: vec![0],
    };
    let mlp = IntegerMlp::new(&[one.view()], Output::Tanh).unwrap();
    let policy = IntegerPolicy::new(12, 12, mlp).unwrap();
    let mut scratch = IntegerScratch::new();
    assert!(policy.act(&[0; 3], &mut scratch, &mut [0]).is_err());
    assert!(policy.act(&[0; 2], &mut scratch, &mut [0; 2]).is_err());
    assert_eq!(policy.action_fraction_bits(), 15);
}

#[test]
fn the_tangent_of_every_argument_is_within_the_stated_error_odd_and_never_falling() {
    for fraction_bits in 0..=15 {
        let (mut worst, mut last) = (0.0_f64, i16::MIN);
        for x in -MAX_ACTIVATION..=MAX_ACTIVATION {
            let computed = tanh_q15(x, fraction_bits);
            let v = f64::from(x) / f64::from(1_u32 << fraction_bits);
            worst = worst.max((f64::from(computed) - v.tanh() * 32768.0).abs());
            assert_eq!(computed, -tanh_q15(-x, fraction_bits), "{x}");
            assert!(computed >= last, "{x}");
            last = computed;
        }
        assert!(worst <= 1.6, "{worst} with {fraction_bits} fraction bits");
    }
    assert_eq!(tanh_q15(i16::MIN, 0), -MAX_ACTIVATION);
    // The three that `docs/artifact-format.md` works out.
    assert_eq!([1000, -1000, 3].map(|x| tanh_q15(x, 12)), [7844, -7844, 24]);
}
