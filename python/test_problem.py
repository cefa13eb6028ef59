"""Tests of problems as dicts: the text that they become, and what is said of mistakes in them.

    BRAKEWAVE=target/release/brakewave python3 python/test_problem.py
"""

import contextlib
import copy
import io
import os
import re
import sys
import tempfile
import unittest
import warnings

try:
    import numpy
    import pandas

    import brakewave
except ImportError as error:
    print(f"tests of problems as dicts skipped: {error}")
    sys.exit(0)

from brakewave import variant
from brakewave.problem import MAPS, TUPLES, Text
from testing import ROOT, require_binary

PROBLEM = dict(
    title="Impact",
    system=dict(
        states=["x", "v"],
        parameters={"c": 0.1, "A": 1.0, "w": 1.0, "d": 1.0, "e": 0.8},
        forcing="w",
        modes={
            "free": dict(
                rates={"x": "v", "v": "A*cos(phase) - c*v - x"},
                until=[dict(zero="d - x", to="free", reset={"v": "-e*v"})],
            )
        },
    ),
    orbit=dict(start=variant.Simulate(mode="free", state={"x": 0.0, "v": 0.0}, settle=200)),
    continuation=dict(parameter="A", range=(0.05, 1.0), toward=variant.Down),
)


def changed(*keys, **entries):
    """The problem with other entries in the dict, or the list, that the keys lead to."""
    problem = copy.deepcopy(PROBLEM)
    place = problem
    for key in keys:
        place = place[key]
    place.update(entries)
    return problem


