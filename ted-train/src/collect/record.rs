//! From the bridge's episode to the dataset's record, simulator state included.

use crate::dataset::{EpisodeRecord, InfoColumn};
use firmware_sim::bridge::Episode;

/// The record of an episode that was played from `seed`.
///
/// `qpos`, `qvel` and the mocap pose of a row put the simulator back to where it was, in an episode with its `goal`; the step
/// from there is the recorded one to within 1e-9 (`test_task.py` of the bridge) and not to the bit, because the warm start of
/// MuJoCo's solver is not stored. `goal`, the vector that the task drew for the episode, is repeated in every row because
/// Minari's infos are per row.
pub(super) fn from_bridge(seed: u64, episode: Episode) -> EpisodeRecord {
    let rows = episode.steps() + 1;
    let column = |name: &str, values: Vec<f64>| InfoColumn {
        name: name.into(),
        width: values.len() / rows,
        values,
    };
    let infos = [
        column("qpos", episode.qpos),
        column("qvel", episode.qvel),
        column("mocap_pos", episode.mocap_pos),
        column("mocap_quat", episode.mocap_quat),
        column("goal", episode.goal.repeat(rows)),
    ];
    // The toy has none of them.
    let infos = infos.into_iter().filter(|info| info.width > 0).collect();
    EpisodeRecord {
        seed: Some(seed),
        observations: episode.observations,
        actions: episode.actions,
        rewards: episode.rewards,
        terminations: episode.terminations,
        truncations: episode.truncations,
        success: episode.success,
        infos,
    }
}
