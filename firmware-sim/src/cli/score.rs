//! `firmware-sim score`: which of the logged episodes are worth uploading.

use std::fmt::{self, Display};
use std::path::PathBuf;

use clap::Args;
use serde::Serialize;
use ted_core::{DiscountClass, NEW_EPISODE, TedDiscount};

use super::artefact;
use super::seat::{self, SeatArgs};
use crate::controller::Numeric;
use crate::exit::ExitCode;
use crate::failure::Failure;
use crate::interrupt;
use crate::output::OutputArgs;
use crate::plants::recording::{Recording, Recordings};
use crate::progress::Progress;
use crate::remote::RemoteScorer;
use crate::scoring::{Judge, ScoreError, Verdict, check, judge, score_recording};

const EXAMPLES: &str = "\
Examples:
  firmware-sim toy toy.ted && firmware-sim fly toy.ted --plant toy --record flight.json
  firmware-sim score toy.ted --recording flight.json
  firmware-sim score toy.ted --recording flight.json --on mps2-an386 --numeric integer --json
  firmware-sim score policy.ted --recording flight.json --on serial:/dev/ttyACM0

The artefact's reward ensemble predicts the return of every episode from what was seen and what was sent; the rewards in the \
recording are not looked at. TED's border, also in the artefact, tells the top k % of the training data from the rest. An \
episode above it would be trained on with the full discount factor gamma, one below with sigma * gamma: the ones above are \
worth uploading, and are named at the end, the best first. A recorded episode counts as new: with a return equal to the \
border's it lies below. A board computes what this machine computes, to the bit.

Exit codes: 0 scored, 2 usage, 3 the artefact or recording is broken, they do not fit each other, or the artefact cannot \
score, 4 QEMU, the firmware or the board is missing or failed, 5 somebody else has the flash image or the serial port, \
7 the golden vectors come out differently, 130 interrupted.";

/// Score recorded episodes as the trainer would, and say which are worth uploading
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct ScoreArgs {
    /// The artefact
    policy: PathBuf,
    /// The recording: what `fly --record` writes
    #[arg(long, value_name = "FILE")]
    recording: PathBuf,
    #[command(flatten)]
    seat: SeatArgs,
    #[command(flatten)]
    output: OutputArgs,
}

/// What `score` reports.
#[derive(Debug, Serialize)]
struct Report {
    policy: String,
    trained_for: String,
    recording: String,
    numeric: Numeric,
    on: String,
    episodes: Vec<EpisodeLine>,
    /// Seeds of the episodes in the top k %, the largest predicted return first.
    upload: Vec<u64>,
}

#[derive(Debug, Serialize)]
struct EpisodeLine {
    seed: u64,
    steps: usize,
    return_hat: f32,
    top_k: bool,
    discount: f32,
}

/// Scores, and prints the report.
pub fn run(args: &ScoreArgs) -> Result<ExitCode, Failure> {
    let bytes = artefact::read(&args.policy)?;
    let artifact = artefact::parse(&bytes, &args.policy)?;
    let recordings = Recordings::read(&args.recording).map_err(|error| {
        Failure::new(
            ExitCode::BadInput,
            format_args!("read recording {}: {error}", args.recording.display()),
        )
    })?;
    check(&recordings, &artifact).map_err(|error| {
        Failure::new(
            error.exit_code(),
            format_args!("score {}: {error}", args.recording.display()),
        )
    })?;
    // Also for a board, before one is started: what cannot score here cannot score there.
    let mut here = judge(&artifact, args.seat.numeric)?;
    let ted = artifact.ted().ok_or(ScoreError::CannotScore {
        missing: "border of TED's",
    })?;
    interrupt::install()
        .map_err(|error| Failure::new(ExitCode::Failure, format_args!("catch Ctrl-C: {error}")))?;
    let audience = args.output.audience();
    let boards = args.seat.boards(bytes.len(), audience)?;
    let progress = audience.start("score", recordings.episodes.len() as u64, "episodes");
    let episodes = match &boards {
        None => score_all(&mut here, &recordings, ted, &progress)?,
        Some(boards) => {
            let connection = seat::connect(boards, &artifact, &bytes, &progress)?;
            let mut there = RemoteScorer::new(connection, args.seat.start());
            score_all(&mut there, &recordings, ted, &progress)?
        }
    };
    progress.finish();
    let report = Report {
        policy: args.policy.display().to_string(),
        trained_for: artifact.contract().task.to_owned(),
        recording: args.recording.display().to_string(),
        numeric: args.seat.numeric,
        on: args.seat.on.to_string(),
        upload: upload(&episodes),
        episodes,
    };
    args.output.print(&report, || report.to_string())?;
    Ok(ExitCode::Success)
}

/// The same for every kind of judge.
fn score_all(
    judge: &mut impl Judge,
    recordings: &Recordings,
    ted: TedDiscount,
    progress: &Progress,
) -> Result<Vec<EpisodeLine>, Failure> {
    let mut lines = Vec::with_capacity(recordings.episodes.len());
    for recording in &recordings.episodes {
        if interrupt::requested() {
            return Err(Failure::new(
                ExitCode::Interrupted,
                format_args!(
                    "score all episodes: stopped on request after {}",
                    lines.len()
                ),
            ));
        }
        let verdict = score_recording(judge, recordings.shape, recording, NEW_EPISODE)?;
        lines.push(EpisodeLine::of(recording, verdict, ted));
        progress.advance(1);
    }
    Ok(lines)
}

/// The seeds of the episodes in the top k %, the best first.
fn upload(episodes: &[EpisodeLine]) -> Vec<u64> {
    let mut worth: Vec<&EpisodeLine> = episodes.iter().filter(|line| line.top_k).collect();
    worth.sort_by(|a, b| b.return_hat.total_cmp(&a.return_hat));
    worth.iter().map(|line| line.seed).collect()
}

impl EpisodeLine {
    fn of(recording: &Recording, verdict: Verdict, ted: TedDiscount) -> Self {
        Self {
            seed: recording.seed,
            steps: recording.rewards.len(),
            return_hat: verdict.return_hat,
            top_k: verdict.class == DiscountClass::TopK,
            discount: ted.discount(verdict.class),
        }
    }
}

impl Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let numbers = match self.numeric {
            Numeric::F32 => "floats",
            Numeric::Integer => "integers",
        };
        writeln!(f, "policy      {}, for {}", self.policy, self.trained_for)?;
        writeln!(
            f,
            "scored      {} episodes of {} on {}, in {numbers}\n",
            self.episodes.len(),
            self.recording,
            self.on
        )?;
        writeln!(
            f,
            "{:>20}  {:>6}  {:>10}  {:9}  {:>8}",
            "seed", "steps", "predicted", "class", "discount"
        )?;
        for line in &self.episodes {
            let class = if line.top_k { "top k %" } else { "below" };
            writeln!(
                f,
                "{:>20}  {:>6}  {:>10.3}  {class:9}  {:>8.4}",
                line.seed, line.steps, line.return_hat, line.discount
            )?;
        }
        let (worth, all) = (self.upload.len(), self.episodes.len());
        match worth {
            0 => write!(f, "\nupload      none of {all}: all lie below TED's border"),
            _ => {
                write!(f, "\nupload      {worth} of {all}, the best first:")?;
                self.upload
                    .iter()
                    .try_for_each(|seed| write!(f, "\n{seed:>20}"))
            }
        }
    }
}
