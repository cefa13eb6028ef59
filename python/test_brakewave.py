"""Tests of brakewave.py against folders that the binary writes.

    BRAKEWAVE=target/release/brakewave python3 python/test_brakewave.py

Without the variable the binary is looked for in target/ and on PATH. Where it, pandas or matplotlib are
not there the tests are skipped, and say so.
"""

import csv
import io
import os
import re
import subprocess
import sys
import tempfile
import unittest
import warnings
from math import pi
from pathlib import Path

try:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot
    import numpy
    import pandas

    import brakewave
except ImportError as error:
    print(f"tests of python/brakewave.py skipped: {error}")
    sys.exit(0)

from testing import ROOT, binary, require_binary

MODEL = "model: (coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1.0), friction: 0.5, mismatch: 0.2),"
WAVE = "wave: (mode: 4, start: Fast),"

RUN = f"""({MODEL} {WAVE}
    continuation: (parameter: Mismatch, range: (0.004, 0.2), toward: Down, stop_at: [0.045]),
    stability: (eigenvalues: 12),
    output: (profiles: 3),
)"""

MAP = f"""({MODEL} {WAVE}
    map: (
        first: (parameter: Friction, range: (0.3, 0.6)),
        second: (parameter: Mismatch, range: (0.04, 0.3)),
        points: Grid(rows: 4, columns: 6),
    ),
)"""

CURVE = f"""({MODEL} {WAVE}
    continuation: (parameter: Mismatch, range: (0.03, 0.2), toward: Down),
    curve: (event: GR, parameters: (Mismatch, Friction), range: ((0.03, 0.1), (0.3, 0.7))),
)"""

SYSTEM = """(system: (
        states: ["type", "infinity"],
        parameters: {"first": 9.0, "from": 0.1, "to": 1.0, "method": 0.8, "points": 1.0, "sample": 1.0, "nan": 1.0,
            "NA": 1.0, "inf": 1.0, "mode": 1.0, "speed": 0.8, "max_": 1.0},
        forcing: "speed",
        modes: {"nan": (
            rates: {"type": "infinity", "infinity": "first/10*cos(phase)*points*sample - from*infinity - nan*NA*inf*type"},
            until: [(zero: "to - mode*max_*type", to: "nan", reset: {"infinity": "-method*infinity"})],
        )},
    ),
    orbit: (start: Simulate(mode: "nan", state: {"type": 0.0, "infinity": 0.0}, settle: 200), periods: 2),
    PARTS,
)"""
"""A system whose names are also columns of tables of tubes, or are read as numbers elsewhere."""

SIMULATION = f"""({MODEL} {WAVE}
    simulation: (
        body: Ring(points: {{points}}), circle: Wavelength, start: Profile(file: "PROFILE", speed: -1.2463066720931508),
        duration: 4.0, snapshots: 2,
    ),
)"""


CONSTANT = re.compile(r"const (\w+): RGBColor = RGBColor\((\w+), (\w+), (\w+)\)")
SEQUENCE = re.compile(r"Some\(\[([\w, ]+)\]\) => (\w+),")
"""Colours in the source of the program, and the sequences that have them."""

MARKERS = {"o": "*", "s": "square*", "^": "triangle*", "v": "triangle*, rotate=180", "D": "diamond*", "*": "star"}
"""Markers of matplotlib as marks of pgfplots; others have the same name."""


def of_pgfplots(text):
    """The steps of the first diagram of a source for pgfplots, each with its style, and the places of its marks, each by shape
    and colour inside."""
    steps, marks = [], {}
    for options, coordinates in re.findall(r"\\addplot\[(.*)\] coordinates \{(.*)\};", text.split("\\end{axis}")[0]):
        points = [tuple(map(float, point.split(","))) for point in re.findall(r"\((.*?)\)", coordinates)]
        if "only marks" in options:
            shape, face = re.search(r"mark=([^,]*)", options)[1], re.search(r"fill=(\w+)", options)[1]
            turned = ", rotate=180" if "rotate=180" in options else ""
            marks.setdefault((shape + turned, FACES.get(face, face)), []).extend(points)
        else:
            style = "--" if ", dashed" in options else ":" if "densely dotted" in options else "-"
            steps += [(style, one + other) for one, other in zip(points, points[1:])]
    return steps, marks


