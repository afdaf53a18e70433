//! Reads a Minari dataset in Arrow storage: all episodes in parallel, each straight into its place in memory.

use super::metadata::{DatasetMetadata, EpisodeMetadata};
use super::{DATA, METADATA, PART, decode, foreign::foreign, python_json};
use crate::dataset::assemble::{Filled, UNIT, assemble};
use crate::dataset::{Dataset, DatasetError, Shape};
use firmware_sim::memory::free_memory;
use firmware_sim::robot::{ROBOT_FILE, Robot};
use firmware_sim::size::Size;
use firmware_sim::worlds;
use rayon::prelude::*;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Reads the dataset whose folder, or whose `data` folder, is `path`, as one of this robot, if it is not to be the dataset's own.
pub(crate) fn read(path: &Path, robot: Option<Robot>) -> Result<Dataset, DatasetError> {
    let data = data_folder(path)?;
    let metadata = DatasetMetadata::read(&data)?;
    if metadata.data_format != "arrow" {
        return Err(DatasetError::Format {
            path: own_folder(&data),
            format: metadata.data_format,
        });
    }
    let (shape, bounds) = metadata.spaces(&data)?;
    let robot = match robot {
        Some(robot) => robot,
        None => recorded_robot(&data, &metadata, shape, &bounds)?,
    };
    if Shape::of(&robot) != shape {
        return Err(DatasetError::OtherRobot {
            robot: robot.name.clone(),
            path: data,
            declared: Shape::of(&robot),
            recorded: shape,
        });
    }
    let id = metadata
        .dataset_id
        .clone()
        .unwrap_or_else(|| "unnamed".into());
    let episodes = episode_metadata(&data, metadata.total_episodes)?;
    let lengths: Vec<_> = episodes.iter().map(|episode| episode.total_steps).collect();
    let steps = lengths
        .iter()
        .try_fold(0_usize, |sum, &len| sum.checked_add(len));
    if steps != Some(metadata.total_steps) {
        return Err(DatasetError::Metadata {
            path: data.join(METADATA),
            reason: format!(
                "it promises {} steps, and its episodes have {}",
                metadata.total_steps,
                steps.map_or("more than can be counted".into(), |steps| steps.to_string())
            ),
        });
    }
    refuse_impossible_lengths(&data, &lengths)?;
    refuse_without_memory(&id, metadata.total_steps, shape, free_memory() as f64)?;

    let mut dataset = assemble(&id, robot, &lengths, |index, slots| {
        let episode = &episodes[index];
        let path = data.join(index.to_string()).join(PART);
        let place = format!("episode {index}, {}", path.display());
        let bytes = fs::read(&path).map_err(|source| DatasetError::Read { path, source })?;
        let expected = episode.ted.as_ref().map(|note| note.blake3.as_str());
        if expected.is_some_and(|expected| *blake3::hash(&bytes).to_hex() != *expected) {
            let reason = "its bytes are not those that were written (BLAKE3 differs)".into();
            return Err(DatasetError::Damaged { place, reason });
        }
        let rewards = decode::episode(bytes, &place, shape, slots)?;
        Ok(Filled {
            place,
            seed: episode.seed,
            rewards,
        })
    })?;
    dataset.origin = metadata.ted.map(|ted| ted.origin);
    Ok(dataset)
}

/// The robot of a dataset: the one in its folder; that of the world whose task it is of; or a draft, with the bounds of the action
/// space as ranges.
fn recorded_robot(
    data: &Path,
    metadata: &DatasetMetadata,
    shape: Shape,
    bounds: &[Option<[f32; 2]>],
) -> Result<Robot, DatasetError> {
    let file = data.join(ROBOT_FILE);
    if file.exists() {
        return Ok(Robot::read(&file)?);
    }
    let origin = metadata.ted.as_ref();
    if let Some(robot) = origin.and_then(|ted| worlds::robot_of(&ted.origin.task)) {
        return Ok(robot);
    }
    let ranges: Vec<_> = bounds.iter().map(|ends| ends.unwrap_or(UNIT)).collect();
    Ok(Robot::draft(shape.observation, &ranges))
}

