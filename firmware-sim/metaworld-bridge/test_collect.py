"""What a behaviour does to a recorded episode: a push, a drift, and the same luck whatever is added. Needs the simulator's packages."""

import unittest
import warnings

import numpy as np

from collect import HAND, Behaviour, biases, collect, drift
from fast import FastTask
from task import ACTION

STEPS = 60
PUSH = (0.15, -0.1, 0.05, 0.0)
NOISY = Behaviour(noise_std=0.8, epsilon=0.0)
EPSILON = Behaviour(noise_std=0.8, epsilon=0.8)


class Unmoved:
    """A task that stays where it is, so that its actions are those that the behaviour makes of zero."""

    purposes = 1

    def __init__(self):
        model = type("Model", (), dict(nq=1, nv=1, nmocap=1))
        data = type("Data", (), dict(qpos=0.0, qvel=0.0, mocap_pos=0.0, mocap_quat=0.0))
        self.env = type("Env", (), dict(model=model, data=data))
        self.goal = np.zeros(1)

    def scripted_policy(self, purpose):
        return lambda observation: np.zeros(ACTION)

    def reset(self, seed):
        return np.zeros(39)

    def step(self, action):
        return np.zeros(39), 0.0, False, False, False


def actions(behaviour, episodes=40, steps=500):
    """The actions that the behaviour makes of zero: episodes, steps, dimensions."""
    task = Unmoved()
    return np.array([collect(task, seed, steps, behaviour).actions for seed in range(episodes)])


class Behaviours(unittest.TestCase):
    def setUp(self):
        warnings.simplefilter("ignore")

    def test_a_push_moves_the_mean_of_noisy_and_of_random_actions(self):
        for behaviour in [Behaviour(0.2, 0.0), Behaviour(0.2, 1.0)]:
            plain, pushed = actions(behaviour), actions(behaviour._replace(push=PUSH))
            np.testing.assert_allclose(plain.mean(axis=(0, 1)), 0.0, atol=0.015)
            # Clipping takes some of it from actions that are random: (1 - p/4) p of a push p.
            expected = np.array(PUSH) * (1.0 - np.abs(PUSH) / 4.0 if behaviour.epsilon else 1.0)
            np.testing.assert_allclose(pushed.mean(axis=(0, 1)), expected, atol=0.015)
            np.testing.assert_array_equal(pushed, np.clip(pushed, -1.0, 1.0))
            np.testing.assert_array_equal(pushed[..., HAND:], plain[..., HAND:])

    def test_a_drift_is_correlated_in_time_and_as_wide_at_the_start_as_later(self):
        drifts = np.array([drift(seed, 500, 0.4, 0.98) for seed in range(400)])
        for step in [0, 1, 250, 499]:
            np.testing.assert_allclose(drifts[:, step].std(axis=0), 0.4, rtol=0.12)
        for lag, expected in [(1, 0.98), (34, 0.98**34)]:
            correlation = (drifts[:, lag:] * drifts[:, :-lag]).mean() / (drifts**2).mean()
            self.assertAlmostEqual(correlation, expected, delta=0.04)
        np.testing.assert_allclose(np.corrcoef(drifts.reshape(-1, HAND).T) - np.eye(HAND), 0.0, atol=0.1)
        # Each episode has one of its own.
        self.assertAlmostEqual((drifts[1:] * drifts[:-1]).mean() / (drifts**2).mean(), 0.0, delta=0.05)

    def test_a_drift_is_in_the_actions_but_not_in_the_gripper_s(self):
        drifting = actions(Behaviour(0.0, 0.0, drift_std=0.1, drift_correlation=0.98), episodes=3)
        for seed in range(3):
            np.testing.assert_array_equal(drifting[seed, :, :HAND], drift(seed, 500, 0.1, 0.98).astype(np.float32))
        np.testing.assert_array_equal(drifting[..., HAND:], 0.0)

    def test_nothing_is_added_where_there_is_neither_push_nor_drift(self):
        self.assertIsNone(biases(7, STEPS, EPSILON))
        self.assertIsNone(biases(7, STEPS, EPSILON._replace(drift_correlation=0.98)))

    def test_a_worse_episode_is_a_function_of_its_seed_and_the_beginning_of_a_longer_one(self):
        task = FastTask("drawer-open-v3")
        for behaviour in [NOISY, EPSILON]:
            behaviour = behaviour._replace(push=PUSH, drift_std=0.4, drift_correlation=0.98)
            whole, again = [collect(task, 7, STEPS, behaviour) for _ in range(2)]
            beginning = collect(task, 7, STEPS // 2, behaviour)
            self.assertEqual(whole.actions.tobytes(), again.actions.tobytes())
            self.assertEqual(whole.observations.tobytes(), again.observations.tobytes())
            self.assertEqual(whole.actions[: STEPS // 2].tobytes(), beginning.actions.tobytes())
            self.assertNotEqual(whole.actions.tobytes(), collect(task, 7, STEPS, NOISY).actions.tobytes())

    def test_the_random_actions_are_the_same_whatever_is_added(self):
        random = Behaviour(0.8, 1.0)
        plain, pushed = actions(random, episodes=1), actions(random._replace(push=PUSH), episodes=1)
        np.testing.assert_array_equal(pushed, np.clip(plain + np.array(PUSH), -1.0, 1.0).astype(np.float32))


if __name__ == "__main__":
    unittest.main()
