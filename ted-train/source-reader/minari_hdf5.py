"""Minari's HDF5 storage: a group for each episode in one file, whose attributes are the metadata up to 0.4."""

import numpy as np

import arrays
from faults import Fault
from minari_metadata import MAIN_FILE

TEXTS = ("observation_space", "action_space", "env_spec")


class Hdf5Episodes:
    def __init__(self, folder, about):
        import h5py

        path = folder / MAIN_FILE
        self._file = h5py.File(path, "r")
        groups = [name for name in self._file if name.startswith("episode_") and name[8:].isdigit()]
        self._ids = sorted(int(name[8:]) for name in groups)
        if not self._ids:
            raise Fault(f"{path} has no episodes", f"it has: {', '.join(self._file) or 'nothing'}")

    def about(self):
        """The metadata in the file's attributes."""
        about = {key: self._file.attrs[key] for key in ("total_episodes", "total_steps") if key in self._file.attrs}
        for key in TEXTS:
            text = self._file.attrs.get(key)
            if text is not None:
                about[key] = text.decode() if isinstance(text, bytes) else str(text)
        return about

    def ids(self):
        return self._ids

    def keys(self):
        found = []
        self._group(self._ids[0]).visititems(
            lambda name, item: found.append((name.replace("_index_", ""), str(item.shape), str(item.dtype))) if hasattr(item, "dtype") else None
        )
        return found

    def names(self, key):
        """The paths of the arrays under this key; none where it is itself one."""
        head = f"{key}/"
        return [path[len(head) :] for path, _, _ in self.keys() if path.startswith(head)]

    def width(self, key, name):
        array = self._find(self._group(self._ids[0]), key, name)
        if arrays.is_image(array.shape[1:], array.dtype):
            raise Fault(f"{name or key} are images of the shape {array.shape[1:]}", "only vectors of numbers can be imported: choose other keys")
        return arrays.width_of(array.shape[1:])

    def read(self, identity, chosen, success):
        group = self._group(identity)
        where = f"episode {identity}"
        read = {key: self._find(group, key, None, where)[:] for key in ("actions", "rewards", "terminations", "truncations")}
        parts = [arrays.rows(self._find(group, "observations", name, where)[:], name or "the observation", where) for name in chosen or [None]]
        if len({len(part) for part in parts}) > 1:
            lengths = ", ".join(f"{name} {len(part)}" for name, part in zip(chosen, parts))
            raise Fault(f"the lengths of its observations disagree: {lengths}", "record it again", where, min(len(part) for part in parts))
        read["observations"] = np.concatenate(parts, axis=1)
        read["success"] = self._find(group, "infos", success, where)[:] if success else None
        read["notes"] = []
        read["total_steps"] = group.attrs.get("total_steps")
        return read

    def _group(self, identity):
        return self._file[f"episode_{identity}"]

    def _find(self, group, key, name, where=None):
        path = key if name is None else f"{key}/{name}"
        for candidate in (path, "/".join(f"_index_{part}" if part.isdigit() else part for part in path.split("/"))):
            if candidate in group and hasattr(group[candidate], "dtype"):
                return group[candidate]
        raise Fault(f"no array {path}", "record or convert the dataset again", where)
