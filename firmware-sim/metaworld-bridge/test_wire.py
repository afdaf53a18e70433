"""The golden frames of docs/bridge-protocol.md, and what the codec refuses. Needs the standard library only."""

import os
import pathlib
import struct
import unittest

import messages
import wire

DOCUMENT = pathlib.Path(__file__).resolve().parents[2] / "docs" / "bridge-protocol.md"


def golden():
    """The frames of the document by name."""
    block = DOCUMENT.read_text().split("```golden\n")[1].split("```")[0]
    frames = {}
    for line in block.splitlines():
        name, equals, digits = line.rpartition("= ")
        current = name.strip() if equals else current
        frames[current] = frames.get(current, "") + digits.strip()
    return {name: bytes.fromhex(digits) for name, digits in frames.items()}


EPISODE = [
    messages.EPISODE_STEPS.pack(1),
    struct.pack("<4f", 1, 2, 3, 4),
    struct.pack("<f", -1),
    struct.pack("<d", 1.5),
    bytes([messages.SUCCESS | messages.TRUNCATED]),
    struct.pack("<2d", 0.1, 0.2),
    struct.pack("<2d", 0.3, 0.4),
    struct.pack("<6d", 0, 1, 2, 3, 4, 5),
    struct.pack("<8d", 1, 0, 1, 0, 1, 0, 1, 0),
    struct.pack("<d", 0.25),
]

EXPECTED = {
    "hello": wire.hello(),
    "ready": wire.frame(messages.READY, 0, messages.text("python=3.11.7 mujoco=3.3.0")),
    "open": wire.frame(messages.OPEN, 1, messages.text("drawer-open-v3")),
    "opened": wire.frame(messages.OPENED, 1, messages.SHAPE.pack(2, 1, 1, 1, 1, 1, 500)),
    "reset": wire.frame(messages.RESET, 2, messages.RESET_REQUEST.pack(1, 7)),
    "resetted": wire.frame(messages.RESETTED, 2, struct.pack("<2f", 1.0, -0.5), struct.pack("<d", 0.25)),
    "step": wire.frame(messages.STEP, 3, struct.pack("<Hf", 0, 0.5), struct.pack("<Hf", 1, -1.0)),
    "stepped": wire.frame(
        messages.STEPPED,
        3,
        struct.pack("<2f", 0.25, 2.0),
        messages.REWARD_AND_FLAGS.pack(1.5, messages.SUCCESS | messages.TRUNCATED),
        struct.pack("<2f", 0.5, 3.0),
        messages.REWARD_AND_FLAGS.pack(-2.5, 0),
    ),
    "collect": wire.frame(messages.COLLECT, 4, messages.COLLECT_REQUEST.pack(0xDEADBEEF, 500, 0.8, 0.8, 0.25, -0.5, 0.0, 1.0, 0.4, 0.98, 1)),
    "collected": wire.frame(messages.COLLECTED, 4, *EPISODE),
    "render": wire.frame(
        messages.RENDER,
        5,
        messages.RENDER_REQUEST.pack(0xDEADBEEF, 400, 300, 80, 2),
        struct.pack("<2d", 0.5, -0.5),
        struct.pack("<6d", 0.5, 1, 2, -0.5, 1, 2),
        struct.pack("<8d", 1, 0, 1, 0.5, 1, 0, 1, -0.5),
    ),
    "rendered": wire.frame(
        messages.RENDERED,
        5,
        messages.text("egl"),
        messages.PICTURE_BYTES.pack(3) + b"\xff\xd8\xff",
        messages.PICTURE_BYTES.pack(2) + b"\xff\xd9",
    ),
    "state": wire.frame(messages.STATE, 6, messages.STATE_REQUEST.pack(1)),
    "stated": wire.frame(messages.STATED, 6, struct.pack("<d", 0.5), struct.pack("<3d", 0.5, 1, 2), struct.pack("<4d", 1, 0, 1, 0.5)),
    "fault": wire.frame(messages.FAULT, 7, messages.fault(messages.UNKNOWN_TASK, "no such task")),
}


class GoldenFrames(unittest.TestCase):
    def test_the_document_and_the_codec_have_the_same_frames(self):
        self.assertEqual(golden(), EXPECTED)

    def test_the_document_names_the_version_that_the_code_speaks(self):
        self.assertIn(f"version {wire.PROTOCOL_VERSION}\n", DOCUMENT.read_text().splitlines(keepends=True)[0])

    def test_every_frame_is_read_back_from_a_pipe(self):
        frames = {name: data for name, data in EXPECTED.items() if name != "hello"}
        source, sink = os.pipe()
        os.write(sink, wire.hello() + b"".join(frames.values()))
        link = wire.Link(source, sink)
        self.assertEqual(link.receive_hello(), wire.PROTOCOL_VERSION)
        for data in frames.values():
            kind, sequence, payload = link.receive()
            self.assertEqual(wire.frame(kind, sequence, payload), data)


class Refusals(unittest.TestCase):
    def test_any_flipped_bit_is_noticed(self):
        good = EXPECTED["step"]
        for bit in range(len(good) * 8):
            bad = bytearray(good)
            bad[bit // 8] ^= 1 << bit % 8
            with self.assertRaises(wire.WireError):
                wire.unframe(bad)

    def test_any_truncation_is_noticed(self):
        good = EXPECTED["step"]
        for length in range(len(good)):
            with self.assertRaises(wire.WireError):
                wire.unframe(good[:length])

    def test_a_greeting_of_another_version_tells_its_version(self):
        self.assertEqual(wire.check_hello(wire.hello(7)), 7)

    def test_a_greeting_with_any_flipped_bit_is_noticed(self):
        for bit in range(wire.HELLO.size * 8):
            bad = bytearray(wire.hello())
            bad[bit // 8] ^= 1 << bit % 8
            with self.assertRaises(wire.WireError):
                wire.check_hello(bad)

    def test_a_closed_pipe_is_told_from_a_broken_frame(self):
        source, sink = os.pipe()
        os.write(sink, EXPECTED["step"][:20])
        os.close(sink)
        with self.assertRaises(wire.Closed):
            wire.Link(source, sink).receive()

    def test_a_text_of_another_length_is_refused(self):
        for payload in [b"", b"\x05", b"\x02\x00a", b"\x01\x00ab"]:
            with self.assertRaises((ValueError, struct.error)):
                messages.read_text(payload)


if __name__ == "__main__":
    unittest.main()
