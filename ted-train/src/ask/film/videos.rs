//! Films from the dataset's own videos: the page plays the files, each from where its clip begins. Nothing is made, and nothing is copied.

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::NoFilm;
use crate::dataset::{Segment, Video, Videos};

/// Finds the videos of a dataset's clips.
pub(super) struct Projector {
    videos: Videos,
    folder: PathBuf,
}

/// The videos of two clips.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Screening {
    /// Cameras that saw both of them; the first one is shown unless somebody chooses another.
    cameras: Vec<String>,
    /// Left and right, what each of these cameras saw.
    takes: [Vec<Take>; 2],
}

/// A clip in a video.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct Take {
    #[serde(skip)]
    file: PathBuf,
    /// When in the video the clip begins, in seconds.
    from_s: f64,
    /// Seconds from one step to the next.
    step_s: f64,
    /// Seconds from one picture to the next.
    frame_s: f64,
}

impl Projector {
    /// Of a dataset in this folder, if it has videos.
    ///
    /// # Errors
    /// When nobody can tell where they are.
    pub fn of(folder: &Path) -> Result<Option<Self>, NoFilm> {
        let videos = Videos::read(folder).map_err(|error| NoFilm(error.to_string()))?;
        Ok(videos.map(|videos| Self {
            videos,
            folder: folder.to_path_buf(),
        }))
    }

    /// The videos of these clips, left and right.
    ///
    /// # Errors
    /// When no camera has both.
    pub fn screen(&self, clips: [Segment; 2]) -> Result<Screening, NoFilm> {
        let [left, right] = clips.map(|clip| self.videos.episode(clip.episode()));
        let (mut cameras, mut takes) = (Vec::new(), [Vec::new(), Vec::new()]);
        let mut gone = None;
        for one in left {
            let Some(other) = right.iter().find(|it| it.camera == one.camera) else {
                continue;
            };
            let both = [(clips[0], one), (clips[1], other)].map(|(clip, it)| self.take(clip, it));
            match both {
                [Ok(one), Ok(other)] => {
                    cameras.push(one.1);
                    takes[0].push(one.0);
                    takes[1].push(other.0);
                }
                [Err(why), _] | [_, Err(why)] => gone = gone.or(Some(why)),
            }
        }
        match (cameras.is_empty(), gone) {
            (false, _) => Ok(Screening { cameras, takes }),
            (true, Some(why)) => Err(why),
            (true, None) => Err(NoFilm("no camera saw both of these episodes".into())),
        }
    }

    fn take(&self, clip: Segment, video: &Video) -> Result<(Take, String), NoFilm> {
        let file = self.videos.find(&self.folder, video).map_err(|was| {
            let was = was.display();
            NoFilm(format!("the video {was} is gone; put it back, or import the logs again from where they are now"))
        })?;
        if kind(&file).is_none() {
            let file = file.display();
            return Err(NoFilm(format!("{file} is of a kind that no browser plays")));
        }
        let take = Take {
            file,
            from_s: video.from_s + f64::from(clip.start()) * video.step_s,
            step_s: video.step_s,
            frame_s: video.frame_s,
        };
        Ok((take, video.camera.clone()))
    }
}

impl Screening {
    /// The file of the left (0) or right (1) clip by a camera.
    pub(super) fn file(&self, side: usize, camera: usize) -> Option<&Path> {
        Some(&self.takes.get(side)?.get(camera)?.file)
    }
}

/// What a file of this name is to a browser.
#[must_use]
pub fn kind(file: &Path) -> Option<&'static str> {
    match file.extension()?.to_str()?.to_ascii_lowercase().as_str() {
        "mp4" | "m4v" => Some("video/mp4"),
        "webm" => Some("video/webm"),
        "mov" => Some("video/quicktime"),
        _ => None,
    }
}
