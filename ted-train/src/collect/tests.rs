//! Collection against a simulator made of arithmetic: order, kills, failures and refusals.

use super::*;
use crate::dataset::Dataset;
use firmware_sim::bridge::{BridgeError, Episode, EpisodeJob, Shape as BridgeShape};
use firmware_sim::exit::ExitCode;
use firmware_sim::worlds::metaworld;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Plays episodes that are arithmetic on the seed, in a chosen order, and stops after some.
struct Arithmetic {
    versions: &'static str,
    backwards: bool,
    stop_after: usize,
    played: Vec<u64>,
}

impl Arithmetic {
    fn new() -> Self {
        Self {
            versions: "python=3.11.7 metaworld=3.1.1 machine=x",
            backwards: false,
            stop_after: usize::MAX,
            played: vec![],
        }
    }
}

impl EpisodeSource for Arithmetic {
    fn versions(&mut self) -> Result<String, BridgeError> {
        Ok(self.versions.into())
    }

    fn run(
        &mut self,
        jobs: &[EpisodeJob],
        on_episode: source::OnEpisode,
    ) -> Result<(), BridgeError> {
        let mut order: Vec<_> = (0..jobs.len()).collect();
        if self.backwards {
            order.reverse();
        }
        for (count, index) in order.into_iter().enumerate() {
            if count == self.stop_after {
                return Err(BridgeError::Interrupted);
            }
            self.played.push(jobs[index].seed);
            if on_episode(index, episode(&jobs[index])).is_break() {
                break;
            }
        }
        Ok(())
    }
}

fn episode(job: &EpisodeJob) -> Episode {
    const STEPS: usize = 3;
    let number = |at: usize| (job.seed % 1000) as f64 / 1000.0 + at as f64 * job.behaviour.epsilon;
    let floats = |count: usize| (0..count).map(number).collect::<Vec<f64>>();
    let narrow = |count: usize| -> Vec<f32> {
        floats(count)
            .into_iter()
            .map(|value| value as f32)
            .collect()
    };
    let rows = STEPS + 1;
    Episode {
        shape: BridgeShape {
            observation: 39,
            action: 4,
            qpos: 2,
            qvel: 3,
            mocap: 1,
            goal: 6,
            horizon: metaworld::EPISODE_STEPS,
        },
        observations: narrow(rows * 39),
        actions: narrow(STEPS * 4).into_iter().map(f32::fract).collect(),
        rewards: floats(STEPS),
        success: vec![false, false, job.behaviour.epsilon == 0.0],
        terminations: vec![false; STEPS],
        truncations: vec![false, false, true],
        qpos: floats(rows * 2),
        qvel: floats(rows * 3),
        mocap_pos: floats(rows * 3),
        mocap_quat: floats(rows * 4),
        goal: floats(6),
    }
}

fn config(root: &Path) -> CollectConfig {
    CollectConfig {
        task: "drawer-open-v3".into(),
        recipe: Recipe::Paper,
        episodes: Some(30),
        good: None,
        seed: 7,
        workers: 2,
        root: root.to_path_buf(),
    }
}

fn collect(root: &Path, source: &mut Arithmetic) -> Result<CollectReport, CollectError> {
    run_on(&config(root), source, Audience::Nobody)
}

/// Every file of the dataset with its bytes.
fn tree(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut files = BTreeMap::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                files.insert(
                    path.strip_prefix(folder).unwrap().to_path_buf(),
                    fs::read(&path).unwrap(),
                );
            }
        }
    }
    files
}

#[test]
fn a_collection_is_a_dataset_that_says_how_it_came_about() {
    let root = tempfile::tempdir().unwrap();
    let report = collect(root.path(), &mut Arithmetic::new()).unwrap();
    assert_eq!(report.dataset, "ted/drawer-open-v3-paper-n30-s7-v0");
    assert_eq!(report.collected, 30);
    let dataset = Dataset::open(&report.folder).unwrap();
    assert_eq!(
        (dataset.id(), dataset.task()),
        (report.dataset.as_str(), Some("drawer-open-v3"))
    );
    assert_eq!((dataset.episodes().len(), dataset.step_count()), (30, 90));
    let engine = &dataset.origin().unwrap().engine;
    assert_eq!(engine.keys().collect::<Vec<_>>(), ["machine", "metaworld"]);
    assert_eq!(
        dataset.episodes()[4].seed,
        Some(Plan::new(&config(root.path())).unwrap().seed(4))
    );
    assert!((report.mix.mean_return - dataset.mean_return_true()).abs() < 1e-12);
    assert_eq!(report.mix.max_return, dataset.max_return_true());
    let parts: Vec<_> = report
        .parts
        .iter()
        .map(|part| (part.part.as_str(), part.episodes, part.success_rate))
        .collect();
    assert_eq!(parts, [("noisy", 2, 1.0), ("epsilon", 28, 0.0)]);
}

