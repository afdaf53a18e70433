//! A study as an array of Slurm jobs, one for each of its parts, on a cluster whose machines share a folder.

use std::io;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::process::Command;

use firmware_sim::disk::{self, WriteError};
use serde::Serialize;

/// The variable that Slurm gives each job of an array its number in.
const PART: &str = "$SLURM_ARRAY_TASK_ID";

/// What is handed over.
#[derive(Clone, Debug)]
pub struct Submission<'a> {
    /// The command of a part, word by word, without its `--shard`.
    pub command: &'a [String],
    /// Parts.
    pub parts: NonZeroUsize,
    /// Further options of `sbatch`.
    pub options: &'a [String],
    /// Where each job's output goes.
    pub logs: &'a Path,
}

/// What Slurm took.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Submitted {
    /// The job's number.
    pub job: String,
    /// Parts, which are the jobs of the array.
    pub parts: NonZeroUsize,
    /// The folder of their output.
    pub logs: PathBuf,
}

/// Why nothing was handed over.
#[derive(Debug, thiserror::Error)]
pub enum SlurmError {
    /// There is no `sbatch`.
    #[error(
        "cannot run sbatch: {0}; submit from a machine of the cluster that has Slurm's commands"
    )]
    NoCommand(io::Error),
    /// Slurm will not have it.
    #[error("sbatch refused: {0}")]
    Refused(String),
    /// No place for the jobs' output.
    #[error(transparent)]
    Write(#[from] WriteError),
}

impl Submission<'_> {
    /// Hands it over; each job runs in this folder, with this environment, when it is its turn.
    ///
    /// # Errors
    /// When there is no Slurm here, or it refuses.
    pub fn submit(&self) -> Result<Submitted, SlurmError> {
        disk::create_folder(self.logs)?;
        let output = Command::new("sbatch")
            .args(["--parsable", "--job-name=ted-study"])
            .arg(format!("--array=1-{}", self.parts))
            .arg(format!("--output={}/%A-%a.log", self.logs.display()))
            .args(self.options)
            .arg(format!("--wrap={}", self.script()))
            .output()
            .map_err(SlurmError::NoCommand)?;
        let said = |bytes: &[u8]| String::from_utf8_lossy(bytes).trim().to_owned();
        if !output.status.success() {
            return Err(SlurmError::Refused(said(&output.stderr)));
        }
        // `123`, or `123;cluster`.
        let job = said(&output.stdout);
        let job = job.split(';').next().unwrap_or_default().to_owned();
        Ok(Submitted {
            job,
            parts: self.parts,
            logs: self.logs.to_path_buf(),
        })
    }

    /// What the shell of a job is told.
    fn script(&self) -> String {
        let words: Vec<String> = self.command.iter().map(|word| quoted(word)).collect();
        format!("exec {} --shard {PART}/{}", words.join(" "), self.parts)
    }
}

/// A word that a shell leaves as it is.
fn quoted(word: &str) -> String {
    format!("'{}'", word.replace('\'', r"'\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shell_gives_the_command_its_words_and_the_number_of_its_part() {
        let words = ["printf", "%s|", "a b", "it's", "$HOME", "`x`"].map(str::to_owned);
        let submission = Submission {
            command: &words,
            parts: NonZeroUsize::new(8).unwrap(),
            options: &[],
            logs: Path::new("logs"),
        };
        let mut shell = Command::new("sh");
        shell.args(["-c", &submission.script()]);
        let said = shell.env("SLURM_ARRAY_TASK_ID", "2").output().unwrap();
        let said = String::from_utf8(said.stdout).unwrap();
        assert_eq!(said, "a b|it's|$HOME|`x`|--shard|2/8|");
    }
}
