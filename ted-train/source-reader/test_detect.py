"""Which format a source is told to be, and what is said where that is unclear."""

import io
import sqlite3
import unittest

import h5py
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

import detect
from reading import Reading, numbers


class Detection(Reading):
    def test_a_source_that_tells_nothing_is_a_fault_that_names_the_formats(self):
        (self.folder / "log.bin").write_bytes(b"\x00\x01\x02")
        (self.folder / "empty").mkdir()
        with h5py.File(self.folder / "other.h5", "w") as file:
            file["trajectory/qpos"] = numbers(0, 4, 2)
        for name, words in [("log.bin", "called log.bin"), ("empty", "nothing in it"), ("other.h5", "trajectory")]:
            fault = self.fault(self.folder / name)
            self.assertIn("the format is unclear", fault["what"])
            self.assertIn(words, fault["what"])
            for format_name in detect.FORMATS:
                self.assertIn(format_name, fault["way_out"])

    def test_what_is_a_part_of_a_source_says_which_whole_to_name(self):
        pq.write_table(pa.table({"a": [1]}), self.folder / "a.parquet")
        self.assertIn("meta/info.json", self.fault(self.folder / "a.parquet")["way_out"])
        database = sqlite3.connect(self.folder / "a.db3")
        database.execute("create table topics (id)")
        database.commit()
        database.close()
        self.assertIn("metadata.yaml", self.fault(self.folder / "a.db3")["way_out"])

    def test_what_is_not_there_is_said_so(self):
        self.assertIn("there is nothing at", self.fault(self.folder / "log.csv")["what"])

    def test_a_damaged_file_is_a_fault_and_no_crash(self):
        path = self.folder / "whole.hdf5"
        with h5py.File(path, "w") as file:
            file["observations"] = numbers(0, 400, 2)
            file["actions"] = numbers(0, 400, 2)
        path.write_bytes(path.read_bytes()[:900])
        self.assertIn("it cannot be read: OSError", self.fault(path)["what"])
        (self.folder / "half.npz").write_bytes(npz_bytes()[:100])
        self.assertIn("it cannot be read: BadZipFile", self.fault(self.folder / "half.npz")["what"])

    def test_an_option_of_another_format_is_refused(self):
        path = self.folder / "log.hdf5"
        with h5py.File(path, "w") as file:
            file["observations"] = numbers(0, 4, 2)
            file["actions"] = numbers(0, 4, 2)
        for option in ("actions", "mask"):
            self.assertIn(f"--{option} says nothing to the format d4rl", self.fault(path, f"--{option}", "x")["what"])
        fault = self.fault(path, *self.map('[reward]\ncolumn = "r"\n'))
        self.assertIn("column in [reward] says nothing to the format d4rl", fault["what"])


def npz_bytes():
    file = io.BytesIO()
    np.savez(file, a=np.zeros(100))
    return file.getvalue()


if __name__ == "__main__":
    unittest.main()
