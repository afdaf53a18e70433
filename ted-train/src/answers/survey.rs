//! What files of answers say, line by line, and what it would be used for.

use std::path::PathBuf;

use serde::Serialize;

use crate::dataset::Dataset;
use crate::preferences::{
    Answer, AnswerFile, Finding, Line, LogEntry, Numbered, Span, Use, account, findings,
};

/// All lines of some files, as people read them.
#[derive(Debug, Serialize)]
pub struct Survey {
    /// The lines, numbered over all files.
    pub answers: Vec<AnswerText>,
    /// Lines that are no preferences, each with its reason.
    pub faults: Vec<String>,
    /// What may not be meant.
    pub findings: Vec<Finding>,
}

/// A line.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct AnswerText {
    /// Its number over all files.
    pub number: usize,
    /// The file that it stands in.
    pub file: PathBuf,
    /// Where it stands there, counted from 1.
    pub line: usize,
    /// Who was asked.
    pub by: String,
    /// When, if somebody wrote it down.
    pub at: Option<String>,
    /// Id of the dataset that was asked about.
    pub dataset: String,
    /// Its digest.
    pub digest: String,
    /// The two clips, in the order in which they were shown.
    pub clips: [ClipText; 2],
    /// The answer in words.
    pub answer: &'static str,
    /// Why this was asked of all things.
    pub why: Option<String>,
    /// What it would be used for, where that was asked.
    #[serde(rename = "use", skip_serializing_if = "Option::is_none")]
    pub used: Option<Use>,
}

/// A clip.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct ClipText {
    /// The episode.
    pub episode: u32,
    /// Its first step, counted from 0.
    pub first: u32,
    /// Its last step.
    pub last: u64,
}

/// What lines are looked at for.
#[derive(Clone, Copy, Debug)]
pub enum About<'a> {
    /// Nothing but themselves.
    Nothing,
    /// A dataset: which of them fit.
    Dataset(&'a Dataset),
    /// A run on a dataset, with the questions that it has asked.
    Run(&'a Dataset, &'a [LogEntry]),
}

impl From<Span> for ClipText {
    fn from(span: Span) -> Self {
        let end = u64::from(span.start) + u64::from(span.length);
        Self {
            episode: span.episode,
            first: span.start,
            last: end.saturating_sub(1),
        }
    }
}

impl Survey {
    /// What these files say, and what it is worth to somebody.
    #[must_use]
    pub fn of(files: &[AnswerFile], about: About<'_>) -> Self {
        let all = || {
            files
                .iter()
                .flat_map(|file| file.lines.iter().map(move |line| (file, line)))
        };
        let lines: Vec<Numbered> = (1..)
            .zip(all())
            .map(|(number, (_, it))| Numbered {
                number,
                line: it.line.clone(),
            })
            .collect();
        let uses = uses(&lines, about);
        let text = |((file, held), it): ((&AnswerFile, &Numbered), &Numbered)| AnswerText {
            number: it.number,
            file: file.path.clone(),
            line: held.number,
            by: it.line.by.clone(),
            at: it.line.at.clone(),
            dataset: it.line.dataset.clone(),
            digest: it.line.digest.clone(),
            clips: it.line.segments.map(ClipText::from),
            answer: in_words(&it.line),
            why: it.line.why.clone(),
            used: uses.iter().find(|used| used.line == it.number).cloned(),
        };
        Self {
            answers: all().zip(&lines).map(text).collect(),
            faults: files
                .iter()
                .flat_map(|file| &file.faults)
                .map(ToString::to_string)
                .collect(),
            findings: findings(&lines),
        }
    }
}

/// What each line would be used for; nothing where that was not asked.
fn uses(lines: &[Numbered], about: About<'_>) -> Vec<Use> {
    let (dataset, asked) = match about {
        About::Nothing => return Vec::new(),
        About::Dataset(dataset) => (dataset, None),
        About::Run(dataset, asked) => (dataset, Some(asked)),
    };
    let (mut fitting, mut uses) = (Vec::new(), Vec::new());
    for it in lines {
        let why_not = it.line.entry(dataset).err().map(|why| why.to_string());
        match (why_not, asked) {
            (None, Some(_)) => fitting.push(it.clone()),
            (why_not, _) => uses.push(Use {
                line: it.number,
                questions: Vec::new(),
                why_not,
            }),
        }
    }
    uses.extend(account(&fitting, asked.unwrap_or_default()));
    uses.sort_by_key(|it| it.line);
    uses
}

fn in_words(line: &Line) -> &'static str {
    match line.answer {
        Some(Answer::First) => "the first is better",
        Some(Answer::Second) => "the second is better",
        Some(Answer::Equal) => "they are equal",
        None if line.puts_off() => "put off",
        None => "cannot tell",
    }
}
