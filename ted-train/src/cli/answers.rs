//! `ted answers`: files of answers, as people read them.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use firmware_sim::exit::ExitCode;
use firmware_sim::failure::Failure;
use firmware_sim::output::OutputArgs;
use serde::Serialize;

use crate::answers::import::{Shape, Source, import, keep};
use crate::answers::{About, AnswerText, ClipText, Merged, Survey, merge};
use crate::preferences::{AnswerFile, PreferenceLog};
use crate::run::{PREFERENCES, RunFolder};

use super::failures::end;
use super::locate::{dataset_of, open_dataset};
use super::table::{Align, Table};

const EXAMPLES: &str = "\
Examples:
  ted answers runs/drawer-open-v3/steer/seed-0/preferences.jsonl
  ted answers mine.jsonl --for drawer-open-v3                     which lines are about that dataset
  ted answers mine.jsonl --for runs/mine                          which lines that run uses
  ted answers anna.jsonl ben.jsonl --merge both.jsonl
  ted answers --import csv labels.csv --dataset drawer-open-v3 --out mine.jsonl

A table of answers (csv) has the columns episode_1,start_1,length_1,episode_2,start_2,length_2,label and, if there are such, by and at; \
label is 0 (the first is better), 1 (the second is better), 0.5 (equal) or empty (could not tell). Of Preference Transformer (pt) and \
of Uni-RLHF (uni-rlhf), name the folder with the files of one task.

Exit code 3 when a line is no preference.";

/// Print, check and merge files of answers, and import those of other programs
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct AnswersArgs {
    /// Files of answers; of --import, the file or folder to import
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// Write all lines into one new file, in order, those that are the same to the letter once
    #[arg(long, value_name = "OUT", conflicts_with = "import")]
    merge: Option<PathBuf>,
    /// Tell which lines would be used for a dataset, or for the folder of a run
    #[arg(long = "for", value_name = "RUN|DATASET", conflicts_with = "import")]
    about: Option<String>,
    /// Import answers in the shape of another program, with --dataset and --out
    #[arg(long, value_enum, value_name = "SHAPE", requires_all = ["dataset", "out"])]
    import: Option<ShapeArg>,
    /// The dataset that imported answers are about
    #[arg(long, requires = "import")]
    dataset: Option<String>,
    /// The new file to import into
    #[arg(long, value_name = "LOG", requires = "import")]
    out: Option<PathBuf>,
    /// Who gave the imported answers, where the file does not say
    #[arg(long, default_value = "imported", requires = "import")]
    by: String,
    /// Steps of an imported clip, where neither the file nor its name says so
    #[arg(long, requires = "import")]
    length: Option<u32>,
    #[command(flatten)]
    output: OutputArgs,
}

/// Shapes that can be imported.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum ShapeArg {
    /// A table
    Csv,
    /// Preference Transformer
    Pt,
    /// Uni-RLHF
    UniRlhf,
}

/// What the command prints.
#[derive(Debug, Serialize)]
struct Report {
    #[serde(flatten)]
    survey: Survey,
    #[serde(skip_serializing_if = "Option::is_none")]
    merged: Option<Merged>,
}

pub(super) fn run(args: &AnswersArgs) -> Result<(), Failure> {
    if let (Some(shape), Some(dataset), Some(out)) = (args.import, &args.dataset, &args.out) {
        return bring(shape, dataset, out, args);
    }
    let files = args.files.iter().map(AnswerFile::read);
    let files: Vec<AnswerFile> = files.collect::<Result<_, _>>().map_err(end)?;
    let survey = match &args.about {
        None => Survey::of(&files, About::Nothing),
        Some(name) if Path::new(name).join("config.toml").is_file() => {
            let folder = RunFolder::open(Path::new(name)).map_err(end)?;
            let dataset = dataset_of(&folder, None)?;
            let asked = PreferenceLog::read(folder.file(PREFERENCES), &dataset).map_err(end)?;
            Survey::of(&files, About::Run(&dataset, &asked))
        }
        Some(name) => Survey::of(&files, About::Dataset(&open_dataset(name)?.0)),
    };
    let broken = survey.faults.first().cloned();
    let merged = match (&args.merge, &broken) {
        (Some(out), None) => {
            new(out)?;
            Some(merge(&files, out).map_err(end)?)
        }
        _ => None,
    };
    let report = Report { survey, merged };
    args.output.print(&report, || report.text())?;
    match (broken, &args.merge) {
        (None, _) => Ok(()),
        (Some(fault), None) => Err(Failure::new(ExitCode::BadInput, fault)),
        (Some(fault), Some(out)) => Err(Failure::new(
            ExitCode::BadInput,
            format_args!("{fault}; {} was not written", out.display()),
        )),
    }
}

