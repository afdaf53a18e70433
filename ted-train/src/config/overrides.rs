//! From a preset to a resolved configuration: a file, then `--set key=value`, each refusing unknown keys.

use std::path::Path;

use serde::Deserialize;
use serde::de::DeserializeOwned;
use toml::{Table, Value};

use super::{Config, ConfigError, Preset};

/// What a person changed about a preset.
#[derive(Clone, Debug, Default)]
pub struct Overrides {
    /// What a file calls its run.
    name: Name,
    /// Merged over the preset in this order.
    layers: Vec<Layer>,
}

/// A table, and where it came from.
#[derive(Clone, Debug)]
struct Layer {
    origin: String,
    /// The presets that it is for; all of them if it names none.
    presets: Vec<Preset>,
    table: Table,
}

/// What a run is called by: the two fields that have flags of their own.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
struct Name {
    preset: Option<Preset>,
    seed: Option<u64>,
}

/// The fields of [`Name`].
const NAME: [&str; 2] = ["preset", "seed"];

impl Overrides {
    /// Adds a TOML file. The preset and the seed that it may name are those of the run, if no flag names others.
    ///
    /// # Errors
    /// When it cannot be read or parsed.
    pub fn file(mut self, path: &Path) -> Result<Self, ConfigError> {
        let text = std::fs::read_to_string(path).map_err(|source| ConfigError::Read {
            path: path.to_path_buf(),
            source,
        })?;
        let origin = path.display().to_string();
        let mut table: Table = parse(&origin, &text)?;
        let Name { preset, seed } = parse(&origin, &text)?;
        self.name.preset = preset.or(self.name.preset);
        self.name.seed = seed.or(self.name.seed);
        table.retain(|key, _| !NAME.contains(&key));
        self.layers.push(Layer {
            origin,
            presets: Vec::new(),
            table,
        });
        Ok(self)
    }

    /// Adds one `key=value`; the key is a dotted path, the value TOML, bare words being strings. With `preset,preset:` before
    /// it, it is for these presets only.
    ///
    /// # Errors
    /// When there is no `=`, the key is empty, it is one that has a flag of its own, or there is no such preset.
    pub fn set(mut self, argument: &str) -> Result<Self, ConfigError> {
        let bad = || ConfigError::Override {
            argument: argument.to_owned(),
        };
        let (key, value) = argument.split_once('=').ok_or_else(bad)?;
        let (names, key) = match key.rsplit_once(':') {
            Some((names, key)) => (Some(names), key),
            None => (None, key),
        };
        let preset = |name: &str| {
            Preset::try_from(name.trim().to_owned()).map_err(|message| ConfigError::Invalid {
                origin: format!("--set {argument}"),
                message,
            })
        };
        let presets = match names {
            None => Vec::new(),
            Some(names) => names.split(',').map(preset).collect::<Result<_, _>>()?,
        };
        if let Some(field) = NAME.into_iter().find(|field| *field == key.trim()) {
            let argument = argument.to_owned();
            return Err(ConfigError::Flag { field, argument });
        }
        let mut parts = key.trim().rsplit('.');
        let value = toml::from_str::<Table>(&format!("v = {value}"))
            .ok()
            .and_then(|mut table| table.remove("v"))
            .unwrap_or_else(|| Value::String(value.trim().to_owned()));
        let last = parts.next().filter(|p| !p.is_empty()).ok_or_else(bad)?;
        let mut table = Table::from_iter([(last.to_owned(), value)]);
        for part in parts {
            if part.is_empty() {
                return Err(bad());
            }
            table = Table::from_iter([(part.to_owned(), Value::Table(table))]);
        }
        self.layers.push(Layer {
            origin: format!("--set {argument}"),
            presets,
            table,
        });
        Ok(self)
    }

    /// Refuses a change that is for presets of which none is among these: nothing would come of it.
    ///
    /// # Errors
    /// Names the change.
    pub fn meant_for(&self, presets: &[Preset]) -> Result<(), ConfigError> {
        let idle = |layer: &&Layer| {
            !layer.presets.is_empty() && !layer.presets.iter().any(|it| presets.contains(it))
        };
        match self.layers.iter().find(idle) {
            None => Ok(()),
            Some(layer) => Err(ConfigError::Invalid {
                origin: layer.origin.clone(),
                message: "it is for presets that none of these runs has".to_owned(),
            }),
        }
    }

