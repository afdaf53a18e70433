"""Pictures of states: what is in them, what is refused, and that they leave no trace in what is played. Needs the simulator's
packages and a way to draw without a screen (Debian: libosmesa6 or libegl1)."""

import io
import os
import struct
import subprocess
import sys
import unittest

import numpy as np
from PIL import Image

import messages
from session import Session
from task import Task
from test_session import Requests, Stopped

FOLDER = os.path.dirname(os.path.abspath(__file__))
# As the parent starts a worker.
PLAYING = {**os.environ, "MUJOCO_GL": "disable"}


def served(requests, engine="fast"):
    """All replies of a session, as (kind, payload)."""
    link = Requests(requests)
    try:
        Session(link, engine).serve()
    except Stopped:
        pass
    return link.replies


def request(seed, states, width=64, height=48, quality=80):
    """A RENDER of some states, each a (qpos, mocap positions, mocap quaternions)."""
    head = messages.RENDER_REQUEST.pack(seed, width, height, quality, len(states))
    return messages.RENDER, head + b"".join(np.array(rows, "<f8").tobytes() for rows in zip(*states, strict=True))


def pictures(payload):
    """The way and the decoded pictures of a RENDERED."""
    (length,) = struct.unpack_from("<H", payload)
    way, at, found = payload[2 : 2 + length].decode(), 2 + length, []
    while at < len(payload):
        (size,) = messages.PICTURE_BYTES.unpack_from(payload, at)
        at += messages.PICTURE_BYTES.size
        found.append(np.asarray(Image.open(io.BytesIO(payload[at : at + size]))).astype(int))
        at += size
    return way, found


def played(name, seed=3, steps=60):
    """The first and the last state of an episode of the scripted policy."""
    task = Task(name)
    policy = task.scripted_policy()
    observation = task.reset(seed)

    def state():
        data = task.env.data
        return data.qpos.copy(), data.mocap_pos.copy(), data.mocap_quat.copy()

    states = [state()]
    for _ in range(steps):
        observation, *_ = task.step(np.clip(policy(observation), -1, 1).astype(np.float32))
    return [*states, state()]


def opened(name):
    return messages.OPEN, messages.text(name)


class Pictures(unittest.TestCase):
    def test_a_picture_shows_something_and_another_state_looks_different(self):
        states = played("drawer-open-v3")
        _, (kind, payload), again = served([opened("drawer-open-v3"), request(3, states), request(3, states)])
        self.assertEqual(kind, messages.RENDERED)
        way, (first, last) = pictures(payload)
        self.assertIn(way, ["egl", "osmesa"])
        self.assertEqual(first.shape, (48, 64, 3))
        self.assertGreater(first.std(), 10)
        self.assertGreater(np.abs(first - last).mean(), 1)
        self.assertEqual(payload, again[1])

    def test_the_size_is_the_request_s(self):
        states = played("reach-v3", steps=1)[:1]
        sizes = [(64, 48), (160, 90), (32, 32)]
        asked = [request(3, states, *size) for size in sizes]
        for size, (_, payload) in zip(sizes, served([opened("reach-v3"), *asked])[1:], strict=True):
            self.assertEqual(pictures(payload)[1][0].shape, (size[1], size[0], 3))

    def test_what_is_fixed_for_an_episode_stands_where_its_seed_put_it(self):
        # The window is a body that the task moves at the start; no joint says where it is.
        states = played("window-open-v3", steps=1)[:1]
        one, other = served([opened("window-open-v3"), request(3, states), request(4, states)])[1:]
        (one,), (other,) = pictures(one[1])[1], pictures(other[1])[1]
        self.assertGreater(np.abs(one - other).mean(), 1)

    def test_a_task_of_two_intentions_shows_neither(self):
        name = "push-left_push-right"
        state = played("push-v3", steps=1)[:1]
        first, second = (served([opened(f"{name}_{judge}"), request(3, state)])[1] for judge in ["first", "second"])
        self.assertEqual(first, second)

    def test_no_states_ask_only_for_the_way(self):
        _, (kind, payload) = served([opened("reach-v3"), (messages.RENDER, messages.RENDER_REQUEST.pack(0, 64, 48, 80, 0))])
        self.assertEqual(kind, messages.RENDERED)
        self.assertEqual(pictures(payload)[1], [])


