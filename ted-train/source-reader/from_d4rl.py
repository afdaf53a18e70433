"""D4RL's layout: arrays of equal length, one row per transition, all episodes behind one another. In HDF5, and in .npz under the same names."""

import re

import numpy as np

import arrays
from faults import Fault
from model import Channel, Episode, Header, Key, Note, Skipped, numbered

USES = {
    "observations": "observation",
    "actions": "action",
    "rewards": "reward",
    "terminals": "the task ended here",
    "timeouts": "the recording was cut here",
    "next_observations": "the observation after the last action",
}

# Relative difference up to which the next row counts as the same observation: f32 and f64 of one number are closer.
SAME = 1e-6


class D4rl:
    """A reader of rows: `store` gives an array by its name, which may be read in slices."""

    takes = {"map", "observations"}

    def __init__(self, path, options, store=None):
        self._store = store if store is not None else hdf5(path)
        self._every = None
        if options.map:
            options.map.only("d4rl", "episode.every")
            self._every = options.map.get("episode", "every")
        self._has = {name: self._store[name] for name in USES if name in self._store}
        self._boundaries = None
        self._width = width(options.observations)

    def keys(self):
        found = []
        for name in sorted(names(self._store)):
            array = self._store[name]
            found.append(Key(name, str(tuple(array.shape)), str(array.dtype), USES.get(name, "ignored")))
        return found

    def header(self):
        for name in ("observations", "actions"):
            if name not in self._has:
                raise Fault(f"no array {name}", f"the arrays are: {', '.join(names(self._store))}; for other names, a .npz with a map will do")
        counts = {name: len(array) for name, array in self._has.items()}
        if len(set(counts.values())) != 1:
            lengths = ", ".join(f"{name} {count}" for name, count in counts.items())
            raise Fault(f"the arrays have different lengths: {lengths}", "download or convert the file again", step=min(counts.values()))
        self._find_boundaries(counts["actions"])
        rows, episodes = counts["actions"], len(self._boundaries.ends)
        whole = "next_observations" in self._has
        notes = list(self._boundaries.notes)
        if not whole:
            notes.append(
                "no next_observations: the last row of each episode gives only its observation; its action and reward are dropped, its end flags "
                "go to the step before"
            )
        return Header(
            self._observed(),
            self._channels("actions", "action"),
            rewards="rewards" in self._has,
            terminations="terminals" in self._has,
            episodes=episodes,
            steps=rows if whole else rows - episodes,
            notes=notes + self._left_out(),
        )

    def episodes(self, first):
        ends = self._boundaries.ends
        for number in range(first, len(ends)):
            begin = int(ends[number - 1]) + 1 if number else 0
            yield self._episode(number, begin, int(ends[number]) + 1)

    def _episode(self, number, begin, stop):
        name = f"rows {begin} to {stop - 1}"
        whole = "next_observations" in self._has
        steps = stop - begin if whole else stop - begin - 1
        if steps == 0:
            return Skipped(number, name, "one row only, and no observation after its action")
        read = {key: np.asarray(array[begin:stop]) for key, array in self._has.items() if key != "next_observations"}
        observations = read["observations"]
        if whole:
            observations = np.concatenate([observations, self._has["next_observations"][stop - 1 : stop]])
        ends = {}
        for key in ("terminals", "timeouts"):
            if key in self._has:
                raised = arrays.flags(read[key], key, name)
                ends[key] = raised[:steps].copy()
                ends[key][-1] |= raised[-1]
        why = self._boundaries.why.get(stop - 1)
        return Episode(
            number,
            name,
            observations if self._width is None else arrays.rows(observations, "observations", name)[:, : self._width],
            read["actions"][:steps],
            rewards=read["rewards"][:steps] if "rewards" in self._has else None,
            terminations=ends.get("terminals"),
            truncations=ends.get("timeouts"),
            notes=[Note(why, steps - 1)] if why else [],
        )

    def _channels(self, key, name):
        array = self._has[key]
        if arrays.is_image(array.shape[1:], array.dtype):
            raise Fault(
                f"{key} are pictures of the shape {tuple(array.shape[1:])}", "only numbers can be imported: compute some from the pictures first"
            )
        return [Channel(label) for label in numbered(name, arrays.width_of(array.shape[1:]))]

    def _observed(self):
        channels = self._channels("observations", "observation")
        if self._width is not None and self._width > len(channels):
            raise Fault(f"an observation has {len(channels)} numbers, and --observations asks for {self._width}", "ask for fewer, or for all")
        return channels[: self._width]

    def _left_out(self):
        whole = arrays.width_of(self._has["observations"].shape[1:])
        if self._width is None or self._width == whole:
            return []
        return [f"{whole - self._width} of {whole} numbers of each observation are left out, as --observations says"]

    def _find_boundaries(self, rows):
        if rows == 0:
            raise Fault("the arrays have no rows", "name another file")
        flagged = np.zeros(rows, bool)
        for key in ("terminals", "timeouts"):
            if key in self._has:
                flagged |= arrays.flags(self._has[key][:], key)
        self._boundaries = Boundaries(flagged)
        if "next_observations" in self._has:
            self._boundaries.breaks(breaks(self._has["observations"], self._has["next_observations"]), "timeouts" in self._has)
        elif "timeouts" not in self._has and self._every is None:
            raise Fault(
                "nothing says where an episode that did not end by itself was cut: there are no timeouts and no next_observations",
                "give the horizon in a map, as every = 1000 in [episode]; where only terminals end episodes, a number larger than any episode",
            )
        if self._every is not None:
            self._boundaries.every(self._every)
        self._boundaries.finish()


