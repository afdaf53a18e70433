"""Puts a Meta-World environment back to how it was when it was built, so that no episode leaves a trace in the next.

Meta-World keeps state in three places: fields of the MuJoCo model (bodies and sites are moved to the goal), attributes of
the environment object (`_prev_obs`, `obj_init_pos`, ...), and the warm start of MuJoCo's solver. Its `reset` clears the
last and, at present, overwrites all that matters of the others, because it goes through `reset_model` twice. That is luck;
this is a promise, for 0.2 ms per episode.
"""

import copy

import mujoco
import numpy as np

# Geometry, textures and the like: large, and no task writes to them (the tests compare the whole model).
LARGEST_RESTORED = 100_000

# Left alone: the simulator's own handles, which are restored field by field.
HANDLES = ("model", "data", "mujoco_renderer", "action_space", "observation_space")


class Snapshot:
    """The state of an environment at the time of construction."""

    def __init__(self, env):
        self._env = env
        self._model = _arrays(env.model)
        self._attributes = {
            name: (value, _contents(value, env)) for name, value in vars(env).items() if name not in HANDLES
        }

    def restore(self):
        """Makes the environment bit for bit what it was when the snapshot was taken."""
        for live, kept in self._model:
            np.copyto(live, kept)
        attributes = vars(self._env)
        for name in [name for name in attributes if name not in self._attributes and name not in HANDLES]:
            del attributes[name]
        for name, (value, contents) in self._attributes.items():
            attributes[name] = value if contents is None else _refill(value, contents)
        mujoco.mj_resetData(self._env.model, self._env.data)
        mujoco.mj_forward(self._env.model, self._env.data)


def _arrays(model):
    """Every array of the model that a task could write to, each with a copy of its contents."""
    arrays = []
    for name in dir(model):
        value = None if name.startswith("_") else getattr(model, name)
        if isinstance(value, np.ndarray) and value.flags.writeable and 0 < value.nbytes <= LARGEST_RESTORED:
            arrays.append((value, value.copy()))
    return arrays


def _contents(value, env):
    """A copy of what a mutable value holds; None for immutable values and for views into the simulator's memory.

    Views matter: `init_left_pad`, for one, is no constant but a window on the pad's present position.
    """
    if isinstance(value, np.ndarray):
        return value.copy() if value.flags.owndata else None
    if isinstance(value, (dict, list)):
        return copy.deepcopy(value)
    return None


def _refill(value, contents):
    """Puts the contents back into the same object, because others may refer to it."""
    if isinstance(value, np.ndarray):
        np.copyto(value, contents)
        return value
    return copy.deepcopy(contents)
