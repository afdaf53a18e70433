//! The names of the 50 Meta-World tasks, of the scenes that two of them share, the groups of both, and what was probably meant by a
//! name that is none.

use thiserror::Error;

/// All 50 tasks of Meta-World v3, in alphabetical order.
pub const ALL: [&str; 50] = [
    "assembly-v3",
    "basketball-v3",
    "bin-picking-v3",
    "box-close-v3",
    "button-press-topdown-v3",
    "button-press-topdown-wall-v3",
    "button-press-v3",
    "button-press-wall-v3",
    "coffee-button-v3",
    "coffee-pull-v3",
    "coffee-push-v3",
    "dial-turn-v3",
    "disassemble-v3",
    "door-close-v3",
    "door-lock-v3",
    "door-open-v3",
    "door-unlock-v3",
    "drawer-close-v3",
    "drawer-open-v3",
    "faucet-close-v3",
    "faucet-open-v3",
    "hammer-v3",
    "hand-insert-v3",
    "handle-press-side-v3",
    "handle-press-v3",
    "handle-pull-side-v3",
    "handle-pull-v3",
    "lever-pull-v3",
    "peg-insert-side-v3",
    "peg-unplug-side-v3",
    "pick-out-of-hole-v3",
    "pick-place-v3",
    "pick-place-wall-v3",
    "plate-slide-back-side-v3",
    "plate-slide-back-v3",
    "plate-slide-side-v3",
    "plate-slide-v3",
    "push-back-v3",
    "push-v3",
    "push-wall-v3",
    "reach-v3",
    "reach-wall-v3",
    "shelf-place-v3",
    "soccer-v3",
    "stick-pull-v3",
    "stick-push-v3",
    "sweep-into-v3",
    "sweep-v3",
    "window-close-v3",
    "window-open-v3",
];

/// The ten tasks of the paper's Table 4, by their v3 names.
pub const EXAMPLE_10: [&str; 10] = [
    "box-close-v3",
    "drawer-open-v3",
    "hammer-v3",
    "handle-pull-side-v3",
    "pick-place-v3",
    "plate-slide-back-v3",
    "push-v3",
    "reach-wall-v3",
    "sweep-v3",
    "sweep-into-v3",
];

/// The tasks of two intentions: each is a scene that two scripted policies play, each after its own goal, with the reward of the
/// first or the second one. The goal is not visible. `firmware-sim/metaworld-bridge/pairs.py` says which tasks these are.
pub const TWO_INTENTIONS: [&str; 8] = [
    "faucet-open_faucet-close_first",
    "faucet-open_faucet-close_second",
    "plate-slide-side_plate-slide_first",
    "plate-slide-side_plate-slide_second",
    "push-left_push-right_first",
    "push-left_push-right_second",
    "reach-left_reach-right_first",
    "reach-left_reach-right_second",
];

/// The names of the groups, with their tasks.
pub const GROUPS: [(&str, &[&str]); 3] = [
    ("example10", &EXAMPLE_10),
    ("all", &ALL),
    ("two-intentions", &TWO_INTENTIONS),
];

/// A name that does not name what is wanted.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum TaskError {
    /// It is neither a task nor a group.
    #[error("there is no task {name:?}{}: a task is one of the 50 of Meta-World v3, one of two \
             intentions such as faucet-open_faucet-close_first, or a group: example10, all, two-intentions", near(.suggestions))]
    Unknown {
        /// What was asked for.
        name: String,
        /// The tasks and groups that come nearest, best first.
        suggestions: Vec<&'static str>,
    },
    /// It is a group, and one task is wanted.
    #[error("{name} is a group of {count} tasks, and one task is wanted: {first}, for example")]
    Group {
        /// The group.
        name: &'static str,
        /// How many tasks it has.
        count: usize,
        /// The first of them.
        first: &'static str,
    },
}

/// The tasks that a name stands for: the task itself, or all of a group.
///
/// # Errors
/// When the name is neither.
pub fn resolve(name: &str) -> Result<&'static [&'static str], TaskError> {
    if let Some((_, tasks)) = GROUPS.iter().find(|(group, _)| *group == name) {
        return Ok(tasks);
    }
    [&ALL[..], &TWO_INTENTIONS]
        .into_iter()
        .flat_map(|tasks| tasks.chunks(1))
        .find(|task| task == &[name])
        .ok_or_else(|| unknown(name))
}

/// The scene of a task of two intentions, which it shares with the task of the other one's reward; none for Meta-World's own.
#[must_use]
pub fn scene(task: &str) -> Option<&str> {
    let (scene, _) = task.rsplit_once('_')?;
    TWO_INTENTIONS.contains(&task).then_some(scene)
}

