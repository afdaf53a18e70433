//! `ted worlds`: where policies can be flown.

use clap::Args;
use firmware_sim::failure::Failure;
use firmware_sim::output::OutputArgs;
use firmware_sim::worlds::{Kind, LISTED};
use serde::Serialize;

use super::table::{Align, Table};

const EXAMPLES: &str = "\
Examples:
  ted worlds
  ted worlds metaworld             all of its tasks
  ted worlds --json

A world of your own is a Python file, or an environment of Gymnasium: ted eval RUN --world my_world.py";

/// List the worlds that policies can be flown in, and their tasks
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct WorldsArgs {
    /// The world whose tasks are all to be listed
    #[arg(value_parser = name())]
    world: Option<String>,
    #[command(flatten)]
    output: OutputArgs,
}

/// A world.
#[derive(Serialize)]
struct Line {
    name: &'static str,
    about: &'static str,
    tasks: Vec<TaskLine>,
    groups: Vec<(&'static str, &'static [&'static str])>,
}

/// A task.
#[derive(Serialize)]
struct TaskLine {
    task: &'static str,
    robot: String,
    observation: usize,
    action: usize,
    period_us: u32,
    /// Whether there is a scripted policy that `ted collect` records.
    collects: bool,
    /// The returns that a score of 0 and of 1 stand for, where they do not depend on the logs.
    yardstick: Option<[f64; 2]>,
}

fn name() -> clap::builder::PossibleValuesParser {
    LISTED.map(Kind::name).into()
}

pub(super) fn run(args: &WorldsArgs) -> Result<(), Failure> {
    let wanted = |kind: &&dyn Kind| args.world.as_deref().is_none_or(|name| name == kind.name());
    let lines: Vec<Line> = LISTED.into_iter().filter(wanted).map(line).collect();
    args.output.print(&lines, || match lines.as_slice() {
        [one] => one_world(one),
        all => overview(all),
    })
}

fn line(kind: &dyn Kind) -> Line {
    let task = |task| {
        let robot = kind.robot(task);
        TaskLine {
            task,
            observation: robot.observation.len(),
            action: robot.action.len(),
            period_us: robot.period_us,
            robot: robot.name,
            collects: kind.collection(task).is_some(),
            yardstick: kind.yardstick(task),
        }
    };
    Line {
        name: kind.name(),
        about: kind.about(),
        tasks: kind.tasks().into_iter().map(task).collect(),
        groups: kind.groups().to_vec(),
    }
}

fn overview(lines: &[Line]) -> String {
    let mut text: Vec<String> = (lines.iter())
        .map(|line| {
            let names: Vec<&str> = line.tasks.iter().map(|it| it.task).collect();
            let tasks = match names.as_slice() {
                [first, second, _, _, _, _, _, _, ..] => {
                    format!(
                        "{first}, {second} and {} others: ted worlds {}",
                        names.len() - 2,
                        line.name
                    )
                }
                few => few.join(", "),
            };
            format!("{}: {}\n  {tasks}", line.name, line.about)
        })
        .collect();
    text.push(
        "your own: a Python file with make(), reset() and step(), or an environment of Gymnasium\n  ted eval RUN --world my_world.py | gym:ID"
            .to_owned(),
    );
    text.join("\n\n")
}

fn one_world(line: &Line) -> String {
    let mut table = Table::new(&[
        ("task", Align::Left),
        ("robot", Align::Left),
        ("observation", Align::Right),
        ("action", Align::Right),
        ("period", Align::Right),
        ("logs", Align::Left),
        ("score 0", Align::Right),
        ("score 1", Align::Right),
    ]);
    for it in &line.tasks {
        let [zero, one] = it.yardstick.map_or_else(
            || ["0".to_owned(), "best of the logs".to_owned()],
            |ends| ends.map(|end| format!("{end:.1}")),
        );
        table.row([
            it.task.to_owned(),
            it.robot.clone(),
            it.observation.to_string(),
            it.action.to_string(),
            format!("{} ms", f64::from(it.period_us) / 1000.0),
            if it.collects {
                "ted collect"
            } else {
                "ted import"
            }
            .to_owned(),
            zero,
            one,
        ]);
    }
    let mut text = format!("{}: {}\n\n{}", line.name, line.about, table.text());
    for (group, tasks) in &line.groups {
        text.push_str(&format!("\n{group}: {} tasks", tasks.len()));
    }
    text
}
