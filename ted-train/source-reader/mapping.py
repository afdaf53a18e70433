"""map.toml: what a table's or a bag's columns mean. README.md describes it; whatever it does not describe is refused."""

try:
    import tomllib
except ModuleNotFoundError:  # Python 3.10
    import tomli as tomllib

from faults import Fault

UNITS_US = {"s": 1e6, "ms": 1e3, "us": 1.0, "ns": 1e-3}

NAMES = "a list of names"
NAME = "a name"
NUMBER = "a number above 0"
COUNT = "a whole number above 0"
FIELDS = "names with the fields that they stand for"

LAYOUT = {
    "observation": {"columns": NAMES},
    "action": {"columns": NAMES, "from_next": NAMES},
    "reward": {"column": NAME},
    "terminated": {"column": NAME},
    "truncated": {"column": NAME},
    "success": {"column": NAME},
    "episode": {"column": NAME, "gap_s": NUMBER, "every": COUNT},
    "time": {"column": NAME, "unit": NAME, "period_us": COUNT, "held": NAMES},
    "topics": None,
}


class Mapping:
    """A map that was read; what it does not say is None."""

    def __init__(self, path, data):
        self.path = path
        self._data = data

    def get(self, section, key):
        return self._data.get(section, {}).get(key)

    @property
    def topics(self):
        """Topic by topic: column names and the fields that they stand for."""
        return self._data.get("topics", {})

    def only(self, format_name, *allowed):
        """Refuses what a format does not look at: `allowed` holds sections and "section.key"s."""
        for section, content in self._data.items():
            for key in [None] if section == "topics" else content:
                if section not in allowed and f"{section}.{key}" not in allowed:
                    where = f"[{section}]" if key is None else f"{key} in [{section}]"
                    raise Fault(
                        f"{self.path}: {where} says nothing to the format {format_name}", f"it looks at: {', '.join(allowed)}; take the rest out"
                    )

    def need(self, section, key):
        value = self.get(section, key)
        if value is None:
            raise Fault(f"{self.path}: no {key} in [{section}]", f"give {LAYOUT[section][key]} there; `--describe` prints what there is")
        return value


def read(path):
    """Reads and checks a map. Raises Fault."""
    try:
        with open(path, "rb") as file:
            data = tomllib.load(file)
    except OSError as error:
        raise Fault(f"the map {path} cannot be read: {error.strerror}", "name an existing file after --map") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise Fault(f"the map {path} is no TOML: {error}", "correct it there") from error
    for section, content in data.items():
        if section not in LAYOUT:
            raise Fault(f"{path}: unknown section [{section}]", f"there are: {', '.join(LAYOUT)}")
        if not isinstance(content, dict):
            raise Fault(f"{path}: {section} is no section", f"write [{section}] and its keys below it")
        keys = LAYOUT[section]
        if keys is None:
            for topic, fields in content.items():
                check(path, f"[{section}]", topic, fields, FIELDS)
            continue
        for key, value in content.items():
            if key not in keys:
                raise Fault(f"{path}: unknown key {key} in [{section}]", f"there are: {', '.join(keys)}")
            check(path, f"[{section}]", key, value, keys[key])
    unit = data.get("time", {}).get("unit")
    if unit is not None and unit not in UNITS_US:
        raise Fault(f"{path}: the unit of time {unit} is unknown", f"there are: {', '.join(UNITS_US)}")
    return Mapping(path, data)


def check(path, section, key, value, kind):
    number = not isinstance(value, bool) and isinstance(value, (int, float)) and value > 0
    good = {
        NAMES: isinstance(value, list) and bool(value) and all(isinstance(name, str) for name in value),
        NAME: isinstance(value, str),
        NUMBER: number,
        COUNT: number and isinstance(value, int),
        FIELDS: isinstance(value, dict) and bool(value) and all(isinstance(field, str) for field in value.values()),
    }[kind]
    if not good:
        raise Fault(f"{path}: {key} in {section} is {value!r}", f"give {kind}")
