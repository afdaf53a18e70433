//! The JSON beside the arrays: what Minari asks for, and what this project adds under `ted`.

use super::{METADATA, MINARI_VERSION, python_json};
use crate::dataset::{DatasetError, Shape};
use firmware_sim::robot::Robot;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::Path;

/// How a dataset was collected: with these values the same bytes can be made again.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Origin {
    /// The task, such as `drawer-open-v3`.
    pub task: String,
    /// The recipe, such as `paper`.
    pub recipe: String,
    /// The root seed.
    pub seed: u64,
    /// How many episodes the recipe was asked for.
    pub episodes: u32,
    /// Whether the goal is visible, and when it is drawn.
    pub goal: String,
    /// The version of the reward functions.
    pub reward: String,
    /// The simulator's packages and their versions.
    pub engine: BTreeMap<String, String>,
}

impl Origin {
    /// Of a dataset that was made from somebody's file.
    #[must_use]
    pub fn import(task: &str, source: &str, format: &str, rewards: bool) -> Self {
        let engine = [(FORMAT, format), (SOURCE, source)];
        Self {
            task: task.to_owned(),
            recipe: IMPORT.to_owned(),
            seed: 0,
            // Nobody knows how many before the end.
            episodes: 0,
            goal: "as recorded".to_owned(),
            reward: if rewards { "as recorded" } else { "none" }.to_owned(),
            engine: engine
                .map(|(key, value)| (key.to_owned(), value.to_owned()))
                .into(),
        }
    }

    /// The format that a dataset was imported from; none for one that was collected.
    #[must_use]
    pub fn imported(&self) -> Option<&str> {
        (self.recipe == IMPORT).then(|| self.engine.get(FORMAT).map_or("", String::as_str))
    }

    fn description(&self) -> String {
        let Self {
            task,
            recipe,
            seed,
            episodes,
            goal,
            reward,
            engine,
        } = self;
        if let Some(format) = self.imported() {
            let source = engine.get(SOURCE).map_or("", String::as_str);
            return format!("{task}: {episodes} episodes, imported from {source} ({format}).");
        }
        let world = if engine.contains_key("toy") {
            ""
        } else {
            "Meta-World "
        };
        format!(
            "{world}{task}: {episodes} episodes of the recipe `{recipe}` from root seed {seed}; goal {goal}, reward {reward}."
        )
    }
}

/// The recipe of what nobody here collected.
const IMPORT: &str = "import";
/// What the source and its format are called among what a dataset depends on.
const FORMAT: &str = "format";
const SOURCE: &str = "source";

/// What made the actions of an episode. What is zero in the paper's recipe is left out of the file where it is zero.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Behaviour {
    /// The part of the recipe, such as `noisy`.
    pub part: String,
    /// Standard deviation of the normal noise added to the scripted action.
    pub noise_std: f64,
    /// Probability of a uniformly random action instead.
    pub epsilon: f64,
    /// Added to every action.
    #[serde(default, skip_serializing_if = "all_zero")]
    pub push: [f64; 4],
    /// Standard deviation of a drift of the hand, added to every action.
    #[serde(default, skip_serializing_if = "zero")]
    pub drift_std: f64,
    /// Correlation of the drift from one step to the next.
    #[serde(default, skip_serializing_if = "zero")]
    pub drift_correlation: f64,
    /// Which of the task's purposes was pursued, from 0.
    #[serde(default, skip_serializing_if = "first")]
    pub purpose: u8,
}

fn first(purpose: &u8) -> bool {
    *purpose == 0
}

fn zero(value: &f64) -> bool {
    *value == 0.0
}

fn all_zero(values: &[f64; 4]) -> bool {
    values.iter().all(zero)
}

/// What one episode is and came to, kept so that a resumed collection need not open its arrays.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EpisodeNote {
    /// What made its actions.
    pub behaviour: Behaviour,
    /// Sum of its true rewards.
    pub return_true: f64,
    /// Whether the task was solved at any step.
    pub success: bool,
    /// BLAKE3 of its Arrow file, in hexadecimal.
    pub blake3: String,
}

/// `metadata.json` of an episode.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct EpisodeMetadata {
    pub id: u32,
    pub total_steps: usize,
    #[serde(default)]
    pub seed: Option<u64>,
    /// Options of the environment's reset; ours has none.
    #[serde(default)]
    pub options: Option<serde_json::Value>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ted: Option<EpisodeNote>,
}

/// The fields of `metadata.json` of a dataset that are read.
#[derive(Debug, Deserialize)]
pub(super) struct DatasetMetadata {
    pub total_episodes: u32,
    pub total_steps: usize,
    pub data_format: String,
    #[serde(default)]
    pub dataset_id: Option<String>,
    observation_space: Option<String>,
    action_space: Option<String>,
    #[serde(default)]
    pub ted: Option<OriginAndStatus>,
}

/// The `ted` object of a dataset.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct OriginAndStatus {
    /// `complete`: the file is written when the last episode is on the disk.
    pub status: String,
    #[serde(flatten)]
    pub origin: Origin,
}

