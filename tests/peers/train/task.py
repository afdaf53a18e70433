"""What every peer trains on, and how it is asked to: the sizes and constants of ted-train's default, and turns over a pipe."""

import sys
import time

import numpy as np

OBSERVATION, ACTION, HIDDEN, BATCH, ROWS = 39, 4, 256, 256, 500_000
TAU, BETA, ADVANTAGE_CLIP, RATE, TARGET_RATE = 0.7, 3.0, 100.0, 3e-4, 0.005
LOG_STD = (-5.0, 2.0)
STEPS = 100_000


def transitions():
    """Observations (standardised already, which favours the peers), actions, rewards, discounts, next observations."""
    rng = np.random.default_rng(0)
    draw = lambda width: rng.standard_normal((ROWS, width), dtype=np.float32)
    actions = rng.uniform(-0.99, 0.99, (ROWS, ACTION)).astype(np.float32)
    rewards = rng.uniform(0, 1, ROWS).astype(np.float32)
    return draw(OBSERVATION), actions, rewards, np.full(ROWS, 0.99, np.float32), draw(OBSERVATION)


def layer_sizes(inputs, outputs):
    return [(inputs, HIDDEN), (HIDDEN, HIDDEN), (HIDDEN, outputs)]


def serve(run):
    """Answers every line on standard input, a number of updates, with the seconds that `run` takes for them."""
    for line in sys.stdin:
        updates = int(line)
        begin = time.perf_counter()
        run(updates)
        print(time.perf_counter() - begin, flush=True)
