"""Tests of brakewave.ball_contacts against certificates of systems with contacts that the binary writes, as they are and forged.

    BRAKEWAVE=target/release/brakewave python3 python/test_check_contacts.py

Where the binary or python-flint is not there the tests are skipped, and say so (see test_check.py).
"""

import re
import subprocess
import sys
import unittest

from test_check import BINARY, ROOT, Certified, check

try:
    from flint import fmpq_poly

    from brakewave.ball_orbits import Modes, Ratio
    from brakewave.balls import Refused
    from brakewave.check import read_ron
except ImportError as error:
    print(f"tests of python/brakewave/ball_contacts.py skipped: {error}")
    sys.exit(0)

problem = lambda name: (ROOT / f"problems/{name}.ron").read_text(encoding="utf-8")
PROBLEMS = {
    name: re.sub(r"\n    (?:expect: \[.*?\n    \]|monitor: .*?|output: .*?|simulation: .*?),(?=\n)", "", problem(name), flags=re.S)
    for name in ("contact_friction", "contact_impact", "resting_ball", "two_blocks", "gear_rattle")
}
PROBLEMS["contact_impact"] = PROBLEMS["contact_impact"].replace(', stop_at: [("hit", 0.5)]', "")
PROBLEMS["gear_rattle"] = PROBLEMS["gear_rattle"].replace("toward: Both", "toward: Up")
PROBLEMS["impact_pair"] = """(
    system: (
        states: ["x", "v"], parameters: {"b": 1.0, "e": 0.8}, forcing: "1",
        contacts: {"p": Stop(gap: "1 - x", restitution: "e"), "q": Stop(gap: "x + 1", restitution: "e")},
        rates: {"x": "v", "v": "b*sin(phase) - p + q"},
    ),
    orbit: (start: Simulate(mode: "open.open", state: {"x": 0.0, "v": 1.0}, settle: 600), periods: 2),
    continuation: (parameter: "b", range: (0.65, 1.0), toward: Down),
    stability: (),
)"""
"""Sliding begins, a fold and a graze, a ball that rests, friction at rest above that of slip, folds and a
doubling, a ball between two stops."""
FRICTION = """(
    states: ["x1", "v1", "x2", "v2"], parameters: {"m": 2, "M": 3, "mu": 0.5},
    contacts: {
        "q": Friction(slip: "v1 - v2", bound: "mu*p"),
        "p": Stop(gap: "x2", restitution: "0"),
    },
    rates: {"x1": "v1", "v1": "(q - x1)/m", "x2": "v2", "v2": "(1 - q + p)/M"},
)"""


class Laws(unittest.TestCase):
    """Modes against forces by hand."""

    def modes(self, system, numbers):
        system = read_ron(system)
        posed = {"system": system, "values": [str(it) for it in system["parameters"].values()], "parameter": len(system["parameters"]) - 1.0}
        return Modes(posed, float(list(system["parameters"].values())[-1]), numbers)

    def test_forces_that_hold_together(self):
        # q keeps v1 - v2, p keeps v2: (q - x1)/m = 0 and 1 - q + p = 0, so that q = x1 and p = x1 - 1
        modes = self.modes(FRICTION, [5])
        self.assertEqual(modes.names[5], "stick.closed")
        for row in modes.matrices[5][1], modes.matrices[5][3]:
            self.assertFalse(any(row))
        # mu p - q and mu p + q, then p: (mu - 1)x1 - mu, (mu + 1)x1 - mu, x1 - 1
        p = Ratio(fmpq_poly([0, 1]))
        for (row, _), expected in zip(modes.guards[5], ([p - 1, 0, 0, 0, -p], [p + 1, 0, 0, 0, -p], [1, 0, 0, 0, -1]), strict=True):
            self.assertFalse(any(x - y for x, y in zip(row, expected)), row)
        # forward q = -mu p, so that 1 - q + p = 0 has p = -1/(1 + mu)
        _, (force, _) = self.modes(FRICTION, [1]).guards[1]
        self.assertFalse(any(x - y for x, y in zip(force, [0, 0, 0, 0, -1 / (1 + p)])))

    def test_what_makes_no_sense(self):
        for old, new in [
            ('"(q - x1)/m"', '"(-q - x1)/m"'), ('"(q - x1)/m"', '"-x1/m"'), ('gap: "x2"', 'gap: "x2 + p"'), ('"0"', '"-0.1"'),
        ]:  # fmt: skip
            with self.subTest(new=new), self.assertRaises(Refused):
                self.modes(FRICTION.replace(old, new, 1), [5]).at(0.5)


