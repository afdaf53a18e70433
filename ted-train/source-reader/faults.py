"""What is wrong with a source, where, and the way out: the one exception that a reader raises on purpose."""


class Fault(Exception):
    """`what` and `way_out` are for a person; `episode` is a name and `step` counts from 0 within it, where they are known."""

    def __init__(self, what, way_out, episode=None, step=None):
        super().__init__(what)
        self.what = what
        self.way_out = way_out
        self.episode = episode
        self.step = step
