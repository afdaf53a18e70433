"""The worker of D4RL's locomotion tasks: `d4rl_worker.py TASK`, driven over stdin and stdout as every worker is.

docs/bridge-protocol.md says what goes over the wire.
"""

import sys

import own_worker
import wire


def world(task):
    if task.startswith("antmaze-"):
        from antmaze import AntMaze

        return AntMaze(task)
    from locomotion import Locomotion

    return Locomotion(task)


if __name__ == "__main__":
    try:
        own_worker.play(lambda: world(sys.argv[1]), "d4rl")
    except wire.Closed:
        pass
