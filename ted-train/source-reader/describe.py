"""Prints for people what is in a source, what would be read of it, and how to go on."""

import math

from faults import Fault


def describe(path, name, reader, out):
    """`reader` is open; its header may still be a fault, which is then the next thing to settle."""
    print(f"{path}: {name}\n", file=out)
    keys = reader.keys()
    cells = [[key.name, key.shape, key.type, key.use] for key in keys]
    widths = [max((len(row[column]) for row in cells), default=0) for column in range(4)]
    for row in cells:
        print("  " + "  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip(), file=out)
    try:
        header = reader.header()
    except Fault as fault:
        print(f"\nnot yet: {fault.what}\nway out: {fault.way_out}", file=out)
        return
    print(file=out)
    for what, channels in (("observation", header.observation), ("action", header.action)):
        print(f"{what}, {len(channels)} numbers: {', '.join(ranged(channel) for channel in channels)}", file=out)
    has = [word for word, there in (("rewards", header.rewards), ("success", header.success), ("terminations", header.terminations)) if there]
    print(f"beside them: {', '.join(has) or 'nothing: no rewards, no success, no terminations'}", file=out)
    print(f"episodes: {unknown(header.episodes)}; steps: {unknown(header.steps)}", file=out)
    print(f"period: {header.period_us} us, {header.period_from}" if header.period_us else "period: the source does not say", file=out)
    for note in header.notes:
        print(f"note: {note}", file=out)
    print("\nto go on: ted import with the same options, without --describe", file=out)


def ranged(channel):
    bounds = (channel.low, channel.high)
    known = all(bound is not None and math.isfinite(bound) for bound in bounds)
    return f"{channel.name} [{channel.low:g}, {channel.high:g}]" if known else channel.name


def unknown(count):
    return "known after reading" if count is None else count
