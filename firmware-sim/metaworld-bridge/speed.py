"""How fast the simulator steps inside this very process, to compare the bridge with.

    speed.py TASK STEPS ENGINE

Prints the seconds per step of `gym.make("Meta-World/MT1")`, untouched, and of the task that a worker steps.
"""

import sys
import time
import warnings

import gymnasium
import metaworld  # noqa: F401, registers the environments
import numpy as np

from parent import leave_with_parent
from session import ENGINES

ACTION = np.array([0.1, -0.1, 0.1, 0.0], np.float32)


def main(name, steps, engine):
    leave_with_parent(0)
    warnings.simplefilter("ignore")
    package = gymnasium.make("Meta-World/MT1", env_name=name)
    task = ENGINES[engine](name)
    untouched = seconds_per_step(package.reset, package.step, task.horizon, int(steps))
    quickened = seconds_per_step(lambda: task.reset(1), task.step, task.horizon, int(steps))
    print(untouched, quickened)


def seconds_per_step(reset, step, horizon, steps):
    left = steps
    spent = 0.0
    while left > 0:
        reset()
        chunk = min(left, horizon)
        begin = time.perf_counter()
        for _ in range(chunk):
            step(ACTION)
        spent += time.perf_counter() - begin
        left -= chunk
    return spent / steps


if __name__ == "__main__":
    main(*sys.argv[1:])
