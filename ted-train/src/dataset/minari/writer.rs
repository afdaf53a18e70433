//! Writes a Minari dataset episode by episode, so that a kill at any moment loses at most the episode in hand.
//!
//! Under the dataset's folder: `collection.json` says what is being collected, `data/<episode>/` appears complete or not at all
//! (written under a hidden name, brought to the disk, renamed), and `data/metadata.json` comes last. A lock file keeps a second
//! process out for as long as the writer lives.

use super::metadata::{
    Behaviour, DatasetMetadata, EpisodeMetadata, EpisodeNote, Origin, dataset_metadata, to_json,
};
use super::{DATA, DatasetId, METADATA, PART, encode};
use crate::dataset::ends::check_ends;
use crate::dataset::{DatasetError, EpisodeRecord, Shape};
use firmware_sim::disk::{Disk, WriteError, create_folder, lock, rename, sync_folder};
use firmware_sim::robot::{ROBOT_FILE, Robot};
use std::fs::{self, File};
use std::path::{Path, PathBuf};

const PLAN: &str = "collection.json";
const NAMESPACE_METADATA: &str = "namespace_metadata.json";

/// Why an episode was not written.
#[derive(Debug, thiserror::Error)]
#[error(transparent)]
pub enum EpisodeError {
    /// It is not consistent in itself, or holds numbers that are not finite.
    Refused(#[from] DatasetError),
    /// The disk.
    Write(#[from] WriteError),
}

/// A dataset being written. Dropping it releases the folder; what is complete stays.
#[derive(Debug)]
pub struct DatasetWriter {
    id: DatasetId,
    folder: PathBuf,
    data: PathBuf,
    origin: Origin,
    robot: Robot,
    disk: Disk,
    _lock: File,
}

impl DatasetWriter {
    /// Begins or goes on with the dataset `id` of this robot under `root`.
    pub fn open(
        root: &Path,
        id: DatasetId,
        origin: Origin,
        robot: Robot,
    ) -> Result<Self, WriteError> {
        Self::open_on(Disk::REAL, root, id, origin, robot)
    }

    pub(super) fn open_on(
        disk: Disk,
        root: &Path,
        id: DatasetId,
        origin: Origin,
        robot: Robot,
    ) -> Result<Self, WriteError> {
        let folder = id.folder(root);
        let data = folder.join(DATA);
        create_folder(&data)?;
        let lock = lock(&folder)?;
        let namespace = root.join(id.namespace()).join(NAMESPACE_METADATA);
        if !namespace.exists() {
            // Begun in our own, locked folder: another collection may be doing the same.
            let begun = folder.join(NAMESPACE_METADATA);
            disk.write(
                &begun,
                b"{\"description\": \"Datasets collected by ted.\"}\n",
            )?;
            rename(&begun, &namespace)?;
        }
        let writer = Self {
            id,
            folder,
            data,
            origin,
            robot,
            disk,
            _lock: lock,
        };
        writer.agree_on_the_plan()?;
        writer.remove_leftovers()?;
        Ok(writer)
    }

    /// The dataset's folder.
    #[must_use]
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The note of an episode that is already complete, with this seed and behaviour and undamaged bytes.
    #[must_use]
    pub fn kept(&self, episode: u32, seed: u64, behaviour: &Behaviour) -> Option<EpisodeNote> {
        kept_episode(&self.folder, episode, seed, behaviour)
    }

    /// Whether this episode is complete, of this part of a recipe, with so many steps and undamaged bytes.
    #[must_use]
    pub fn holds(&self, episode: u32, part: &str, steps: usize) -> bool {
        let Some(metadata) = episode_metadata(&self.data, episode) else {
            return false;
        };
        let bytes = fs::read(self.data.join(episode.to_string()).join(PART));
        let note = metadata.ted.filter(|note| note.behaviour.part == part);
        metadata.total_steps == steps
            && note.is_some_and(|note| {
                bytes.is_ok_and(|bytes| *blake3::hash(&bytes).to_hex() == *note.blake3)
            })
    }

    /// The same dataset, of so many episodes: for one whose number is known at the end only.
    #[must_use]
    pub fn of_episodes(mut self, episodes: u32) -> Self {
        self.origin.episodes = episodes;
        self
    }

    /// Writes one episode; when this returns it is on the disk.
    pub fn write(
        &self,
        episode: u32,
        behaviour: Behaviour,
        record: &EpisodeRecord,
    ) -> Result<EpisodeNote, EpisodeError> {
        let place = format!("episode {episode}");
        record.check(&self.robot, &place)?;
        check_ends(&place, &record.terminations, &record.truncations)?;
        let part = encode::episode_file(record, Shape::of(&self.robot))
            .map_err(|error| WriteError::at(&self.data, std::io::Error::other(error)))?;
        let note = EpisodeNote {
            behaviour,
            return_true: record.return_true(),
            success: record.succeeded(),
            blake3: blake3::hash(&part).to_hex().to_string(),
        };
        let metadata = EpisodeMetadata {
            id: episode,
            total_steps: record.steps(),
            seed: record.seed,
            options: None,
            ted: Some(note.clone()),
        };
        let hidden = self.data.join(format!("{HIDDEN}{episode}"));
        create_folder(&hidden)?;
        self.disk.write(&hidden.join(PART), &part)?;
        self.disk
            .write(&hidden.join(METADATA), &to_json(&metadata))?;
        sync_folder(&hidden)?;
        let place = self.data.join(episode.to_string());
        remove_folder(&place)?;
        rename(&hidden, &place)?;
        Ok(note)
    }

    /// Writes the robot and `metadata.json`, after which the dataset is complete. Every episode must have been written or kept.
    pub fn finish(&self) -> Result<PathBuf, WriteError> {
        let mut steps = 0;
        let mut bytes = 0;
        for episode in 0..self.origin.episodes {
            let folder = self.data.join(episode.to_string());
            let metadata =
                episode_metadata(&self.data, episode).ok_or_else(|| WriteError::Different {
                    path: folder.clone(),
                    difference: "the episode is missing or its metadata unreadable".into(),
                })?;
            steps += metadata.total_steps;
            for file in [PART, METADATA] {
                let path = folder.join(file);
                bytes += fs::metadata(&path)
                    .map_err(|error| WriteError::at(&path, error))?
                    .len();
            }
        }
        let robot = self.robot.to_toml().into_bytes();
        let path = self.data.join(ROBOT_FILE);
        if fs::read(&path).ok().as_ref() != Some(&robot) {
            self.disk.replace(&path, &robot)?;
        }
        let id = self.id.to_string();
        let metadata = dataset_metadata(&id, &self.origin, &self.robot, steps, bytes);
        let path = self.data.join(METADATA);
        if fs::read(&path).ok().as_ref() != Some(&metadata) {
            self.disk.replace(&path, &metadata)?;
        }
        Ok(self.folder.clone())
    }

    /// Refuses to mix two different collections in one folder.
    fn agree_on_the_plan(&self) -> Result<(), WriteError> {
        let path = self.folder.join(PLAN);
        let plan = to_json(&self.origin);
        let begun = match fs::read(&path) {
            Ok(begun) => begun,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                return self.disk.replace(&path, &plan);
            }
            Err(error) => return Err(WriteError::at(&path, error)),
        };
        if begun == plan {
            return Ok(());
        }
        let difference = match serde_json::from_slice::<Origin>(&begun) {
            Ok(begun) => format!("there {}, now {}", summary(&begun), summary(&self.origin)),
            Err(error) => format!("its {PLAN} is unreadable ({error})"),
        };
        Err(WriteError::Different {
            path: self.folder.clone(),
            difference,
        })
    }

    /// Half-written episodes of a killed process.
    fn remove_leftovers(&self) -> Result<(), WriteError> {
        let at = |error| WriteError::at(&self.data, error);
        for entry in fs::read_dir(&self.data).map_err(at)? {
            let entry = entry.map_err(at)?;
            if entry.file_name().to_string_lossy().starts_with(HIDDEN) {
                remove_folder(&entry.path())?;
            }
        }
        Ok(())
    }
}

/// The note of an episode that is complete in the dataset at `folder`, with this seed and behaviour and undamaged bytes.
pub(crate) fn kept_episode(
    folder: &Path,
    episode: u32,
    seed: u64,
    behaviour: &Behaviour,
) -> Option<EpisodeNote> {
    let data = folder.join(DATA);
    let metadata = episode_metadata(&data, episode)?;
    let part = fs::read(data.join(episode.to_string()).join(PART)).ok()?;
    let note = metadata.ted?;
    let same =
        metadata.id == episode && metadata.seed == Some(seed) && note.behaviour == *behaviour;
    (same && *blake3::hash(&part).to_hex() == *note.blake3).then_some(note)
}

/// Whether the dataset at `folder` is complete: its metadata comes last.
pub(crate) fn is_finished(folder: &Path) -> bool {
    folder.join(DATA).join(METADATA).exists()
}

/// How the dataset at `folder` was collected, if its collection was finished.
pub(crate) fn finished_origin(folder: &Path) -> Option<Origin> {
    DatasetMetadata::read(&folder.join(DATA))
        .ok()?
        .ted
        .map(|ted| ted.origin)
}

fn episode_metadata(data: &Path, episode: u32) -> Option<EpisodeMetadata> {
    let path = data.join(episode.to_string()).join(METADATA);
    serde_json::from_slice(&fs::read(path).ok()?).ok()
}

/// Prefix of an episode folder that is being written.
const HIDDEN: &str = ".writing-";

fn summary(origin: &Origin) -> String {
    let Origin {
        task,
        recipe,
        seed,
        episodes,
        engine,
        ..
    } = origin;
    let engine: Vec<_> = engine
        .iter()
        .map(|(package, version)| format!("{package} {version}"))
        .collect();
    format!(
        "{task} {recipe}, seed {seed}, {episodes} episodes, with {}",
        engine.join(", ")
    )
}

fn remove_folder(folder: &Path) -> Result<(), WriteError> {
    match fs::remove_dir_all(folder) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            Err(WriteError::at(folder, error))
        }
        _ => Ok(()),
    }
}
