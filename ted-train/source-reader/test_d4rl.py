"""D4RL's layout, written with h5py and with numpy: where episodes end, what becomes of last rows, and what is refused."""

import unittest

import h5py
import numpy as np

import from_d4rl
from reading import Reading, numbers

ROWS = 12


class D4rlFiles(Reading):
    def arrays(self, ends=(4, 7), rows=ROWS):
        """Three episodes: rows 0-4 end by a terminal, 5-7 by a timeout, the rest goes on to the end of the file."""
        observations = numbers(1, rows, 3).astype(np.float32)
        terminals, timeouts = np.zeros(rows, bool), np.zeros(rows, bool)
        terminals[ends[0]] = True
        timeouts[ends[1]] = True
        following = np.concatenate([observations[1:], observations[:1] + 1])
        for end in ends:
            following[end] = numbers(end, 3).astype(np.float32)
        return {
            "observations": observations,
            "actions": numbers(2, rows, 2).astype(np.float32),
            "rewards": numbers(3, rows).astype(np.float32),
            "terminals": terminals,
            "timeouts": timeouts,
            "next_observations": following,
        }

    def write(self, arrays):
        path = self.folder / "hopper.hdf5"
        with h5py.File(path, "w") as file:
            for name, values in arrays.items():
                file.create_dataset(name, data=values, compression="gzip", chunks=(4, *np.shape(values)[1:]))
            file.create_dataset("infos/qpos", data=numbers(9, 4, 5))
        return path

    def test_every_number_of_a_file_with_next_observations_is_read(self):
        written = self.arrays()
        source, episodes = self.whole(self.write(written))
        self.assertEqual(source["format"], "d4rl")
        self.assertEqual([channel["name"] for channel in source["observation"]], ["observation_0", "observation_1", "observation_2"])
        self.assertEqual(source["has"], {"rewards": True, "success": False, "terminations": True})
        self.assertEqual((source["period_us"], source["episodes"], source["steps"]), (None, 3, ROWS))
        for episode, (begin, stop) in zip(episodes, [(0, 5), (5, 8), (8, 12)], strict=True):
            self.assertEqual(episode["name"], f"rows {begin} to {stop - 1}")
            self.same(episode["observations"], np.concatenate([written["observations"][begin:stop], written["next_observations"][stop - 1 : stop]]))
            for read, name in [("actions", "actions"), ("rewards", "rewards"), ("terminations", "terminals"), ("truncations", "timeouts")]:
                self.same(episode[read], written[name][begin:stop])
        self.assertEqual(episodes[2]["notes"], [{"step": 3, "what": "the file ends inside this episode"}])

    def test_the_first_numbers_of_an_observation_may_be_enough(self):
        written = self.arrays()
        path = self.write(written)
        source, episodes = self.whole(path, "--observations", "observations[:2]")
        self.assertEqual(len(source["observation"]), 2)
        self.assertIn("1 of 3 numbers of each observation are left out", source["notes"][-1])
        self.same(episodes[0]["observations"], np.concatenate([written["observations"][:5], written["next_observations"][4:5]])[:, :2])
        for keys in ("observations[:4]", "observations[2:]", "observations[:2],actions"):
            fault = self.fault(path, "--observations", keys)
            self.assertIn("--observations", fault["what"])

    def test_without_next_observations_the_last_row_gives_its_observation_alone(self):
        written = self.arrays()
        del written["next_observations"]
        source, episodes = self.whole(self.write(written))
        self.assertIn("no next_observations: the last row", source["notes"][0])
        self.assertEqual([episode["steps"] for episode in episodes], [4, 2, 3])
        self.same(episodes[1]["observations"], written["observations"][5:8])
        self.same(episodes[1]["actions"], written["actions"][5:7])
        self.same(episodes[0]["terminations"], [False, False, False, True])
        self.same(episodes[1]["truncations"], [False, True])

    def test_without_timeouts_an_episode_ends_where_the_next_observation_does_not_follow(self):
        written = self.arrays()
        del written["timeouts"]
        source, episodes = self.whole(self.write(written))
        self.assertEqual([episode["steps"] for episode in episodes], [5, 3, 4])
        self.assertNotIn("truncations", episodes[0])
        self.assertIn("no timeouts", source["notes"][0])

    def test_two_episodes_that_run_together_are_cut_and_told(self):
        written = self.arrays()
        written["timeouts"][:] = False
        _, episodes = self.whole(self.write(written))
        self.assertEqual([episode["steps"] for episode in episodes], [5, 3, 4])
        self.assertIn("no flag says that the episode ends", episodes[1]["notes"][0]["what"])
        self.assertEqual(episodes[1]["notes"][0]["step"], 2)

    def test_breaks_are_found_across_the_borders_of_chunks(self):
        written = self.arrays()
        whole = from_d4rl.breaks(written["observations"], written["next_observations"])
        chunk, from_d4rl.arrays.CHUNK_ROWS = from_d4rl.arrays.CHUNK_ROWS, 2
        self.addCleanup(setattr, from_d4rl.arrays, "CHUNK_ROWS", chunk)
        self.same(from_d4rl.breaks(written["observations"], written["next_observations"]), whole)
        self.same(np.flatnonzero(whole), [4, 7])

    def test_without_any_word_on_cuts_a_horizon_must_be_given(self):
        written = self.arrays()
        del written["timeouts"], written["next_observations"]
        path = self.write(written)
        self.assertIn("every = 1000", self.fault(path)["way_out"])
        _, episodes = self.whole(path, *self.map("[episode]\nevery = 3\n"))
        # Rows 0-2, 3-4 (a terminal), 5-7, 8-10, 11; of each the last is an observation alone, so that nothing is left of the fifth.
        self.assertEqual([episode["steps"] for episode in episodes], [2, 1, 2, 2])
        self.assertEqual(self.frames(path, *self.map("[episode]\nevery = 3\n"))[-2]["kind"], "skipped")

    def test_reading_from_an_episode_on_gives_the_same_numbers(self):
        path = self.write(self.arrays())
        _, all_of_them = self.whole(path)
        _, rest = self.whole(path, "--from-episode", "1")
        self.assertEqual([episode["number"] for episode in rest], [1, 2])
        self.same(rest[0]["observations"], all_of_them[1]["observations"])

    def test_an_npz_file_with_the_same_names_reads_the_same(self):
        written = self.arrays()
        path = self.folder / "hopper.npz"
        for save in (np.savez, np.savez_compressed):
            save(path, **written)
            source, episodes = self.whole(path)
            self.assertEqual((source["format"], source["steps"]), ("npz", ROWS))
            self.same(np.concatenate([episode["actions"] for episode in episodes]), written["actions"])
            _, rest = self.whole(path, "--from-episode", "1")
            self.same(rest[0]["observations"], episodes[1]["observations"])
            self.same(rest[1]["actions"], episodes[2]["actions"])

    def test_integers_booleans_and_other_floats_widen_exactly(self):
        written = self.arrays()
        written["observations"] = np.arange(ROWS * 3).reshape(ROWS, 3).astype(np.int16)
        del written["next_observations"]
        written["actions"] = written["actions"].astype(np.float16)
        written["terminals"] = written["terminals"].astype(np.float32)
        written["rewards"] = written["rewards"].reshape(ROWS, 1)
        _, episodes = self.whole(self.write(written))
        self.same(episodes[0]["observations"], written["observations"][:5])
        self.same(episodes[0]["actions"], written["actions"][:4].astype(np.float64))
        self.same(episodes[0]["rewards"], written["rewards"][:4, 0])

    def test_arrays_of_different_lengths_are_a_fault(self):
        written = self.arrays()
        written["rewards"] = written["rewards"][:9]
        fault = self.fault(self.write(written))
        self.assertIn("rewards 9", fault["what"])
        self.assertEqual(fault["step"], 9)

    def test_flags_that_are_no_flags_are_a_fault(self):
        written = self.arrays()
        written["terminals"] = written["terminals"] * 0.5
        self.assertIn("0.5 where only 0 and 1", self.fault(self.write(written))["what"])

    def test_pictures_are_a_fault(self):
        written = self.arrays()
        written["observations"] = np.zeros((ROWS, 8, 8, 3), np.uint8)
        del written["next_observations"]
        self.assertIn("pictures", self.fault(self.write(written))["what"])

    def test_a_file_without_actions_names_what_it_has(self):
        written = self.arrays()
        del written["actions"]
        fault = self.fault(self.write(written), "--format", "d4rl")
        self.assertIn("no array actions", fault["what"])
        self.assertIn("infos/qpos", fault["way_out"])


if __name__ == "__main__":
    unittest.main()
