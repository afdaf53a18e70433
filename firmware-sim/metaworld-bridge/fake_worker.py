"""A worker without a simulator, for tests of the parent: it speaks the protocol, or breaks it in one way on purpose.

The file `mode` in the current directory says how. A lock is held on the file `alive` for as long as the process lives; with
the lock in its hands, every start appends a line to the file `starts`, and a worker that computes for ever one to `busy`.
"""

import fcntl
import os
import pathlib
import random
import signal
import struct
import sys
import time

REQUESTS = os.dup(0)
REPLIES = os.dup(1)

import messages  # noqa: E402
import wire  # noqa: E402
from parent import leave_with_parent  # noqa: E402

STEPS = 500
MOVE = struct.Struct("<Hf")


def episode(seed, steps):
    """A toy: one joint that a random walk moves."""
    draws = random.Random(seed)
    walk = [draws.uniform(-1, 1) for _ in range(steps)]
    places = [sum(walk[:row]) for row in range(steps + 1)]
    flags = bytes(steps - 1) + bytes([messages.SUCCESS | messages.TRUNCATED])
    rows = steps + 1
    return [
        messages.EPISODE_STEPS.pack(steps),
        struct.pack(f"<{2 * rows}f", *[value for place in places for value in (place, seed % 1000)]),
        struct.pack(f"<{steps}f", *walk),
        struct.pack(f"<{steps}d", *[-abs(place) for place in places[1:]]),
        flags,
        struct.pack(f"<{rows}d", *places),
        struct.pack(f"<{rows}d", 0.0, *walk),
        struct.pack("<d", seed % 1000),
    ]


def step(walk, action):
    """Moves the joint of one episode; the outcome on the wire."""
    walk[:] = walk[0] + action, walk[1] + 1
    flags = messages.TRUNCATED if walk[1] == STEPS else 0
    return struct.pack("<2f", walk[0], 0.0) + messages.REWARD_AND_FLAGS.pack(-abs(walk[0]), flags)


def serve(link, mode, starts):
    walks = {}
    while True:
        kind, sequence, payload = link.receive()
        if kind == messages.COLLECT:
            if answered_badly(link, mode, starts, sequence):
                continue
            seed, steps, *_ = messages.COLLECT_REQUEST.unpack(payload)
            link.send(messages.COLLECTED, sequence, *episode(seed, steps))
        elif kind == messages.OPEN:
            link.send(messages.OPENED, sequence, messages.SHAPE.pack(2, 1, 1, 1, 0, 1, STEPS))
        elif kind == messages.RESET:
            slot, seed = messages.RESET_REQUEST.unpack(payload)
            walks[slot] = [0.0, 0]
            link.send(messages.RESETTED, sequence, struct.pack("<2f", 0.0, seed % 1000), struct.pack("<d", seed % 1000))
        elif any(slot not in walks for slot, _ in MOVE.iter_unpack(payload)):
            link.send(messages.FAULT, sequence, messages.fault(messages.NO_EPISODE, "reset first"))
        else:
            if answered_badly(link, mode, starts, sequence):
                continue
            link.send(messages.STEPPED, sequence, *[step(walks[slot], action) for slot, action in MOVE.iter_unpack(payload)])


def answered_badly(link, mode, starts, sequence):
    """Does what the mode asks for in the middle of an episode; whether that was an answer of some kind."""
    if mode == "dies always" or (mode.startswith("dies once") and starts == 1):
        print("first line\nthe simulator exploded", file=sys.stderr, flush=True)
        os.kill(os.getpid(), signal.SIGKILL)
    elif mode == "hangs":
        time.sleep(3600)
    elif mode == "computes for ever":
        note("busy")
        while True:
            pass
    elif mode == "flips a bit":
        reply = bytearray(wire.frame(messages.COLLECTED, sequence, *episode(1, 3)))
        reply[40] ^= 4
        os.write(REPLIES, reply)
    elif mode == "answers another request":
        link.send(messages.COLLECTED, sequence + 1, *episode(1, 3))
    elif mode == "answers another kind":
        link.send(messages.RESETTED, sequence, *episode(1, 3))
    elif mode == "answers too briefly":
        link.send(messages.COLLECTED, sequence, *episode(1, 3)[:-1])
    elif mode == "announces too much":
        os.write(REPLIES, wire.HEADER.pack(wire.MAX_PAYLOAD + 1, messages.COLLECTED, 0, sequence, 0))
    elif mode == "stops halfway":
        os.write(REPLIES, wire.frame(messages.COLLECTED, sequence, *episode(1, 3))[:50])
        os._exit(9)
    elif mode == "refuses":
        link.send(messages.FAULT, sequence, messages.fault(messages.SIMULATOR, "the drawer fell off"))
    else:
        return False
    return True


def note(file):
    """Appends a line about this process."""
    with open(file, "a") as lines:
        print(os.getpid(), file=lines)


def main():
    mode = pathlib.Path("mode").read_text()
    alive = open("alive", "w")
    fcntl.flock(alive, fcntl.LOCK_SH)
    note("starts")
    link = wire.Link(REQUESTS, REPLIES)
    if mode == "dies at once":
        sys.exit("no simulator here")
    if mode == "babbles":
        os.write(REPLIES, b"Hello, I am a perfectly normal Python program.\n")
        time.sleep(3600)
    if mode == "speaks another version":
        os.write(REPLIES, wire.hello(wire.PROTOCOL_VERSION + 1))
        time.sleep(3600)
    link.send_hello()
    leave_with_parent(REQUESTS)
    link.receive_hello()
    starts = len(pathlib.Path("starts").read_text().splitlines())
    if mode == "cannot start" or (mode == "dies once and never starts again" and starts > 1):
        link.send(messages.FAULT, 0, messages.fault(messages.CANNOT_START, "No module named 'mujoco'"))
        sys.exit(1)
    link.send(messages.READY, 0, messages.text("fake=1"))
    serve(link, mode, starts)


if __name__ == "__main__":
    try:
        main()
    except wire.Closed:
        pass
