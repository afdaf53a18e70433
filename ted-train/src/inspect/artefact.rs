//! Everything that an artefact holds, as plain data. Weights are summed up layer by layer.

use std::path::{Path, PathBuf};

use serde::Serialize;
use ted_core::integer::IntegerScratch;
use ted_core::{Mlp, Normaliser, Output, RewardInput, Scratch};
use ted_policy::{Artifact, FORMAT_VERSION, SafeAction};

/// An artefact.
#[derive(Clone, Debug, Serialize)]
pub struct ArtefactText {
    /// The file.
    pub path: PathBuf,
    /// Its size.
    pub bytes: usize,
    /// Version of the format.
    pub format_version: u32,
    /// CRC-32 of the file, which has been checked.
    pub crc32: String,
    /// What the policy expects and promises.
    pub contract: ContractText,
    /// Where it comes from.
    pub provenance: ProvenanceText,
    /// The policy.
    pub policy: NetworkText,
    /// The reward ensemble.
    pub reward: Option<RewardText>,
    /// TED's discount.
    pub ted: Option<TedText>,
    /// The same networks in integers.
    pub integers: Option<IntegersText>,
    /// The golden vectors.
    pub golden: GoldenText,
}

/// The fixed point of integer networks.
#[derive(Clone, Debug, Serialize)]
pub struct IntegersText {
    /// Fraction bits of a standardised observation.
    pub input_fraction_bits: u8,
    /// Fraction bits of an action.
    pub action_fraction_bits: u8,
    /// The sums over all members that become a reward of 0 and of 1.
    pub reward_sums: Option<[i32; 2]>,
    /// Predicted return in integer rewards from which an episode has the full discount.
    pub threshold_return_hat: Option<i64>,
}

/// What a policy expects of the world, and what it promises.
#[derive(Clone, Debug, Serialize)]
pub struct ContractText {
    /// The task.
    pub task: String,
    /// Time between two ticks.
    pub control_period_us: u32,
    /// Oldest observation that is acted on.
    pub max_observation_age_us: u32,
    /// Whether somebody declared the robot: otherwise names, units and times stand for nothing.
    pub declared: bool,
    /// The raw observation.
    pub observation: Vec<ChannelText>,
    /// The action.
    pub action: Vec<ActionText>,
}

/// A channel of the observation.
#[derive(Clone, Debug, Serialize)]
pub struct ChannelText {
    /// What it measures.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// Smallest value that is accepted.
    pub low: f32,
    /// Largest value that is accepted.
    pub high: f32,
    /// What the policy's normaliser subtracts.
    pub shift: f32,
    /// What it multiplies with then.
    pub scale: f32,
}

/// A channel of the action.
#[derive(Clone, Debug, Serialize)]
pub struct ActionText {
    /// What it moves.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// Smallest value that is sent.
    pub low: f32,
    /// Largest value that is sent.
    pub high: f32,
    /// Largest change from one tick to the next.
    pub slew_per_tick: f32,
    /// What is sent while a fault is latched.
    pub on_fault: SafeAction,
}

/// Where a policy comes from.
#[derive(Clone, Debug, Serialize)]
pub struct ProvenanceText {
    /// Version of the trainer.
    pub trainer_version: String,
    /// The composition.
    pub preset: String,
    /// Root seed.
    pub seed: u64,
    /// Updates of the policy.
    pub steps: u64,
    /// Digest of the resolved configuration.
    pub config_digest: String,
    /// The dataset.
    pub dataset_id: String,
    /// Digest of the dataset.
    pub dataset_digest: String,
    /// Digest of the preference log.
    pub preferences_digest: Option<String>,
    /// Mean true return of the dataset.
    pub dataset_return_mean: f64,
    /// Largest true return of the dataset.
    pub dataset_return_max: f64,
}

