//! The policy as a header for C and C++: constants, the contract, and one function.
//!
//! Its sums are in the order of `ted_core::reference`, so that what is left to a compiler is whether it fuses multiply and add,
//! and to a C library its `tanhf`.

use std::fmt::Write;

use ted_core::Output;
use ted_policy::{Artifact, SafeAction};

use super::floats::Floats;

/// Numbers in a line of an array.
const A_LINE: usize = 8;

/// What every header begins with.
const HEAD: &str = "\
/*
 * A policy, written by `ted export --to c-header`. C99 or C++; of the C library it needs <math.h> alone.
 *
 * ted_policy_act() takes a raw observation and gives an action, both in the order and units of the tables below. It is
 * the policy and nothing else: whoever calls it refuses observations that are not finite, outside their ranges or older
 * than TED_POLICY_MAX_OBSERVATION_AGE_US, calls it every TED_POLICY_CONTROL_PERIOD_US, changes no channel by more
 * than slew_per_tick, and on a fault sends what on_fault says.
 */
#ifndef TED_POLICY_H
#define TED_POLICY_H

#include <math.h>
";

/// The types of the tables.
const TYPES: &str = "
/* A channel of the observation. */
typedef struct {
    const char *name;
    const char *unit;
    float low;
    float high;
} ted_policy_observation_channel;

/* What a channel of the action is sent on a fault. */
typedef enum { TED_POLICY_ZERO, TED_POLICY_HOLD_LAST, TED_POLICY_VALUE } ted_policy_safe_action;

/* A channel of the action. */
typedef struct {
    const char *name;
    const char *unit;
    float low;
    float high;
    float slew_per_tick;
    ted_policy_safe_action on_fault;
    /* What is sent with TED_POLICY_VALUE. */
    float on_fault_value;
} ted_policy_action_channel;
";

/// One layer. Four sums, so that the order of additions is the trainer's.
const LAYER: &str = "
/* out = weights x + bias; weights row by row, a row for each output. */
static inline void ted_policy_layer(const float *weights, const float *bias, int inputs, int outputs, const float *x, float *out)
{
    for (int o = 0; o < outputs; ++o) {
        const float *row = weights + o * inputs;
        float a = 0.0f, b = 0.0f, c = 0.0f, d = 0.0f;
        int i = 0;
        for (; i + 4 <= inputs; i += 4) {
            a += row[i] * x[i];
            b += row[i + 1] * x[i + 1];
            c += row[i + 2] * x[i + 2];
            d += row[i + 3] * x[i + 3];
        }
        if (i < inputs) {
            a += row[i] * x[i];
        }
        if (i + 1 < inputs) {
            b += row[i + 1] * x[i + 1];
        }
        if (i + 2 < inputs) {
            c += row[i + 2] * x[i + 2];
        }
        out[o] = (a + b) + (c + d) + bias[o];
    }
}

static inline void ted_policy_relu(float *x, int count)
{
    for (int i = 0; i < count; ++i) {
        x[i] = x[i] > 0.0f ? x[i] : 0.0f;
    }
}
";

/// The text of the file.
pub(super) fn text(artifact: &Artifact<'_>, floats: &Floats<'_>) -> String {
    [
        HEAD,
        &constants(artifact, floats),
        TYPES,
        &tables(floats),
        &arrays(floats),
        LAYER,
        &act(floats),
        "\n#endif\n",
    ]
    .concat()
}

fn constants(artifact: &Artifact<'_>, floats: &Floats<'_>) -> String {
    let (contract, provenance) = (&floats.contract, artifact.provenance());
    let us = |time: u32| format!("{time}UL");
    let constants = [
        ("OBSERVATION", contract.observation.len().to_string()),
        ("ACTION", contract.action.len().to_string()),
        ("CONTROL_PERIOD_US", us(contract.control_period_us)),
        (
            "MAX_OBSERVATION_AGE_US",
            us(contract.max_observation_age_us),
        ),
        // Of a robot that nobody declared, names, units and times stand for nothing.
        ("DECLARED", u8::from(contract.declared).to_string()),
        ("TASK", quoted(contract.task)),
        ("PRESET", quoted(provenance.preset)),
        ("SEED", format!("{}ULL", provenance.seed)),
        ("DATASET", quoted(provenance.dataset_id)),
        (
            "DATASET_DIGEST",
            quoted(&provenance.dataset_digest.to_string()),
        ),
        (
            "CONFIG_DIGEST",
            quoted(&provenance.config_digest.to_string()),
        ),
        ("TRAINER", quoted(provenance.trainer_version)),
        ("ARTEFACT_CRC32", format!("0x{:08x}UL", artifact.checksum())),
    ];
    let lines = constants.map(|(name, value)| format!("#define TED_POLICY_{name} {value}\n"));
    format!("\n/* The contract and the origin. */\n{}", lines.concat())
}

