//! A trained ensemble in the controller's layout: what labels the dataset, is saved, and travels in the artefact.

use serde::{Deserialize, Serialize};
use ted_core::{Normaliser, RewardEnsemble, RewardInput, RewardRange, ShapeError};

use crate::nn::ExportedMlp;

use super::{InputMap, RewardInputs};

/// A reward ensemble as plain arrays, each member in `ted_core`'s row-major `[out][in]` order.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ExportedEnsemble {
    /// Scaling of the inputs.
    pub inputs: InputMap,
    /// The members in order.
    pub members: Vec<ExportedMlp>,
}

impl ExportedEnsemble {
    /// The controller's view of it, with the raw rewards that map to 0 and 1.
    ///
    /// # Errors
    /// When the networks are larger than the controller's limits.
    pub fn view(&self, range: RewardRange) -> Result<RewardEnsemble<'_>, ShapeError> {
        let input = match self.inputs.inputs {
            RewardInputs::Observation => RewardInput::Observation,
            RewardInputs::ObservationAction => RewardInput::ObservationAction,
        };
        let members = self
            .members
            .iter()
            .map(ExportedMlp::view)
            .collect::<Result<Vec<_>, _>>()?;
        RewardEnsemble::new(
            input,
            Normaliser::new(&self.inputs.shift, &self.inputs.scale)?,
            &members,
            range,
        )
    }
}
