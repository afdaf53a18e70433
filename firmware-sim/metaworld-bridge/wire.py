"""Frames on the wire between the Rust parent and this worker: see docs/bridge-protocol.md, which is normative.

Only the standard library is used, so that the golden frames are tested without the simulator.
"""

import os
import struct
import zlib

MAGIC = b"TEDBRDG\n"
PROTOCOL_VERSION = 5

HELLO = struct.Struct("<8sII")
HEADER = struct.Struct("<IHHII")
HEADER_CHECKED = 12
MAX_PAYLOAD = 64 * 1024 * 1024


class WireError(Exception):
    """The bytes are not a frame of this protocol."""


class Closed(Exception):
    """The parent closed its end: time to go."""


def hello(version=PROTOCOL_VERSION):
    """The first 16 bytes in each direction, in every version of the protocol."""
    return HELLO.pack(MAGIC, version, version ^ 0xFFFFFFFF)


def check_hello(data):
    """Returns the version that the other side speaks."""
    magic, version, inverted = HELLO.unpack(data)
    if magic != MAGIC or version ^ inverted != 0xFFFFFFFF:
        raise WireError("the peer did not greet with the bridge's magic")
    return version


def pack_header(into, kind, sequence, payload_parts):
    """Writes the 16 header bytes of a frame with this payload at the start of `into`."""
    length = sum(len(part) for part in payload_parts)
    HEADER.pack_into(into, 0, length, kind, 0, sequence, 0)
    crc = zlib.crc32(memoryview(into)[:HEADER_CHECKED])
    for part in payload_parts:
        crc = zlib.crc32(part, crc)
    struct.pack_into("<I", into, HEADER_CHECKED, crc)


def frame(kind, sequence, *payload_parts):
    """A whole frame as bytes."""
    header = bytearray(HEADER.size)
    parts = [memoryview(part).cast("B") for part in payload_parts]
    pack_header(header, kind, sequence, parts)
    return b"".join([header, *parts])


def unframe(data):
    """Checks one whole frame and returns (kind, sequence, payload)."""
    if len(data) < HEADER.size:
        raise WireError(f"a frame of {len(data)} bytes is shorter than its header")
    length, kind, reserved, sequence, crc = HEADER.unpack_from(data)
    payload = memoryview(data)[HEADER.size :]
    if reserved != 0 or length != len(payload):
        raise WireError(f"a frame of {len(payload)} payload bytes announces {length}")
    if zlib.crc32(payload, zlib.crc32(memoryview(data)[:HEADER_CHECKED])) != crc:
        raise WireError("a frame's checksum does not match")
    return kind, sequence, payload


class Link:
    """Reads requests from one file descriptor and writes replies to another."""

    def __init__(self, source, sink):
        self._source = source
        self._sink = sink
        self._header = bytearray(HEADER.size)

    def send_hello(self):
        self._write(hello())

    def receive_hello(self):
        return check_hello(self._read(HELLO.size))

    def receive(self):
        """Waits for the next request; a request nearly always arrives in one read."""
        header = self._read(HEADER.size)
        length = HEADER.unpack(header)[0]
        if length > MAX_PAYLOAD:
            raise WireError(f"a request of {length} bytes is over the limit of {MAX_PAYLOAD}")
        return unframe(header + self._read(length) if length else header)

    def send(self, kind, sequence, *payload_parts):
        """Sends a reply; the parts may be anything that has the buffer protocol."""
        parts = [memoryview(part).cast("B") for part in payload_parts]
        pack_header(self._header, kind, sequence, parts)
        self._write(b"".join([self._header, *parts]))

    def _read(self, count):
        data = os.read(self._source, count)
        while len(data) < count:
            more = os.read(self._source, count - len(data))
            if not more:
                raise Closed
            data += more
        return data

    def _write(self, data):
        view = memoryview(data)
        while view:
            view = view[os.write(self._sink, view) :]
