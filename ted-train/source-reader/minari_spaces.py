"""Gymnasium's spaces as Minari serialises them: which leaves there are, and what can be imported of them."""

import json

import numpy as np

import arrays
from faults import Fault


class Space:
    """One leaf of a serialised space."""

    def __init__(self, about):
        self._about = about

    def bounds(self, where):
        """Lowest and highest value of each number; a space of anything but a vector of numbers is a fault."""
        kind = self._about.get("type")
        if kind == "MultiBinary":
            width = arrays.width_of(np.atleast_1d(self._about["n"]))
            return [0.0] * width, [1.0] * width
        if kind != "Box":
            raise Fault(f"{where} are of a {kind} space", "only Box spaces can be imported: record numbers instead")
        shape = tuple(self._about["shape"])
        if arrays.is_image(shape, self._about["dtype"]):
            raise Fault(f"{where} are images of the shape {shape}", "only vectors of numbers can be imported: choose other keys, or record numbers")
        return [np.broadcast_to(np.asarray(self._about[side], float), shape).ravel().tolist() for side in ("low", "high")]


def leaves(serialised):
    """The leaves of a space by their path, joined by slashes; that of a space without parts is None. None without a space."""
    if serialised is None:
        return None
    try:
        space = json.loads(serialised)
    except ValueError as error:
        raise Fault(f"a space in the metadata is no JSON: {error}", "download or write the dataset again") from error
    found = {}
    walk(space, None, found)
    return found


def walk(space, path, found):
    parts = space.get("subspaces")
    if parts is None:
        found[path] = Space(space)
        return
    for name, part in parts.items() if isinstance(parts, dict) else enumerate(parts):
        walk(part, str(name) if path is None else f"{path}/{name}", found)
