"""The fast engine against the reference, bit for bit: all 50 tasks, from the same seed, with the same actions. Needs the simulator."""

import unittest
import warnings

import mujoco
import numpy as np
from metaworld.env_dict import ALL_V3_ENVIRONMENTS
from metaworld.utils import reward_utils
from scipy.spatial.transform import Rotation

import scalars
from collect import Behaviour, collect
from fast import FastTask
from task import Task

STEPS = 40
# Whole episodes, for what only comes with time: a drawer that stands open, an object that is pushed into place.
LONG = {"drawer-open-v3": 500, "sweep-into-v3": 500, "box-close-v3": 500, "pick-place-v3": 200}
BEHAVIOUR = Behaviour(noise_std=0.3, epsilon=0.3)
SEEDS = [7, 2**63 + 1]

# What a body's motion depends on. Of the geoms some are gone, and the equality's own data is set by the package.
MOVING_PARTS = ("body_", "dof_", "jnt_", "actuator_", "eq_", "qpos")
NUMBER_OF_GEOMS = ("body_geomadr", "body_geomnum", "body_bvhadr", "body_bvhnum")


class Engines(unittest.TestCase):
    def setUp(self):
        warnings.simplefilter("ignore")

    def assert_same(self, record, other):
        for ours, theirs in zip(record.parts(), other.parts(), strict=True):
            np.testing.assert_array_equal(ours, theirs)

    def test_every_task_has_the_bits_of_the_reference(self):
        self.assertEqual(len(ALL_V3_ENVIRONMENTS), 50)
        for name in ALL_V3_ENVIRONMENTS:
            fast, reference = FastTask(name), Task(name)
            for seed in SEEDS:
                with self.subTest(f"{name} {seed}"):
                    steps = LONG.get(name, STEPS)
                    self.assert_same(collect(fast, seed, steps, BEHAVIOUR), collect(reference, seed, steps, BEHAVIOUR))

    def test_only_what_touches_nothing_is_left_out_of_the_models(self):
        for name in ["drawer-open-v3", "box-close-v3", "stick-pull-v3", "plate-slide-back-v3"]:
            with self.subTest(name):
                fast, reference = FastTask(name).env.model, Task(name).env.model
                self.assertLess(fast.ngeom, reference.ngeom)
                for field in dir(reference):
                    if field.startswith(MOVING_PARTS) and field not in NUMBER_OF_GEOMS:
                        np.testing.assert_array_equal(getattr(fast, field), getattr(reference, field), field)
                touching = lambda model: int(((model.geom_contype > 0) | (model.geom_conaffinity > 0)).sum())  # noqa: E731
                self.assertEqual(touching(fast), touching(reference))

    def test_an_episode_leaves_no_trace_in_the_next(self):
        for name in ["drawer-open-v3", "hammer-v3", "window-close-v3"]:
            with self.subTest(name):
                task = FastTask(name)
                fresh = collect(task, 3, STEPS, BEHAVIOUR)
                collect(task, 4, STEPS, BEHAVIOUR)
                task.env.model.body_pos += 0.01
                task.env.obj_init_pos = None
                mujoco.mj_step(task.env.model, task.env.data, 50)
                self.assert_same(collect(task, 3, STEPS, BEHAVIOUR), fresh)
                self.assertEqual(task.reset_to(fresh.goal).astype("f4").tobytes(), fresh.observations[0].tobytes())

    def test_two_environments_of_one_task_do_not_share_what_moves(self):
        one, other = FastTask("door-open-v3"), FastTask("door-open-v3")
        first = one.reset(1)
        other.reset(2)
        action = np.array([0.5, -0.5, 0.5, 1.0], np.float32)
        for _ in range(5):
            other.step(action)
        alone = FastTask("door-open-v3")
        np.testing.assert_array_equal(alone.reset(1), first)
        for _ in range(5):
            np.testing.assert_array_equal(alone.step(action)[0], one.step(action)[0])


class Scalars(unittest.TestCase):
    def setUp(self):
        self.draws = np.random.default_rng(5)

    def test_a_norm_has_the_bits_of_numpy(self):
        for _ in range(2000):
            vector = self.draws.normal(size=self.draws.integers(1, 5)) * 10.0 ** self.draws.integers(-8, 3)
            for order in (None, 2):
                self.assertEqual(scalars.norm(vector, order), np.linalg.norm(vector, order))
        self.assertEqual(scalars.norm([3.0, 4.0]), 5.0)
        self.assertEqual(scalars.norm(np.ones((2, 2))), 2.0)

    def test_a_tolerance_has_the_bits_of_the_package(self):
        for _ in range(2000):
            x = np.float64(self.draws.normal())
            lower, width, margin = self.draws.normal(), self.draws.exponential(), self.draws.choice([0.0, 1e-12, 0.2, 3.0])
            for sigmoid in ["long_tail", "gaussian"]:
                arguments = dict(bounds=(lower, lower + width), margin=margin, sigmoid=sigmoid)
                self.assertEqual(scalars.tolerance(x, **arguments), reward_utils.tolerance(x, **arguments))
        for wrong in [dict(bounds=(1.0, 0.0)), dict(margin=-1.0)]:
            with self.assertRaises(ValueError):
                scalars.tolerance(0.5, sigmoid="long_tail", **wrong)

    def test_a_rotation_has_the_bits_of_scipy(self):
        matrix = np.empty(9)
        for quaternion in [*self.draws.normal(size=(2000, 4)), *np.eye(4), np.ones(4)]:
            mujoco.mju_quat2Mat(matrix, quaternion / np.linalg.norm(quaternion))
            turn = matrix.reshape(3, 3)
            np.testing.assert_array_equal(scalars.Rotation.from_matrix(turn).as_quat(), Rotation.from_matrix(turn).as_quat())


if __name__ == "__main__":
    unittest.main()