/// The `data` folder of a dataset, whichever of the two was named.
pub(crate) fn data_folder(path: &Path) -> Result<PathBuf, DatasetError> {
    let inner = path.join(DATA);
    if inner.is_dir() {
        Ok(inner)
    } else if let Some(error) = foreign(path) {
        Err(error)
    } else if path.is_dir() {
        Ok(path.to_path_buf())
    } else {
        Err(DatasetError::NotFound {
            path: path.to_path_buf(),
        })
    }
}

/// The dataset's own folder, whichever of the two was named.
pub(crate) fn own_folder(path: &Path) -> PathBuf {
    let parent = path.parent().filter(|_| !path.join(DATA).is_dir());
    parent.unwrap_or(path).to_path_buf()
}

/// The metadata of all episodes in order.
fn episode_metadata(data: &Path, total: u32) -> Result<Vec<EpisodeMetadata>, DatasetError> {
    let read = |episode: u32| {
        let folder = data.join(episode.to_string());
        let missing = |path| DatasetError::MissingEpisode {
            episode,
            total,
            path,
        };
        let path = folder.join(METADATA);
        let bytes = match fs::read(&path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Err(missing(path)),
            Err(source) => return Err(DatasetError::Read { path, source }),
        };
        let part = folder.join(PART);
        if !part.is_file() {
            return Err(missing(part));
        }
        let metadata: EpisodeMetadata =
            python_json::parse(&bytes).map_err(|error| DatasetError::Metadata {
                path: path.clone(),
                reason: error.to_string(),
            })?;
        if metadata.id != episode {
            let reason = format!("it is the metadata of episode {}", metadata.id);
            return Err(DatasetError::Metadata { path, reason });
        }
        if metadata.total_steps == 0 {
            return Err(DatasetError::EmptyEpisode {
                place: folder.display().to_string(),
            });
        }
        Ok(metadata)
    };
    // An episode is an entry of the folder. Of one more than there are entries one is missing, so a total that is a lie is
    // found without exhausting memory.
    let entries = fs::read_dir(data).map_err(|source| DatasetError::Read {
        path: data.to_path_buf(),
        source,
    })?;
    let enough = u32::try_from(entries.count() + 1).unwrap_or(u32::MAX);
    // Collected first and judged in order, so that the error named is always the first.
    let all: Vec<_> = (0..total.min(enough)).into_par_iter().map(read).collect();
    all.into_iter().collect()
}

/// All of it is in memory at once: two rows of single precision, a reward in both precisions, a return, and flags.
fn refuse_without_memory(
    id: &str,
    steps: usize,
    shape: Shape,
    free: f64,
) -> Result<(), DatasetError> {
    let row = 4 * (shape.observation + shape.action) + 24;
    let needed = steps as f64 * row as f64;
    if needed <= free {
        return Ok(());
    }
    Err(DatasetError::NoMemory {
        id: id.to_owned(),
        needed: Size(needed),
        free: Size(free),
    })
}

/// A step takes some bytes on the disk, so a length beyond the file's size is a lie that would exhaust memory.
fn refuse_impossible_lengths(data: &Path, lengths: &[usize]) -> Result<(), DatasetError> {
    for (episode, &steps) in lengths.iter().enumerate() {
        let part = data.join(episode.to_string()).join(PART);
        let bytes = fs::metadata(&part)
            .map_err(|source| DatasetError::Read {
                path: part.clone(),
                source,
            })?
            .len();
        if steps as u64 > bytes {
            return Err(DatasetError::WrongShape {
                place: part.display().to_string(),
                array: "row count".into(),
                expected: format!("{steps} steps as its metadata says"),
                actual: format!("a file of {bytes} bytes"),
            });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dataset_that_is_larger_than_the_memory_is_refused_before_it_is_read() {
        let shape = Shape {
            observation: 39,
            action: 4,
        };
        let steps = 10_000_000;
        assert!(refuse_without_memory("mine/large-v0", steps, shape, 2e9).is_ok());
        let refused = refuse_without_memory("mine/large-v0", steps, shape, 1e9).unwrap_err();
        assert_eq!(
            refused.to_string(),
            "the dataset mine/large-v0 takes about 2.0 GB of memory, and 1.0 GB are free: end other programs, or make a smaller one of it"
        );
    }
}
