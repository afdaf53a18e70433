"""Frames to the parent: the length of some JSON (u32), the JSON, then the raw arrays that it names; all little-endian.

README.md describes each kind.
"""

import json
import math
import struct

import numpy as np

LENGTH = struct.Struct("<I")

TYPES = {"f32": "<f4", "f64": "<f8", "bool8": "|b1"}
ARRAYS = {
    "observations": "f32",
    "actions": "f64",
    "rewards": "f64",
    "terminations": "bool8",
    "truncations": "bool8",
    "success": "bool8",
}


class Frames:
    """Writes frames to a binary file, and counts what went out."""

    def __init__(self, sink):
        self._sink = sink
        self.episodes = 0
        self.steps = 0

    def source(self, name, header):
        self._send(
            {
                "kind": "source",
                "format": name,
                "observation": [described(channel) for channel in header.observation],
                "action": [described(channel) for channel in header.action],
                "period_us": header.period_us,
                "period_from": header.period_from,
                "episodes": header.episodes,
                "steps": header.steps,
                "task": header.task,
                "has": {"rewards": header.rewards, "success": header.success, "terminations": header.terminations},
                "notes": header.notes,
            }
        )

    def episode(self, episode):
        arrays = {name: getattr(episode, name) for name in ARRAYS if getattr(episode, name) is not None}
        steps = len(episode.actions)
        self._send(
            {
                "kind": "episode",
                "number": episode.number,
                "name": episode.name,
                "steps": steps,
                "share": episode.share,
                "arrays": [{"name": name, "type": ARRAYS[name], "shape": list(values.shape)} for name, values in arrays.items()],
                "notes": [{"step": note.step, "what": note.what} for note in episode.notes],
                "videos": episode.videos,
            },
            *(np.ascontiguousarray(values, TYPES[ARRAYS[name]]) for name, values in arrays.items()),
        )
        self.episodes += 1
        self.steps += steps

    def skipped(self, skipped):
        self._send({"kind": "skipped", "number": skipped.number, "name": skipped.name, "why": skipped.why})

    def fault(self, fault):
        self._send({"kind": "fault", "episode": fault.episode, "step": fault.step, "what": fault.what, "way_out": fault.way_out})

    def end(self):
        self._send({"kind": "end", "episodes": self.episodes, "steps": self.steps})

    def _send(self, about, *arrays):
        text = json.dumps(about, allow_nan=False).encode()
        self._sink.write(LENGTH.pack(len(text)) + text)
        for array in arrays:
            if array.size:
                self._sink.write(memoryview(array).cast("B"))
        self._sink.flush()


def described(channel):
    """A channel as JSON; a bound that is infinite is none."""
    about = {"name": channel.name}
    for bound in ("low", "high"):
        value = getattr(channel, bound)
        if value is not None and math.isfinite(value):
            about[bound] = float(value)
    return about
