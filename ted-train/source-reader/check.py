"""Checks every episode before it leaves: lengths, end flags, numbers that are none.

What is wrong is a fault or, if told so, is dropped with a note.
"""

import numpy as np

import arrays
from faults import Fault
from model import Note, Skipped

# What `--drop` may name.
NAN = "nan"
AFTER_END = "after-end"
EMPTY = "empty"
DROPS = (NAN, AFTER_END, EMPTY)

PER_STEP = ("actions", "rewards", "terminations", "truncations", "success")


def checked(episode, header, drop):
    """The episode in the types of the wire, or a Skipped if nothing is left of it. Raises Fault."""
    convert(episode)
    if len(episode.actions) == 0 and len(episode.observations) <= 1:
        if EMPTY in drop:
            return Skipped(episode.number, episode.name, "the episode has no steps")
        raise Fault("the episode has no steps", "--drop empty leaves such episodes out", episode.name)
    same_lengths(episode, header)
    end_flags(episode, AFTER_END in drop)
    return finite(episode, header, NAN in drop)


def convert(episode):
    name = episode.name
    episode.observations = arrays.rows(episode.observations, "the observation", name)
    episode.actions = arrays.rows(episode.actions, "the action", name).astype(np.float64)
    if episode.rewards is not None:
        episode.rewards = arrays.column(episode.rewards, "the reward", name).astype(np.float64)
    for flag in ("terminations", "truncations", "success"):
        values = getattr(episode, flag)
        if values is not None:
            setattr(episode, flag, arrays.flags(values, flag, name))


def same_lengths(episode, header):
    steps = len(episode.actions)
    found = {"observations": len(episode.observations)}
    found.update((name, len(getattr(episode, name))) for name in PER_STEP if getattr(episode, name) is not None)
    expected = {name: steps + (name == "observations") for name in found}
    if found != expected:
        lengths = ", ".join(f"{name} {length}" for name, length in found.items())
        raise Fault(
            f"the lengths of its arrays disagree: {lengths}; every action needs an observation before it and one after the last",
            "record or convert this episode again, or take it out of the source",
            episode.name,
            min(found["observations"], *(length for name, length in found.items() if name != "observations")),
        )
    for name, channels in (("observations", header.observation), ("actions", header.action)):
        width = getattr(episode, name).shape[1]
        if width != len(channels):
            raise Fault(
                f"its {name} have {width} numbers a step, and those of the first episode {len(channels)}",
                "the episodes of a source must be of one robot: split the source",
                episode.name,
            )


def end_flags(episode, drop):
    ends = np.zeros(len(episode.actions), bool)
    for flag in (episode.terminations, episode.truncations):
        if flag is not None:
            ends |= flag
    inside = np.flatnonzero(ends[:-1])
    if not inside.size:
        return
    step = int(inside[0])
    rest = len(ends) - step - 1
    if not drop:
        raise Fault(
            f"an end flag is set at step {step}, and {rest} more steps follow: these are two recordings in one, or blocks in the wrong order",
            "record or convert it again; --drop after-end keeps what comes before the flag",
            episode.name,
            step,
        )
    shorten(episode, step + 1)
    episode.notes.append(Note(f"an end flag is set here: the {rest} steps after it are dropped", step))


def finite(episode, header, drop):
    with np.errstate(over="ignore"):
        narrow = episode.observations.astype(np.float32)
    wrong = []
    for what, values, limit, channels, before in (
        ("observation", episode.observations, narrow, header.observation, 1),
        ("action", episode.actions, episode.actions, header.action, 0),
        ("reward", episode.rewards, episode.rewards, None, 0),
    ):
        row = None if values is None else first_bad(limit)
        if row is not None:
            wrong.append((max(row - before, 0), row, what, values, limit, channels))
    episode.observations = narrow
    if not wrong:
        return episode
    keep, row, what, values, limit, channels = min(wrong, key=lambda one: one[:2])
    where = what
    value = values[row]
    if channels is not None:
        column = int(np.flatnonzero(~np.isfinite(limit[row]))[0])
        where, value = f"{what} channel {channels[column].name}", values[row, column]
    is_large = " (too large for 32 bits)" if np.isfinite(value) else ""
    if not drop:
        raise Fault(f"{where} is {value}{is_large}", "--drop nan cuts the episode there", episode.name, row)
    lost = len(episode.actions) - keep
    words = f"{where} is {value}{is_large} at step {row}: the last {lost} steps are dropped"
    if keep == 0:
        return Skipped(episode.number, episode.name, words)
    shorten(episode, keep)
    episode.notes.append(Note(words, row))
    return episode


def first_bad(values):
    """The first row with a number that is not finite."""
    good = np.isfinite(values)
    bad = np.flatnonzero(~(good if good.ndim == 1 else good.all(axis=1)))
    return int(bad[0]) if bad.size else None


def shorten(episode, steps):
    episode.observations = episode.observations[: steps + 1]
    for name in PER_STEP:
        values = getattr(episode, name)
        if values is not None:
            setattr(episode, name, values[:steps])
