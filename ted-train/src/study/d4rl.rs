//! The paper's Section 4.3 on a person's own copy of D4RL: which files these are, which tasks they are of, and how they are learned from.

use std::path::{Path, PathBuf};

use firmware_sim::worlds::{self, Task};

use crate::config::Preset;
use crate::dataset::DatasetError;
use crate::dataset::minari::DatasetId;

/// The namespace of D4RL's datasets.
pub const NAMESPACE: &str = "d4rl";
/// What the paper compares.
pub const PRESETS: [Preset; 3] = [Preset::True, Preset::Random, Preset::OprlI];

/// Of the locomotion tasks the random, the good and the mixed logs.
const ROBOTS: [&str; 4] = ["hopper", "halfcheetah", "walker2d", "ant"];
const LOGS: [&str; 5] = [
    "random",
    "medium",
    "medium-replay",
    "medium-expert",
    "expert",
];
/// Of the maze a dataset, its task, and what D4RL calls its file.
const MAZES: [(&str, &str, &str); 6] = [
    (
        "umaze",
        "antmaze-umaze",
        "u-maze_noisy_multistart_False_multigoal_False",
    ),
    (
        "umaze-diverse",
        "antmaze-umaze",
        "u-maze_noisy_multistart_True_multigoal_True",
    ),
    (
        "medium-play",
        "antmaze-medium",
        "big-maze_noisy_multistart_True_multigoal_False",
    ),
    (
        "medium-diverse",
        "antmaze-medium",
        "big-maze_noisy_multistart_True_multigoal_True",
    ),
    (
        "large-play",
        "antmaze-large",
        "hardest-maze_noisy_multistart_True_multigoal_False",
    ),
    (
        "large-diverse",
        "antmaze-large",
        "hardest-maze_noisy_multistart_True_multigoal_True",
    ),
];

/// What every run is trained with: as many updates as IQL was published with.
const SETS: [&str; 1] = ["algorithm.steps=1000000"];
/// What IQL has for the maze (its `configs/antmaze_config.py` and `train_offline.py`), where what is flown is 0 or 1.
const MAZE_SETS: [&str; 4] = [
    "algorithm.tau=0.9",
    "algorithm.beta=10",
    "discount.shift=-1",
    "schedule.evaluation_episodes=100",
];

/// One of the 26 datasets.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// Its name, such as `hopper-medium-v2`.
    pub name: String,
    /// Its task.
    pub task: Task,
    /// What its file may be called: as D4RL calls it, or by its name.
    pub files: [String; 2],
    /// What the reader is told.
    pub options: Vec<String>,
    /// What its runs are configured with.
    pub sets: Vec<&'static str>,
}

impl Source {
    /// The id of the dataset that is made of it.
    ///
    /// # Errors
    /// Never, for those of [`sources`].
    pub fn id(&self) -> Result<DatasetId, DatasetError> {
        format!("{NAMESPACE}/{}", self.name).parse()
    }

    /// Its file in a folder, if it is there.
    #[must_use]
    pub fn file(&self, folder: &Path) -> Option<PathBuf> {
        let files = self.files.iter().map(|file| folder.join(file));
        files.into_iter().find(|file| file.is_file())
    }
}

/// The 26 datasets of the paper's Table 15.
#[must_use]
pub fn sources() -> Vec<Source> {
    let source =
        |name: String, task: &str, file: String, options: &[&str], sets: &[&'static str]| Source {
            task: worlds::single(task).expect("a test looks all of them up"),
            files: [file, format!("{name}.hdf5")],
            options: options.iter().map(|&it| it.to_owned()).collect(),
            sets: [&SETS[..], sets].concat(),
            name,
        };
    let locomotion = ROBOTS
        .into_iter()
        .flat_map(|robot| LOGS.map(|logs| (robot, logs)));
    let locomotion = locomotion.map(|(robot, logs)| {
        // The others are contact forces, which the recorder never computed.
        let options: &[&str] = match robot {
            "ant" => &["--observations", "observations[:27]"],
            _ => &[],
        };
        let file = format!("{robot}_{}-v2.hdf5", logs.replace('-', "_"));
        source(format!("{robot}-{logs}-v2"), robot, file, options, &[])
    });
    let mazes = MAZES.into_iter().map(|(logs, task, file)| {
        let file = format!("Ant_maze_{file}_sparse_fixed.hdf5");
        source(format!("antmaze-{logs}-v2"), task, file, &[], &MAZE_SETS)
    });
    locomotion.chain(mazes).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Overrides;
    use crate::study::paper;

    #[test]
    fn there_are_the_26_of_the_paper_and_every_run_can_be_configured() {
        let sources = sources();
        assert_eq!(sources.len(), 26);
        for source in &sources {
            assert_eq!(source.task.kind().name(), NAMESPACE);
            assert_eq!(
                source.id().unwrap().to_string(),
                format!("d4rl/{}", source.name)
            );
            for preset in PRESETS {
                let changes = (source.sets.iter())
                    .try_fold(Overrides::default(), |all, set| all.set(set))
                    .unwrap();
                let config = changes.resolve(Some(preset), None).unwrap();
                assert_eq!(config.algorithm.steps(), 1_000_000);
                assert!(
                    paper::score(&source.name, preset).is_some(),
                    "{}",
                    source.name
                );
            }
        }
        let files = |place: usize| sources[place].files[0].as_str();
        assert_eq!(files(3), "hopper_medium_expert-v2.hdf5");
        assert_eq!(
            files(20),
            "Ant_maze_u-maze_noisy_multistart_False_multigoal_False_sparse_fixed.hdf5"
        );
    }
}