    /// The preset with every change applied, checked. Preset and seed are the given ones, or else those of the file, or
    /// else the default ones.
    ///
    /// # Errors
    /// Names the first unknown key, wrong type or value out of range, and where it came from.
    pub fn resolve(
        &self,
        preset: Option<Preset>,
        seed: Option<u64>,
    ) -> Result<Config, ConfigError> {
        let preset = preset.or(self.name.preset).unwrap_or_default();
        let start = Config {
            seed: seed.or(self.name.seed).unwrap_or_default(),
            ..preset.config()
        };
        let mut table: Table = parse("the preset", &start.to_toml())?;
        let mut config = start;
        let theirs = |layer: &&Layer| layer.presets.is_empty() || layer.presets.contains(&preset);
        for layer in self.layers.iter().filter(theirs) {
            merge(&mut table, layer.table.clone());
            config = table
                .clone()
                .try_into()
                .map_err(|error| ConfigError::Invalid {
                    origin: layer.origin.clone(),
                    message: clean(&error),
                })?;
        }
        config.check()?;
        Ok(config)
    }
}

impl Config {
    /// Reads a resolved configuration, as a run folder holds it.
    ///
    /// # Errors
    /// When it cannot be read, has an unknown key, or holds a value out of range.
    pub fn read(path: &Path) -> Result<Self, ConfigError> {
        let text = std::fs::read_to_string(path).map_err(|source| ConfigError::Read {
            path: path.to_path_buf(),
            source,
        })?;
        let config: Self = parse(&path.display().to_string(), &text)?;
        config.check()?;
        Ok(config)
    }
}

fn parse<T: DeserializeOwned>(origin: &str, text: &str) -> Result<T, ConfigError> {
    toml::from_str(text).map_err(|error| ConfigError::Invalid {
        origin: origin.to_owned(),
        message: clean(&error),
    })
}

fn clean(error: &toml::de::Error) -> String {
    error.to_string().trim().replace('\n', " ")
}

/// Merges tables key by key. A table that names another kind (`source`, `keep`, `rule`, `kind`) replaces the old one: the
/// fields of one kind mean nothing to another.
fn merge(base: &mut Table, layer: Table) {
    for (key, value) in layer {
        match (base.get_mut(&key), value) {
            (Some(Value::Table(old)), Value::Table(new)) if same_kind(old, &new) => merge(old, new),
            (_, value) => {
                base.insert(key, value);
            }
        }
    }
}