#[test]
fn the_order_of_the_workers_does_not_show_in_the_bytes() {
    let [one, other] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    let forwards = collect(one.path(), &mut Arithmetic::new()).unwrap();
    let mut source = Arithmetic {
        backwards: true,
        ..Arithmetic::new()
    };
    let backwards = collect(other.path(), &mut source).unwrap();
    assert_eq!(tree(&forwards.folder), tree(&backwards.folder));
    assert_eq!(forwards.mix, backwards.mix);
}

#[test]
fn an_interrupted_collection_goes_on_and_plays_nothing_twice() {
    let [one, other] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    let whole = collect(one.path(), &mut Arithmetic::new()).unwrap();
    let mut first = Arithmetic {
        stop_after: 11,
        backwards: true,
        ..Arithmetic::new()
    };
    let error = collect(other.path(), &mut first).unwrap_err();
    assert!(
        matches!(
            error,
            CollectError::Interrupted {
                done: 11,
                total: 30
            }
        ),
        "{error}"
    );
    let mut second = Arithmetic::new();
    let resumed = collect(other.path(), &mut second).unwrap();
    assert_eq!((resumed.collected, second.played.len()), (19, 19));
    assert!(
        second
            .played
            .iter()
            .all(|seed| !first.played.contains(seed))
    );
    assert_eq!(tree(&whole.folder), tree(&resumed.folder));
    assert_eq!(whole.parts, resumed.parts);
}

#[test]
fn a_finished_collection_needs_no_simulator_until_it_is_damaged() {
    let root = tempfile::tempdir().unwrap();
    assert_eq!(finished(&config(root.path())).unwrap(), None);
    let report = collect(root.path(), &mut Arithmetic::new()).unwrap();
    let whole = tree(&report.folder);
    // Another engine would be refused for a collection in progress; what is finished is just reported.
    let mut newer = Arithmetic {
        versions: "metaworld=9",
        ..Arithmetic::new()
    };
    let again = collect(root.path(), &mut newer).unwrap();
    assert_eq!((again.collected, newer.played.len()), (0, 0));
    assert_eq!((again.parts, again.mix), (report.parts, report.mix));

    fs::write(report.folder.join("data/12/part-0.arrow"), b"ARROW1").unwrap();
    fs::remove_dir_all(report.folder.join("data/3")).unwrap();
    let error = collect(root.path(), &mut newer).unwrap_err();
    assert!(
        error.to_string().contains("was begun differently"),
        "{error}"
    );
    let mut source = Arithmetic::new();
    assert_eq!(collect(root.path(), &mut source).unwrap().collected, 2);
    assert_eq!(tree(&report.folder), whole);
}

#[test]
fn an_episode_that_cannot_be_written_stops_the_collection_with_the_reason() {
    let root = tempfile::tempdir().unwrap();
    let folder = config(root.path()).folder().unwrap();
    fs::create_dir_all(folder.join("data")).unwrap();
    // A file where the episode's folder has to go.
    fs::write(folder.join("data/5"), b"in the way").unwrap();
    let mut source = Arithmetic::new();
    let error = collect(root.path(), &mut source).unwrap_err();
    assert!(matches!(error, CollectError::Write(_)), "{error}");
    assert!(error.to_string().contains("data/5"), "{error}");
    assert_eq!(source.played.len(), 6);
}

#[test]
fn what_cannot_be_collected_is_refused_before_anything_is_written() {
    let root = tempfile::tempdir().unwrap();
    let refuse = |config: &CollectConfig| {
        run_on(config, &mut Arithmetic::new(), Audience::Nobody).unwrap_err()
    };
    let unknown = CollectConfig {
        task: "drawer-opn-v3".into(),
        ..config(root.path())
    };
    assert!(refuse(&unknown).to_string().contains("drawer-open-v3"));
    let nothing = CollectConfig {
        episodes: Some(0),
        ..config(root.path())
    };
    assert!(matches!(refuse(&nothing), CollectError::NoEpisodes));
    let too_good = CollectConfig {
        good: Some(31),
        ..config(root.path())
    };
    assert_eq!(
        refuse(&too_good).to_string(),
        "31 good episodes of 30: --good counts some of --episodes"
    );
    let expert = CollectConfig {
        good: Some(5),
        recipe: Recipe::Expert,
        ..config(root.path())
    };
    assert!(matches!(refuse(&expert), CollectError::NoGoodPart { .. }));
    assert_eq!(fs::read_dir(root.path()).unwrap().count(), 0);
}

