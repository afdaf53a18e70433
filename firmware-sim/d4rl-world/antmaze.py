"""AntMaze, as D4RL's version 2 evaluates it: an ant walks from one corner of a maze to another.

Built from the ant of gymnasium and D4RL's numbers: motors of 30 N m, 10 actions a second, and a maze in which the ant starts at the origin
and rows go up. The AntMaze of gymnasium-robotics has another ant (motors of 150 N m, 20 actions a second), the maze the other way up and the
origin in its middle: a policy of D4RL's files is lost there.
"""

import pathlib
import xml.etree.ElementTree as ET

import gymnasium.envs.mujoco
import mujoco
import numpy

# W is a wall, S where the ant starts, G where it is to go.
MAZES = {
    "antmaze-umaze": ("WWWWW", "WS..W", "WWW.W", "WG..W", "WWWWW"),
    "antmaze-medium": ("WWWWWWWW", "WS.WW..W", "W..W...W", "WW...WWW", "W..W...W", "W.W..W.W", "W...W.GW", "WWWWWWWW"),
    "antmaze-large": (
        "WWWWWWWWWWWW",
        "WS...W.....W",
        "W.WW.W.W.W.W",
        "W......W...W",
        "W.WWWW.WWW.W",
        "W..W.W.....W",
        "WW.W.W.W.WWW",
        "W..W...W.G.W",
        "WWWWWWWWWWWW",
    ),
}
# Metres.
CELL = 4.0
WALL = 2.0
# The goal is drawn within this much of its cell's middle, as the sum of two uniform numbers; so near counts as reached.
GOAL_SPREADS = (1.0, 0.5)
NEAR = 0.5
TORQUE = 30.0
SUBSTEPS = 5
SUBSTEP_S = 0.02
# Uniform in positions, normal in velocities.
START_NOISE = 0.1


class Ant:
    """One ant in one maze."""

    def __init__(self, model):
        self.model = model
        self.data = mujoco.MjData(model)
        self.goal = numpy.zeros(2)


class AntMaze:
    actions = 8
    period_us = round(1e6 * SUBSTEPS * SUBSTEP_S)

    def __init__(self, task):
        maze = MAZES[task]
        self.steps = 700 if task == "antmaze-umaze" else 1000
        (start,) = cells(maze, "S")
        (goal,) = cells(maze, "G")
        self._goal = goal - start
        self._model = mujoco.MjModel.from_xml_string(model([cell - start for cell in cells(maze, "W")]))
        self.versions = {"gymnasium": gymnasium.__version__, "mujoco": mujoco.__version__, "numpy": numpy.__version__}

    def make(self):
        return Ant(self._model)

    def reset(self, ant, seed):
        chance = numpy.random.default_rng(seed)
        ant.goal = self._goal + sum(chance.uniform(0, spread, 2) for spread in GOAL_SPREADS)
        mujoco.mj_resetData(ant.model, ant.data)
        ant.data.qpos[:] += chance.uniform(-START_NOISE, START_NOISE, ant.model.nq)
        ant.data.qvel[:] = START_NOISE * chance.standard_normal(ant.model.nv)
        mujoco.mj_forward(ant.model, ant.data)
        return seen(ant)

    def step(self, ant, action):
        ant.data.ctrl[:] = TORQUE * numpy.clip(action, -1, 1)
        mujoco.mj_step(ant.model, ant.data, SUBSTEPS)
        reached = bool(numpy.linalg.norm(ant.data.qpos[:2] - ant.goal) <= NEAR)
        return seen(ant), float(reached), reached, reached


def seen(ant):
    return numpy.concatenate([ant.data.qpos, ant.data.qvel])


def cells(maze, kind):
    """The middles of the cells of a kind: x from left to right, y from the first row to the last."""
    return [CELL * numpy.array([column, row], float) for row, line in enumerate(maze) for column, found in enumerate(line) if found == kind]


def model(walls):
    """gymnasium's ant between walls, with D4RL's motors, time step and contacts, as XML."""
    ant = ET.parse(pathlib.Path(gymnasium.envs.mujoco.__file__).parent / "assets" / "ant.xml")
    ant.find("option").set("timestep", str(SUBSTEP_S))
    for name, value in (("solref", ".02 1"), ("solimp", ".8 .8 .01")):
        ant.find("default/geom").set(name, value)
    for motor in ant.find("actuator"):
        motor.set("ctrlrange", f"{-TORQUE} {TORQUE}")
        motor.set("gear", "1")
    for number, (x, y) in enumerate(walls):
        place = {"pos": f"{x} {y} {WALL / 2}", "size": f"{CELL / 2} {CELL / 2} {WALL / 2}"}
        ET.SubElement(ant.find("worldbody"), "geom", name=f"wall_{number}", type="box", contype="1", conaffinity="1", **place)
    return ET.tostring(ant.getroot(), encoding="unicode")
