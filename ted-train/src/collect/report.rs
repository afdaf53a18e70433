//! What a collected dataset came to, in the terms of the paper's table of datasets.

use crate::dataset::Dataset;
use crate::dataset::minari::EpisodeNote;
use serde::Serialize;
use std::path::PathBuf;

/// What a dataset came to.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CollectReport {
    /// `namespace/name-vN`.
    pub dataset: String,
    /// Where it lies.
    pub folder: PathBuf,
    /// Episodes recorded by this run; the others were there before.
    pub collected: usize,
    /// Each part of the recipe, such as `noisy`, in the order of their first episodes.
    pub parts: Vec<PartReport>,
    /// All episodes together.
    pub mix: PartReport,
}

/// True returns and success over some episodes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PartReport {
    /// Which episodes.
    pub part: String,
    /// How many.
    pub episodes: usize,
    /// Mean true return.
    pub mean_return: f64,
    /// Largest true return.
    pub max_return: f64,
    /// Share of episodes in which the task was solved at some step.
    pub success_rate: f64,
}

impl PartReport {
    /// Of the logs that somebody else recorded.
    #[must_use]
    pub fn of_logs(dataset: &Dataset) -> Self {
        let episodes = dataset.episodes();
        Self {
            part: "logs".to_owned(),
            episodes: episodes.len(),
            mean_return: dataset.mean_return_true(),
            max_return: dataset.max_return_true(),
            success_rate: episodes.iter().filter(|it| it.success).count() as f64
                / episodes.len().max(1) as f64,
        }
    }
}

impl CollectReport {
    /// The report over the notes of all episodes in order.
    pub(super) fn new(
        dataset: String,
        folder: PathBuf,
        collected: usize,
        notes: Vec<EpisodeNote>,
    ) -> Self {
        let mut parts: Vec<(&str, Vec<&EpisodeNote>)> = Vec::new();
        for note in &notes {
            let name = note.behaviour.part.as_str();
            match parts.iter_mut().find(|(part, _)| *part == name) {
                Some((_, members)) => members.push(note),
                None => parts.push((name, vec![note])),
            }
        }
        let parts = parts
            .into_iter()
            .map(|(part, notes)| PartReport::new(part, &notes))
            .collect();
        Self {
            dataset,
            folder,
            collected,
            parts,
            mix: PartReport::new("mix", &notes.iter().collect::<Vec<_>>()),
        }
    }
}

impl PartReport {
    fn new(part: &str, notes: &[&EpisodeNote]) -> Self {
        let count = notes.len() as f64;
        Self {
            part: part.into(),
            episodes: notes.len(),
            mean_return: notes.iter().map(|note| note.return_true).sum::<f64>() / count,
            max_return: notes
                .iter()
                .map(|note| note.return_true)
                .fold(f64::NEG_INFINITY, f64::max),
            success_rate: notes.iter().filter(|note| note.success).count() as f64 / count,
        }
    }
}
