//! `ted import`: other people's logs, made into a dataset.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use firmware_sim::exit::ExitCode;
use firmware_sim::failure::Failure;
use firmware_sim::output::OutputArgs;
use firmware_sim::robot::Robot;
use firmware_sim::worlds;

use crate::dataset::minari::DatasetId;
use crate::import::{ImportConfig, ImportReport, describe, import};

use super::failures::end;
use super::locate::datasets_root;

const EXAMPLES: &str = "\
Examples:
  ted import hopper_medium-v2.hdf5 --task hopper               D4RL; policies fly in its world
  ted import ant_medium-v2.hdf5 --task ant --observations 'observations[:27]'
  ted import low_dim.hdf5 --observations robot0_eef_pos,object robomimic
  ted import my_lerobot_dataset/ --as mine/so101-v0            LeRobot 2.1 or 3
  ted import logs.csv --map map.toml --robot robot.toml        a table; docs/import.md has the map
  ted import run.mcap --map map.toml                           MCAP; a rosbag2 folder works as well
  ted import logs.csv --describe                               what is there, and nothing is written

The dataset is then `ted check`ed, its robot declared (`ted robot draft`), asked about (`ted ask`) and trained on (`ted train`).";

/// Make a dataset of logs that another program wrote
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct ImportArgs {
    /// A file or a folder
    source: PathBuf,
    /// The dataset to write, as namespace/name-vN; mine/<name of the source>-v0 if not given
    #[arg(long = "as", value_name = "ID")]
    id: Option<String>,
    /// The format, where it cannot be told from what is inside
    #[arg(long, value_enum)]
    format: Option<Format>,
    /// Which columns or topics are what: of tables and bags
    #[arg(long, value_name = "FILE")]
    map: Option<PathBuf>,
    /// Which of the observations, in this order, joined with commas
    #[arg(long, value_name = "KEYS")]
    observations: Option<String>,
    /// Which of the actions
    #[arg(long, value_name = "KEY")]
    actions: Option<String>,
    /// Which part of a robomimic file
    #[arg(long, value_name = "NAME")]
    mask: Option<String>,
    /// What to leave out instead of refusing it; may be given several times
    #[arg(long, value_enum)]
    drop: Vec<Drop>,
    /// The robot, where it is declared: docs/your-robot.md
    #[arg(long, value_name = "FILE")]
    robot: Option<PathBuf>,
    /// The task of a world that is known here, such as hopper: its robot recorded the logs, and policies are flown there. `ted worlds`
    /// lists them
    #[arg(long, conflicts_with = "robot")]
    task: Option<String>,
    /// Make actions outside of their ranges the ends of these, and say how many there were
    #[arg(long)]
    clip: bool,
    /// Say what is there and what would be read, and write nothing
    #[arg(long)]
    describe: bool,
    #[command(flatten)]
    output: OutputArgs,
}

/// The formats.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Format {
    D4rl,
    Robomimic,
    Lerobot,
    Minari,
    Npz,
    Csv,
    Jsonl,
    Mcap,
    Rosbag2,
}

/// What can be left out.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Drop {
    /// The rest of an episode from a number on that is not finite
    Nan,
    /// The rest of an episode behind an end flag
    AfterEnd,
    /// Episodes without steps
    Empty,
}

pub(super) fn run(args: &ImportArgs) -> Result<(), Failure> {
    let options = args.options();
    let audience = args.output.audience();
    if args.describe {
        let text = describe(&args.source, &options, audience).map_err(end)?;
        return args.output.print(&text, || text.clone());
    }
    let robot = args.robot.as_deref().map(Robot::read).transpose();
    let task = args.task.as_deref().map(worlds::single).transpose();
    let config = ImportConfig {
        source: args.source.clone(),
        options,
        robot: robot.map_err(end)?,
        task: task.map_err(|error| Failure::new(ExitCode::Usage, error))?,
        clip: args.clip,
        id: args.id()?,
        root: datasets_root(),
    };
    let report = import(&config, audience).map_err(end)?;
    args.output.print(&report, || text(&report))
}

impl ImportArgs {
    fn options(&self) -> Vec<String> {
        let name = |value: &dyn Fn() -> Option<clap::builder::PossibleValue>| {
            value().map(|it| it.get_name().to_owned())
        };
        let format = self.format.and_then(|it| name(&|| it.to_possible_value()));
        let map = (self.map.as_ref()).map(|it| it.display().to_string());
        let mut options: Vec<String> = [
            ("--format", &format),
            ("--map", &map),
            ("--observations", &self.observations),
            ("--actions", &self.actions),
            ("--mask", &self.mask),
        ]
        .into_iter()
        .filter_map(|(flag, value)| Some([flag.to_owned(), value.clone()?]))
        .flatten()
        .collect();
        for it in &self.drop {
            options.extend(
                name(&|| it.to_possible_value())
                    .into_iter()
                    .flat_map(|it| ["--drop".to_owned(), it]),
            );
        }
        options
    }

    fn id(&self) -> Result<DatasetId, Failure> {
        let given = self.id.clone().unwrap_or_else(|| {
            let stem = self
                .source
                .file_stem()
                .unwrap_or_default()
                .to_string_lossy();
            let plain = |c: char| {
                if c.is_ascii_alphanumeric() {
                    c.to_ascii_lowercase()
                } else {
                    '-'
                }
            };
            format!(
                "mine/{}-v0",
                stem.chars()
                    .map(plain)
                    .collect::<String>()
                    .trim_matches('-')
            )
        });
        given
            .parse()
            .map_err(|error| Failure::new(ExitCode::Usage, format_args!("{error}")))
    }
}

/// Notes that are printed.
const SHOWN: usize = 5;

fn text(report: &ImportReport) -> String {
    let said = |it: bool| if it { "as recorded" } else { "none" };
    let mut lines = vec![
        format!(
            "{}: {} episodes, {} steps, from {}, in {}",
            report.dataset,
            report.episodes,
            report.steps,
            report.format,
            report.folder.display()
        ),
        format!("period    {} us: {}", report.period_us, report.period_from),
        format!(
            "rewards   {}{}",
            said(report.rewards),
            if report.rewards {
                ""
            } else {
                ": answers will be a person's (`ted ask`)"
            }
        ),
        format!("success   {}", said(report.success)),
    ];
    if !report.cameras.is_empty() {
        lines.push(format!(
            "videos    of {}: `ted ask` shows them from where they are",
            report.cameras.join(", ")
        ));
    }
    let clipped: u64 = report.clipped.iter().sum();
    if clipped > 0 {
        lines.push(format!(
            "clipped   {clipped} numbers of actions, by channel {:?}",
            report.clipped
        ));
    }
    lines.extend(
        report
            .notes
            .iter()
            .take(SHOWN)
            .map(|note| format!("note      {note}")),
    );
    if report.notes.len() > SHOWN {
        lines.push(format!(
            "          and {} more: --json has them all",
            report.notes.len() - SHOWN
        ));
    }
    if report.guesses > 0 {
        lines.push(format!(
            "robot     {} facts are guesses, and no device flies a policy of it: ted robot draft {}",
            report.guesses, report.dataset
        ));
    }
    lines.push(format!(
        "next      ted check {0}; ted ask {0}; ted train {0}",
        report.dataset
    ));
    lines.join("\n")
}
