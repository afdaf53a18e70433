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
import pairs
from collect import Behaviour, collect
from importlib import metadata
from fast import FastTask
from task import ACTION, OBSERVATION, Task

# The scripted policies warn at nearly every step that their gains are high; Meta-World clips the action and so do we.
warnings.filterwarnings("ignore", message="Constant.s. may be too high")


# How a task is simulated. The episodes are the same, to the bit.
ENGINES = {"fast": FastTask, "reference": Task}

# Pixels of a picture in either direction.
LARGEST = 1920

# Rows of a STEP and of what answers it.
MOVE = np.dtype([("slot", "<u2"), ("action", "<f4", ACTION)])
OUTCOME = np.dtype([("observation", "<f4", OBSERVATION), ("reward", "<f8"), ("flags", "u1")])


class Refusal(Exception):
    """A request that cannot be served, with the code that says why."""

    def __init__(self, code, message):
        super().__init__(message)
        self.code = code


def versions(engine):
    """What the results depend on, for provenance."""
    parts = {
        "python": platform.python_version(),
        "engine": engine,
        "metaworld": metadata.version("metaworld"),
        "mujoco": mujoco.__version__,
        "gymnasium": gymnasium.__version__,
        "numpy": np.__version__,
        "scipy": scipy.__version__,
        "machine": platform.machine(),
    }
    return " ".join(f"{name}={version}" for name, version in parts.items())


def read_moves(payload):
    """The actions on the wire, each with the slot of its episode."""
    moves = np.frombuffer(payload, MOVE)
    slots = moves["slot"].tolist()
    if not slots or len(set(slots)) < len(slots):
        raise ValueError(f"a step of the slots {slots}")
    return slots, moves["action"]


def read_collect(payload):
    """The seed, the steps and the behaviour of an episode to record."""
    seed, steps, noise_std, epsilon, *push, drift_std, drift_correlation, purpose = messages.COLLECT_REQUEST.unpack(payload)
    if not (drift_std >= 0.0 and abs(drift_correlation) <= 1.0):
        raise ValueError(f"a drift of {drift_std} with correlation {drift_correlation}")
    return seed, steps, Behaviour(noise_std, epsilon, tuple(push), drift_std, drift_correlation, purpose)


def read_reset(payload):
    """The slot and the seed of an episode to start."""
    slot, seed = messages.RESET_REQUEST.unpack(payload)
    if slot >= messages.SLOTS:
        raise ValueError(f"slot {slot} of {messages.SLOTS}")
    return slot, seed


def read_render(payload, model):
    """The seed, width, height and quality of pictures, and the states to draw: a row of each array for each."""
    seed, width, height, quality, frames = messages.RENDER_REQUEST.unpack_from(payload)
    if not (1 <= width <= LARGEST and 1 <= height <= LARGEST and 1 <= quality <= 100):
        raise ValueError(f"a picture of {width} x {height} pixels and quality {quality}")
    values = np.frombuffer(payload, "<f8", offset=messages.RENDER_REQUEST.size)
    widths = [model.nq, 3 * model.nmocap, 4 * model.nmocap]
    if values.size != frames * sum(widths):
        raise ValueError(f"{values.size} numbers for {frames} states of {sum(widths)}")
    qpos, mocap_pos, mocap_quat = np.split(values, np.cumsum([frames * width for width in widths[:2]]))
    bodies = (frames, model.nmocap)
    states = qpos.reshape(frames, model.nq), mocap_pos.reshape(*bodies, 3), mocap_quat.reshape(*bodies, 4)
    return (seed, width, height, quality), states


