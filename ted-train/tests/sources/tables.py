"""Tables of numbers as numpy, Python's csv and its json write them, with the map that says what their columns are."""

import csv
import json

import numpy as np

from numbers_made import episodes

PERIOD_S = 0.05
MAP = """
[observation]
columns = [{observation}]
[action]
columns = [{action}]
[reward]
column = "reward"
[episode]
column = "episode"
[time]
column = "time"
unit = "s"
"""
NAMES = {"observation": ["x", "y", "z", "grip"], "action": ["u", "v"]}


def rows():
    """All rows: the last one of an episode has an action that nobody saw the end of."""
    for number, one in enumerate(episodes(6)):
        actions = np.concatenate([one["actions"], one["actions"][-1:] / 2])
        rewards = np.append(one["rewards"], 0.5)
        for step, (seen, done, reward) in enumerate(zip(one["observations"], actions, rewards)):
            yield f"take {number}", step * PERIOD_S, seen, done, float(reward)


def mapped(folder, names):
    quoted = {key: ", ".join(f'"{name}"' for name in chosen) for key, chosen in names.items()}
    path = folder / "map.toml"
    path.write_text(MAP.format(**quoted))
    return ["--map", str(path)]


def grouped(read):
    """Rows of (episode, observation, action, reward) as episodes, whose last row gives its observation alone."""
    found = {}
    for name, seen, done, reward in read:
        found.setdefault(name, []).append((seen, done, reward))
    columns = lambda part, which: np.array([row[which] for row in part])
    return [
        {"observations": columns(part, 0), "actions": columns(part[:-1], 1), "rewards": columns(part[:-1], 2)} for part in found.values()
    ]


def npz(folder):
    """Two wide columns and three narrow ones."""
    path = folder / "log.npz"
    names, times, seen, done, rewards = zip(*rows())
    np.savez(path, episode=np.array(names), time=np.array(times), state=np.array(seen), command=np.array(done), reward=np.array(rewards))
    with np.load(path) as read:
        found = grouped(zip(read["episode"].tolist(), read["state"], read["command"], read["reward"]))
    return path, mapped(folder, {"observation": ["state"], "action": ["command"]}), found


def comma_separated(folder):
    path = folder / "log.csv"
    with open(path, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["episode", "time", *NAMES["observation"], *NAMES["action"], "reward"])
        writer.writerows([name, time, *seen.tolist(), *done.tolist(), reward] for name, time, seen, done, reward in rows())
    with open(path, newline="") as file:
        read = list(csv.DictReader(file))
    numbers = lambda row, kind: [float(row[name]) for name in NAMES[kind]]
    found = grouped((row["episode"], numbers(row, "observation"), numbers(row, "action"), float(row["reward"])) for row in read)
    return path, mapped(folder, NAMES), found


def json_lines(folder):
    """An object on each line, with an inner object and a list."""
    path = folder / "log.jsonl"
    with open(path, "w") as file:
        for name, time, seen, done, reward in rows():
            line = {"episode": name, "time": time, "arm": dict(zip(NAMES["observation"], seen.tolist())), "command": done.tolist(), "reward": reward}
            file.write(json.dumps(line) + "\n")
    read = [json.loads(line) for line in path.read_text().splitlines()]
    found = grouped((row["episode"], [row["arm"][name] for name in NAMES["observation"]], row["command"], row["reward"]) for row in read)
    return path, mapped(folder, {"observation": [f"arm.{name}" for name in NAMES["observation"]], "action": ["command"]}), found
