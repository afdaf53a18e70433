//! Answers that were given after one that was taken back: a file of answers beside the log. Where the same question comes again,
//! nobody is asked twice.

use firmware_sim::disk;

use super::AskError;
use crate::dataset::Dataset;
use crate::preferences::{Line, LogEntry, PreferenceError, PreferenceLog, ReplayTeacher};
use crate::run::{PREFERENCES, RunFolder};

/// The file beside the log, whose lines are those of a log.
const ASIDE: &str = "preferences.aside.jsonl";

/// Whoever repeats what the folder holds of it; none where nothing was set aside.
pub(super) fn open(
    folder: &RunFolder,
    dataset: &Dataset,
) -> Result<Option<ReplayTeacher>, PreferenceError> {
    let path = folder.file(ASIDE);
    let held = path.exists().then(|| ReplayTeacher::open(path, dataset));
    held.transpose()
}

/// Cuts the log off before the line of this place, counted from 0, and sets what stood after it aside. A place beyond its end
/// changes nothing. Killed between the two files, both are whole and nothing was taken back.
pub(super) fn reopen(folder: &RunFolder, dataset: &Dataset, place: usize) -> Result<(), AskError> {
    let (log, path) = (folder.file(PREFERENCES), folder.file(ASIDE));
    let mut kept = PreferenceLog::read(&log, dataset)?;
    if place >= kept.len() {
        return Ok(());
    }
    let mut aside = kept.split_off(place);
    let taken_back = aside.remove(0);
    let mut older = match path.exists() {
        true => PreferenceLog::read(&path, dataset)?,
        false => Vec::new(),
    };
    // The newest answer to a question is the one that counts.
    older.retain(|it| !aside.iter().any(|newer| same(newer, it)));
    aside.append(&mut older);
    aside.retain(|it| !same(&taken_back, it));
    disk::replace(&path, text(&aside, dataset).as_bytes())?;
    disk::replace(&log, text(&kept, dataset).as_bytes())?;
    Ok(())
}

/// Whether both are about the same two clips.
fn same(one: &LogEntry, other: &LogEntry) -> bool {
    one.question.query.is_about(other.question.query.segments)
}

fn text(entries: &[LogEntry], dataset: &Dataset) -> String {
    let line = |entry| Line::new(dataset, entry).text() + "\n";
    entries.iter().map(line).collect()
}
