//! The reader of other people's logs: a Python process in an environment of its own, which is installed on first use.
//! `source-reader/README.md` says what it reads and what it sends.

use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, Stdio};

use firmware_sim::bridge::environment::{INSTALLER, Kit, SetupError, call};
use firmware_sim::last_words::{LastWords, Listener};
use firmware_sim::progress::Audience;
use serde::Deserialize;

use super::ImportError;

macro_rules! carried {
    ($($name:literal),* $(,)?) => {
        &[INSTALLER[0], INSTALLER[1], $(($name, include_str!(concat!("../../source-reader/", $name)))),*]
    };
}

/// What the reader's environment is made of.
const READER: Kit = Kit {
    name: "reader",
    what: "the reader of logs",
    variable: "TED_READER_VENV",
    files: carried!(
        "arrays.py",
        "arrow_columns.py",
        "bags.py",
        "check.py",
        "cutting.py",
        "describe.py",
        "detect.py",
        "faults.py",
        "fields.py",
        "frames.py",
        "from_bag.py",
        "from_d4rl.py",
        "from_lerobot.py",
        "from_minari.py",
        "from_robomimic.py",
        "from_table.py",
        "mapping.py",
        "minari_arrow.py",
        "minari_hdf5.py",
        "minari_metadata.py",
        "minari_spaces.py",
        "model.py",
        "npy_rows.py",
        "read_source.py",
        "requirements.lock",
        "resample.py",
        "tables.py",
        "timing.py",
    ),
    checked: false,
};

/// The longest text of a frame: far more than any source has to say.
const LONGEST: usize = 64 << 20;

/// A channel as the source has it.
#[derive(Clone, Debug, Deserialize)]
pub(super) struct Channel {
    pub name: String,
    pub low: Option<f64>,
    pub high: Option<f64>,
}

/// What the reader says of a source before its episodes.
#[derive(Clone, Debug, Deserialize)]
pub(super) struct Header {
    pub format: String,
    pub observation: Vec<Channel>,
    pub action: Vec<Channel>,
    pub period_us: Option<u32>,
    pub period_from: Option<String>,
    pub episodes: Option<u64>,
    pub has: Has,
    pub notes: Vec<String>,
}

/// Which arrays a source has.
#[derive(Clone, Copy, Debug, Deserialize)]
pub(super) struct Has {
    pub rewards: bool,
    pub success: bool,
}

/// Something odd that was dealt with.
#[derive(Clone, Debug, Deserialize)]
pub(super) struct Note {
    pub step: Option<u64>,
    pub what: String,
}

/// Where one camera's video of an episode is.
#[derive(Clone, Debug, Deserialize)]
pub(super) struct Filmed {
    pub feature: String,
    pub path: PathBuf,
    pub from_s: f64,
    pub step_s: f64,
    pub fps: f64,
}

#[derive(Clone, Debug, Deserialize)]
struct Array {
    name: String,
    #[serde(rename = "type")]
    kind: String,
    shape: Vec<usize>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
enum About {
    Source(Header),
    Episode {
        number: u64,
        name: String,
        steps: usize,
        share: Option<f64>,
        arrays: Vec<Array>,
        notes: Vec<Note>,
        videos: Vec<Filmed>,
    },
    Skipped {
        name: String,
        why: String,
    },
    Fault {
        episode: Option<String>,
        step: Option<u64>,
        what: String,
        way_out: String,
    },
    End {},
}

/// An episode, its numbers as they were in the source.
#[derive(Clone, Debug, Default)]
pub(super) struct EpisodeRead {
    pub number: u64,
    pub name: String,
    pub steps: usize,
    /// How much of the source was read, where nobody knows how many episodes it has.
    pub share: Option<f64>,
    pub notes: Vec<Note>,
    pub videos: Vec<Filmed>,
    pub observations: Vec<f32>,
    pub actions: Vec<f64>,
    pub rewards: Option<Vec<f64>>,
    pub terminations: Option<Vec<bool>>,
    pub truncations: Option<Vec<bool>>,
    pub success: Option<Vec<bool>>,
}

/// What comes next of a source.
pub(super) enum Next {
    Episode(Box<EpisodeRead>),
    /// A piece that gave no step, and why.
    Skipped(String),
    End,
}

/// A process that reads a source.
pub(super) struct Reader {
    child: Child,
    frames: BufReader<ChildStdout>,
    words: Listener,
}

impl Drop for Reader {
    fn drop(&mut self) {
        // Both fail only for a process that is gone already.
        self.child.kill().ok();
        self.child.wait().ok();
    }
}

/// How the reader is called: its interpreter and its script, installed first if need be.
///
/// # Errors
/// When there is no Python, no network on first use, or no room.
pub(super) fn command(audience: Audience) -> Result<impl Fn() -> Command, SetupError> {
    let (python, folder) = READER.ensure(audience)?;
    let script = folder.join("read_source.py");
    Ok(move || {
        let mut command = call(&python);
        command.arg("-Es").arg(&script);
        command
    })
}

impl Reader {
    /// Starts reading.
    ///
    /// # Errors
    /// When the process does not start, or finds fault with the source.
    pub(super) fn start(
        mut command: Command,
        source: &Path,
        options: &[String],
        from: u64,
    ) -> Result<(Self, Header), ImportError> {
        command.arg(source).args(options);
        command.arg("--from-episode").arg(from.to_string());
        let piped = (command.stdin(Stdio::null()).stdout(Stdio::piped())).stderr(Stdio::piped());
        let mut child = piped.spawn().map_err(ImportError::Start)?;
        let (Some(stdout), Some(stderr)) = (child.stdout.take(), child.stderr.take()) else {
            return Err(ImportError::Start(std::io::ErrorKind::BrokenPipe.into()));
        };
        let mut reader = Self {
            child,
            frames: BufReader::new(stdout),
            words: Listener::new(stderr),
        };
        match reader.about()? {
            About::Source(header) => Ok((reader, header)),
            About::Fault {
                episode,
                step,
                what,
                way_out,
            } => Err(ImportError::fault(episode, step, what, way_out)),
            _ => Err(reader.nonsense()),
        }
    }

