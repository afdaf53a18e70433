"""Recordings of ROS 2: an MCAP file, whose messages are CDR or JSON, or a rosbag2 folder with either storage.

Each has `topics` ({topic: type and encoding}), `span` (first and last time), `first` (one message of a topic), `times` (of a topic) and
`messages` (of some topics, by time). All times are nanoseconds of the recorder's clock.
"""

import json
import pathlib

from faults import Fault


class McapFile:
    def __init__(self, path):
        from mcap.exceptions import McapError

        self._path = path
        try:
            with open(path, "rb") as file:
                summary = self._reader(file).get_summary()
        except McapError as error:
            raise Fault(f"it is no whole MCAP file: {error}", "repair it with `mcap recover`") from error
        if summary is None or summary.statistics is None or not summary.channels:
            raise Fault("the MCAP file has no index: the recording was not closed", "repair it with `mcap recover`")
        self.span = (summary.statistics.message_start_time, summary.statistics.message_end_time)
        self.topics = {}
        for channel in summary.channels.values():
            schema = summary.schemas.get(channel.schema_id)
            self.topics[channel.topic] = f"{schema.name if schema else 'no schema'} ({channel.message_encoding})"

    def first(self, topic):
        return next((message for _, _, message in self.messages([topic])), None)

    def times(self, topic):
        with open(self._path, "rb") as file:
            for _, _, message in self._reader(file).iter_messages(topics=[topic]):
                yield message.log_time

    def messages(self, topics):
        from mcap.exceptions import DecoderNotFoundError, McapError

        with open(self._path, "rb") as file:
            try:
                for _, channel, message, decoded in self._reader(file).iter_decoded_messages(topics=topics):
                    yield channel.topic, message.log_time, decoded
            except DecoderNotFoundError as error:
                raise Fault(
                    f"messages of a topic cannot be read: {error}", "ROS 2 messages (CDR with ros2msg schemas) and JSON can be read"
                ) from error
            except McapError as error:
                raise Fault(f"the MCAP file cannot be read on: {error}", "repair it with `mcap recover`") from error

    def _reader(self, file):
        from mcap.reader import make_reader
        from mcap_ros2.decoder import DecoderFactory

        return make_reader(file, decoder_factories=[DecoderFactory(), JsonDecoder()])


class JsonDecoder:
    """Reads messages whose encoding is JSON."""

    def decoder_for(self, message_encoding, schema):
        return json.loads if message_encoding == "json" else None


class BagFolder:
    def __init__(self, path):
        from rosbags.highlevel import AnyReader, AnyReaderError
        from rosbags.typesys import Stores, get_typestore

        try:
            # Bags of Humble and before do not say what their types are; the common ones have not changed since.
            self._reader = AnyReader([pathlib.Path(path)], default_typestore=get_typestore(Stores.ROS2_HUMBLE))
            self._reader.open()
        except (AnyReaderError, AssertionError) as error:
            raise Fault(f"the bag cannot be read: {error}", "rebuild its metadata with `ros2 bag reindex`") from error
        self.span = (self._reader.start_time, self._reader.end_time)
        self.topics = {connection.topic: f"{connection.msgtype} (cdr)" for connection in self._reader.connections}

    def first(self, topic):
        return next((message for _, _, message in self.messages([topic])), None)

    def times(self, topic):
        for _, time, _ in self._reader.messages(self._of([topic])):
            yield time

    def messages(self, topics):
        for connection, time, data in self._reader.messages(self._of(topics)):
            try:
                message = self._reader.deserialize(data, connection.msgtype)
            except KeyError as error:
                raise Fault(
                    f"the bag does not say what the type {connection.msgtype} of {connection.topic} is", "convert it to MCAP with `ros2 bag convert`"
                ) from error
            yield connection.topic, time, message

    def _of(self, topics):
        return [connection for connection in self._reader.connections if connection.topic in topics]
