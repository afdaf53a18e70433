//! The scores that the paper reports, beside which a study prints its own.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use crate::config::Preset;

type Scores = BTreeMap<String, BTreeMap<String, [f64; 2]>>;

/// The tables of Meta-World's tasks, and of D4RL's datasets.
const TABLES: [&str; 2] = [include_str!("paper.toml"), include_str!("paper-d4rl.toml")];

/// The paper's normalised score of a preset and its spread, if it has one: of a task of Meta-World, or of a dataset of D4RL, with its
/// namespace or without. The paper's tasks are Meta-World's v2; the same tasks of a later version are compared with these.
#[must_use]
pub fn score(name: &str, preset: Preset) -> Option<[f64; 2]> {
    static SCORES: LazyLock<Scores> = LazyLock::new(|| {
        let tables =
            TABLES.map(|text| toml::from_str::<Scores>(text).expect("a test reads all of it"));
        tables.into_iter().flatten().collect()
    });
    let (name, version) = name
        .strip_prefix("d4rl/")
        .unwrap_or(name)
        .rsplit_once("-v")?;
    version.parse::<u32>().ok()?;
    SCORES.get(name)?.get(preset.name()).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scores_are_found_by_task_whatever_its_version_and_by_preset() {
        assert_eq!(
            score("drawer-open-v3", Preset::OprlITed),
            Some([0.56, 0.02])
        );
        assert_eq!(score("box-close-v2", Preset::PtTed), Some([0.34, 0.12]));
        assert_eq!(score("stick-pull-v3", Preset::True), Some([0.18, 0.01]));
        assert_eq!(score("drawer-open-v3", Preset::Zero), None);
        assert_eq!(
            score("d4rl/hopper-medium-v2", Preset::OprlI),
            Some([0.55, 0.01])
        );
        assert_eq!(
            score("antmaze-umaze-v2", Preset::Random),
            Some([0.87, 0.02])
        );
        assert_eq!(score("drawer-open", Preset::True), None);
        assert_eq!(score("ted/mine-v0", Preset::True), None);
    }

    #[test]
    fn every_name_is_a_preset_and_every_task_has_the_methods_of_the_main_tables() {
        let main = [
            "true",
            "random",
            "oprl-i",
            "bc10",
            "otr",
            "oppo",
            "oprl-i+ted",
            "pt",
            "pt+ted",
            "pt+truncate",
        ];
        for (text, rows, columns) in [(TABLES[0], 50, &main[..]), (TABLES[1], 26, &main[..3])] {
            let scores: Scores = toml::from_str(text).unwrap();
            assert_eq!(scores.len(), rows);
            for (task, row) in scores {
                for name in row.keys() {
                    Preset::try_from(name.clone()).unwrap();
                }
                for name in columns {
                    assert!(row.contains_key(*name), "{task} {name}");
                }
            }
        }
    }
}