/// A network.
#[derive(Clone, Debug, Serialize)]
pub struct NetworkText {
    /// Activation of the last layer.
    pub output: &'static str,
    /// Numbers that were learned.
    pub parameters: usize,
    /// Its layers.
    pub layers: Vec<LayerText>,
}

/// A layer of a network.
#[derive(Clone, Debug, Serialize)]
pub struct LayerText {
    /// Inputs.
    pub inputs: usize,
    /// Outputs.
    pub outputs: usize,
    /// Smallest and largest weight.
    pub weights: [f32; 2],
    /// Root mean square of the weights.
    pub weight_rms: f64,
    /// Smallest and largest bias.
    pub bias: [f32; 2],
}

/// The reward ensemble.
#[derive(Clone, Debug, Serialize)]
pub struct RewardText {
    /// What the members see.
    pub input: &'static str,
    /// The raw reward that becomes 0.
    pub low: f32,
    /// The raw reward that becomes 1.
    pub high: f32,
    /// What is subtracted from each input.
    pub shift: Vec<f32>,
    /// What it is multiplied with then.
    pub scale: Vec<f32>,
    /// The members.
    pub members: Vec<NetworkText>,
}

/// TED's discount.
#[derive(Clone, Debug, Serialize)]
pub struct TedText {
    /// Discount factor of the top episodes.
    pub gamma: f32,
    /// What it is multiplied with below.
    pub sigma: f32,
    /// Predicted return of the last episode of the top.
    pub threshold_return_hat: f32,
    /// The last episode with that return that is in the top.
    pub last_tied_episode: u32,
}

/// The golden vectors.
#[derive(Clone, Debug, Serialize)]
pub struct GoldenText {
    /// How many.
    pub cases: usize,
    /// Whether this machine computes all of them to the bit.
    pub verified: bool,
    /// The first difference.
    pub difference: Option<String>,
    /// The vectors themselves.
    pub vectors: Vec<GoldenVector>,
}

/// One golden vector.
#[derive(Clone, Debug, Serialize)]
pub struct GoldenVector {
    /// The raw observation.
    pub observation: Vec<f32>,
    /// The action that comes out.
    pub action: Vec<f32>,
    /// The raw reward of the two.
    pub reward_raw: Option<f32>,
}

impl ArtefactText {
    pub(super) fn new(path: &Path, bytes: usize, artifact: &Artifact<'_>) -> Self {
        let policy = artifact.policy();
        let reward = artifact.reward().map(|reward| RewardText {
            input: match reward.input() {
                RewardInput::Observation => "observation",
                RewardInput::ObservationAction => "observation and action",
            },
            low: reward.range().low,
            high: reward.range().high,
            shift: reward.normaliser().shift().to_vec(),
            scale: reward.normaliser().scale().to_vec(),
            members: reward.members().iter().map(NetworkText::new).collect(),
        });
        let ted = artifact.ted().map(|ted| TedText {
            gamma: ted.gamma(),
            sigma: ted.sigma(),
            threshold_return_hat: ted.threshold().return_hat,
            last_tied_episode: ted.threshold().last_tied_episode,
        });
        let integers = artifact.integers().map(|integers| IntegersText {
            input_fraction_bits: integers.policy.integer().input_fraction_bits(),
            action_fraction_bits: integers.policy.integer().action_fraction_bits(),
            reward_sums: integers.reward.as_ref().map(|reward| {
                let range = reward.integer().range();
                [range.low, range.high]
            }),
            threshold_return_hat: integers.threshold.map(|threshold| threshold.return_hat),
        });
        Self {
            path: path.to_path_buf(),
            bytes,
            format_version: FORMAT_VERSION,
            crc32: format!("{:08x}", artifact.checksum()),
            contract: ContractText::new(artifact, policy.normaliser()),
            provenance: ProvenanceText::new(artifact),
            policy: NetworkText::new(policy.mlp()),
            reward,
            ted,
            integers,
            golden: GoldenText::new(artifact),
        }
    }
}

