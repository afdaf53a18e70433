"""Reads other people's robot logs and streams their episodes to a parent.

    read_source.py SOURCE [--format NAME] [--map map.toml] [--observations KEY,KEY] [--actions KEY] [--mask NAME]
                          [--drop nan|after-end|empty]... [--from-episode N] [--describe]

Standard output carries frames alone (frames.py), or with --describe a text for people. A fault of the source is a frame and exit status 3.
"""

import argparse
import io
import os
import sys
import traceback

import check
import detect
import mapping
from describe import describe
from faults import Fault
from frames import Frames
from model import Skipped

FAULTY = 3


def main(arguments):
    options = parsed(arguments)
    # Whatever a library prints must not come between the frames.
    sink = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    try:
        return run(options, sink)
    except BrokenPipeError:
        # The parent went away; there is nobody to tell.
        os._exit(1)


def run(options, sink):
    frames = Frames(sink)
    try:
        read(options, frames, sink)
        return 0
    except Fault as fault:
        report(options, frames, fault)
    except BrokenPipeError:
        raise
    except PermissionError as error:
        report(options, frames, Fault(f"{error.filename} may not be read", "give yourself the right to read it"))
    except MemoryError:
        report(options, frames, Fault("an episode needs more memory than there is", "cut the source into shorter episodes"))
    except Exception as error:  # What a library says of a damaged file is its own.
        traceback.print_exc()
        report(
            options,
            frames,
            Fault(f"it cannot be read: {type(error).__name__}: {error}", "the file may be damaged: open it with the library that wrote it"),
        )
    return FAULTY


def read(options, frames, sink):
    options.map = mapping.read(options.map) if options.map else None
    name = options.format or detect.told(options.source)
    reader = detect.opened(name, options.source, options)
    if options.describe:
        text = io.StringIO()
        describe(options.source, name, reader, text)
        sink.write(text.getvalue().encode())
        sink.flush()
        return
    header = reader.header()
    frames.source(name, header)
    for episode in reader.episodes(options.from_episode):
        if not isinstance(episode, Skipped):
            episode = check.checked(episode, header, options.drop)
        if isinstance(episode, Skipped):
            frames.skipped(episode)
        else:
            frames.episode(episode)
    frames.end()


def report(options, frames, fault):
    if options.describe:
        where = "".join(f"{word} {value}: " for word, value in (("episode", fault.episode), ("step", fault.step)) if value is not None)
        print(f"{options.source}: {where}{fault.what}\nway out: {fault.way_out}", file=sys.stderr)
    else:
        frames.fault(fault)


def parsed(arguments):
    parser = argparse.ArgumentParser(prog="read_source.py", allow_abbrev=False)
    parser.add_argument("source")
    parser.add_argument("--format", choices=detect.FORMATS)
    parser.add_argument("--map")
    parser.add_argument("--observations", type=lambda keys: keys.split(","))
    parser.add_argument("--actions")
    parser.add_argument("--mask")
    parser.add_argument("--drop", action="append", choices=check.DROPS, default=[])
    parser.add_argument("--from-episode", type=count, default=0)
    parser.add_argument("--describe", action="store_true")
    return parser.parse_args(arguments)


def count(text):
    """A whole number that is not below 0."""
    number = int(text)
    if number < 0:
        raise ValueError
    return number


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
