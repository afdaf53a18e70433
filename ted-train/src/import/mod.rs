//! Other people's logs, made into a dataset: `ted import`.
//!
//! A source is read twice. The first time nothing is written: every fault is found, and what the actions are. The second time
//! episodes are written as they come, so that a kill costs the one in hand, and the same command goes on behind the last.

mod error;
mod reader;
mod robot;

pub use error::ImportError;
use error::called;

use std::path::{Path, PathBuf};
use std::process::Command;

use firmware_sim::disk::{Disk, WriteError};
use firmware_sim::interrupt;
use firmware_sim::progress::{Audience, Progress};
use firmware_sim::robot::{ROBOT_FILE, Robot};
use firmware_sim::worlds::Task;
use serde::Serialize;

use crate::dataset::minari::{self, Behaviour, DatasetId, DatasetWriter, Origin, Room};
use crate::dataset::{EpisodeRecord, Shape, Video, Videos};
use reader::{EpisodeRead, Filmed, Header, Next, Reader};

/// What to import, and where to.
#[derive(Clone, Debug)]
pub struct ImportConfig {
    /// The file or folder.
    pub source: PathBuf,
    /// What the reader is told, such as `--map`.
    pub options: Vec<String>,
    /// The robot, if somebody declared it.
    pub robot: Option<Robot>,
    /// The task of a known world that the logs are of, if they are; its robot is then theirs.
    pub task: Option<Task>,
    /// Whether actions outside of their ranges are made the ends of these.
    pub clip: bool,
    /// The dataset.
    pub id: DatasetId,
    /// The folder that holds its namespace.
    pub root: PathBuf,
}

/// What was imported.
#[derive(Clone, Debug, Serialize)]
pub struct ImportReport {
    /// The dataset's id.
    pub dataset: String,
    /// Its folder.
    pub folder: PathBuf,
    /// The format of the source.
    pub format: String,
    /// Episodes.
    pub episodes: u32,
    /// Steps of all of them.
    pub steps: usize,
    /// Whether the source has rewards; otherwise all are 0.
    pub rewards: bool,
    /// Whether it says what a success was.
    pub success: bool,
    /// Time from one action to the next, in microseconds, and how that is known.
    pub period_us: u32,
    /// How the period is known.
    pub period_from: String,
    /// Cameras of which the source has videos.
    pub cameras: Vec<String>,
    /// Facts about the robot that are guessed.
    pub guesses: usize,
    /// Numbers of actions that were clipped, for each channel.
    pub clipped: Vec<u64>,
    /// What was odd, with its episode.
    pub notes: Vec<String>,
}

/// What the first look at a source found.
pub(crate) struct Seen {
    /// Lowest and highest of each action channel.
    actions: Vec<[f32; 2]>,
    /// Number, name and steps of every episode.
    episodes: Vec<(u64, String, usize)>,
    /// What the cameras saw of each.
    videos: Vec<Vec<Video>>,
    notes: Vec<String>,
}

impl Seen {
    /// The cameras of the episodes, in the order in which they are found.
    fn cameras(&self) -> Vec<String> {
        let mut cameras: Vec<String> = Vec::new();
        for video in self.videos.iter().flatten() {
            if !cameras.contains(&video.camera) {
                cameras.push(video.camera.clone());
            }
        }
        cameras
    }
}

/// A video as a dataset names it.
fn video(filmed: Filmed) -> Video {
    Video {
        camera: filmed.feature,
        path: filmed.path,
        from_s: filmed.from_s,
        step_s: filmed.step_s,
        frame_s: filmed.fps.recip(),
    }
}

