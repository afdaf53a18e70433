//! `ted inspect`: what is in a file or folder.

use std::path::{Path, PathBuf};

use clap::Args;
use firmware_sim::exit::ExitCode;
use firmware_sim::failure::Failure;
use firmware_sim::output::OutputArgs;
use ted_policy::SafeAction;

use crate::check::short;
use crate::dataset::Dataset;
use crate::inspect::{
    ArtefactText, DatasetText, Inspection, LookText, NetworkText, RunText, inspect, look,
};
use crate::train::TrainError;

use super::failures::end;
use super::locate::existing_or_dataset;
use super::table::{Align, Table};

const EXAMPLES: &str = "\
Examples:
  ted inspect runs/drawer-open-v3/steer/seed-0/policy.ted
  ted inspect runs/drawer-open-v3/steer/seed-0 --json
  ted inspect ted/drawer-open-v3-paper-s0-v0
  ted inspect drawer-open-v3 --look                  what the logs say before anybody is asked

Exit code 7 when this machine does not compute the artefact's golden vectors to the bit.";

/// Show all of an artefact, or what a run or a dataset is and came to
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct InspectArgs {
    /// An artefact, the folder of a run, or a dataset
    path: PathBuf,
    /// Of a dataset, what the logs say by themselves: what the preset steer goes by before it asks anything. Takes half a minute
    #[arg(long)]
    look: bool,
    #[command(flatten)]
    output: OutputArgs,
}

pub(super) fn run(args: &InspectArgs) -> Result<(), Failure> {
    let path = existing_or_dataset(&args.path);
    if args.look {
        return look_at(&path, args);
    }
    let inspection = inspect(&path).map_err(end)?;
    args.output.print(&inspection, || match &inspection {
        Inspection::Artefact(artefact) => artefact_text(artefact),
        Inspection::Run(run) => run_text(run),
        Inspection::Dataset(dataset) => dataset_text(dataset),
    })?;
    match &inspection {
        Inspection::Artefact(artefact) => match &artefact.golden.difference {
            Some(difference) => Err(Failure::new(ExitCode::Faulted, difference)),
            None => Ok(()),
        },
        _ => Ok(()),
    }
}

fn look_at(path: &Path, args: &InspectArgs) -> Result<(), Failure> {
    if path.is_file() || path.join("config.toml").is_file() {
        return Err(Failure::new(
            ExitCode::Usage,
            format_args!(
                "--look is for datasets, and {} is none: leave it out",
                path.display()
            ),
        ));
    }
    let dataset = Dataset::open(path).map_err(end)?;
    let look = look(&dataset, args.output.audience())
        .map_err(TrainError::from)
        .map_err(end)?;
    args.output.print(&look, || look_text(&look))?;
    Ok(())
}

fn look_text(look: &LookText) -> String {
    let mut table = Table::new(&[
        ("descriptor", Align::Left),
        ("reliability", Align::Right),
        ("most of it", Align::Left),
        ("made of", Align::Left),
    ]);
    for descriptor in &look.descriptors {
        let most = descriptor.most.iter().map(|episode| episode.to_string());
        table.row([
            descriptor.name.clone(),
            format!("{:.2}", descriptor.reliability),
            format!("episodes {}", most.collect::<Vec<_>>().join(", ")),
            descriptor.made_of.clone(),
        ]);
    }
    let competence = look.descriptors.first().map_or(0.0, |it| it.reliability);
    let verdict = if competence < 0.5 {
        "The halves of an episode do not agree on how competent it is: little is believed of it beforehand, and answers decide."
    } else {
        "Episodes differ in how far they go the way that all go. Before anybody answers, those that go further are held to be better."
    };
    format!("{}\n{verdict}", table.text())
}

