"""Tables by a map: .npz by numpy, CSV by Python's writer, JSONL by its json; the rules that cut them, time, and every refusal."""

import csv
import json
import unittest

import numpy as np

import npy_rows
import tables
from reading import Reading, numbers

MAP = """
[observation]
columns = ["x", "v"]
[action]
columns = ["u"]
[reward]
column = "r"
[success]
column = "ok"
[episode]
column = "episode"
[time]
column = "t"
unit = "s"
"""
LENGTHS = {"first": 5, "second": 4}
# What says how much is read at once.
SIZES = [("JSON_ROWS", tables), ("CSV_BLOCK", tables), ("CHUNK_ROWS", npy_rows.arrays)]
ALL = ("npz", "csv", "jsonl")


class Tables(Reading):
    def rows(self):
        """Two episodes at 50 Hz, the second a success, as {column: values}."""
        total = sum(LENGTHS.values())
        names = [name for name, length in LENGTHS.items() for _ in range(length)]
        times = [round(0.02 * step, 6) for length in LENGTHS.values() for step in range(length)]
        return {
            "t": times,
            "x": numbers(1, total).tolist(),
            "v": numbers(2, total).tolist(),
            "u": numbers(3, total).tolist(),
            "r": numbers(4, total).tolist(),
            "ok": [0] * (total - 1) + [1],
            "episode": names,
        }

    def write(self, kind, rows):
        path = self.folder / f"log.{kind}"
        if kind == "npz":
            np.savez(path, **{name: np.array(values) for name, values in rows.items()})
        elif kind == "csv":
            with open(path, "w", newline="") as file:
                writer = csv.writer(file)
                writer.writerow(rows)
                writer.writerows(zip(*rows.values()))
        else:
            lines = (json.dumps(dict(zip(rows, values))) for values in zip(*rows.values()))
            path.write_text("".join(line + "\n" for line in lines))
        return path

    def change(self, kind, map=MAP, **columns):
        """A source with some columns changed, and the options to read it."""
        return [self.write(kind, {**self.rows(), **columns}), *self.map(map)]

    def test_every_number_is_read_from_each_kind(self):
        rows = self.rows()
        for kind in ALL:
            source, episodes = self.whole(self.write(kind, rows), *self.map(MAP))
            self.assertEqual(source["format"], kind)
            self.assertEqual([channel["name"] for channel in source["observation"]], ["x", "v"])
            self.assertEqual((source["period_us"], source["episodes"]), (20_000, None))
            self.assertIn("column t", source["period_from"])
            self.assertEqual(source["has"], {"rewards": True, "success": True, "terminations": False})
            begin = 0
            for episode, (name, length) in zip(episodes, LENGTHS.items(), strict=True):
                there = slice(begin, begin + length)
                self.assertEqual((episode["name"], episode["steps"], episode["notes"]), (name, length - 1, []))
                self.same(episode["observations"], np.array([rows["x"][there], rows["v"][there]]).T.astype(np.float32))
                self.same(episode["actions"][:, 0], rows["u"][there][:-1])
                self.same(episode["rewards"], rows["r"][there][:-1])
                begin += length
            self.same(episodes[1]["success"], [False, False, True])
            self.assertEqual(episodes[1]["share"], 1.0)

    def test_how_much_was_read_is_told_on_the_way(self):
        rows = {name: values * 400 for name, values in self.rows().items()}
        rows["episode"] = [f"{row // 9}" for row in range(9 * 400)]
        rows["t"] = [0.02 * row for row in range(9 * 400)]
        for name, module in SIZES:
            self.addCleanup(setattr, module, name, getattr(module, name))
            setattr(module, name, 4000 if name == "CSV_BLOCK" else 90)
        for kind in ALL:
            _, episodes = self.whole(self.write(kind, rows), *self.map(MAP))
            shares = [episode["share"] for episode in episodes]
            self.assertEqual((len(shares), shares, shares[-1]), (400, sorted(shares), 1.0))
            # pyarrow reads some blocks ahead.
            self.assertLess(shares[0], 0.6)

    def test_blocks_of_any_size_give_the_same_episodes(self):
        for name, module in SIZES:
            self.addCleanup(setattr, module, name, getattr(module, name))
        # The second episode begins with row 5: inside a block, and at the border of two.
        for rows in (2, 5):
            for name, module in SIZES:
                setattr(module, name, 100 * rows if name == "CSV_BLOCK" else rows)
            self.test_every_number_is_read_from_each_kind()
            self.test_a_gap_in_time_cuts_and_is_told()
            self.test_a_number_of_rows_cuts()
            self.test_end_flags_cut_where_no_other_rule_does()
            for kind in ALL:
                _, episodes = self.whole(self.write(kind, self.rows()), *self.map(MAP), "--from-episode", "1")
                self.assertEqual([(episode["number"], episode["name"]) for episode in episodes], [(1, "second")])

    def test_a_gap_in_time_cuts_and_is_told(self):
        times = [0.02 * step for step in range(5)] + [9.0 + 0.02 * step for step in range(4)]
        map = MAP.replace('column = "episode"', "gap_s = 1.0")
        for kind in ALL:
            _, episodes = self.whole(*self.change(kind, map, t=times))
            self.assertEqual([episode["steps"] for episode in episodes], [4, 3])
            (note,) = episodes[0]["notes"]
            self.assertEqual(note["step"], 4)
            self.assertIn("8.920 s later", note["what"])

    def test_a_number_of_rows_cuts(self):
        map = MAP.replace('column = "episode"', "every = 3").replace('[time]\ncolumn = "t"\nunit = "s"', "[time]\nperiod_us = 20000")
        for kind in ALL:
            source, episodes = self.whole(*self.change(kind, map))
            self.assertEqual([episode["steps"] for episode in episodes], [2, 2, 2])
            self.assertEqual((source["period_us"], source["period_from"]), (20_000, "period_us in the map"))

    def test_end_flags_cut_where_no_other_rule_does(self):
        map = MAP.replace('[episode]\ncolumn = "episode"', '[terminated]\ncolumn = "end"').replace('[time]\ncolumn = "t"\nunit = "s"', "")
        for kind, yes in [("npz", True), ("csv", "true"), ("jsonl", True)]:
            ends = [yes if row == 4 else False for row in range(9)]
            source, episodes = self.whole(*self.change(kind, map, end=ends))
            self.assertEqual([episode["steps"] for episode in episodes], [4, 3])
            self.same(episodes[0]["terminations"], [False, False, False, True])
            self.assertFalse(episodes[1]["terminations"].any())
            self.assertIsNone(source["period_us"])

    def test_an_end_flag_inside_an_episode_is_a_fault(self):
        map = MAP + '[truncated]\ncolumn = "end"\n'
        for kind in ALL:
            fault = self.fault(*self.change(kind, map, end=[1 if row == 6 else 0 for row in range(9)]))
            self.assertEqual((fault["episode"], fault["step"]), ("second", 1))

    def test_time_that_stands_still_or_goes_backward_is_a_fault(self):
        for kind in ALL:
            for value, words in [(0.02, "is that of the row before"), (0.01, "goes backward")]:
                times = self.rows()["t"]
                times[2] = value
                fault = self.fault(*self.change(kind, t=times))
                self.assertIn(words, fault["what"])
                self.assertEqual((fault["episode"], fault["step"]), ("first", 2))

    def test_the_time_between_episodes_has_no_part_in_the_period(self):
        times = [row // 2 + 0.02 * (row % 2) for row in range(9)]
        for kind in ALL:
            source, episodes = self.whole(*self.change(kind, episode=[f"{row // 2}" for row in range(9)], t=times))
            self.assertEqual((source["period_us"], len(episodes)), (20_000, 4))

    def test_gaps_and_jitter_are_told_with_their_steps(self):
        times = self.rows()["t"]
        times[3:5] = [0.5, 0.525]
        _, episodes = self.whole(*self.change("csv", t=times))
        self.assertEqual(episodes[0]["notes"][0], {"step": 3, "what": "a gap of 23.0 periods"})
        self.assertIn("varies between 20000 and 25000 us", episodes[0]["notes"][1]["what"])

    def test_nanoseconds_since_1970_stay_exact(self):
        map = MAP.replace('"s"', '"ns"')
        start = 1_700_000_000_000_000_001
        times = [start + 20_000_000 * step for step in range(9)]
        times[3] = times[2] + 1
        for kind in ALL:
            fault_free = [*times[:3], times[2] + 1, *times[4:]]
            source, _ = self.whole(*self.change(kind, map, t=fault_free))
            self.assertEqual(source["period_us"], 20_000)
            doubled = [*times[:3], times[2], *times[4:]]
            self.assertIn("is that of the row before", self.fault(*self.change(kind, map, t=doubled))["what"])

    def test_an_episode_that_comes_back_is_a_fault(self):
        names = ["a"] * 3 + ["b"] * 3 + ["a"] * 3
        for kind in ALL:
            fault = self.fault(*self.change(kind, episode=names, t=[0.02 * row for row in range(9)]))
            self.assertIn("come back", fault["what"])
            self.assertEqual(fault["episode"], "a")

    def test_a_value_that_is_missing_or_none_is_a_fault_with_its_place(self):
        for kind, value in [("csv", ""), ("csv", "nan"), ("jsonl", None), ("jsonl", float("inf")), ("npz", float("nan"))]:
            values = self.rows()["v"]
            values[6] = value
            fault = self.fault(*self.change(kind, v=values))
            self.assertIn("observation channel v is", fault["what"])
            self.assertEqual((fault["episode"], fault["step"]), ("second", 1))

    def test_a_text_among_numbers_is_a_fault(self):
        for kind in ("csv", "jsonl"):
            values = self.rows()["v"]
            values[6] = "fast"
            self.assertIn("fast", self.fault(*self.change(kind, v=values))["what"])

    def test_a_flag_that_is_none_is_a_fault(self):
        flags = self.rows()["ok"]
        flags[2] = 0.5
        fault = self.fault(*self.change("jsonl", ok=flags))
        self.assertEqual((fault["episode"], fault["step"]), ("first", 2))

    def test_one_column_may_be_the_reward_and_the_success(self):
        for kind in ALL:
            source, episodes = self.whole(*self.change(kind, MAP.replace('column = "r"', 'column = "ok"')))
            self.assertEqual(episodes[1]["success"].tolist(), [False, False, True])
            self.same(episodes[1]["rewards"], [0.0, 0.0, 0.0])

    def test_the_action_may_be_the_next_position(self):
        rows = self.rows()
        map = MAP.replace('[action]\ncolumns = ["u"]', '[action]\nfrom_next = ["x"]')
        source, episodes = self.whole(self.write("csv", rows), *self.map(map))
        self.assertEqual(source["action"], [{"name": "x_next"}])
        self.same(episodes[0]["actions"][:, 0], rows["x"][1:5])

    def test_wide_columns_may_be_named_whole_or_by_one_of_their_numbers(self):
        state = numbers(7, 9, 3)
        map = MAP.replace('columns = ["x", "v"]', 'columns = ["state", "x"]').replace('columns = ["u"]', 'columns = ["state_1"]')
        for kind, wide in [("npz", state), ("jsonl", state.tolist())]:
            source, episodes = self.whole(*self.change(kind, map, state=wide))
            self.assertEqual([channel["name"] for channel in source["observation"]], ["state_0", "state_1", "state_2", "x"])
            self.same(episodes[0]["observations"][:, :3], state[:5].astype(np.float32))
            self.same(episodes[0]["actions"][:, 0], state[:4, 1])

    def test_objects_inside_objects_are_named_with_a_dot(self):
        map = MAP.replace('columns = ["x", "v"]', 'columns = ["arm.x", "arm.v"]')
        arm = [{"x": x, "v": v} for x, v in zip(self.rows()["x"], self.rows()["v"])]
        _, episodes = self.whole(*self.change("jsonl", map, arm=arm))
        self.same(episodes[1]["observations"][:, 0], np.array(self.rows()["x"][5:], np.float32))

    def test_without_a_map_the_columns_are_named(self):
        for kind in ALL:
            fault = self.fault(self.write(kind, self.rows()))
            self.assertIn("t, x, v, u, r, ok, episode", fault["what"])
            self.assertIn("--map", fault["way_out"])
            self.assertIn("not yet: what the columns mean", self.described(self.write(kind, self.rows())))

    def test_a_map_that_does_not_fit_the_table_is_a_fault_that_names_what_there_is(self):
        for old, new, words, way_out in [
            ('"x", "v"', '"x", "y"', "no column y", "t, x, v"),
            ('"x", "v"', '"x", "x"', "x stands twice", "once"),
            ('column = "r"', 'column = "reward"', "no column reward", "t, x, v"),
            ('column = "episode"', "", "nothing says where an episode ends", "gap_s"),
            ('unit = "s"', "", "no unit in [time]", "a name"),
            ('columns = ["u"]', "", "either columns or from_next", "commands"),
            ('column = "episode"', 'column = "x"', "the column x is a number of the robot", "twice"),
        ]:
            fault = self.fault(self.write("csv", self.rows()), *self.map(MAP.replace(old, new)))
            self.assertIn(words, fault["what"])
            self.assertIn(way_out, fault["way_out"])

    def test_columns_of_one_name_and_lines_of_another_width_are_faults(self):
        path = self.folder / "log.csv"
        path.write_text("t,x,x\n0,1,2\n")
        self.assertIn("two columns are called x", self.fault(path)["what"])
        path.write_text("t,x,v,u,r,ok,episode\n0,1,2,3,4,0,a\n0.02,1\n")
        self.assertIn("Expected 7 columns, got 2", self.fault(path, *self.map(MAP))["what"])

    def test_broken_json_is_a_fault_with_its_line(self):
        path = self.write("jsonl", self.rows())
        path.write_text(path.read_text() + "{]\n")
        self.assertIn("line 10 is no JSON", self.fault(path, *self.map(MAP))["what"])

    def test_arrays_of_different_lengths_are_a_fault(self):
        self.assertIn("different lengths", self.fault(*self.change("npz", v=np.zeros(4)))["what"])

    def test_arrays_of_python_objects_are_a_fault(self):
        fault = self.fault(*self.change("npz", v=np.array([None] * 9)))
        self.assertIn("Python objects", fault["what"])

    def test_columns_that_lie_behind_one_another_are_read_as_rows(self):
        state = np.asfortranarray(numbers(7, 9, 3))
        map = MAP.replace('columns = ["x", "v"]', 'columns = ["state"]')
        _, episodes = self.whole(*self.change("npz", map, state=state))
        self.same(episodes[1]["observations"], state[5:].astype(np.float32))


if __name__ == "__main__":
    unittest.main()