fn same_kind(old: &Table, new: &Table) -> bool {
    ["source", "keep", "rule", "kind"]
        .iter()
        .all(|tag| new.get(*tag).is_none_or(|v| old.get(*tag) == Some(v)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algorithm::AlgorithmConfig;
    use crate::config::TABLE;
    use crate::ted::DiscountConfig;

    fn resolve(sets: &[&str]) -> Result<Config, ConfigError> {
        let mut overrides = Overrides::default();
        for set in sets {
            overrides = overrides.set(set)?;
        }
        overrides.resolve(Some(Preset::OprlITed), Some(3))
    }

    #[test]
    fn fields_of_any_depth_can_be_set() {
        let config = resolve(&[
            "algorithm.steps=7",
            "discount.sigma=0.5",
            "algorithm.hidden=[64, 64]",
            "backend=ndarray",
        ])
        .unwrap();
        assert_eq!(config.algorithm.steps(), 7);
        let AlgorithmConfig::Iql(iql) = &config.algorithm else {
            panic!("{config:?}");
        };
        assert_eq!(iql.hidden, [64, 64]);
        assert_eq!(
            config.discount,
            DiscountConfig::Ted {
                gamma: 0.99,
                k: 70.0,
                sigma: 0.5
            }
        );
        assert_eq!(config.seed, 3);
    }

    #[test]
    fn a_change_of_kind_drops_the_fields_of_the_old_kind() {
        let config = resolve(&["reward={source=\"zero\"}"]).unwrap();
        assert_eq!(config.reward, crate::reward::RewardConfig::Zero {});
        assert!(matches!(resolve(&["reward.source=zero"]), Ok(c) if c.reward == config.reward));
    }

    #[test]
    fn every_preset_survives_writing_and_reading() {
        for row in &TABLE {
            let config = row.preset.config();
            assert_eq!(toml::from_str::<Config>(&config.to_toml()).unwrap(), config);
        }
    }

    #[test]
    fn unknown_keys_are_refused_by_name() {
        for set in [
            "algorithm.step=7",
            "steps=7",
            "reward.epoch=1",
            "discount.kk=1",
            "reward.scaling={kind=\"raw\", floor=0.1}",
        ] {
            let error = resolve(&[set]).unwrap_err().to_string();
            assert!(error.contains("unknown field"), "{set}: {error}");
        }
    }

    #[test]
    fn values_out_of_range_are_refused_by_field_and_range() {
        for (set, field) in [
            ("discount.k=100.1", "discount.k"),
            ("discount.k=-1.0", "discount.k"),
            ("discount.sigma=1.01", "discount.sigma"),
            ("discount.sigma=nan", "discount.sigma"),
            ("algorithm.tau=0.0", "algorithm.tau"),
            ("algorithm.tau=1.0", "algorithm.tau"),
            ("algorithm.hidden=[512]", "algorithm.hidden"),
            ("reward.members=9", "reward.members"),
        ] {
            let error = resolve(&[set]).unwrap_err().to_string();
            assert!(error.starts_with(field), "{set}: {error}");
        }
    }

    #[test]
    fn preset_and_seed_come_from_a_flag_or_the_file_and_not_from_set() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mine.toml");
        let file = |text: &str| {
            std::fs::write(&path, text).unwrap();
            Overrides::default().file(&path)
        };
        let resolved =
            |text: &str, preset, seed| file(text).unwrap().resolve(preset, seed).unwrap();

        let unnamed = resolved("algorithm.steps = 7", None, None);
        assert_eq!((unnamed.preset, unnamed.seed), (Preset::Steer, 0));
        // A preset is a composition and not a label: naming it changes what is computed.
        let named = resolved("preset = \"zero\"\nseed = 5", None, None);
        let zero = Preset::Zero.config();
        assert_eq!(
            named,
            Config {
                seed: 5,
                ..zero.clone()
            }
        );
        assert_eq!(resolved("seed = 5", Some(Preset::Zero), Some(0)), zero);
        assert_eq!(resolved(&named.to_toml(), None, None), named);

        for text in ["seed = -1", "seed = \"x\"", "preset = \"x\""] {
            let error = file(text).unwrap_err().to_string();
            assert!(error.contains("mine.toml"), "{error}");
        }
        for set in ["seed=5", "preset=true", " seed =5"] {
            let error = resolve(&[set]).unwrap_err().to_string();
            assert!(error.contains("has --"), "{set}: {error}");
        }
    }

    #[test]
    fn a_change_may_be_for_some_presets_only() {
        let changes = Overrides::default().set("algorithm.steps=7").unwrap();
        let changes = changes
            .set("oprl-atac,oprl-atac+ted:algorithm.warm_start=3")
            .and_then(|it| it.set("zero : algorithm.steps=9"));
        let steps = |preset| {
            let config = changes.as_ref().unwrap().resolve(Some(preset), None);
            config.unwrap().algorithm.steps()
        };
        assert_eq!((steps(Preset::Zero), steps(Preset::True)), (9, 7));
        let atac = changes
            .as_ref()
            .unwrap()
            .resolve(Some(Preset::OprlAtacTed), None);
        assert!(atac.unwrap().to_toml().contains("warm_start = 3"));
        let error = Overrides::default()
            .set("zer:algorithm.steps=9")
            .unwrap_err();
        assert!(
            error.to_string().contains("no preset is called \"zer\""),
            "{error}"
        );
        assert!(Overrides::default().set(":algorithm.steps=9").is_err());
        let changes = changes.unwrap();
        assert!(changes.meant_for(&[Preset::Zero, Preset::OprlAtac]).is_ok());
        let error = changes.meant_for(&[Preset::OprlAtac]).unwrap_err();
        let error = error.to_string();
        assert!(error.contains("zero : algorithm.steps=9"), "{error}");
    }

    #[test]
    fn an_override_without_a_value_is_refused() {
        for set in ["algorithm.steps", "=3", "algorithm.=3", ".steps=3"] {
            assert!(
                matches!(resolve(&[set]), Err(ConfigError::Override { .. })),
                "{set}"
            );
        }
    }
}
