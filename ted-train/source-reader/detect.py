"""Tells the format of a source from what is inside, and opens its reader."""

import json
import pathlib

from faults import Fault

MAGIC = {
    b"\x89HDF\r\n\x1a\n": "hdf5",
    b"PK\x03\x04": "npz",
    b"\x89MCAP0\r\n": "mcap",
    b"SQLite f": "sqlite",
    b"PAR1": "parquet",
}
TABLE_PARTS = ["observation", "action", "reward", "terminated", "truncated", "success", "episode", "time.column", "time.unit", "time.period_us"]


def d4rl(path, options):
    from from_d4rl import D4rl

    return D4rl(path, options)


def robomimic(path, options):
    from from_robomimic import Robomimic

    return Robomimic(path, options)


def lerobot(path, options):
    from from_lerobot import Lerobot

    return Lerobot(path, options)


def minari(path, options):
    from from_minari import Minari

    return Minari(path, options)


def npz(path, options):
    """With a map a table, without one D4RL's arrays under their names."""
    from from_d4rl import D4rl
    from from_table import MappedTable
    from npy_rows import Npz
    from tables import NpzTable

    store = Npz(path)
    if options.map is None and "observations" in store and "actions" in store:
        return D4rl(path, options, store)
    return MappedTable("npz", NpzTable(path), options, TABLE_PARTS)


def csv(path, options):
    from from_table import MappedTable
    from tables import CsvTable

    return MappedTable("csv", CsvTable(path), options, TABLE_PARTS)


def jsonl(path, options):
    from from_table import MappedTable
    from tables import JsonlTable

    return MappedTable("jsonl", JsonlTable(path), options, TABLE_PARTS)


def mcap(path, options):
    from bags import McapFile
    from from_bag import Bag

    return Bag("mcap", McapFile(path), options)


def rosbag2(path, options):
    from bags import BagFolder
    from from_bag import Bag

    return Bag("rosbag2", BagFolder(path), options)


FORMATS = {
    "d4rl": d4rl,
    "robomimic": robomimic,
    "lerobot": lerobot,
    "minari": minari,
    "npz": npz,
    "csv": csv,
    "jsonl": jsonl,
    "mcap": mcap,
    "rosbag2": rosbag2,
}


def opened(name, path, options):
    """The reader of a format, after what it does not take was refused. Raises Fault."""
    reader = FORMATS[name](path, options)
    for option in ("observations", "actions", "map", "mask"):
        if getattr(options, option) is not None and option not in reader.takes:
            raise Fault(f"--{option} says nothing to the format {name}", "leave it out")
    return reader


def told(path):
    """The name of the format of what lies at this path. Raises Fault."""
    path = pathlib.Path(path)
    if not path.exists():
        raise Fault(f"there is nothing at {path}", "name a file or folder that exists")
    return of_folder(path) if path.is_dir() else of_file(path)


def of_folder(path):
    if (path / "meta" / "info.json").exists():
        return "lerobot"
    if (path / "metadata.yaml").exists():
        return "rosbag2"
    for data in (path / "data", path):
        if (data / "main_data.hdf5").exists() or is_minari(data / "metadata.json"):
            return "minari"
    raise unclear(f"a folder with {few(child.name for child in sorted(path.iterdir()))}")


def of_file(path):
    with open(path, "rb") as file:
        head = file.read(8)
    kind = next((kind for magic, kind in MAGIC.items() if head.startswith(magic)), None)
    if kind == "hdf5":
        return of_hdf5(path)
    if kind == "npz" or kind == "mcap":
        return kind
    if kind == "sqlite":
        raise Fault("a database file, as rosbag2 keeps one in a folder", "name the folder with its metadata.yaml")
    if kind == "parquet":
        raise Fault("a single parquet file", "name the folder of the LeRobot dataset, with meta/info.json in it")
    ending = {".csv": "csv", ".jsonl": "jsonl", ".ndjson": "jsonl"}.get(path.suffix.lower())
    if ending is None:
        raise unclear(f"a file that begins with {head!r} and is called {path.name}")
    return ending


def of_hdf5(path):
    import h5py

    with h5py.File(path, "r") as file:
        names = list(file)
        if "data" in file and any(name.startswith("demo_") for name in file["data"]):
            return "robomimic"
        if any(name.startswith("episode_") for name in names):
            return "minari"
        if all(name in file and hasattr(file[name], "dtype") for name in ("observations", "actions")):
            return "d4rl"
    raise unclear(f"an HDF5 file with {few(names)}")


def is_minari(path):
    try:
        about = json.loads(path.read_text())
    except (OSError, ValueError):
        return False
    return isinstance(about, dict) and "total_episodes" in about


def unclear(found):
    return Fault(f"the format is unclear: {found}", f"name it with --format: {', '.join(FORMATS)}")


def few(names):
    names = list(names)
    return f"{', '.join(names[:8])}{' and more' if len(names) > 8 else ''}" or "nothing in it"
