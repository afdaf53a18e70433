"""From where a task is looked at: one place for most of the 50, others where the arm or the thing itself stands in the way.

The robot stands at y = 0 behind the table's edge and reaches towards y = 1, z is up, and what is to be pressed, pulled or opened faces
the robot. So the camera stands on the robot's right and looks past its arm, down on the place where the hand works.
"""

from typing import NamedTuple


class Camera(NamedTuple):
    """A free camera of MuJoCo."""

    # What is in the middle, in metres.
    lookat: tuple = (0.05, 0.72, 0.15)
    # From there to the camera, in metres.
    distance: float = 1.2
    # The compass direction in which it looks, in degrees: 90 is along y, 180 against x.
    azimuth: float = 152.0
    # How far up it looks, in degrees: down is negative.
    elevation: float = -32.0


DEFAULT = Camera()

EXCEPTIONS = {
    # The ring, and the ball above it, are higher than most things.
    "basketball-v3": Camera(lookat=(0.05, 0.75, 0.2), distance=1.25),
    # The lever is as high as the hand.
    "lever-pull-v3": Camera(lookat=(0.0, 0.7, 0.2), distance=1.25),
    # The shelf is tall, and its side hides what is on it.
    "shelf-place-v3": Camera(lookat=(0.05, 0.75, 0.2), distance=1.3, azimuth=115.0, elevation=-22.0),
    # The goal is a net at the far edge, and the arm reaches over the ball.
    "soccer-v3": Camera(lookat=(0.1, 0.75, 0.05), distance=1.3, azimuth=125.0, elevation=-45.0),
    # What is pushed or pulled goes a long way towards the camera.
    "stick-pull-v3": Camera(lookat=(0.2, 0.6, 0.1), distance=1.4),
    "stick-push-v3": Camera(lookat=(0.2, 0.65, 0.1), distance=1.35),
    # The table's right edge is the goal, and the arm comes with the puck.
    "sweep-v3": Camera(lookat=(0.25, 0.7, 0.05), distance=1.35, azimuth=115.0, elevation=-42.0),
}


def camera_of(task):
    """The camera of a task; a scene of two intentions has that of most."""
    return EXCEPTIONS.get(task, DEFAULT)
