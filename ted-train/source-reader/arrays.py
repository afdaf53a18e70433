"""Arrays of any numeric type, brought to rows of numbers and to flags without changing a value."""

import numpy as np

from faults import Fault

# Rows that are read at once from a source without episodes of its own.
CHUNK_ROWS = 65_536


def is_number(dtype):
    """Whether values of this type are plain numbers or booleans."""
    return np.dtype(dtype).kind in "fiub"


def is_image(row_shape, dtype):
    """Whether rows of this shape and type are pictures: bytes in two dimensions or more, or anything in three."""
    return len(row_shape) >= 3 or (len(row_shape) == 2 and np.dtype(dtype) == np.uint8)


def width_of(row_shape):
    """How many numbers a row of this shape has."""
    return int(np.prod(row_shape, dtype=np.int64))


def rows(array, what, episode=None):
    """The array as a matrix with one row per step."""
    array = np.asarray(array)
    if not is_number(array.dtype):
        raise Fault(f"{what} has the type {array.dtype}, which is no number", "choose another key or column", episode)
    if array.ndim == 0:
        raise Fault(f"{what} is a single value, not one per step", "choose another key or column", episode)
    return array.reshape(len(array), width_of(array.shape[1:]))


def column(array, what, episode=None):
    """The array as one number per step."""
    array = rows(array, what, episode)
    if array.shape[1] != 1:
        raise Fault(f"{what} has {array.shape[1]} numbers a step instead of one", "choose another key or column", episode)
    return array[:, 0]


def flags(array, what, episode=None):
    """The array as one boolean per step; whatever type it has, it must hold 0 and 1 alone."""
    array = column(array, what, episode)
    wrong = np.flatnonzero((array != 0) & (array != 1))
    if wrong.size:
        step = int(wrong[0])
        raise Fault(
            f"{what} is {array[step]} where only 0 and 1 are flags", "correct it in the source, or choose another key or column", episode, step
        )
    return array != 0
