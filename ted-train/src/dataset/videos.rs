//! Videos of a dataset's episodes: which file shows one, and from when on. They belong to whoever recorded the logs and stay where they are;
//! the dataset's folder has `videos.json`, which names them.

use super::DatasetError;
use super::minari::own_folder;
use firmware_sim::disk::{WriteError, replace};
use serde::{Deserialize, Serialize};
use std::fs;
use std::io::ErrorKind;
use std::path::{Component, Path, PathBuf};

/// Its name, in the dataset's folder.
const FILE: &str = "videos.json";

/// The videos of a dataset.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Videos {
    /// The folder that the logs were imported from.
    source: PathBuf,
    /// The way there from the dataset's folder: it still leads there when both were moved together.
    from_here: Option<PathBuf>,
    /// For each episode its videos, one for each camera.
    episodes: Vec<Vec<Video>>,
}

/// What one camera saw of an episode.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Video {
    /// What the camera is called.
    pub camera: String,
    /// The file, in the folder of the logs. Other episodes may be in it as well.
    pub path: PathBuf,
    /// When in it the episode begins, in seconds.
    pub from_s: f64,
    /// Seconds from one step of the episode to the next.
    pub step_s: f64,
    /// Seconds from one picture of the video to the next.
    pub frame_s: f64,
}

impl Videos {
    /// Of the episodes of logs in this folder.
    #[must_use]
    pub fn of(source: &Path, episodes: Vec<Vec<Video>>) -> Self {
        Self {
            source: source.to_path_buf(),
            from_here: None,
            episodes,
        }
    }

    /// Those of a dataset in this folder, if there are any.
    ///
    /// # Errors
    /// When they cannot be read, or are named in another way than they are written.
    pub fn read(dataset: &Path) -> Result<Option<Self>, DatasetError> {
        let path = own_folder(dataset).join(FILE);
        let bytes = match fs::read(&path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            Err(source) => return Err(DatasetError::Read { path, source }),
        };
        let broken = |reason: String| DatasetError::Videos {
            path: path.clone(),
            reason,
        };
        let videos: Self = serde_json::from_slice(&bytes).map_err(|it| broken(it.to_string()))?;
        if let Some(video) = videos.all().find(|video| !video.is_sound()) {
            return Err(broken(format!("{} of {:?}", video.camera, video.path)));
        }
        Ok(Some(videos))
    }

    /// Writes them into a dataset's folder, where they replace those of another import.
    ///
    /// # Errors
    /// When the disk is full or fails.
    ///
    /// # Panics
    /// Never: names and times can be written as JSON.
    pub fn write(mut self, dataset: &Path) -> Result<(), WriteError> {
        let whole = |path: &Path| fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
        self.source = whole(&self.source);
        let folder = own_folder(dataset);
        self.from_here = way(&whole(&folder), &self.source);
        let json = serde_json::to_vec(&self).expect("names and times are plain data");
        replace(&folder.join(FILE), &json)
    }

    /// What the cameras saw of an episode.
    #[must_use]
    pub fn episode(&self, episode: u32) -> &[Video] {
        let videos = self.episodes.get(episode as usize);
        videos.map_or(&[], Vec::as_slice)
    }

    /// Where a video of a dataset in this folder is; where it was, if it is gone.
    ///
    /// # Errors
    /// When it is gone.
    pub fn find(&self, dataset: &Path, video: &Video) -> Result<PathBuf, PathBuf> {
        let was = self.source.join(&video.path);
        let moved = (self.from_here.as_ref())
            .map(|way| own_folder(dataset).join(way).join(&video.path))
            .filter(|path| path.is_file());
        if was.is_file() {
            return Ok(was);
        }
        moved.ok_or(was)
    }

    /// Whether every video is inside of the folder of its logs, with times that are numbers.
    #[must_use]
    pub fn are_sound(&self) -> bool {
        self.all().all(Video::is_sound)
    }

    fn all(&self) -> impl Iterator<Item = &Video> {
        self.episodes.iter().flatten()
    }
}

impl Video {
    fn is_sound(&self) -> bool {
        let inside = |part| matches!(part, Component::Normal(_));
        let times = [self.from_s, self.step_s, self.frame_s];
        self.path.components().all(inside)
            && times.iter().all(|it| it.is_finite() && *it >= 0.0)
            && self.step_s > 0.0
    }
}

/// The way from a folder to another one, both whole.
fn way(from: &Path, to: &Path) -> Option<PathBuf> {
    if !(from.is_absolute() && to.is_absolute()) {
        return None;
    }
    let shared = from.components().zip(to.components());
    let shared = shared.take_while(|(one, other)| one == other).count();
    let up = from.components().skip(shared).map(|_| Component::ParentDir);
    Some(up.chain(to.components().skip(shared)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn video(path: &str) -> Video {
        Video {
            camera: "top".into(),
            path: path.into(),
            from_s: 1.5,
            step_s: 0.1,
            frame_s: 0.05,
        }
    }

    #[test]
    fn a_video_is_found_where_it_was_and_where_it_was_moved_to_with_the_dataset() {
        let home = tempfile::tempdir().unwrap();
        let (logs, dataset) = (
            home.path().join("logs"),
            home.path().join("data/mine/logs-v0"),
        );
        fs::create_dir_all(logs.join("videos")).unwrap();
        fs::create_dir_all(dataset.join("data")).unwrap();
        fs::write(logs.join("videos/0.mp4"), "").unwrap();
        let seen = video("videos/0.mp4");
        let videos = Videos::of(&logs, vec![vec![seen.clone()], Vec::new()]);
        videos.write(&dataset).unwrap();
        // The data folder is another name of the dataset.
        let videos = Videos::read(&dataset.join("data")).unwrap().unwrap();
        assert_eq!(videos.episode(0), std::slice::from_ref(&seen));
        assert!(videos.episode(1).is_empty() && videos.episode(2).is_empty());
        let was = fs::canonicalize(&logs).unwrap().join("videos/0.mp4");
        assert_eq!(videos.find(&dataset, &seen), Ok(was.clone()));

        let moved = tempfile::tempdir().unwrap();
        for part in ["logs", "data"] {
            fs::rename(home.path().join(part), moved.path().join(part)).unwrap();
        }
        let there = moved.path().join("data/mine/logs-v0");
        let found = videos.find(&there, &seen).unwrap();
        let found = fs::canonicalize(found).unwrap();
        assert_eq!(
            found,
            fs::canonicalize(moved.path().join("logs/videos/0.mp4")).unwrap()
        );
        fs::remove_file(found).unwrap();
        assert_eq!(videos.find(&there, &seen), Err(was));
    }

    #[test]
    fn a_dataset_without_videos_has_none_and_one_that_names_a_file_elsewhere_is_refused() {
        let dataset = tempfile::tempdir().unwrap();
        fs::create_dir(dataset.path().join("data")).unwrap();
        assert_eq!(Videos::read(dataset.path()).unwrap(), None);
        let mut late = video("a.mp4");
        late.from_s = -1.0;
        for bad in [video("../a.mp4"), video("/etc/passwd"), late] {
            let videos = Videos::of(dataset.path(), vec![vec![bad]]);
            assert!(!videos.are_sound());
            videos.write(dataset.path()).unwrap();
            let refused = Videos::read(dataset.path()).unwrap_err().to_string();
            assert!(refused.contains("import the logs again"), "{refused}");
        }
        fs::write(dataset.path().join(FILE), "{").unwrap();
        assert!(Videos::read(dataset.path()).is_err());
    }
}