/// Imports answers, and prints what they say.
fn bring(shape: ShapeArg, dataset: &str, out: &Path, args: &AnswersArgs) -> Result<(), Failure> {
    let [file] = args.files.as_slice() else {
        return Err(Failure::new(
            ExitCode::Usage,
            "--import takes one file or folder at a time: import each, and join them with --merge",
        ));
    };
    new(out)?;
    let (dataset, _) = open_dataset(dataset)?;
    let source = Source {
        dataset: &dataset,
        by: &args.by,
        length: args.length,
    };
    let shape = match shape {
        ShapeArg::Csv => Shape::Csv,
        ShapeArg::Pt => Shape::Pt,
        ShapeArg::UniRlhf => Shape::UniRlhf,
    };
    let lines = import(shape, file, &source).map_err(end)?;
    keep(&lines, out).map_err(end)?;
    let written = AnswerFile::read(out).map_err(end)?;
    let report = Report {
        survey: Survey::of(&[written], About::Nothing),
        merged: None,
    };
    args.output.print(&report, || report.text())
}

/// Refuses to write over anything: it may be the only place of an answer.
fn new(out: &Path) -> Result<(), Failure> {
    match out.exists() {
        false => Ok(()),
        true => Err(Failure::new(
            ExitCode::Usage,
            format_args!(
                "{} exists, and answers are never written over: name a new file",
                out.display()
            ),
        )),
    }
}

impl Report {
    fn text(&self) -> String {
        let Survey {
            answers,
            faults,
            findings,
        } = &self.survey;
        let mut parts = datasets(answers);
        if !answers.is_empty() {
            parts.push(table(answers));
        }
        parts.extend(
            faults
                .iter()
                .map(|fault| format!("not a preference: {fault}")),
        );
        parts.extend(
            findings
                .iter()
                .map(|finding| format!("note: {}", finding.says)),
        );
        if let Some(merged) = &self.merged {
            parts.push(format!(
                "wrote {}: {} lines; {} more were the same to the letter as one before",
                merged.path.display(),
                merged.lines,
                merged.duplicates
            ));
        }
        parts.join("\n")
    }
}

/// A line for each dataset that is asked about.
fn datasets(answers: &[AnswerText]) -> Vec<String> {
    let mut known: Vec<(&str, &str, usize)> = Vec::new();
    for it in answers {
        match known.iter_mut().find(|(_, digest, _)| *digest == it.digest) {
            Some((.., count)) => *count += 1,
            None => known.push((&it.dataset, &it.digest, 1)),
        }
    }
    let line = |(id, digest, count): &(&str, &str, usize)| {
        let short: String = digest.chars().take(12).collect();
        format!("{count} lines about {id}, digest {short}...")
    };
    if known.is_empty() {
        return vec!["no answers".to_owned()];
    }
    known.iter().map(line).collect()
}

/// A row for each line; what no line has gets no column.
fn table(answers: &[AnswerText]) -> String {
    let several = answers.iter().any(|it| it.file != answers[0].file);
    let dated = answers.iter().any(|it| it.at.is_some());
    let reasoned = answers.iter().any(|it| it.why.is_some());
    let used = answers.iter().any(|it| it.used.is_some());
    let columns = [
        (true, "line", Align::Right),
        (several, "stands in", Align::Left),
        (true, "who", Align::Left),
        (dated, "when", Align::Left),
        (true, "first clip", Align::Left),
        (true, "second clip", Align::Left),
        (true, "answer", Align::Left),
        (used, "used", Align::Left),
        (reasoned, "why it was asked", Align::Left),
    ];
    let shown: Vec<(&str, Align)> = columns
        .iter()
        .filter(|(shown, ..)| *shown)
        .map(|&(_, name, align)| (name, align))
        .collect();
    let mut table = Table::new(&shown);
    for it in answers {
        let [first, second] = it.clips.map(clip);
        let cells = [
            it.number.to_string(),
            format!("{} {}", it.file.display(), it.line),
            it.by.clone(),
            it.at.clone().unwrap_or_default(),
            first,
            second,
            it.answer.to_owned(),
            use_of(it),
            it.why.clone().unwrap_or_default(),
        ];
        let shown = columns.iter().zip(cells).filter(|((shown, ..), _)| *shown);
        table.row(shown.map(|(_, cell)| cell));
    }
    table.text()
}

fn clip(clip: ClipText) -> String {
    format!(
        "episode {}, steps {} to {}",
        clip.episode, clip.first, clip.last
    )
}

fn use_of(answer: &AnswerText) -> String {
    let Some(used) = &answer.used else {
        return String::new();
    };
    match (&used.why_not, used.questions.as_slice()) {
        (Some(why), _) => format!("no: {why}"),
        (None, []) => "yes".to_owned(),
        (None, questions) => {
            let questions: Vec<String> = questions.iter().map(ToString::to_string).collect();
            format!("question {}", questions.join(", "))
        }
    }
}