fn artefact_text(artefact: &ArtefactText) -> String {
    let provenance = &artefact.provenance;
    let golden = match &artefact.golden.difference {
        None => "all computed on this machine, to the bit".to_owned(),
        Some(difference) => format!("NOT the same on this machine: {difference}"),
    };
    let mut lines = vec![
        format!(
            "artefact         {}: {} bytes, format {}, CRC-32 {} (checked)",
            artefact.path.display(),
            artefact.bytes,
            artefact.format_version,
            artefact.crc32
        ),
        format!("task             {}", artefact.contract.task),
        match artefact.contract.declared {
            true => format!(
                "control period   {} us, observations at most {} us old",
                artefact.contract.control_period_us, artefact.contract.max_observation_age_us
            ),
            false => "robot            undeclared: no device flies this; `ted robot draft DATASET` is the way out".to_owned(),
        },
        format!("golden vectors   {}: {golden}", artefact.golden.cases),
        String::new(),
        format!(
            "trained by       ted {}, {}, seed {}, {} updates",
            provenance.trainer_version, provenance.preset, provenance.seed, provenance.steps
        ),
        format!(
            "dataset          {}: mean return {:.1}, largest {:.1}",
            provenance.dataset_id, provenance.dataset_return_mean, provenance.dataset_return_max
        ),
        format!("dataset digest   {}", provenance.dataset_digest),
        format!("config digest    {}", provenance.config_digest),
        format!(
            "preferences      {}",
            provenance.preferences_digest.as_deref().unwrap_or("none")
        ),
        String::new(),
        format!("policy           {}", network_line(&artefact.policy)),
        layers(&artefact.policy),
        String::new(),
    ];
    match &artefact.reward {
        Some(reward) => {
            lines.push(format!(
                "reward ensemble  {} members on {}, raw {:.6} to {:.6} become 0 to 1",
                reward.members.len(),
                reward.input,
                reward.low,
                reward.high
            ));
            lines.extend(
                reward
                    .members
                    .iter()
                    .map(|m| format!("                 {}", network_line(m))),
            );
        }
        None => lines.push("reward ensemble  none".to_owned()),
    }
    lines.push(match &artefact.ted {
        Some(ted) => format!(
            "TED              gamma {}, sigma {}; {} from predicted return {} (ties up to episode {})",
            ted.gamma,
            ted.sigma,
            match ted.sigma < 1.0 {
                true => "full discount",
                false => "no discount is lowered; an episode is among the best",
            },
            ted.threshold_return_hat,
            ted.last_tied_episode
        ),
        None => "TED              none: constant discount".to_owned(),
    });
    lines.push(match &artefact.integers {
        Some(integers) => format!(
            "integers         {} fraction bits of observations, {} of actions; policy{}{}",
            integers.input_fraction_bits,
            integers.action_fraction_bits,
            integers.reward_sums.map_or("", |_| ", reward ensemble"),
            integers.threshold_return_hat.map_or("", |_| ", TED")
        ),
        None => "integers         none".to_owned(),
    });
    lines.extend([String::new(), observation_table(artefact)]);
    lines.extend([String::new(), action_table(artefact)]);
    lines.join("\n")
}

fn network_line(network: &NetworkText) -> String {
    format!(
        "{}, {} at the end, {} parameters",
        network.widths(),
        network.output,
        network.parameters
    )
}

fn layers(network: &NetworkText) -> String {
    let line = |(index, layer): (usize, &crate::inspect::LayerText)| {
        format!(
            "  layer {index}        {} -> {}: weights {:.4} to {:.4}, rms {:.4}; bias {:.4} to {:.4}",
            layer.inputs,
            layer.outputs,
            layer.weights[0],
            layer.weights[1],
            layer.weight_rms,
            layer.bias[0],
            layer.bias[1]
        )
    };
    let lines: Vec<_> = network.layers.iter().enumerate().map(line).collect();
    lines.join("\n")
}

fn observation_table(artefact: &ArtefactText) -> String {
    let numbers = ["low", "high", "shift", "scale"].map(|name| (name, Align::Right));
    let mut columns = vec![
        ("#", Align::Right),
        ("observation", Align::Left),
        ("unit", Align::Left),
    ];
    columns.extend(numbers);
    let mut table = Table::new(&columns);
    for (index, channel) in artefact.contract.observation.iter().enumerate() {
        let numbers = [channel.low, channel.high, channel.shift, channel.scale];
        let mut cells = vec![
            index.to_string(),
            channel.name.clone(),
            channel.unit.clone(),
        ];
        cells.extend(numbers.map(short));
        table.row(cells);
    }
    table.text()
}