/// Makes a dataset of a source, or goes on with it.
///
/// # Errors
/// When there is no reader, the source is at fault, the robot is another one, or the disk fails.
pub fn import(config: &ImportConfig, audience: Audience) -> Result<ImportReport, ImportError> {
    let command = reader::command(audience)?;
    let (header, mut seen) = look(config, command(), audience)?;
    // What somebody declared for this dataset before outlives another import.
    let there = minari::data_folder(&config.id.folder(&config.root));
    let there = there
        .ok()
        .and_then(|data| Robot::read(&data.join(ROBOT_FILE)).ok());
    let of_task = config.task.map(|task| task.robot());
    let declared = (of_task.or_else(|| config.robot.clone())).or(there.filter(Robot::declared));
    let robot = match &declared {
        Some(robot) => robot::fitting(robot.clone(), &header)?,
        None => robot::draft(&header, &seen),
    };
    let clipped = outside(config, command(), &robot, &seen)?;
    make_sure_of_room(Disk::REAL, config, &robot, &seen)?;
    let source = config.source.display().to_string();
    let task = config.task.map_or(config.id.name(), |task| task.name());
    let origin = Origin::import(task, &source, &header.format, header.has.rewards);
    let writer = DatasetWriter::open(&config.root, config.id.clone(), origin, robot.clone())?;
    write(config, command(), &writer, &robot, &seen, audience)?;
    let mut cameras = seen.cameras();
    let videos = Videos::of(&config.source, std::mem::take(&mut seen.videos));
    if !videos.are_sound() {
        let odd = "its videos are not in its folder, or at times that are none: they are left out";
        seen.notes.push(odd.to_owned());
        cameras.clear();
    }
    if !cameras.is_empty() {
        videos.write(writer.folder())?;
    }
    let episodes = u32::try_from(seen.episodes.len()).unwrap_or(u32::MAX);
    let folder = writer.of_episodes(episodes).finish()?;
    Ok(ImportReport {
        dataset: config.id.to_string(),
        folder,
        format: header.format,
        episodes,
        steps: seen.episodes.iter().map(|(_, _, steps)| steps).sum(),
        rewards: header.has.rewards,
        success: header.has.success,
        period_us: robot.period_us,
        period_from: match (&declared, header.period_from) {
            (Some(_), _) => "as declared".to_owned(),
            (None, Some(from)) => from,
            (None, None) => "a guess".to_owned(),
        },
        cameras,
        guesses: robot.guesses().count(),
        clipped,
        notes: header.notes.into_iter().chain(seen.notes).collect(),
    })
}

/// What the reader says of a source in words, without reading all of it.
///
/// # Errors
/// When there is no reader, or it finds fault with the source.
pub fn describe(
    source: &Path,
    options: &[String],
    audience: Audience,
) -> Result<String, ImportError> {
    let mut command = reader::command(audience)?();
    let said = command.arg(source).args(options).arg("--describe").output();
    let said = said.map_err(ImportError::Start)?;
    if said.status.success() {
        return Ok(String::from_utf8_lossy(&said.stdout).trim_end().to_owned());
    }
    let words = String::from_utf8_lossy(&said.stderr).trim_end().to_owned();
    let (what, way_out) = words
        .rsplit_once("\nway out: ")
        .unwrap_or((&words, "correct it"));
    Err(ImportError::fault(
        None,
        None,
        what.to_owned(),
        way_out.to_owned(),
    ))
}

/// Reads everything and writes nothing.
fn look(
    config: &ImportConfig,
    command: Command,
    audience: Audience,
) -> Result<(Header, Seen), ImportError> {
    let (mut reader, header) = Reader::start(command, &config.source, &config.options, 0)?;
    let mut bar = Bar::start(audience, "look", &header);
    let mut seen = Seen {
        actions: vec![[f32::INFINITY, f32::NEG_INFINITY]; header.action.len()],
        episodes: Vec::new(),
        videos: Vec::new(),
        notes: Vec::new(),
    };
    loop {
        if interrupt::requested() {
            return Err(ImportError::Interrupted(0));
        }
        match reader.next()? {
            Next::End => break,
            Next::Skipped(why) => seen.notes.push(format!("left out: {why}")),
            Next::Episode(read) => {
                for row in read.actions.chunks_exact(header.action.len()) {
                    for ([low, high], &value) in seen.actions.iter_mut().zip(row) {
                        *low = low.min(value as f32);
                        *high = high.max(value as f32);
                    }
                }
                seen.notes.extend(read.notes.iter().map(|note| {
                    let step = note
                        .step
                        .map_or_else(String::new, |step| format!(", step {step}"));
                    format!("{}{step}: {}", called(&read.name), note.what)
                }));
                bar.at(&read, seen.episodes.len() + 1);
                seen.episodes.push((read.number, read.name, read.steps));
                seen.videos
                    .push(read.videos.into_iter().map(video).collect());
            }
        }
    }
    bar.progress.finish();
    if seen.episodes.is_empty() {
        return Err(ImportError::Nothing);
    }
    Ok((header, seen))
}

