"""Bags: MCAP by its own writers (ROS 2 and JSON), rosbag2 by rosbags with both storages; resampling, gaps and actions from the next position."""

import json
import unittest

import numpy as np
from mcap.writer import Writer as PlainWriter
from mcap_ros2.writer import Writer as Ros2Writer
from rosbags.rosbag2 import StoragePlugin, Writer as BagWriter
from rosbags.typesys import Stores, get_typestore

from fields import Field
from reading import Reading
from resample import Resampler

JOINTS = "sensor_msgs/msg/JointState"
COMMAND = "std_msgs/msg/Float64MultiArray"
SCHEMAS = {
    JOINTS: """std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
""",
    COMMAND: """std_msgs/MultiArrayLayout layout
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
""",
}
START = 1_700_000_000_000_000_000
PERIOD = 20_000_000
MAP = """
[observation]
columns = ["shoulder", "elbow"]
[action]
columns = ["torque"]
[topics."/joint_states"]
shoulder = "position[0]"
elbow = "position[elbow]"
[topics."/command"]
torque = "data[0]"
"""


def at(step):
    return START + step * PERIOD


def recording(steps=range(8)):
    """(time, topic, value): joints on every tick, a command half a period later."""
    events = []
    for step in steps:
        events.append((at(step), "/joint_states", step + 0.25))
        events.append((at(step) + PERIOD // 2, "/command", step + 0.5))
    return events


class Bags(Reading):
    def write_mcap(self, events):
        path = self.folder / "log.mcap"
        with open(path, "wb") as file:
            writer = Ros2Writer(file)
            schemas = {name: writer.register_msgdef(name, text) for name, text in SCHEMAS.items()}
            for time, topic, value in events:
                if topic == "/command":
                    writer.write_message(topic, schemas[COMMAND], {"layout": {"dim": [], "data_offset": 0}, "data": [value]}, time, time)
                else:
                    writer.write_message(topic, schemas[JOINTS], joints(value, time), time, time)
            writer.finish()
        return path

    def write_json(self, events):
        path = self.folder / "json.mcap"
        with open(path, "wb") as file:
            writer = PlainWriter(file)
            writer.start()
            schema = writer.register_schema("any", "jsonschema", b"{}")
            channels = {topic: writer.register_channel(topic, "json", schema) for topic in ("/joint_states", "/command")}
            for time, topic, value in events:
                message = {"data": [value]} if topic == "/command" else joints(value, time)
                writer.add_message(channels[topic], time, json.dumps(message).encode(), time)
            writer.finish()
        return path

    def write_bag(self, events, plugin):
        path = self.folder / plugin.name
        store = get_typestore(Stores.ROS2_JAZZY)
        types = store.types
        with BagWriter(path, version=9, storage_plugin=plugin) as writer:
            connections = {
                topic: writer.add_connection(topic, name, typestore=store) for topic, name in (("/joint_states", JOINTS), ("/command", COMMAND))
            }
            for time, topic, value in events:
                if topic == "/command":
                    layout = types["std_msgs/msg/MultiArrayLayout"](dim=[], data_offset=0)
                    message = types[COMMAND](layout=layout, data=np.array([value]))
                else:
                    about = joints(value, time)
                    stamp = types["builtin_interfaces/msg/Time"](**about["header"]["stamp"])
                    header = types["std_msgs/msg/Header"](stamp=stamp, frame_id="")
                    lists = {key: np.array(about[key], float) for key in ("position", "velocity", "effort")}
                    message = types[JOINTS](header=header, name=about["name"], **lists)
                connection = connections[topic]
                writer.write(connection, time, store.serialize_cdr(message, connection.msgtype))
        return path

    def test_every_kind_gives_the_numbers_that_were_sent(self):
        events = recording()
        for path, name in [
            (self.write_mcap(events), "mcap"),
            (self.write_json(events), "mcap"),
            (self.write_bag(events, StoragePlugin.SQLITE3), "rosbag2"),
            (self.write_bag(events, StoragePlugin.MCAP), "rosbag2"),
        ]:
            source, episodes = self.whole(path, *self.map(MAP))
            self.assertEqual(source["format"], name)
            self.assertEqual([channel["name"] for channel in source["observation"]], ["shoulder", "elbow"])
            self.assertEqual(source["period_us"], 20_000)
            self.assertIn("/joint_states", source["period_from"])
            # The first row is when both topics have spoken; each has the last value of each.
            (episode,) = episodes
            self.same(episode["observations"][:, 0], np.arange(0, 8) + 0.25)
            self.same(episode["observations"][:, 1], np.arange(0, 8) + 100.25)
            self.same(episode["actions"][:, 0], np.arange(0, 7) + 0.5)
            self.assertEqual(episode["notes"], [])
            self.assertAlmostEqual(episode["share"], 1.0)

    def test_a_gap_of_more_than_three_periods_cuts_the_episode_and_is_told(self):
        path = self.write_mcap(recording([*range(6), *range(20, 25)]))
        _, episodes = self.whole(path, *self.map(MAP))
        self.assertEqual([episode["observations"][0, 0] for episode in episodes], [0.25, 20.25])
        # No row has a value that is older than one period.
        self.assertLessEqual(episodes[0]["observations"].max(), 105.25)
        self.assertEqual(episodes[0]["steps"], 5)
        self.assertIn("later: another episode begins there", episodes[0]["notes"][-1]["what"])
        _, rest = self.whole(path, *self.map(MAP), "--from-episode", "1")
        self.assertEqual(rest[0]["number"], 1)
        self.same(rest[0]["actions"], episodes[1]["actions"])

    def test_a_topic_that_is_held_may_be_silent(self):
        events = [event for event in recording(range(12)) if event[1] != "/command" or event[2] == 0.5]
        _, cut = self.whole(self.write_mcap(events), *self.map(MAP))
        self.assertLess(sum(episode["steps"] for episode in cut), 4)
        _, held = self.whole(self.write_mcap(events), *self.map(MAP + '[time]\nheld = ["/command"]\n'))
        self.assertEqual([episode["steps"] for episode in held], [10])
        self.same(held[0]["actions"], np.full((10, 1), 0.5))

    def test_another_period_resamples_to_it(self):
        source, episodes = self.whole(self.write_mcap(recording(range(9))), *self.map(MAP + "[time]\nperiod_us = 40000\n"))
        self.assertEqual((source["period_us"], source["period_from"]), (40_000, "period_us in the map"))
        self.same(episodes[0]["observations"][:, 0], [0.25, 2.25, 4.25, 6.25, 8.25])

    def test_the_action_may_be_the_next_position(self):
        map = MAP.replace('[action]\ncolumns = ["torque"]', '[action]\nfrom_next = ["elbow"]')
        source, episodes = self.whole(self.write_mcap(recording()), *self.map(map))
        self.assertEqual(source["action"], [{"name": "elbow_next"}])
        self.same(episodes[0]["actions"][:, 0], np.arange(1, 8) + 100.25)

    def test_two_messages_of_one_time_are_told_and_the_later_one_counts(self):
        events = recording()
        events.insert(7, (at(3), "/joint_states", 3.75))
        _, episodes = self.whole(self.write_mcap(events), *self.map(MAP))
        self.same(episodes[0]["observations"][3], [3.75, 103.75])
        self.assertEqual(episodes[0]["notes"], [{"step": 3, "what": "/joint_states has two messages of the same time: the later one counts"}])

    def test_what_the_map_names_and_the_bag_has_not_is_a_fault_that_names_what_there_is(self):
        path = self.write_mcap(recording())
        for old, new, words, way_out in [
            ("/command", "/cmd", "no topic /cmd", "/command, /joint_states"),
            ("data[0]", "value", "have no value", "data"),
            ("data[0]", "data[3]", "have no [3]", "1 entries"),
            ("data[0]", "data", "no single value", "data[0..0]"),
            ("position[elbow]", "position[wrist]", "names no wrist", "shoulder, elbow"),
            ("position[0]", "position[", "is no path", "pose.position.x"),
            ('"shoulder", "elbow"', '"knee"', "no column knee", "shoulder"),
        ]:
            fault = self.fault(path, *self.map(MAP.replace(old, new)))
            self.assertIn(words, fault["what"])
            self.assertIn(way_out, fault["way_out"])
        self.assertIn("what the topics mean is not said: /command, /joint_states", self.fault(path)["what"])

    def test_the_description_names_topics_and_fields(self):
        text = self.described(self.write_mcap(recording()))
        for words in ["/joint_states", "sensor_msgs/msg/JointState (cdr)", "position[0..1]", "header.stamp.nanosec"]:
            self.assertIn(words, text)

    def test_a_recording_that_was_not_closed_is_a_fault(self):
        path = self.write_mcap(recording())
        path.write_bytes(path.read_bytes()[:-200])
        self.assertIn("mcap recover", self.fault(path, *self.map(MAP))["way_out"])


class Resampling(unittest.TestCase):
    def rows(self, messages, held=()):
        columns = {topic: {topic: Field(topic, "value")} for topic in ("a", "b")}
        resampler = Resampler(columns, held, 10, 30)
        return [(time, values) for time, values, _ in resampler.rows((topic, time, {"value": value}) for topic, time, value in messages)]

    def test_a_row_has_the_last_value_at_its_time_of_every_topic(self):
        rows = self.rows([("a", 0, 1), ("b", 4, 2), ("a", 9, 3), ("b", 14, 4), ("a", 20, 5), ("b", 24, 6)])
        self.assertEqual(rows, [(4, {"a": 1, "b": 2}), (14, {"a": 3, "b": 4}), (24, {"a": 5, "b": 6})])

    def test_rows_in_a_gap_are_taken_back_also_where_another_topic_goes_on(self):
        messages = [("a", 0, 0), ("b", 0, 0)]
        messages += [("b", time, time) for time in range(10, 100, 10)]
        messages += [("a", 100, 1), ("b", 100, 100), ("a", 110, 2), ("b", 110, 110)]
        times = [time for time, _ in self.rows(messages)]
        self.assertEqual(times, [0, 10, 100, 110])

    def test_a_gap_at_the_end_is_cut_off(self):
        messages = [("a", 0, 0), ("b", 0, 0)] + [("b", time, time) for time in range(10, 100, 10)]
        self.assertEqual([time for time, _ in self.rows(messages)], [0, 10])

    def test_after_a_gap_no_row_has_a_value_from_before_it(self):
        messages = [("a", 0, 0), ("b", 0, 0), ("a", 10, 1), ("b", 10, 1), ("a", 100, 2), ("a", 110, 3), ("b", 115, 4), ("a", 120, 5), ("b", 125, 6)]
        rows = self.rows(messages)
        self.assertEqual(rows[-2:], [(115, {"a": 3, "b": 4}), (125, {"a": 5, "b": 6})])
        self.assertEqual([time for time, _ in rows[:-2]], [0, 10, 20])

    def test_silence_of_years_makes_no_rows(self):
        messages = [("a", 0, 0), ("b", 0, 0), ("a", 10**15, 1), ("b", 10**15, 1)]
        self.assertEqual([time for time, _ in self.rows(messages)], [0, 10, 10**15])


def joints(value, time):
    return {
        "header": {"stamp": {"sec": time // 10**9, "nanosec": time % 10**9}, "frame_id": ""},
        "name": ["shoulder", "elbow"],
        "position": [value, value + 100],
        "velocity": [],
        "effort": [],
    }


if __name__ == "__main__":
    unittest.main()
