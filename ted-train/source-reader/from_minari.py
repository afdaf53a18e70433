"""Minari's own datasets: HDF5 and Arrow (or Parquet) storage, with the metadata of 0.4 (HDF5 attributes) and of 0.5 (metadata.json)."""

import pathlib

import arrays
from faults import Fault
from minari_metadata import MAIN_FILE, METADATA, data_folder, env_name, read_json
from minari_spaces import leaves
from model import Channel, Episode, Header, Key, Note, numbered

SUCCESS = ("success", "is_success")
PER_STEP = ("rewards", "terminations", "truncations")


class Minari:
    takes = {"observations"}

    def __init__(self, path, options):
        folder = data_folder(pathlib.Path(path))
        self._about = read_json(folder / METADATA)
        if (folder / MAIN_FILE).exists():
            from minari_hdf5 import Hdf5Episodes as Episodes
        else:
            from minari_arrow import ArrowEpisodes as Episodes
        self._storage = Episodes(folder, self._about)
        self._about = {**self._storage.about(), **self._about}
        self._observation = leaves(self._about.get("observation_space"))
        self._action = leaves(self._about.get("action_space"))
        self._chosen = options.observations
        self._success = None

    def keys(self):
        found = []
        for path, shape, kind in self._storage.keys():
            use = {"actions": "action", "rewards": "reward", "observations": "observation"}.get(path, "")
            if path.startswith("observations/"):
                use = f"--observations {path.partition('/')[2]}"
            elif path.partition("/")[0] == "infos":
                use = "success" if path.partition("/")[2] in SUCCESS else "ignored"
            found.append(Key(path, shape, kind, use))
        return found

    def header(self):
        names = self._storage.names("infos")
        self._success = next((name for name in SUCCESS if name in names), None)
        task = env_name(self._about.get("env_spec"))
        ids = self._storage.ids()
        total = self._about.get("total_episodes")
        if total is not None and int(total) != len(ids):
            raise Fault(f"the metadata says {total} episodes and there are {len(ids)}", "download or write the dataset again")
        return Header(
            self._channels("observations", self._observation, self._chosen),
            self._channels("actions", self._action, None),
            rewards=True,
            success=self._success is not None,
            terminations=True,
            episodes=len(ids),
            steps=int(self._about["total_steps"]) if "total_steps" in self._about else None,
            task=task,
            notes=[] if self._success is None else [f"success is infos/{self._success}"],
        )

    def episodes(self, first):
        total = 0
        for number, identity in enumerate(self._storage.ids()):
            if number >= first:
                episode = self._episode(number, identity)
                total += len(episode.actions)
                yield episode
        expected = self._about.get("total_steps")
        if first == 0 and expected is not None and int(expected) != total:
            raise Fault(f"the metadata says {expected} steps and the episodes have {total}", "download or write the dataset again")

    def _episode(self, number, identity):
        name = f"episode {identity}"
        read = self._storage.read(identity, self._chosen, self._success)
        actions = arrays.rows(read["actions"], "the action", name)
        if read["total_steps"] is not None and int(read["total_steps"]) != len(actions):
            raise Fault(
                f"its metadata says {read['total_steps']} steps and there are {len(actions)}; Minari's Arrow writer truncates and reorders "
                "episodes of more than 32,767 steps",
                "write the dataset again with data_format='hdf5', or in shorter episodes",
                name,
                min(int(read["total_steps"]), len(actions)),
            )
        success = read.get("success")
        if success is not None and len(success) == len(actions) + 1:
            success = success[1:]  # Minari keeps what reset returned as well.
        notes = list(read["notes"])
        if len(actions) and not any(arrays.flags(read[flag], flag, name)[-1:].any() for flag in ("terminations", "truncations")):
            notes.append(Note("no end flag at its last step", len(actions) - 1))
        return Episode(number, name, read["observations"], actions, **{key: read[key] for key in PER_STEP}, success=success, notes=notes)

    def _channels(self, key, spaces, chosen):
        """Channels by the space where the metadata has it, else by the shape of the first episode."""
        label = key[:-1]
        nested = self._storage.names(key)
        if nested and not chosen:
            if key == "actions":
                raise Fault("the action space is a dictionary", "flatten it when you record: only one array of actions can be imported")
            raise Fault("the observations are a dictionary", f"choose with --observations, separated by commas, among: {', '.join(nested)}")
        if chosen and not nested:
            raise Fault("the observations are one array and have no keys", "leave --observations out")
        unknown = [name for name in chosen or [] if name not in nested]
        if unknown:
            raise Fault(f"no observation {unknown[0]}", f"choose with --observations among: {', '.join(nested)}")
        channels = []
        for name in chosen or [None]:
            space = spaces.get(name) if spaces is not None else None
            if space is None:
                width = self._storage.width(key, name)
                low = high = [None] * width
            else:
                low, high = space.bounds(f"{key}/{name}" if name else key)
            channels += [Channel(*one) for one in zip(numbered(name or label, len(low)), low, high)]
        return channels
