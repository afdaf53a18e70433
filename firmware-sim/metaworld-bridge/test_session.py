"""Which fault a session answers with, and what it does to the episode. Needs the simulator's packages."""

import struct
import unittest

import messages
import wire
from collect import Behaviour, collect
from session import Session
from task import Task


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
    purposes = 1

    def __init__(self, error):
        self._error = error

    def reset(self, seed):
        raise self._error

    def step(self, action):
        raise self._error


def broken(link, error):
    """A session with two running episodes of a task that fails with this error."""
    session = Session(link, "reference")
    session._tasks = {0: Broken(error), 3: Broken(error)}
    session._running = {0, 3}
    return session


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


def recording(steps=20, drift_std=0.0, drift_correlation=0.0, purpose=0):
    """The payload of a COLLECT."""
    return messages.COLLECT_REQUEST.pack(7, steps, 0.8, 0.0, 0.0, 0.0, 0.0, 0.0, drift_std, drift_correlation, purpose)


ACTION = struct.pack("<H4f", 0, 0, 0, 0, 0)


class Faults(unittest.TestCase):
    def test_an_error_of_the_simulator_is_one_whatever_its_type(self):
        for error in [ValueError("of numpy"), struct.error("of struct"), UnicodeError("of text"), RuntimeError("of any kind")]:
            for request in [(messages.RESET, messages.RESET_REQUEST.pack(0, 1)), (messages.STEP, ACTION)]:
                with self.subTest(f"{error!r} {request[0]}"):
                    link = Requests([request])
                    session = broken(link, error)
                    ((code, text),) = faults(session, link)
                    self.assertEqual(code, messages.SIMULATOR)
                    self.assertTrue(text.endswith(f"{error}") and "Traceback" in text, text)
                    self.assertFalse(session._running)

    def test_a_payload_of_another_layout_is_a_bad_request_that_ends_the_episode(self):
        for kind, payload in [
            (messages.OPEN, b"\x05\x00"),
            (messages.OPEN, b"\x01\x00\xff"),
            (messages.RESET, b"short"),
            (messages.STEP, ACTION[:-1]),
            (messages.STEP, ACTION[:-4]),
            (messages.STEP, b""),
            (messages.STEP, ACTION + ACTION),
            (messages.RESET, messages.RESET_REQUEST.pack(messages.SLOTS, 1)),
            (messages.COLLECT, b""),
            (messages.COLLECT, recording(drift_std=-0.1)),
            (messages.COLLECT, recording(drift_std=float("nan"))),
            (messages.COLLECT, recording(drift_correlation=1.5)),
            (messages.COLLECT, recording(purpose=1)),
            (messages.COLLECT, recording(steps=501)),
        ]:
            with self.subTest(f"{kind} {payload}"):
                link = Requests([(kind, payload)])
                session = broken(link, AssertionError("it is not reached"))
                ((code, _),) = faults(session, link)
                self.assertEqual(code, messages.BAD_REQUEST)
                self.assertFalse(session._running)

    def test_a_refusal_leaves_the_episode_as_it_is(self):
        for request, expected in [
            ((0x55, b""), messages.BAD_REQUEST),
            ((messages.OPEN, messages.text("no-such-task")), messages.UNKNOWN_TASK),
            ((messages.STEP, ACTION + b"\x01" + ACTION[1:]), messages.NO_EPISODE),
        ]:
            link = Requests([request])
            session = broken(link, AssertionError("it is not reached"))
            ((code, _),) = faults(session, link)
            self.assertEqual(code, expected)
            self.assertEqual(session._running, {0, 3})


class SideBySide(unittest.TestCase):
    def test_episodes_in_slots_are_those_that_are_played_alone(self):
        def step(*moves):
            return (messages.STEP, b"".join(struct.pack("<H4f", slot, *[value] * 4) for slot, value in moves))

        def reset(slot, seed):
            return (messages.RESET, messages.RESET_REQUEST.pack(slot, seed))

        def replies(engine, requests):
            link = Requests([(messages.OPEN, messages.text("push-v3")), *requests])
            with self.assertRaises(Stopped):
                Session(link, engine).serve()
            return [payload for _, payload in link.replies[1:]]

        together = replies("fast", [reset(0, 5), reset(7, 6), step((7, 0.5), (0, -0.5)), step((0, 0.1)), step((0, 1), (7, 1))])
        one = replies("reference", [reset(0, 5), step((0, -0.5)), step((0, 0.1)), step((0, 1))])
        other = replies("reference", [reset(0, 6), step((0, 0.5)), step((0, 1))])
        self.assertEqual(together, [one[0], other[0], other[1] + one[1], one[2], one[3] + other[2]])

    def test_the_state_of_an_episode_is_the_one_that_its_collection_records(self):
        record = collect(Task("drawer-open-v3"), 7, 3, Behaviour(0.8, 0.5))
        state = (messages.STATE, messages.STATE_REQUEST.pack(2))
        steps = [(messages.STEP, struct.pack("<H", 2) + action.tobytes()) for action in record.actions]
        requests = [step_or_state for step in steps for step_or_state in (step, state)]
        for engine in ["fast", "reference"]:
            link = Requests([(messages.OPEN, messages.text("drawer-open-v3")), state, (messages.RESET, messages.RESET_REQUEST.pack(2, 7)), state, *requests])
            with self.assertRaises(Stopped):
                Session(link, engine).serve()
            (kind, fault), *_ = link.replies[1:]
            self.assertEqual((kind, messages.FAULT_CODE.unpack_from(fault)[0]), (messages.FAULT, messages.NO_EPISODE))
            said = [payload for kind, payload in link.replies if kind == messages.STATED]
            rows = zip(record.qpos, record.mocap_pos, record.mocap_quat, strict=True)
            self.assertEqual(said, [b"".join(array.tobytes() for array in row) for row in rows])



if __name__ == "__main__":
    unittest.main()
