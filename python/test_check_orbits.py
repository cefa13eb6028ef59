"""Tests of brakewave.ball_orbits against certificates of systems that the binary writes, as they are and forged.

    BRAKEWAVE=target/release/brakewave python3 python/test_check_orbits.py

Where the binary or python-flint is not there the tests are skipped, and say so (see test_check.py).
"""

import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from test_check import BINARY, check

try:
    from flint import acb, acb_mat, acb_poly, fmpq_poly

    from brakewave.ball_orbits import Form, Ratio, Zeros, evaluate, outside
    from brakewave.balls import Dual, NotCovered, Refused, determinant
except ImportError as error:
    print(f"tests of python/brakewave/ball_orbits.py skipped: {error}")
    sys.exit(0)

SYSTEM = """(
    system: (
        states: ["x", "v"], parameters: {"c": 0.1, "A": 0.12, "w": 1.0, "d": 1.0, "e": 0.8}, forcing: "w",
        modes: {"free": (
            rates: {"x": "v", "v": "A*cos(phase) - c*v - x"},
            until: [(zero: "d - x", to: "free", reset: {"v": "-e*v"})],
        )},
    ),
    orbit: (start: Given(mode: "free", state: {"x": 1.0, "v": -0.08}, phase: 1.03)),
    continuation: (parameter: "A", range: (0.05, 0.12), toward: Down), stability: (),
)"""
"""An end, a fold, a graze, an end."""
PAIR = (
    SYSTEM.replace('"A": 0.12, "w": 1.0, "d": 1.0', '"A": 0.5, "w": 1.7, "d": 10.0')
    .replace('"x": 1.0, "v": -0.08}, phase: 1.03', '"x": -0.3, "v": 0.0}, phase: 0.0')
    .replace('parameter: "A", range: (0.05, 0.12)', 'parameter: "c", range: (-0.1, 0.1)')
)
"""An end, a pair on the unit circle, an end."""
FRICTION = """(
    system: (
        states: ["x", "v"], parameters: {"w": 0.8, "F": 0.6666666666666666, "z": 0.05}, forcing: "w",
        define: {"rest": "cos(phase) - 2*z*v - x"},
        modes: {
            "forth": (rates: {"x": "v", "v": "rest - F"}, until: [(zero: "v", to: "back")]),
            "back": (rates: {"x": "v", "v": "rest + F"}, until: [(zero: "-v", to: "forth")]),
        },
        sliding: {"stick": ("forth", "back")},
    ),
    orbit: (start: Given(mode: "forth", state: {"x": -1.4305683932561448, "v": 0.0}, phase: -2.1458443767657066)),
    continuation: (parameter: "w", range: (0.7, 0.8), toward: Down, stop_at: [0.71]), stability: (),
)"""
"""An end without stick, the onset of stick at 0.7227, a value with it, an end."""
THRESHOLD = SYSTEM.replace('"e": 0.8', '"e": 0.8, "s": 0.01').replace(
    "until: [(", 'until: [(zero: "d - x", to: "free", if: ["v - s"], reset: {"v": "-e*v"}), ('
)
"""The same orbits where slow impacts are others: to the fold with 0.1 and more."""
CHUA = (Path(__file__).resolve().parent.parent / "problems/chua.ron").read_text(encoding="utf-8")
LOSS = (
    CHUA.split("    orbit:")[0].replace('"alpha": 7.5', '"alpha": 13.74')
    + """    orbit: (start: Given(mode: "upper", state: {"x": 1.0, "y": 0.0937, "z": -0.8123}, period: 4.6152)),
    continuation: (parameter: "alpha", range: (13.7, 13.74), toward: Down, stop_after: [(event: BP, count: 1)]),
    stability: (),
)"""
)
"""An end of a symmetric orbit, and where it loses its symmetry."""
SHIFT = 1 + 1e-12


