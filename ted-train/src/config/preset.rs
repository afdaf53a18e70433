//! Named compositions: the rows of the paper's tables, and those that a result has to be seen beside.

use clap::ValueEnum;
use clap::builder::PossibleValue;
use serde::{Deserialize, Serialize};

use crate::algorithm::atac::AtacConfig;
use crate::algorithm::awr::AwrConfig;
use crate::algorithm::bc::BcConfig;
use crate::algorithm::conditioned::ConditionedConfig;
use crate::algorithm::iql::IqlConfig;
use crate::algorithm::oppo::OppoConfig;
use crate::algorithm::{AlgorithmConfig, ObservationScaling};
use crate::filter::FilterConfig;
use crate::nn::Backend;
use crate::preferences::TeacherConfig;
use crate::reward::RewardConfig;
use crate::reward::episodes::EpisodesConfig;
use crate::reward::oprl::OprlConfig;
use crate::reward::transformer::PtConfig;
use crate::reward::transport::TransportConfig;
use crate::ted::DiscountConfig;

use super::{Config, Schedule};

/// A named composition of reward source, filter, discount and offline algorithm; [`TABLE`] says what each is for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "&'static str", try_from = "String")]
#[expect(missing_docs, reason = "the table says it once")]
pub enum Preset {
    True,
    TrueTed,
    TrueConditioned,
    #[default]
    Steer,
    Zero,
    ZeroTed,
    Random,
    RandomTed,
    Negative,
    NegativeTed,
    OprlI,
    OprlITed,
    OprlITedTransition,
    OprlITedSoft,
    OprlIPenalty,
    Oprl,
    OprlAtac,
    OprlAtacTed,
    Pt,
    PtTed,
    PtTruncate,
    Otr,
    Oppo,
    Bc,
    Bc10,
}

/// What there is to say about a preset.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Row {
    /// The preset.
    pub preset: Preset,
    /// What it is for.
    pub purpose: &'static str,
    /// Where it comes from.
    pub source: &'static str,
    #[serde(skip)]
    name: &'static str,
}

const fn row(
    preset: Preset,
    name: &'static str,
    purpose: &'static str,
    source: &'static str,
) -> Row {
    Row {
        preset,
        purpose,
        source,
        name,
    }
}

const SURVIVAL: &str = "Li et al. 2023, on the survival instinct";
const SANITY: &str = "ours: TED must not make something of nothing";

