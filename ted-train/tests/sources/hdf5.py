"""The layouts that D4RL and robomimic write with h5py, and what h5py reads from them."""

import json

import h5py
import numpy as np

from numbers_made import episodes


def d4rl(folder):
    """One episode ends by a terminal, one by both flags, the others by a timeout, as in the files of the locomotion tasks."""
    path = folder / "hopper-tiny-v2.hdf5"
    made = episodes(1)
    with h5py.File(path, "w") as file:
        last = [np.arange(len(one["actions"])) == len(one["actions"]) - 1 for one in made]
        arrays = {
            "observations": [one["observations"][:-1] for one in made],
            "next_observations": [one["observations"][1:] for one in made],
            "actions": [one["actions"] for one in made],
            "rewards": [one["rewards"] for one in made],
            "terminals": [end & (number in (0, 2)) for number, end in enumerate(last)],
            "timeouts": [end & (number != 0) for number, end in enumerate(last)],
            "infos/qpos": [one["observations"][:-1] for one in made],
        }
        for name, parts in arrays.items():
            values = np.concatenate(parts)
            values = values if values.dtype == bool else values.astype(np.float32)
            file.create_dataset(name, data=values, compression="gzip")
    with h5py.File(path) as file:
        arrays = {name: file[name][:] for name in ("observations", "next_observations", "actions", "rewards", "terminals", "timeouts")}
    found, begin = [], 0
    for row in range(len(arrays["actions"])):
        if not (arrays["terminals"][row] or arrays["timeouts"][row]):
            continue
        here = slice(begin, row + 1)
        found.append(
            {
                "observations": np.concatenate([arrays["observations"][here], arrays["next_observations"][row : row + 1]]),
                "actions": arrays["actions"][here],
                "rewards": arrays["rewards"][here],
                "terminations": arrays["terminals"][here],
                "truncations": arrays["timeouts"][here],
            }
        )
        begin = row + 1
    return path, [], found


def robomimic(folder):
    """Demos of two low-dimensional observations and an image, of which the last step is done."""
    path = folder / "low_dim.hdf5"
    with h5py.File(path, "w") as file:
        data = file.create_group("data")
        data.attrs["env_args"] = json.dumps({"env_name": "Lift", "type": 1, "env_kwargs": {"control_freq": 20}})
        for number, one in enumerate(episodes(2)):
            steps = len(one["actions"])
            demo = data.create_group(f"demo_{number}")
            demo.attrs["num_samples"] = steps
            for key, rows in (("obs", one["observations"][:-1]), ("next_obs", one["observations"][1:])):
                demo[f"{key}/robot0_eef_pos"] = rows[:, :3]
                demo[f"{key}/object"] = rows[:, 3:]
            demo["obs/agentview_image"] = np.zeros((steps, 8, 8, 3), np.uint8)
            demo["actions"] = one["actions"]
            demo["rewards"] = one["rewards"]
            demo["dones"] = (np.arange(steps) == steps - 1).astype(np.int64)
            demo["states"] = np.zeros((steps, 9))
    keys = ["robot0_eef_pos", "object"]
    found = []
    with h5py.File(path) as file:
        for number in range(len(file["data"])):
            demo = file[f"data/demo_{number}"]
            rows = [np.concatenate([demo[f"obs/{key}"][:], demo[f"next_obs/{key}"][-1:]]) for key in keys]
            found.append(
                {
                    "observations": np.concatenate(rows, axis=1),
                    "actions": demo["actions"][:],
                    "rewards": demo["rewards"][:],
                    "terminations": demo["dones"][:],
                }
            )
    return path, ["--observations", ",".join(keys)], found
