"""Pictures of recorded states, on machines without a screen: by EGL, or by OSMesa where there is none.

This is not imported before a picture is asked for, and a picture is made of an environment of its own, with everything to
look at in its model: who only plays pays nothing, and what is played has the same bits afterwards.
"""

import atexit
import functools
import importlib
import io
import os
import pathlib
import subprocess
import sys

import mujoco
import numpy as np
from PIL import Image

from cameras import camera_of

# In the order in which they are tried: the first one can use a GPU.
WAYS = ("cgl",) if sys.platform == "darwin" else ("egl", "osmesa")
REMEDY = "on Debian and Ubuntu: apt install libosmesa6, or with a GPU libegl1 and libopengl0"

# Seconds after which a way is given up: all of them together have to be done before the parent gives the worker up.
PATIENCE = 40

FOLDER = str(pathlib.Path(__file__).resolve().parent)

# Far more than any scene of Meta-World has.
GEOMS = 1000

# The looks that take most of the time where a processor draws: a shadow takes three times as long as all the rest.
LEFT_OUT = [
    mujoco.mjtRndFlag.mjRND_SHADOW,
    mujoco.mjtRndFlag.mjRND_REFLECTION,
    mujoco.mjtRndFlag.mjRND_HAZE,
    mujoco.mjtRndFlag.mjRND_FOG,
]


class NoPictures(Exception):
    """No picture can be made on this machine; the text says why, and what helps."""


@functools.cache
def open_way():
    """Makes a context to draw in, for the rest of the process, and returns the name of the way."""
    reasons = []
    for way in WAYS:
        reason = trouble_with(way)
        if reason is None:
            # Before the way closes its display, which it does at the end too.
            atexit.register(made(way).free)
            return way
        reasons.append(f"{way}: {reason}")
    raise NoPictures(f"nothing here draws without a screen ({'; '.join(reasons)}); {REMEDY}")


def trouble_with(way):
    """Why a way does not work; none if it does. It is tried in another process: what a library that fails leaves behind stands in the
    way of the next one, and some drivers end the process."""
    code = f"import sys; sys.path.insert(0, {FOLDER!r}); import render; print(render.trouble_here({way!r}))"
    try:
        tried = subprocess.run(
            [sys.executable, "-Es", "-c", code],
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            errors="replace",
            timeout=PATIENCE,
        )
    except subprocess.TimeoutExpired:
        return f"it gave no answer in {PATIENCE} s"
    if tried.returncode != 0:
        return f"it ended with status {tried.returncode}"
    return tried.stdout.strip() or None


def trouble_here(way):
    """The same of this process, as one line, empty if there is none."""
    try:
        made(way)
    except Exception as error:  # Whatever a library that is missing or half there raises.
        return " ".join(f"{error}".split())
    return ""


def made(way):
    """A context of this way, made current."""
    # MuJoCo reads the variable when it loads OpenGL. PyOpenGL chooses a library when it is imported, and Gymnasium has imported it.
    os.environ["MUJOCO_GL"] = way
    os.environ.pop("PYOPENGL_PLATFORM", None)
    # Mesa would keep what it compiles in the folder of the user's caches, and nobody asked for anything there.
    os.environ.setdefault("MESA_SHADER_CACHE_DISABLE", "true")
    for name in [name for name in sys.modules if name.partition(".")[0] == "OpenGL"]:
        del sys.modules[name]
    try:
        module = importlib.import_module(f"mujoco.{way}")
    except AttributeError as error:
        # What PyOpenGL comes to where it finds no library.
        raise ImportError("its library cannot be loaded") from error
    context = module.GLContext(1, 1)
    context.make_current()
    return context


class Painter:
    """Draws states of one task."""

    def __init__(self, task):
        """`task` is this painter's own, with everything to look at in its model; a context must be current."""
        self.name = task.name
        self._task = task
        self._seed, self._marks = None, []
        self._model, self._data = task.env.model, task.env.data
        quality = self._model.vis.quality
        quality.shadowsize = quality.offsamples = 0
        if task.purposes > 1:
            # Nobody is told what is wanted, so nobody is shown it.
            self._model.site_rgba[:, 3] = 0
        self._scene = mujoco.MjvScene(self._model, maxgeom=GEOMS)
        for flag in LEFT_OUT:
            self._scene.flags[flag] = 0
        self._option = mujoco.MjvOption()
        self._camera = mujoco.MjvCamera()
        self._camera.type = mujoco.mjtCamera.mjCAMERA_FREE
        place = camera_of(task.name)
        self._camera.lookat[:] = place.lookat
        self._camera.distance, self._camera.azimuth, self._camera.elevation = place[1:]
        self._context = mujoco.MjrContext(self._model, mujoco.mjtFontScale.mjFONTSCALE_100.value)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, self._context)
        # The first picture takes as long as many: what draws is compiled for it.
        data = self._data
        self.pictures(0, 64, 48, 80, [data.qpos.copy()], [data.mocap_pos.copy()], [data.mocap_quat.copy()])

    def pictures(self, seed, width, height, quality, qpos, mocap_pos, mocap_quat):
        """A JPEG of each state of the episode of this seed, whose fixed things stand where they stood."""
        if seed != self._seed:
            self._task.reset(seed)
            self._marks = self._task.marks()
            self._seed = seed
        if (self._context.offWidth, self._context.offHeight) != (width, height):
            mujoco.mjr_resizeOffscreen(width, height, self._context)
        rectangle = mujoco.MjrRect(0, 0, width, height)
        pixels = np.empty((height, width, 3), np.uint8)
        return [self._picture(rectangle, pixels, quality, *state) for state in zip(qpos, mocap_pos, mocap_quat, strict=True)]

    def _picture(self, rectangle, pixels, quality, qpos, mocap_pos, mocap_quat):
        model, data = self._model, self._data
        data.qpos[:] = qpos
        data.qvel[:] = 0
        data.mocap_pos[:] = mocap_pos
        data.mocap_quat[:] = mocap_quat
        mujoco.mj_forward(model, data)
        # Marks of the goal have no body: the package puts them in their place at every step.
        for name, place in self._marks:
            data.site(name).xpos[:] = place[:3]
        every = mujoco.mjtCatBit.mjCAT_ALL.value
        mujoco.mjv_updateScene(model, data, self._option, None, self._camera, every, self._scene)
        mujoco.mjr_render(rectangle, self._scene, self._context)
        mujoco.mjr_readPixels(pixels, None, rectangle, self._context)
        file = io.BytesIO()
        # OpenGL counts rows from below.
        Image.fromarray(pixels[::-1]).save(file, "JPEG", quality=quality)
        return file.getvalue()
