"""Tests of the checker on what certificates say of branches: problems beside them, arcs, an orbit in two sequences of zones.

    BRAKEWAVE=target/release/brakewave python3 python/test_check_branches.py

Where the binary or python-flint is not there the tests are skipped, and say so (see test_check.py).
"""

import re
import subprocess
import unittest

from test_check import BINARY, ROOT, WAVES, Certified, check
from test_check_orbits import FRICTION, read_ron, ron

from brakewave.ball_walk import walk
from brakewave.ball_waves import Wave
from brakewave.balls import Refused, differences, prove_zero
from brakewave.check import Point

CLOCK = """(
    system: (
        states: ["t", "y", "z"], parameters: {"p": 1.0, "k": 0.05},
        modes: {"run": (rates: {"t": "1", "y": "z", "z": "2"},
            until: [(zero: "1 + p - t", to: "run", reset: {"t": "0", "y": "1.8 + k*p", "z": "-2.7"})])},
    ),
    orbit: (start: Given(mode: "run", state: {"t": 0.0, "y": 1.85, "z": -2.7}, period: 2.0)),
    continuation: (parameter: "p", range: (0.5, 1.0), toward: Down, stop_at: [0.75]), stability: (),
)"""
"""A clock whose period is 1 + p."""
REST = """(
    system: (states: ["x"], parameters: {"p": 1.0, "k": 0.05}, modes: {"run": (rates: {"x": "p - k*x"})}),
    equilibrium: (start: Given(mode: "run", state: {"x": 20.0})),
    continuation: (parameter: "p", range: (0.5, 1.0), toward: Down, stop_at: [0.75]),
)"""
STARTS = {
    "clock": 'Given(mode: "run", state: {"t": 0.0, "y": 1.85, "z": -2.7}, period: 2.0)',
    "rest": 'Given(mode: "run", state: {"x": 20.0})',
    "waves": "Fast",
}
FOLD = (
    (ROOT / "problems/chua.ron").read_text(encoding="utf-8").split("    orbit:")[0].replace('"alpha": 7.5', '"alpha": 11.7038')
    + """    orbit: (start: Given(mode: "inner", state: {"x": 1.0, "y": -0.27685, "z": -1.41492}, period: 3.4571)),
    continuation: (parameter: "alpha", range: (7.0, 12.0), toward: Up, stop_after: [(event: LP, count: 1)]), stability: (),
)"""
)
"""An end, a doubling, and a fold with a multiplier of -60 before: a product of matrices over its zones is wide."""
WAVES_OF_FRICTION = (ROOT / "problems/mode4_friction.ron").read_text(encoding="utf-8")
"""Waves with a fold between two of one sequence of zones."""
BALL = (ROOT / "problems/bouncing_ball.ron").read_text(encoding="utf-8")


def replaced(text, old, new):
    assert old in text, old
    return text.replace(old, new)


