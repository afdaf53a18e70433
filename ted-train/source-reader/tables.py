"""Tables, read in blocks of rows: .npz, CSV and JSONL.

Each has `widths`, the numbers in each column; `types`, for a person; `blocks`; and `share`, how much of it was read, from 0 to 1.

`blocks(columns)` takes {column: NUMBER, TEXT or TIME} and yields {column: array of some rows}: numbers as they are (matrices where a column
is wide), texts as strings, times as int64 where all of a block are whole, else float64.
"""

import codecs
import json
import os

import numpy as np

import arrays
from faults import Fault
from npy_rows import Npz

NUMBER = "number"
TEXT = "text"
TIME = "time"

# Bytes of a CSV file, and rows of a JSONL file, that are read at once.
CSV_BLOCK = 4 << 20
JSON_ROWS = 8192


class NpzTable:
    """One row per entry of the arrays' first axis."""

    def __init__(self, path):
        self._arrays = Npz(path)
        self.widths = {name: arrays.width_of(self._arrays[name].shape[1:]) for name in self._arrays}
        self.types = {name: str(self._arrays[name].dtype) for name in self._arrays}
        self._share = 0.0

    def share(self):
        return self._share

    def blocks(self, columns):
        counts = {name: len(self._arrays[name]) for name in columns}
        if len(set(counts.values())) > 1:
            lengths = ", ".join(f"{name} {count}" for name, count in counts.items())
            raise Fault(
                f"the arrays have different lengths: {lengths}", "write the file again, or take the odd one out of the map", step=min(counts.values())
            )
        total = next(iter(counts.values()))
        for begin in range(0, total, arrays.CHUNK_ROWS):
            block = {}
            for name, kind in columns.items():
                values = self._arrays[name][begin : min(begin + arrays.CHUNK_ROWS, total)]
                if kind == TEXT:
                    values = arrays_as_text(values.reshape(len(values)))
                elif kind == TIME:
                    values = arrays.column(values, name)
                    values = values.astype(np.int64) if values.dtype.kind in "iu" else values.astype(np.float64)
                else:
                    values = arrays.rows(values, name)
                block[name] = values
            self._share = min((begin + arrays.CHUNK_ROWS) / total, 1.0)
            yield block


class CsvTable:
    """A first line with the names of the columns, then a line for each row, separated by commas."""

    def __init__(self, path):
        self._path = path
        self._size = max(os.path.getsize(path), 1)
        names = self._open({}).schema.names
        doubled = sorted({name for name in names if names.count(name) > 1})
        if doubled:
            raise Fault(f"two columns are called {doubled[0]}", "give each column a name of its own in the first line")
        self.widths = dict.fromkeys(names, 1)
        self.types = dict.fromkeys(names, "column")

    def blocks(self, columns):
        import pyarrow as pa

        try:
            for batch in self._open(columns):
                yield {name: self._values(batch.column(name), kind, name) for name, kind in columns.items()}
        except pa.ArrowInvalid as error:
            raise Fault(f"a line cannot be read: {error}", "correct it in the file, or take the column out of the map") from error

    def share(self):
        return self._file.tell() / self._size

    def _open(self, columns):
        import pyarrow as pa
        from pyarrow import csv

        types = {name: pa.float64() if kind == NUMBER else pa.string() for name, kind in columns.items()}
        convert = csv.ConvertOptions(include_columns=list(columns) or None, column_types=types)
        try:
            self._file = pa.OSFile(str(self._path))
            return csv.open_csv(self._file, csv.ReadOptions(block_size=CSV_BLOCK), convert_options=convert)
        except pa.ArrowInvalid as error:
            raise Fault(f"it is no table: {error}", "the first line names the columns, and commas separate them") from error

    def _values(self, array, kind, name):
        if kind == NUMBER:
            return array.to_numpy(zero_copy_only=False).reshape(-1, 1)
        texts = array.to_numpy(zero_copy_only=False)
        return texts if kind == TEXT else stamps(texts.tolist(), name)


class JsonlTable:
    """A JSON object on each line; objects inside it give columns with a dot, lists give wide columns."""

    def __init__(self, path):
        self._path = path
        self._size = max(os.path.getsize(path), 1)
        self._read = 0
        first = next(self._rows(), None)
        if first is None:
            raise Fault("it has no line", "name another file")
        self.widths, self.types = {}, {}
        self._describe("", first[1])

    def blocks(self, columns):
        pending = []
        for line, row in self._rows():
            pending.append((line, row))
            if len(pending) == JSON_ROWS:
                yield self._block(pending, columns)
                pending = []
        if pending:
            yield self._block(pending, columns)

    def share(self):
        return self._read / self._size

    def _block(self, rows, columns):
        block = {}
        for name, kind in columns.items():
            values = [self._find(row, name, line) for line, row in rows]
            if kind == TEXT:
                block[name] = np.array([None if value is None else str(value) for value in values], object)
            elif kind == TIME:
                block[name] = stamps(values, name)
            else:
                block[name] = self._numbers(values, name, rows)
        return block

    def _numbers(self, values, name, rows):
        width = self.widths[name]
        numbers = np.empty((len(values), width))
        for place, value in enumerate(values):
            parts = value if isinstance(value, list) else [value]
            parts = [np.nan if part is None else part for part in parts]
            if len(parts) != width or not all(isinstance(part, (int, float)) for part in parts):
                raise Fault(f"line {rows[place][0]}: {name} is {json.dumps(value)[:60]}, not {width} numbers", "correct it in the file")
            numbers[place] = parts
        return numbers

    def _rows(self):
        self._read = 0
        with open(self._path, "rb") as file:
            for line, text in enumerate(file, 1):
                self._read += len(text)
                text = text.removeprefix(codecs.BOM_UTF8) if line == 1 else text
                if not text.strip():
                    continue
                try:
                    row = json.loads(text)
                except ValueError as error:
                    raise Fault(f"line {line} is no JSON: {error}", "correct it in the file") from error
                if not isinstance(row, dict):
                    raise Fault(f"line {line} is no JSON object", 'write one object on each line, as {"t": 0.0, "x": 1.5}')
                yield line, row

    def _find(self, row, name, line):
        if name in row:
            return row[name]
        for part in name.split("."):
            if not isinstance(row, dict) or part not in row:
                raise Fault(f"line {line} has no {name}", "every line needs the columns of the map; a value that is missing is null")
            row = row[part]
        return row

    def _describe(self, head, row):
        for key, value in row.items():
            if isinstance(value, dict):
                self._describe(f"{head}{key}.", value)
                continue
            self.widths[head + key] = len(value) if isinstance(value, list) else 1
            self.types[head + key] = type(value).__name__


def arrays_as_text(values):
    """Values of any plain type as strings, whole numbers without a point."""
    if values.dtype.kind == "f":
        return np.array([str(int(value)) if np.isfinite(value) and value == int(value) else str(value) for value in values], object)
    return np.array([value.decode() if isinstance(value, bytes) else str(value) for value in values], object)


def stamps(values, name):
    """Times as int64 where all are whole, so that nanoseconds since 1970 stay exact; what is missing becomes NaN."""
    if not any(isinstance(value, float) for value in values):
        try:
            return np.array([int(value) for value in values], np.int64)
        except (ValueError, TypeError, OverflowError):
            pass  # Not all are whole, or one is missing.
    try:
        return np.array([np.nan if value is None or value == "" else float(value) for value in values])
    except (ValueError, TypeError) as error:
        raise Fault(
            f"the time column {name} holds something that is no number: {error}", "write times as numbers, and say their unit in [time]"
        ) from error
