//! `--preset`: a composition, or `list` to see them all.

use std::sync::LazyLock;

use clap::ValueEnum;
use clap::builder::PossibleValue;
use serde::Serialize;
use toml::Value;

use crate::config::{Preset, Row, TABLE};

use super::table::{Align, Table};

/// What may stand after `--preset`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PresetArg {
    /// A composition.
    One(Preset),
    /// A wish to see all of them.
    List,
}

impl PresetArg {
    /// The composition.
    pub(super) fn preset(self) -> Option<Preset> {
        match self {
            Self::One(preset) => Some(preset),
            Self::List => None,
        }
    }
}

impl ValueEnum for PresetArg {
    fn value_variants<'a>() -> &'a [Self] {
        static ALL: LazyLock<Vec<PresetArg>> = LazyLock::new(|| {
            let all = TABLE.iter().map(|row| PresetArg::One(row.preset));
            all.chain([PresetArg::List]).collect()
        });
        &ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        match self {
            Self::One(preset) => preset.to_possible_value(),
            Self::List => Some(PossibleValue::new("list").help("Print them all and train nothing")),
        }
    }
}

/// A preset with the four choices that it stands for.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Composition {
    #[serde(flatten)]
    row: &'static Row,
    reward: String,
    filter: String,
    discount: String,
    algorithm: String,
}

/// All of them.
pub(super) fn compositions() -> Vec<Composition> {
    let composition = |row: &'static Row| {
        // The names that the configuration has for them, so that nobody learns a second set.
        let config = Value::try_from(row.preset.config()).ok();
        let name = |table: &str, tag: &str| {
            let name = config
                .as_ref()
                .and_then(|it| it.get(table)?.get(tag)?.as_str());
            name.unwrap_or_default().to_owned()
        };
        Composition {
            row,
            reward: name("reward", "source"),
            filter: name("filter", "keep"),
            discount: name("discount", "rule"),
            algorithm: name("algorithm", "kind"),
        }
    };
    TABLE.iter().map(composition).collect()
}

/// As a table.
pub(super) fn text(compositions: &[Composition]) -> String {
    let columns = [
        "preset",
        "reward",
        "filter",
        "discount",
        "algorithm",
        "what it is for",
        "source",
    ];
    let mut table = Table::new(&columns.map(|name| (name, Align::Left)));
    for one in compositions {
        table.row([
            one.row.preset.name().to_owned(),
            one.reward.clone(),
            one.filter.clone(),
            one.discount.clone(),
            one.algorithm.clone(),
            one.row.purpose.to_owned(),
            one.row.source.to_owned(),
        ]);
    }
    table.text()
}
