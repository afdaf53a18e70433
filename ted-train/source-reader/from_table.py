"""Tables whose columns a map names: .npz, CSV, JSONL, and bags after they were resampled."""

import numpy as np

import arrays
import mapping
import timing
from cutting import Cutter
from faults import Fault
from model import Channel, Episode, Header, Key, Note, Skipped
from tables import NUMBER, TEXT, TIME

TRUE = {"1", "1.0", "true", "True", "TRUE"}
FALSE = {"0", "0.0", "false", "False", "FALSE"}
FLAGS = ("terminated", "truncated", "success")
ENDS = ("terminated", "truncated")
# What a table may say of single rows, beside its columns.
WORDS = "words"


class MappedTable:
    """A reader of rows: `table` has widths, types and blocks, as in tables.py."""

    takes = {"map"}

    def __init__(self, name, table, options, allowed):
        self._name = name
        self._table = table
        self._map = options.map
        self._allowed = allowed

    def keys(self):
        return [
            Key(name, "one number" if width == 1 else f"{width} numbers", self._table.types[name], "") for name, width in self._table.widths.items()
        ]

    def header(self):
        if self._map is None:
            raise Fault(
                f"what the columns mean is not said: {', '.join(self._table.widths)}", "say it in a map: --map map.toml, as docs/import.md describes it"
            )
        self._map.only(self._name, *self._allowed)
        observation = self._resolve("observation", "columns")
        from_next = self._map.get("action", "from_next")
        if (from_next is None) == (self._map.get("action", "columns") is None):
            raise Fault(
                "[action] needs either columns or from_next", "name the columns with the commands, or the positions whose next value is the command"
            )
        action = self._resolve("action", "from_next" if from_next else "columns")
        self._from_next = from_next is not None
        self._parts = {"observation": observation, "action": action}
        self._columns = dict.fromkeys([name for part in (observation, action) for name, _, _ in part], NUMBER)
        self._single("reward", NUMBER)
        for flag in FLAGS:
            self._single(flag, TEXT)
        self._rules()
        period_us, period_from, notes = self._period()
        self._period_us = period_us
        notes.append(
            "the last row of each episode gives only its observation: its action and reward are dropped, its flags go to the step before"
            if not self._from_next
            else "the action of a step is the next row's value of: " + ", ".join(from_next)
        )
        return Header(
            [Channel(label) for _, _, label in observation],
            [Channel(f"{label}_next" if self._from_next else label) for _, _, label in action],
            rewards=self._map.get("reward", "column") is not None,
            success=self._map.get("success", "column") is not None,
            terminations=self._map.get("terminated", "column") is not None,
            period_us=period_us,
            period_from=period_from,
            notes=notes,
        )

    def episodes(self, first):
        cutter = Cutter(self._by_column is not None, self._gap, self._by_flags, self._every, self._scale_us)
        for piece in cutter.pieces(self._rows()):
            if piece.number >= first:
                yield self._episode(piece)

    def _episode(self, piece):
        rows, name = piece.rows, piece.name
        notes = piece.notes
        if "time" in rows:
            timing.forward(rows["time"], name)
            if self._period_us is not None:
                notes = notes + timing.notes(rows["time"], self._scale_us, self._period_us)
        if WORDS in rows:
            notes = notes + [Note(words, step) for step, words in enumerate(rows[WORDS]) if words]
        count = len(rows["observation"])
        if count == 1:
            return Skipped(piece.number, name, "one row only, and no observation after its action")
        steps = count - 1
        flags = {}
        for flag in FLAGS:
            if flag in rows:
                values = as_flags(rows[flag], flag, name)
                flags[flag] = np.concatenate([values[: steps - 1], values[steps - 1 :].any(keepdims=True)])
        return Episode(
            piece.number,
            name,
            rows["observation"],
            rows["action"][1:] if self._from_next else rows["action"][:steps],
            rewards=rows["reward"][:steps] if "reward" in rows else None,
            terminations=flags.get("terminated"),
            truncations=flags.get("truncated"),
            success=flags.get("success"),
            share=self._table.share(),
            notes=notes,
        )

    def _rows(self):
        """Blocks with the columns under the names of their parts."""
        singles = {part: self._map.get(part, "column") for part in ("reward", *FLAGS, "episode")}
        singles["time"] = self._clock()[0]
        for block in self._table.blocks(self._columns):
            rows = {part: gathered(block, columns) for part, columns in self._parts.items()}
            for part, column in singles.items():
                if column is not None:
                    rows[part] = block[column]
            if WORDS in block:
                rows[WORDS] = block[WORDS]
            if self._by_flags:
                rows["end"] = np.zeros(len(rows["observation"]), bool)
                for part in ENDS:
                    if part in rows:
                        rows["end"] |= raised(rows[part])
            yield rows

    def _resolve(self, section, key):
        """The columns of a part as (column of the table, place in it or None, label)."""
        found = []
        widths = self._table.widths
        for name in self._map.need(section, key):
            head, _, place = name.rpartition("_")
            if name in widths:
                count = widths[name]
                found += [
                    (name, None if count == 1 else one, label)
                    for one, label in enumerate([name] if count == 1 else [f"{name}_{one}" for one in range(count)])
                ]
            elif head in widths and place.isdigit() and int(place) < widths[head]:
                found.append((head, int(place), name))
            else:
                self._no_column(name)
        labels = [label for _, _, label in found]
        doubled = [label for label in labels if labels.count(label) > 1]
        if doubled:
            raise Fault(f"{doubled[0]} stands twice in [{section}]", "name each column once")
        return found

    def _single(self, section, kind):
        self._want(section, self._map.get(section, "column"), kind)

    def _want(self, section, name, kind):
        if name is None:
            return
        if name not in self._table.widths:
            self._no_column(name)
        if section in FLAGS and self._columns.get(name) == NUMBER:
            return  # A reward of 0 and 1 may be the success as well.
        if self._columns.get(name, kind) != kind:
            raise Fault(f"the column {name} is a number of the robot and the {section} as well", "write it into the file twice, under two names")
        self._columns[name] = kind

    def _no_column(self, name):
        raise Fault(f"no column {name}", f"the columns are: {', '.join(self._table.widths)}")

    def _rules(self):
        self._by_column = self._map.get("episode", "column")
        self._every = self._map.get("episode", "every")
        self._single("episode", TEXT)
        column, unit = self._clock()
        self._want("time", column, TIME)
        self._scale_us = mapping.UNITS_US[unit] if column else 1.0
        gap_s = self._map.get("episode", "gap_s") or self._default_gap_s()
        if gap_s is not None and not column:
            raise Fault("gap_s in [episode] needs to know the time", "name the column and its unit in [time]")
        self._gap = None if gap_s is None else gap_s * 1e6 / self._scale_us
        others = self._by_column is not None or self._gap is not None
        self._by_flags = not others and any(self._map.get(flag, "column") for flag in ENDS)
        if not others and not self._by_flags and self._every is None:
            raise Fault(
                "nothing says where an episode ends",
                "give one of these in a map: column, gap_s or every in [episode], or the columns of [terminated] and [truncated]",
            )

    def _clock(self):
        """The column of times and its unit; None and None without one."""
        column = self._map.get("time", "column")
        return column, self._map.need("time", "unit") if column else None

    def _default_gap_s(self):
        """The gap that cuts where the map says none."""
        return None

    def _period(self):
        """The period, where it stands, and notes: declared, or the median of the differences of the first rows' times."""
        declared = self._map.get("time", "period_us")
        column = self._map.get("time", "column")
        if declared is not None:
            return declared, "period_us in the map", []
        if column is None:
            return None, None, ["no time column: the period is unknown"]
        wanted = {column: TIME}
        if self._by_column is not None:
            wanted[self._by_column] = TEXT
        differences, rows = [], 0
        last = {}
        for block in self._table.blocks(wanted):
            times = np.concatenate([last.get("time", block[column][:1]), block[column]])
            step = np.diff(times) * self._scale_us
            if self._by_column is not None:
                names = np.concatenate([last.get("name", block[self._by_column][:1]), block[self._by_column]])
                step = step[names[1:] == names[:-1]]
                last["name"] = block[self._by_column][-1:]
            last["time"] = block[column][-1:]
            if self._gap is not None:
                step = step[step <= self._gap * self._scale_us]
            differences.append(step)
            rows += len(block[column])
            if rows >= arrays.CHUNK_ROWS:
                break
        if not rows:
            raise Fault("it has no rows", "name another file")
        period_us = timing.period(np.concatenate(differences), f"the time column {column}")
        return period_us, f"the median difference of the first {rows} times in the column {column}", []


def gathered(block, columns):
    return np.concatenate([block[name] if place is None else block[name][:, place : place + 1] for name, place, _ in columns], axis=1)


def raised(values):
    """Where flags, as texts or numbers, are set."""
    return values[:, 0] == 1 if values.ndim == 2 else np.array([text in TRUE for text in values], bool)


def as_flags(texts, what, episode):
    """Texts or numbers as one boolean per row. Raises Fault where one is neither."""
    if texts.ndim == 2:
        return arrays.flags(texts, what, episode)
    wrong = np.flatnonzero(np.array([text not in TRUE and text not in FALSE for text in texts], bool))
    if wrong.size:
        step = int(wrong[0])
        raise Fault(f"{what} is {texts[step]!r} where only 0, 1, true and false are flags", "correct it in the source", episode, step)
    return raised(texts)