fn action_table(artefact: &ArtefactText) -> String {
    let numbers = ["low", "high", "slew a tick"].map(|name| (name, Align::Right));
    let mut columns = vec![
        ("#", Align::Right),
        ("action", Align::Left),
        ("unit", Align::Left),
    ];
    columns.extend(numbers);
    columns.push(("on a fault", Align::Left));
    let mut table = Table::new(&columns);
    for (index, channel) in artefact.contract.action.iter().enumerate() {
        let numbers = [channel.low, channel.high, channel.slew_per_tick];
        let mut cells = vec![
            index.to_string(),
            channel.name.clone(),
            channel.unit.clone(),
        ];
        cells.extend(numbers.map(|number| format!("{number}")));
        let on_fault = match channel.on_fault {
            SafeAction::Zero => "zero".to_owned(),
            SafeAction::HoldLast => "hold the last".to_owned(),
            SafeAction::Value(value) => value.to_string(),
        };
        cells.push(on_fault);
        table.row(cells);
    }
    table.text()
}

fn run_text(run: &RunText) -> String {
    let mut lines = vec![
        format!(
            "run            {}: {}, seed {}, {} of {} updates",
            run.path.display(),
            run.config.preset.name(),
            run.config.seed,
            run.step,
            run.steps
        ),
        format!(
            "dataset        {} at {}",
            run.dataset.id,
            run.dataset.path.display()
        ),
        format!("config digest  {}", run.config_digest),
    ];
    if let Some(reward) = &run.reward {
        let held_out = reward.held_out.map_or_else(String::new, |held_out| {
            format!(
                ", {:.3} of held-out pairs ordered right",
                held_out.agreement
            )
        });
        let quality = reward.quality.as_ref().map_or_else(
            || match run.config.reward.is_none() {
                true => "no reward: the policy is learned without one".to_owned(),
                false => "Pearson -, Spearman -: the logs have no rewards".to_owned(),
            },
            |it| {
                format!(
                    "Pearson {:.3}, Spearman {:.3} with true returns",
                    it.pearson, it.spearman
                )
            },
        );
        lines.push(format!(
            "reward         {} answers{held_out}; {quality}",
            reward.queries
        ));
    }
    if let Some(spent) = &run.spent {
        let of = spent.reward_of.as_ref().map_or_else(String::new, |from| {
            format!(", where the reward was taken from {}", from.display())
        });
        lines.push(format!(
            "time           {:.0} s before the policy{of}; {:.0} s for the policy",
            spent.reward_s, spent.policy_s
        ));
    }
    lines.push(match &run.evaluation {
        Some(flown) => format!(
            "evaluation     {} episodes: return {:.1} +- {:.1}, score {}, success {:.3}, {} engine",
            flown.returns.len(),
            flown.return_mean,
            flown.return_sd,
            flown
                .score
                .map_or_else(|| "-".to_owned(), |score| format!("{score:.3}")),
            flown.success,
            flown.engine
        ),
        None => "evaluation     none yet: `ted eval` flies the policy".to_owned(),
    });
    lines.extend(
        run.files
            .iter()
            .map(|(name, bytes)| format!("{bytes:>13}  {name}")),
    );
    lines.join("\n")
}

pub(super) fn dataset_text(dataset: &DatasetText) -> String {
    let origin = dataset.origin.as_ref().map_or_else(
        || "not recorded by this program".to_owned(),
        |origin| {
            let engine = origin.engine.iter();
            let engine: Vec<_> = engine
                .map(|(name, version)| format!("{name} {version}"))
                .collect();
            format!(
                "{}, recipe {}, seed {}, {}",
                origin.task,
                origin.recipe,
                origin.seed,
                engine.join(", ")
            )
        },
    );
    let returns = dataset.returns.map_or_else(
        || "- (no rewards)".to_owned(),
        |it| format!("mean {:.1}, from {:.1} to {:.1}", it.mean, it.min, it.max),
    );
    format!(
        "dataset   {id} at {path}\n\
         digest    {digest}\n\
         origin    {origin}\n\
         episodes  {episodes} of {shortest} to {longest} steps, {steps} in all; {terminations} end the task, {truncations} only the recording\n\
         shape     observation {observation}, action {action}\n\
         return    {returns}\n\
         success   {success:.3}",
        id = dataset.id,
        path = dataset.path.display(),
        digest = dataset.digest,
        episodes = dataset.episodes,
        shortest = dataset.episode_steps[0],
        longest = dataset.episode_steps[1],
        steps = dataset.steps,
        terminations = dataset.terminations,
        truncations = dataset.truncations,
        observation = dataset.observation_dim,
        action = dataset.action_dim,
        success = dataset.success,
    )
}
