"""What the payload of each frame means: layouts only, no behaviour. docs/bridge-protocol.md is normative."""

import struct

# Requests, parent to worker.
OPEN = 0x01
RESET = 0x02
STEP = 0x03
COLLECT = 0x04
RENDER = 0x05
STATE = 0x06

# Replies, worker to parent: the request's kind with the high bit set, and two that answer no request of their own.
READY = 0x80
OPENED = 0x81
RESETTED = 0x82
STEPPED = 0x83
COLLECTED = 0x84
RENDERED = 0x85
STATED = 0x86
FAULT = 0xFF

# Why a worker refuses: the first field of a FAULT.
BAD_REQUEST = 1
UNKNOWN_TASK = 2
NO_EPISODE = 3
SIMULATOR = 4
CANNOT_START = 5
NO_PICTURES = 6

# Episodes that may run side by side.
SLOTS = 64

SUCCESS = 1
TERMINATED = 2
TRUNCATED = 4

SHAPE = struct.Struct("<HHIIIII")
RESET_REQUEST = struct.Struct("<HQ")
STATE_REQUEST = struct.Struct("<H")
# Seed and steps, then the fields of `collect.Behaviour`: push is four numbers.
COLLECT_REQUEST = struct.Struct("<QIdd4dddB")
# Seed, width and height in pixels, quality, and how many states follow.
RENDER_REQUEST = struct.Struct("<QHHBI")
REWARD_AND_FLAGS = struct.Struct("<dB")
EPISODE_STEPS = struct.Struct("<I")
PICTURE_BYTES = struct.Struct("<I")
FAULT_CODE = struct.Struct("<H")


def text(value):
    """A string on the wire: its length in bytes, then UTF-8."""
    data = value.encode()
    return struct.pack("<H", len(data)) + data


def read_text(payload):
    """The string that fills this payload."""
    (length,) = struct.unpack_from("<H", payload)
    if len(payload) != 2 + length:
        raise ValueError(f"a text of {length} bytes in a payload of {len(payload)}")
    return bytes(payload[2:]).decode()


def fault(code, message):
    """The payload of a FAULT; a long message keeps its end, which in Python says the most."""
    return FAULT_CODE.pack(code) + text(message.encode()[-8000:].decode(errors="ignore"))
