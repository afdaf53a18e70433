"""Opens or writes a dataset with the real minari package and prints every array of it, to the bit, as JSON.

    arrays.py read DATASET_ID       open it and print it
    arrays.py write DATASET_ID      write one with minari's own writer, then print it

The datasets lie under $MINARI_DATASETS_PATH. Arrays are printed as {dtype, shape, hex}, little-endian.
"""

import json
import sys
import warnings

import gymnasium
import minari
import numpy as np
from minari.data_collector import EpisodeBuffer


def encoded(array):
    array = np.ascontiguousarray(array)
    return {"dtype": array.dtype.str, "shape": list(array.shape), "hex": array.tobytes().hex()}


def contents(dataset_id):
    # Whatever minari has to complain about the dataset counts as a failure.
    warnings.simplefilter("error")
    listed = minari.list_local_datasets()
    dataset = minari.load_dataset(dataset_id)
    metadata = list(dataset.storage.get_episode_metadata(dataset.episode_indices))
    episodes = [
        {
            "id": int(episode.id),
            "seed": about.get("seed"),
            "arrays": {
                "observations": encoded(episode.observations),
                "actions": encoded(episode.actions),
                "rewards": encoded(episode.rewards),
                "terminations": encoded(episode.terminations),
                "truncations": encoded(episode.truncations),
            },
            "infos": {name: encoded(values) for name, values in episode.infos.items()},
            "in_space": all(row in dataset.observation_space for row in episode.observations)
            and all(row in dataset.action_space for row in episode.actions),
        }
        for episode, about in zip(dataset.iterate_episodes(), metadata, strict=True)
    ]
    return {
        "listed": sorted(listed),
        "id": dataset.spec.dataset_id,
        "minari_version": dataset.spec.minari_version,
        "total_steps": int(dataset.total_steps),
        "observation_space": repr(dataset.observation_space.shape) + str(dataset.observation_space.dtype),
        "action_space": repr(dataset.action_space.shape) + str(dataset.action_space.dtype),
        "sampled": len(dataset.sample_episodes(2)),
        "episodes": episodes,
    }


def write(dataset_id):
    """Three episodes with float64 observations, one that terminates, and infos of several kinds."""
    warnings.simplefilter("ignore")
    rng = np.random.default_rng(5)
    buffers = []
    for index, steps in enumerate([5, 8, 3]):
        ends = [False] * (steps - 1) + [True]
        goes_on = [False] * steps
        buffers.append(
            EpisodeBuffer(
                id=index,
                seed=100 + index,
                observations=rng.normal(size=(steps + 1, 6)),
                actions=rng.uniform(-1, 1, size=(steps, 2)).astype(np.float32),
                rewards=list(rng.normal(size=steps)),
                terminations=ends if index == 1 else goes_on,
                truncations=goes_on if index == 1 else ends,
                infos={
                    "success": [False] * steps + [index != 2],
                    "qpos": rng.normal(size=(steps + 1, 3)),
                    "note": ["text"] * (steps + 1),
                },
            )
        )
    minari.create_dataset_from_buffers(
        dataset_id,
        buffers,
        observation_space=gymnasium.spaces.Box(-np.inf, np.inf, (6,), np.float64),
        action_space=gymnasium.spaces.Box(-1, 1, (2,), np.float32),
        data_format="arrow",
        algorithm_name="random",
        author="a test",
        code_permalink="none",
        description="A dataset by minari's own writer.",
    )


command, name = sys.argv[1:]
if command == "write":
    write(name)
json.dump(contents(name), sys.stdout)
