//! The names of the 50 Meta-World tasks, the groups of them, and what was probably meant by a name that is none.

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

/// The names of the groups, with their tasks.
pub const GROUPS: [(&str, &[&str]); 2] = [("example10", &EXAMPLE_10), ("all", &ALL)];

/// A name that does not name what is wanted.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum TaskError {
    /// It is neither a task nor a group.
    #[error("there is no task {name:?}{}: a task is one of the 50 of Meta-World v3, or a group: example10, all", near(.suggestions))]
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
    match ALL.iter().position(|task| *task == name) {
        Some(index) => Ok(&ALL[index..=index]),
        None => Err(unknown(name)),
    }
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
