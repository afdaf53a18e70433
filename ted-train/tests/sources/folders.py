"""LeRobot's folders as its documents lay them out, written and read with pyarrow, which is what LeRobot itself does."""

import json

import numpy as np
import pyarrow as pa
import pyarrow.dataset
import pyarrow.parquet as pq

from numbers_made import CHANNELS, COMMANDS, episodes

FPS = 30
FEATURES = {
    "observation.state": {"dtype": "float32", "shape": [CHANNELS], "names": ["pan", "lift", "elbow", "grip"]},
    "action": {"dtype": "float32", "shape": [COMMANDS], "names": ["pan", "lift"]},
    "next.reward": {"dtype": "float32", "shape": [1], "names": None},
    "timestamp": {"dtype": "float32", "shape": [1], "names": None},
    "frame_index": {"dtype": "int64", "shape": [1], "names": None},
    "episode_index": {"dtype": "int64", "shape": [1], "names": None},
    "index": {"dtype": "int64", "shape": [1], "names": None},
    "task_index": {"dtype": "int64", "shape": [1], "names": None},
}


def lerobot_2(folder):
    """Version 2.1: a file for each episode, which is a line of a JSON file."""
    root = folder / "so101-2"
    info(root, "v2.1", "data/chunk-{episode_chunk:03d}/episode_{episode_index:06d}.parquet")
    lines = []
    for number, frames in enumerate(all_frames()):
        path = root / f"data/chunk-{number // 4:03d}/episode_{number:06d}.parquet"
        path.parent.mkdir(parents=True, exist_ok=True)
        pq.write_table(frames, path)
        lines.append(json.dumps({"episode_index": number, "tasks": ["stack"], "length": frames.num_rows}))
    (root / "meta/episodes.jsonl").write_text("\n".join(lines) + "\n")
    return root, [], seen(root)


def lerobot_3(folder):
    """Version 3.0: several episodes in a file, with vectors of a fixed size, as the datasets library writes them."""
    root = folder / "so101-3"
    info(root, "v3.0", "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet")
    files, rows = [[], []], []
    for number, frames in enumerate(all_frames(fixed=True)):
        file = int(number >= 5)
        files[file].append(frames)
        rows.append({"episode_index": number, "tasks": ["stack"], "length": frames.num_rows, "data/chunk_index": 0, "data/file_index": file})
    (root / "data/chunk-000").mkdir(parents=True)
    for number, parts in enumerate(files):
        pq.write_table(pa.concat_tables(parts), root / f"data/chunk-000/file-{number:03d}.parquet")
    (root / "meta/episodes/chunk-000").mkdir(parents=True)
    pq.write_table(pa.Table.from_pylist(rows), root / "meta/episodes/chunk-000/file-000.parquet")
    return root, [], seen(root)


def info(root, version, data_path):
    about = {"codebase_version": version, "robot_type": "so101", "chunks_size": 4, "fps": FPS, "data_path": data_path, "features": FEATURES}
    (root / "meta").mkdir(parents=True)
    (root / "meta/info.json").write_text(json.dumps(about))


def all_frames(fixed=False):
    """The frames of each episode: the action of the last one was sent, and nobody saw what came of it."""
    frames, before = [], 0
    for number, one in enumerate(episodes(3)):
        count = len(one["observations"])
        actions = np.concatenate([one["actions"], one["actions"][-1:] / 2])
        rewards = np.append(one["rewards"], 0.5)
        kind = lambda width: pa.list_(pa.float32(), width if fixed else -1)
        columns = {
            "observation.state": pa.array(list(one["observations"].astype(np.float32)), kind(CHANNELS)),
            "action": pa.array(list(actions.astype(np.float32)), kind(COMMANDS)),
            "next.reward": rewards.astype(np.float32),
            "timestamp": (np.arange(count) / FPS).astype(np.float32),
            "frame_index": np.arange(count),
            "episode_index": np.full(count, number),
            "index": np.arange(before, before + count),
            "task_index": np.zeros(count, np.int64),
        }
        frames.append(pa.table(columns))
        before += count
    return frames


def seen(root):
    table = pyarrow.dataset.dataset(root / "data").to_table().sort_by("index")
    numbers = table["episode_index"].to_numpy()
    found = []
    for number in np.unique(numbers):
        rows = table.filter(pa.array(numbers == number))
        found.append(
            {
                "observations": np.array(rows["observation.state"].to_pylist()),
                "actions": np.array(rows["action"].to_pylist())[:-1],
                "rewards": np.array(rows["next.reward"].to_pylist())[:-1],
            }
        )
    return found