class Expressions(unittest.TestCase):
    """What is read and evaluated, against numbers by hand."""

    def value(self, text, phase=0.0):
        names = {"p": Form.number(3), "lambda": Form.number(2), "phase": Form(phase=1)}
        waves = evaluate(text, names).waves
        turn = lambda h, odd: acb(h * phase).sin() if odd else acb(h * phase).cos()
        return float(sum((a.at(acb(0)) * turn(*key) for key, a in waves.items()), acb(0)).real)

    def test_precedence(self):
        for text, expected in [
            ("-p^2", -9), ("2^-1", 0.5), ("2^3^2", 512), ("1 - 2 - 3", -4), ("8/4/2", 1), ("p*-2", -6), ("1e-1*p", 0.3),
            (" .5*\n2.", 1), ("lambda/p", 2 / 3), ("exp(0)*p", 3),
        ]:  # fmt: skip
            self.assertAlmostEqual(self.value(text), expected, places=14, msg=text)
        wrong = "p p|(p|p +|p @|p @ p|p) + (p|sine(p)|q|cos(0.5*phase)|p^phase|p/phase|p.real|'p'|p if p else p|1/0"
        for text in ["", *wrong.split("|")]:
            with self.assertRaises(Refused, msg=text):
                self.value(text)
        for text in ["sin(p)", "p^0.5"]:
            with self.assertRaises(NotCovered, msg=text):
                self.value(text)

    def test_waves(self):
        from math import cos, sin

        for text, direct in [
            ("p*cos(phase)^3", lambda f: 3 * cos(f) ** 3),
            ("sin(2*phase)*cos(phase)", lambda f: sin(2 * f) * cos(f)),
            ("cos(phase)*sin(2*phase)*sin(phase)", lambda f: cos(f) * sin(2 * f) * sin(f)),
        ]:
            for phase in [0.0, 0.9, -2.2]:
                self.assertAlmostEqual(self.value(text, phase), direct(phase), places=13, msg=text)

    def test_zeros_are_exact(self):
        p = Ratio(fmpq_poly([0, 1]))
        zeros = Zeros([[p, Ratio(1), 0], [0, p - 1, Ratio(2)]])
        self.assertTrue(zeros.have([p * p - p, 0, Ratio(-2)]))
        self.assertFalse(zeros.have([p * p - p, 0, Ratio(2)]))

    def test_derivatives(self):
        # p²/(p − 1) at 3, and a determinant without an inverse: det(A + εB) = ε at A = diag(0, 1), B = 1
        p = Ratio(fmpq_poly([0, 1]))
        there = (p * p / (p - 1)).at(Dual(acb(3), acb(2)))
        self.assertTrue(there.v == 4.5 and there.d == 1.5)
        found = determinant([[Dual(acb(0), acb(1)), acb(0)], [acb(0), Dual(acb(1), acb(1))]])
        self.assertTrue(found.v.contains(0) and found.d.contains(1))

    def test_zeros_outside(self):
        for roots, expected in [([0.5, -0.5], 0), ([0, 0, 3], 1), ([2, -2, 0.1], 2), ([acb(1, 1), acb(1, -1), 0.2], 2)]:
            polynomial = acb_poly([1])
            for root in roots:
                polynomial *= acb_poly([-acb(root), 1])
            self.assertEqual(outside(polynomial.coeffs()), expected, roots)
        with self.assertRaises(Refused):
            outside(acb_mat([[0, 1], [-1, 0]]).charpoly().coeffs())


