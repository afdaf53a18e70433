//! `ted check`: what to know of a dataset before spending a day on it.

use clap::Args;
use firmware_sim::failure::Failure;
use firmware_sim::output::OutputArgs;

use crate::check::{Check, Grade, Moves, short};

use super::inspect::dataset_text;
use super::locate::open_dataset;
use super::table::{Align, Table};

const EXAMPLES: &str = "\
Examples:
  ted check drawer-open-v3
  ted check data/ted/mine-v0
  ted check data/ted/mine-v0 --json

Whatever is odd is said first, the worst at the top. Exit code 0 unless the dataset cannot be read.";

/// Say what every channel of a dataset does, what a run will make of it, and what is odd
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct CheckArgs {
    /// A dataset's folder, its Minari id, or a task that `ted collect` has collected
    dataset: String,
    #[command(flatten)]
    output: OutputArgs,
}

pub(super) fn run(args: &CheckArgs) -> Result<(), Failure> {
    let (dataset, path) = open_dataset(&args.dataset)?;
    let check = Check::of(&dataset, &path);
    args.output.print(&check, || text(&check))
}

/// Glitches that are listed; --json has all of them.
const LISTED: usize = 10;

fn text(check: &Check) -> String {
    let mut parts = vec![
        findings(check),
        dataset_text(&check.dataset),
        episodes(check),
    ];
    parts.extend([observations(check), actions(check)]);
    if !check.glitches.is_empty() {
        parts.push(glitches(check));
    }
    parts.join("\n\n")
}

fn findings(check: &Check) -> String {
    let lines = check.findings.iter().map(|finding| {
        let grade = match finding.grade {
            Grade::Stops => "STOPS",
            Grade::Doubtful => "doubtful",
            Grade::Note => "note",
        };
        format!("{grade:8}  {}", finding.words)
    });
    match check.findings.is_empty() {
        true => "nothing odd".to_owned(),
        false => lines.collect::<Vec<_>>().join("\n"),
    }
}

fn episodes(check: &Check) -> String {
    let it = &check.episodes;
    let [shortest, median, longest] = it.steps;
    let rewards = match it.only_reward {
        Some(_) => "none".to_owned(),
        None => format!(
            "{} to {} a step",
            short(it.rewards[0]),
            short(it.rewards[1])
        ),
    };
    let period = check
        .period_us
        .map_or_else(|| "not known".to_owned(), |it| format!("{it} us"));
    format!(
        "steps     {shortest} to {longest}, {median} in the middle\n\
         ends      {} end the task, {} the recording, {} say neither\n\
         begin     {} different first observations\n\
         rewards   {rewards}\n\
         successes {}\n\
         period    {period}",
        it.terminated, it.truncated, it.unflagged, it.beginnings, it.successes
    )
}

/// The columns that say how a channel moves.
const MOVES: [&str; 5] = ["low", "high", "resolution", "constant", "saturated"];

fn moves(moves: &Moves) -> [String; 5] {
    [
        short(moves.low),
        short(moves.high),
        moves.resolution.map_or_else(|| "-".to_owned(), short),
        format!("{:.0} %", 100.0 * moves.constant),
        format!("{:.0} %", 100.0 * moves.saturated),
    ]
}

fn observations(check: &Check) -> String {
    let mut columns = vec![
        ("#", Align::Right),
        ("observation", Align::Left),
        ("unit", Align::Left),
    ];
    columns.extend(MOVES.map(|name| (name, Align::Right)));
    columns.extend(["glitches", "shift", "divisor"].map(|name| (name, Align::Right)));
    columns.push(("by", Align::Left));
    columns.extend(["guard from", "to"].map(|name| (name, Align::Right)));
    columns.push(("by", Align::Left));
    let mut table = Table::new(&columns);
    for (index, channel) in check.observations.iter().enumerate() {
        let mut cells = vec![
            index.to_string(),
            channel.name.clone(),
            channel.unit.clone(),
        ];
        cells.extend(moves(&channel.moves));
        cells.push(channel.glitches.to_string());
        cells.extend([channel.shift, channel.divisor].map(short));
        cells.push(channel.divisor_by.word().to_owned());
        let guard = channel.guard.map(|ends| ends.map(short));
        cells.extend(guard.unwrap_or_else(|| ["-"; 2].map(str::to_owned)));
        cells.push(channel.guard_by.word().to_owned());
        table.row(cells);
    }
    table.text()
}

fn actions(check: &Check) -> String {
    let mut columns = vec![
        ("#", Align::Right),
        ("action", Align::Left),
        ("unit", Align::Left),
    ];
    columns.extend(MOVES.map(|name| (name, Align::Right)));
    let mut table = Table::new(&columns);
    for (index, channel) in check.actions.iter().enumerate() {
        let mut cells = vec![
            index.to_string(),
            channel.name.clone(),
            channel.unit.clone(),
        ];
        cells.extend(moves(&channel.moves));
        table.row(cells);
    }
    table.text()
}

fn glitches(check: &Check) -> String {
    let columns = [
        "episode",
        "observation",
        "channel",
        "value",
        "usual",
        "deviations",
    ];
    let mut table = Table::new(&columns.map(|name| (name, Align::Right)));
    for text in check.glitches.iter().take(LISTED) {
        let glitch = &text.glitch;
        table.row([
            glitch.episode.to_string(),
            glitch.step.to_string(),
            check.observations[glitch.channel].name.clone(),
            short(glitch.value),
            short(glitch.usual),
            text.deviations
                .map_or_else(|| "-".to_owned(), |it| short(it as f32)),
        ]);
    }
    let more = check.glitches.len().saturating_sub(LISTED);
    match more {
        0 => table.text(),
        more => format!("{}\nand {more} more: --json lists them", table.text()),
    }
}
