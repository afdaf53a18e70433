"""What a reader finds: the facts of a source, and its episodes one at a time.

A reader has `takes` (the options that say something to it) and three methods: `keys`, what is there for a person to choose from; `header`,
which comes before the episodes; and `episodes(first)`, which yields Episode or Skipped from that number on. Each raises Fault.
"""

from dataclasses import dataclass, field
from typing import NamedTuple, Optional


class Channel(NamedTuple):
    """One number of an observation or action; the range is there only if the source declares it."""

    name: str
    low: Optional[float] = None
    high: Optional[float] = None


class Key(NamedTuple):
    """One array or column of the source, for a person to choose from; `use` says what it would be without further words."""

    name: str
    shape: str
    type: str
    use: str


@dataclass
class Header:
    """What is known before the first episode. Unknown numbers are None; `period_from` says where the period stands."""

    observation: list
    action: list
    rewards: bool = False
    success: bool = False
    terminations: bool = False
    period_us: Optional[int] = None
    period_from: Optional[str] = None
    episodes: Optional[int] = None
    steps: Optional[int] = None
    task: Optional[str] = None
    notes: list = field(default_factory=list)


class Note(NamedTuple):
    """Something that a person should know of an episode; `step` is None where all of it is meant."""

    what: str
    step: Optional[int] = None


@dataclass
class Episode:
    """T steps: `observations` has T + 1 rows, everything else T; what the source does not have is None.

    `number` is the place in the source, counted from 0, and does not depend on where reading began. `share` is how much of the source was
    read, from 0 to 1, where its episodes are not known beforehand.
    """

    number: int
    name: str
    observations: object
    actions: object
    rewards: object = None
    terminations: object = None
    truncations: object = None
    success: object = None
    share: Optional[float] = None
    notes: list = field(default_factory=list)
    videos: list = field(default_factory=list)


class Skipped(NamedTuple):
    """A piece of the source that gives no step, and why."""

    number: int
    name: str
    why: str


def numbered(name, width):
    """Names for the columns of an array: its own if there is one column, else name_0, name_1, and so on."""
    return [name] if width == 1 else [f"{name}_{column}" for column in range(width)]