/// The fields of `metadata.json` of a dataset that are written.
#[derive(Serialize)]
struct WrittenMetadata<'a> {
    total_episodes: u32,
    total_steps: usize,
    data_format: &'static str,
    jpeg_encoding: bool,
    observation_space: String,
    action_space: String,
    dataset_id: &'a str,
    minari_version: &'static str,
    dataset_size: f64,
    author: [&'static str; 1],
    algorithm_name: String,
    code_permalink: &'static str,
    description: String,
    ted: OriginAndStatus,
}

#[derive(Deserialize)]
struct Space {
    #[serde(rename = "type")]
    kind: String,
    #[serde(default)]
    shape: Vec<usize>,
    #[serde(default)]
    low: Vec<Option<f32>>,
    #[serde(default)]
    high: Vec<Option<f32>>,
}

/// The bounds of each number of a space, none where it has none.
pub(super) type Bounds = Vec<Option<[f32; 2]>>;

impl Space {
    fn bounds(&self) -> Bounds {
        let width = self.shape.first().copied().unwrap_or_default();
        let at = |ends: &[Option<f32>], i: usize| ends.get(i).copied().flatten();
        (0..width)
            .map(|i| Some([at(&self.low, i)?, at(&self.high, i)?]))
            // A bound beyond single precision is none.
            .map(|ends| ends.filter(|[low, high]| low < high && (high - low).is_finite()))
            .collect()
    }
}

impl DatasetMetadata {
    pub(super) fn read(data: &Path) -> Result<Self, DatasetError> {
        let path = data.join(METADATA);
        match fs::read(&path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                Err(DatasetError::MissingMetadata {
                    path: data.to_path_buf(),
                })
            }
            Err(source) => Err(DatasetError::Read { path, source }),
            Ok(bytes) => python_json::parse(&bytes).map_err(|error| DatasetError::Metadata {
                path,
                reason: error.to_string(),
            }),
        }
    }

    /// The widths of the two spaces, which must be flat boxes, and the bounds of each action where both are finite.
    pub(super) fn spaces(&self, data: &Path) -> Result<(Shape, Bounds), DatasetError> {
        let flat = |name: &'static str, space: &Option<String>| {
            let refuse = |actual: String| DatasetError::Space {
                path: data.join(METADATA),
                space: name,
                actual,
            };
            let text = space.as_ref().ok_or_else(|| refuse("absent".into()))?;
            let space: Space = python_json::parse(text.as_bytes())
                .map_err(|error| refuse(format!("unreadable ({error})")))?;
            // The type is that of the arrays, and theirs counts.
            match (space.kind.as_str(), space.shape.as_slice()) {
                ("Box", &[width]) if width > 0 => Ok((width, space.bounds())),
                ("Box", shape) => Err(refuse(format!("a Box with shape {shape:?}"))),
                (kind, _) => Err(refuse(format!("a {kind}"))),
            }
        };
        let (observation, _) = flat("observation_space", &self.observation_space)?;
        let (action, bounds) = flat("action_space", &self.action_space)?;
        Ok((
            Shape {
                observation,
                action,
            },
            bounds,
        ))
    }
}

/// The bytes of a complete dataset's `metadata.json`.
pub(super) fn dataset_metadata(
    id: &str,
    origin: &Origin,
    robot: &Robot,
    steps: usize,
    bytes: u64,
) -> Vec<u8> {
    let metadata = WrittenMetadata {
        total_episodes: origin.episodes,
        total_steps: steps,
        data_format: "arrow",
        jpeg_encoding: false,
        observation_space: box_space(robot.observation.iter().map(|it| it.range)),
        action_space: box_space(robot.action.iter().map(|it| Some(it.range))),
        dataset_id: id,
        minari_version: MINARI_VERSION,
        dataset_size: (bytes as f64 / 1e5).round() / 10.0,
        author: ["ted-train"],
        algorithm_name: match origin.imported() {
            Some(format) => format!("recorded; imported from {format}"),
            None => format!("scripted policy, recipe {}", origin.recipe),
        },
        code_permalink: concat!(env!("CARGO_PKG_NAME"), " ", env!("CARGO_PKG_VERSION")),
        description: origin.description(),
        ted: OriginAndStatus {
            status: "complete".into(),
            origin: origin.clone(),
        },
    };
    to_json(&metadata)
}

/// A flat box of `float32` as the string that Minari stores, with the bounds of each number where it has any. Their spelling is
/// Python's.
fn box_space(ranges: impl ExactSizeIterator<Item = Option<[f32; 2]>>) -> String {
    let width = ranges.len();
    let bounds = ranges.map(|range| match range {
        Some(ends) => ends.map(|end| format!("{end:?}")),
        None => ["-Infinity".to_owned(), "Infinity".to_owned()],
    });
    let (low, high): (Vec<_>, Vec<_>) = bounds.map(|[low, high]| (low, high)).unzip();
    let [low, high] = [low.join(", "), high.join(", ")];
    format!(
        r#"{{"type": "Box", "dtype": "float32", "shape": [{width}], "low": [{low}], "high": [{high}]}}"#
    )
}

/// Pretty JSON with a final newline.
pub(super) fn to_json(value: &impl Serialize) -> Vec<u8> {
    let mut bytes = serde_json::to_vec_pretty(value)
        .expect("strings, numbers and string keys always serialise");
    bytes.push(b'\n');
    bytes
}