#[test]
fn every_log_has_a_name_of_its_own() {
    let id = |recipe, episodes, good| {
        let config = CollectConfig {
            recipe,
            episodes,
            good,
            ..config(Path::new("data"))
        };
        config.dataset_id().unwrap().to_string()
    };
    let named = |name: &str| format!("ted/drawer-open-v3-{name}-s7-v0");
    assert_eq!(id(Recipe::Paper, None, None), named("paper"));
    assert_eq!(id(Recipe::Biased, None, None), named("biased"));
    assert_eq!(id(Recipe::Drift, Some(300), None), named("drift-n300"));
    assert_eq!(id(Recipe::Paper, None, Some(20)), named("paper-good20"));
    assert_eq!(
        id(Recipe::Paper, Some(100), Some(0)),
        named("paper-good0-n100")
    );
    // The recipe's own number is no other log.
    assert_eq!(id(Recipe::Paper, None, Some(50)), named("paper"));
}

#[test]
fn a_log_with_fewer_good_episodes_differs_in_those_alone() {
    let configs = [None, Some(0)].map(|good| CollectConfig {
        good,
        ..config(Path::new("data"))
    });
    let [paper, none] = configs.each_ref().map(|config| Plan::new(config).unwrap());
    for episode in 0..30 {
        let same = paper.job(episode) == none.job(episode);
        assert_eq!(same, episode >= 2, "{episode}");
        assert_eq!(none.job(episode).behaviour.epsilon, 0.8);
    }
}

#[test]
fn an_episode_s_note_says_what_was_added_to_its_actions() {
    let root = tempfile::tempdir().unwrap();
    for (recipe, said) in [
        (Recipe::Biased, "\"push\": ["),
        (Recipe::Drift, "\"drift_std\": 0.4"),
    ] {
        let config = CollectConfig {
            recipe,
            ..config(root.path())
        };
        let report = run_on(&config, &mut Arithmetic::new(), Audience::Nobody).unwrap();
        let note = fs::read_to_string(report.folder.join("data/3/metadata.json")).unwrap();
        assert!(note.contains(said), "{note}");
        assert_eq!(finished(&config).unwrap().unwrap().parts, report.parts);
    }
    let paper = collect(root.path(), &mut Arithmetic::new()).unwrap();
    let note = fs::read_to_string(paper.folder.join("data/3/metadata.json")).unwrap();
    assert!(!note.contains("push") && !note.contains("drift"), "{note}");
}

#[test]
fn two_intentions_take_turns_and_both_rewards_are_of_the_same_episodes() {
    let [first, second] = ["first", "second"].map(|judge| CollectConfig {
        task: format!("push-left_push-right_{judge}"),
        episodes: Some(100),
        ..config(Path::new("data"))
    });
    assert_eq!(
        first.dataset_id().unwrap().to_string(),
        "ted/push-left_push-right_first-paper-n100-s7-v0"
    );
    let [first, second] = [&first, &second].map(|config| Plan::new(config).unwrap());
    let mut parts = BTreeMap::new();
    for episode in 0..100 {
        let (one, other) = (first.job(episode), second.job(episode));
        assert_eq!((one.seed, one.behaviour), (other.seed, other.behaviour));
        assert_eq!(u32::from(one.behaviour.purpose), episode % 2);
        *parts.entry(first.behaviour(episode).part).or_insert(0) += 1;
    }
    let expected = [
        ("epsilon-first", 47),
        ("epsilon-second", 48),
        ("noisy-first", 3),
        ("noisy-second", 2),
    ];
    let expected = expected.map(|(part, count)| (part.to_owned(), count));
    assert_eq!(parts, BTreeMap::from(expected));
    assert!(first.origin("").goal.starts_with("hidden"));
}

#[test]
fn parts_that_take_turns_are_reported_once_each() {
    let root = tempfile::tempdir().unwrap();
    let config = CollectConfig {
        task: "reach-left_reach-right_second".into(),
        ..config(root.path())
    };
    let report = run_on(&config, &mut Arithmetic::new(), Audience::Nobody).unwrap();
    let parts = report.parts.iter();
    let parts: Vec<_> = parts.map(|it| (it.part.as_str(), it.episodes)).collect();
    assert_eq!(
        parts,
        [
            ("noisy-first", 1),
            ("noisy-second", 1),
            ("epsilon-first", 14),
            ("epsilon-second", 14)
        ]
    );
    assert_eq!(finished(&config).unwrap().unwrap().parts, report.parts);
}

