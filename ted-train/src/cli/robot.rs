//! `ted robot`: what the numbers of a robot are, drafted from its logs, checked, and declared for a dataset.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use firmware_sim::disk;
use firmware_sim::exit::ExitCode;
use firmware_sim::failure::Failure;
use firmware_sim::output::OutputArgs;
use firmware_sim::robot::Robot;
use serde::Serialize;

use crate::robot::{Fit, declare, draft, fit, guess_text, open_for_draft};

use super::failures::end;
use super::locate::{dataset_path, no_dataset};

const EXAMPLES: &str = "\
From logs to a robot that devices fly:
  ted robot draft my/arm-v0                     writes robot.toml, every guess in it marked as one
  ted robot check robot.toml --for my/arm-v0    what is still a guess, and what of the logs contradicts it
  ted robot declare my/arm-v0 robot.toml        puts it into the dataset; what is trained then carries it

A policy of a robot that nobody declared trains, replays and reports; no device flies it. `ted export RUN` makes its artefact again
once the robot is declared, as long as the ranges of its actions stay.";

/// Say what the numbers of a robot are: names, units, ranges, times, and what is safe
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct RobotArgs {
    #[command(subcommand)]
    command: RobotCommand,
}

#[derive(Debug, Subcommand)]
enum RobotCommand {
    /// Write a file from a dataset, with every guess marked as one
    Draft {
        /// A folder, an id or a task
        dataset: String,
        /// The file to write; one that is there is not overwritten
        #[arg(long, value_name = "FILE", default_value = "robot.toml")]
        out: PathBuf,
        #[command(flatten)]
        output: OutputArgs,
    },
    /// Say what of a file is wrong, what is a guess, and what the logs say against it
    Check {
        /// The robot's file
        file: PathBuf,
        /// The dataset that it is to be the robot of
        #[arg(long = "for", value_name = "DATASET")]
        dataset: Option<String>,
        #[command(flatten)]
        output: OutputArgs,
    },
    /// Put a file into a dataset, which is then one of this robot
    Declare {
        /// A folder, an id or a task
        dataset: String,
        /// The robot's file
        file: PathBuf,
        #[command(flatten)]
        output: OutputArgs,
    },
}

/// What a file says.
#[derive(Debug, Serialize)]
struct Checked {
    name: String,
    observation: usize,
    action: usize,
    declared: bool,
    guesses: Vec<String>,
    fit: Option<Fit>,
}

pub(super) fn run(args: &RobotArgs) -> Result<(), Failure> {
    match &args.command {
        RobotCommand::Draft {
            dataset,
            out,
            output,
        } => {
            let path = dataset_path(dataset);
            let opened = open_for_draft(&path).map_err(|error| no_dataset(dataset, error))?;
            if out.exists() {
                return Err(Failure::new(
                    ExitCode::BadInput,
                    format_args!(
                        "{} is there already: name another file with --out, or check it with `ted robot check`",
                        out.display()
                    ),
                ));
            }
            disk::replace(out, draft(&opened).as_bytes()).map_err(end)?;
            let checked = Checked::of(opened.robot(), None);
            output.print(&checked, || {
                format!("wrote {}\n{}", out.display(), checked.text())
            })
        }
        RobotCommand::Check {
            file,
            dataset,
            output,
        } => {
            let robot = Robot::read(file).map_err(end)?;
            let fitting = dataset.as_ref().map(|name| {
                fit(&dataset_path(name), &robot).map_err(|error| no_dataset(name, error))
            });
            let checked = Checked::of(&robot, fitting.transpose()?);
            output.print(&checked, || checked.text())
        }
        RobotCommand::Declare {
            dataset,
            file,
            output,
        } => {
            let robot = Robot::read(file).map_err(end)?;
            let fitting = declare(&dataset_path(dataset), &robot, file).map_err(end)?;
            let checked = Checked::of(&robot, Some(fitting));
            output.print(&checked, || {
                format!("{dataset} is now one of {}\n{}", robot.name, checked.text())
            })
        }
    }
}

impl Checked {
    fn of(robot: &Robot, fit: Option<Fit>) -> Self {
        Self {
            name: robot.name.clone(),
            observation: robot.observation.len(),
            action: robot.action.len(),
            declared: robot.declared(),
            guesses: (robot.guesses())
                .map(|(channel, fact)| guess_text(channel, fact))
                .collect(),
            fit,
        }
    }

    fn text(&self) -> String {
        let mut lines = vec![format!(
            "{}: {} observation and {} action channels, {}",
            self.name,
            self.observation,
            self.action,
            match self.guesses.len() {
                0 => "declared".to_owned(),
                guesses => format!("undeclared: {guesses} facts are guesses"),
            }
        )];
        lines.extend(
            self.guesses
                .iter()
                .map(|guess| format!("  guessed: {guess}")),
        );
        if let Some(fit) = &self.fit {
            lines.extend(fit.outside.iter().map(|it| {
                format!(
                    "  {} is declared to read {} to {}, and the logs hold {} to {}: correct the range, or look at the logs",
                    it.channel, it.range[0], it.range[1], it.logs[0], it.logs[1]
                )
            }));
            if fit.changes_actions {
                lines.push(
                    "  the ranges of its actions are not those that the dataset had: runs that were trained on it before are of \
                     other data"
                        .to_owned(),
                );
            }
        }
        lines.join("\n")
    }
}