fn tables(floats: &Floats<'_>) -> String {
    let observation = floats.contract.observation.iter().map(|channel| {
        let [name, unit] = [channel.name, channel.unit].map(|text| quoted(text.as_str()));
        let [low, high] = [channel.low, channel.high].map(number);
        format!("    {{{name}, {unit}, {low}, {high}}},\n")
    });
    let action = floats.contract.action.iter().map(|channel| {
        let [name, unit] = [channel.name, channel.unit].map(|text| quoted(text.as_str()));
        let [low, high, slew] = [channel.low, channel.high, channel.slew_per_tick].map(number);
        let on_fault = match channel.on_fault {
            SafeAction::Zero => "TED_POLICY_ZERO, 0.0f".to_owned(),
            SafeAction::HoldLast => "TED_POLICY_HOLD_LAST, 0.0f".to_owned(),
            SafeAction::Value(value) => format!("TED_POLICY_VALUE, {}", number(value)),
        };
        format!("    {{{name}, {unit}, {low}, {high}, {slew}, {on_fault}}},\n")
    });
    format!(
        "
static const ted_policy_observation_channel ted_policy_observation_channels[TED_POLICY_OBSERVATION] = {{
{}}};

static const ted_policy_action_channel ted_policy_action_channels[TED_POLICY_ACTION] = {{
{}}};
",
        observation.collect::<String>(),
        action.collect::<String>()
    )
}

fn arrays(floats: &Floats<'_>) -> String {
    let map = &floats.map;
    let mut text = String::from("\n/* x = (observation - shift) * scale */\n");
    text += &array("shift", floats.shift);
    text += &array("scale", floats.scale);
    for (index, layer) in floats.layers.iter().enumerate() {
        let (inputs, outputs) = (layer.inputs(), layer.outputs());
        // Writing to a string cannot fail.
        let _ = writeln!(text, "\n/* Layer {index}, {inputs} to {outputs} */");
        text += &array(&format!("weights_{index}"), layer.weights());
        text += &array(&format!("bias_{index}"), layer.bias());
    }
    text += "\n/* action = middle + half * unit, inside the range of the table above */\n";
    text += &array("middle", &map.middle);
    text += &array("half", &map.half);
    text
}

fn act(floats: &Floats<'_>) -> String {
    let outputs = floats.layers.iter().map(|layer| layer.outputs());
    let width = outputs.fold(floats.shift.len(), usize::max);
    let mut text = format!(
        "
/* The action for a raw observation. The two may be the same memory. */
static inline void ted_policy_act(const float observation[TED_POLICY_OBSERVATION], float action[TED_POLICY_ACTION])
{{
    float x[{width}];
    float y[{width}];
    for (int i = 0; i < TED_POLICY_OBSERVATION; ++i) {{
        x[i] = (observation[i] - ted_policy_shift[i]) * ted_policy_scale[i];
    }}
"
    );
    let (mut read, mut write) = ("x", "y");
    for (index, layer) in floats.layers.iter().enumerate() {
        let (inputs, outputs) = (layer.inputs(), layer.outputs());
        let _ = writeln!(
            text,
            "    ted_policy_layer(ted_policy_weights_{index}, ted_policy_bias_{index}, {inputs}, {outputs}, {read}, {write});"
        );
        if index != floats.last() {
            let _ = writeln!(text, "    ted_policy_relu({write}, {outputs});");
        }
        (read, write) = (write, read);
    }
    let unit = match floats.output {
        Output::Tanh => format!("tanhf({read}[i])"),
        Output::Linear => format!("{read}[i]"),
    };
    text + &format!(
        "    for (int i = 0; i < TED_POLICY_ACTION; ++i) {{
        const float low = ted_policy_action_channels[i].low;
        const float high = ted_policy_action_channels[i].high;
        const float native = ted_policy_middle[i] + ted_policy_half[i] * {unit};
        action[i] = native < low ? low : native > high ? high : native;
    }}
}}
"
    )
}

fn array(name: &str, values: &[f32]) -> String {
    let lines = values.chunks(A_LINE).map(|line| {
        let numbers: Vec<String> = line.iter().copied().map(number).collect();
        format!("    {},\n", numbers.join(", "))
    });
    format!(
        "static const float ted_policy_{name}[{}] = {{\n{}}};\n",
        values.len(),
        lines.collect::<String>()
    )
}

/// The shortest decimal that a compiler reads as these bits. Everything in an artefact is finite.
fn number(value: f32) -> String {
    format!("{value:?}f")
}

/// A text as a literal: what could end it, begin a trigraph, or is not ASCII is written in octal, byte by byte.
fn quoted(text: &str) -> String {
    let bytes = text.bytes().map(|byte| match byte {
        b'"' | b'\\' | b'?' => format!("\\{byte:03o}"),
        b' '..=b'~' => char::from(byte).to_string(),
        _ => format!("\\{byte:03o}"),
    });
    format!("\"{}\"", bytes.collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_the_shortest_that_c_reads_as_a_float() {
        let written = [1.0, -0.5, 0.1, 1e-45, f32::MAX].map(number);
        assert_eq!(
            written,
            ["1.0f", "-0.5f", "0.1f", "1e-45f", "3.4028235e38f"]
        );
    }

    #[test]
    fn texts_are_literals_that_nothing_in_them_can_end() {
        assert_eq!(
            quoted("a \"b\"\\\n*/ ??="),
            r#""a \042b\042\134\012*/ \077\077=""#
        );
        assert_eq!(quoted("°/s"), r#""\302\260/s""#);
    }
}
