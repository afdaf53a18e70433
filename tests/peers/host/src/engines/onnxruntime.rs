//! ONNX Runtime, from the ONNX model: the library of its own wheel, loaded at run time.

use std::error::Error;

use ort::environment::Environment;
use ort::session::builder::GraphOptimizationLevel;
use ort::session::{IoBinding, Session};
use ort::value::Tensor;

use super::Engine;
use crate::network::{ACTION, Network, OBSERVATION};
use crate::onnx::{INPUT, OUTPUT};

pub struct OnnxRuntime<'n> {
    network: &'n Network,
    session: Session,
    input: Tensor<f32>,
    binding: IoBinding,
    _environment: Environment,
}

impl<'n> OnnxRuntime<'n> {
    /// `library` is the path of `libonnxruntime.so`.
    pub fn new(network: &'n Network, model: &[u8], library: &str) -> Result<Self, Box<dyn Error>> {
        let environment = ort::init_from(library)?.with_telemetry(false).build()?;
        let session = Session::builder(&environment)?
            .with_optimization_level(GraphOptimizationLevel::All)?
            .with_intra_threads(1)?
            .with_inter_threads(1)?
            .with_parallel_execution(false)?
            .commit_from_memory(model)?;
        let input = Tensor::from_array(([1, OBSERVATION], vec![0.0; OBSERVATION]))?;
        let output = Tensor::<f32>::new(session.allocator(), [1, ACTION])?;
        let mut binding = session.create_binding()?;
        binding.bind_input(INPUT, &input)?;
        binding.bind_output(OUTPUT, output)?;
        Ok(Self {
            network,
            session,
            input,
            binding,
            _environment: environment,
        })
    }
}

impl Engine for OnnxRuntime<'_> {
    fn name(&self) -> String {
        // Of the wheel that run.sh fetches: the library itself tells no version.
        "ONNX Runtime 1.32.0".into()
    }

    fn settings(&self) -> &'static str {
        "1 intra-op and 1 inter-op thread, sequential; all graph optimisations; input and output bound once"
    }

    fn act(
        &mut self,
        obs_raw: &[f32; OBSERVATION],
        action: &mut [f32; ACTION],
    ) -> Result<(), Box<dyn Error>> {
        let (_, values) = self.input.extract_tensor_mut();
        self.network.standardise(obs_raw, values);
        let outputs = self.session.run_binding(&self.binding)?;
        let (_, values) = outputs[0].try_extract_tensor::<f32>()?;
        action.copy_from_slice(values);
        Ok(())
    }
}
