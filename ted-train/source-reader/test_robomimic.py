"""robomimic's layout, written with h5py: the order of demos, the choice of keys, masks, and what its dones mean."""

import json
import unittest

import h5py
import numpy as np

from reading import Reading, numbers

STEPS = {0: 4, 2: 6, 10: 5}


class Robomimic(Reading):
    def write(self, next_obs=True, dones=None):
        path = self.folder / "low_dim.hdf5"
        self.written = {}
        with h5py.File(path, "w") as file:
            data = file.create_group("data")
            data.attrs["env_args"] = json.dumps({"env_name": "Lift", "type": 1, "env_kwargs": {"control_freq": 20}})
            data.attrs["total"] = sum(STEPS.values())
            for demo, steps in STEPS.items():
                done = np.zeros(steps, np.int64)
                done[-1] = 1
                arrays = {
                    "obs/object": numbers(demo, steps, 2),
                    "obs/eef_pos": numbers(demo + 1, steps, 3),
                    "obs/agentview_image": np.zeros((steps, 8, 8, 3), np.uint8),
                    "actions": numbers(demo + 2, steps, 2),
                    "actions_abs": numbers(demo + 3, steps, 2),
                    "rewards": numbers(demo + 4, steps),
                    "dones": dones(steps) if dones else done,
                    "states": numbers(demo + 5, steps, 9),
                }
                if next_obs:
                    arrays.update({f"next_obs/{key}": numbers(demo + 6, steps, width) for key, width in [("object", 2), ("eef_pos", 3)]})
                for name, values in arrays.items():
                    data.create_dataset(f"demo_{demo}/{name}", data=values)
                data[f"demo_{demo}"].attrs["num_samples"] = steps
                self.written[f"demo_{demo}"] = arrays
            file.create_dataset("mask/train", data=np.array([b"demo_10", b"demo_0"]))
        return path

    def test_all_low_dimensional_observations_are_read_in_the_order_of_their_names(self):
        source, episodes = self.whole(self.write())
        self.assertEqual(source["format"], "robomimic")
        self.assertEqual([channel["name"] for channel in source["observation"]], ["eef_pos_0", "eef_pos_1", "eef_pos_2", "object_0", "object_1"])
        self.assertIn("left out, as they are images or no numbers: agentview_image", source["notes"])
        self.assertEqual((source["period_us"], source["task"], source["steps"]), (50_000, "Lift", 15))
        self.assertIn("control_freq", source["period_from"])
        self.assertEqual([episode["name"] for episode in episodes], ["demo_0", "demo_2", "demo_10"])
        for episode in episodes:
            written = self.written[episode["name"]]
            rows = np.concatenate([written["obs/eef_pos"], written["obs/object"]], axis=1)
            last = np.concatenate([written["next_obs/eef_pos"][-1:], written["next_obs/object"][-1:]], axis=1)
            self.same(episode["observations"], np.concatenate([rows, last]).astype(np.float32))
            self.same(episode["actions"], written["actions"])
            self.same(episode["rewards"], written["rewards"])
            self.same(episode["terminations"], written["dones"])

    def test_keys_are_concatenated_in_the_order_of_the_choice(self):
        source, episodes = self.whole(self.write(), "--observations", "object,eef_pos", "--actions", "actions_abs")
        self.assertEqual(source["observation"][0]["name"], "object_0")
        self.same(episodes[0]["observations"][:4, :2], self.written["demo_0"]["obs/object"].astype(np.float32))
        self.same(episodes[0]["actions"], self.written["demo_0"]["actions_abs"])

    def test_without_next_obs_the_last_row_gives_its_observation_alone(self):
        source, episodes = self.whole(self.write(next_obs=False))
        self.assertEqual([episode["steps"] for episode in episodes], [3, 5, 4])
        self.same(episodes[0]["actions"], self.written["demo_0"]["actions"][:3])
        self.same(episodes[0]["terminations"], [False, False, True])
        self.assertIn("no next_obs", source["notes"][-1])
        self.assertEqual(source["steps"], 12)

    def test_a_mask_chooses_demos_and_leaves_their_numbers(self):
        _, episodes = self.whole(self.write(), "--mask", "train")
        self.assertEqual([(episode["number"], episode["name"]) for episode in episodes], [(0, "demo_0"), (2, "demo_10")])
        self.assertIn("the masks are: train", self.fault(self.write(), "--mask", "valid")["way_out"])

    def test_dones_at_successful_states_are_told_and_end_nothing(self):
        _, episodes = self.whole(self.write(dones=lambda steps: np.arange(steps) >= steps - 3))
        self.same(episodes[0]["terminations"], [False, False, False, True])
        self.assertEqual(episodes[0]["notes"][0]["step"], 1)
        self.assertIn("dones are set at 2 steps before the last", episodes[0]["notes"][0]["what"])

    def test_an_unknown_key_and_an_image_are_faults_that_name_the_others(self):
        path = self.write()
        self.assertIn("eef_pos", self.fault(path, "--observations", "elbow")["way_out"])
        self.assertIn("is an image", self.fault(path, "--observations", "agentview_image")["what"])
        self.assertIn("actions_abs", self.fault(path, "--actions", "torques")["way_out"])

    def test_a_number_of_samples_that_is_not_that_of_the_actions_is_a_fault(self):
        path = self.write()
        with h5py.File(path, "a") as file:
            file["data/demo_2"].attrs["num_samples"] = 9
        fault = self.fault(path)
        self.assertEqual((fault["what"], fault["episode"], fault["step"]), ("num_samples says 9 and there are 6 actions", "demo_2", 6))

    def test_a_file_of_states_alone_says_how_to_make_observations(self):
        path = self.folder / "raw.hdf5"
        with h5py.File(path, "w") as file:
            file["data/demo_0/actions"] = numbers(0, 4, 2)
            file["data/demo_0/states"] = numbers(1, 4, 3)
        self.assertIn("dataset_states_to_obs.py", self.fault(path)["way_out"])
        _, episodes = self.whole(path, "--observations", "states")
        self.same(episodes[0]["observations"], numbers(1, 4, 3).astype(np.float32))

    def test_the_description_shows_keys_and_choices(self):
        text = self.described(self.write())
        for words in ["obs/agentview_image", "left out: no vector of numbers", "--mask train", "eef_pos_2", "20 Hz"]:
            self.assertIn(words, text)


if __name__ == "__main__":
    unittest.main()
