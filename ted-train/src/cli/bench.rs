//! `ted bench`: how fast this machine is at it.

use clap::Args;
use firmware_sim::exit::ExitCode;
use firmware_sim::failure::Failure;
use firmware_sim::output::OutputArgs;
use firmware_sim::worlds::{self, metaworld::tasks};

use crate::bench::{Bench, BenchConfig, bench};

use super::failures::end;
use super::table::{Align, Table};

const EXAMPLES: &str = "\
Examples:
  ted bench
  ted bench --steps 1000 --simulator-steps 0 --json

Run it on an idle machine. What is compared is measured in turn; medians count, and the simulator's best rounds.";

/// Time an update of the learner, an action of a policy, and a step of the simulator
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct BenchArgs {
    /// Updates of the learner in one repetition
    #[arg(long, default_value_t = 200, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    steps: u32,
    /// Repetitions
    #[arg(long, default_value_t = 7, value_parser = clap::value_parser!(u32).range(5..=10_000))]
    repetitions: u32,
    /// Steps of the simulator in one of its five rounds; 0 leaves the simulator out
    #[arg(long, default_value_t = 2000, value_parser = clap::value_parser!(u32).range(..=100_000_000))]
    simulator_steps: u32,
    /// The task that is simulated
    #[arg(long, default_value = "drawer-open-v3")]
    task: String,
    #[command(flatten)]
    output: OutputArgs,
}

pub(super) fn run(args: &BenchArgs) -> Result<(), Failure> {
    let task = worlds::single(&args.task).map_err(|e| Failure::new(ExitCode::Usage, e))?;
    let task = task.name();
    if !tasks::ALL.contains(&task) {
        return Err(Failure::new(
            ExitCode::Usage,
            format_args!(
                "{task} is no task of the package, which the simulator is compared with: name one that is"
            ),
        ));
    }
    let config = BenchConfig {
        updates: args.steps,
        repetitions: args.repetitions,
        simulator_steps: Some(args.simulator_steps).filter(|steps| *steps > 0),
        task: task.to_owned(),
    };
    let report = bench(&config, args.output.audience()).map_err(end)?;
    args.output.print(&report, || text(&report))
}

fn text(report: &Bench) -> String {
    let mut times = Table::new(&[
        ("one", Align::Left),
        ("median", Align::Right),
        ("fastest", Align::Right),
        ("slowest", Align::Right),
        ("per second", Align::Right),
    ]);
    for timing in &report.timings {
        times.row([
            timing.what.clone(),
            duration(timing.median_s),
            duration(timing.fastest_s),
            duration(timing.slowest_s),
            format!("{:.0}", 1.0 / timing.median_s),
        ]);
    }
    let mut ratios = Table::new(&[("speed of", Align::Left), ("ratio", Align::Right)]);
    for ratio in &report.ratios {
        ratios.row([ratio.what.clone(), format!("{:.2}", ratio.ratio)]);
    }
    [
        format!("On {}:", report.machine),
        times.markdown(),
        ratios.markdown(),
    ]
    .join("\n\n")
}

fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 1e-6 => format!("{:.0} ns", s * 1e9),
        s if s < 1e-3 => format!("{:.2} us", s * 1e6),
        s if s < 1.0 => format!("{:.3} ms", s * 1e3),
        s => format!("{s:.2} s"),
    }
}

#[cfg(test)]
mod tests {
    use super::duration;

    #[test]
    fn a_duration_is_written_in_the_unit_that_suits_it() {
        let written = [5e-7, 3.456e-6, 0.0123, 2.0].map(duration);
        assert_eq!(written, ["500 ns", "3.46 us", "12.300 ms", "2.00 s"]);
    }
}
