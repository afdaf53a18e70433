"""The numbers of the logs that are made here: eight episodes of different lengths, with full mantissas and without a jump."""

import numpy as np

LENGTHS = [21, 34, 27, 40, 18, 25, 30, 22]
CHANNELS = 4
COMMANDS = 2


def episodes(seed):
    """For each episode what was seen, what was done at each step, and what that was worth."""
    rng = np.random.default_rng(seed)
    made = []
    for steps in LENGTHS:
        made.append(
            {
                "observations": np.cumsum(rng.uniform(-0.1, 0.1, (steps + 1, CHANNELS)), axis=0) + rng.uniform(-1, 1, CHANNELS),
                "actions": rng.uniform(-1.5, 2.5, (steps, COMMANDS)),
                "rewards": rng.normal(size=steps),
            }
        )
    return made