/// How many actions of each channel are outside of their ranges.
fn outside(
    config: &ImportConfig,
    command: Command,
    robot: &Robot,
    seen: &Seen,
) -> Result<Vec<u64>, ImportError> {
    let mut counts = vec![0; robot.action.len()];
    let ranges = || robot.action.iter().map(|it| it.range);
    let inside = |(range, seen): ([f32; 2], &[f32; 2])| range[0] <= seen[0] && seen[1] <= range[1];
    if ranges().zip(&seen.actions).all(inside) {
        return Ok(counts);
    }
    let (mut reader, _) = Reader::start(command, &config.source, &config.options, 0)?;
    let mut first = None;
    loop {
        let read = match reader.next()? {
            Next::End => break,
            Next::Skipped(_) => continue,
            Next::Episode(read) => read,
        };
        for (step, row) in read.actions.chunks_exact(counts.len()).enumerate() {
            for (channel, (&value, [low, high])) in row.iter().zip(ranges()).enumerate() {
                if !(low..=high).contains(&(value as f32)) {
                    counts[channel] += 1;
                    first.get_or_insert_with(|| (channel, value, read.name.clone(), step));
                }
            }
        }
    }
    match first {
        Some((channel, value, episode, step)) if !config.clip => Err(ImportError::ActionRange {
            count: counts.iter().sum(),
            value,
            channel: robot.action[channel].name.clone(),
            range: robot.action[channel].range,
            episode,
            step,
        }),
        _ => Ok(counts),
    }
}

/// Refuses what there is no disk for; what is there already needs none.
fn make_sure_of_room(
    disk: Disk,
    config: &ImportConfig,
    robot: &Robot,
    seen: &Seen,
) -> Result<(), WriteError> {
    let folder = config.id.folder(&config.root);
    let there = minari::begun_episodes(&folder) as usize;
    let missing = seen.episodes.iter().skip(there);
    let steps = missing.clone().map(|(_, _, steps)| *steps as u64).sum();
    let room = Room {
        shape: Shape::of(robot),
        infos: 0,
    };
    let episodes = missing.count() as u64;
    let what = format!("importing {episodes} episodes");
    room.require(disk, &folder, &what, episodes, steps)
}

/// Writes what is not there yet.
fn write(
    config: &ImportConfig,
    command: Command,
    writer: &DatasetWriter,
    robot: &Robot,
    seen: &Seen,
    audience: Audience,
) -> Result<(), ImportError> {
    let held =
        |(index, (_, name, steps)): (u32, &(u64, String, usize))| writer.holds(index, name, *steps);
    let mut index = (0..).zip(&seen.episodes).take_while(|&it| held(it)).count();
    let Some((from, _, _)) = seen.episodes.get(index) else {
        return Ok(());
    };
    let (mut reader, _) = Reader::start(command, &config.source, &config.options, *from)?;
    let progress = audience.start("import", seen.episodes.len() as u64, "episodes");
    progress.skip(index as u64);
    loop {
        let place = u32::try_from(index).unwrap_or(u32::MAX);
        if interrupt::requested() {
            return Err(ImportError::Interrupted(place));
        }
        match reader.next()? {
            Next::End => break,
            Next::Skipped(_) => {}
            Next::Episode(read) => {
                let behaviour = Behaviour {
                    part: read.name.clone(),
                    ..Behaviour::default()
                };
                writer.write(place, behaviour, &record(*read, robot))?;
                index += 1;
                progress.advance(1);
            }
        }
    }
    progress.finish();
    Ok(())
}