@unittest.skipUnless(BINARY, "no binary of brakewave")
class Branches(Certified):
    PROBLEMS = {"clock": CLOCK, "rest": REST, "waves": WAVES, "friction": FRICTION, "fold": FOLD, "ball": BALL, "arcs": WAVES, "friction_waves": WAVES_OF_FRICTION, "wave_fold": WAVES_OF_FRICTION}
    OPTIONS = {"fold": ["--arcs"], "arcs": ["--arcs"], "friction_waves": ["--arcs"]}

    def beside(self, name, source):
        """Exit code and words of the checker of a certificate beside another problem."""
        copy = self.copied(name)
        (copy / "source.ron").write_text(source, encoding="utf-8")
        return check(copy)

    def changed(self, name, change, table=lambda text: text):
        """Exit code and words of the checker of a certificate that a function changes."""
        copy = self.copied(name, "changed")
        certificate = read_ron((copy / "certificate.ron").read_text(encoding="utf-8"))
        change(certificate)
        (copy / "certificate.ron").write_text(ron(certificate), encoding="utf-8")
        rows = (copy / "certificates.csv").read_text(encoding="utf-8")
        (copy / "certificates.csv").write_text(table(rows), encoding="utf-8")
        return check(copy)

    def test_a_branch_that_goes_on_from_an_earlier_run(self):
        # its numbers do not stand in the file, and all else does
        others = {
            "clock": [('"-2.7"', '"-2.6"', "system"), ('parameter: "p"', 'parameter: "k"', "parameter"), ("0.75", "0.76", "value"), ("(0.5,", "(0.6,", "unit")],
            "rest": [("p - k*x", "p - 2*k*x", "system"), ('parameter: "p"', 'parameter: "k"', "parameter"), ("0.75", "0.76", "value"), ("(0.5,", "(0.6,", "unit")],
            "waves": [("mode: 4", "mode: 5", "mode"), ("parameter: Mismatch", "parameter: Friction", "parameter"), ("0.08", "0.09", "value"), ("(0.045,", "(0.05,", "unit")],
        }
        for name, start in STARTS.items():
            restart = replaced(self.PROBLEMS[name], start, 'Restart(dir: "earlier", label: 1)')
            code, told = self.beside(name, restart.replace('"k": 0.05', '"k": 0.07'))
            self.assertEqual(code, 3, told)
            self.assertNotIn("refused", told)
            for old, new, what in others[name]:
                with self.subTest(name=name, new=new):
                    code, told = self.beside(name, replaced(restart, old, new))
                    self.assertEqual(code, 1, told)
                    self.assertRegex(told, f"numbers of the problem: refused: the {what}")

    def test_parameters_in_other_words(self):
        for old, new in [('"k": 0.05', '"k": "0.05"'), ('"k": 0.05', '"k": "1/20"'), ('"k": 0.05', '"k": "p/20"'), ('"k": 0.05', '"k": "cos(0)/20"'), ('"p": 1.0', '"p": "2/2"')]:
            for name in ("clock", "rest"):
                code, told = self.beside(name, replaced(self.PROBLEMS[name], old, new))
                self.assertEqual(code, 0, told)
        for new, expected, outcome in [('"1/21"', 1, "refused"), ('"0.05 + 1e-7"', 1, "refused"), ('"nowhere"', 1, "refused"), ('"0.05 + 1e-12"', 3, "not covered")]:
            code, told = self.beside("clock", replaced(CLOCK, '"k": 0.05', f'"k": {new}'))
            self.assertEqual(code, expected, told)
            self.assertIn(f"numbers of the problem: {outcome}", told)

    def test_values_of_monitors_are_none_of_the_parameter(self):
        for stop, holds in [('{"speed": 0.75}', 1), ('("speed", 0.75)', 1), ("(p: 0.75)", 0)]:
            code, told = self.beside("clock", replaced(CLOCK, "stop_at: [0.75]", f"stop_at: [{stop}]"))
            self.assertEqual(code, holds, told)

    def test_units_without_their_orbit(self):
        """The units of `unique` are told by what the branch begins with: without it they are not covered, and this is said."""
        for name in ("clock", "rest"):
            table = lambda text: "\n".join(text.splitlines()[:1] + text.splitlines()[2:]) + "\n"
            code, told = self.changed(name, lambda certificate: certificate["points"].pop(0), table)
            self.assertEqual(code, 3, told)
            self.assertEqual(told.count("not covered: the units"), 1, told)

    def test_counts_are_whole(self):
        def outside(certificate):
            certificate["points"][0]["outcome"].value["statement"]["outside"] += 0.5

        code, told = self.changed("clock", outside)
        self.assertEqual(code, 1, told)
        self.assertRegex(told, "multipliers outside the unit circle: refused: .* is no whole number")

    def test_a_period_that_is_prescribed(self):
        code, told = self.beside("clock", replaced(CLOCK, "orbit: (", 'orbit: (period: "1.9", free: "k", '))
        self.assertEqual(code, 1, told)
        self.assertIn("refused: the period is prescribed", told)

    def test_a_problem_about_something_else(self):
        kinds = ("clock", "rest", "waves")
        for name, other in ((name, other) for name in kinds for other in kinds if name != other):
            code, told = self.beside(name, self.PROBLEMS[other])
            self.assertEqual(code, 1, told)
            self.assertIn("refused: the problem is about something else", told)

    def test_a_zone_of_no_duration(self):
        # the onset of stick as the orbit that has a stick of no duration in either half, of which the one without is seen
        def closed(certificate):
            proof = next(it for it in certificate["points"] if it["kind"] == "SL")["outcome"].value
            (seen,), near, condition, said = proof["seen"], proof["near"], proof["condition"], proof["statement"]
            proof |= {"near": seen["near"], "condition": seen["condition"], "seen": [{"near": near, "condition": condition}]}
            # it is enclosed about as narrowly
            for name in "parameter", "period":
                said[name] = {"low": said[name]["low"] - 1e-11, "high": said[name]["high"] + 1e-11}
            said["unique"] = 1e-9
            # those of the zones of no duration are among them
            said["inequalities"] = 10

        (self.work / "changed").mkdir(exist_ok=True)
        code, told = self.changed("friction", closed)
        lines = [line for line in told.splitlines() if " SL " in line and "row of" not in line]
        self.assertTrue(lines and all("proven again" in line for line in lines), told)
        told = self.program("certify", "--verify", "changed", code=1)
        self.assertRegex(told, "SL: verified")

    def test_cells_that_are_no_numbers(self):
        for cell in ["0.75 +/- 0.1", "[0.75 +/- 1e-3]", "3/4", "0.7_5", "pi", ""]:
            table = lambda text: "\n".join(",".join([*line.split(",")[:4], cell, *line.split(",")[5:]]) if ",UZ," in line else line for line in text.splitlines()) + "\n"
            code, told = self.changed("clock", lambda _: None, table)
            self.assertEqual(code, 1, told)
            self.assertRegex(told, "row of certificates.csv: refused: .* is no number")
            self.assertIn("certificates.csv: refused", self.program("certify", "--verify", "changed", code=1))

    def test_an_arc_to_a_fold(self):
        code, told = check(self.folders["fold"])
        self.assertEqual(len([line for line in told.splitlines() if "arc: proven again" in line]), 2, told)
        self.assertNotIn("refused", told)

    def left_out(self, name, kind):
        """Exit codes and words of the checker and of the program of a certificate that leaves a point out and states the arc over it."""
        changed = self.copied(name, "changed")
        text = (changed / "certificate.ron").read_text(encoding="utf-8")
        point = re.search(rf"^        \(\n            label: (\d+),\n            kind: {kind},.*?^        \),\n", text, re.M | re.S)
        (changed / "certificate.ron").write_text(text.replace(point[0], ""), encoding="utf-8")
        rows = (changed / "certificates.csv").read_text(encoding="utf-8").splitlines(keepends=True)
        rows = [row for row in rows if not row.startswith(f"{point[1]},")]
        (changed / "certificates.csv").write_text("".join(rows), encoding="utf-8")
        code, told = check(changed)
        (self.work / "changed/theorem.md").unlink()
        run = subprocess.run([BINARY, "certify", "--verify", "changed"], cwd=self.work, capture_output=True, text=True)
        return code, told, run.returncode, run.stdout

    def test_arcs_of_waves(self):
        for name in ("arcs", "friction_waves"):
            code, told = check(self.folders[name])
            self.assertEqual(code, 3, told)
            self.assertNotIn("refused", told)
            self.assertIn("arc: not covered: what lies between two points", told)

    def test_arcs_of_waves_over_an_event(self):
        """An event that is left out is found on the way from one point to the other."""
        for name, kind, reason in [
            ("arcs", "RV", "its ends have not one sequence of zones"),
            ("arcs", "GR", "its ends have not one sequence of zones"),
            ("friction_waves", "LP", "the curve does not lead to its last end"),
        ]:
            code, told, verified, words = self.left_out(name, kind)
            self.assertEqual((code, verified), (1, 1), told)
            self.assertIn(f"arc: refused: {reason}", told)
            self.assertIn("refused: the arc before it", words)
        # a value that is asked for is no event
        code, told, verified, words = self.left_out("arcs", "UZ")
        self.assertEqual((code, verified), (3, 0), told)

    def test_distances_of_waves_that_are_too_large(self):
        """What the program proves is not refuted, and some times as much is refused, at folds as elsewhere: of a fold ten times as much is
        still true, and shown."""
        for kind, times in ("LP", 40), ("CO", 10):
            larger = lambda found, times=times: f"{found[1]}{float(found[2]) * times!r},"
            change = lambda text: re.sub(rf"(kind: {kind},.*?unique: )([\d.e-]+),", larger, text, count=1, flags=re.S)
            self.refused_by_both("wave_fold", change, f"{kind} no other within", ["certificate.ron"], True)
        # where even the balls show it, and where it is less than what is proven
        less = lambda found: f"{found[1]}{float(found[2]) / 8!r},"
        forged = self.edited("wave_fold", lambda text: re.sub(r"(kind: LP,.*?unique: )([\d.e-]+),", less, text, count=1, flags=re.S))
        self.assertRegex(check(forged)[1], r"LP no other within .*: proven again")

    def test_a_jacobian_of_a_fold(self):
        """In balls, against differences."""
        certificate = read_ron((self.folders["wave_fold"] / "certificate.ron").read_text(encoding="utf-8"))
        proof = next(point for point in certificate["points"] if point["kind"] == "LP")["outcome"].value
        wave = Wave(proof["posed"], proof["near"], proof["condition"])
        middle = prove_zero(wave.equations, wave.guess).middle
        one, other = wave.slope(middle, [1] * len(middle)), differences(wave.equations, middle)
        self.assertLess(max(float(abs(a - b).upper()) for a, b in zip(one.entries(), other.entries())), 1e-25)

    def test_an_inequality_on_the_way(self):
        """From the onset of reverse slip on the wave without it solves all equations, and is refused where it is followed."""
        certificate = read_ron((self.folders["arcs"] / "certificate.ron").read_text(encoding="utf-8"))
        first = certificate["points"][0]["outcome"].value
        wave = Wave(first["posed"], first["near"], first["condition"])
        ends = []
        for value in ("0.2", "0.06"):
            wave.condition = wave.condition._replace(value=value)
            guess = ends[0] if ends else wave.guess
            for step in range(8 if ends else 1):
                part = 0.2 + (float(value) - 0.2) * (step + 1) / 8
                wave.condition = wave.condition._replace(value=repr(part) if ends else value)
                guess = wave.enclosed(prove_zero(wave.equations, guess))
            ends.append(guess)
        with self.assertRaises(Refused) as refused:
            walk(wave, ends, Point.signs, (1,))
        self.assertRegex(str(refused.exception), "on the way Q > −fP in stick is not shown")

    def test_an_arc_that_leads_elsewhere(self):
        # over a fold that is left out: the branch that begins there leads to another orbit at the same value
        def over(certificate):
            points = certificate["points"]
            fold = next(i for i, point in enumerate(points) if point["kind"] == "LP")
            points[:] = [points[fold - 1], points[fold + 1] | {"arc": "Proven"}]

        def rows(text):
            header, first, _, last, *_ = text.splitlines()
            *cells, _, why = last.split(",")
            return "\n".join([header, first, ",".join([*cells, "yes", why])]) + "\n"

        code, told = self.changed("ball", over, rows)
        self.assertEqual(code, 1, told)
        self.assertRegex(told, "arc: refused: the curve does not lead to its last end")
        self.assertIn("the arc before it", self.program("certify", "--verify", "changed", code=1))


if __name__ == "__main__":
    unittest.main()
