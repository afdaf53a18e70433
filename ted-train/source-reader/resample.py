"""Messages that come when they come, brought to rows of one period: each row has the last value of every column. Gaps leave rows out."""


class Resampler:
    """`columns` is {topic: {column: Field}}; times are nanoseconds. Topics in `held` may be silent for as long as they like."""

    def __init__(self, columns, held, period, gap):
        self._columns = columns
        self._judged = [topic for topic in columns if topic not in held]
        self._period = period
        self._gap = gap
        self._latest = {}
        self._arrived = {}
        self._tick = None
        self._rows = []
        self._words = None

    def rows(self, messages):
        """Yields (time, {column: value}, words or None), in the order of time."""
        time = None
        for topic, time, message in messages:
            self._advance(time)
            before = self._arrived.get(topic)
            if topic in self._judged and before is not None and time - before > self._gap:
                self._forget(before + self._period)
                self._tick = None
            if before == time:
                self._words = f"{topic} has two messages of the same time: the later one counts"
            self._latest.update((column, field.of(message)) for column, field in self._columns[topic].items())
            self._arrived[topic] = time
            if self._tick is None and all(one in self._arrived for one in self._columns):
                self._tick = time
            yield from self._settled(min((self._arrived.get(one, time) for one in self._judged), default=time))
        if time is not None:
            self._advance(time + 1)
            late = [self._arrived[one] for one in self._judged if one in self._arrived and time - self._arrived[one] > self._gap]
            if late:
                self._forget(min(late) + self._period)
            yield from self._settled(time)

    def _advance(self, time):
        """Makes the rows before this time, as far as nothing is silent for longer than a gap."""
        if self._tick is None:
            return
        until = min([time, *(self._arrived[topic] + self._gap for topic in self._judged)])
        while self._tick < until:
            self._rows.append((self._tick, dict(self._latest), self._words))
            self._words = None
            self._tick += self._period

    def _forget(self, limit):
        """Takes back rows that were made of values that had become old before a gap was known."""
        while self._rows and self._rows[-1][0] > limit:
            self._rows.pop()

    def _settled(self, time):
        """Rows that no later message takes back."""
        count = 0
        while count < len(self._rows) and self._rows[count][0] <= time:
            count += 1
        yield from self._rows[:count]
        del self._rows[:count]
