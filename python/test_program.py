"""Tests of calling the program from Python.

    BRAKEWAVE=target/release/brakewave python3 python/test_program.py
"""

import inspect
import os
import re
import subprocess
import sys
import tempfile
import unittest
import warnings
from pathlib import Path
from unittest import mock

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
from testing import ROOT, require_binary


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


class InFolder(unittest.TestCase):
    """Tests in a folder of their own."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(folder.name)


class Program(InFolder):
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
        self.assertEqual((axes.get_xlabel(), axes.get_ylabel()), ("A", "min_x"))
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
        self.assertEqual([folder.states for folder in (scan, motion)], [["x", "v"]] * 2)
        self.assertEqual(len(motion.series), 41)
        self.assertEqual(set(motion.series["mode"]), {"free"})
        still = impact()
        del still["system"]["forcing"], still["system"]["parameters"]["w"]
        still["system"]["modes"]["free"]["rates"]["v"] = "A - c*v - x"
        steady = brakewave.steady(still, out="e", quiet=True).steady
        self.assertAlmostEqual(steady["x"].iloc[0], 1.0, delta=1e-15)



BRANCH = dict(parameter="A", range=(0.05, 1.0), toward=variant.Down)

WAVES = dict(
    model=dict(coefficients=variant.Geometry(nu=0.3, xi=1.5, gamma=1.0), friction=0.5, mismatch=0.2),
    wave=dict(mode=4, start=variant.Fast),
    continuation=dict(parameter=variant.Mismatch, range=(0.045, 0.2), toward=variant.Down),
)


class Verbs(InFolder):
    def test_proofs_are_written_and_verified(self):
        problem = impact(continuation=BRANCH)
        folder = brakewave.certify(problem, out="proofs", quiet=True)
        self.assertEqual(folder.kind, "certificate")
        table = folder.certificates.set_index("type")
        self.assertEqual(set(table["proven"]), {"yes"})
        # at resonance it touches where A = cd
        self.assertTrue(table.loc["GR", "low"] <= 0.1 <= table.loc["GR", "high"])
        self.assertRegex(brakewave.verify(folder, quiet=True), "GR: verified")
        certificate = folder.path / "certificate.ron"
        text = certificate.read_text(encoding="utf-8")
        certificate.write_text(text.replace("stable: true", "stable: false").replace("kind: GR", "kind: PD"), encoding="utf-8")
        with self.assertRaises(brakewave.Refused) as refused:
            brakewave.verify(folder, quiet=True)
        self.assertNotEqual(refused.exception.code, 0)

    def test_expectations_are_compared(self):
        graze = dict(event=variant.GR, A=0.1, tolerance=1e-12)
        met, unmet = (impact(continuation=BRANCH, expect=[dict(graze, A=value)]) for value in (0.1, 0.2))
        nothing = impact(continuation=BRANCH)
        checked = brakewave.check(met, quiet=True)
        self.assertTrue(checked and checked.passed)
        self.assertEqual(list(checked.table.loc[0])[0::2], ["problem", "passed"])
        # that nothing is expected is no success
        with self.assertWarnsRegex(UserWarning, "1 of 3 problem files expect nothing"):
            checked = brakewave.check(met, unmet, nothing, quiet=True, junit="junit.xml")
        self.assertFalse(checked)
        self.assertEqual(list(checked.table["problem"]), ["problem 1", "problem 2", "problem 3"])
        self.assertEqual(list(checked.table["verdict"]), ["passed", "failed", "skipped"])
        self.assertIn("FAIL", checked.table["what"][1])
        self.assertEqual(repr(checked), "Checked: 1 passed, 1 failed, 1 skipped")
        self.assertIn("<table", checked._repr_html_())
        self.assertNotIn("/tmp", checked.said)
        self.assertTrue(Path("junit.xml").is_file())
        with self.assertWarns(UserWarning):
            self.assertFalse(brakewave.check(nothing))
        with self.assertRaisesRegex(brakewave.Refused, "continuation.parameter: `B` is no parameter"):
            brakewave.check(met, impact(continuation=dict(BRANCH, parameter="B"), expect=[graze]))

    def test_a_report_and_pictures_are_written(self):
        run = brakewave.run(impact(continuation=BRANCH, output=dict(plots=[variant.Diagram])), out="run", quiet=True)
        page = brakewave.report(run)
        self.assertEqual(page, Path("run/report.html"))
        self.assertIn("<svg", page.read_text(encoding="utf-8"))
        drawn = brakewave.plot(run)
        self.assertEqual(drawn, [Path("run/diagram.svg")])
        self.assertRegex(drawn._repr_html_(), "^<img src=.data:image/svg.xml;base64,")
        view = brakewave.plot("run", x="A", y="min_v", range=numpy.array([-0.06, 0.2]), range_y=(-1, 0))
        self.assertEqual(view, [Path("run/view.svg")])
        self.assertEqual(brakewave.plot(run, format="tex"), [Path("run/diagram.tex")])
        with self.assertRaisesRegex(brakewave.Refused, "no numeric column `z`"):
            brakewave.plot(run, y="z", force=True)

    def test_eigenvalues_are_a_table(self):
        table = brakewave.spectrum(WAVES, at={"mismatch": numpy.float64(0.08)}, sector=2, quiet=True)
        self.assertEqual((set(table["sector"]), set(table["mismatch"])), ({2}, {0.08}))
        self.assertEqual(table["re"].dtype, float)
        same = brakewave.spectrum(WAVES, at="mismatch=0.08", sector=2, quiet=True)
        pandas.testing.assert_frame_equal(table, same)
        with self.assertRaisesRegex(brakewave.Refused, "`friction` is no number|lies outside the range|not admitted"):
            brakewave.spectrum(WAVES, at={"mismatch": 0.3}, quiet=True)

    def test_methods_are_compared(self):
        with warnings.catch_warnings():
            # how many methods fit into the budget is up to the machine
            warnings.simplefilter("ignore")
            folder = brakewave.accuracy(WAVES, out="methods", budget=1.0, repeats=1, quiet=True)
        self.assertEqual(folder.kind, "accuracy")
        self.assertIn("method", folder.accuracy)

    def test_shards_are_joined(self):
        plane = dict(
            first=dict(parameter="A", range=(0.05, 0.09)), second=dict(parameter="w", range=(1.0, 1.1)), points=variant.Grid(rows=2, columns=2)
        )
        values = variant.Linear(0.05, 0.09, 4)
        scan = dict(parameter="A", values=values, sweep=variant.Both, settle=300, keep=3, section=variant.Phase(0.0))
        for verb, problem, table in [(brakewave.map, impact(map=plane), "map.csv"), (brakewave.scan, impact(scan=scan), "scan.csv")]:
            kind = verb.__name__
            whole = verb(problem, out=kind, quiet=True)
            shards = [verb(problem, out=f"{kind}-{index}", shard=f"{index}/2", quiet=True) for index in (1, 2)]
            joined = brakewave.merge(shards, out=f"{kind}-joined", quiet=True, plot=f"{kind}.svg")
            self.assertEqual(joined.kind, kind)
            self.assertEqual((joined.path / table).read_bytes(), (whole.path / table).read_bytes())
            self.assertTrue(Path(f"{kind}.svg").is_file())
            with self.assertRaises(brakewave.Refused):
                brakewave.merge(shards[:1], out=f"{kind}-part", quiet=True)
        with self.assertRaises(ValueError):
            brakewave.merge([], out="none")

    def test_modes_of_steady_sliding(self):
        with self.assertWarnsRegex(UserWarning, "a higher one may go earlier"):
            folder = brakewave.steady(WAVES, out="modes", modes="3..4", at={"friction": 0.4}, families=1, quiet=True)
        self.assertEqual(list(folder.steady["mode"]), [3, 4])

    def test_a_computation_that_ends_early_is_kept_with_a_warning(self):
        problem = impact(continuation=dict(BRANCH, max_points=5))
        with self.assertWarnsRegex(brakewave.Incomplete, "^the branch ended before its range: max_points = 5"):
            run = brakewave.run(problem, out="short", quiet=True)
        self.assertEqual(run.branch["type"].iloc[-1], "MX")
        # what cannot begin is refused, also where there are earlier results
        nowhere = impact(continuation=BRANCH)
        nowhere["system"]["modes"]["free"]["rates"]["v"] = "1 + x^2"
        with self.assertRaises(brakewave.Refused):
            brakewave.run(nowhere, out="short", force=True, quiet=True)

    def test_a_notebook_shows_table_and_picture(self):
        drawn = impact(continuation=BRANCH, stability={}, output=dict(plots=[variant.Multipliers, variant.Diagram]))
        plain = impact(continuation=BRANCH)
        for name, problem in [("drawn", drawn), ("plain", plain)]:
            run = brakewave.run(problem, out=name, quiet=True)
            self.assertRegex(repr(run), rf"^Folder\('{name}'\) of a run: branch \(264 rows\), events \(4 rows\)")
            page = run._repr_html_()
            # the parameter that changes, and not the others
            self.assertRegex(page, "<th>A</th>\\s*<th>period</th>")
            self.assertEqual(page.count("<img src="), 1)
            self.assertNotIn("<svg", page)
        self.assertEqual(brakewave.Folder("drawn").pictures, [Path("drawn/diagram.svg"), Path("drawn/multipliers.svg")])
        values = variant.Linear(0.05, 0.09, 5)
        scan = dict(parameter="A", values=values, settle=300, keep=3, section=variant.Phase(0.0))
        self.assertEqual(brakewave.scan(impact(scan=scan), out="s", quiet=True)._repr_html_().count("<img src="), 1)
        # what is not whole is shown as far as it is there
        for name in ("branch.csv", "events.csv"):
            Path("plain", name).write_text("", encoding="utf-8")
        self.assertIn("events (0 rows)", brakewave.Folder("plain")._repr_html_())

    def test_the_program_is_the_one_that_is_named_installed_or_on_the_path(self):
        named = os.environ["BRAKEWAVE"]
        kept = {name: os.environ.get(name, "") for name in ("BRAKEWAVE", "PATH")}
        self.addCleanup(os.environ.update, kept)
        Path("scripts").mkdir()
        Path("path").mkdir()
        on_path, installed = (Path(folder, "brakewave").absolute() for folder in ("path", "scripts"))
        on_path.symlink_to(named)
        os.environ.update(BRAKEWAVE="", PATH=str(on_path.parent))
        with mock.patch("sysconfig.get_path", lambda *_: str(installed.parent)):
            self.assertEqual(brakewave.binary(), str(on_path))
            installed.symlink_to(named)
            self.assertEqual(brakewave.binary(), str(installed))
            os.environ["BRAKEWAVE"] = named
            self.assertEqual(brakewave.binary(), named)
        os.environ.update(BRAKEWAVE="", PATH="")
        with mock.patch("sysconfig.get_path", lambda *_: "/nowhere"), self.assertRaises(FileNotFoundError):
            brakewave.run(impact(continuation=BRANCH))


class Package(unittest.TestCase):
    def test_what_it_offers_is_there_and_is_known_to_type_checkers(self):
        text = (ROOT / "python" / "brakewave" / "__init__.py").read_text(encoding="utf-8")
        typed = {name for name, other in re.findall(r"\b(\w+) as (\w+)", text) if name == other}
        self.assertEqual(typed, set(brakewave.__all__))
        for name in brakewave.__all__:
            self.assertIsNotNone(getattr(brakewave, name))
        self.assertTrue((ROOT / "python" / "brakewave" / "py.typed").is_file())
        with self.assertRaises(AttributeError):
            brakewave.nothing

    def test_all_that_can_be_called_is_annotated(self):
        offered = [getattr(brakewave, name) for name in brakewave.__all__]
        own = [thing for thing in offered if callable(thing) and not isinstance(thing, brakewave.Variant)]
        methods = [method for thing in own if isinstance(thing, type) for method in vars(thing).values() if inspect.isfunction(method)]
        for function in [*filter(inspect.isfunction, own), *methods]:
            if str(ROOT) not in function.__code__.co_filename:
                continue  # made by dataclass
            signature = inspect.signature(function)
            bare = [name for name, one in signature.parameters.items() if one.annotation is one.empty and name != "self"]
            self.assertEqual((bare, signature.return_annotation is signature.empty), ([], False), function.__qualname__)

    def test_the_checker_is_a_module_and_a_verb(self):
        # after an import of the module its name still is the verb
        code = "import brakewave.check; import brakewave; print(brakewave.check(__import__('sys').argv[1]))"
        path = ROOT / "problems" / "impact_oscillator.ron"
        done = subprocess.run([sys.executable, "-c", code, str(path)], capture_output=True, text=True)
        if "python-flint" in done.stderr:
            self.skipTest("python-flint is not here")
        self.assertRegex(done.stdout, "^Checked: [0-9]+ passed$")

    def test_versions_and_licences_are_those_of_the_crate(self):
        version = re.search(r'^version = "(.*)"', (ROOT / "Cargo.toml").read_text(encoding="utf-8"), re.M)[1]
        citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
        self.assertIn(f"\nversion: {version}\n", citation)
        self.assertEqual((ROOT / "python" / "LICENSE.txt").read_bytes(), (ROOT / "LICENSE").read_bytes())


if __name__ == "__main__":
    require_binary()
    unittest.main()
