//! The policy as an ONNX model: raw observations `[batch, channels]` in, actions in the robot's units out.
//!
//! The numbers of fields are those of `onnx/onnx.proto`, whose messages only ever grow.

use ted_core::Output;

use super::floats::Floats;
use crate::protobuf::Message;

/// Names of the model's input and output.
const OBSERVATION: &str = "observation";
const ACTION: &str = "action";

/// Version of the file format and of the operators: old enough for every engine in use.
const IR_VERSION: u64 = 8;
const OPERATORS: u64 = 17;

/// `TensorProto.DataType.FLOAT` and `AttributeProto.AttributeType.INT`.
const FLOAT: u64 = 1;
const INT: u64 = 2;

/// The bytes of the file.
pub(super) fn bytes(floats: &Floats<'_>) -> Vec<u8> {
    // ModelProto { ir_version = 1; producer_name = 2; producer_version = 3; graph = 7; opset_import = 8; metadata_props = 14 }
    Message::new()
        .integer(1, IR_VERSION)
        .text(2, "ted")
        .text(3, env!("CARGO_PKG_VERSION"))
        .message(7, &graph(floats))
        // OperatorSetIdProto { version = 2 }
        .message(8, &Message::new().integer(2, OPERATORS))
        .messages(
            14,
            &[
                property("contract", &floats.facts.contract),
                property("origin", &floats.facts.origin),
            ],
        )
        .encoded()
}

fn graph(floats: &Floats<'_>) -> Message {
    let mut graph = Graph::default();
    let (channels, map) = (floats.shift.len() as u64, &floats.map);
    let centred = graph.with("Sub", OBSERVATION, "shift", floats.shift);
    let mut x = graph.with("Mul", &centred, "scale", floats.scale);
    for (index, layer) in floats.layers.iter().enumerate() {
        let sides = [layer.outputs() as u64, layer.inputs() as u64];
        let weights = graph.tensor(&format!("policy.{index}.weight"), &sides, layer.weights());
        let bias = graph.tensor(&format!("policy.{index}.bias"), &sides[..1], layer.bias());
        x = graph.gemm(&x, &weights, &bias);
        if index != floats.last() {
            x = graph.node("Relu", &[&x]);
        } else if floats.output == Output::Tanh {
            x = graph.node("Tanh", &[&x]);
        }
    }
    let wide = graph.with("Mul", &x, "half", &map.half);
    let native = graph.with("Add", &wide, "middle", &map.middle);
    // Clip takes one range for all channels.
    let above = graph.with("Max", &native, "low", &map.low);
    let high = graph.vector("high", &map.high);
    graph.node_to("Min", &[&above, &high], ACTION);
    let unit = "raw, in the order and units of the contract";
    let sent = "in the units of the contract, inside its ranges";
    // GraphProto { node = 1; name = 2; initializer = 5; input = 11; output = 12 }
    Message::new()
        .messages(1, &graph.nodes)
        .text(2, "policy")
        .messages(5, &graph.tensors)
        .message(11, &value(OBSERVATION, channels, unit))
        .message(12, &value(ACTION, map.half.len() as u64, sent))
}

/// The nodes and constants of a graph, in order.
#[derive(Default)]
struct Graph {
    nodes: Vec<Message>,
    tensors: Vec<Message>,
}

impl Graph {
    /// Adds a constant, and gives its name back.
    fn tensor(&mut self, name: &str, sides: &[u64], values: &[f32]) -> String {
        // TensorProto { dims = 1; data_type = 2; name = 8; raw_data = 9 }
        let tensor = sides
            .iter()
            .fold(Message::new(), |tensor, &side| tensor.integer(1, side))
            .integer(2, FLOAT)
            .text(8, name);
        let raw: Vec<u8> = values
            .iter()
            .flat_map(|value| value.to_le_bytes())
            .collect();
        self.tensors.push(tensor.bytes(9, &raw));
        name.to_owned()
    }

    /// A constant with a value for each channel.
    fn vector(&mut self, name: &str, values: &[f32]) -> String {
        self.tensor(name, &[values.len() as u64], values)
    }

    /// Adds an operation on `x` and a value for each channel, and gives the name of what it computes.
    fn with(&mut self, operator: &str, x: &str, name: &str, values: &[f32]) -> String {
        let values = self.vector(name, values);
        self.node(operator, &[x, &values])
    }

    /// Adds `x weights^T + bias`.
    fn gemm(&mut self, x: &str, weights: &str, bias: &str) -> String {
        // AttributeProto { name = 1; i = 3; type = 20 }
        let transposed = Message::new()
            .text(1, "transB")
            .integer(3, 1)
            .integer(20, INT);
        let output = self.next("Gemm");
        let node = node("Gemm", &[x, weights, bias], &output);
        // NodeProto { attribute = 5 }
        self.nodes.push(node.message(5, &transposed));
        output
    }

    fn node(&mut self, operator: &str, inputs: &[&str]) -> String {
        let output = self.next(operator);
        self.node_to(operator, inputs, &output);
        output
    }

    fn node_to(&mut self, operator: &str, inputs: &[&str], output: &str) {
        self.nodes.push(node(operator, inputs, output));
    }

    /// A name that no other value has.
    fn next(&self, operator: &str) -> String {
        format!("{}.{}", self.nodes.len(), operator.to_lowercase())
    }
}

fn node(operator: &str, inputs: &[&str], output: &str) -> Message {
    // NodeProto { input = 1; output = 2; name = 3; op_type = 4 }
    inputs
        .iter()
        .fold(Message::new(), |node, input| node.text(1, input))
        .text(2, output)
        .text(3, &format!("{operator} to {output}"))
        .text(4, operator)
}

/// What goes in or comes out: `[batch, channels]`.
fn value(name: &str, channels: u64, says: &str) -> Message {
    // TensorShapeProto { dim = 1 }, Dimension { dim_value = 1; dim_param = 2 }
    let sides = [
        Message::new().text(2, "batch"),
        Message::new().integer(1, channels),
    ];
    let shape = Message::new().messages(1, &sides);
    // TypeProto { tensor_type = 1 }, Tensor { elem_type = 1; shape = 2 }
    let tensor = Message::new().integer(1, FLOAT).message(2, &shape);
    let kind = Message::new().message(1, &tensor);
    // ValueInfoProto { name = 1; type = 2; doc_string = 3 }
    Message::new().text(1, name).message(2, &kind).text(3, says)
}

/// StringStringEntryProto { key = 1; value = 2 }
fn property(key: &str, value: &str) -> Message {
    Message::new().text(1, key).text(2, value)
}