@unittest.skipUnless(BINARY, "no binary of brakewave")
class Certificates(Certified):
    """Certificates as they are written hold; forged ones are refused by the checker and by `certify --verify`."""

    PROBLEMS = PROBLEMS

    def test_honest(self):
        for name, kinds in [
            ("contact_friction", "EP SL UZ EP"), ("contact_impact", "EP LP GR EP"), ("resting_ball", "EP EP EP SL PD EP"),
            ("two_blocks", "EP CO EP EP EP"), ("gear_rattle", "EP LP LP PD GR EP"), ("impact_pair", "EP LP EP"),
        ]:  # fmt: skip
            code, told = check(self.work / name)
            self.assertIn(code, (0, 3), told)
            self.assertNotIn("refused", told)
            self.assertEqual(re.findall(r"\d+ (\w+) orbit, in its intervals: proven again", told), kinds.split(), told)
            for what in ["numbers of the problem", "type", "inequalities"]:
                self.assertEqual(len(re.findall(f"{what}: proven again", told)), len(kinds.split()), told)

    def refused(self, name, change, files=("certificate.ron",), statement="", verify=True):
        """That what a function makes of texts is refused by both programs."""
        self.refused_by_both(name, change, statement, files, verify)

    def test_forged_laws(self):
        both = ("certificate.ron", "source.ron")
        spaced = lambda old, new: lambda text: re.sub(old, new, text, count=1)
        # here the problem tells that the law is another; beside a problem that is forged with it the equations do
        for name, change in [
            ("contact_friction", spaced(r'(bound: )"F"', r'\1"z"')),
            ("contact_friction", spaced(r'(bound: )"F"', r'\1"1.01*F"')),
            ("contact_friction", spaced(r'"cos\(phase\) - 2\*z\*v - x \+ q"', '"cos(phase) - 2*z*v - x - q"')),
            ("contact_friction", spaced(r'Friction\((\s*)slip: "v",\s*bound: "F"', r'Jenkins(\1slip: "v", stiffness: "1", bound: "F"')),
            ("contact_impact", spaced(r'(restitution: )"e"', r'\1"1"')),
            ("contact_impact", spaced(r'(gap: )"d - x"', r'\1"d - 0.99*x"')),
            ("two_blocks", spaced(r'(static: (?:Some\()?)"Fs2"', r'\1"Fs1"')),
            ("gear_rattle", spaced(r'(damping: (?:Some\()?)"b"', r'\1"2*b"')),
        ]:  # fmt: skip
            with self.subTest(name=name):
                self.refused(name, change, statement="numbers of the problem|orbit", verify=False)
                self.refused(name, change, both, verify=False)
                told = subprocess.run([BINARY, "certify", "--verify", "forged"], cwd=self.work, capture_output=True, text=True)
                self.assertNotEqual(told.returncode, 0, told.stdout)

    def test_modes_by_another_name(self):
        stick = lambda name: lambda text: text.replace('name: "stick"', f'name: "{name}"', 1)
        for name in "forward", "backward", "open":
            self.refused("contact_friction", stick(name))
        # by another number, and by both
        number = lambda new: lambda text: re.sub(r'mode: 2,(.*?)name: "stick"', rf'mode: {new},\1name: "stick"', text, count=1, flags=re.S)
        both = lambda text: re.sub(r'mode: 2,(.*?)name: "stick"', r'mode: 0,\1name: "forward"', text, count=1, flags=re.S)
        for change in number(0), number(3), number(10**9), both:
            self.refused("contact_friction", change)
        # switches of contacts have no label
        self.refused("contact_impact", lambda text: text.replace('name: "open"', 'name: "open", label: Some("p")', 1))

    def test_another_way_on(self):
        # where both slip, the exit by which it would stick; a guard that the mode does not have
        first = lambda text: re.sub(r"(guard: 0,\s*exit: )1", r"\g<1>0", text, count=1)
        second = lambda text: re.sub(r"guard: 0,(\s*exit: 1)", r"guard: 2,\1", text, count=1)
        for change in first, second:
            self.refused("contact_friction", change)

    def test_a_count_that_leaves_out_a_guard(self):
        fewer = lambda text: re.sub(r"inequalities: (\d+)", lambda found: f"inequalities: {int(found[1]) - 1}", text, count=1)
        self.refused("contact_friction", fewer, statement="inequalities")

    def test_types(self):
        for name, old, new in [("contact_impact", "GR", "CO"), ("contact_friction", "SL", "GR"), ("resting_ball", "SL", "CO"), ("two_blocks", "CO", "SL")]:
            change = lambda text, old=old, new=new: text.replace(f",{old},", f",{new},").replace(f"kind: {old}", f"kind: {new}")
            self.refused(name, change, ["certificate.ron", "certificates.csv"], "type")


if __name__ == "__main__":
    unittest.main()