OF_LINES = ("|", "x", "+", "star")
"""Marks of pgfplots that have no inside."""

FACES = {"c828282": "#828282", "c000000": "black", "cffffff": "white"}


def of_matplotlib(axes):
    """The same of a drawing of matplotlib."""
    steps, marks = [], {}
    for line in axes.lines:
        points = [tuple(map(float, point)) for point in line.get_xydata()]
        if line.get_linestyle() == "None":
            marker = line.get_marker()
            shape = MARKERS.get(marker, marker)
            face = "white" if shape in OF_LINES else line.get_markerfacecolor()
            marks.setdefault((shape, face), []).extend(points)
        else:
            steps += [(line.get_linestyle(), one + other) for one, other in zip(points, points[1:])]
    return steps, marks


class Folders(unittest.TestCase):
    """Every kind of folder, computed once."""

    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.temporary.cleanup)
        cls.work = Path(cls.temporary.name)
        cls.run_folder = cls.compute("run", RUN)
        # the wave of the user point
        events = cls.run_folder.events
        cls.label = int(events["label"][events["mismatch"] == 0.045].iloc[0])

    @classmethod
    def call(cls, *arguments):
        done = subprocess.run([binary(), *arguments], cwd=cls.work, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise AssertionError(f"{arguments}: exit code {done.returncode}\n{done.stderr}")
        return done.stdout

    @classmethod
    def problem(cls, text, name):
        path = cls.work / f"{name}.ron"
        path.write_text(text, encoding="utf-8")
        return str(path)

    @classmethod
    def compute(cls, verb, text, name=None):
        name = name or verb
        path = cls.problem(text, name)
        cls.call(verb, path, "--out", name, "--quiet")
        return brakewave.Folder(cls.work / name)

    def simulate(self, points, name):
        profile = self.run_folder.path / "profiles" / f"{self.label}.csv"
        text = SIMULATION.format(points=points).replace("PROFILE", str(profile))
        return self.compute("simulate", text.replace("mismatch: 0.2", "mismatch: 0.045"), name)

    def test_numbers_are_those_of_the_file(self):
        """float() rounds correctly, and so must the reader, cell by cell."""
        run = self.run_folder
        tables = {"branch": run.branch, "events": run.events, "spectrum": run.spectrum}
        for name, table in tables.items():
            with open(run.path / f"{name}.csv", encoding="utf-8", newline="") as file:
                rows = list(csv.DictReader(file))
            self.assertEqual(len(rows), len(table), name)
            self.assertEqual(list(rows[0]), list(table), name)
            for column in table:
                for cell, value in zip([row[column] for row in rows], table[column]):
                    if isinstance(value, str):
                        self.assertEqual(cell, value)
                    elif cell == "":
                        self.assertTrue(pandas.isna(value), (name, column))
                    else:
                        self.assertEqual(float(cell), value, (name, column))

    def test_events_stand_on_the_branch(self):
        run = self.run_folder
        self.assertEqual(run.kind, "run")
        labelled = run.branch.dropna(subset="label").set_index("label")
        for _, event in run.events.iterrows():
            point = labelled.loc[event["label"]]
            self.assertEqual((event["type"], event["mismatch"]), (point["type"], point["mismatch"]))
        opening = run.events[run.events["type"] == "GR"].iloc[0]
        # of an independent program, as in the problem files
        self.assertAlmostEqual(opening["mismatch"], 0.05022841036275642, delta=1e-11)

    def test_zones_are_those_of_the_profiles(self):
        run = self.run_folder
        zones, table = run.zones, run.branch
        self.assertIn(self.label, run.profiles)
        for label in run.profiles:
            wave = table.index[table["label"] == label][0]
            mine, profile = zones[zones["wave"] == wave], run.profile(label)
            self.assertEqual("-".join(mine["regime"]), table["regimes"][wave])
            self.assertAlmostEqual(mine["end"].iloc[-1], pi / 2, delta=1e-14)
            blocks = profile.groupby((profile["regime"] != profile["regime"].shift()).cumsum())
            ends = blocks["theta"].agg(["first", "last"]).to_numpy()
            # both add durations, each in its own order
            self.assertLess(abs(ends - mine[["begin", "end"]].to_numpy()).max(), 1e-14)
            self.assertEqual(list(blocks["regime"].first()), list(mine["regime"]))

    def test_profiles_obey_contact_and_friction(self):
        """Rounding of products of numbers of order 10 is below 1e-13."""
        wave = self.run_folder.profile(self.label)
        self.assertIn("separation", set(wave["regime"]))
        gap = wave["U"] - 0.045
        self.assertGreater(gap.max(), 1e-3)
        self.assertGreaterEqual(gap.min(), -1e-13)
        self.assertLess((wave["P"] * gap).abs().max(), 1e-13)
        self.assertLess((wave["Q"].abs() - 0.5 * wave["P"]).max(), 1e-13)

    def test_spectra_have_the_counts_of_the_branch(self):
        """Growing eigenvalues on the full circle: a pair counts twice, and so do the sectors j and k − j."""
        run = self.run_folder
        points = run.branch.dropna(subset="label").set_index("label")
        compared = 0
        for label, values in run.spectrum.groupby("label"):
            # where all growing eigenvalues of a sector are among those listed
            if any(sector["re"].min() > 0 for _, sector in values.groupby("sector")):
                continue
            growing = values[values["re"] > 1e-9]
            ends = growing["sector"].isin([0, 2])
            count = 2 * (~ends).sum() + numpy.where(growing["im"][ends] == 0, 1, 2).sum()
            self.assertEqual(count, points.loc[label, "unstable"], f"label {label}")
            compared += 1
        self.assertGreater(compared, 5)

    def test_maps_have_every_cell_and_the_waves_of_closed_form(self):
        table = self.compute("map", MAP).map
        self.assertEqual(brakewave.varying(table), ["mismatch", "friction"])
        self.assertEqual(len(table[["row", "column", "start"]].drop_duplicates()), 4 * 6 * 2)
        simple = table[(table["regimes"] == "slip-stick") & (table["start"] == "fast")]
        # a slip-stick wave does not feel the mismatch
        for _, row in simple.groupby("row"):
            self.assertLess(row["speed"].max() - row["speed"].min(), 1e-12)
        self.assertEqual(simple["row"].nunique(), 4)

    def test_curves_pass_through_the_event_of_the_branch(self):
        curve = self.compute("curve", CURVE).curve
        nearest = (curve["friction"] - 0.5).abs().idxmin()
        self.assertAlmostEqual(curve["friction"][nearest], 0.5, delta=1e-15)
        self.assertAlmostEqual(curve["mismatch"][nearest], 0.05022841036275642, delta=1e-11)

    def test_simulations_have_regimes_by_place_and_time(self):
        """Shares of the regimes can be counted where every point is kept."""
        for points, columns in [(96, 96), (600, 300)]:
            simulation = self.simulate(points, f"simulation{points}")
            regimes, series = simulation.regimes, simulation.series
            self.assertEqual(regimes.shape, (len(series), columns))
            self.assertEqual(list(regimes.index), list(series["time"]))
            spacing = pi / 2 / columns
            self.assertLess(abs(regimes.columns - spacing * numpy.arange(columns)).max(), 1e-14)
            if points == columns:
                for code, name in enumerate(brakewave.REGIMES):
                    counted = (regimes == code).mean(axis=1).to_numpy()
                    self.assertLess(abs(counted - series[name].to_numpy()).max(), 1e-12)
            last, end = simulation.snapshot(2), simulation.end
            for column in last:
                self.assertEqual(list(last[column]), list(end[column]))
            self.assertIn("speed", set(simulation.measures["name"]))
            for column in ("from", "to"):
                self.assertEqual(simulation.measures[column].dtype, float)

    def test_a_tube_in_metres_is_the_tube_without_units(self):
        """The symmetry (γ, δ, c) → (s²γ, sδ, c/s), from a tube in SI units to γ = 1."""
        tube = brakewave.Tube(2e9, 2000, 0.3, 0.1, 0.15, 50e-6, 2 * pi * 10)
        root = tube.gamma**0.5
        self.assertAlmostEqual(root, tube.inner * tube.rotation / 1000, delta=1e-15)
        self.assertAlmostEqual(tube.mismatch, 5e-4, delta=1e-18)
        branch = "continuation: (parameter: Mismatch, range: ({}, {}), toward: Down),"
        mine = branch.format(0.3 * tube.mismatch, tube.mismatch)
        ours = branch.format(0.3 * tube.mismatch / root, tube.mismatch / root)
        scaled = MODEL.replace("0.2", repr(tube.mismatch / root))
        physical = self.compute("run", f"({tube.model(0.5)} {WAVE} {mine})", "tube").events
        plain = self.compute("run", f"({scaled} {WAVE} {ours})", "scaled").events
        self.assertEqual(list(physical["type"]), list(plain["type"]))
        self.assertIn("GR", set(plain["type"]))
        for a, b in zip(physical["speed"] * root, plain["speed"]):
            self.assertAlmostEqual(a / b, 1, delta=1e-10)
        # k|c|Ω/2π = k(|c|√γ)√(E/ρ)/(2πR), in which Ω does not appear
        slip_stick = 1.2427008006300821
        hertz = 4 * slip_stick * 1000 / (2 * pi * 0.1)
        self.assertAlmostEqual(tube.hertz(slip_stick / root, 4), hertz, delta=1e-9)

    def test_names_of_a_system_are_only_names(self):
        """Its columns are known by their place: numbers, in every table, and modes are text whatever they are called."""
        numbers = "first from to method points sample nan NA inf mode speed max_".split()
        states = ["type", "infinity"]
        follow = 'continuation: (parameter: "first", range: (9.0, 10.5), toward: Up), stability: (), output: (profiles: 2)'
        monitors = ["setting", "regime", "lead_sector"]
        follow += ', monitor: {"setting": Max("type"), "regime": Mean("infinity"), "lead_sector": Integral("1")}'
        run = self.compute("run", SYSTEM.replace("PARTS", follow), "named")
        for table in [run.branch, run.events]:
            self.assertEqual([table[name].dtype for name in numbers + monitors], [float] * len(numbers + monitors))
        branch = run.branch
        self.assertEqual(brakewave.parameters(branch), numbers)
        self.assertEqual(brakewave.varying(branch), ["first"])
        self.assertTrue((branch["regimes"].str.split("-").explode() == "nan").all())
        self.assertEqual((branch["first"].min(), branch["first"].max()), (9.0, 10.5))
        axes = brakewave.draw_branch(run)
        # at the greatest value it hits the stop, the same along the branch
        self.assertEqual((axes.get_xlabel(), axes.get_ylabel()), ("first", "min_type"))
        matplotlib.pyplot.close(axes.figure)
        profile = run.profile(run.profiles[0])
        self.assertEqual([profile[name].dtype for name in states], [float, float])
        self.assertEqual(set(profile["mode"]), {"nan"})
        scan = 'scan: (parameter: "first", values: Linear(9.0, 9.2, 2), sweep: Up, section: Phase(0.0), settle: 4, keep: 2)'
        scan = self.compute("scan", SYSTEM.replace("PARTS", scan), "named_scan")
        self.assertEqual([scan.scan[name].dtype for name in states], [float, float])
        self.assertEqual(set(scan.scan["mode"]), {"nan"})
        axes = brakewave.draw_scan(scan)
        self.assertEqual(axes.get_ylabel(), "type")
        matplotlib.pyplot.close(axes.figure)
        plane = """map: (first: (parameter: "first", range: (9.0, 9.2)), second: (parameter: "points", range: (1.0, 1.1)),
            points: Grid(rows: 2, columns: 2))"""
        plane = self.compute("map", SYSTEM.replace("PARTS", plane), "named_map")
        self.assertEqual([plane.map[name].dtype for name in numbers], [float] * len(numbers))
        axes = brakewave.draw_map(plane)
        self.assertEqual((axes.get_xlabel(), axes.get_ylabel()), ("first", "points"))
        matplotlib.pyplot.close(axes.figure)
        motion = self.compute("simulate", SYSTEM.replace("PARTS", "simulation: (duration: 30.0)"), "named_motion")
        for table in [motion.series, motion.section]:
            self.assertEqual([table[name].dtype for name in states], [float, float])
            self.assertEqual(set(table["mode"]), {"nan"})
        self.assertEqual(set(motion.switches["from"]) | set(motion.switches["to"]), {"nan"})
        steady = brakewave.read(io.StringIO("mode,equilibrium,type,stable,re,im,why\nnan,none,,,,,forced\n"))
        self.assertEqual((steady["mode"][0], steady["type"].dtype), ("nan", float))

    def test_tables_of_equilibria_are_those_of_a_system(self):
        """The Hopf point of the Brusselator is B = 1 + A², where x = A, y = B/A and λ = ±iA."""
        run = self.compute("run", (ROOT / "problems" / "brusselator.ron").read_text(encoding="utf-8"), "brusselator")
        self.assertEqual((run.states, run.parameter), (["x", "y"], "B"))
        self.assertEqual(brakewave.parameters(run.branch), ["A", "B"])
        self.assertEqual(brakewave.varying(run.events), ["B"])
        hopf = run.events.set_index("type").loc["HB"]
        for name, exact in [("A", 1.0), ("B", 2.0), ("x", 1.0), ("y", 2.0), ("omega", 1.0), ("re", 0.0)]:
            self.assertAlmostEqual(hopf[name], exact, delta=1e-12)
        self.assertEqual([run.branch[name].dtype for name in ("x", "y", "re", "im")], [float] * 4)
        curve = (ROOT / "problems" / "fitzhugh_curve.ron").read_text(encoding="utf-8")
        curve = self.compute("curve", curve, "fitzhugh_curve")
        table = curve.curve
        self.assertEqual(brakewave.parameters(table), ["I", "b"])
        # along its Hopf points v² = 1 − εb
        self.assertLess((table["v"] ** 2 - (1 - 0.08 * table["b"])).abs().max(), 1e-12)
        axes = brakewave.draw_curve(curve)
        self.assertEqual((axes.get_xlabel(), axes.get_ylabel()), ("I", "b"))
        matplotlib.pyplot.close(axes.figure)

    def test_what_is_no_tube_is_refused(self):
        numbers = dict(young=2e9, density=2000, poisson=0.3, inner=0.1, outer=0.15, oversize=50e-6, rotation=20 * pi)
        for wrong in [{"poisson": 0.6}, {"poisson": 0.5}, {"inner": 0.2}, {"outer": 0.1}, {"young": 0}, {"rotation": -1}]:
            with self.assertRaisesRegex(ValueError, "|".join(wrong)):
                brakewave.Tube(**numbers | wrong)
        for odd, words in [({"rotation": 600}, "not rpm"), ({"oversize": 0.02}, "20% thicker"), ({"young": 2}, "sound")]:
            with self.assertWarnsRegex(UserWarning, words):
                brakewave.Tube(**numbers | odd)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            brakewave.Tube(**numbers)

    def test_a_section_in_si_units_is_the_same_tube(self):
        """`tube` of a problem file against the conversion of this module, to rounding."""
        numbers = "young: 2e9, density: 2000, poisson: 0.3, inner: 0.1, outer: 0.15, oversize: 50e-6, rotation: Rpm(600)"
        range = "continuation: (parameter: Mismatch, range: (4e-4, 5e-4), toward: Down),"
        branch = self.compute("run", f"(tube: ({numbers}, friction: 0.5), {WAVE} {range})", "si").branch
        tube = brakewave.Tube(2e9, 2000, 0.3, 0.1, 0.15, 50e-6, 2 * pi * 10)
        for name in ["gamma", "xi"]:
            self.assertAlmostEqual(branch[name][0] / getattr(tube, name), 1, delta=1e-15)
        self.assertAlmostEqual(branch["hertz"][0] / tube.hertz(branch["speed"][0], 4), 1, delta=1e-15)

    def test_a_tube_has_the_elasticity_of_the_program(self):
        """Virtual work with the field X by quadrature, against κ = −λ² = ak² + h + ikfD of `steady` and against
        the pressure of steady sliding, P = gδ."""
        nu, xi, friction = 0.3, 1.5, 0.5
        node, weight = numpy.polynomial.legendre.leggauss(40)
        r = 1 + (xi - 1) * (node + 1) / 2
        field, slope = (xi**2 / r - r) / (xi**2 - 1), -(xi**2 / r**2 + 1) / (xi**2 - 1)

        def integral(density):
            return (xi - 1) / 2 * weight @ (density * r)

        product = (1 + nu) * (1 - 2 * nu)
        stiff, lame, shear = (1 - nu) / product, nu / product, 0.5 / (1 + nu)
        hoop, shearing = field / r, slope - field / r
        inertia = integral(field**2)
        for thickness in [1e-6, 1e-3, 0.1, 0.224, 0.226, 0.5, 2.0]:
            s = 1 + thickness * (node + 1) / 2
            w = thickness * (2 + thickness)
            exact = thickness / 2 * weight @ (((1 + thickness) ** 2 / s - s) ** 2 * s) / w**2
            self.assertAlmostEqual(brakewave.inertia(1 + thickness) / exact, 1, delta=1e-9)
        a = stiff * integral(hoop**2) / inertia
        h = shear * integral(shearing**2) / inertia
        g = integral(stiff * (slope**2 + hoop**2) + 2 * lame * slope * hoop) / inertia
        coupling = -integral((lame * slope + stiff * hoop - shear * shearing) * hoop) / inertia
        printed = self.call("steady", self.problem(RUN, "steady"), "--modes", "1..6")
        table = brakewave.read(io.StringIO(printed))
        self.assertEqual(list(table["mode"]), [1, 2, 3, 4, 5, 6])
        self.assertEqual(set(table["direction"]), {"against"})
        k = table["mode"].to_numpy(float)
        square = (table["growth"] + 1j * table["omega"]).to_numpy() ** 2
        self.assertLess(max(abs(square + a * k**2 + h + 1j * k * friction * coupling) / abs(square)), 1e-12)
        tube = brakewave.Tube(2e9, 2000, nu, 0.1, 0.1 * xi, 50e-6, 2 * pi * 10)
        pascal = 2e9 * 5e-4 * (xi**2 + 1 / (1 - 2 * nu)) / ((xi**2 - 1) * (1 + nu))
        self.assertAlmostEqual(tube.pascal(g / tube.gamma * 5e-4) / pascal, 1, delta=1e-12)

    def test_a_branch_is_drawn_as_the_program_draws_it(self):
        """Every step with its stability, and every mark with its shape, as in the source for pgfplots, whose coordinates have
        nine digits. Among the branches are those left both ways, whose starts are no ends, and with changes of stability."""
        for name in ["bouncing_ball", "mode4_damping", "mode4_stability", "mode4_hopf", "relay", "buck_converter", "brusselator", "duffing_wall"]:
            run = self.compute("run", (ROOT / "problems" / f"{name}.ron").read_text(encoding="utf-8"), f"drawn_{name}")
            self.call("plot", f"drawn_{name}", "--format", "tex")
            steps, marks = of_pgfplots((run.path / "diagram.tex").read_text(encoding="utf-8"))
            axes = brakewave.draw_branch(run)
            drawn, marked = of_matplotlib(axes)
            matplotlib.pyplot.close(axes.figure)
            self.assertEqual([style for style, _ in drawn], [style for style, _ in steps], name)
            self.assertEqual(sorted(marked), sorted(marks), name)
            places = [(points, marks[mark]) for mark, points in marked.items()]
            for mine, theirs in [([step for _, step in drawn], [step for _, step in steps]), *places]:
                self.assertEqual(numpy.shape(mine), numpy.shape(theirs), name)
                self.assertTrue(numpy.allclose(sorted(mine), sorted(theirs), rtol=1e-8, atol=1e-300), name)

    def test_every_kind_of_picture_is_drawn(self):
        run = self.run_folder
        simulation = self.simulate(96, "regimes")
        pictures = {
            "branch": brakewave.draw_branch(run),
            "profile": brakewave.draw_profile(run, self.label),
            "spectrum": brakewave.draw_spectrum(run, self.label),
            "map": brakewave.draw_map(self.compute("map", MAP, "map2")),
            "curve": brakewave.draw_curve(self.compute("curve", CURVE, "curve2")),
            "regimes": brakewave.draw_regimes(simulation),
        }
        keep = Path(os.environ.get("BRAKEWAVE_PICTURES", self.work))
        for name, axes in pictures.items():
            axes.figure.savefig(keep / f"{name}.png")
            self.assertGreater((keep / f"{name}.png").stat().st_size, 5000, name)
        matplotlib.pyplot.close("all")

    def test_colours_and_marks_are_those_of_the_program(self):
        """Of zones and of the commonest sequences, and a mark for every type of event."""
        source = ROOT / "src" / "output"
        constants = CONSTANT.findall((source / "render" / "palette.rs").read_text(encoding="utf-8"))
        known = {colour: "#{:02x}{:02x}{:02x}".format(*map(int, numbers)) for colour, *numbers in constants}
        sequences = SEQUENCE.findall((source / "pictures" / "colours.rs").read_text(encoding="utf-8"))
        colours = {"-".join(sequence.lower().split(", ")): known.get(colour) for sequence, colour in sequences}
        self.assertEqual(brakewave.SEQUENCES, {name: colours.get(name) for name in brakewave.SEQUENCES})
        drawing = (ROOT / "docs" / "wave.svg").read_text(encoding="utf-8")
        for regime in brakewave.REGIMES:
            self.assertIn(f'fill="{brakewave.COLOURS[regime]}"', drawing, regime)
        events = (ROOT / "src" / "orbit" / "event.rs").read_text(encoding="utf-8")
        all_types = events[events.index("const ALL") :].split("];")[0]
        self.assertEqual(sorted(re.findall(r"EventType::(\w+)", all_types)), sorted(brakewave.MARKS))

    def test_what_is_no_result_is_named(self):
        with self.assertRaisesRegex(FileNotFoundError, "no result folder"):
            brakewave.Folder(self.work)
        with self.assertRaisesRegex(FileNotFoundError, "folder of a run, has no map.csv"):
            self.run_folder.map  # pylint: disable=pointless-statement


if __name__ == "__main__":
    require_binary()
    unittest.main()