    /// The next episode.
    ///
    /// # Errors
    /// When the reader finds fault with the source, or ends by itself.
    pub(super) fn next(&mut self) -> Result<Next, ImportError> {
        match self.about()? {
            About::Episode {
                number,
                name,
                steps,
                share,
                arrays,
                notes,
                videos,
            } => {
                let mut read = EpisodeRead {
                    number,
                    name,
                    steps,
                    share,
                    notes,
                    videos,
                    ..EpisodeRead::default()
                };
                for array in &arrays {
                    self.take(array, &mut read)?;
                }
                Ok(Next::Episode(Box::new(read)))
            }
            About::Skipped { name, why } => Ok(Next::Skipped(format!("{name}: {why}"))),
            About::End {} => Ok(Next::End),
            About::Fault {
                episode,
                step,
                what,
                way_out,
            } => Err(ImportError::fault(episode, step, what, way_out)),
            About::Source(_) => Err(self.nonsense()),
        }
    }

    fn take(&mut self, array: &Array, into: &mut EpisodeRead) -> Result<(), ImportError> {
        let count: usize = array.shape.iter().product();
        let width = match array.kind.as_str() {
            "f32" => 4,
            "f64" => 8,
            _ => 1,
        };
        let bytes = self.bytes(count * width)?;
        let doubles = || {
            bytes
                .chunks_exact(8)
                .map(|it| f64::from_le_bytes(it.try_into().unwrap_or_default()))
        };
        let flags = || bytes.iter().map(|&it| it != 0).collect();
        match array.name.as_str() {
            "observations" => {
                let floats = bytes.chunks_exact(4);
                let floats = floats.map(|it| f32::from_le_bytes(it.try_into().unwrap_or_default()));
                into.observations = floats.collect();
            }
            "actions" => into.actions = doubles().collect(),
            "rewards" => into.rewards = Some(doubles().collect()),
            "terminations" => into.terminations = Some(flags()),
            "truncations" => into.truncations = Some(flags()),
            "success" => into.success = Some(flags()),
            _ => {}
        }
        Ok(())
    }

    fn about(&mut self) -> Result<About, ImportError> {
        let length = self.bytes(4)?;
        let length = u32::from_le_bytes(length.try_into().unwrap_or_default()) as usize;
        if length > LONGEST {
            return Err(self.nonsense());
        }
        let text = self.bytes(length)?;
        serde_json::from_slice(&text).map_err(|_| self.nonsense())
    }

    fn bytes(&mut self, count: usize) -> Result<Vec<u8>, ImportError> {
        let mut bytes = vec![0; count];
        match self.frames.read_exact(&mut bytes) {
            Ok(()) => Ok(bytes),
            Err(_) => Err(self.nonsense()),
        }
    }

    /// The reader ended by itself, or did not speak its own language.
    fn nonsense(&mut self) -> ImportError {
        self.child.kill().ok();
        self.child.wait().ok();
        let words: LastWords = self.words.words();
        ImportError::Ended(words)
    }
}
