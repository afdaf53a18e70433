"""robomimic's HDF5 layout: a group for each demonstration, with observations by key."""

import json

import numpy as np

import arrays
from faults import Fault
from model import Channel, Episode, Header, Key, Note, Skipped, numbered

DEFAULT_ACTIONS = "actions"


class Robomimic:
    takes = {"observations", "actions", "mask"}

    def __init__(self, path, options):
        import h5py

        self._file = h5py.File(path, "r")
        self._data = self._file["data"]
        self._demos = sorted((name for name in self._data if number_of(name) is not None), key=number_of)
        if not self._demos:
            raise Fault("no demo_0, demo_1, ... in the group data", f"it has: {', '.join(self._data) or 'nothing'}")
        self._others = [name for name in self._data if number_of(name) is None]
        self._chosen = set(self._demos if options.mask is None else self._mask(options.mask))
        self._observations = options.observations
        self._actions = options.actions or DEFAULT_ACTIONS

    def keys(self):
        demo = self._first()
        chosen, others = self._default(demo)
        uses = {f"obs/{key}": "observation" for key in chosen}
        uses.update({f"obs/{key}": "left out: no vector of numbers" for key in others})
        uses.update({DEFAULT_ACTIONS: "action", "rewards": "reward", "dones": "end flag"})
        found = []
        demo.visititems(
            lambda name, item: (
                found.append(Key(name, str(item.shape), str(item.dtype), uses.get(name, "not used"))) if hasattr(item, "dtype") else None
            )
        )
        masks = self._file.get("mask", {})
        return found + [Key(f"mask/{name}", str(masks[name].shape), "names of demos", f"--mask {name}") for name in masks]

    def header(self):
        demo = self._first()
        notes = []
        if self._observations is None:
            self._observations, others = self._default(demo)
            if others:
                notes.append(f"left out, as they are images or no numbers: {', '.join(others)}")
            if not self._observations:
                raise Fault(
                    "there are no low-dimensional observations under obs/",
                    "make them with robomimic's dataset_states_to_obs.py, or name what there is: --observations states",
                )
        if self._others:
            notes.append(f"ignored in the group data: {', '.join(self._others)}")
        observation = [Channel(name) for key in self._observations for name in self._channels(demo, key)]
        if self._actions not in demo:
            raise Fault(f"no array {self._actions}", f"choose with --actions among: {', '.join(arrays_of(demo))}", demo_name(demo))
        action = [Channel(name) for name in numbered("action", arrays.width_of(demo[self._actions].shape[1:]))]
        if not self._has_next(demo):
            notes.append(
                "no next_obs: the last row of each demo gives only its observation; its action and reward are dropped, its done goes to the step "
                "before"
            )
        about = self._about()
        rate = about.get("env_kwargs", {}).get("control_freq")
        return Header(
            observation,
            action,
            rewards="rewards" in demo,
            terminations="dones" in demo,
            period_us=round(1e6 / rate) if rate else None,
            period_from=f"control_freq = {rate} Hz in env_args" if rate else None,
            episodes=len(self._chosen),
            steps=sum(
                len(self._data[name][self._actions]) - (not self._has_next(self._data[name]))
                for name in self._chosen
                if self._actions in self._data[name]
            ),
            task=about.get("env_name"),
            notes=notes,
        )

    def episodes(self, first):
        for number, name in enumerate(self._demos):
            if number >= first and name in self._chosen:
                yield self._episode(number, name)

    def _episode(self, number, name):
        demo = self._data[name]
        if self._actions not in demo:
            raise Fault(f"no array {self._actions}", "take this demo out, or choose another key with --actions", name)
        actions = demo[self._actions][:]
        samples = demo.attrs.get("num_samples")
        if samples is not None and int(samples) != len(actions):
            raise Fault(
                f"num_samples says {samples} and there are {len(actions)} actions", "convert this demo again", name, min(int(samples), len(actions))
            )
        observations = self._concatenated(demo, "obs", name)
        rewards = demo["rewards"][:] if "rewards" in demo else None
        dones = arrays.flags(demo["dones"][:], "dones", name) if "dones" in demo else None
        steps = len(actions)
        if self._has_next(demo):
            if steps:
                observations = np.concatenate([observations, self._concatenated(demo, "next_obs", name)[-1:]])
        elif steps and all(len(rows) == steps for rows in (observations, rewards, dones) if rows is not None):
            # Only arrays that agree are shortened, so that lengths that do not are reported as they are.
            steps -= 1
            if steps == 0:
                return Skipped(number, name, "one row only, and no observation after its action")
            actions = actions[:steps]
            rewards = rewards[:steps] if rewards is not None else None
            if dones is not None:
                dones = np.concatenate([dones[: steps - 1], dones[steps - 1 :].any(keepdims=True)])
        notes = []
        if dones is not None and dones[:-1].any():
            inside = np.flatnonzero(dones[:-1])
            words = f"dones are set at {inside.size} steps before the last, as robomimic does at successful states; the demo is kept whole"
            notes.append(Note(words, int(inside[0])))
            dones = np.concatenate([np.zeros(len(dones) - 1, bool), dones[-1:]])
        return Episode(number, name, observations, actions, rewards=rewards, terminations=dones, notes=notes)

    def _first(self):
        return self._data[min(self._chosen, key=number_of)]

    def _default(self, demo):
        """The observations that are vectors of numbers, in the order of their names, and the others."""
        chosen, others = [], []
        for key, array in sorted(demo.get("obs", {}).items()):
            vector = hasattr(array, "dtype") and arrays.is_number(array.dtype) and not arrays.is_image(array.shape[1:], array.dtype)
            (chosen if vector else others).append(key)
        return chosen, others

    def _find(self, demo, group, key):
        """The array of this key, under obs/ or beside it; None where there is none."""
        if group in demo and key in demo[group]:
            return demo[group][key]
        return demo.get(key) if group == "obs" else None

    def _channels(self, demo, key):
        array = self._find(demo, "obs", key)
        if array is None or not hasattr(array, "dtype"):
            there = [*demo.get("obs", {}), *arrays_of(demo)]
            raise Fault(f"no observation {key}", f"choose with --observations among: {', '.join(there)}", demo_name(demo))
        if arrays.is_image(array.shape[1:], array.dtype):
            raise Fault(f"{key} is an image of the shape {array.shape[1:]}", "leave it out of --observations: only numbers can be imported")
        return numbered(key, arrays.width_of(array.shape[1:]))

    def _concatenated(self, demo, group, name):
        parts = []
        for key in self._observations:
            array = self._find(demo, group, key)
            if array is None:
                raise Fault(f"no {group}/{key}, which other demos have", "take this demo out, or choose other keys with --observations", name)
            parts.append(arrays.rows(array[:], key, name))
            if len(parts[-1]) != len(parts[0]):
                raise Fault(
                    f"the lengths of its arrays disagree: {self._observations[0]} {len(parts[0])}, {key} {len(parts[-1])}",
                    "convert this demo again",
                    name,
                    min(len(parts[0]), len(parts[-1])),
                )
        return np.concatenate(parts, axis=1)

    def _has_next(self, demo):
        return all(self._find(demo, "next_obs", key) is not None for key in self._observations)

    def _mask(self, name):
        masks = self._file.get("mask", {})
        if name not in masks:
            raise Fault(f"no mask {name}", f"the masks are: {', '.join(masks) or 'none'}")
        chosen = [demo.decode() if isinstance(demo, bytes) else str(demo) for demo in masks[name][:]]
        unknown = [demo for demo in chosen if demo not in self._data]
        if unknown or not chosen:
            raise Fault(
                f"the mask {name} names {'demos that are not there: ' + ', '.join(unknown[:5]) if unknown else 'no demo'}", "choose another mask"
            )
        return chosen

    def _about(self):
        try:
            about = json.loads(self._data.attrs.get("env_args", "{}"))
        except ValueError as error:
            raise Fault(f"env_args is no JSON: {error}", "correct the attribute of the group data") from error
        return about if isinstance(about, dict) else {}


def number_of(name):
    """The number in demo_12; None for another name."""
    head, _, digits = name.partition("_")
    return int(digits) if head == "demo" and digits.isdigit() else None


def demo_name(demo):
    return demo.name.rsplit("/", 1)[-1]


def arrays_of(group):
    return [name for name, item in group.items() if hasattr(item, "dtype")]