@unittest.skipUnless(BINARY, "no binary of brakewave")
class Certificates(unittest.TestCase):
    """Certificates as they are written hold; forged ones are refused by the checker and by `certify --verify`."""

    @classmethod
    def setUpClass(cls):
        cls.work, cls.folders = Path(tempfile.mkdtemp()), {}
        cls.addClassCleanup(shutil.rmtree, cls.work)
        for name, problem in [("impact", SYSTEM), ("pair", PAIR), ("friction", FRICTION), ("threshold", THRESHOLD), ("loss", LOSS), ("graze", SYSTEM)]:
            (cls.work / f"{name}.ron").write_text(problem, encoding="utf-8")
            cls.folders[name] = cls.work / name
            cls.program("certify", f"{name}.ron", "--out", name, "--quiet", *["--arcs"] * (name == "graze"))

    @classmethod
    def program(cls, *arguments, code=0):
        run = subprocess.run([BINARY, *arguments], cwd=cls.work, capture_output=True, text=True)
        assert run.returncode == code, run.stdout + run.stderr
        return run.stdout

    def test_honest(self):
        for name, points, counts in [("impact", 4, 2), ("pair", 3, 2), ("friction", 4, 3), ("loss", 2, 1)]:
            code, told = check(self.folders[name])
            self.assertEqual(code, 0, told)
            self.assertNotIn("refused", told)
            for what in ["orbit, in its intervals", "numbers of the problem", "type", "inequalities", "row of"]:
                self.assertEqual(len(re.findall(f"{what}.*: proven again", told)), points, told)
            self.assertEqual(told.count("multipliers outside the unit circle: proven again"), counts, told)
            self.assertGreaterEqual(len(re.findall("no other within .*: proven again", told)), points // 2, told)

    def refused(self, name, statement, change, files=("certificate.ron",), verify=True):
        """That what a function makes of texts is refused: by the checker for a statement, and by the program."""
        forged = self.work / "forged"
        shutil.rmtree(forged, ignore_errors=True)
        shutil.copytree(self.folders[name], forged)
        for file in files:
            text = (forged / file).read_text(encoding="utf-8")
            changed = change(text)
            self.assertNotEqual(text, changed)
            (forged / file).write_text(changed, encoding="utf-8")
        code, told = check(forged)
        self.assertEqual(code, 1, told)
        self.assertRegex(told, f"{statement}[^\n]*: refused|: refused[^\n]*{statement}")
        if verify:
            self.assertIn("refused", self.program("certify", "--verify", "forged", code=1))

    def test_forged(self):
        for name, statement, old, new in [
            ("impact", "type", "kind: GR", "kind: CO"),
            ("impact", "type", "kind: LP", "kind: PD"),
            ("impact", "type", "kind: UZ|kind: EP", "kind: SL"),
            ("impact", "orbit", "condition: Fold", "condition: Doubling"),
            ("impact", "multipliers", r"outside: Some\(0\)", "outside: Some(1)"),
            ("impact", "row", r"outside: Some\(0\),", ""),
            ("impact", "row", r"inequalities: (\d+)", "inequalities: 99"),
            ("impact", "", '"d - x"', '"d + x"'),
            ("impact", "", 'zero: "d - x"', 'zero: "1.5*d - x"'),
            ("impact", "", '"-e\\*v"', '"-e*v/2"'),
            ("impact", "orbit", "periods: 1", "periods: 2"),
            ("impact", "numbers", '"0.8",', '"0.81",'),
            # another regime, another exit
            ("friction", "orbit", r'mode: 0,(.*?)name: "forth"', r'mode: 1,\1name: "back"'),
            ("friction", "orbit", "exit: 1", "exit: 0"),
            ("friction", "orbit", r"Before\(0\)", "Condition(0)"),
            ("loss", "type", "kind: BP", "kind: PD"),
            ("loss", "orbit", "condition: Branching", "condition: Doubling"),
            ("pair", "multipliers", r"outside: Some\(2\)", "outside: Some(0)"),
        ]:
            with self.subTest(name=name, old=old, new=new):
                self.refused(name, statement, lambda text: re.sub(old, new, text, count=1, flags=re.S))

    def test_forged_intervals(self):
        number = r"(-?[\d.]+(?:e-?\d+)?)"
        for name, kind, what in [
            ("impact", "EP", "parameter"), ("impact", "LP", "parameter"), ("impact", "GR", "parameter"),
            ("impact", "GR", "period"), ("loss", "BP", "parameter"), ("loss", "BP", "period"), ("pair", "NS", "angle"), ("friction", "SL", "period"), ("friction", "UZ", "period"),
        ]:  # fmt: skip
            # by 1e-12 of itself, which is less than an independent computation in doubles would see
            shift = lambda found: f"{found[1]}low: {float(found[2]) * SHIFT!r}, high: {float(found[3]) * SHIFT!r}"
            interval = rf"(kind: {kind},.*?statement:.*?{what}: (?:Some\()?\(\s*)low: {number},\s*high: {number}"
            with self.subTest(name=name, kind=kind, what=what):
                self.refused(name, "orbit", lambda text: re.sub(interval, shift, text, count=1, flags=re.S))

    def test_what_is_left_out(self):
        last = lambda text: text[: text.rindex("        (\n            label:")] + "    ],\n)\n"
        self.refused("impact", "labels", last, verify=False)
        rows = lambda text: "\n".join(text.splitlines()[:-1]) + "\n"
        self.refused("impact", "labels", rows, files=["certificates.csv"], verify=False)
        yes = lambda text: re.sub("(LP.*),yes,", r"\1,no,", text)
        self.refused("impact", "row", yes, files=["certificates.csv"], verify=False)

    def test_arcs(self):
        code, told = check(self.folders["graze"])
        self.assertEqual((code, len(re.findall("(?:LP|GR|EP) arc: proven again", told))), (0, 3), told)
        # without the fold there is another event between the points
        point = lambda text: re.sub(r"        \(\n            label: \d+,\n            kind: LP,.*?\n        \),\n", "", text, flags=re.S)
        row = lambda text: re.sub(r"\n\d+,LP,[^\n]*", "", text)
        less = lambda text: row(text) if text.startswith("label") else point(text)
        self.refused("graze", "GR arc", less, ["certificate.ron", "certificates.csv"])
        # of the orbit beyond the graze, where nothing switches, nothing is said
        unseen = lambda text: re.sub(r"seen: \[.*?\],\n(\s+near:)", r"\1", text, count=1, flags=re.S)
        self.refused("graze", "EP arc", unseen)

    def test_names_of_modes_beyond_a_change(self):
        another = lambda text: re.sub('(after: .*?)name: "stick"', r'\1name: "forth"', text, count=1, flags=re.S)
        self.refused("friction", "type", another)

    def test_a_change_that_is_none(self):
        # with one sequence before and after another type would follow
        def forged(text):
            before = re.search(r"before: (.*?),\s*after: ", text, re.S)[1]
            after = re.search(r"after: Some\(\(\[.*?\]\)\)", text, re.S)[0]
            return text.replace("kind: SL", "kind: CO").replace(after, f"after: Some({before})", 1)

        table = lambda text: text.replace(",SL,", ",CO,")
        change = lambda text: table(text) if text.startswith("label") else forged(text)
        self.refused("friction", "type", change, ["certificate.ron", "certificates.csv"])

    def test_a_condition_that_does_not_hold(self):
        # the orbit solves all equations still, but is too slow for the exit that it takes
        self.refused(
            "threshold", "condition 0 at the end of zone 0", lambda text: text.replace("0.01", "0.2"),
            ["certificate.ron", "source.ron"],
        )  # fmt: skip


if __name__ == "__main__":
    unittest.main()
