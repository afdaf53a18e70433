//! Minari datasets on disk, in Arrow storage: `<root>/<namespace>/<name>-vN/data/<episode>/part-0.arrow`.
//!
//! What is written opens in the Python package `minari` (0.5), and what that package writes in its Arrow storage is read.
//! Beside what Minari asks for, `metadata.json` carries a `ted` object that says how the data came about ([`Origin`]), and each
//! episode's `metadata.json` carries one with what it came to and the BLAKE3 of its file ([`EpisodeNote`]).

mod arrow_file;
mod decode;
mod encode;
mod foreign;
mod id;
mod metadata;
mod numbers;
mod python_json;
#[cfg(test)]
mod python_tests;
mod reader;
mod room;
mod states;
#[cfg(test)]
mod tests;
mod writer;

pub(crate) use foreign::foreign;
pub use id::DatasetId;
pub use metadata::{Behaviour, EpisodeNote, Origin};
pub(super) use reader::read;
pub(crate) use reader::{data_folder, own_folder};
pub use room::Room;
pub(crate) use room::begun_episodes;
pub(crate) use states::states;
pub use writer::{DatasetWriter, EpisodeError};
pub(crate) use writer::{finished_origin, is_finished, kept_episode};

/// The Minari version whose layout is written; newer packages read it too.
pub const MINARI_VERSION: &str = "0.5.4";

/// Name of the folder of the episodes.
const DATA: &str = "data";
/// Name of the one Arrow file of an episode.
const PART: &str = "part-0.arrow";
/// Name of the metadata file of a dataset and of an episode.
const METADATA: &str = "metadata.json";
