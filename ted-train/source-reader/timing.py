"""Time stamps: the period that they say, and where they do not keep it."""

import numpy as np

from faults import Fault
from model import Note

# A difference of more periods than that is a gap, which is told; a smaller one is jitter.
GAP_PERIODS = 1.5
# Jitter of more than this share of a period is told.
JITTER = 0.1
# Gaps of one episode that are told one by one.
GAPS_TOLD = 5


def forward(stamps, episode):
    """Raises Fault where a time stamp is not later than the one before it, or is no number."""
    bad = np.flatnonzero(~np.isfinite(stamps))
    if bad.size:
        raise Fault("the time stamp is missing", "fill it in, or take the row out", episode, int(bad[0]))
    back = np.flatnonzero(np.diff(stamps) <= 0)
    if back.size:
        step = int(back[0]) + 1
        words = "is that of the row before" if stamps[step] == stamps[step - 1] else "goes backward"
        raise Fault(
            f"the time stamp {words}: {stamps[step - 1]}, then {stamps[step]}",
            "sort the rows by time and take duplicates out; if another episode begins here, say so with an episode column",
            episode,
            step,
        )


def notes(stamps, scale_us, period_us):
    """What an episode's time stamps, of `scale_us` microseconds each, say about the period."""
    differences = np.diff(stamps) * scale_us
    gaps = np.flatnonzero(differences > GAP_PERIODS * period_us)
    told = [Note(f"a gap of {differences[step] / period_us:.1f} periods", int(step) + 1) for step in gaps[:GAPS_TOLD]]
    if gaps.size > GAPS_TOLD:
        told.append(Note(f"{gaps.size - GAPS_TOLD} more gaps"))
    steady = np.delete(differences, gaps)
    if steady.size and np.abs(steady - period_us).max() > JITTER * period_us:
        told.append(Note(f"the period varies between {steady.min():.0f} and {steady.max():.0f} us (it is said to be {period_us} us)"))
    return told


def period(differences_us, where):
    """The period in whole microseconds, from differences of time stamps."""
    usable = differences_us[differences_us > 0]
    if not usable.size:
        raise Fault(f"{where} has no two rows of one episode that are apart in time", "name another time column, or give period_us in [time]")
    value = int(round(float(np.median(usable))))
    if value == 0:
        raise Fault(f"{where} says a period below one microsecond", "correct unit in [time]")
    return value
