"""Recordings of ROS 2 topics by the writers of mcap and rosbags, and what the readers of these packages read from them.

A command is sent two milliseconds before each state, so it is in force when the state is seen, and some seconds pass between two takes.
"""

import numpy as np
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from mcap_ros2.writer import Writer as McapWriter
from rosbags.rosbag2 import Reader as BagReader
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as BagWriter
from rosbags.typesys import Stores, get_typestore

from numbers_made import CHANNELS, COMMANDS, episodes

TYPE = "std_msgs/msg/Float64MultiArray"
SCHEMA = """std_msgs/MultiArrayLayout layout
float64[] data
================================================================================
MSG: std_msgs/MultiArrayLayout
std_msgs/MultiArrayDimension[] dim
uint32 data_offset
================================================================================
MSG: std_msgs/MultiArrayDimension
string label
uint32 size
uint32 stride
"""
START = 1_700_000_000_000_000_000
PERIOD = 20_000_000
BEFORE = 2_000_000
BREAK = 5_000_000_000
STATE, COMMAND = "/state", "/command"


def messages():
    """(time, topic, numbers) in the order of time."""
    time = START
    for one in episodes(7):
        actions = np.concatenate([one["actions"], one["actions"][-1:] / 2])
        for seen, done in zip(one["observations"], actions):
            yield time - BEFORE, COMMAND, done
            yield time, STATE, seen
            time += PERIOD
        time += BREAK


def mapped(folder):
    fields = [[f'{letter}{i} = "data[{i}]"' for i in range(count)] for letter, count in (("x", CHANNELS), ("u", COMMANDS))]
    names = [", ".join(f'"{letter}{i}"' for i in range(count)) for letter, count in (("x", CHANNELS), ("u", COMMANDS))]
    lines = ["[observation]", f"columns = [{names[0]}]", "[action]", f"columns = [{names[1]}]"]
    lines += [f'[topics."{STATE}"]', *fields[0], f'[topics."{COMMAND}"]', *fields[1]]
    path = folder / "map.toml"
    path.write_text("\n".join(lines) + "\n")
    return ["--map", str(path)]


def grouped(read):
    """Messages as episodes: a break between two states is longer than three periods."""
    takes, command, before = [], None, None
    for time, topic, numbers in read:
        if topic == COMMAND:
            command = numbers
            continue
        if before is None or time - before > 3 * PERIOD:
            takes.append([])
        takes[-1].append((numbers, command))
        before = time
    return [{"observations": np.array([seen for seen, _ in take]), "actions": np.array([done for _, done in take[:-1]])} for take in takes]


def mcap(folder):
    path = folder / "log.mcap"
    with open(path, "wb") as file:
        writer = McapWriter(file)
        schema = writer.register_msgdef(TYPE, SCHEMA)
        for time, topic, numbers in messages():
            writer.write_message(topic, schema, {"layout": {"dim": [], "data_offset": 0}, "data": numbers.tolist()}, time, time)
        writer.finish()
    with open(path, "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        read = [(one.log_time, channel.topic, list(decoded.data)) for _, channel, one, decoded in reader.iter_decoded_messages()]
    return path, mapped(folder), grouped(read)


def sqlite3(folder):
    return bag(folder, StoragePlugin.SQLITE3)


def mcap_storage(folder):
    return bag(folder, StoragePlugin.MCAP)


def bag(folder, plugin):
    path = folder / "bag"
    store = get_typestore(Stores.ROS2_JAZZY)
    layout = store.types["std_msgs/msg/MultiArrayLayout"](dim=[], data_offset=0)
    with BagWriter(path, version=9, storage_plugin=plugin) as writer:
        connections = {topic: writer.add_connection(topic, TYPE, typestore=store) for topic in (STATE, COMMAND)}
        for time, topic, numbers in messages():
            message = store.types[TYPE](layout=layout, data=np.array(numbers))
            writer.write(connections[topic], time, store.serialize_cdr(message, TYPE))
    with BagReader(path) as reader:
        read = [(time, connection.topic, store.deserialize_cdr(raw, connection.msgtype).data) for connection, time, raw in reader.messages()]
    return path, mapped(folder), grouped(read)
