"""Tasks against the package's own environment, bit for bit, and against their own past. Needs the simulator.

Runs the paper's ten example tasks and a few with habits of their own; all 50 with TED_ALL_TASKS=1 (two minutes).
"""

import hashlib
import os
import pickle
import unittest
import warnings

import gymnasium
import metaworld
import mujoco
import numpy as np
from metaworld.env_dict import ALL_V3_ENVIRONMENTS
from metaworld.types import Task as MetaWorldTask

from collect import Behaviour, collect
from task import Task

STEPS = 25
BEHAVIOUR = Behaviour(noise_std=0.3, epsilon=0.3)
SEED = 7

TASKS = [
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
    "basketball-v3",  # its target is a window on the simulator's memory
    "bin-picking-v3",  # leaves the model as it is
    "door-unlock-v3",  # so is the first place of its lock, where the door is moved
    "stick-pull-v3",  # two objects
]

if os.environ.get("TED_ALL_TASKS"):
    TASKS = list(ALL_V3_ENVIRONMENTS)


def model_digest(task):
    """Of the whole MuJoCo model, as it would be saved."""
    data = np.empty(mujoco.mj_sizeModel(task.env.model), np.uint8)
    mujoco.mj_saveModel(task.env.model, None, data)
    return hashlib.sha256(data).hexdigest()


def packaged(name, goal):
    """`gym.make("Meta-World/MT1")`, wrappers and all, with one goal to choose from."""
    env = gymnasium.make("Meta-World/MT1", env_name=name)
    wrapper = env
    while not isinstance(wrapper, metaworld.RandomTaskSelectWrapper):
        wrapper = wrapper.env
    data = dict(rand_vec=goal, env_cls=ALL_V3_ENVIRONMENTS[name], partially_observable=False)
    wrapper.tasks = [MetaWorldTask(env_name=name, data=pickle.dumps(data))]
    return env


class Episodes(unittest.TestCase):
    def setUp(self):
        warnings.simplefilter("ignore")

    def assert_same(self, record, other):
        for ours, theirs in zip(record.parts(), other.parts(), strict=True):
            np.testing.assert_array_equal(ours, theirs)

    def test_leaves_no_trace_and_equals_the_package(self):
        moved = set()
        for name in TASKS:
            with self.subTest(name):
                task = Task(name)
                untouched = model_digest(task)
                fresh = collect(task, SEED, STEPS, BEHAVIOUR)
                collect(task, SEED + 1, STEPS, BEHAVIOUR)
                self.assert_same(collect(task, SEED, STEPS, BEHAVIOUR), fresh)
                if model_digest(task) != untouched:
                    moved.add(name)
                task._snapshot.restore()
                self.assertEqual(model_digest(task), untouched)
                self.assertEqual(task.reset_to(fresh.goal).astype("f4").tobytes(), fresh.observations[0].tobytes())
                self.compare_with_package(packaged(name, fresh.goal.copy()), fresh)
        self.assertGreater(len(moved), len(TASKS) // 2, "most tasks move something in the model: there is a trace to remove")

    def test_a_recorded_row_puts_the_simulator_back_to_where_it_was(self):
        """Up to the solver's warm start, which is not recorded."""
        for name in TASKS:
            with self.subTest(name):
                task = Task(name)
                record = collect(task, SEED, STEPS, BEHAVIOUR)
                row = STEPS // 2
                task.reset_to(record.goal)
                data = task.env.data
                data.qpos[:], data.qvel[:] = record.qpos[row], record.qvel[row]
                data.mocap_pos[:], data.mocap_quat[:] = record.mocap_pos[row], record.mocap_quat[row]
                mujoco.mj_forward(task.env.model, data)
                observation, reward, *_ = task.step(record.actions[row])
                np.testing.assert_allclose(data.qpos, record.qpos[row + 1], rtol=0, atol=1e-12)
                np.testing.assert_allclose(data.qvel, record.qvel[row + 1], rtol=0, atol=1e-9)
                np.testing.assert_allclose(observation[:18], record.observations[row + 1][:18], rtol=1e-6, atol=1e-9)
                self.assertAlmostEqual(reward, record.rewards[row], delta=1e-9)

    def test_forgets_whatever_was_changed(self):
        task = Task("hammer-v3")
        untouched = model_digest(task)
        fresh = collect(task, SEED, STEPS, BEHAVIOUR)
        model, env = task.env.model, task.env
        model.body_pos += 0.01
        model.geom_friction *= 2
        model.eq_data[:] = 0
        env.hand_init_pos[:] = 0
        env.init_config["hand_init_pos"][:] = 1
        env.obj_init_pos = None
        env.never_seen_before = True
        env._last_stable_obs = "nonsense"
        self.assert_same(collect(task, SEED, STEPS, BEHAVIOUR), fresh)
        task._snapshot.restore()
        self.assertEqual(model_digest(task), untouched)
        self.assertFalse(hasattr(env, "never_seen_before"))

    def compare_with_package(self, env, record):
        observation, _ = env.reset()
        np.testing.assert_array_equal(observation.astype("f4"), record.observations[0])
        for step in range(record.steps):
            observation, reward, terminated, truncated, info = env.step(record.actions[step])
            np.testing.assert_array_equal(observation.astype("f4"), record.observations[step + 1])
            self.assertEqual(reward, record.rewards[step])
            self.assertEqual(info["success"] == 1.0, bool(record.flags[step] & 1))
            self.assertFalse(terminated or truncated)
        np.testing.assert_array_equal(env.unwrapped.data.qpos, record.qpos[-1])


if __name__ == "__main__":
    unittest.main()
