"""Answers the parent's requests, one at a time and in order."""

import platform
import struct
import traceback
import warnings

import gymnasium
import metaworld
import mujoco
import numpy as np
import scipy
from metaworld.env_dict import ALL_V3_ENVIRONMENTS

import messages
from collect import collect
from importlib import metadata
from task import ACTION, OBSERVATION, Task

# The scripted policies warn at nearly every step that their gains are high; Meta-World clips the action and so do we.
warnings.filterwarnings("ignore", message="Constant.s. may be too high")


class Refusal(Exception):
    """A request that cannot be served, with the code that says why."""

    def __init__(self, code, message):
        super().__init__(message)
        self.code = code


def versions():
    """What the results depend on, for provenance."""
    parts = {
        "python": platform.python_version(),
        "metaworld": metadata.version("metaworld"),
        "mujoco": mujoco.__version__,
        "gymnasium": gymnasium.__version__,
        "numpy": np.__version__,
        "scipy": scipy.__version__,
        "machine": platform.machine(),
    }
    return " ".join(f"{name}={version}" for name, version in parts.items())


def read_action(payload):
    """The values of an action on the wire."""
    return np.frombuffer(payload, "<f4").reshape(ACTION)


class Session:
    """The open task and the buffers that a step reuses."""

    def __init__(self, link):
        self._link = link
        self._task = None
        self._in_episode = False
        self._action = np.empty(ACTION, np.float32)
        self._observation = np.empty(OBSERVATION, "<f4")
        self._outcome = bytearray(messages.REWARD_AND_FLAGS.size)
        self._serve = {
            messages.OPEN: self._open,
            messages.RESET: self._reset,
            messages.STEP: self._step,
            messages.COLLECT: self._collect,
        }

    def serve(self):
        """Serves until the parent closes the link."""
        while True:
            kind, sequence, payload = self._link.receive()
            try:
                if kind not in self._serve:
                    raise Refusal(messages.BAD_REQUEST, f"request of unknown kind {kind:#04x}")
                reply, parts = self._serve[kind](payload)
            except Refusal as refusal:
                self._link.send(messages.FAULT, sequence, messages.fault(refusal.code, str(refusal)))
            except Exception:
                self._in_episode = False
                self._link.send(
                    messages.FAULT, sequence, messages.fault(messages.SIMULATOR, traceback.format_exc().strip())
                )
            else:
                self._link.send(reply, sequence, *parts)

    def _open(self, payload):
        name = self._parsed(messages.read_text, payload)
        if name not in ALL_V3_ENVIRONMENTS:
            raise Refusal(messages.UNKNOWN_TASK, f"metaworld {metadata.version('metaworld')} has no task {name!r}")
        self._in_episode = False
        if self._task is None or self._task.name != name:
            self._task = None
            self._task = Task(name)
        model = self._task.env.model
        shape = (OBSERVATION, ACTION, model.nq, model.nv, model.nmocap, self._task.goal.size, self._task.horizon)
        return messages.OPENED, [messages.SHAPE.pack(*shape)]

    def _reset(self, payload):
        (seed,) = self._parsed(messages.RESET_REQUEST.unpack, payload)
        self._observation[:] = self._opened().reset(seed)
        self._in_episode = True
        return messages.RESETTED, [self._observation, self._task.goal.astype("<f8")]

    def _step(self, payload):
        if not self._in_episode:
            raise Refusal(messages.NO_EPISODE, "a step outside an episode: reset first")
        self._action[:] = self._parsed(read_action, payload)
        observation, reward, success, terminated, truncated = self._task.step(self._action)
        self._in_episode = not (terminated or truncated)
        self._observation[:] = observation
        flags = messages.SUCCESS * success | messages.TERMINATED * terminated | messages.TRUNCATED * truncated
        messages.REWARD_AND_FLAGS.pack_into(self._outcome, 0, reward, flags)
        return messages.STEPPED, [self._observation, self._outcome]

    def _collect(self, payload):
        seed, steps, noise_std, epsilon = self._parsed(messages.COLLECT_REQUEST.unpack, payload)
        task = self._opened()
        self._in_episode = False
        if not 1 <= steps <= task.horizon:
            raise Refusal(messages.BAD_REQUEST, f"{steps} steps in a task of 1 to {task.horizon}")
        record = collect(task, seed, steps, noise_std, epsilon)
        return messages.COLLECTED, [messages.EPISODE_STEPS.pack(record.steps), *record.parts()]

    def _parsed(self, parse, payload):
        """What is in a payload, apart from the serving: an error of the simulator's is no bad request."""
        try:
            return parse(payload)
        except (struct.error, ValueError) as error:
            self._in_episode = False
            raise Refusal(messages.BAD_REQUEST, str(error)) from error

    def _opened(self):
        if self._task is None:
            raise Refusal(messages.NO_EPISODE, "no task is open: open one first")
        return self._task
