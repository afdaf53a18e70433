//! What a person calls a task, and what was probably meant by a name that is none.

use thiserror::Error;

use super::{LISTED, Task};

/// A name that does not name what is wanted.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum TaskError {
    /// It is neither a task nor a group.
    #[error("there is no task {name:?}{}: {}", near(.suggestions), known())]
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
pub fn resolve(name: &str) -> Result<Vec<Task>, TaskError> {
    for kind in LISTED {
        if let Some((_, tasks)) = group(kind.groups(), name) {
            return Ok(tasks.iter().map(|name| Task { kind, name }).collect());
        }
        if let Some(name) = kind.tasks().into_iter().find(|task| *task == name) {
            return Ok(vec![Task { kind, name }]);
        }
    }
    Err(unknown(name))
}

/// The one task of this name.
///
/// # Errors
/// When the name is no task, but a group or nothing at all.
pub fn single(name: &str) -> Result<Task, TaskError> {
    match (
        resolve(name)?.as_slice(),
        all_groups().find(|(group, _)| *group == name),
    ) {
        ([task], None) => Ok(*task),
        (_, Some((name, tasks))) => Err(TaskError::Group {
            name,
            count: tasks.len(),
            first: tasks.first().copied().unwrap_or_default(),
        }),
        (_, None) => Err(unknown(name)),
    }
}

type Group = (&'static str, &'static [&'static str]);

fn group(groups: &[Group], name: &str) -> Option<Group> {
    groups.iter().copied().find(|(group, _)| *group == name)
}

fn all_groups() -> impl Iterator<Item = Group> {
    LISTED
        .into_iter()
        .flat_map(|kind| kind.groups().iter().copied())
}

fn unknown(name: &str) -> TaskError {
    let wanted = name.to_lowercase();
    let stem = stem(&wanted);
    let mut near: Vec<(usize, &'static str)> = LISTED
        .into_iter()
        .flat_map(|kind| kind.tasks())
        .chain(all_groups().map(|(group, _)| group))
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

/// The worlds and their groups, for whoever has to choose.
fn known() -> String {
    let worlds: Vec<String> = (LISTED.into_iter())
        .map(|kind| match kind.tasks().as_slice() {
            [] => kind.name().to_owned(),
            [task] => format!("{task} ({})", kind.name()),
            [task, ..] => format!("{task} or another of {}", kind.name()),
        })
        .collect();
    let groups: Vec<&str> = all_groups().map(|(group, _)| group).collect();
    format!(
        "a task is {}; a group of tasks is {}; `ted worlds` lists them all",
        worlds.join(", "),
        groups.join(", ")
    )
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
    fn every_task_is_found_by_its_name_in_one_world_and_groups_hold_tasks_of_theirs() {
        let mut seen = Vec::new();
        for kind in LISTED {
            assert!(!kind.tasks().is_empty());
            for task in kind.tasks() {
                assert!(!seen.contains(&task), "{task} is in two worlds");
                seen.push(task);
                let found = single(task).unwrap();
                assert_eq!((found.name(), found.kind().name()), (task, kind.name()));
            }
            for (group, tasks) in kind.groups() {
                assert!(!seen.contains(group), "{group} is a task as well");
                assert_eq!(resolve(group).unwrap().len(), tasks.len());
                assert!(tasks.iter().all(|task| kind.tasks().contains(task)));
            }
        }
        let refused = single("all").unwrap_err().to_string();
        assert!(
            refused.starts_with("all is a group of 50 tasks"),
            "{refused}"
        );
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
