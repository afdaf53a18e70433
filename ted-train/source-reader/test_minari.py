"""Minari's datasets, written by the package itself: HDF5, Arrow and Parquet, dictionaries of observations.

And what its Arrow writer does to long episodes.
"""

import json
import os
import unittest
import warnings

import gymnasium
import h5py
import minari
import numpy as np
import pyarrow as pa
from gymnasium.spaces import Box, Dict, Discrete
from minari.data_collector import EpisodeBuffer

from reading import Reading, numbers

LENGTHS = [5, 8, 3]
VECTOR = Box(-np.inf, np.inf, (4,), np.float64)
PARTS = Dict({"arm": Box(-2, 2, (2,), np.float32), "hand": Dict({"grip": Box(0, 1, (1,), np.float64)}), "camera": Box(0, 255, (32, 32, 3), np.uint8)})
BOUNDED = Box(-1, 2, (2,), np.float32)
WALK = Box(-np.inf, np.inf, (2,), np.float32)
FORMATS = ["hdf5", "arrow", "parquet"]


class Minari(Reading):
    def write(self, data_format, observation_space=VECTOR, action_space=BOUNDED, lengths=LENGTHS):
        warnings.simplefilter("ignore")
        os.environ["MINARI_DATASETS_PATH"] = str(self.folder)
        self.written = [buffer(number, steps, observation_space, action_space) for number, steps in enumerate(lengths)]
        minari.create_dataset_from_buffers(
            f"robot/{data_format}-v0",
            self.written,
            observation_space=observation_space,
            action_space=action_space,
            data_format=data_format,
            algorithm_name="random",
            author="a test",
            code_permalink="none",
            description="A dataset by minari's own writer.",
        )
        return self.folder / "robot" / f"{data_format}-v0"

    def test_every_number_that_the_package_wrote_is_read(self):
        for data_format in FORMATS:
            path = self.write(data_format)
            source, episodes = self.whole(path)
            self.assertEqual(source["format"], "minari")
            self.assertEqual((source["episodes"], source["steps"]), (3, 16))
            self.assertEqual(source["has"], {"rewards": True, "success": True, "terminations": True})
            self.assertEqual(source["observation"][1], {"name": "observation_1"})
            self.assertEqual(source["action"][0], {"name": "action_0", "low": -1.0, "high": 2.0})
            loaded = minari.load_dataset(f"robot/{data_format}-v0")
            for episode, theirs in zip(episodes, loaded.iterate_episodes(), strict=True):
                self.same(episode["observations"], theirs.observations.astype(np.float32))
                for name in ("actions", "rewards", "terminations", "truncations"):
                    self.same(episode[name], getattr(theirs, name))
                self.same(episode["success"], np.asarray(theirs.infos["success"])[1:])
            self.same(episodes[1]["observations"], self.written[1].observations.astype(np.float32))

    def test_the_data_folder_and_the_file_itself_may_be_named(self):
        path = self.write("hdf5")
        for inner in ["data", "data/main_data.hdf5"]:
            self.assertEqual(len(self.whole(path / inner)[1]), 3)

    def test_a_dictionary_of_observations_needs_a_choice_of_keys(self):
        for data_format in FORMATS:
            path = self.write(data_format, PARTS)
            fault = self.fault(path)
            self.assertIn("a dictionary", fault["what"])
            for key in ("arm", "hand/grip"):
                self.assertIn(key, fault["way_out"])
            source, episodes = self.whole(path, "--observations", "hand/grip,arm")
            self.assertEqual(source["observation"][0], {"name": "hand/grip", "low": 0.0, "high": 1.0})
            self.assertEqual(source["observation"][2], {"name": "arm_1", "low": -2.0, "high": 2.0})
            written = self.written[2].observations
            self.same(episodes[2]["observations"], np.concatenate([written["hand"]["grip"], written["arm"]], axis=1).astype(np.float32))
            self.assertIn("images", self.fault(path, "--observations", "camera")["what"])
            self.assertIn("hand/grip", self.fault(path, "--observations", "elbow")["way_out"])

    def test_discrete_actions_are_a_fault_with_words(self):
        for data_format in FORMATS:
            fault = self.fault(self.write(data_format, action_space=Discrete(3)))
            self.assertIn("Discrete", fault["what"])

    def test_any_numeric_type_is_read(self):
        for dtype in (np.float16, np.int32, np.uint8, np.bool_):
            for data_format in ("hdf5", "arrow"):
                space = Box(0, 1, (4,), dtype)
                path = self.write(data_format, space)
                _, episodes = self.whole(path)
                self.same(episodes[0]["observations"], self.written[0].observations.astype(np.float32))
                self.doCleanups()
                self.setUp()

    def test_metadata_of_version_0_4_lies_in_the_attributes_of_the_file(self):
        path = self.write("hdf5")
        about = json.loads((path / "data/metadata.json").read_text())
        (path / "data/metadata.json").unlink()
        with h5py.File(path / "data/main_data.hdf5", "a") as file:
            file.attrs.update(
                {**{key: about[key] for key in ("total_episodes", "total_steps", "observation_space", "action_space")}, "minari_version": "0.4.3"}
            )
        source, episodes = self.whole(path)
        self.assertEqual((source["steps"], len(episodes)), (16, 3))
        self.assertEqual(source["action"][0]["high"], 2.0)

    def test_a_long_arrow_episode_is_read_as_it_was_written_or_is_a_fault_with_episode_and_step(self):
        # The package's writer gives its blocks to threads, so that their order in the file is another every time.
        for steps in (40_000, 140_000):
            path = self.write("arrow", WALK, WALK, lengths=[3, steps])
            frames = self.frames(path)
            if frames[-1]["kind"] == "end":
                self.same(frames[2]["observations"], self.written[1].observations)
            else:
                self.assertEqual(frames[-1]["episode"], "episode 1")
                self.assertIn(frames[-1]["step"], range(steps))
            self.doCleanups()
            self.setUp()

    def test_blocks_in_the_wrong_order_are_found_by_their_jump(self):
        path = self.write("arrow")
        file = next((path / "data/1").glob("*.arrow"))
        table = pa.ipc.open_file(file).read_all()
        slow = pa.FixedSizeListArray.from_arrays(np.repeat(np.arange(9.0), 4), 4)
        table = table.set_column(table.column_names.index("observations"), "observations", slow)
        blocks = {"first": table.slice(0, 3), "second": table.slice(3, 3), "last": table.slice(6)}
        for order, step in [(["second", "first", "last"], 3), (["first", "second", "last"], None)]:
            with pa.ipc.new_file(str(file), table.schema) as sink:
                for name in order:
                    sink.write_table(blocks[name])
            if step is None:
                _, episodes = self.whole(path)
                self.same(episodes[1]["observations"][:, 0], np.arange(9))
                self.assertIn("written in 3 blocks", episodes[1]["notes"][0]["what"])
            else:
                fault = self.fault(path)
                self.assertIn("the observations jump here", fault["what"])
                self.assertEqual((fault["episode"], fault["step"]), ("episode 1", step))

    def test_missing_rows_and_reordered_blocks_are_faults(self):
        path = self.write("arrow")
        file = next((path / "data/1").glob("*.arrow"))
        table = pa.ipc.open_file(file).read_all()
        for spoiled, step, words in [
            (table.slice(0, 6), 5, "its metadata says 8 steps and there are 5"),
            (pa.concat_tables([table.slice(4, 4), table.slice(0, 4), table.slice(8)]), 3, "an end flag is set at step 3"),
        ]:
            with pa.ipc.new_file(str(file), table.schema) as sink:
                sink.write_table(spoiled)
            fault = self.fault(path)
            self.assertIn(words, fault["what"])
            self.assertEqual((fault["episode"], fault["step"]), ("episode 1", step))
        _, episodes = self.whole_but_short(path)
        self.assertEqual(episodes[1]["steps"], 4)

    def whole_but_short(self, path):
        """Reading with --drop after-end, after which the number of steps is another than the metadata says."""
        frames = self.frames(path, "--drop", "after-end")
        return frames[0], [frame for frame in frames if frame["kind"] == "episode"]

    def test_totals_that_are_not_those_of_the_metadata_are_faults(self):
        path = self.write("hdf5")
        file = path / "data/metadata.json"
        text = file.read_text()
        file.write_text(text.replace('"total_episodes": 3', '"total_episodes": 4'))
        self.assertIn("says 4 episodes and there are 3", self.fault(path)["what"])
        file.write_text(text.replace('"total_steps": 16', '"total_steps": 17'))
        self.assertIn("says 17 steps and the episodes have 16", self.fault(path)["what"])

    def test_reading_from_an_episode_on_gives_the_same_numbers(self):
        for data_format in FORMATS:
            _, episodes = self.whole(self.write(data_format), "--from-episode", "1")
            self.assertEqual([episode["number"] for episode in episodes], [1, 2])
            self.same(episodes[0]["actions"], self.written[1].actions)


def sample(space, steps, seed):
    if isinstance(space, Dict):
        return {name: sample(part, steps, seed + place) for place, (name, part) in enumerate(space.spaces.items())}
    space.seed(seed)
    if isinstance(space, gymnasium.spaces.Box) and np.isinf(space.low).any():
        return numbers(seed, steps, *space.shape).astype(space.dtype)
    return np.array([space.sample() for _ in range(steps)])


def buffer(number, steps, observation_space, action_space):
    ends = [False] * (steps - 1) + [True]
    goes_on = [False] * steps
    return EpisodeBuffer(
        id=number,
        seed=number,
        observations=sample(observation_space, steps + 1, number),
        actions=sample(action_space, steps, number + 10),
        rewards=list(numbers(number + 20, steps)),
        terminations=ends if number == 1 else goes_on,
        truncations=goes_on if number == 1 else ends,
        infos={"success": [False] * steps + [number != 2], "qpos": numbers(number, steps + 1, 3)},
    )


if __name__ == "__main__":
    unittest.main()
