"""Hopper, HalfCheetah, Walker2d and Ant, as D4RL's files of version 2 were recorded: gymnasium's environments of version 4, which have the
dynamics, rewards and ends of the version 2 that D4RL used, on MuJoCo's own bindings.

The ant's contact forces are left out of the observation: mujoco-py, which recorded the files, never computed them.
"""

import warnings

import gymnasium
import mujoco
import numpy

ENVIRONMENTS = {"hopper": "Hopper-v4", "halfcheetah": "HalfCheetah-v4", "walker2d": "Walker2d-v4", "ant": "Ant-v4"}


class Locomotion:
    steps = 1000

    def __init__(self, task):
        self._id = ENVIRONMENTS[task]
        one = self.make()
        self.actions = one.action_space.shape[0]
        self.period_us = round(1e6 * one.dt)
        self.versions = {"gymnasium": gymnasium.__version__, "mujoco": mujoco.__version__, "numpy": numpy.__version__}

    def make(self):
        with warnings.catch_warnings():
            # Version 5 has other rewards and observations than the files.
            warnings.simplefilter("ignore", DeprecationWarning)
            # Without the wrappers: they check every step again.
            return gymnasium.make(self._id).unwrapped

    def reset(self, env, seed):
        return env.reset(seed=seed)[0]

    def step(self, env, action):
        observation, reward, terminated, _, _ = env.step(numpy.clip(action, -1, 1))
        return observation, reward, False, terminated
