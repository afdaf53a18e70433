"""Makes a small log with the library that people write such logs with, and prints what that library reads from it.

    make.py KIND FOLDER     prints {source, options, episodes}: what `ted import` is told, and every array of every episode, to the bit

Arrays are printed as {dtype, shape, hex}, in the types that a dataset keeps. Nothing here knows the reader that is tested.
"""

import json
import pathlib
import sys
import warnings

import numpy as np

import bags
import folders
import hdf5
import packages
import tables

KINDS = {
    "d4rl": hdf5.d4rl,
    "robomimic": hdf5.robomimic,
    "lerobot-2": folders.lerobot_2,
    "lerobot-3": folders.lerobot_3,
    "minari-arrow": packages.arrow,
    "minari-hdf5": packages.hdf5,
    "npz": tables.npz,
    "csv": tables.comma_separated,
    "jsonl": tables.json_lines,
    "mcap": bags.mcap,
    "rosbag2-sqlite3": bags.sqlite3,
    "rosbag2-mcap": bags.mcap_storage,
}


def encoded(values, dtype):
    array = np.ascontiguousarray(values, dtype)
    return {"dtype": array.dtype.str, "shape": list(array.shape), "hex": array.tobytes().hex()}


def printed(episode):
    """Rewards of 0 where the source has none, no termination where it knows of none, and an end for every episode."""
    steps = len(episode["actions"])
    terminations = np.array(episode.get("terminations", np.zeros(steps)), bool)
    truncations = np.array(episode.get("truncations", np.zeros(steps)), bool)
    truncations[-1] |= not terminations[-1]
    return {
        "observations": encoded(episode["observations"], "<f4"),
        "actions": encoded(episode["actions"], "<f4"),
        "rewards": encoded(episode.get("rewards", np.zeros(steps)), "<f8"),
        "terminations": encoded(terminations, "|b1"),
        "truncations": encoded(truncations, "|b1"),
    }


kind, folder = sys.argv[1:]
warnings.simplefilter("ignore")
source, options, episodes = KINDS[kind](pathlib.Path(folder))
json.dump({"source": str(source), "options": options, "episodes": [printed(episode) for episode in episodes]}, sys.stdout)
