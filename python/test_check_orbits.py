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
    from flint import acb, fmpq_poly

    from brakewave.ball_orbits import Field, Form, Ratio, Zeros, evaluate, read
    from brakewave.ball_waves import Refused
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


class Expressions(unittest.TestCase):
    """What is read and evaluated, against numbers by hand."""

    def value(self, text, phase=0.0):
        posed = {"system": {"parameters": {"p": 3.0}}, "parameter": 0, "values": ["3"]}
        field = Field(posed, acb(3))
        names = {"p": Form(waves={(0, 0): acb(3)}), "phase": Form(phase=1)}
        form = evaluate(read(text), names, field)
        waves = (a * (acb(h * phase).sin() if odd else acb(h * phase).cos()) for (h, odd), a in form.waves.items())
        return float(sum(waves, acb(0)).real)

    def test_precedence(self):
        for text, expected in [
            ("-p^2", -9), ("2^-1", 0.5), ("2^3^2", 512), ("1 - 2 - 3", -4), ("8/4/2", 1), ("p*-2", -6), ("1e-1*p", 0.3),
        ]:
            self.assertAlmostEqual(self.value(text), expected, places=14, msg=text)
        for wrong in ["", "p p", "(p", "p +", "p @", "sine(p)", "q", "cos(0.5*phase)", "p^phase"]:
            with self.assertRaises(Refused, msg=wrong):
                self.value(wrong)

    def test_waves(self):
        from math import cos, sin

        for text, direct in [
            ("p*cos(phase)^3", lambda f: 3 * cos(f) ** 3),
            ("sin(2*phase - p)*cos(phase)", lambda f: sin(2 * f - 3) * cos(f)),
            ("cos(phase)*sin(2*phase)*sin(phase)", lambda f: cos(f) * sin(2 * f) * sin(f)),
        ]:
            for phase in [0.0, 0.9, -2.2]:
                self.assertAlmostEqual(self.value(text, phase), direct(phase), places=13, msg=text)

    def test_zeros_are_exact(self):
        p = Ratio(fmpq_poly([0, 1]))
        zeros = Zeros([[p, Ratio(1), 0], [0, p - 1, Ratio(2)]])
        self.assertTrue(zeros.have([p * p - p, 0, Ratio(-2)]))
        self.assertFalse(zeros.have([p * p - p, 0, Ratio(2)]))


@unittest.skipUnless(BINARY, "no binary of brakewave")
class Certificates(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp())
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        (cls.folder / "problem.ron").write_text(SYSTEM, encoding="utf-8")
        cls.honest = cls.folder / "honest"
        run = subprocess.run(
            [BINARY, "certify", "problem.ron", "--out", "honest", "--quiet"], cwd=cls.folder, capture_output=True, text=True
        )
        assert run.returncode == 0, run.stderr

    def test_honest(self):
        code, told = check(self.honest)
        self.assertEqual(code, 0, told)
        self.assertNotIn("refused", told)
        for what in ["orbit, in its intervals", "numbers of the problem", "type", "inequalities", "row of"]:
            self.assertEqual(len(re.findall(f"{what}.*: proven again", told)), 4, told)
        self.assertEqual(told.count("multipliers outside the unit circle: proven again"), 2, told)

    def test_forged(self):
        for old, new, why in [
            ("kind: GR", "kind: CO", "type"),
            ("kind: LP", "kind: PD", "type"),
            ("condition: Fold", "condition: Doubling", "orbit"),
            ("low: 0.09997075", "low: 0.09997076", "orbit"),
            ("outside: Some(0)", "outside: Some(1)", "multipliers"),
            ('"d - x"', '"d + x"', ""),
            ('zero: "d - x"', 'zero: "1.5*d - x"', ""),
            ('"-e*v"', '"-e*v/2"', ""),
            ("periods: 1", "periods: 2", "orbit"),
            ('"0.8",', '"0.81",', "orbit"),
        ]:
            forged = self.folder / "forged"
            shutil.rmtree(forged, ignore_errors=True)
            shutil.copytree(self.honest, forged)
            path = forged / "certificate.ron"
            text = path.read_text(encoding="utf-8")
            self.assertIn(old, text)
            path.write_text(text.replace(old, new), encoding="utf-8")
            code, told = check(forged)
            self.assertEqual(code, 1, f"{old}: {told}")
            self.assertRegex(told, f"{why}.*: refused", old)


if __name__ == "__main__":
    unittest.main()
