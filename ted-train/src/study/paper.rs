//! The scores that the paper reports, beside which a study prints its own.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use crate::config::Preset;

type Scores = BTreeMap<String, BTreeMap<String, [f64; 2]>>;

/// The paper's normalised score of a preset on a task and its spread, if it has one. The paper's tasks are Meta-World's v2; the
/// same tasks of a later version are compared with these.
#[must_use]
pub fn score(task: &str, preset: Preset) -> Option<[f64; 2]> {
    static SCORES: LazyLock<Scores> = LazyLock::new(|| {
        toml::from_str(include_str!("paper.toml")).expect("a test reads all of it")
    });
    let (task, version) = task.rsplit_once("-v")?;
    version.parse::<u32>().ok()?;
    SCORES.get(task)?.get(preset.name()).copied()
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
        assert_eq!(score("drawer-open", Preset::True), None);
        assert_eq!(score("ted/mine-v0", Preset::True), None);
    }

    #[test]
    fn every_name_is_a_preset_and_every_task_has_the_methods_of_the_main_tables() {
        let scores: Scores = toml::from_str(include_str!("paper.toml")).unwrap();
        assert_eq!(scores.len(), 50);
        for (task, row) in scores {
            for name in row.keys() {
                Preset::try_from(name.clone()).unwrap();
            }
            for name in [
                "true",
                "random",
                "bc10",
                "otr",
                "oppo",
                "oprl-i",
                "oprl-i+ted",
                "pt",
                "pt+ted",
                "pt+truncate",
            ] {
                assert!(row.contains_key(name), "{task} {name}");
            }
        }
    }
}