/// Every preset, in the order of the enum.
pub const TABLE: [Row; 25] = [
    row(
        Preset::True,
        "true",
        "the dataset's own rewards: what perfect labels reach",
        "paper, Table 4",
    ),
    row(
        Preset::TrueTed,
        "true+ted",
        "the same with TED, which must not harm them",
        "paper, Table 12",
    ),
    row(
        Preset::TrueConditioned,
        "true+conditioned",
        "cloning told how good each episode was, flown at the best: what conditioning reaches with perfect labels",
        "ours, docs/steer.md",
    ),
    row(
        Preset::Steer,
        "steer",
        "a look at the logs, ten answers about whole episodes, and cloning that they steer towards the best",
        "ours, docs/steer.md",
    ),
    row(
        Preset::Zero,
        "zero",
        "no reward at all: what pessimism alone reaches",
        SURVIVAL,
    ),
    row(Preset::ZeroTed, "zero+ted", "the same with TED", SANITY),
    row(
        Preset::Random,
        "random",
        "uniform noise: what a reward without information reaches",
        "paper, Table 8",
    ),
    row(Preset::RandomTed, "random+ted", "the same with TED", SANITY),
    row(
        Preset::Negative,
        "negative",
        "the dataset's rewards turned round: how far a wrong reward leads",
        SURVIVAL,
    ),
    row(
        Preset::NegativeTed,
        "negative+ted",
        "the same with TED",
        SANITY,
    ),
    row(
        Preset::OprlI,
        "oprl-i",
        "OPRL's reward ensemble from ten answers, IQL",
        "paper, Table 4; Shin et al. 2023",
    ),
    row(
        Preset::OprlITed,
        "oprl-i+ted",
        "the same with transition-dependent discounting: the paper's method",
        "paper, Table 4",
    ),
    row(
        Preset::OprlITedTransition,
        "oprl-i+ted-transition",
        "TED by a transition's own predicted reward",
        "asked for by the paper's reviewers",
    ),
    row(
        Preset::OprlITedSoft,
        "oprl-i+ted-soft",
        "TED without a border: a discount that falls with the rank",
        "asked for by the paper's reviewers",
    ),
    row(
        Preset::OprlIPenalty,
        "oprl-i+penalty",
        "TED's episodes with lower rewards instead of lower discounts",
        "asked for by the paper's reviewers",
    ),
    row(
        Preset::Oprl,
        "oprl",
        "OPRL-I's ensemble with the learner that OPRL was published with, AWR",
        "Shin et al. 2023",
    ),
    row(
        Preset::OprlAtac,
        "oprl-atac",
        "OPRL's ensemble, ATAC",
        "paper, Table 13; Cheng et al. 2022",
    ),
    row(
        Preset::OprlAtacTed,
        "oprl-atac+ted",
        "the same with TED",
        "paper, Table 13",
    ),
    row(
        Preset::Pt,
        "pt",
        "Preference Transformer's rewards from ten answers, IQL",
        "paper, Table 4; Kim et al. 2023",
    ),
    row(
        Preset::PtTed,
        "pt+ted",
        "the same with TED",
        "paper, Table 4",
    ),
    row(
        Preset::PtTruncate,
        "pt+truncate",
        "the same, learned from the 70 % predicted best episodes only",
        "paper, Table 14",
    ),
    row(
        Preset::Otr,
        "otr",
        "rewards by optimal transport to the best episodes, IQL",
        "paper, Table 8; Luo et al. 2023",
    ),
    row(
        Preset::Oppo,
        "oppo",
        "a policy for sequences from ten answers, without a reward; no controller flies it",
        "paper, Table 8; Kang et al. 2023",
    ),
    row(
        Preset::Bc,
        "bc",
        "behaviour cloning of everything",
        "what the data does, without any choice",
    ),
    row(
        Preset::Bc10,
        "bc10",
        "behaviour cloning of the tenth with the highest true returns",
        "paper, Table 8",
    ),
];

impl Preset {
    /// The composition with every default.
    #[must_use]
    pub fn config(self) -> Config {
        let reward = match self {
            Self::True | Self::TrueTed | Self::TrueConditioned => RewardConfig::True {},
            Self::Zero | Self::ZeroTed => RewardConfig::Zero {},
            Self::Random | Self::RandomTed => RewardConfig::Random {},
            Self::Negative | Self::NegativeTed => RewardConfig::Negative {},
            Self::OprlI
            | Self::OprlITed
            | Self::OprlITedTransition
            | Self::OprlITedSoft
            | Self::OprlIPenalty
            | Self::Oprl
            | Self::OprlAtac
            | Self::OprlAtacTed => RewardConfig::Oprl(OprlConfig::default()),
            Self::Pt | Self::PtTed | Self::PtTruncate => {
                RewardConfig::Transformer(PtConfig::default())
            }
            Self::Otr => RewardConfig::Transport(TransportConfig::default()),
            Self::Steer => RewardConfig::Episodes(EpisodesConfig::default()),
            Self::Oppo | Self::Bc | Self::Bc10 => RewardConfig::None {},
        };
        let filter = match self {
            Self::Bc10 => FilterConfig::TopTrue { k: 10.0 },
            Self::PtTruncate => FilterConfig::TopPredicted { k: 70.0 },
            _ => FilterConfig::All {},
        };
        let discount = match self {
            Self::TrueTed
            | Self::ZeroTed
            | Self::RandomTed
            | Self::NegativeTed
            | Self::OprlITed
            | Self::OprlAtacTed
            | Self::PtTed => DiscountConfig::TED,
            Self::Steer => DiscountConfig::BORDER,
            Self::OprlITedTransition => DiscountConfig::TED_TRANSITION,
            Self::OprlITedSoft => DiscountConfig::TED_SOFT,
            Self::OprlIPenalty => DiscountConfig::REWARD_PENALTY,
            _ => DiscountConfig::CONSTANT,
        };
        let algorithm = match self {
            Self::Oprl => AlgorithmConfig::Awr(AwrConfig::default()),
            Self::OprlAtac | Self::OprlAtacTed => AlgorithmConfig::Atac(AtacConfig::default()),
            Self::TrueConditioned | Self::Steer => {
                AlgorithmConfig::Conditioned(ConditionedConfig::default())
            }
            Self::Bc | Self::Bc10 => AlgorithmConfig::Bc(BcConfig::default()),
            Self::Oppo => AlgorithmConfig::Oppo(OppoConfig::default()),
            _ => AlgorithmConfig::Iql(IqlConfig::default()),
        };
        let mut schedule = Schedule::default();
        if self == Self::Oppo {
            // An update takes about two seconds.
            (schedule.log_every, schedule.checkpoint_every) = (50, 100);
        }
        Config {
            preset: self,
            seed: 0,
            backend: Backend::Fused,
            unit_rewards: true,
            observations: ObservationScaling::Standardised,
            reward,
            filter,
            discount,
            algorithm,
            schedule,
            teacher: TeacherConfig::default(),
        }
    }

