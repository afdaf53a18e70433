"""Bags as tables: topics and fields by a map, resampled to one period."""

from itertools import islice

import numpy as np

import arrays
import timing
from fields import Field, leaves
from faults import Fault
from from_table import WORDS, MappedTable
from model import Key
from resample import Resampler
from tables import NUMBER

# A topic that is silent for more periods than that ends an episode.
GAP_PERIODS = 3
BLOCK_ROWS = 4096
STAMP = "time"


class Bag(MappedTable):
    """A reader of bags: `bag` is one of bags.py."""

    def __init__(self, name, bag, options):
        allowed = ["observation", "action", "reward", "terminated", "truncated", "success", "episode", "time.period_us", "time.held", "topics"]
        self._bag = bag
        super().__init__(name, BagTable(bag, options.map), options, allowed)

    def keys(self):
        found = []
        for topic, kind in self._bag.topics.items():
            message = self._bag.first(topic)
            found.append(Key(topic, "", kind, ""))
            found += [Key(f"    {path}", "", "", "") for path in ([] if message is None else leaves(message))]
        return found

    def header(self):
        if self._map is None:
            topics = ", ".join(sorted(self._bag.topics))
            raise Fault(
                f"what the topics mean is not said: {topics}", "say it in a map: --map map.toml, as docs/import.md describes it; --describe prints fields"
            )
        return super().header()

    def _clock(self):
        return STAMP, "ns"

    def _default_gap_s(self):
        # Rows of one stretch are one period apart, and a gap leaves out more than one.
        return timing.GAP_PERIODS * self._period()[0] / 1e6

    def _period(self):
        if self._table.period_us is None:
            column = self._map.need("observation", "columns")[0]
            self._table.find_period(column, self._map.get("time", "period_us"))
        return self._table.period_us, self._table.period_from, []


class BagTable:
    def __init__(self, bag, map):
        self._bag = bag
        self._time = bag.span[0]
        self.period_us = None
        self.period_from = None
        self.widths, self.types, self._fields = {STAMP: 1}, {STAMP: "time"}, {}
        self._held = map.get("time", "held") or [] if map else []
        for topic, fields in (map.topics if map else {}).items():
            if topic not in bag.topics:
                raise Fault(f"no topic {topic}", f"the topics are: {', '.join(sorted(bag.topics))}")
            for column, path in fields.items():
                if column in self.widths:
                    raise Fault(
                        f"the column {column} stands twice under [topics]" if column != STAMP else "no column may be called time",
                        "give it another name",
                    )
                self.widths[column] = 1
                self.types[column] = topic
                self._fields[column] = (topic, Field(topic, path))
        unknown = [topic for topic in self._held if topic not in (map.topics if map else {})]
        if unknown:
            raise Fault(f"held in [time] names {unknown[0]}, which is no topic of the map", "name topics that stand under [topics]")

    def find_period(self, column, declared):
        if declared is not None:
            self.period_us, self.period_from = declared, "period_us in the map"
            return
        if column not in self._fields:
            raise Fault(f"no column {column}", f"the columns under [topics] are: {', '.join(self._fields) or 'none'}")
        topic = self._fields[column][0]
        times = np.array(list(islice(self._bag.times(topic), arrays.CHUNK_ROWS)), np.int64)
        self.period_us = timing.period(np.diff(times) / 1e3, f"the topic {topic}")
        self.period_from = f"the median difference of the first {len(times)} messages of {topic}"

    def share(self):
        begin, end = self._bag.span
        return min((self._time - begin) / max(end - begin, 1), 1.0)

    def blocks(self, columns):
        wanted = {}
        for column in columns:
            if column != STAMP:
                topic, field = self._fields[column]
                wanted.setdefault(topic, {})[column] = field
        period = self.period_us * 1000
        rows = Resampler(wanted, self._held, period, GAP_PERIODS * period).rows(forward(self._bag.messages(list(wanted))))
        while True:
            some = list(islice(rows, BLOCK_ROWS))
            if not some:
                return
            block = {column: self._values(some, column, kind) for column, kind in columns.items() if column != STAMP}
            block[STAMP] = np.array([row[0] for row in some], np.int64)
            self._time = some[-1][0]
            block[WORDS] = np.array([row[2] for row in some], object)
            yield block

    def _values(self, rows, column, kind):
        if kind != NUMBER:
            return np.array([str(row[1][column]) for row in rows], object)
        try:
            return np.array([float(row[1][column]) for row in rows]).reshape(-1, 1)
        except ValueError as error:
            raise Fault(f"the column {column} holds a text: {error}", "name another field under [topics]") from error


def forward(messages):
    """Messages as they are, as long as their times do not go backward."""
    last = None
    for topic, time, message in messages:
        if last is not None and time < last:
            raise Fault(f"the time of {topic} goes backward: {last}, then {time} ns", "record again, or sort the bag with `mcap sort`")
        last = time
        yield topic, time, message