/// The one task of this name.
///
/// # Errors
/// When the name is no task, but a group or nothing at all.
pub fn single(name: &str) -> Result<&'static str, TaskError> {
    match resolve(name)? {
        [task] => Ok(task),
        group => Err(TaskError::Group {
            name: GROUPS
                .iter()
                .find_map(|(name, tasks)| (*tasks == group).then_some(*name))
                .unwrap_or_default(),
            count: group.len(),
            first: group.first().copied().unwrap_or_default(),
        }),
    }
}

fn unknown(name: &str) -> TaskError {
    let wanted = name.to_lowercase();
    let stem = stem(&wanted);
    let mut near: Vec<(usize, &'static str)> = ALL
        .into_iter()
        .chain(TWO_INTENTIONS)
        .chain(GROUPS.map(|(group, _)| group))
        .map(|candidate| (distance(stem, self::stem(candidate)), candidate))
        .filter(|(distance, candidate)| {
            *distance <= 3 || (stem.len() > 3 && candidate.contains(stem))
        })
        .collect();
    near.sort();
    TaskError::Unknown {
        name: name.to_owned(),
        suggestions: near
            .into_iter()
            .take(4)
            .map(|(_, candidate)| candidate)
            .collect(),
    }
}

/// A task's name without its version, so that `drawer-open` and `drawer-open-v2` are near to `drawer-open-v3`.
fn stem(name: &str) -> &str {
    match name.rsplit_once("-v") {
        Some((stem, version)) if version.chars().all(|c| c.is_ascii_digit()) => stem,
        _ => name,
    }
}

/// Edits (insert, delete, replace one character) between two names.
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, from) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, to) in b.iter().enumerate() {
            let replace = diagonal + usize::from(from != *to);
            diagonal = row[j + 1];
            row[j + 1] = replace.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

fn near(suggestions: &[&str]) -> String {
    match suggestions {
        [] => String::new(),
        names => format!(" (did you mean {}?)", names.join(" or ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn suggestions(name: &str) -> Vec<&'static str> {
        match unknown(name) {
            TaskError::Unknown { suggestions, .. } => suggestions,
            TaskError::Group { .. } => Vec::new(),
        }
    }

    #[test]
    fn every_task_resolves_to_itself_and_groups_to_their_tasks() {
        for task in ALL {
            assert_eq!(resolve(task), Ok(&[task][..]));
        }
        assert_eq!(resolve("all").map(<[_]>::len), Ok(50));
        for task in TWO_INTENTIONS {
            assert_eq!(resolve(task), Ok(&[task][..]));
        }
        assert!(
            resolve("example10").is_ok_and(|tasks| tasks.iter().all(|task| ALL.contains(task)))
        );
        let refused = single("all").unwrap_err().to_string();
        assert!(
            refused.starts_with("all is a group of 50 tasks"),
            "{refused}"
        );
    }

    #[test]
    fn both_tasks_of_a_scene_name_it_and_meta_world_s_own_have_none() {
        for pair in TWO_INTENTIONS.chunks(2) {
            let scene = scene(pair[0]).unwrap();
            assert_eq!(pair, [format!("{scene}_first"), format!("{scene}_second")]);
        }
        assert!(ALL.iter().all(|task| scene(task).is_none()));
        assert_eq!(scene("push-left_push-right_third"), None);
        assert_eq!(
            suggestions("faucet-open_faucet-close").first(),
            Some(&"faucet-open_faucet-close_first")
        );
    }

    #[test]
    fn the_table_is_sorted_and_has_no_name_twice() {
        assert!(ALL.windows(2).all(|pair| pair[0] < pair[1]));
    }

    #[test]
    fn a_name_without_its_version_or_with_an_old_one_is_told_the_new_name() {
        for name in [
            "drawer-open",
            "drawer-open-v2",
            "Drawer-Open-v3",
            "drawr-open-v3",
        ] {
            assert_eq!(suggestions(name).first(), Some(&"drawer-open-v3"), "{name}");
        }
    }

    #[test]
    fn a_part_of_a_name_lists_the_tasks_that_contain_it() {
        assert!(suggestions("window").contains(&"window-open-v3"));
    }

    #[test]
    fn nonsense_gets_no_suggestions_but_still_an_answer() {
        assert!(suggestions("quantum-chess").is_empty());
        assert!(unknown("quantum-chess").to_string().contains("example10"));
    }
}