class Session:
    """The open task, once for each slot that an episode was started in."""

    def __init__(self, link, engine):
        self._link = link
        self._engine = ENGINES[engine]
        self._tasks = {}
        self._running = set()
        self._painter = None
        self._serve = {
            messages.OPEN: self._open,
            messages.RESET: self._reset,
            messages.STEP: self._step,
            messages.COLLECT: self._collect,
            messages.RENDER: self._render,
            messages.STATE: self._state,
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
                self._running.clear()
                self._link.send(
                    messages.FAULT, sequence, messages.fault(messages.SIMULATOR, traceback.format_exc().strip())
                )
            else:
                self._link.send(reply, sequence, *parts)

    def _open(self, payload):
        name = self._parsed(messages.read_text, payload)
        if name not in ALL_V3_ENVIRONMENTS and name not in pairs.NAMES:
            raise Refusal(messages.UNKNOWN_TASK, f"metaworld {metadata.version('metaworld')} has no task {name!r}")
        self._running.clear()
        if not self._tasks or self._tasks[0].name != name:
            self._tasks.clear()
            self._tasks[0] = self._made(name)
        task = self._tasks[0]
        model = task.env.model
        shape = (OBSERVATION, ACTION, model.nq, model.nv, model.nmocap, task.goal.size, task.horizon)
        return messages.OPENED, [messages.SHAPE.pack(*shape)]

    def _reset(self, payload):
        slot, seed = self._parsed(read_reset, payload)
        name = self._opened().name
        if slot not in self._tasks:
            self._tasks[slot] = self._made(name)
        task = self._tasks[slot]
        self._running.discard(slot)
        observation = task.reset(seed)
        self._running.add(slot)
        return messages.RESETTED, [observation.astype("<f4"), task.goal.astype("<f8")]

    def _step(self, payload):
        slots, actions = self._parsed(read_moves, payload)
        for slot in slots:
            if slot not in self._running:
                raise Refusal(messages.NO_EPISODE, f"a step outside an episode in slot {slot}: reset first")
        outcomes = np.empty(len(slots), OUTCOME)
        observations, rewards, flags = (outcomes[field] for field in OUTCOME.names)
        for row, slot in enumerate(slots):
            observations[row], rewards[row], success, terminated, truncated = self._tasks[slot].step(actions[row])
            flags[row] = messages.SUCCESS * success | messages.TERMINATED * terminated | messages.TRUNCATED * truncated
            if terminated or truncated:
                self._running.discard(slot)
        return messages.STEPPED, [outcomes.tobytes()]

    def _collect(self, payload):
        seed, steps, behaviour = self._parsed(read_collect, payload)
        task = self._opened()
        self._running.clear()
        if not 1 <= steps <= task.horizon:
            raise Refusal(messages.BAD_REQUEST, f"{steps} steps in a task of 1 to {task.horizon}")
        if behaviour.purpose >= task.purposes:
            raise Refusal(messages.BAD_REQUEST, f"purpose {behaviour.purpose} of a task with {task.purposes}")
        record = collect(task, seed, steps, behaviour)
        return messages.COLLECTED, [messages.EPISODE_STEPS.pack(record.steps), *record.parts()]

    def _render(self, payload):
        task = self._opened()
        how, states = self._parsed(lambda payload: read_render(payload, task.env.model), payload)
        # Whoever only plays does without: it loads what draws.
        import render

        try:
            way = render.open_way()
            if self._painter is None or self._painter.name != task.name:
                self._painter = None
                self._painter = render.Painter(self._made(task.name, Task))
        except render.NoPictures as error:
            raise Refusal(messages.NO_PICTURES, str(error)) from error
        pictures = self._painter.pictures(*how, *states)
        parts = [part for picture in pictures for part in (messages.PICTURE_BYTES.pack(len(picture)), picture)]
        return messages.RENDERED, [messages.text(way), *parts]

    def _state(self, payload):
        (slot,) = self._parsed(messages.STATE_REQUEST.unpack, payload)
        if slot not in self._running:
            raise Refusal(messages.NO_EPISODE, f"the state of slot {slot}, which has no episode: reset first")
        data = self._tasks[slot].env.data
        return messages.STATED, [array.astype("<f8").tobytes() for array in (data.qpos, data.mocap_pos, data.mocap_quat)]

    def _made(self, name, engine=None):
        engine = engine or self._engine
        return pairs.Pair(name, engine) if name in pairs.NAMES else engine(name)

    def _parsed(self, parse, payload):
        """What is in a payload, apart from the serving: an error of the simulator's is no bad request."""
        try:
            return parse(payload)
        except (struct.error, ValueError) as error:
            self._running.clear()
            raise Refusal(messages.BAD_REQUEST, str(error)) from error

    def _opened(self):
        if not self._tasks:
            raise Refusal(messages.NO_EPISODE, "no task is open: open one first")
        return self._tasks[0]
