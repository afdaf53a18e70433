"""LeRobot's layouts v2.1 and v3.0, written with pyarrow as its documents and its own writer lay them out."""

import json
import unittest

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from reading import Reading, numbers

FPS = 30
LENGTHS = [5, 7, 4]
VIDEO = "observation.images.top"
PATHS = {
    "v2.1": (
        "data/chunk-{episode_chunk:03d}/episode_{episode_index:06d}.parquet",
        "videos/chunk-{episode_chunk:03d}/{video_key}/episode_{episode_index:06d}.mp4",
    ),
    "v3.0": ("data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet", "videos/{video_key}/chunk-{chunk_index:03d}/file-{file_index:03d}.mp4"),
}


class Lerobot(Reading):
    def write(self, version, change=lambda number, columns: None, files=(0, 0, 1)):
        """Three episodes; in v3 the first two share a file."""
        self.written = []
        for number, length in enumerate(LENGTHS):
            last = np.arange(length) == length - 1
            columns = {
                "observation.state": numbers(number, length, 3).astype(np.float32),
                "action": numbers(number + 10, length, 2).astype(np.float32),
                "next.reward": numbers(number + 20, length).astype(np.float32),
                "next.success": last & (number == 1),
                "next.done": last,
                "timestamp": (np.arange(length) / FPS).astype(np.float32),
                "frame_index": np.arange(length),
                "episode_index": np.full(length, number),
                "index": np.arange(length) + sum(LENGTHS[:number]),
                "task_index": np.zeros(length, np.int64),
            }
            change(number, columns)
            self.written.append(columns)
        root = self.folder / version
        (self.write_v2 if version == "v2.1" else self.write_v3)(root, files)
        features = {
            "observation.state": {"dtype": "float32", "shape": [3], "names": {"motors": ["pan", "lift", "grip"]}},
            "action": {"dtype": "float32", "shape": [2], "names": ["pan", "lift"]},
            VIDEO: {"dtype": "video", "shape": [8, 8, 3], "names": ["height", "width", "channels"], "info": {"video.fps": 15.0}},
        }
        features.update({name: {"dtype": "float32", "shape": [1], "names": None} for name in columns if name not in features})
        data_path, video_path = PATHS[version]
        info = {
            "codebase_version": version,
            "robot_type": "so101",
            "total_episodes": len(LENGTHS),
            "total_frames": sum(LENGTHS),
            "chunks_size": 2,
            "fps": FPS,
            "data_path": data_path,
            "video_path": video_path,
            "features": features,
        }
        (root / "meta" / "info.json").write_text(json.dumps(info))
        return root

    def write_v2(self, root, files):
        (root / "meta").mkdir(parents=True)
        lines = [json.dumps({"episode_index": number, "tasks": ["stack"], "length": length}) for number, length in enumerate(LENGTHS)]
        (root / "meta" / "episodes.jsonl").write_text("\n".join(lines) + "\n")
        for number, columns in enumerate(self.written):
            path = root / f"data/chunk-{number // 2:03d}/episode_{number:06d}.parquet"
            path.parent.mkdir(parents=True, exist_ok=True)
            pq.write_table(table(columns), path)

    def write_v3(self, root, files):
        (root / "meta/episodes/chunk-000").mkdir(parents=True)
        rows = []
        for number, length in enumerate(LENGTHS):
            begin = 0.5 * number
            rows.append(
                {
                    "episode_index": number,
                    "tasks": ["stack"],
                    "length": length,
                    "data/chunk_index": 0,
                    "data/file_index": files[number],
                    f"videos/{VIDEO}/chunk_index": 0,
                    f"videos/{VIDEO}/file_index": 0,
                    f"videos/{VIDEO}/from_timestamp": begin,
                    f"videos/{VIDEO}/to_timestamp": begin + length / FPS,
                    "stats/action/min": [0.0, 0.0],
                }
            )
        pq.write_table(pa.Table.from_pylist(rows), root / "meta/episodes/chunk-000/file-000.parquet")
        (root / "data/chunk-000").mkdir(parents=True)
        for file in set(files):
            tables = [table(columns) for number, columns in enumerate(self.written) if files[number] == file]
            pq.write_table(pa.concat_tables(tables), root / f"data/chunk-000/file-{file:03d}.parquet")

    def test_both_layouts_give_every_number(self):
        for version in PATHS:
            source, episodes = self.whole(self.write(version))
            self.assertEqual(source["format"], "lerobot")
            self.assertEqual([channel["name"] for channel in source["observation"]], ["pan", "lift", "grip"])
            self.assertEqual([channel["name"] for channel in source["action"]], ["pan", "lift"])
            self.assertEqual((source["period_us"], source["task"], source["episodes"], source["steps"]), (33_333, "stack", 3, 13))
            self.assertEqual(source["has"], {"rewards": True, "success": True, "terminations": False})
            for episode, written in zip(episodes, self.written, strict=True):
                self.same(episode["observations"], written["observation.state"])
                self.same(episode["actions"], written["action"][:-1].astype(np.float64))
                self.same(episode["rewards"], written["next.reward"][:-1].astype(np.float64))
                self.assertEqual(episode["success"].tolist()[-1], written["next.success"][-1])
                self.assertFalse(episode["success"][:-1].any())
                self.assertEqual(episode["notes"], [])

    def test_the_places_of_videos_are_told(self):
        _, episodes = self.whole(self.write("v2.1"))
        path = f"videos/chunk-001/{VIDEO}/episode_000002.mp4"
        self.assertEqual(episodes[2]["videos"], [{"feature": VIDEO, "path": path, "from_s": 0.0, "to_s": None, "step_s": 1 / FPS, "fps": 15.0}])
        _, episodes = self.whole(self.write("v3.0"))
        (video,) = episodes[2]["videos"]
        self.assertEqual((video["path"], video["from_s"]), (f"videos/{VIDEO}/chunk-000/file-000.mp4", 1.0))

    def test_reading_from_an_episode_on_opens_no_file_before_it(self):
        for version, first in [("v2.1", "data/chunk-000/episode_000000.parquet"), ("v3.0", "data/chunk-000/file-000.parquet")]:
            root = self.write(version)
            (root / first).unlink()
            _, episodes = self.whole(root, "--from-episode", "2")
            self.assertEqual([episode["number"] for episode in episodes], [2])
            self.same(episodes[0]["observations"], self.written[2]["observation.state"])
            self.assertIn(f"{first} is missing", self.fault(root)["what"])

    def test_several_features_make_one_observation_with_names_of_their_own(self):
        source, episodes = self.whole(self.write("v3.0"), "--observations", "observation.state,action")
        self.assertEqual([channel["name"] for channel in source["observation"]][2:4], ["observation.state.grip", "action.pan"])
        self.same(episodes[0]["observations"][:, 3:], self.written[0]["action"])

    def test_an_end_inside_an_episode_is_a_fault(self):
        def end_early(number, columns):
            if number == 1:
                columns["next.done"][2] = True

        fault = self.fault(self.write("v3.0", end_early))
        self.assertEqual((fault["episode"], fault["step"]), ("episode 1", 2))

    def test_frames_out_of_order_and_time_that_goes_backward_are_faults(self):
        def swap_frames(number, columns):
            columns["frame_index"][[1, 2]] = [2, 1]

        def swap_times(number, columns):
            columns["timestamp"][[1, 2]] = columns["timestamp"][[2, 1]]

        fault = self.fault(self.write("v2.1", swap_frames))
        self.assertEqual((fault["episode"], fault["step"]), ("episode 0", 1))
        fault = self.fault(self.write("v3.0", swap_times))
        self.assertIn("goes backward", fault["what"])
        self.assertEqual((fault["episode"], fault["step"]), ("episode 0", 2))

    def test_a_gap_in_time_is_told(self):
        def skip(number, columns):
            columns["timestamp"][3:] += np.float32(0.5)

        _, episodes = self.whole(self.write("v3.0", skip))
        self.assertEqual(episodes[0]["notes"], [{"step": 3, "what": "a gap of 16.0 periods"}])

    def test_a_length_that_is_not_that_of_the_metadata_is_a_fault(self):
        root = self.write("v2.1")
        path = root / "meta" / "episodes.jsonl"
        path.write_text(path.read_text().replace('"length": 7', '"length": 9'))
        fault = self.fault(root)
        self.assertEqual((fault["what"], fault["episode"], fault["step"]), ("the metadata says 9 frames and there are 7", "episode 1", 7))

    def test_an_episode_in_two_pieces_is_a_fault(self):
        root = self.write("v3.0")
        file = root / "data/chunk-000/file-000.parquet"
        whole = pq.read_table(file)
        pq.write_table(pa.concat_tables([whole, whole.slice(0, 2)]), file)
        fault = self.fault(root)
        self.assertIn("in two pieces", fault["what"])
        self.assertEqual(fault["episode"], "episode 0")

    def test_a_video_is_no_observation_and_an_unknown_layout_is_named(self):
        root = self.write("v3.0")
        self.assertIn("is a video", self.fault(root, "--observations", VIDEO)["what"])
        self.assertIn("observation.state", self.fault(root, "--observations", "arm")["way_out"])
        info = root / "meta" / "info.json"
        info.write_text(info.read_text().replace("v3.0", "v1.6"))
        self.assertIn("v1.6", self.fault(root)["what"])


def table(columns):
    """A matrix becomes a list for each row, as the datasets library writes features."""
    return pa.table({name: pa.array(list(values)) if values.ndim == 2 else pa.array(values) for name, values in columns.items()})


if __name__ == "__main__":
    unittest.main()