class Written(unittest.TestCase):
    def test_values_are_written_as_ron(self):
        written = brakewave.ron(
            dict(
                title='a "b" \\',
                parameters={"A": 1, "e": 0.5},
                modes={"state": dict(rates={"x": "-x"}, until=[])},
                range=(0.1, 1e-20),
                toward=variant.Down,
                values=variant.Linear(0, 1.5, numpy.int64(3)),
                start=variant.Given(state={"x": True}),
                left=None,
                stability={},
            )
        )
        self.assertEqual(
            written,
            '(title: "a \\"b\\" \\\\", parameters: {"A": 1, "e": 0.5}, modes: {"state": (rates: {"x": "-x"}, until: [])}, '
            'range: (0.1, 1e-20), toward: Down, values: Linear(0, 1.5, 3), start: Given(state: {"x": true}), '
            "stability: ())",
        )

    def test_brackets_follow_from_the_field_and_numbers_may_be_of_numpy(self):
        ends = numpy.array([0.25, 1.0])
        for range_ in [(0.25, 1.0), [0.25, 1.0], ends, pandas.Series(ends), map(float, ends)]:
            self.assertEqual(brakewave.ron(dict(range=range_)), "(range: (0.25, 1.0))")
        for states in [("x", "v"), ["x", "v"], numpy.array(["x", "v"])]:
            self.assertEqual(brakewave.ron(dict(states=states)), '(states: ["x", "v"])')
        for number, written in [
            (numpy.float64(0.1), "0.1"),
            (numpy.float32(0.5), "0.5"),
            (numpy.int32(7), "7"),
            (numpy.array(0.1), "0.1"),
            (numpy.bool_(True), "true"),
            (float("inf"), "inf"),
            (10**400, "1" + 400 * "0"),
        ]:
            self.assertEqual(brakewave.ron(dict(number=number)), f"(number: {written})")
        nested = dict(parameters=["A", "w"], range=numpy.array([[0.5, 1.0], [2.0, 4.0]]))
        self.assertEqual(brakewave.ron(nested), '(parameters: ("A", "w"), range: ((0.5, 1.0), (2.0, 4.0)))')
        self.assertEqual(brakewave.ron(dict(within={"x": [-1, 1]})), '(within: {"x": (-1, 1)})')
        self.assertEqual(brakewave.ron(dict(sliding={"stick": ["one", "other"]})), '(sliding: {"stick": ("one", "other")})')
        self.assertEqual(brakewave.ron(dict(contacts={"q": variant.Stop(gap="x")}, if_=["v"])), '(contacts: {"q": Stop(gap: "x")}, if: ["v"])')
        # an underscore that makes no word of Python a name is one of the name
        self.assertEqual(brakewave.ron(dict(A_=0.1, lambda_=0.2)), "(A_: 0.1, lambda: 0.2)")
        self.assertEqual(brakewave.ron((1, (2,))), "(1, [2])")

    def test_every_map_and_tuple_of_a_problem_file_is_known(self):
        """By the types of the fields in the source of the program."""
        sources = [path.read_text(encoding="utf-8") for folder in ("problem", "affine") for path in (ROOT / "src" / folder).rglob("*.rs")]
        fields = re.findall(r"^    pub (?:\(crate\) )?(\w+): (.*),$", "\n".join(sources), re.M)
        maps = {name for name, kind in fields if re.match(r"(Option<)?Ordered<", kind)}
        self.assertGreaterEqual(MAPS, maps)
        self.assertLessEqual(MAPS - maps, {"numbers"})
        of_pairs = {name for name, kind in fields if re.search(r"^\(\(?f64, |Ordered<\(", kind)}
        self.assertEqual(TUPLES, of_pairs | {"parameters"})

    def test_a_long_problem_has_a_line_for_each_entry(self):
        text = Text(PROBLEM).text
        self.assertLessEqual(max(map(len, text.splitlines())), 100)
        # the same but for blanks, and the comma after the last entry
        flat = re.sub(r"\s+", "", text).replace(",)", ")").replace(",}", "}")
        self.assertEqual(flat, re.sub(r"\s+", "", brakewave.ron(PROBLEM)))

    def test_places_have_their_keys(self):
        text = Text(PROBLEM)
        for word, key in [
            ('"Impact"', "title"),
            ("title", "title"),
            ("0.8", "system.parameters.e"),
            ("cos", "system.modes.free.rates.v"),
            ('"d - x"', "system.modes.free.until[0].zero"),
            ("-e*v", "system.modes.free.until[0].reset.v"),
            ("200", "orbit.start.settle"),
            ("0.05", "continuation.range[0]"),
            ("Down", "continuation.toward"),
        ]:
            before = text.text[: text.text.index(word)]
            self.assertEqual(text.key(before.count("\n") + 1, len(before) - before.rfind("\n")), key)
        self.assertEqual(text.key(1, 1), "")

    def test_what_has_no_place_is_named_by_its_key(self):
        for value in [1j, {1, 2}, b"x", object()]:
            with self.assertRaisesRegex(TypeError, "^system.parameters.A: .* has no place in a problem"):
                brakewave.run(changed("system", "parameters", A=value))


MISTAKES = [
    # what is changed, the first line of what is said, and what is marked below it
    (changed("system", "parameters", A="q"), "system.parameters.A: `q` is no parameter that stands before this one", '"A": "q"'),
    (
        changed("system", "modes", "free", "rates", v="A*cos(phase) - δ*v"),
        "system.modes.free.rates.v: `δ` is no state, parameter or abbreviation",
        "δ*v",
    ),
    (changed("system", "modes", "free", "until", 0, to="fre"), "system.modes.free.until[0].to: `fre` is no mode; did you mean `free`?", '"fre"'),
    (changed("continuation", parameter="B"), "continuation.parameter: `B` is no parameter; known: `c`, `A`, `w`, `d`, `e`", '"B"'),
    (changed("continuation", range=[1.0, 0.05]), "`continuation.range` is (1.0, 0.05), which is not admitted", "(1.0, 0.05)"),
    (changed("continuation", max_points="many"), "`continuation.max_points` must be a whole number from 0 up, found `\"many\"`", '"many"'),
    (changed("system", states="x"), "`system.states` must be a list in square brackets, found `\"x\"`", '"x"'),
    (changed("continuation", range=[[1, 2], [3, 4]]), "an entry of `continuation.range` must be a number, found `(1, 2)`", "(1, 2)"),
]


