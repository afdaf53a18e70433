//! The contract and the origin of a policy as JSON, for whoever reads an exported file without this program.

use serde::Serialize;
use ted_policy::{Artifact, Contract, SafeAction};

/// The two texts that an exported file carries.
pub(super) struct Facts {
    /// Channels, units, ranges, period, and what is sent on a fault.
    pub(super) contract: String,
    /// Where the policy comes from.
    pub(super) origin: String,
}

#[derive(Serialize)]
struct ContractFacts<'a> {
    task: &'a str,
    control_period_us: u32,
    max_observation_age_us: u32,
    /// Whether somebody declared the robot: otherwise names, units and times stand for nothing.
    declared: bool,
    observation: Vec<ObservationFacts<'a>>,
    action: Vec<ActionFacts<'a>>,
}

#[derive(Serialize)]
struct ObservationFacts<'a> {
    name: &'a str,
    unit: &'a str,
    low: f32,
    high: f32,
}

#[derive(Serialize)]
struct ActionFacts<'a> {
    name: &'a str,
    unit: &'a str,
    low: f32,
    high: f32,
    slew_per_tick: f32,
    on_fault: SafeAction,
}

#[derive(Serialize)]
struct OriginFacts<'a> {
    trainer: String,
    preset: &'a str,
    seed: u64,
    steps: u64,
    dataset: &'a str,
    dataset_digest: String,
    config_digest: String,
    preferences_digest: Option<String>,
    /// Names the artefact that this was read from.
    artefact_crc32: String,
}

impl Facts {
    /// Those of an artefact.
    pub(super) fn of(artifact: &Artifact<'_>, contract: &Contract<'_>) -> Self {
        let provenance = artifact.provenance();
        let origin = OriginFacts {
            trainer: format!("ted {}", provenance.trainer_version),
            preset: provenance.preset,
            seed: provenance.seed,
            steps: provenance.steps,
            dataset: provenance.dataset_id,
            dataset_digest: provenance.dataset_digest.to_string(),
            config_digest: provenance.config_digest.to_string(),
            preferences_digest: provenance
                .preferences_digest
                .map(|digest| digest.to_string()),
            artefact_crc32: format!("{:08x}", artifact.checksum()),
        };
        Self {
            contract: json(&ContractFacts::of(contract)),
            origin: json(&origin),
        }
    }
}

impl<'a> ContractFacts<'a> {
    fn of(contract: &Contract<'a>) -> Self {
        let observation = contract.observation.iter().map(|channel| ObservationFacts {
            name: channel.name.as_str(),
            unit: channel.unit.as_str(),
            low: channel.low,
            high: channel.high,
        });
        let action = contract.action.iter().map(|channel| ActionFacts {
            name: channel.name.as_str(),
            unit: channel.unit.as_str(),
            low: channel.low,
            high: channel.high,
            slew_per_tick: channel.slew_per_tick,
            on_fault: channel.on_fault,
        });
        Self {
            task: contract.task,
            control_period_us: contract.control_period_us,
            max_observation_age_us: contract.max_observation_age_us,
            declared: contract.declared,
            observation: observation.collect(),
            action: action.collect(),
        }
    }
}

/// # Panics
/// Never: these are structs of texts and finite numbers, which always are JSON.
fn json(facts: &impl Serialize) -> String {
    serde_json::to_string(facts).expect("texts and numbers are JSON")
}