#[test]
fn the_toy_is_collected_without_a_simulator_and_the_same_again() {
    let [one, other] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    let reports = [&one, &other].map(|root| {
        let config = CollectConfig {
            task: "toy-micrometres".into(),
            ..config(root.path())
        };
        let mut toy = ToySource::of(&config).unwrap();
        run_on(&config, &mut toy, Audience::Nobody).unwrap()
    });
    assert_eq!(reports[0].dataset, "ted/toy-micrometres-paper-n30-s7-v0");
    assert_eq!(tree(&reports[0].folder), tree(&reports[1].folder));
    let dataset = Dataset::open(&reports[0].folder).unwrap();
    assert_eq!((dataset.observation_dim(), dataset.action_dim()), (5, 3));
    assert_eq!((dataset.episodes().len(), dataset.step_count()), (30, 3000));
    assert!(dataset.observation_statistics().max[0] > 1e5);
    let [noisy, epsilon] = &reports[0].parts[..] else {
        panic!("{:?}", reports[0].parts)
    };
    assert!(noisy.mean_return > epsilon.mean_return);

    let drifting = CollectConfig {
        task: "toy".into(),
        recipe: Recipe::Drift,
        ..config(one.path())
    };
    let error = ToySource::of(&drifting)
        .map(|mut toy| run_on(&drifting, &mut toy, Audience::Nobody).unwrap_err());
    assert!(matches!(error, Some(CollectError::NoPush { .. })));
    assert!(ToySource::of(&config(one.path())).is_none());
}

#[test]
fn a_task_without_a_scripted_policy_is_refused_with_the_way_to_its_logs() {
    let root = tempfile::tempdir().unwrap();
    let hopper = CollectConfig {
        task: "hopper".into(),
        ..config(root.path())
    };
    let error = run_anywhere(&hopper, Engine::default(), Audience::Nobody).unwrap_err();
    assert_eq!(error.exit_code(), ExitCode::Usage);
    let text = error.to_string();
    assert!(
        text.contains("hopper has no scripted policy") && text.contains("`ted import`"),
        "{text}"
    );
}

#[test]
fn episodes_that_the_disk_has_no_room_for_are_refused_before_any_is_played() {
    let root = tempfile::tempdir().unwrap();
    let mut source = Arithmetic::new();
    let tight = Disk::with_free(|_| Some(5_000_000));
    let run = |disk, source: &mut Arithmetic| {
        run_on_disk(disk, &config(root.path()), source, Audience::Nobody)
    };
    let error = run(tight, &mut source).unwrap_err();
    let text = error.to_string();
    assert!(
        text.starts_with(
            "recording 30 episodes needs about 10.9 MB on the disk, and 5.0 MB are free at "
        ),
        "{text}"
    );
    assert!(
        text.contains("drawer-open-v3-paper-n30-s7-v0: free some, or name another place"),
        "{text}"
    );
    assert_eq!(error.exit_code(), firmware_sim::exit::ExitCode::Storage);
    assert!(source.played.is_empty());
    assert_eq!(
        fs::read_dir(root.path()).unwrap().count(),
        0,
        "nothing was begun"
    );

    // What is there already needs no room.
    let mut source = Arithmetic {
        stop_after: 20,
        ..source
    };
    let stopped = run(Disk::REAL, &mut source).unwrap_err();
    assert!(
        matches!(stopped, CollectError::Interrupted { done: 20, .. }),
        "{stopped}"
    );
    assert_eq!(run(tight, &mut Arithmetic::new()).unwrap().collected, 10);
}

#[test]
fn episodes_that_there_is_no_memory_for_are_refused_before_any_is_played() {
    let root = tempfile::tempdir().unwrap();
    let mut source = Arithmetic::new();
    let many = CollectConfig {
        episodes: Some(u32::MAX),
        ..config(root.path())
    };
    let error = run_on(&many, &mut source, Audience::Nobody).unwrap_err();
    let text = error.to_string();
    assert!(
        text.starts_with("--episodes is 4294967295, which needs about 4.4 TB of memory"),
        "{text}"
    );
    assert_eq!(error.exit_code(), firmware_sim::exit::ExitCode::Usage);
    assert_eq!(
        fs::read_dir(root.path()).unwrap().count(),
        0,
        "nothing was begun"
    );
}
