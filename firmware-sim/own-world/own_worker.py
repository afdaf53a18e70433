"""The worker of a world of one's own: a Python file with three functions, or an environment of Gymnasium, driven over stdin and stdout.

    own_worker.py my_world.py | gym:ENVIRONMENT

It runs in the person's own interpreter and needs nothing but the standard library. docs/own-world.md says what a file looks like,
docs/bridge-protocol.md what goes over the wire. Standard output belongs to the protocol, so whatever the world prints goes to
standard error.
"""

import math
import os
import pathlib
import platform
import signal
import struct
import sys
import traceback

REQUESTS = os.dup(0)
REPLIES = os.dup(1)
os.dup2(2, 1)
signal.signal(signal.SIGINT, signal.SIG_IGN)
# The files of the protocol lie beside this one.
sys.path.insert(0, str(pathlib.Path(__file__).parent))

import messages  # noqa: E402
import wire  # noqa: E402
from parent import leave_with_parent  # noqa: E402

GYM = "gym:"
FUNCTIONS = ("make", "reset", "step")


class Unusable(Exception):
    """The world is not one, or did what a world does not do."""


class OwnFile:
    """A Python file with `make()`, `reset(world, seed)` and `step(world, action)`; `steps`, the length of an episode; and `actions`, how many
    numbers an action has."""

    def __init__(self, path):
        path = pathlib.Path(path)
        sys.path.insert(0, str(path.resolve().parent))
        names = {"__name__": path.stem, "__file__": str(path)}
        exec(compile(path.read_bytes(), str(path), "exec"), names)
        missing = [name for name in FUNCTIONS if not callable(names.get(name))]
        if missing:
            raise Unusable(f"{path.name} has no function {' or '.join(missing)}: a world has make(), reset(world, seed) and step(world, action)")
        for name, means in (("steps", "how many steps an episode has"), ("actions", "how many numbers an action has")):
            if not (isinstance(names.get(name), int) and names[name] > 0):
                raise Unusable(f"{path.name} must say `{name} = 2` or the like: {means}")
        self.steps, self.actions = names["steps"], names["actions"]
        self.period_us = names.get("period_us")
        self.make, self._reset, self._step = (names[name] for name in FUNCTIONS)
        self.versions = {}

    def reset(self, world, seed):
        return self._reset(world, seed)

    def step(self, world, action):
        """Observation, reward, success, and whether the task ended; success and end may be left out."""
        outcome = tuple(self._step(world, action))
        if not 2 <= len(outcome) <= 4:
            raise Unusable(f"step() gave {len(outcome)} things: it gives observation, reward, success, terminated; the last two may be left out")
        observation, reward, success, terminated = outcome + (False,) * (4 - len(outcome))
        return observation, reward, success, terminated


class Gymnasium:
    """An environment of Gymnasium, by its id."""

    def __init__(self, name):
        try:
            import gymnasium
        except ImportError as error:
            raise Unusable(f"{sys.executable} has no gymnasium ({error}): install it there, or name another interpreter with TED_PYTHON") from error
        self._name = name
        self.make = lambda: gymnasium.make(self._name)
        one = self.make()
        self.steps = one.spec.max_episode_steps or 1000
        if len(getattr(one.action_space, "shape", ())) != 1:
            raise Unusable(f"the actions of {name} are {one.action_space}: a controller sends a list of numbers")
        self.actions = one.action_space.shape[0]
        seconds = getattr(one.unwrapped, "dt", None)
        self.period_us = round(1e6 * seconds) if seconds else None
        self._dtype = one.action_space.dtype
        self.versions = {"gymnasium": gymnasium.__version__}

    def reset(self, world, seed):
        # Gymnasium's seeds have 32 bits on some environments.
        return world.reset(seed=seed % 2**31)[0]

    def step(self, world, action):
        import numpy

        observation, reward, terminated, _, info = world.step(numpy.asarray(action, self._dtype))
        return observation, reward, bool(info.get("is_success", info.get("success", False))), terminated


