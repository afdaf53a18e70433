"""The worker must not outlive its parent, whatever it is doing when the parent goes.

A thread waits for the parent's end of our stdin to close, which the kernel does however the parent ends (exit, panic,
kill -9), and also looks now and then whether we were handed to another parent. Linux could send a signal instead
(PR_SET_PDEATHSIG), but that one comes when the *thread* that started us ends, not the process.
"""

import os
import select
import threading

CHECK_PERIOD_MS = 1000


def leave_with_parent(stdin, whole_group=False):
    """Ends this process (or its whole process group) as soon as the parent is gone."""
    first_parent = os.getppid()

    def watch():
        poll = select.poll()
        poll.register(stdin, select.POLLHUP)  # always reported on Linux, only on request on macOS
        while True:
            events = poll.poll(CHECK_PERIOD_MS)
            if events or os.getppid() != first_parent:
                if whole_group:
                    os.killpg(0, 9)
                os._exit(0)

    threading.Thread(target=watch, name="leave-with-parent", daemon=True).start()