    /// Its row of the table.
    #[must_use]
    pub fn row(self) -> &'static Row {
        &TABLE[self as usize]
    }

    /// The name as it is written on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.row().name
    }
}

impl From<Preset> for &'static str {
    fn from(preset: Preset) -> Self {
        preset.name()
    }
}

impl TryFrom<String> for Preset {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        let row = TABLE.iter().find(|row| row.name == name);
        row.map(|row| row.preset).ok_or_else(|| {
            format!(
                "no preset is called {name:?}: `ted train --preset list` prints those there are"
            )
        })
    }
}

impl ValueEnum for Preset {
    fn value_variants<'a>() -> &'a [Self] {
        const ALL: [Preset; TABLE.len()] = {
            let mut all = [Preset::True; TABLE.len()];
            let mut i = 0;
            while i < all.len() {
                all[i] = TABLE[i].preset;
                i += 1;
            }
            all
        };
        &ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(PossibleValue::new(self.name()).help(self.row().purpose))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::Clip;
    use crate::nn::Adam;

    #[test]
    fn every_preset_has_its_own_row_and_name() {
        for (i, row) in TABLE.iter().enumerate() {
            assert_eq!(row.preset as usize, i, "{}", row.name);
            assert_eq!(Preset::try_from(row.name.to_owned()), Ok(row.preset));
        }
        assert!(Preset::try_from("list".to_owned()).is_err());
    }

    #[test]
    fn every_preset_is_a_composition_that_holds() {
        for row in &TABLE {
            row.preset.config().check().unwrap();
        }
    }

    #[test]
    fn the_default_is_our_own_which_lowers_no_discount_and_leaves_a_border_for_a_device() {
        let config = Preset::default().config();
        assert_eq!(config.preset, Preset::Steer);
        let DiscountConfig::Ted { gamma, sigma, .. } = config.discount else {
            panic!("{:?}", config.discount);
        };
        assert_eq!(sigma, 1.0);
        let shift = 0.0;
        assert_eq!(
            DiscountConfig::CONSTANT,
            DiscountConfig::Constant { gamma, shift }
        );
    }

    #[test]
    fn the_method_of_the_paper_has_its_setting_and_the_constants_of_the_methods_it_builds_on() {
        let Config {
            preset,
            seed,
            unit_rewards,
            reward,
            discount,
            algorithm,
            ..
        } = Preset::OprlITed.config();
        assert_eq!((preset, seed, unit_rewards), (Preset::OprlITed, 0, true));
        let (gamma, k, sigma) = (0.99, 70.0, 0.7);
        assert_eq!(discount, DiscountConfig::Ted { gamma, k, sigma });
        assert_eq!(Preset::OprlI.config().discount, DiscountConfig::CONSTANT);
        let adam = Adam {
            beta1: 0.9,
            beta2: 0.999,
            epsilon: 1e-8,
        };
        let paper = IqlConfig {
            steps: 100_000,
            batch: 256,
            hidden: vec![256, 256],
            tau: 0.7,
            beta: 3.0,
            advantage_clip: 100.0,
            learning_rate: 3e-4,
            target_rate: 0.005,
            log_std: [-5.0, 2.0],
            adam,
        };
        assert_eq!(algorithm, AlgorithmConfig::Iql(paper));
        let RewardConfig::Oprl(oprl) = reward else {
            panic!("{reward:?}");
        };
        assert_eq!((oprl.members, oprl.rounds, oprl.queries()), (7, 3, 10));
        assert_eq!(oprl.segment, Clip::Steps(50));
        assert_eq!((oprl.pool, oprl.adam), (1000, adam));
    }
}
