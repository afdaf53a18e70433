"""How fast the simulator steps inside this very process, to compare the bridge with.

    speed.py TASK STEPS

Prints two numbers, in seconds per step: for the environment that the worker steps, and for `gym.make("Meta-World/MT1")`
with its wrappers, which is what most people step.
"""

import sys
import time
import warnings

import gymnasium
import numpy as np

from task import Task

ACTION = np.array([0.1, -0.1, 0.1, 0.0], np.float32)


def seconds_per_step(reset, step, steps, horizon):
    """The time of the steps alone, in whole episodes and a rest."""
    spent = 0.0
    while steps > 0:
        reset()
        chunk = min(steps, horizon)
        begin = time.perf_counter()
        for _ in range(chunk):
            step(ACTION)
        spent += time.perf_counter() - begin
        steps -= chunk
    return spent


def main(name, steps):
    warnings.simplefilter("ignore")
    steps = int(steps)
    task = Task(name)
    bare = seconds_per_step(lambda: task.reset(1), task.step, steps, task.horizon) / steps
    wrapped = gymnasium.make("Meta-World/MT1", env_name=name)
    made = seconds_per_step(wrapped.reset, wrapped.step, steps, task.horizon) / steps
    print(bare, made)


if __name__ == "__main__":
    main(*sys.argv[1:])
