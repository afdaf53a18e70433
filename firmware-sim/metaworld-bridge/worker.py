"""The worker: one process, one Meta-World task at a time, driven over stdin and stdout.

    worker.py [fast|reference]        the engine

The order at the start matters. Standard output belongs to the protocol, so it is moved out of reach of any library that
prints before anything else is imported; the greeting goes out first of all, so that a parent of another version learns
that before it waits for anything.
"""

import os
import signal
import sys

REQUESTS = os.dup(0)
REPLIES = os.dup(1)
os.dup2(2, 1)
signal.signal(signal.SIGINT, signal.SIG_IGN)

import messages  # noqa: E402
import wire  # noqa: E402
from parent import leave_with_parent  # noqa: E402


def main(engine="fast"):
    link = wire.Link(REQUESTS, REPLIES)
    link.send_hello()
    leave_with_parent(REQUESTS)
    spoken = link.receive_hello()
    if spoken != wire.PROTOCOL_VERSION:
        sys.exit(f"the parent speaks protocol {spoken}, this worker {wire.PROTOCOL_VERSION}")
    try:
        from session import Session, versions
    except Exception as error:
        link.send(messages.FAULT, 0, messages.fault(messages.CANNOT_START, f"{type(error).__name__}: {error}"))
        raise
    link.send(messages.READY, 0, messages.text(versions(engine)))
    Session(link, engine).serve()


if __name__ == "__main__":
    try:
        main(*sys.argv[1:])
    except wire.Closed:
        pass
