"""Which fault a session answers with, and what it does to the episode. Needs the simulator's packages."""

import struct
import unittest

import messages
import wire
from session import Session


class Stopped(Exception):
    """There are no more requests."""


class Requests:
    """A link with a list of requests, which keeps the replies."""

    def __init__(self, requests):
        self._requests = iter(requests)
        self.replies = []

    def receive(self):
        try:
            kind, payload = next(self._requests)
        except StopIteration:
            raise Stopped from None
        return kind, 1, payload

    def send(self, kind, sequence, *parts):
        _, _, payload = wire.unframe(wire.frame(kind, sequence, *parts))
        self.replies.append((kind, bytes(payload)))


class Broken:
    """A task whose simulator fails with the very errors that a bad payload gives."""

    name = "broken"
    horizon = 500

    def __init__(self, error):
        self._error = error

    def reset(self, seed):
        raise self._error

    def step(self, action):
        raise self._error


def faults(session, link):
    """Serves all requests; (code, text) of each reply, which has to be a fault."""
    try:
        session.serve()
    except Stopped:
        pass
    read = []
    for kind, payload in link.replies:
        assert kind == messages.FAULT, kind
        read.append((messages.FAULT_CODE.unpack_from(payload)[0], messages.read_text(payload[2:])))
    return read


ACTION = struct.pack("<4f", 0, 0, 0, 0)


class Faults(unittest.TestCase):
    def test_an_error_of_the_simulator_is_one_whatever_its_type(self):
        for error in [ValueError("of numpy"), struct.error("of struct"), UnicodeError("of text"), RuntimeError("of any kind")]:
            for request in [(messages.RESET, messages.RESET_REQUEST.pack(1)), (messages.STEP, ACTION)]:
                with self.subTest(f"{error!r} {request[0]}"):
                    link = Requests([request])
                    session = Session(link)
                    session._task, session._in_episode = Broken(error), True
                    ((code, text),) = faults(session, link)
                    self.assertEqual(code, messages.SIMULATOR)
                    self.assertTrue(text.endswith(f"{error}") and "Traceback" in text, text)
                    self.assertFalse(session._in_episode)

    def test_a_payload_of_another_layout_is_a_bad_request_that_ends_the_episode(self):
        for kind, payload in [
            (messages.OPEN, b"\x05\x00"),
            (messages.OPEN, b"\x01\x00\xff"),
            (messages.RESET, b"short"),
            (messages.STEP, ACTION[:-1]),
            (messages.STEP, ACTION[:-4]),
            (messages.COLLECT, b""),
        ]:
            with self.subTest(f"{kind} {payload}"):
                link = Requests([(kind, payload)])
                session = Session(link)
                session._task, session._in_episode = Broken(AssertionError("it is not reached")), True
                ((code, _),) = faults(session, link)
                self.assertEqual(code, messages.BAD_REQUEST)
                self.assertFalse(session._in_episode)

    def test_a_refusal_leaves_the_episode_as_it_is(self):
        for request, expected in [
            ((0x55, b""), messages.BAD_REQUEST),
            ((messages.OPEN, messages.text("no-such-task")), messages.UNKNOWN_TASK),
        ]:
            link = Requests([request])
            session = Session(link)
            session._task, session._in_episode = Broken(AssertionError("it is not reached")), True
            ((code, _),) = faults(session, link)
            self.assertEqual(code, expected)
            self.assertTrue(session._in_episode)


if __name__ == "__main__":
    unittest.main()
