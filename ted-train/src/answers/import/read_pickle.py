"""Reads a pickled list or array of numbers from standard input and writes it as JSON.

A pickle can name any function and have it called. This one may name what an array of numbers is made of, and gets the stand-ins
below instead: nothing that the pickle brings is ever run, and numpy is not needed.
"""

import json
import pickle
import struct
import sys


def raw(data):
    """Bytes, which old pickles hold as text."""
    return data.encode("latin1") if isinstance(data, str) else bytes(data)


def numbers(dtype, data):
    """All numbers in some bytes."""
    data = raw(data)
    return [number for number, in struct.iter_unpack(dtype.order + dtype.letter, data)]


class DType:
    """Stands in for numpy.dtype."""

    LETTERS = {
        "b1": "?", "i1": "b", "i2": "h", "i4": "i", "i8": "q",
        "u1": "B", "u2": "H", "u4": "I", "u8": "Q", "f4": "f", "f8": "d",
    }

    def __init__(self, name, *_):
        if name not in self.LETTERS:
            raise pickle.UnpicklingError(f"it holds {name}, which are no plain numbers")
        self.letter = self.LETTERS[name]
        self.order = "<"

    def __setstate__(self, state):
        self.order = ">" if state[1] == ">" else "<"


class Array:
    """Stands in for numpy.ndarray."""

    def __init__(self, *_):
        self.shape, self.flat = (0,), []

    def __setstate__(self, state):
        _, self.shape, dtype, by_columns, data = state
        if by_columns and len(self.shape) > 1:
            raise pickle.UnpicklingError("it is stored column by column")
        self.flat = numbers(dtype, data)


def from_buffer(data, dtype, shape, order):
    """Stands in for numpy's reader of buffers."""
    array = Array()
    array.__setstate__((1, shape, dtype, order == "F", data))
    return array


def scalar(dtype, data):
    """Stands in for numpy's single numbers."""
    return numbers(dtype, data)[0]


def encode(text, encoding):
    """Stands in for what old protocols write bytes as."""
    if encoding != "latin1":
        raise pickle.UnpicklingError(f"it holds bytes as {encoding}")
    return text.encode(encoding)


ALLOWED = {
    "numpy.ndarray": Array,
    "numpy.dtype": DType,
    "_codecs.encode": encode,
}
for core in ("numpy.core", "numpy._core"):
    ALLOWED[core + ".multiarray._reconstruct"] = Array
    ALLOWED[core + ".multiarray.scalar"] = scalar
    ALLOWED[core + ".numeric._frombuffer"] = from_buffer


class Reader(pickle.Unpickler):
    """Knows no names but those of stand-ins."""

    def find_class(self, module, name):
        full = f"{module}.{name}"
        if full not in ALLOWED:
            raise pickle.UnpicklingError(f"it names {full}, and an array of numbers has no need of that")
        return ALLOWED[full]


def plain(value):
    """Lists of numbers and of lists."""
    if isinstance(value, Array):
        rows = value.flat
        for size in reversed(value.shape[1:]):
            rows = [rows[at:at + size] for at in range(0, len(rows), size)]
        return rows
    if isinstance(value, (list, tuple)):
        return [plain(one) for one in value]
    if isinstance(value, (bool, int, float)):
        return value
    raise pickle.UnpicklingError(f"it holds a {type(value).__name__} where a number is expected")


try:
    print(json.dumps(plain(Reader(sys.stdin.buffer, encoding="latin1").load())))
except Exception as error:  # whatever is wrong with a pickle is wrong with it
    sys.exit(f"{error or type(error).__name__}")
