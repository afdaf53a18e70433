"""LeRobot's datasets, v2 (a parquet file for each episode) and v3 (many episodes in a file).

Videos are only named: where they lie and from when to when.
"""

import json
import pathlib

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

import arrays
import timing
from arrow_columns import matrix
from faults import Fault
from model import Channel, Episode, Header, Key, Skipped, numbered

REWARD = "next.reward"
SUCCESS = "next.success"
DONE = "next.done"
STAMP = "timestamp"
FRAME = "frame_index"
INDEX = "episode_index"


class Place:
    """Where one episode lies: its number, file and frames, and its videos."""

    def __init__(self, number, file, length, tasks, videos):
        self.number = number
        self.file = file
        self.length = length
        self.tasks = tasks
        self.videos = videos


class Lerobot:
    takes = {"observations", "actions"}

    def __init__(self, path, options):
        self._root = pathlib.Path(path)
        self._info = read_info(self._root)
        self._features = self._info["features"]
        self._observations = options.observations or ["observation.state"]
        self._actions = options.actions or "action"

    def keys(self):
        uses = {
            "observation.state": "observation",
            "action": "action",
            REWARD: "reward",
            SUCCESS: "success",
            DONE: "checked",
            STAMP: "checked",
            FRAME: "checked",
        }
        found = []
        for name, about in self._features.items():
            use = "named, not read" if about.get("dtype") in ("video", "image") else uses.get(name, "not used")
            found.append(Key(name, str(tuple(about.get("shape", ()))), str(about.get("dtype")), use))
        return found

    def header(self):
        observation = [channel for key in self._observations for channel in self._channels(key)]
        action = self._channels(self._actions)
        self._places = self._v3() if self._version() == 3 else self._v2()
        total = self._info.get("total_episodes")
        if total is not None and int(total) != len(self._places):
            raise Fault(f"meta/info.json says {total} episodes and the list of episodes has {len(self._places)}", "download the dataset again")
        tasks = {task for place in self._places for task in place.tasks}
        self._period_us = round(1e6 / self._info["fps"])
        notes = ["the last frame of each episode gives only its observation: its action and reward are dropped, its success goes to the step before"]
        if DONE in self._features:
            notes.append(
                "next.done says that an episode ends and not why: it is compared with the end of the episode, and no step counts as terminated"
            )
        return Header(
            observation,
            action,
            rewards=REWARD in self._features,
            success=SUCCESS in self._features,
            period_us=self._period_us,
            period_from=f"{self._info['fps']} frames a second in meta/info.json",
            episodes=len(self._places),
            steps=sum(max(place.length - 1, 0) for place in self._places),
            task=tasks.pop() if len(tasks) == 1 else None,
            notes=notes,
        )

    def episodes(self, first):
        places = self._places[first:]
        begin = 0
        while begin < len(places):
            file = places[begin].file
            stop = begin
            while stop < len(places) and places[stop].file == file:
                stop += 1
            yield from self._in_file(file, places[begin:stop])
            begin = stop

    def _in_file(self, file, places):
        """The episodes of one file, which stand in it in the order of their numbers."""
        wanted = {place.number: place for place in places}
        seen = set()
        for index, table in self._runs(file):
            if index in seen:
                raise Fault(f"its frames come in two pieces in {file.name}", "download or record the dataset again", f"episode {index}")
            seen.add(index)
            if index in wanted:
                yield self._episode(wanted[index], table)
        missing = sorted(set(wanted) - seen)
        if missing:
            raise Fault(f"no frames in {file.name}, where the metadata says they are", "download the dataset again", f"episode {missing[0]}")

    def _runs(self, file):
        """Runs of rows of one episode, read some rows at a time."""
        if not file.exists():
            raise Fault(f"{file.relative_to(self._root)} is missing", "download the dataset again")
        optional = [key for key in (REWARD, SUCCESS, DONE, STAMP, FRAME) if key in self._features]
        columns = [*self._observations, self._actions, *optional, INDEX]
        parquet = pq.ParquetFile(file, pre_buffer=False)
        missing = [name for name in columns if name not in parquet.schema_arrow.names]
        if missing:
            raise Fault(f"{file.name} has no column {missing[0]}, which meta/info.json names", "download the dataset again")
        current, pending = None, []
        for batch in parquet.iter_batches(arrays.CHUNK_ROWS, columns=columns):
            indices = batch.column(INDEX).to_numpy(zero_copy_only=False)
            bounds = [0, *(np.flatnonzero(np.diff(indices)) + 1), len(indices)]
            for begin, stop in zip(bounds, bounds[1:]):
                if begin == stop:
                    continue
                index = int(indices[begin])
                if pending and index != current:
                    yield current, pa.Table.from_batches(pending)
                    pending = []
                current = index
                pending.append(batch.slice(begin, stop - begin))
        if pending:
            yield current, pa.Table.from_batches(pending)

    def _episode(self, place, table):
        name = f"episode {place.number}"
        frames = table.num_rows
        if frames != place.length:
            raise Fault(
                f"the metadata says {place.length} frames and there are {frames}", "download the dataset again", name, min(frames, place.length)
            )
        notes = self._in_time(table, name)
        if frames == 1:
            return Skipped(place.number, name, "one frame only, and no observation after its action")
        steps = frames - 1
        observations = np.concatenate([matrix(table[key], key, name) for key in self._observations], axis=1)
        success = None
        if SUCCESS in self._features:
            success = arrays.flags(matrix(table[SUCCESS], SUCCESS, name), SUCCESS, name)
            success = np.concatenate([success[: steps - 1], success[steps - 1 :].any(keepdims=True)])
        if DONE in self._features:
            done = np.flatnonzero(arrays.flags(matrix(table[DONE], DONE, name), DONE, name)[:-1])
            if done.size:
                raise Fault(
                    f"next.done is set at step {done[0]} of {frames}: these are two recordings in one, or frames in the wrong order",
                    "record it again, or take the episode out with LeRobot's own tools",
                    name,
                    int(done[0]),
                )
        return Episode(
            place.number,
            name,
            observations,
            matrix(table[self._actions], self._actions, name)[:steps],
            rewards=matrix(table[REWARD], REWARD, name)[:steps] if REWARD in self._features else None,
            success=success,
            notes=notes,
            videos=place.videos,
        )

    def _in_time(self, table, name):
        if FRAME in self._features:
            frames = matrix(table[FRAME], FRAME, name)[:, 0]
            wrong = np.flatnonzero(frames != np.arange(len(frames)))
            if wrong.size:
                step = int(wrong[0])
                raise Fault(
                    f"frame_index is {frames[step]} in the place of frame {step}: frames are missing, doubled or out of order",
                    "record it again",
                    name,
                    step,
                )
        if STAMP not in self._features:
            return []
        stamps = matrix(table[STAMP], STAMP, name)[:, 0].astype(np.float64)
        timing.forward(stamps, name)
        return timing.notes(stamps, 1e6, self._period_us)

    def _channels(self, key):
        about = self._features.get(key)
        if about is None:
            there = [name for name, one in self._features.items() if one.get("dtype") not in ("video", "image", "string")]
            raise Fault(f"no feature {key}", f"choose with --observations and --actions among: {', '.join(there)}")
        if about.get("dtype") in ("video", "image", "string"):
            raise Fault(f"the feature {key} is a {about['dtype']}", "only numbers can be imported: choose another")
        width = arrays.width_of(about.get("shape", [1]))
        names = about.get("names")
        if isinstance(names, dict):
            names = [name for group in names.values() if isinstance(group, list) for name in group]
        if not names or len(names) != width or len(set(map(str, names))) != width:
            names = numbered(key, width)
        elif len(self._observations) > 1 and key in self._observations:
            names = [f"{key}.{name}" for name in names]
        return [Channel(str(name)) for name in names]

    def _version(self):
        return int(str(self._info["codebase_version"]).lstrip("v").split(".")[0])

    def _videos(self):
        return [key for key, about in self._features.items() if about.get("dtype") == "video"]

    def _v2(self):
        """Episodes by meta/episodes.jsonl, one file each."""
        path = self._root / "meta" / "episodes.jsonl"
        try:
            lines = [json.loads(line) for line in path.read_text().splitlines() if line.strip()]
        except (OSError, ValueError) as error:
            raise Fault(f"meta/episodes.jsonl cannot be read: {error}", "download the dataset again") from error
        chunks = self._info.get("chunks_size", 1000)
        places = []
        for line in sorted(lines, key=lambda line: line["episode_index"]):
            number = int(line["episode_index"])
            about = {"episode_chunk": number // chunks, "episode_index": number}
            file = self._root / self._info["data_path"].format(**about)
            videos = [self._video(key, about, 0.0, None) for key in self._videos()]
            places.append(Place(number, file, int(line["length"]), line.get("tasks") or [], videos))
        return without_holes(places)

    def _v3(self):
        """Episodes by the parquet files under meta/episodes, which say where the frames and the videos of each lie."""
        files = sorted((self._root / "meta" / "episodes").glob("*/*.parquet"))
        if not files:
            raise Fault("no parquet file under meta/episodes", "download the dataset again")
        rows = []
        for file in files:
            schema = pq.read_schema(file).names
            # Statistics of every feature stand there too, and are most of the file.
            columns = [name for name in schema if not name.startswith("stats/")]
            rows += pq.read_table(file, columns=columns).to_pylist()
        places = []
        for row in sorted(rows, key=lambda row: row["episode_index"]):
            about = {"chunk_index": row["data/chunk_index"], "file_index": row["data/file_index"]}
            videos = []
            for key in self._videos():
                where = {part: row[f"videos/{key}/{part}"] for part in ("chunk_index", "file_index")}
                videos.append(self._video(key, where, row[f"videos/{key}/from_timestamp"], row[f"videos/{key}/to_timestamp"]))
            file = self._root / self._info["data_path"].format(**about)
            places.append(Place(int(row["episode_index"]), file, int(row["length"]), row.get("tasks") or [], videos))
        return without_holes(places)

    def _video(self, key, where, begin, end):
        path = self._info["video_path"].format(video_key=key, **where)
        about = self._features[key].get("info") or self._features[key].get("video_info") or {}
        fps = self._info["fps"]
        return {"feature": key, "path": path, "from_s": begin, "to_s": end, "step_s": 1 / fps, "fps": about.get("video.fps", fps)}


def without_holes(places):
    """Numbers must be 0, 1, 2, ...: a place in the list is a number of the source."""
    for place, episode in enumerate(places):
        if episode.number != place:
            raise Fault(f"the list of episodes goes from {place - 1} to {episode.number}", "download the dataset again", f"episode {place}")
    return places


def read_info(root):
    try:
        info = json.loads((root / "meta" / "info.json").read_text())
    except (OSError, ValueError) as error:
        raise Fault(f"meta/info.json cannot be read: {error}", "download the dataset again") from error
    missing = [key for key in ("codebase_version", "features", "fps", "data_path") if key not in info]
    if missing:
        raise Fault(f"meta/info.json has no {', '.join(missing)}", "download the dataset again")
    if not str(info["codebase_version"]).startswith(("v2.", "v3.")):
        raise Fault(f"the layout is {info['codebase_version']}, and v2.0, v2.1 and v3.0 are known", "convert it with LeRobot's own script")
    return info
