//! The policy as a safetensors file: named tensors behind a header of JSON, and the contract in its metadata.
//!
//! The format is a length in 8 bytes, the header, and the tensors one after the other, all little-endian.

use serde_json::{Map, Value, json};
use ted_core::Output;

use super::floats::Floats;

/// The tensors begin at a multiple of this, so that a reader may borrow them.
const ALIGNMENT: usize = 8;

/// The bytes of the file.
pub(super) fn bytes(floats: &Floats<'_>) -> Vec<u8> {
    let mut file = Tensors::default();
    file.vector("observation.shift", floats.shift);
    file.vector("observation.scale", floats.scale);
    for (index, layer) in floats.layers.iter().enumerate() {
        let sides = [layer.outputs(), layer.inputs()];
        file.add(&format!("policy.{index}.weight"), &sides, layer.weights());
        file.vector(&format!("policy.{index}.bias"), layer.bias());
    }
    file.vector("action.middle", &floats.map.middle);
    file.vector("action.half", &floats.map.half);
    file.vector("action.low", &floats.map.low);
    file.vector("action.high", &floats.map.high);
    let output = match floats.output {
        Output::Tanh => "tanh",
        Output::Linear => "linear",
    };
    // Texts only: that is the format's rule.
    file.sealed(json!({
        "contract": floats.facts.contract,
        "origin": floats.facts.origin,
        "layers": floats.layers.len().to_string(),
        "output": output,
    }))
}

/// The tensors so far, and where each of them lies.
#[derive(Default)]
struct Tensors {
    header: Map<String, Value>,
    data: Vec<u8>,
}

impl Tensors {
    fn vector(&mut self, name: &str, values: &[f32]) {
        self.add(name, &[values.len()], values);
    }

    fn add(&mut self, name: &str, sides: &[usize], values: &[f32]) {
        let begin = self.data.len();
        self.data
            .extend(values.iter().flat_map(|value| value.to_le_bytes()));
        let place = [begin, self.data.len()];
        let entry = json!({ "dtype": "F32", "shape": sides, "data_offsets": place });
        self.header.insert(name.to_owned(), entry);
    }

    fn sealed(mut self, metadata: Value) -> Vec<u8> {
        self.header.insert("__metadata__".to_owned(), metadata);
        let mut header = Value::Object(self.header).to_string();
        let length = header.len().next_multiple_of(ALIGNMENT);
        header.extend(std::iter::repeat_n(' ', length - header.len()));
        let length = (length as u64).to_le_bytes();
        [&length[..], header.as_bytes(), &self.data].concat()
    }
}