impl ContractText {
    fn new(artifact: &Artifact<'_>, normaliser: &Normaliser<'_>) -> Self {
        let contract = artifact.contract();
        let standardisation = normaliser.shift().iter().zip(normaliser.scale());
        Self {
            task: contract.task.to_owned(),
            control_period_us: contract.control_period_us,
            max_observation_age_us: contract.max_observation_age_us,
            declared: contract.declared,
            observation: contract
                .observation
                .iter()
                .zip(standardisation)
                .map(|(channel, (&shift, &scale))| ChannelText {
                    name: channel.name.to_string(),
                    unit: channel.unit.to_string(),
                    low: channel.low,
                    high: channel.high,
                    shift,
                    scale,
                })
                .collect(),
            action: contract
                .action
                .iter()
                .map(|channel| ActionText {
                    name: channel.name.to_string(),
                    unit: channel.unit.to_string(),
                    low: channel.low,
                    high: channel.high,
                    slew_per_tick: channel.slew_per_tick,
                    on_fault: channel.on_fault,
                })
                .collect(),
        }
    }
}

impl ProvenanceText {
    fn new(artifact: &Artifact<'_>) -> Self {
        let provenance = artifact.provenance();
        Self {
            trainer_version: provenance.trainer_version.to_owned(),
            preset: provenance.preset.to_owned(),
            seed: provenance.seed,
            steps: provenance.steps,
            config_digest: provenance.config_digest.to_string(),
            dataset_id: provenance.dataset_id.to_owned(),
            dataset_digest: provenance.dataset_digest.to_string(),
            preferences_digest: provenance.preferences_digest.map(|d| d.to_string()),
            dataset_return_mean: provenance.dataset_return_mean,
            dataset_return_max: provenance.dataset_return_max,
        }
    }
}

impl NetworkText {
    fn new(network: &Mlp<'_>) -> Self {
        let range = |values: &[f32]| {
            values
                .iter()
                .fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], &value| {
                    [low.min(value), high.max(value)]
                })
        };
        let layers: Vec<LayerText> = network
            .layers()
            .map(|layer| {
                let squares = layer.weights().iter().map(|&w| f64::from(w).powi(2));
                LayerText {
                    inputs: layer.inputs(),
                    outputs: layer.outputs(),
                    weights: range(layer.weights()),
                    weight_rms: (squares.sum::<f64>() / layer.weights().len() as f64).sqrt(),
                    bias: range(layer.bias()),
                }
            })
            .collect();
        Self {
            output: match network.output() {
                Output::Linear => "linear",
                Output::Tanh => "tanh",
            },
            parameters: layers.iter().map(|l| (l.inputs + 1) * l.outputs).sum(),
            layers,
        }
    }

    /// Its widths from input to output, such as `39-256-256-4`.
    #[must_use]
    pub fn widths(&self) -> String {
        let inputs = self.layers.iter().take(1).map(|layer| layer.inputs);
        let widths = inputs.chain(self.layers.iter().map(|layer| layer.outputs));
        widths
            .map(|width| width.to_string())
            .collect::<Vec<_>>()
            .join("-")
    }
}

impl GoldenText {
    fn new(artifact: &Artifact<'_>) -> Self {
        let vectors: Vec<GoldenVector> = artifact
            .golden()
            .cases()
            .map(|case| GoldenVector {
                observation: case.obs_raw.to_vec(),
                action: case.action_unit.to_vec(),
                reward_raw: case.reward_raw,
            })
            .collect();
        let verified =
            artifact
                .verify_golden(&mut Scratch::new())
                .and_then(|()| match artifact.integers() {
                    Some(_) => artifact.verify_integer_golden(&mut IntegerScratch::new()),
                    None => Ok(()),
                });
        Self {
            cases: vectors.len(),
            verified: verified.is_ok(),
            difference: verified.err().map(|error| error.to_string()),
            vectors,
        }
    }
}
