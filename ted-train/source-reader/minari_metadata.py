"""Minari's metadata: where it lies, and the JSON in it."""

import json

from faults import Fault

MAIN_FILE = "main_data.hdf5"
METADATA = "metadata.json"


def data_folder(path):
    """Where the episodes lie, whether the dataset, its data folder or its HDF5 file is named."""
    if path.is_file():
        return path.parent
    inner = path / "data"
    return inner if inner.is_dir() and not (path / MAIN_FILE).exists() else path


def read_json(path):
    """Reads JSON as Python writes it, with NaN and Infinity; nothing where there is no file. Raises Fault."""
    try:
        return json.loads(path.read_text())
    except FileNotFoundError:
        return {}
    except ValueError as error:
        raise Fault(f"{path} is no JSON: {error}", "download or write the dataset again") from error


def env_name(spec):
    """The environment's id in a serialised specification; None where there is none."""
    try:
        return json.loads(spec).get("id") if spec else None
    except ValueError:
        return None
