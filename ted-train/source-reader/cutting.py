"""Cuts a stream of rows into episodes by the rules of a map: a column's value, a gap in time, end flags, a number of rows."""

import numpy as np

from faults import Fault
from model import Note


class Piece:
    """The rows of one episode."""

    def __init__(self, number, name, rows, notes):
        self.number = number
        self.name = name
        self.rows = rows
        self.notes = notes


class Cutter:
    """Takes blocks of rows and gives whole episodes.

    A block is {name: array of n rows}; `episode` in it is an array of names, `time` of stamps, `end` of end flags, each only where a rule or a
    check needs it.
    """

    def __init__(self, by_column, gap, by_flags, every, scale_us=1.0):
        self._by_column = by_column
        self._gap = gap
        self._by_flags = by_flags
        self._every = every
        self._scale_us = scale_us
        self._number = 0
        self._pending = []
        self._count = 0
        self._last = {}
        self._seen = set()
        self._current = None

    def pieces(self, blocks):
        for block in blocks:
            rows = len(next(iter(block.values())))
            if rows:
                yield from self._take(block, rows)
        if self._count:
            yield self._finish([])

    def _take(self, block, rows):
        new = self._new(block, rows)
        starts = np.flatnonzero(new["column"] | new["gap"] | new["flags"])
        begin = 0
        for stop in [*starts.tolist(), rows]:
            while self._every is not None and self._count + stop - begin > self._every:
                middle = begin + self._every - self._count
                self._keep(block, begin, middle)
                yield self._finish([])
                begin = middle
            if stop > begin:
                self._keep(block, begin, stop)
            if stop < rows and self._count:
                yield self._finish(self._reasons(block, new, stop))
            begin = stop
        self._last = {name: values[-1] for name, values in block.items() if name in ("episode", "time", "end")}

    def _new(self, block, rows):
        """For each row, by which rule an episode begins with it. The first row of all begins one anyway."""
        new = {rule: np.zeros(rows, bool) for rule in ("column", "gap", "flags")}
        if self._by_column:
            before = np.concatenate([[self._last.get("episode", block["episode"][0])], block["episode"][:-1]])
            new["column"] = before != block["episode"]
        if self._gap is not None:
            before = np.concatenate([[self._last.get("time", block["time"][0])], block["time"][:-1]])
            new["gap"] = block["time"] - before > self._gap
        if self._by_flags:
            new["flags"] = np.concatenate([[self._last.get("end", False)], block["end"][:-1]]).astype(bool)
        return new

    def _reasons(self, block, new, row):
        if not new["gap"][row] or new["column"][row]:
            return []
        before = block["time"][row - 1] if row else self._last["time"]
        seconds = float(block["time"][row] - before) * self._scale_us / 1e6
        return [Note(f"the next row is {seconds:.3f} s later: another episode begins there", self._count - 1)]

    def _keep(self, block, begin, stop):
        self._pending.append({name: values[begin:stop] for name, values in block.items()})
        self._count += stop - begin

    def _finish(self, notes):
        rows = {name: np.concatenate([part[name] for part in self._pending]) for name in self._pending[0]}
        name = f"episode {self._number}"
        if self._by_column:
            name = rows["episode"][0]
            if name is None or name == "":
                raise Fault("the episode column is empty", "fill it in", f"the one after {self._number} others")
            if name in self._seen and name != self._current:
                raise Fault("its rows come back after another episode began", "sort the rows by episode, then by time", name)
            self._seen.add(name)
            self._current = name
        piece = Piece(self._number, name, rows, notes)
        self._number += 1
        self._pending = []
        self._count = 0
        return piece
