"""Plain arithmetic in the place of helpers that Meta-World's tasks call with one vector or number at a time, with the same bits.

`numpy`, `scipy` and `metaworld.utils.reward_utils` answer for arrays of any shape, and most of their time goes into finding out
that there is nothing but a scalar. Whatever these functions do not cover goes on to the original.
"""

import math
from types import SimpleNamespace

import numpy as np
from metaworld.utils import reward_utils

FLOAT64 = np.dtype(np.float64)
LONG_TAIL_AT_MARGIN = 0.1
LONG_TAIL_SCALE = float(np.sqrt(1 / LONG_TAIL_AT_MARGIN - 1))
# Below this a quotient could leave the range in which Python's power and numpy's do the same.
SMALLEST_MARGIN = 1e-9


def norm(x, ord=None, axis=None, keepdims=False):
    """`numpy.linalg.norm` of one vector."""
    if isinstance(x, np.ndarray) and x.ndim == 1 and x.dtype == FLOAT64 and ord in (None, 2) and axis is None and not keepdims:
        return np.float64(math.sqrt(x.dot(x)))
    return np.linalg.norm(x, ord, axis, keepdims)


def tolerance(x, bounds=(0.0, 0.0), margin=0.0, sigmoid="gaussian", value_at_margin=LONG_TAIL_AT_MARGIN):
    """`reward_utils.tolerance` of one number with the sigmoid that nearly all rewards take."""
    lower, upper = bounds
    usual = sigmoid == "long_tail" and value_at_margin == LONG_TAIL_AT_MARGIN and margin > SMALLEST_MARGIN
    if not (usual and isinstance(x, float) and lower <= upper):
        return reward_utils.tolerance(x, bounds, margin, sigmoid, value_at_margin)
    if lower <= x <= upper:
        return 1.0
    beyond = float((lower - x if x < lower else x - upper) / margin)
    return 1 / ((beyond * LONG_TAIL_SCALE) ** 2 + 1)


class Rotation:
    """`scipy.spatial.transform.Rotation`, from one matrix to one quaternion (x, y, z, w)."""

    def __init__(self, quaternion):
        self._quaternion = quaternion

    @classmethod
    def from_matrix(cls, matrix):
        (a, b, c), (d, e, f), (g, h, i) = matrix.tolist()
        trace = a + e + i
        largest = max(a, e, i, trace)
        if a == largest:
            x, y, z, w = 1 - trace + 2 * a, d + b, g + c, h - f
        elif e == largest:
            x, y, z, w = b + d, 1 - trace + 2 * e, h + f, c - g
        elif i == largest:
            x, y, z, w = c + g, f + h, 1 - trace + 2 * i, d - b
        else:
            x, y, z, w = h - f, c - g, d - b, 1 + trace
        length = math.sqrt(x * x + y * y + z * z + w * w)
        return cls(np.array([x / length, y / length, z / length, w / length]))

    def as_quat(self):
        return self._quaternion


def _with(original, **replaced):
    """A module with some of its names replaced."""
    return SimpleNamespace(**{**vars(original), **replaced})


# The names that a task's module knows these helpers by.
REPLACEMENTS = {
    "np": _with(np, linalg=_with(np.linalg, norm=norm)),
    "reward_utils": _with(reward_utils, tolerance=tolerance),
    "tolerance": tolerance,
    "Rotation": Rotation,
}
