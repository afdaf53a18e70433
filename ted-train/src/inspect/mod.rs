//! What is in a file or folder that this project writes: an artefact, a run, a dataset.

mod artefact;
mod dataset;
mod look;
mod run;

pub use artefact::{
    ActionText, ArtefactText, ChannelText, ContractText, GoldenText, GoldenVector, LayerText,
    NetworkText, ProvenanceText, RewardText, TedText,
};
pub use dataset::{DatasetText, Returns};
pub use look::{DescriptorText, LookText, look};
pub use run::RunText;

use std::path::Path;

use serde::Serialize;
use ted_policy::{Artifact, ArtifactBytes, ArtifactError, LoadError};

use crate::dataset::minari::foreign;
use crate::dataset::{Dataset, DatasetError};
use crate::run::{RunError, RunFolder};

/// Anything that can be inspected.
#[derive(Clone, Debug, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Inspection {
    /// An artefact.
    Artefact(Box<ArtefactText>),
    /// A run folder.
    Run(Box<RunText>),
    /// A dataset.
    Dataset(Box<DatasetText>),
}

/// Why something cannot be inspected.
#[derive(Debug, thiserror::Error)]
pub enum InspectError {
    /// There is nothing.
    #[error("nothing at {path}: name an artefact, the folder of a run, or a dataset", path = path.display())]
    Nothing {
        /// Where it was looked for.
        path: std::path::PathBuf,
    },
    /// The artefact cannot be read.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// The artefact is broken.
    #[error("{path} is not a valid artefact: {error}", path = path.display())]
    Artifact {
        /// The file.
        path: std::path::PathBuf,
        /// What is wrong with it.
        error: ArtifactError,
    },
    /// The run's folder.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The dataset.
    #[error(transparent)]
    Dataset(#[from] DatasetError),
}

/// Looks at what is at a path.
///
/// # Errors
/// When there is nothing, or it is broken. Golden vectors that do not come out as they should are no error but part of the
/// answer.
pub fn inspect(path: &Path) -> Result<Inspection, InspectError> {
    if let Some(error) = foreign(path) {
        Err(error.into())
    } else if path.is_file() {
        let bytes = ArtifactBytes::read(path)?;
        let artifact = Artifact::parse(&bytes).map_err(|error| InspectError::Artifact {
            path: path.to_path_buf(),
            error,
        })?;
        let text = ArtefactText::new(path, bytes.len(), &artifact);
        Ok(Inspection::Artefact(Box::new(text)))
    } else if path.join("config.toml").is_file() {
        let folder = RunFolder::open(path)?;
        Ok(Inspection::Run(Box::new(RunText::read(&folder)?)))
    } else if path.is_dir() {
        let dataset = Dataset::open(path)?;
        Ok(Inspection::Dataset(Box::new(DatasetText::new(
            path, &dataset,
        ))))
    } else {
        Err(InspectError::Nothing {
            path: path.to_path_buf(),
        })
    }
}
