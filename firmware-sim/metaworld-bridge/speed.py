"""How fast the simulator steps inside this very process, to compare the bridge with.

    speed.py TASK STEPS

Prints the seconds per step of `gym.make("Meta-World/MT1")`, untouched.
"""

import sys
import time
import warnings

import gymnasium
import metaworld  # noqa: F401, registers the environments
import numpy as np

ACTION = np.array([0.1, -0.1, 0.1, 0.0], np.float32)


def main(name, steps):
    warnings.simplefilter("ignore")
    env = gymnasium.make("Meta-World/MT1", env_name=name)
    left = int(steps)
    spent = 0.0
    while left > 0:
        env.reset()
        chunk = min(left, env.unwrapped.max_path_length)
        begin = time.perf_counter()
        for _ in range(chunk):
            env.step(ACTION)
        spent += time.perf_counter() - begin
        left -= chunk
    print(spent / int(steps))


if __name__ == "__main__":
    main(*sys.argv[1:])
