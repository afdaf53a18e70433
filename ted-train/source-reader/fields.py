"""Fields of messages by a path: pose.position.x, position[2], or position[elbow] where the message has a list `name` beside the list."""

import re

from faults import Fault

TOKEN = re.compile(r"\.?([A-Za-z_]\w*)|\[([^\]]+)\]")


class Field:
    """One field of the messages of one topic."""

    def __init__(self, topic, path):
        self._topic = topic
        self._path = path
        self._tokens = []
        at = 0
        while at < len(path):
            match = TOKEN.match(path, at)
            if match is None:
                raise Fault(f"the field {path} of {topic} is no path", "write it as pose.position.x, position[2] or position[elbow]")
            self._tokens.append(match.groups())
            at = match.end()

    def of(self, message):
        """The value of the field: a number or a text."""
        value, holder = message, message
        for name, index in self._tokens:
            if name is not None:
                holder, value = value, self._member(value, name)
                continue
            place = int(index) if index.lstrip("-").isdigit() else self._named(holder, index)
            try:
                value = value[place]
            except (IndexError, TypeError, KeyError) as error:
                raise self._missing(f"[{index}]", value) from error
        if hasattr(value, "item"):
            value = value.item()
        if not isinstance(value, (bool, int, float, str)):
            raise Fault(f"the field {self._path} of {self._topic} is no single value", f"there are: {', '.join(leaves(message))}")
        return value

    def _member(self, value, name):
        members = members_of(value)
        if name not in members:
            raise self._missing(name, value)
        return members[name]

    def _named(self, holder, name):
        names = list(members_of(holder).get("name", []))
        if name not in names:
            raise Fault(f"the message of {self._topic} names no {name}", f"its names are: {', '.join(map(str, names)) or 'none'}")
        return names.index(name)

    def _missing(self, what, value):
        there = ", ".join(members_of(value)) or f"{len(value)} entries" if hasattr(value, "__len__") or members_of(value) else "nothing below"
        return Fault(f"the messages of {self._topic} have no {what} in {self._path}", f"there: {there}")


def members_of(value):
    """The fields of a decoded message, whichever library decoded it."""
    if isinstance(value, dict):
        return value
    if isinstance(value, (str, bytes, int, float)) or hasattr(value, "dtype"):
        return {}
    names = getattr(value, "__slots__", None) or getattr(value, "__dict__", {})
    return {name: getattr(value, name) for name in names if not name.startswith("_")}


def leaves(value, head=""):
    """The paths of all single values of a message."""
    members = members_of(value)
    if members:
        return [path for name, member in members.items() for path in leaves(member, f"{head}.{name}" if head else name)]
    if hasattr(value, "__len__") and not isinstance(value, (str, bytes)):
        return [f"{head}[0..{len(value) - 1}]"] if len(value) else []
    return [head]