def numbers(values, what, width=None):
    """A flat list of finite numbers."""
    try:
        flat = [float(value) for value in getattr(values, "ravel", lambda: values)()]
    except (TypeError, ValueError) as error:
        raise Unusable(f"{what} is {type(values).__name__}, not a list of numbers ({error})") from error
    if width is not None and len(flat) != width:
        raise Unusable(f"{what} has {len(flat)} numbers, and had {width} before")
    if not all(map(math.isfinite, flat)):
        raise Unusable(f"{what} is not finite: {flat}")
    return flat


class Session:
    """The world, once for each slot that an episode was started in."""

    def __init__(self, link, world):
        self._link = link
        self._world = world
        self._move = struct.Struct(f"<H{world.actions}f")
        self._slots = {}
        self._running = {}
        self._observations = len(numbers(world.reset(self._made(0), 0), "the first observation"))
        self._serve = {messages.OPEN: self._open, messages.RESET: self._reset, messages.STEP: self._step}

    def serve(self):
        """Serves until the parent closes the link."""
        while True:
            kind, sequence, payload = self._link.receive()
            try:
                if kind not in self._serve:
                    raise Unusable(f"a world of one's own is flown in, and cannot answer request {kind:#04x}")
                reply, parts = self._serve[kind](payload)
            except Unusable as error:
                self._refuse(sequence, messages.BAD_REQUEST, str(error))
            except Exception:
                self._refuse(sequence, messages.SIMULATOR, traceback.format_exc().strip())
            else:
                self._link.send(reply, sequence, *parts)

    def _refuse(self, sequence, code, reason):
        self._running.clear()
        self._link.send(messages.FAULT, sequence, messages.fault(code, reason))

    def _made(self, slot):
        if slot not in self._slots:
            self._slots[slot] = self._world.make()
        return self._slots[slot]

    def _open(self, payload):
        # Whatever the task is called: there is one.
        messages.read_text(payload)
        self._running.clear()
        return messages.OPENED, [messages.SHAPE.pack(self._observations, self._world.actions, 0, 0, 0, 0, self._world.steps)]

    def _reset(self, payload):
        slot, seed = messages.RESET_REQUEST.unpack(payload)
        observation = numbers(self._world.reset(self._made(slot), seed), "the observation of reset()", self._observations)
        self._running[slot] = 0
        return messages.RESETTED, [struct.pack(f"<{self._observations}f", *observation)]

    def _step(self, payload):
        replies = []
        moves = list(self._move.iter_unpack(payload))
        for slot, *_ in moves:
            if slot not in self._running:
                raise Unusable(f"a step outside an episode in slot {slot}: reset first")
        for slot, *action in moves:
            observation, reward, success, terminated = self._world.step(self._made(slot), action)
            observation = numbers(observation, "the observation of step()", self._observations)
            (reward,) = numbers([reward], "the reward of step()")
            self._running[slot] += 1
            truncated = self._running[slot] >= self._world.steps
            flags = messages.SUCCESS * bool(success) | messages.TERMINATED * bool(terminated) | messages.TRUNCATED * truncated
            if terminated or truncated:
                del self._running[slot]
            replies.append(struct.pack(f"<{self._observations}fdB", *observation, reward, flags))
        return messages.STEPPED, replies


def world(name):
    return Gymnasium(name[len(GYM) :]) if name.startswith(GYM) else OwnFile(name)


def play(make_world, engine):
    """Serves the world that `make_world` gives, until the parent closes the link."""
    link = wire.Link(REQUESTS, REPLIES)
    link.send_hello()
    leave_with_parent(REQUESTS)
    spoken = link.receive_hello()
    if spoken != wire.PROTOCOL_VERSION:
        sys.exit(f"the parent speaks protocol {spoken}, this worker {wire.PROTOCOL_VERSION}")
    try:
        world = make_world()
        session = Session(link, world)
    except Exception as error:
        reason = str(error) if isinstance(error, Unusable) else traceback.format_exc().strip()
        link.send(messages.FAULT, 0, messages.fault(messages.CANNOT_START, reason))
        raise
    versions = {"python": platform.python_version(), "engine": engine, **world.versions}
    if world.period_us is not None:
        versions["period_us"] = world.period_us
    link.send(messages.READY, 0, messages.text(" ".join(f"{name}={value}" for name, value in versions.items())))
    session.serve()


if __name__ == "__main__":
    try:
        play(lambda: world(*sys.argv[1:]), "own")
    except wire.Closed:
        pass
