//! The names of the 50 Meta-World tasks, of the scenes that two of them share, and the groups of both.

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

/// The scene of a task of two intentions, which it shares with the task of the other one's reward; none for Meta-World's own.
#[must_use]
pub fn scene(task: &str) -> Option<&str> {
    let (scene, _) = task.rsplit_once('_')?;
    TWO_INTENTIONS.contains(&task).then_some(scene)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_tasks_of_a_scene_name_it_and_meta_world_s_own_have_none() {
        for pair in TWO_INTENTIONS.chunks(2) {
            let scene = scene(pair[0]).unwrap();
            assert_eq!(pair, [format!("{scene}_first"), format!("{scene}_second")]);
        }
        assert!(ALL.iter().all(|task| scene(task).is_none()));
        assert_eq!(scene("push-left_push-right_third"), None);
    }

    #[test]
    fn the_table_is_sorted_and_has_no_name_twice() {
        assert!(ALL.windows(2).all(|pair| pair[0] < pair[1]));
        assert!(EXAMPLE_10.iter().all(|task| ALL.contains(task)));
    }
}