/// An episode as a dataset has it: rewards of 0 where there are none, and an end. Whatever is outside of a range then is to be clipped.
fn record(read: EpisodeRead, robot: &Robot) -> EpisodeRecord {
    let steps = read.steps;
    let ranges = robot.action.iter().map(|it| it.range).cycle();
    let terminations = read.terminations.unwrap_or_else(|| vec![false; steps]);
    let mut truncations = read.truncations.unwrap_or_else(|| vec![false; steps]);
    // Where the recording ended is where the episode does.
    if let (Some(truncated), Some(terminated)) = (truncations.last_mut(), terminations.last()) {
        *truncated |= !terminated;
    }
    EpisodeRecord {
        seed: None,
        observations: read.observations,
        actions: (read.actions.iter().zip(ranges))
            .map(|(&value, [low, high])| (value as f32).max(low).min(high))
            .collect(),
        rewards: read.rewards.unwrap_or_else(|| vec![0.0; steps]),
        terminations,
        truncations,
        success: read.success.unwrap_or_else(|| vec![false; steps]),
        infos: Vec::new(),
    }
}

/// How far a source was read: in episodes where it says how many it has, in percent otherwise.
struct Bar {
    progress: Progress,
    percent: bool,
    shown: u64,
}

impl Bar {
    fn start(audience: Audience, label: &str, header: &Header) -> Self {
        let (total, unit) = match header.episodes {
            Some(episodes) => (episodes, "episodes"),
            None => (100, "%"),
        };
        Self {
            progress: audience.start(label, total, unit),
            percent: header.episodes.is_none(),
            shown: 0,
        }
    }

    fn at(&mut self, read: &EpisodeRead, episodes: usize) {
        let now = match self.percent {
            true => (100.0 * read.share.unwrap_or_default().clamp(0.0, 1.0)) as u64,
            false => episodes as u64,
        };
        self.progress.advance(now.saturating_sub(self.shown));
        self.shown = self.shown.max(now);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_disk_has_no_room_for_is_refused_before_anything_is_written() {
        let root = tempfile::tempdir().unwrap();
        let config = ImportConfig {
            source: "logs.csv".into(),
            options: Vec::new(),
            robot: None,
            task: None,
            clip: false,
            id: "mine/logs-v0".parse().unwrap(),
            root: root.path().to_path_buf(),
        };
        let robot = Robot::draft(6, &[[0.0, 1.0]; 2]);
        let seen = Seen {
            actions: Vec::new(),
            episodes: (0..100).map(|it| (it, it.to_string(), 150_000)).collect(),
            notes: Vec::new(),
            videos: Vec::new(),
        };
        let tight = Disk::with_free(|_| Some(500_000_000));
        let error = make_sure_of_room(tight, &config, &robot, &seen).unwrap_err();
        let text = error.to_string();
        assert!(
            text.starts_with(
                "importing 100 episodes needs about 617 MB on the disk, and 500 MB are free at "
            ),
            "{text}"
        );
        assert!(
            text.contains(
                "mine/logs-v0: free some, or name another place with MINARI_DATASETS_PATH"
            ),
            "{text}"
        );
        // Thirty of them are there already.
        for episode in 0..30 {
            let folder = root.path().join(format!("mine/logs-v0/data/{episode}"));
            std::fs::create_dir_all(&folder).unwrap();
            std::fs::write(folder.join("metadata.json"), "{}").unwrap();
        }
        assert!(make_sure_of_room(tight, &config, &robot, &seen).is_ok());
    }
}
