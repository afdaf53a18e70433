"""Two intentions in one scene: what is hidden, what is shared, and whose reward it is. Needs the simulator's packages."""

import unittest
import warnings

import mujoco
import numpy as np
from metaworld.env_dict import ALL_V3_ENVIRONMENTS

from collect import Behaviour, collect
from fast import FastTask
from pairs import GOAL, SCENES, Pair
from task import Task

STEPS = 40
LONG = 300
SEED = 7
# What an environment says of itself, and what a second one around the same simulator must not disturb.
FIELDS = ["observations", "actions", "flags", "qpos", "qvel", "mocap_pos", "mocap_quat", "goal"]


def behaviours():
    return [Behaviour(0.8, epsilon, purpose=purpose) for purpose in (0, 1) for epsilon in (0.0, 0.8)]


def judged(scene, make=FastTask):
    """The scene before its first and before its second judge."""
    return [Pair(f"{scene}_{judge}", make) for judge in ("first", "second")]


class Scenes(unittest.TestCase):
    def setUp(self):
        warnings.simplefilter("ignore")

    def assert_same(self, record, other, fields):
        for field in fields:
            np.testing.assert_array_equal(getattr(record, field), getattr(other, field), field)

    def test_both_judges_see_the_same_episode_and_no_goal(self):
        for scene in SCENES:
            first, second = judged(scene)
            for behaviour in behaviours():
                with self.subTest(f"{scene} {behaviour}"):
                    one, other = (collect(task, SEED, STEPS, behaviour) for task in (first, second))
                    self.assert_same(one, other, [field for field in FIELDS if field != "flags"])
                    self.assertFalse(one.observations[:, GOAL].any())
                    self.assertTrue(one.observations[:, :4].all())

    def test_each_purpose_is_played_for_its_own_judge(self):
        for scene in SCENES:
            with self.subTest(scene):
                returns = np.zeros((2, 2))
                for judge, task in enumerate(judged(scene)):
                    for purpose in (0, 1):
                        clean = Behaviour(0.0, 0.0, purpose=purpose)
                        returns[judge, purpose] = collect(task, SEED, LONG, clean).rewards.sum()
                self.assertGreater(returns[0, 0], 1.5 * returns[0, 1])
                self.assertGreater(returns[1, 1], 1.5 * returns[1, 0])

    def test_a_judge_says_what_its_own_task_says_of_the_same_actions(self):
        """Its own environment, alone with its own simulator. All scenes but the plate's, which has a net, are the second task's too."""
        for scene, purposes in SCENES.items():
            for judge, (task, purpose) in enumerate(zip(judged(scene), purposes, strict=True)):
                if purpose.task == "plate-slide-v3":
                    continue
                with self.subTest(task.name):
                    record = collect(task, SEED, LONG, Behaviour(0.0, 0.0, purpose=judge))
                    alone = FastTask(purpose.task)
                    start = record.goal.copy()
                    start[start.size - len(purpose.goal) :] = purpose.goal
                    alone.reset_to(start)
                    for step in range(LONG):
                        _, reward, success, *_ = alone.step(record.actions[step])
                        self.assertEqual(success, bool(record.flags[step] & 1))
                        # `faucet-close-v3` begins with one pass of the solver more, and so with other last bits.
                        self.assertAlmostEqual(reward, record.rewards[step], delta=1e-6)
                    np.testing.assert_allclose(alone.env.data.qpos, record.qpos[-1], rtol=0, atol=1e-6)
                    self.assertTrue((record.flags & 1).any(), "it was solved, so that there was something to judge")

    def test_a_plate_s_judge_says_what_its_own_task_says_of_the_same_states(self):
        _, task = judged("plate-slide-side_plate-slide")
        record = collect(task, SEED, LONG, Behaviour(0.0, 0.0, purpose=1))
        alone = FastTask("plate-slide-v3")
        alone.reset_to(np.array([0.0, 0.6, 0.0, 0.0, 0.9, 0.0]))
        data, solved = alone.env.data, False
        for step in range(LONG):
            row = step + 1
            data.qpos[:], data.qvel[:] = record.qpos[row], record.qvel[row]
            mujoco.mj_forward(alone.env.model, data)
            reward, success = alone.judge(alone.look(), record.actions[step])
            self.assertAlmostEqual(reward, record.rewards[step], delta=1e-9)
            self.assertEqual(success, bool(record.flags[step] & 1))
            solved |= success
        self.assertTrue(solved)

    def test_both_engines_play_and_judge_with_the_same_bits_and_leave_no_trace(self):
        for scene in SCENES:
            for judge, behaviour in [("first", Behaviour(0.8, 0.3, purpose=1)), ("second", Behaviour(0.8, 0.3, purpose=0))]:
                with self.subTest(f"{scene} {judge}"):
                    fast, reference = (Pair(f"{scene}_{judge}", make) for make in (FastTask, Task))
                    fresh = collect(fast, SEED, STEPS, behaviour)
                    self.assert_same(fresh, collect(reference, SEED, STEPS, behaviour), [*FIELDS, "rewards"])
                    collect(fast, SEED + 1, STEPS, behaviour)
                    self.assert_same(fresh, collect(fast, SEED, STEPS, behaviour), [*FIELDS, "rewards"])

    def test_what_a_task_draws_at_the_start_is_drawn_as_ever_and_the_goals_are_ours(self):
        for scene, (purpose, _) in SCENES.items():
            with self.subTest(scene):
                task = judged(scene)[0]
                starts = np.array([task.reset(seed) is not None and task.goal.copy() for seed in range(8)])
                fixed = len(purpose.goal)
                space = task.env._random_reset_space
                free = slice(0, space.low.size - fixed)
                self.assertTrue((starts[:, free] >= space.low[free]).all() and (starts[:, free] <= space.high[free]).all())
                moves = space.high[free] > space.low[free]
                self.assertTrue((np.ptp(starts[:, free], axis=0) > 0)[moves].all())
                np.testing.assert_array_equal(starts[:, space.low.size - fixed :], np.tile(purpose.goal, (8, 1)))

    def test_no_place_that_is_drawn_is_one_that_the_task_refuses(self):
        """It would draw again, and get the same goal for ever."""
        for purposes in SCENES.values():
            for purpose in purposes:
                if purpose.task in ("push-v3", "reach-v3"):
                    space = FastTask(purpose.task).env._random_reset_space
                    nearest = np.clip(purpose.goal[:2], space.low[:2], space.high[:2])
                    self.assertGreater(np.linalg.norm(nearest - purpose.goal[:2]), 0.151)

    def test_a_scene_s_tasks_exist_and_their_names_are_no_task_s(self):
        for scene, purposes in SCENES.items():
            self.assertNotIn(f"{scene}_first", ALL_V3_ENVIRONMENTS)
            for purpose in purposes:
                self.assertIn(purpose.task, ALL_V3_ENVIRONMENTS)


if __name__ == "__main__":
    unittest.main()
