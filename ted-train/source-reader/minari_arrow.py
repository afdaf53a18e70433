"""Minari's Arrow and Parquet storage: a folder for each episode, with rows from reset to the last observation and a padded last step."""

import re

import numpy as np
import pyarrow as pa

from arrow_columns import matrix
from faults import Fault
from minari_metadata import METADATA, read_json
from model import Note

# A jump between two blocks that is so many times the largest elsewhere in the episode is no motion of the robot.
FAR = 3.0


class ArrowEpisodes:
    def __init__(self, folder, about):
        self._folder = folder
        self._format = about.get("data_format", "arrow")
        if self._format not in ("arrow", "parquet"):
            raise Fault(f"the storage format {self._format} is unknown", "there are: hdf5, arrow, parquet")
        self._ids = sorted(int(child.name) for child in folder.iterdir() if child.is_dir() and child.name.isdigit())
        if not self._ids:
            raise Fault(f"{folder} has no episodes", "download or write the dataset again")
        self._sample = None

    def about(self):
        """What the data itself knows of the dataset: nothing."""
        return {}

    def ids(self):
        return self._ids

    def keys(self):
        found = []
        for name in self._first().column_names:
            self._walk(name, self._first()[name], found)
        return found

    def names(self, key):
        """The paths of the arrays under this key; none where it is itself one."""
        head = f"{key}/"
        return [path[len(head) :] for path, _, _ in self.keys() if path.startswith(head)]

    def width(self, key, name):
        return matrix(self._find(self._first(), key, name, None), key).shape[1]

    def read(self, identity, chosen, success):
        where = f"episode {identity}"
        table = self._table(identity)
        about = read_json(self._folder / str(identity) / METADATA)
        read = {key: matrix(self._padded(table, key, where), key, where) for key in ("actions", "rewards", "terminations", "truncations")}
        parts = [matrix(self._find(table, "observations", name, where), name or "the observation", where) for name in chosen or [None]]
        read["observations"] = np.concatenate(parts, axis=1)
        read["notes"] = in_order(read["observations"], [chunk.num_rows for chunk in table.to_batches()], where)
        read["success"] = matrix(self._find(table, "infos", success, where), success, where) if success else None
        read["total_steps"] = about.get("total_steps")
        return read

    def _padded(self, table, key, where):
        """A column without its last row, which belongs to no step."""
        column = self._find(table, key, None, where)
        return column.slice(0, max(len(column) - 1, 0))

    def _table(self, identity):
        folder = self._folder / str(identity)
        files = sorted((child for child in folder.iterdir() if child.suffix == f".{self._format}"), key=part_number)
        if not files:
            raise Fault(f"no .{self._format} file in {folder}", "download or write the dataset again", f"episode {identity}")
        return pa.concat_tables(self._open(file) for file in files)

    def _open(self, file):
        if self._format == "parquet":
            import pyarrow.parquet

            return pyarrow.parquet.ParquetFile(file).read()
        return pa.ipc.open_file(pa.memory_map(str(file))).read_all()

    def _first(self):
        if self._sample is None:
            self._sample = self._table(self._ids[0])
        return self._sample

    def _find(self, table, key, name, where):
        parts = [key] if name is None else [key, *name.split("/")]
        if key not in table.column_names:
            raise Fault(f"no column {key}", "record or convert the dataset again", where)
        column = table[key]
        for part in parts[1:]:
            if not pa.types.is_struct(column.type) or column.type.get_field_index(part) < 0:
                raise Fault(f"no array {'/'.join(parts)}", "record or convert the dataset again", where)
            column = pa.chunked_array([chunk.field(part) for chunk in column.chunks], column.type.field(part).type)
        return column

    def _walk(self, path, column, found):
        if not pa.types.is_struct(column.type):
            found.append((path, f"({len(column)} rows)", str(column.type)))
            return
        for field in column.type:
            inner = pa.chunked_array([chunk.field(field.name) for chunk in column.chunks], field.type)
            self._walk(f"{path}/{field.name}", inner, found)


def in_order(observations, lengths, where):
    """Checks the order of an episode's blocks: a jump at a border that is much larger than every other in a channel is a fault.

    Minari's writer hands out blocks of 32,768 rows to threads, and whichever is ready first comes first.
    """
    borders = np.cumsum(lengths)[:-1]
    if not borders.size:
        return []
    jumps = np.abs(np.diff(observations.astype(np.float64), axis=0))
    elsewhere = np.delete(jumps, borders - 1, axis=0).max(axis=0)
    wrong = borders[(jumps[borders - 1] > FAR * elsewhere).any(axis=1)]
    if wrong.size:
        raise Fault(
            "the observations jump here, between two blocks of the file, much further than anywhere else: the blocks are in the wrong order, as "
            "Minari's Arrow writer leaves them in episodes of more than 32,767 steps",
            "write the dataset again with data_format='hdf5', or in shorter episodes",
            where,
            int(wrong[0]),
        )
    if len(borders) == 1:
        return []  # The end flag is in the last block, so the other one is the first.
    words = f"written in {len(lengths)} blocks, of which only the last is known to be in its place: Minari's Arrow writer does not keep their order"
    return [Note(words, int(borders[0]))]


def part_number(file):
    """The number in part-12.arrow: the order in which the parts were written."""
    digits = re.findall(r"\d+", file.stem)
    return int(digits[-1]) if digits else 0
