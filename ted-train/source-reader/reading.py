"""Reads a source as the parent does, for tests: every frame as a dictionary, with its arrays under their names."""

import contextlib
import io
import json
import pathlib
import shutil
import tempfile
import unittest

import numpy as np

import read_source
from frames import LENGTH, TYPES


def parse(data):
    """All frames of a stream of bytes."""
    frames = []
    at = 0
    while at < len(data):
        (length,) = LENGTH.unpack_from(data, at)
        at += LENGTH.size
        frame = json.loads(data[at : at + length])
        at += length
        for about in frame.get("arrays", []):
            dtype = np.dtype(TYPES[about["type"]])
            count = int(np.prod(about["shape"], dtype=int))
            frame[about["name"]] = np.frombuffer(data, dtype, count, at).reshape(about["shape"])
            at += count * dtype.itemsize
        frames.append(frame)
    return frames


class Reading(unittest.TestCase):
    """A test with a folder of its own, and the ways to read what lies there."""

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)

    def frames(self, source, *arguments):
        """All frames; a fault is the last of them."""
        sink = io.BytesIO()
        with contextlib.redirect_stderr(io.StringIO()):
            self.status = read_source.run(read_source.parsed([str(source), *arguments]), sink)
        return parse(sink.getvalue())

    def whole(self, source, *arguments):
        """The source frame and the episodes of a source without fault."""
        frames = self.frames(source, *arguments)
        self.assertEqual((frames[-1]["kind"], self.status), ("end", 0), frames[-1])
        episodes = [frame for frame in frames if frame["kind"] == "episode"]
        self.assertEqual(frames[-1]["episodes"], len(episodes))
        self.assertEqual(frames[-1]["steps"], sum(episode["steps"] for episode in episodes))
        return frames[0], episodes

    def fault(self, source, *arguments):
        """The fault that reading ends with."""
        fault = self.frames(source, *arguments)[-1]
        self.assertEqual((fault["kind"], self.status), ("fault", 3), fault)
        self.assertTrue(fault["way_out"])
        return fault

    def described(self, source, *arguments):
        """What --describe prints."""
        sink = io.BytesIO()
        options = read_source.parsed([str(source), "--describe", *arguments])
        self.assertEqual(read_source.run(options, sink), 0)
        return sink.getvalue().decode()

    def map(self, text):
        """Options that name a map of this text."""
        path = self.folder / "map.toml"
        path.write_text(text)
        return ["--map", str(path)]

    def same(self, read, written):
        """Asserts that an array that was read has the numbers that were written."""
        np.testing.assert_array_equal(read, written)


def numbers(seed, *shape):
    """Numbers with full mantissas."""
    return np.random.default_rng(seed).normal(size=shape)
