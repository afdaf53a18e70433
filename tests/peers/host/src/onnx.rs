//! The policy as an ONNX model, for the engines that read one: three `Gemm`, two `Relu`, one `Tanh`.

use prost::Message;
use tract_onnx::pb::{
    AttributeProto, GraphProto, ModelProto, NodeProto, OperatorSetIdProto, TensorProto,
    TensorShapeProto, TypeProto, ValueInfoProto, attribute_proto::AttributeType,
    tensor_proto::DataType, tensor_shape_proto::Dimension, tensor_shape_proto::dimension,
    type_proto,
};

use crate::network::{ACTION, Network, OBSERVATION};

/// Name of the model's input.
pub const INPUT: &str = "obs_norm";

/// Name of the model's output.
pub const OUTPUT: &str = "action";

/// Every engine here reads this version of the format and of the operators.
const IR_VERSION: i64 = 8;
const OPERATORS: i64 = 17;

/// The file, as bytes: standardised observation `[1, 39]` in, action `[1, 4]` out.
pub fn model(network: &Network) -> Vec<u8> {
    let mut graph = GraphProto {
        name: "policy".into(),
        input: vec![value(INPUT, OBSERVATION)],
        output: vec![value(OUTPUT, ACTION)],
        ..Default::default()
    };
    let mut read = INPUT.to_owned();
    for (index, layer) in network.layers.iter().enumerate() {
        let [weights, bias, sum] = ["weights", "bias", "sum"].map(|part| format!("{part}{index}"));
        let sides = [layer.outputs as i64, layer.inputs as i64];
        graph
            .initializer
            .push(tensor(&weights, &sides, &layer.weights));
        graph
            .initializer
            .push(tensor(&bias, &sides[..1], &layer.bias));
        let mut gemm = node("Gemm", &[&read, &weights, &bias], &sum);
        gemm.attribute.push(AttributeProto {
            name: "transB".into(),
            r#type: AttributeType::Int as i32,
            i: 1,
            ..Default::default()
        });
        graph.node.push(gemm);
        let last = index + 1 == network.layers.len();
        let (activation, written) = match last {
            true => ("Tanh", OUTPUT.to_owned()),
            false => ("Relu", format!("hidden{index}")),
        };
        graph.node.push(node(activation, &[&sum], &written));
        read = written;
    }
    let operators = OperatorSetIdProto {
        domain: String::new(),
        version: OPERATORS,
    };
    let model = ModelProto {
        ir_version: IR_VERSION,
        opset_import: vec![operators],
        producer_name: "host-peers".into(),
        graph: Some(graph),
        ..Default::default()
    };
    model.encode_to_vec()
}

fn node(operator: &str, inputs: &[&str], output: &str) -> NodeProto {
    NodeProto {
        op_type: operator.into(),
        name: format!("{operator} {output}"),
        input: inputs.iter().map(|&name| name.into()).collect(),
        output: vec![output.into()],
        ..Default::default()
    }
}

fn tensor(name: &str, sides: &[i64], values: &[f32]) -> TensorProto {
    TensorProto {
        name: name.into(),
        dims: sides.to_vec(),
        data_type: DataType::Float as i32,
        raw_data: values
            .iter()
            .flat_map(|value| value.to_le_bytes())
            .collect(),
        ..Default::default()
    }
}

fn value(name: &str, width: usize) -> ValueInfoProto {
    let side = |length: usize| Dimension {
        value: Some(dimension::Value::DimValue(length as i64)),
        ..Default::default()
    };
    let shape = TensorShapeProto {
        dim: vec![side(1), side(width)],
    };
    let tensor = type_proto::Tensor {
        elem_type: DataType::Float as i32,
        shape: Some(shape),
    };
    ValueInfoProto {
        name: name.into(),
        r#type: Some(TypeProto {
            value: Some(type_proto::Value::TensorType(tensor)),
            ..Default::default()
        }),
        ..Default::default()
    }
}