class Mistakes(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(folder.name)

    def refused(self, call):
        """The message and the code of what is refused, of which nothing is shown."""
        shown = io.StringIO()
        with self.assertRaises(brakewave.Refused) as refused, contextlib.redirect_stderr(shown), contextlib.redirect_stdout(shown):
            call()
        self.assertEqual(shown.getvalue(), "")
        self.assertNotRegex(str(refused.exception), r"\.ron|/tmp|^error")
        return str(refused.exception), refused.exception.code

    def test_a_mistake_is_named_by_its_key_once(self):
        for problem, first, marked in MISTAKES:
            message, code = self.refused(lambda: brakewave.run(problem, out="no"))
            lines = message.splitlines()
            self.assertEqual((lines[0], code), (first, 2))
            begin = lines[2].index("^")
            self.assertIn(lines[1][begin : lines[2].rindex("^") + 1], marked)
            self.assertIn(marked, lines[1])
            self.assertTrue(lines[3].startswith("help: "), message)

    def test_what_is_missing_or_unknown_is_named_once(self):
        problem = copy.deepcopy(PROBLEM)
        del problem["continuation"]
        message, _ = self.refused(lambda: brakewave.run(problem))
        self.assertRegex(message, "^missing field `continuation` in the problem: there is no branch to follow\nhelp: ")
        message, _ = self.refused(lambda: brakewave.run(changed("continuation", towrd=variant.Down)))
        self.assertRegex(message, "^unknown field `towrd` in `continuation`; did you mean `toward`")
        message, _ = self.refused(lambda: brakewave.run(changed(orbt=1)))
        self.assertRegex(message, "^unknown field `orbt` in the problem; did you mean `orbit`")

    def test_of_a_file_its_name_is_kept(self):
        with open("mine.ron", "w", encoding="utf-8") as file:
            file.write(Text(changed("continuation", parameter="B")).text)
        with self.assertRaisesRegex(brakewave.Refused, r"^mine\.ron:15:31: `B` is no parameter"):
            brakewave.run("mine.ron")

    def test_no_warning_names_a_temporary_file(self):
        tube = dict(
            model=dict(coefficients=variant.Geometry(nu=0.3, xi=1.5, gamma=1.5), friction=0.5, mismatch=0.3),
            wave=dict(mode=4, start=variant.Fast),
            continuation=dict(parameter=variant.Mismatch, range=(0.25, 0.3), toward=variant.Down),
        )
        shown = io.StringIO()
        with warnings.catch_warnings(record=True) as warned, contextlib.redirect_stderr(shown):
            warnings.simplefilter("always")
            brakewave.run(tube, out="fast")
        self.assertEqual(len(warned), 1)
        self.assertNotRegex(str(warned[0].message), r"\.ron|/tmp|^warning")
        self.assertEqual((warned[0].filename, shown.getvalue()), (__file__, ""))

    def test_the_first_example_of_the_docs_runs(self):
        page = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
        names = {}
        exec(re.search(r"(?ms)^```python\n(.*?)^```", page)[1], names)
        self.assertIn("GR", set(names["folder"].events["type"]))
        # and the mistake that it shows is told so
        shown = re.search(r"(?m)^    system\.modes.*\n(?:    .*\n)+", page)[0]
        problem = changed("system", "modes", "free", "until", 0, to="fre")
        message, _ = self.refused(lambda: brakewave.run(problem))
        self.assertEqual(message, re.sub("(?m)^    ", "", shown).strip())

    def test_a_name_is_that_of_a_file(self):
        with self.assertRaisesRegex(ValueError, "`name`"):
            brakewave.run(PROBLEM, name="a/b")


if __name__ == "__main__":
    require_binary()
    unittest.main()