class NoTrace(unittest.TestCase):
    def test_what_is_played_after_a_picture_and_around_it_has_the_same_bits(self):
        seed, record = 11, messages.COLLECT_REQUEST.pack(7, 60, 0.8, 0.5, 0, 0, 0, 0, 0, 0, 0)
        step = (messages.STEP, struct.pack("<H4f", 0, 0.3, -0.2, 0.9, 1.0))
        reset = (messages.RESET, messages.RESET_REQUEST.pack(0, seed))
        picture = request(seed, played("drawer-open-v3"))
        for engine in ["fast", "reference"]:
            plain = served([opened("drawer-open-v3"), reset, step, step, (messages.COLLECT, record)], engine)
            shown = served(
                [opened("drawer-open-v3"), picture, reset, step, picture, step, picture, (messages.COLLECT, record)], engine
            )
            self.assertEqual(plain, [reply for reply in shown if reply[0] != messages.RENDERED])

    def test_who_only_plays_loads_nothing_that_draws(self):
        code = "import sys, session; print({'render', 'mujoco.egl', 'mujoco.osmesa'} & sys.modules.keys())"
        self.assertEqual(subprocess.check_output([sys.executable, "-c", code], cwd=FOLDER, env=PLAYING, text=True).strip(), "set()")


class Refusals(unittest.TestCase):
    def test_what_makes_no_sense_is_a_bad_request(self):
        state = played("reach-v3", steps=1)[:1]
        kind, good = request(3, state)
        head = messages.RENDER_REQUEST
        for payload in [
            b"",
            good[:-1],
            good[:-8],
            good + bytes(8),
            head.pack(3, 0, 48, 80, 0),
            head.pack(3, 64, 5000, 80, 0),
            head.pack(3, 64, 48, 0, 0),
            head.pack(3, 64, 48, 101, 0),
            head.pack(3, 64, 48, 80, 2**32 - 1),
        ]:
            _, (answer, text) = served([opened("reach-v3"), (kind, payload)])
            self.assertEqual((answer, messages.FAULT_CODE.unpack_from(text)[0]), (messages.FAULT, messages.BAD_REQUEST))

    def test_where_no_way_works_it_says_which_package_helps_and_serves_on(self):
        import render

        ways, open_way = render.WAYS, render.open_way
        render.WAYS, render.open_way = ("no_such_way",), open_way.__wrapped__
        try:
            _, (kind, fault), (after, _) = served(
                [opened("reach-v3"), request(3, played("reach-v3", steps=1)), (messages.RESET, messages.RESET_REQUEST.pack(0, 1))]
            )
        finally:
            render.WAYS, render.open_way = ways, open_way
        self.assertEqual((kind, messages.FAULT_CODE.unpack_from(fault)[0]), (messages.FAULT, messages.NO_PICTURES))
        self.assertIn("apt install libosmesa6", messages.read_text(fault[2:]))
        self.assertEqual(after, messages.RESETTED)

    def test_a_way_that_gives_no_answer_is_given_up(self):
        import render

        patience, render.PATIENCE = render.PATIENCE, 0.01
        try:
            self.assertEqual(render.trouble_with(render.WAYS[0]), "it gave no answer in 0.01 s")
        finally:
            render.PATIENCE = patience

    def test_a_picture_needs_an_open_task(self):
        ((kind, fault),) = served([(messages.RENDER, b"")])
        self.assertEqual((kind, messages.FAULT_CODE.unpack_from(fault)[0]), (messages.FAULT, messages.NO_EPISODE))


class Cameras(unittest.TestCase):
    def test_every_exception_is_of_a_task_that_there_is(self):
        from metaworld.env_dict import ALL_V3_ENVIRONMENTS

        from cameras import EXCEPTIONS

        self.assertLessEqual(EXCEPTIONS.keys(), ALL_V3_ENVIRONMENTS.keys())


if __name__ == "__main__":
    unittest.main()
