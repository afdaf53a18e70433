"""One Meta-World task whose episodes are a function of their seed.

The dynamics, rewards and observations are those of `gym.make("Meta-World/MT1", env_name=...)`: goal visible, version 2
rewards, 500 steps, no early stop. Gymnasium's wrappers are left out, because they only check and count, and three helper
methods are replaced by faster ones; a test compares tasks with the untouched package bit for bit. The goal is drawn from the seed, not from a list of 50.
"""

import pickle

import mujoco
import numpy as np
from metaworld.env_dict import ALL_V3_ENVIRONMENTS
from metaworld.policies import ENV_POLICY_MAP
from metaworld.types import Task as MetaWorldTask

from quick import quicken
from snapshot import Snapshot

OBSERVATION = 39
ACTION = 4


class Task:
    """A task, ready for any number of episodes."""

    # How many scripted policies there are to play it.
    purposes = 1

    def __init__(self, name, simulator=None):
        """`simulator`, a model and its data in their first state, is another task's whose states this one is to look at."""
        environment = ALL_V3_ENVIRONMENTS[name]
        self.name = name
        self.env = self._build(environment, simulator)
        goal_visible = dict(rand_vec=None, env_cls=environment, partially_observable=False)
        self.env.set_task(MetaWorldTask(env_name=name, data=pickle.dumps(goal_visible)))
        self.env.seeded_rand_vec = True
        self.horizon = self.env.max_path_length
        self.goal = np.zeros(self.env._random_reset_space.low.size)
        self._policy = ENV_POLICY_MAP[name]
        self._prepare()

    def _build(self, environment, simulator):
        """The task's environment, as the package makes it."""
        if simulator is not None:
            environment = type(environment.__name__, (environment,), {"_initialize_simulation": lambda env: simulator})
        return environment(reward_function_version="v2")

    def _prepare(self):
        """What comes before the first episode."""
        quicken(self.env)
        self._snapshot = Snapshot(self.env)

    def _restore(self):
        """Forgets all episodes."""
        self._snapshot.restore()

    def scripted_policy(self, purpose=0):
        """The package's own policy for this task, new: from an observation to an action."""
        assert purpose < self.purposes, purpose
        return self._policy().get_action

    def reset(self, seed):
        """Starts the episode of this seed and returns its first observation, in float64."""
        self._restore()
        self.env.seed(seed)
        self.env._freeze_rand_vec = False
        return self._start()

    def draw(self, seed):
        """What the episode of this seed draws first; a task may refuse it and draw again."""
        self.env.seed(seed)
        self.env._freeze_rand_vec = False
        return self.env._get_state_rand_vec()

    def reset_to(self, goal):
        """Starts an episode with a goal that an earlier episode drew."""
        self._restore()
        self.env._last_rand_vec = np.array(goal)
        return self._start()

    def _start(self):
        """What `SawyerXYZEnv.reset` does, with one goal: the first `reset_model` draws it, the second uses it again."""
        env = self.env
        env.curr_path_length = 0
        env.reset_model()
        env._freeze_rand_vec = True
        mujoco.mj_resetData(env.model, env.data)
        observation = env.reset_model()
        env._prev_obs = observation[:18].copy()
        observation[18:36] = env._prev_obs
        self.goal[:] = env._last_rand_vec
        return observation.astype(np.float64)

    def step(self, action):
        """One control period: (observation in float64, reward, success, terminated, truncated)."""
        observation, reward, terminated, truncated, info = self.env.step(action)
        return observation, reward, info["success"] == 1.0, terminated, truncated

    def marks(self):
        """Sites that show the goal, by name, and where they belong."""
        return self.env._target_site_config

    def look(self):
        """The observation of the simulator's present state, whoever brought it there."""
        env = self.env
        return np.clip(env._get_obs(), env.sawyer_observation_space.low, env.sawyer_observation_space.high)

    def judge(self, observation, action):
        """Reward and success of the simulator's present state, seen like this, after this action."""
        reward, info = self.env.evaluate_state(observation, action)
        return reward, info["success"] == 1.0
