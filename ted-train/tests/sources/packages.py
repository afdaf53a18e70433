"""What minari itself writes in its two storages, and what it reads from them. Its collector ends in the same call, and drags jax in."""

import os

import minari
import numpy as np
from gymnasium.spaces import Box
from minari.data_collector import EpisodeBuffer

from numbers_made import CHANNELS, COMMANDS, episodes


def arrow(folder):
    return written(folder, "arrow")


def hdf5(folder):
    return written(folder, "hdf5")


def written(folder, data_format):
    """Three episodes terminate, and the third of these is cut at its last step as well; the others are cut."""
    os.environ["MINARI_DATASETS_PATH"] = str(folder)
    buffers = []
    for number, one in enumerate(episodes(4)):
        last = np.arange(len(one["actions"])) == len(one["actions"]) - 1
        buffers.append(
            EpisodeBuffer(
                id=number,
                seed=number,
                observations=one["observations"],
                actions=one["actions"].astype(np.float32),
                rewards=list(one["rewards"]),
                terminations=list(last & (number < 3)),
                truncations=list(last & (number > 1)),
                infos={},
            )
        )
    name = f"robot/{data_format}-v0"
    minari.create_dataset_from_buffers(
        name,
        buffers,
        observation_space=Box(-np.inf, np.inf, (CHANNELS,), np.float64),
        action_space=Box(-2, 3, (COMMANDS,), np.float32),
        data_format=data_format,
        algorithm_name="random",
        author="a test",
        code_permalink="none",
        description="A log of nothing.",
    )
    keys = ("observations", "actions", "rewards", "terminations", "truncations")
    read = minari.load_dataset(name).iterate_episodes()
    return folder / name, [], [{key: getattr(episode, key) for key in keys} for episode in read]
