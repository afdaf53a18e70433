"""What is found in the episodes of any format: numbers that are none, end flags inside, lengths that disagree, nothing at all."""

import unittest

import h5py
import numpy as np

from reading import Reading, numbers


class Checks(Reading):
    """In robomimic's layout, where each episode's arrays stand by themselves."""

    def write(self, change=lambda arrays: None, steps=6):
        path = self.folder / "demos.hdf5"
        with h5py.File(path, "w") as file:
            for demo in range(2):
                arrays = {
                    "obs/joints": numbers(demo, steps, 3),
                    "next_obs/joints": numbers(demo + 10, steps, 3),
                    "actions": numbers(demo + 20, steps, 2),
                    "rewards": numbers(demo + 30, steps),
                }
                if demo == 1:
                    change(arrays)
                for name, values in arrays.items():
                    file.create_dataset(f"data/demo_{demo}/{name}", data=values)
        return path

    def test_a_number_that_is_none_is_a_fault_with_channel_episode_and_step(self):
        for name, value, words in [
            ("obs/joints", np.nan, "observation channel joints_2 is nan"),
            ("actions", np.inf, "action channel action_1 is inf"),
            ("rewards", -np.inf, "reward is -inf"),
        ]:
            fault = self.fault(self.write(lambda arrays, name=name, value=value: spoil(arrays[name], value)))
            self.assertEqual((fault["what"], fault["episode"], fault["step"]), (words, "demo_1", 3))
            self.assertIn("--drop nan", fault["way_out"])

    def test_dropping_cuts_the_episode_before_it_and_says_how_much_is_lost(self):
        for name, steps in [("obs/joints", 2), ("actions", 3), ("rewards", 3)]:
            path = self.write(lambda arrays, name=name: spoil(arrays[name], np.nan))
            _, episodes = self.whole(path, "--drop", "nan")
            self.assertEqual([episode["steps"] for episode in episodes], [6, steps])
            self.assertEqual(len(episodes[1]["observations"]), steps + 1)
            self.assertTrue(np.isfinite(episodes[1]["observations"]).all())
            (note,) = episodes[1]["notes"]
            self.assertEqual(note["step"], 3)
            self.assertIn(f"the last {6 - steps} steps are dropped", note["what"])

    def test_of_several_numbers_that_are_none_the_first_in_time_cuts(self):
        def spoil_two(arrays):
            arrays["obs/joints"][5, 0] = np.nan
            arrays["actions"][1, 0] = np.nan
            arrays["rewards"][3] = np.inf

        path = self.write(spoil_two)
        self.assertEqual((self.fault(path)["what"], self.fault(path)["step"]), ("action channel action_0 is nan", 1))
        _, episodes = self.whole(path, "--drop", "nan")
        self.assertEqual(episodes[1]["steps"], 1)

    def test_an_episode_of_which_nothing_is_left_is_skipped_by_name(self):
        def spoil_first(arrays):
            arrays["obs/joints"][0] = np.nan

        frames = self.frames(self.write(spoil_first), "--drop", "nan")
        (skipped,) = [frame for frame in frames if frame["kind"] == "skipped"]
        self.assertEqual((skipped["number"], skipped["name"]), (1, "demo_1"))
        self.assertIn("joints_0 is nan", skipped["why"])

    def test_an_observation_beyond_32_bits_is_a_fault_and_not_infinity(self):
        fault = self.fault(self.write(lambda arrays: spoil(arrays["obs/joints"], 1e300)))
        self.assertIn("1e+300 (too large for 32 bits)", fault["what"])

    def test_lengths_that_disagree_are_a_fault_that_names_them(self):
        def cut(arrays):
            arrays["rewards"] = arrays["rewards"][:4]

        fault = self.fault(self.write(cut))
        self.assertIn("observations 7, actions 6, rewards 4", fault["what"])
        self.assertEqual((fault["episode"], fault["step"]), ("demo_1", 4))

    def test_an_empty_episode_is_a_fault_unless_it_is_dropped(self):
        def empty(arrays):
            for name in arrays:
                arrays[name] = arrays[name][:0]

        path = self.write(empty)
        self.assertEqual(self.fault(path)["episode"], "demo_1")
        _, episodes = self.whole(path, "--drop", "empty")
        self.assertEqual(len(episodes), 1)

    def test_another_number_of_channels_is_a_fault(self):
        def widen(arrays):
            arrays["actions"] = numbers(1, 6, 4)

        fault = self.fault(self.write(widen))
        self.assertIn("actions have 4 numbers a step, and those of the first episode 2", fault["what"])

    def test_texts_are_a_fault(self):
        def write_words(arrays):
            arrays["actions"] = np.array([b"left"] * 6)

        self.assertIn("is no number", self.fault(self.write(write_words))["what"])

    def test_observations_narrow_once_and_actions_and_rewards_stay_as_they_are(self):
        written = {}
        path = self.write(written.update)
        _, episodes = self.whole(path)
        self.same(episodes[1]["observations"], np.concatenate([written["obs/joints"], written["next_obs/joints"][-1:]]).astype(np.float32))
        self.same(episodes[1]["actions"], written["actions"])
        self.same(episodes[1]["rewards"], written["rewards"])


def spoil(values, value):
    """Writes the value into the last number of row 3."""
    values[3, ...] = values[3, ...] if values.ndim > 1 else value
    if values.ndim > 1:
        values[3, -1] = value


if __name__ == "__main__":
    unittest.main()