def width(keys):
    """How many numbers of an observation are wanted: `observations[:27]` for the first 27; none for all."""
    if keys is None or keys == ["observations"]:
        return None
    found = re.fullmatch(r"observations\[:([1-9]\d*)\]", ",".join(keys))
    if found is None:
        raise Fault(f"--observations {','.join(keys)} names nothing in this format", "write observations[:27] for the first 27 numbers of each")
    return int(found[1])


class Boundaries:
    """The last rows of the episodes, and what was unusual about them."""

    def __init__(self, flagged):
        self._ends = flagged
        self.why = {}
        self.notes = []

    def breaks(self, broken, has_timeouts):
        """Adds rows whose next observation is not that of the row after them."""
        new = broken & ~self._ends
        if not has_timeouts:
            self.notes.append(f"no timeouts: an episode ends where next_observations is not the next row's observation, at {int(new.sum())} places")
        else:
            words = "next_observations is not the next row's observation, and no flag says that the episode ends: cut here"
            self.why.update((int(row), words) for row in np.flatnonzero(new))
        self._ends |= broken

    def every(self, horizon):
        """Ends an episode after `horizon` rows at the latest."""
        begin = 0
        for end in [*np.flatnonzero(self._ends), len(self._ends) - 1]:
            self._ends[begin + horizon - 1 : end : horizon] = True
            begin = int(end) + 1
        self.notes.append(f"an episode ends after {horizon} rows at the latest, as the map says")

    def finish(self):
        last = len(self._ends) - 1
        if not self._ends[last]:
            self.why[last] = "the file ends inside this episode"
            self._ends[last] = True
        self.ends = np.flatnonzero(self._ends)


def breaks(observations, following):
    """For each row whether the row after it has another observation than the one that should follow."""
    broken = np.zeros(len(observations), bool)
    for begin in range(0, len(observations) - 1, arrays.CHUNK_ROWS):
        stop = min(begin + arrays.CHUNK_ROWS, len(observations) - 1)
        here = arrays.rows(following[begin:stop], "next_observations").astype(np.float64)
        there = arrays.rows(observations[begin + 1 : stop + 1], "observations").astype(np.float64)
        # Numbers that are none are reported by name later on; two of them are no break.
        both = np.isfinite(here) & np.isfinite(there)
        with np.errstate(invalid="ignore"):
            apart = np.abs(here - there) > SAME * np.maximum(np.abs(here), np.abs(there))
        broken[begin:stop] = (apart & both).any(axis=1)
    return broken


def hdf5(path):
    """The file as a store; the cache holds the compressed chunks that neighbouring episodes share."""
    import h5py

    return h5py.File(path, "r", rdcc_nbytes=64 << 20)


def names(store):
    """The arrays of a store, those in groups as group/name."""
    if not hasattr(store, "visititems"):
        return list(store)
    found = []
    store.visititems(lambda name, item: found.append(name) if hasattr(item, "dtype") else None)
    return found
