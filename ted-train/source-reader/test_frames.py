"""The frames byte by byte, and the process: its streams, its exit statuses, and what it does when nobody listens."""

import io
import json
import math
import os
import pathlib
import struct
import subprocess
import sys
import unittest

import numpy as np

from faults import Fault
from frames import Frames
from model import Channel, Episode, Header, Note, Skipped
from reading import Reading, parse

SCRIPT = pathlib.Path(__file__).with_name("read_source.py")


def sent(send):
    sink = io.BytesIO()
    send(Frames(sink))
    data = sink.getvalue()
    (length,) = struct.unpack_from("<I", data)
    return json.loads(data[4 : 4 + length]), data[4 + length :]


class Layout(unittest.TestCase):
    def test_the_source_frame_says_what_is_known(self):
        header = Header([Channel("x", -1.0, math.inf)], [Channel("u")], rewards=True, period_us=20_000, period_from="words", notes=["a note"])
        about, rest = sent(lambda frames: frames.source("csv", header))
        self.assertEqual(rest, b"")
        self.assertEqual(
            about,
            {
                "kind": "source",
                "format": "csv",
                "observation": [{"name": "x", "low": -1.0}],
                "action": [{"name": "u"}],
                "period_us": 20_000,
                "period_from": "words",
                "episodes": None,
                "steps": None,
                "task": None,
                "has": {"rewards": True, "success": False, "terminations": False},
                "notes": ["a note"],
            },
        )

    def test_an_episode_frame_is_followed_by_its_arrays_in_order(self):
        episode = Episode(3, "demo_3", np.array([[1.0], [2.0]], np.float32), np.array([[0.5]]), rewards=np.array([4.0]), success=np.array([True]))
        episode.notes.append(Note("words", 0))
        about, rest = sent(lambda frames: frames.episode(episode))
        self.assertEqual(
            about,
            {
                "kind": "episode",
                "number": 3,
                "name": "demo_3",
                "steps": 1,
                "share": None,
                "arrays": [
                    {"name": "observations", "type": "f32", "shape": [2, 1]},
                    {"name": "actions", "type": "f64", "shape": [1, 1]},
                    {"name": "rewards", "type": "f64", "shape": [1]},
                    {"name": "success", "type": "bool8", "shape": [1]},
                ],
                "notes": [{"step": 0, "what": "words"}],
                "videos": [],
            },
        )
        self.assertEqual(rest, struct.pack("<2f2dB", 1.0, 2.0, 0.5, 4.0, 1))

    def test_the_other_frames_are_json_alone(self):
        about, _ = sent(lambda frames: frames.skipped(Skipped(2, "demo_2", "words")))
        self.assertEqual(about, {"kind": "skipped", "number": 2, "name": "demo_2", "why": "words"})
        about, _ = sent(lambda frames: frames.fault(Fault("what", "out", "demo_2", 7)))
        self.assertEqual(about, {"kind": "fault", "episode": "demo_2", "step": 7, "what": "what", "way_out": "out"})
        about, _ = sent(lambda frames: frames.end())
        self.assertEqual(about, {"kind": "end", "episodes": 0, "steps": 0})


class Process(Reading):
    def write(self, rows=6):
        path = self.folder / "log.npz"
        ends = np.arange(rows) == rows - 1
        np.savez(path, observations=np.arange(rows * 2.0).reshape(rows, 2), actions=np.ones((rows, 1)), timeouts=ends)
        return path

    def run_it(self, *arguments, **options):
        return subprocess.run([sys.executable, "-Es", str(SCRIPT), *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, **options)

    def test_standard_output_carries_frames_alone(self):
        done = self.run_it(self.write())
        self.assertEqual((done.returncode, done.stderr), (0, b""))
        self.assertEqual([frame["kind"] for frame in parse(done.stdout)], ["source", "episode", "end"])

    def test_what_a_library_prints_does_not_come_between_the_frames(self):
        words = f"import os, sys; sys.path.insert(0, {str(SCRIPT.parent)!r}); import read_source\n"
        words += "read = read_source.read\ndef noisy(*arguments): os.write(1, b'noise'); print('noise', flush=True); read(*arguments)\n"
        words += "read_source.read = noisy; sys.exit(read_source.main(sys.argv[1:]))"
        done = subprocess.run([sys.executable, "-Es", "-c", words, str(self.write())], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.assertEqual([frame["kind"] for frame in parse(done.stdout)], ["source", "episode", "end"])
        self.assertEqual(done.stderr, b"noisenoise\n")

    def test_a_fault_is_a_frame_and_exit_status_3(self):
        done = self.run_it(self.folder / "none")
        self.assertEqual(done.returncode, 3)
        self.assertEqual([frame["kind"] for frame in parse(done.stdout)], ["fault"])

    def test_a_description_is_text_and_its_fault_goes_to_standard_error(self):
        done = self.run_it(self.write(), "--describe")
        self.assertEqual(done.returncode, 0)
        self.assertIn("observation_1", done.stdout.decode())
        done = self.run_it(self.folder / "none", "--describe")
        self.assertEqual((done.returncode, done.stdout), (3, b""))
        self.assertIn("way out: name a file", done.stderr.decode())

    def test_unknown_options_are_usage_and_exit_status_2(self):
        for option in (["--colour"], ["--from-episode", "-1"], ["--format", "bag"], ["--drop", "all"]):
            self.assertEqual(self.run_it(self.write(), *option).returncode, 2)

    def test_a_parent_that_goes_away_ends_it_without_a_trace(self):
        process = subprocess.Popen([sys.executable, "-Es", str(SCRIPT), str(self.write(400_000))], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        os.read(process.stdout.fileno(), 4)
        process.stdout.close()
        with process.stderr:
            self.assertEqual(process.stderr.read(), b"")
        self.assertEqual(process.wait(), 1)

    def test_only_the_libraries_of_a_format_are_loaded(self):
        words = "import sys, runpy; sys.argv[0:] = sys.argv[1:]; sys.path.insert(0, {!r})\n".format(str(SCRIPT.parent))
        words += "try: runpy.run_path(sys.argv[0], run_name='__main__')\nexcept SystemExit: pass\n"
        words += "print(sorted({'h5py', 'pyarrow', 'mcap', 'rosbags'} & set(sys.modules)), file=sys.stderr)"
        done = subprocess.run([sys.executable, "-Es", "-c", words, str(SCRIPT), str(self.write())], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        self.assertEqual(done.stderr.decode().splitlines()[-1], "[]")


if __name__ == "__main__":
    unittest.main()
