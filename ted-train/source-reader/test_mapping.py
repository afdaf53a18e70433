"""What a map may say, and what is refused in it."""

import unittest

from reading import Reading


class Maps(Reading):
    def test_everything_unknown_or_of_another_kind_is_a_fault_that_says_what_there_is(self):
        source = self.folder / "log.csv"
        source.write_text("a\n1\n")
        for text, words, way_out in [
            ("[observations]\n", "unknown section [observations]", "observation, action"),
            ("[observation]\ncolumn = []\n", "unknown key column in [observation]", "columns"),
            ("[observation]\ncolumns = []\n", "columns in [observation] is []", "a list of names"),
            ('[observation]\ncolumns = "a"\n', "columns in [observation] is 'a'", "a list of names"),
            ("[episode]\nevery = 0\n", "every in [episode] is 0", "a whole number above 0"),
            ("[episode]\nevery = 2.5\n", "every in [episode] is 2.5", "a whole number above 0"),
            ("[episode]\ngap_s = true\n", "gap_s in [episode] is True", "a number above 0"),
            ('[time]\nunit = "h"\n', "the unit of time h is unknown", "s, ms, us, ns"),
            ('topics = "a"\n', "topics is no section", "[topics]"),
            ('[topics]\n"/a" = "x"\n', "/a in [topics] is 'x'", "names with the fields"),
            ("[episode\n", "is no TOML", "correct it"),
        ]:
            fault = self.fault(source, *self.map(text))
            self.assertIn(words, fault["what"])
            self.assertIn(way_out, fault["way_out"])

    def test_a_map_that_is_not_there_is_a_fault(self):
        self.assertIn("cannot be read", self.fault("log.csv", "--map", str(self.folder / "none.toml"))["what"])


if __name__ == "__main__":
    unittest.main()
