"""Tests of calling the program from Python.

    BRAKEWAVE=target/release/brakewave python3 python/test_program.py
"""

import contextlib
import io
import os
import runpy
import subprocess
import sys
import tempfile
import unittest
import warnings
from pathlib import Path

try:
    import matplotlib

    matplotlib.use("Agg")
    import numpy
    import pandas

    import brakewave
except ImportError as error:
    print(f"tests of the package brakewave skipped: {error}")
    sys.exit(0)

from brakewave import variant

ROOT = Path(__file__).resolve().parent.parent


def impact(**sections):
    """The oscillator of problems/impact_oscillator.ron."""
    free = dict(
        rates={"x": "v", "v": "A*cos(phase) - c*v - x"},
        until=[dict(zero="d - x", to="free", reset={"v": "-e*v"})],
    )
    rest = variant.Simulate(mode="free", state={"x": 0.0, "v": 0.0}, settle=200)
    return dict(
        title="Impact",
        system=dict(
            states=["x", "v"],
            parameters={"c": 0.1, "A": 1.0, "w": 1.0, "d": 1, "e": numpy.float64(0.8)},
            forcing="w",
            modes={"free": free},
        ),
        orbit=dict(start=rest),
        **sections,
    )


class Program(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(folder.name)

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
            "range: (0.1, 1e-20), toward: Down, values: Linear(0, 1.5, 3), start: Given(state: {\"x\": true}), "
            "stability: ())",
        )
        with self.assertRaises(TypeError):
            brakewave.ron({"x": 1j})

    def test_a_dict_is_followed_to_its_events(self):
        problem = impact(
            continuation=dict(parameter="A", range=(0.05, 1.0), toward=variant.Down), stability={}, output=dict(profiles=2)
        )
        run = brakewave.run(problem, name="impact", quiet=True)
        self.assertEqual(run.path, Path("results/impact"))
        events = run.events.set_index("type")
        # the graze is where |1 + icω − ω²| A⁻¹ = 1
        self.assertAlmostEqual(events.loc["GR", "A"], 0.1, delta=1e-12)
        self.assertLess(events.loc["LP", "A"], 0.1)
        self.assertIn("GR", run.said)
        self.assertEqual(brakewave.varying(run.branch), ["A"])
        axes = brakewave.draw_branch(run)
        self.assertEqual((axes.get_xlabel(), axes.get_ylabel()), ("A", "max_x"))
        self.assertGreater(len(run.multipliers), 0)
        # the same folder again
        with self.assertRaises(brakewave.Refused) as refused:
            brakewave.run(problem, name="impact", quiet=True)
        self.assertEqual(refused.exception.code, 2)
        self.assertIn("--force", str(refused.exception))
        brakewave.run(problem, name="impact", quiet=True, force=True)

    def test_maps(self):
        side = lambda name, *ends: dict(parameter=name, range=ends)
        section = dict(first=side("A", 0.02, 0.06), second=side("e", 0.5, 0.8), points=variant.Grid(rows=2, columns=3))
        folder = brakewave.map(impact(map=section), out="plane", quiet=True, threads=2)
        table = folder.map
        self.assertEqual((folder.kind, len(table)), ("map", 6))
        self.assertEqual(set(table["found"]) | set(table["regimes"]), {"orbit", "free"})
        # at resonance it does not touch, and swings to A/cω
        self.assertLess((table["max_x"] - table["A"] / 0.1).abs().max(), 1e-11)
        axes = brakewave.draw_map(folder)
        self.assertEqual((axes.get_xlabel(), axes.get_ylabel()), ("A", "e"))
        drawn = {line.get_label(): sorted(zip(*line.get_data())) for line in axes.lines}
        self.assertEqual(drawn, {"free": sorted(zip(table["A"], table["e"]))})

    def test_basins_and_shares(self):
        side = lambda name, *ends: dict(state=name, range=ends)
        shares = dict(parameter="A", values=variant.Linear(0.02, 0.06, 2), draws=3, seed=1)
        section = dict(first=side("x", -0.1, 0.1), second=side("v", -0.1, 0.2), points=variant.Grid(rows=2, columns=3))
        problem = impact(map=dict(section, shares=shares))
        # the values of parameters may be expressions in those before them
        problem["system"]["parameters"]["A"] = "c/2"
        folder = brakewave.map(problem, out="basin", quiet=True, threads=2)
        table, attractors, shares = folder.map, folder.attractors, folder.shares
        self.assertEqual(list(table["attractor"]), [1] * 6)
        self.assertEqual(list(attractors)[:6], ["attractor", "regimes", "period", "periods", "stable", "share"])
        # at resonance x = A sin(phase)/cω
        self.assertLess(abs(attractors["x"][0]) + abs(attractors["v"][0] - 0.5), 1e-10)
        self.assertEqual(list(shares["share"]), [1.0, 1.0])
        self.assertLess((shares["v"] - shares["value"] / 0.1).abs().max(), 1e-10)
        axes = brakewave.draw_map(folder)
        self.assertEqual((axes.get_xlabel(), axes.get_ylabel()), ("column", "row"))

    def test_exponents(self):
        values = variant.Linear(0.05, 0.09, 2)
        scan = dict(parameter="A", values=values, settle=100, keep=9, section=variant.Phase(0.0), lyapunov=2)
        folder = brakewave.scan(impact(scan=scan), out="l", quiet=True)
        table = folder.scan
        self.assertEqual([table[name].dtype for name in ("x", "v", "lyapunov", "lyapunov_2")], [float] * 4)
        # those of a complex pair, whose sum is −c
        self.assertLess((table["lyapunov"] + table["lyapunov_2"] + 0.1).abs().max(), 1e-12)
        self.assertEqual(len(brakewave.draw_exponents(folder).lines), 3)

    def test_curves(self):
        section = dict(event=variant.GR, parameters=("A", "c"), range=((0.05, 0.2), (0.05, 0.2)))
        along = dict(parameter="A", range=(0.05, 1.0), toward=variant.Down)
        folder = brakewave.curve(impact(continuation=along, curve=section), out="grazes", quiet=True)
        # at resonance it touches where A = cd
        self.assertLess((folder.curve["A"] - folder.curve["c"]).abs().max(), 1e-12)
        axes = brakewave.draw_curve(folder)
        self.assertEqual((axes.get_xlabel(), axes.get_ylabel()), ("A", "c"))

    def test_scans_simulations_and_equilibria(self):
        values = variant.Linear(0.05, 0.09, 5)
        problem = impact(
            scan=dict(parameter="A", values=values, sweep=variant.Both, settle=300, keep=3, section=variant.Phase(0.0)),
            simulation=dict(duration=20.0, samples=40),
        )
        scan = brakewave.scan(problem, out="s", quiet=True, threads=2)
        self.assertEqual(list(scan.scan), ["value", "sweep", "sample", "x", "v", "phase", "mode", "why"])
        table = scan.scan
        self.assertEqual(len(table), 30)
        # at resonance x = A sin(phase)/cω: zero at phase 0, where v = A/c; what is left of the start falls like
        # exp(−300·2π·c/2), and each period rounds a phase of 1900 to 2e-13
        self.assertLess((table["v"] - table["value"] / 0.1).abs().max(), 300 * 3e-13)
        self.assertLess(table["x"].abs().max(), 300 * 3e-13)
        brakewave.draw_scan(scan)
        motion = brakewave.simulate(problem, out="m", quiet=True)
        self.assertEqual(len(motion.series), 41)
        self.assertEqual(set(motion.series["mode"]), {"free"})
        still = impact()
        del still["system"]["forcing"], still["system"]["parameters"]["w"]
        still["system"]["modes"]["free"]["rates"]["v"] = "A - c*v - x"
        steady = brakewave.steady(still, out="e", quiet=True).steady
        self.assertAlmostEqual(steady["x"].iloc[0], 1.0, delta=1e-15)

    def test_what_is_refused_is_an_exception_with_its_message(self):
        problem = impact(continuation=dict(parameter="B", range=(0.05, 1.0)))
        said = io.StringIO()
        with self.assertRaises(brakewave.Refused) as refused, contextlib.redirect_stderr(said):
            brakewave.run(problem, out="no")
        self.assertEqual(refused.exception.code, 2)
        self.assertIn("`B` is no parameter", str(refused.exception))
        self.assertIn("`B` is no parameter", said.getvalue())
        # an end before the range keeps what there is
        problem = impact(continuation=dict(parameter="A", range=(0.05, 1.0), toward=variant.Down, max_points=5))
        with warnings.catch_warnings(record=True) as warned:
            warnings.simplefilter("always")
            run = brakewave.run(problem, out="short", quiet=True)
        self.assertEqual(run.branch["type"].iloc[-1], "MX")
        self.assertEqual(len(warned), 1)
        os.environ["BRAKEWAVE"], kept = "", os.environ.get("BRAKEWAVE", "")
        path, os.environ["PATH"] = os.environ["PATH"], ""
        try:
            with self.assertRaises(FileNotFoundError):
                brakewave.run(problem)
        finally:
            os.environ["BRAKEWAVE"], os.environ["PATH"] = kept, path

    def test_the_notebook_of_the_docs_runs(self):
        with contextlib.redirect_stdout(io.StringIO()):
            runpy.run_path(str(ROOT / "docs" / "notebook.py"), run_name="__main__")
        self.assertGreater(Path("impact.png").stat().st_size, 10_000)

    def test_the_checker_is_a_module(self):
        path = str(ROOT / "python")
        called = [sys.executable, "-m", "brakewave.check"]
        done = subprocess.run(called, capture_output=True, text=True, env={**os.environ, "PYTHONPATH": path})
        # without arguments it says what it is for, or what it needs
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, "brakewave.check results|python-flint")


def binary():
    """The binary to test with."""
    built = (ROOT / "target" / profile / "brakewave" for profile in ["release", "debug"])
    found = [os.environ.get("BRAKEWAVE"), *map(str, filter(Path.is_file, built))]
    return next((str(Path(path).absolute()) for path in found if path), None)


if __name__ == "__main__":
    found = binary()
    if found:
        os.environ["BRAKEWAVE"] = found
    unittest.main()
