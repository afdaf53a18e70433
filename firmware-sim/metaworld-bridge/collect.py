"""Records one episode of the scripted policy, made worse on purpose.

Each step: the scripted policy's action, plus N(0, noise_std^2) in every dimension; with probability epsilon a uniformly
random action instead; then, whichever it is, a constant push and a drift of the hand; clipped to [-1, 1] and cast to float32.
That float32 action is executed and recorded.

Randomness: four PCG64 streams whose seed sequences are the episode's seed with the spawn keys below, each drawn step by
step (four normals; one uniform in [0, 1); four uniforms in [-1, 1); three normals). The goal has the seed's own stream, without
a spawn key. So a shorter episode is the beginning of a longer one, and the same seed has the same luck under every behaviour.
"""

from typing import NamedTuple

import numpy as np

from messages import SUCCESS, TERMINATED, TRUNCATED
from task import ACTION, OBSERVATION

NOISE_KEY = 1
CHOICE_KEY = 2
UNIFORM_KEY = 3
DRIFT_KEY = 4

# What drifts: the hand's three directions. A drifting gripper would let go for a hundred steps, and the log would be of failures.
HAND = 3


class Behaviour(NamedTuple):
    """How the scripted policy is made worse, in the order of the wire."""

    noise_std: float
    epsilon: float
    push: tuple = (0.0, 0.0, 0.0, 0.0)
    drift_std: float = 0.0
    drift_correlation: float = 0.0
    purpose: int = 0


class Record:
    """The rows of one episode, in the types they have on the wire."""

    def __init__(self, task, steps):
        model = task.env.model
        rows = steps + 1
        self.steps = 0
        self.observations = np.empty((rows, OBSERVATION), "<f4")
        self.actions = np.empty((steps, ACTION), "<f4")
        self.rewards = np.empty(steps, "<f8")
        self.flags = np.zeros(steps, np.uint8)
        self.qpos = np.empty((rows, model.nq), "<f8")
        self.qvel = np.empty((rows, model.nv), "<f8")
        self.mocap_pos = np.empty((rows, model.nmocap, 3), "<f8")
        self.mocap_quat = np.empty((rows, model.nmocap, 4), "<f8")
        self.goal = task.goal.astype("<f8")

    def keep_state(self, row, observation, data):
        """Fills the row that has an entry before the first action and after every action."""
        self.observations[row] = observation
        self.qpos[row] = data.qpos
        self.qvel[row] = data.qvel
        self.mocap_pos[row] = data.mocap_pos
        self.mocap_quat[row] = data.mocap_quat

    def parts(self):
        """The arrays in the order of the wire, cut to the steps that were made."""
        rows = self.steps + 1
        return [
            self.observations[:rows],
            self.actions[: self.steps],
            self.rewards[: self.steps],
            self.flags[: self.steps],
            self.qpos[:rows],
            self.qvel[:rows],
            self.mocap_pos[:rows],
            self.mocap_quat[:rows],
            self.goal,
        ]


def collect(task, seed, steps, behaviour):
    """Plays the episode of this seed for `steps` steps and returns its Record."""
    noise = stream(seed, NOISE_KEY).standard_normal((steps, ACTION)) * behaviour.noise_std
    choices = stream(seed, CHOICE_KEY).random(steps) < behaviour.epsilon
    uniform = stream(seed, UNIFORM_KEY).uniform(-1.0, 1.0, (steps, ACTION)).astype(np.float32)
    bias = biases(seed, steps, behaviour)

    scripted = task.scripted_policy(behaviour.purpose)
    data = task.env.data
    observation = task.reset(seed)
    record = Record(task, steps)
    record.keep_state(0, observation, data)
    for step in range(steps):
        action = uniform[step] if choices[step] else scripted(observation) + noise[step]
        if bias is not None:
            action = action + bias[step]
        action = np.clip(action, -1.0, 1.0).astype(np.float32)
        observation, reward, success, terminated, truncated = task.step(action)
        record.actions[step] = action
        record.rewards[step] = reward
        record.keep_state(step + 1, observation, data)
        record.steps = step + 1
        truncated = truncated or record.steps == steps
        record.flags[step] = SUCCESS * success | TERMINATED * terminated | TRUNCATED * truncated
        if terminated:
            break
    return record


def biases(seed, steps, behaviour):
    """What is added to the action of each step beside noise: the push, and the drift so far. None where there is neither."""
    if behaviour.drift_std == 0.0 and not any(behaviour.push):
        return None
    bias = np.tile(np.array(behaviour.push), (steps, 1))
    if behaviour.drift_std > 0.0:
        bias[:, :HAND] += drift(seed, steps, behaviour.drift_std, behaviour.drift_correlation)
    return bias


def drift(seed, steps, std, correlation):
    """A first-order autoregression in each direction of the hand, which starts in its stationary distribution."""
    draws = stream(seed, DRIFT_KEY).standard_normal((steps, HAND)) * std
    draws[1:] *= np.sqrt(1.0 - correlation**2)
    for step in range(1, steps):
        draws[step] += correlation * draws[step - 1]
    return draws


def stream(seed, key):
    """One of the episode's independent random streams."""
    return np.random.Generator(np.random.PCG64(np.random.SeedSequence(seed, spawn_key=(key,))))
