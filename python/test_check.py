"""Tests of check_certificate.py against certificates that the binary writes, as they are and forged.

    BRAKEWAVE=target/release/brakewave python3 python/test_check.py

Without the variable the binary is looked for in target/ and on PATH. Where it or python-flint is not there the
tests are skipped, and say so.
"""

import contextlib
import io
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from math import nextafter
from pathlib import Path

try:
    import flint

    import check_certificate
    from brakewave.ball_spectrum import Perturbed
    from brakewave.balls import Dual, Refused, double, exact, exponential, least_norm, prove_zero, tail, whole
    from brakewave.ball_layers import root
except (ImportError, SystemExit) as error:
    print(f"tests of python/check_certificate.py skipped: {error}")
    sys.exit(0)

ROOT = Path(__file__).resolve().parent.parent
BUILT = [ROOT / "target" / profile / "brakewave" for profile in ("release", "debug")]
BINARY = next(filter(None, [os.environ.get("BRAKEWAVE"), *(str(path) for path in BUILT if path.is_file())]), None)
# it is called from other folders
BINARY = BINARY and str(Path(BINARY).resolve())
BINARY = BINARY or shutil.which("brakewave")

MODEL = "model: (coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1.0), friction: 0.5, mismatch: 0.2),"
WAVES = f"""({MODEL} wave: (mode: 4, start: Fast),
    continuation: (parameter: Mismatch, range: (0.045, 0.2), toward: Down, stop_at: [0.08]),
)"""
DAMPED = MODEL.replace("mismatch: 0.2", "mismatch: 0.2, damping: (mass: 0.28)")
COUNTED = f"""({DAMPED} wave: (mode: 4, start: Fast),
    continuation: (parameter: MassDamping, range: (0.28, 0.31), toward: Up),
    stability: (max_frequency: 1.5),
)"""
"""One crossing; counts are 0 1 2 before it and 0 1 0 after, with what leads sector 0 left of the axis."""
LAYERED = f"""({MODEL.replace("mismatch: 0.2", "mismatch: 0.2, damping: (stiffness: 0.005)")} wave: (mode: 4, start: Fast),
    continuation: (parameter: Mismatch, range: (0.04315, 0.2), toward: Down, stop_after: [(event: GR, count: 1)]),
)"""
"""Slip and stick with a layer, reverse slip from RV on."""
SLOW = f"""({MODEL.replace("mismatch: 0.2", "mismatch: 0.8")} wave: (mode: 4, start: Slow),
    continuation: (parameter: Mismatch, range: (0.5, 6.0), toward: Down, stop_at: [0.653731], stop_after: [(event: UZ, count: 2)]),
)"""
"""A fold of a wave that separates, with a value just above it that is met on either side."""
SHIFT = 1 + 1e-12


def check(path):
    """Exit code of the checker, and what it prints."""
    output = io.StringIO()
    with contextlib.redirect_stdout(output), contextlib.redirect_stderr(output):
        return check_certificate.main(path), output.getvalue()


class Certified(unittest.TestCase):
    """Certificates of problems, in a folder that is there as long as the tests of a class."""

    PROBLEMS = {}
    OPTIONS = {}
    """Of `certify`, by the names of problems."""
    CODES = {}
    """Exit codes other than 0."""

    @classmethod
    def setUpClass(cls):
        cls.work, cls.folders = Path(tempfile.mkdtemp()), {}
        cls.addClassCleanup(shutil.rmtree, cls.work)
        for name, problem in cls.PROBLEMS.items():
            (cls.work / f"{name}.ron").write_text(problem, encoding="utf-8")
            cls.folders[name] = cls.work / name
            cls.program("certify", f"{name}.ron", "--out", name, "--quiet", *cls.OPTIONS.get(name, []), code=cls.CODES.get(name, 0))

    @classmethod
    def program(cls, *arguments, code=0):
        run = subprocess.run([BINARY, *arguments], cwd=cls.work, capture_output=True, text=True)
        assert run.returncode == code, f"{arguments}: {run.returncode}, {run.stdout}{run.stderr}"
        return run.stdout

    def copied(self, name, to="forged", **what):
        """A copy of a certificate, in place of the one before."""
        copy = self.work / to
        shutil.rmtree(copy, ignore_errors=True)
        return Path(shutil.copytree(self.folders[name], copy, **what))

    def edited(self, name, change, files=("certificate.ron",)):
        """A copy with what a function makes of the texts of files."""
        forged = self.copied(name)
        for file in files:
            text = (forged / file).read_text(encoding="utf-8")
            changed = change(text)
            self.assertTrue(text != changed, f"{file} is as it was")
            (forged / file).write_text(changed, encoding="utf-8")
        return forged

    def refused_by_both(self, name, change, statement, files, verify):
        """That what a function makes of texts is refused: by the checker for a statement, and by the program."""
        code, told = check(self.edited(name, change, files))
        self.assertEqual(code, 1, told)
        self.assertRegex(told, f"{statement}[^\n]*: refused|: refused[^\n]*{statement}")
        if verify:
            self.assertIn("refused", self.program("certify", "--verify", "forged", code=1))


class Alone(unittest.TestCase):
    def test_the_checker_needs_flint_and_nothing_else(self):
        """Neither numpy nor pandas, by both of its names: without an argument it says what it is for."""
        nothing = "sys.modules.update(dict.fromkeys(('numpy', 'pandas', 'matplotlib')))"
        folder = str(ROOT / "python")
        for run in ("run_module('brakewave.check', run_name='__main__')", f"run_path({folder!r} + '/check_certificate.py', run_name='__main__')"):
            code = f"import runpy, sys; {nothing}; sys.path.insert(0, {folder!r}); sys.argv[1:] = []; runpy.{run}"
            done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
            self.assertEqual(done.returncode, 1, done.stderr)
            self.assertIn("An independent check of what `brakewave certify` proves.", done.stderr)


class Mathematics(unittest.TestCase):
    """What the balls are used for, against closed forms."""

    def test_ron(self):
        text = '// one\n(a: 1.50, b: [Some(2), None], c: Law(x: -1e-3), d: ("p\\"q", On), /* e */ e: Tag((1, 2)),)'
        value = check_certificate.read_ron(text)
        self.assertEqual(value["a"].text, "1.50")
        self.assertEqual(value["b"], [2, None])
        self.assertEqual(value["c"].value["x"], -1e-3)
        self.assertEqual(value["d"], ('p"q', "On"))
        self.assertEqual(value["e"].value, (1, 2))
        for wrong in ["", "(a: 1", "(a: 1) 2", "(a: 1, a: 2)", "[1, 2)", "(a 1)", "@"]:
            with self.assertRaises((ValueError, IndexError), msg=wrong):
                check_certificate.read_ron(wrong)

    def test_ron_in_other_spellings(self):
        """What the program reads in a problem file is read here as well."""
        for text, number in [
            ("0x1F", "31.0"), ("-0b11", "-3.0"), ("0o17", "15.0"), ("7u8", "7.0"), ("1.50f64", "1.5"), ("0.5f32", "0.5"), ("b'1'", "49.0"),
            ("b'\\n'", "10.0"), ("1_000.5", "1000.5"), ("\ufeff#![enable(implicit_some)] 1.50", "1.50"),
        ]:  # fmt: skip
            self.assertEqual(check_certificate.read_ron(text).text, number, text)
        value = check_certificate.read_ron('#![enable(implicit_some, unwrap_newtypes)]\n(r#forcing: "w", raw: r#"a\\"#, long: "-e*\\\n    v")')
        self.assertEqual(value, {"forcing": "w", "raw": "a\\", "long": "-e*v"})
        for wrong in ["0xg", "1.0f", "1.0abc", "b'ab'", "#![enable(explicit_struct_names)] 1", "r#"]:
            with self.assertRaises((ValueError, IndexError), msg=wrong):
                check_certificate.read_ron(wrong)

    def test_numbers_of_a_kind(self):
        """A number is none of another kind, and none that takes for ever."""
        text, name, number = check_certificate.read_ron('("1.5", On, 1.5)')
        self.assertEqual((double(number), exact(text), whole(check_certificate.read_ron("2"))), (1.5, 1.5, 2))
        for wrong in (text, name, True, None, [number]):
            with self.assertRaises(Refused, msg=repr(wrong)):
                double(wrong)
            with self.assertRaises(Refused, msg=repr(wrong)):
                whole(wrong)
        with self.assertRaises(Refused):
            whole(number)
        for wrong in (number, name, "1e9999999", "1e-9999999", "1e99999999999", "1/0", "inf", " 1", "0x1"):
            with self.assertRaises(Refused, msg=repr(wrong)):
                exact(wrong)

    def test_zeros(self):
        # x² = 2 and xy = 1
        zero = prove_zero(lambda x: [x[0] * x[0] - 2, x[0] * x[1] - 1], [1.414, 0.707])
        for y, exact in zip(zero.middle, [flint.arb(2).sqrt(), 1 / flint.arb(2).sqrt()]):
            self.assertTrue((y.real + flint.arb(0, zero.radius)).overlaps(exact))
            self.assertLess(float(zero.radius), 1e-50)
        # none, and a double one
        for equation in [lambda x: [x[0] * x[0] + 1], lambda x: [x[0] * x[0]], lambda x: [x[0].exp()]]:
            with self.assertRaises(Refused):
                prove_zero(equation, [0.1])

    def test_exponentials(self):
        turn = [[0, 1, 0], [-1, 0, 0], [0, 0, 0]]
        time = flint.acb(0.7)
        turned = exponential(turn, time)
        self.assertTrue(turned[0][0].overlaps(time.cos()) and turned[1][0].overlaps(-time.sin()))
        # (sin t − t)/t³ at t = 0.7, and its limit −1/6
        self.assertTrue(tail(turn, time, [0, 1, 0], 3)[0].overlaps((time.sin() - time) / time**3))
        self.assertTrue(tail(turn, flint.acb(0), [0, 1, 0], 3)[0].contains(flint.fmpq(-1, 6)))

    def test_rates_of_layers(self):
        # 2(r − R)(r² + r + 3) with R = 10^8, and its derivative where the last coefficient moves
        rate = flint.acb(10) ** 8
        numbers = [flint.acb(2), 2 * (rate - 1), 2 * (rate - 3), Dual(6 * rate, 1)]
        found = root(numbers)
        self.assertTrue(found.v.contains(rate) and float(found.v.rad()) < 1e-40)
        self.assertTrue(found.d.overlaps(1 / (2 * (rate * rate + rate + 3))))

    def test_norms(self):
        # both have a row sum above 1; the spectral radii are 1/2 and 1.1
        self.assertTrue(least_norm([[0.5, 100], [0, 0.5]]) < 1)
        self.assertFalse(least_norm([[0.1, 1], [1, 0.1]]) < 1)

    def test_polynomials_of_a_disc(self):
        # in place of a wave's M(λ) an entire function
        wave = object.__new__(Perturbed)
        wave.period = lambda parts, growth: [[(3 * growth).exp()]]
        polynomials, error = wave.disc(None, flint.acb(0.5, 2), flint.arb(0.25))
        self.assertLess(float(error), 1e-11)
        for place in [flint.acb(0), flint.acb(0.6, 0.8), flint.acb(-1)]:
            exact = (3 * (flint.acb(0.5, 2) + place / 4)).exp()
            self.assertLess(float(abs(polynomials[0][0](place) - exact).upper()), float(error.upper()))

    def test_turns(self):
        # F(λ) − z = λ³ − z on the circle of radius 2 has three zeros, with |z| = 10 none
        wave = object.__new__(Perturbed)
        places = [2 * (flint.acb(0, 1) * flint.arb.pi() * i / 16).exp() for i in range(17)]
        for root, zeros in [(flint.acb(0, 1), 3), (flint.acb(0, 10), 0)]:
            chains = ([place**3 - z for place in places] for z in (root, root.conjugate()))
            self.assertEqual(wave.turns(*chains), zeros)


class Certificates(Certified):
    """Certificates as they are written are proven again, and forged ones are refused."""

    PROBLEMS = {"waves": WAVES, "counted": COUNTED, "layered": LAYERED}
    OPTIONS = {"counted": ["--spectrum"]}

    def forged(self, folder, *changes, file="certificate.ron", after=""):
        """What the checker says of a folder in which (pattern, replacement) changed the text once, after a text."""
        copy = self.copied(folder)
        text = (copy / file).read_text(encoding="utf-8")
        begin = text.index(after)
        for pattern, replacement in changes:
            changed, times = re.subn(pattern, replacement, text[begin:], count=1, flags=re.S)
            self.assertEqual(times, 1, pattern)
            self.assertNotEqual(changed, text[begin:], pattern)
            text = text[:begin] + changed
        (copy / file).write_text(text, encoding="utf-8")
        return check(copy)

    def refuses(self, folder, statement, *changes, **where):
        """Whether a forgery is refused for the statement that it changes."""
        code, output = self.forged(folder, *changes, **where)
        self.assertEqual(code, 1, output)
        self.assertRegex(output, f"{statement}[^\n]*: refused: ")

    def test_what_is_proven_is_proven_again(self):
        for name, folder in self.folders.items():
            code, output = check(folder)
            self.assertEqual(code, 3 if "not covered" in output else 0, output)
            self.assertNotIn("refused", output)
            # every statement, but of layers the distance and what opens
            uncovered = [line for line in output.splitlines() if "proven again" not in line and not line.startswith("theorem.md: not read")]
            reasons = "with material damping", "in other unknowns"
            self.assertTrue(name == "layered" or not uncovered, output)
            self.assertTrue(all(any(reason in line for reason in reasons) for line in uncovered), output)
            self.assertGreater(output.count("proven again"), 13 if name == "layered" else 25, name)
            self.assertEqual(check(folder / "certificate.ron"), (code, output))

    def test_forged_intervals(self):
        number = r"(-?[\d.]+(?:e-?\d+)?)"
        interval = rf"low: {number},\s*high: {number},"
        for name in ["parameter", "speed"]:
            # by 1e-12 of itself, which is less than an independent computation in doubles would see
            shift = lambda found: f"{name}: (low: {float(found[1]) * SHIFT!r}, high: {float(found[2]) * SHIFT!r},"
            for kind in ["RV", "UZ", "GR", "EP"]:
                self.refuses("waves", "wave", (rf"{name}: \(\s*{interval}", shift), after=f"kind: {kind},")
        below = lambda found: f"parameter: (low: {found[1]}, high: {float(found[1]) * 0.6 + float(found[2]) * 0.4!r},"
        turned = lambda found: f"parameter: (low: {found[2]}, high: {found[1]},"
        for change in [below, turned]:
            self.refuses("waves", "wave", (rf"parameter: \(\s*{interval}", change), after="kind: RV,")
        beside = lambda found: f"lengths: [(low: {found[2]}, high: {nextafter(float(found[2]), 9)!r},"
        self.refuses("waves", "wave", (rf"lengths: \[\s*\(\s*{interval}", beside))
        omega = lambda found: f"omega: Some((low: {float(found[1]) * SHIFT!r}, high: {float(found[2]) * SHIFT!r},"
        self.refuses("counted", "wave", (rf"omega: Some\(\(\s*{interval}", omega), after="kind: HB,")

    def test_forged_waves(self):
        for statement, change, after in [
            # another regime, another switch, another impact that the wave does not meet
            ("wave", ("regime: Reverse", "regime: Slip"), "kind: UZ"),
            ("wave", ("entry: Arrest", "entry: Landing"), "kind: UZ"),
            ("numbers", ("impact: Frictionless", "impact: Coulomb"), "kind: UZ"),
            # another type, another margin
            ("type", ("kind: RV", "kind: CO"), ""),
            ("type", ("kind: GR", "kind: ST"), ""),
            ("type", ("kind: UZ", "kind: LP"), ""),
            ("wave", ("watch: LowerForce", "watch: UpperForce"), "kind: RV"),
            # another number of the model: one on which the wave depends, one on which it does not
            ("wave", ('friction: "0.5"', 'friction: "0.5000000000001"'), "kind: GR"),
            ("numbers", ('mismatch: "0.2"', 'mismatch: "0.3"'), "kind: GR"),
            ("wave", ("mode: 4", "mode: 5"), ""),
            ("wave", ('Value\("0.08"\)', 'Value("0.0800000000001")'), ""),
            ("wave", ("parameter: Mismatch", "parameter: Friction"), ""),
            ("numbers", (r"unit: 0\.155", "unit: 0.3"), ""),
            # another point: that of the row before
            ("labels", ("label: 1,", "label: 2,"), ""),
            ("row", (r"inequalities: \d+", "inequalities: 99"), ""),
        ]:
            with self.subTest(statement=statement, change=change):
                self.refuses("waves", statement, change, after=after)

    def test_an_inequality_that_does_not_hold(self):
        # slip-stick beyond the point where reverse slip opens solves all equations, but not |Q| ≤ fP
        text = (self.folders["waves"] / "certificate.ron").read_text(encoding="utf-8")
        first = text[text.index("near: (") : text.index("parameter: 0.2,")]
        value = (r'condition: Value\("0.2"\)', 'condition: Value("0.08")')
        parameter = (r"parameter: 0\.2,", "parameter: 0.08,")
        interval = (r"low: 0\.1\d*,\s*high: 0\.2\d*,", "low: 0.07999999999999999, high: 0.08000000000000002,")
        self.assertIn("regime: Stick", first)
        self.refuses("waves", "inequalities", value, parameter, interval)

    def test_forged_layers(self):
        number = r"(-?[\d.]+(?:e-?\d+)?)"
        for name, kind in [("parameter", "RV"), ("parameter", "GR"), ("speed", "RV"), ("speed", "GR")]:
            shift = lambda found: f"{name}: (low: {float(found[1]) * SHIFT!r}, high: {float(found[2]) * SHIFT!r},"
            change = (rf"{name}: \(\s*low: {number},\s*high: {number},", shift)
            self.refuses("layered", "wave", change, after=f"kind: {kind},")
        self.refuses("layered", "wave", (r'material: Some\("0.005"\)', 'material: Some("0.0050000000001")'), after="kind: RV")
        self.refuses("layered", "type", ("kind: RV", "kind: ST"))
        # beyond the point where reverse slip opens, as in the undamped problem
        point = (r'condition: Value\("0.2"\)', 'condition: Value("0.05")'), (r"parameter: 0\.2,", "parameter: 0.05,")
        interval = (r"low: 0\.1\d*,\s*high: 0\.2\d*,", "low: 0.04999999999999999, high: 0.05000000000000002,")
        self.refuses("layered", "inequalities", *point, interval)

    def test_boxes_that_have_another_wave(self):
        (self.work / "slow.ron").write_text(SLOW, encoding="utf-8")
        self.folders["slow"] = self.work / "slow"
        self.program("certify", "slow.ron", "--out", "slow", "--quiet")
        # what is stated truly is shown, though it is told much more widely than entries and speeds are known apart
        code, output = check(self.folders["slow"])
        self.assertEqual((code, len(re.findall("no other within [^\n]*: proven again", output))), (0, 6), output)
        code, output = self.forged("slow", (r"(label: 4,.*?unique: )[^,]*", r"\g<1>0.05"))
        del self.folders["slow"]
        self.assertEqual(code, 1, output)
        self.assertIn("the solution of label 6 lies in the box of label 4, too", output)

    def test_a_wide_interval_of_an_eigenvalue_is_as_true(self):
        forged = self.copied("counted", ignore=shutil.ignore_patterns("theorem.md"))
        text = (forged / "certificate.ron").read_text(encoding="utf-8")
        # that of sector 0 lies left of the axis, so that the table says the same
        wide = re.sub(r"(sector: 0,.*?growth: \(\s*low: )[^,]*(,\s*high: )[^,]*", r"\g<1>-inf\g<2>inf", text, count=1, flags=re.S)
        self.assertNotEqual(wide, text)
        (forged / "certificate.ron").write_text(wide, encoding="utf-8")
        code, output = check(forged)
        self.assertEqual(code, 0, output)
        self.program("certify", "--verify", "forged")

    def test_numbers_of_a_wave_are_texts(self):
        self.refuses("waves", "fields", (r'friction: "0\.5"', "friction: 0.5"))

    def test_margins_belong_to_their_zones(self):
        # Q + fP has a zero in slip, too, where no switch asks for it; so has W − 1 where nothing lands
        for watch in ["LandingRate", "UpperForce", "Impulse", "Tension", "Gap"]:
            self.refuses("waves", "wave", ("watch: LowerForce", f"watch: {watch}"), after="kind: RV")
        for zone in ["0", "1.5", "-1", "9"]:
            self.refuses("waves", "wave", (r"zone: \d", f"zone: {zone}"), after="kind: RV")

    def test_what_is_beyond(self):
        text = (self.folders["waves"] / "certificate.ron").read_text(encoding="utf-8")
        for kind in ["RV", "GR"]:
            event = text[text.index(f"kind: {kind}") :]
            found = re.search(r"condition: (Margin\(.*?\)),\s*beyond: Some\(.*?\)\),\s*near: (\(.*?\)),\s*statement", event, re.S)
            same = f"beyond: Some((condition: {found[1]}, near: {found[2]})), near: {found[2]}, statement"
            change = (r"beyond: Some\(.*?\)\),\s*near: \(.*?\),\s*statement", lambda _: same)
            # the sequence of the wave itself, and states of another wave
            self.refuses("waves", "the same wave beyond", change, after=f"kind: {kind}")
            self.refuses("waves", "the same wave beyond", (r"(beyond: .*?zones: \[\s*\(\s*)-?[\d.e-]+", r"\g<1>7.5"), after=f"kind: {kind}")
            # at a value of the parameter nothing changes
            value = (r"beyond: None", lambda _: f"beyond: Some((condition: {found[1]}, near: {found[2]}))")
            self.refuses("waves", "the same wave beyond", value, after="kind: UZ")
            # without it less is said
            row = (r"beyond: Some\(.*?\)\),\s*near", "beyond: None, near")
            self.assertEqual(self.forged("waves", row, after=f"kind: {kind}"), check(self.folders["waves"])[:1] + (self.without_beyond(kind),))

    def without_beyond(self, kind):
        """What the checker prints of the certificate that says nothing of what is beyond an event."""
        lines = check(self.folders["waves"])[1].splitlines(keepends=True)
        return "".join(line for line in lines if not (f" {kind} the same" in line))

    def test_names_that_there_are_not(self):
        """A name of an enum that has no such name is refused, and so is one that holds something else: it is no kind of statement that is
        not treated."""
        for folder, old, new in [
            ("waves", "impact: Frictionless", "impact: Elastic"),
            ("waves", "impact: Frictionless", 'impact: "Frictionless"'),
            ("waves", "impact: Frictionless", "impact: Frictionless(1.0)"),
            ("waves", "watch: LowerForce", "watch: Landing"),
            ("waves", "watch: LowerForce", "watch: End(0)"),
            ("waves", "regime: Stick", "regime: Sticking"),
            ("waves", "entry: Arrest", "entry: Rest"),
            ("waves", "kind: RV", "kind: RW"),
            ("waves", "parameter: Mismatch", "parameter: Tilt"),
            ("waves", r"origin: Geometry", "origin: Shape"),
            ("waves", r"condition: Value\(", "condition: Values("),
            ("waves", r'condition: Value\("0.2"\)', "condition: Value(0.2)"),
            ("waves", r"condition: Value\(.*?\)", "condition: Value"),
            ("waves", r"leg: (\d+)", r"leg: \1, arc: Some(Shown)"),
            ("counted", "verdict: Unstable", "verdict: Chaotic"),
            ("counted", "verdict: Unstable", "verdict: Stable"),
        ]:
            with self.subTest(new=new):
                self.refuses(folder, "fields", (old, new))
                self.assertNotIn("not covered", self.forged(folder, (old, new))[1])
        self.assertEqual(self.forged("waves", (r"outcome: Proven", "outcome: Shown"))[0], 2)

    def test_margins_that_no_wave_has(self):
        # of a release with material damping, and of D/c, in which waves run
        for watch in ("Release", "Coupling"):
            self.refuses("waves", "wave", ("watch: LowerForce", f"watch: {watch}"))
        self.refuses("waves", "wave", ("parameter: Mismatch,\\s*mode", "parameter: Smoothing, mode"))

    def test_layers_and_material_damping_go_together(self):
        self.refuses("layered", "fields", (r"layers: \[.*?\],", ""), after="kind: RV")
        self.refuses("layered", "fields", (r"layers: \[", "layers: [0.0, "), after="kind: RV")
        beta = (r"ratio: None", 'material: Some("0.02"), ratio: None')
        self.refuses("waves", "fields", beta)
        # with layers, too, it is not the β of the problem, whatever wave there is
        text = (self.folders["waves"] / "certificate.ron").read_text(encoding="utf-8")
        zones = text[: text.index("excess: ")].count("entry: ")
        layers = (r"excess: ", f"layers: {[0.0] * zones}, excess: ")
        self.refuses("waves", "numbers of the problem", beta, layers)

    def test_whole_numbers(self):
        for folder, statement, change, after in [
            ("waves", "wave", ("mode: 4", "mode: 4.5"), ""),
            ("counted", "wave", (r"sector: \d", "sector: 6"), "kind: HB"),
            ("counted", "wave", (r"sector: \d", "sector: -2"), "kind: HB"),
            ("counted", "eigenvalue", (r"sector: 1", "sector: 1.5"), "eigenvalues: ["),
            ("counted", "eigenvalue", (r"sector: 1", "sector: 5"), "eigenvalues: ["),
            ("counted", "growing", (r"counts: \[\s*0,\s*1", "counts: [0, 1.2"), ""),
            ("counted", "growing", ("mode: 4,\\s*counts", "mode: 4.2, counts"), ""),
            ("waves", "fields", (r"leg: \d+", "leg: 0.5"), ""),
            ("waves", "fields", (r"leg: \d+", 'leg: "0"'), ""),
        ]:
            with self.subTest(change=change):
                self.refuses(folder, statement, change, after=after)

    def test_a_wave_traversed_twice(self):
        # one of mode 8 is no wave of mode 4
        text = (self.folders["waves"] / "certificate.ron").read_text(encoding="utf-8")
        sequence, zones = (re.search(pattern, text, re.S)[1] for pattern in (r"signature: \(\[(.*?)\]\)", r"zones: \[(.*?\)),\s*\]"))
        lengths = re.search(r"lengths: \[(.*?\)),\s*\]", text, re.S)[1]
        twice = [
            (r"mode: 4", "mode: 2"),
            (r"signature: \(\[.*?\]\)", lambda _: f"signature: ([{sequence} {sequence}])"),
            (r"zones: \[.*?\),\s*\]", lambda _: f"zones: [{zones}, {zones}]"),
            (r"lengths: \[.*?\),\s*\]", lambda _: f"lengths: [{lengths}, {lengths}]"),
        ]
        self.refuses("waves", "wavelength", *twice)

    def test_numbers_of_a_model(self):
        # β without a layer, ν where the coefficients are given
        self.refuses("waves", "wave", ("parameter: Mismatch", "parameter: StiffnessDamping"))
        given = 'origin: Given(("1.08757120692928", "0.3107346305512234", "-0.8109523622920903", "17.8555456457278", "8.4578900427131"))'
        self.refuses("waves", "wave", (r"origin: Geometry\(.*?\)\)", given), ("parameter: Mismatch", "parameter: Nu"))
        # α < 0, r < 1
        for change in [('damping: "0.0"', 'damping: "-0.05"'), ("ratio: None", 'ratio: Some("0.9")')]:
            code, output = self.forged("waves", change)
            self.assertEqual(code, 1, output)
        # the window, and a distance over which the equations end
        for window in ["-1.5", "0.0", "inf"]:
            self.refuses("counted", "fields", ("window: 1.5", f"window: {window}"))
        for distance in ["-0.001", "1e300", "inf"]:
            self.refuses("waves", "fields", (r"unique: [\d.e-]+", f"unique: {distance}"), after="kind: GR")
        self.refuses("counted", "growing", ("window: 1.5", "window: 0.5"), after="kind: HB")

    def test_one_event_twice(self):
        text = (self.folders["counted"] / "certificate.ron").read_text(encoding="utf-8")
        begin = text.index("kind: HB")
        begin = text.rindex("(", 0, begin)
        end = text.index("(label: 3") if "(label: 3" in text else text.rindex("(", 0, text.index("label: 3"))
        point = text[begin:end]
        copy = self.work / "twice"
        shutil.copytree(self.folders["counted"], copy)
        self.addCleanup(shutil.rmtree, copy)
        later = point.replace("label: 2", "label: 3", 1)
        changed = text[:end] + later + text[end:].replace("label: 3", "label: 4", 1)
        (copy / "certificate.ron").write_text(changed, encoding="utf-8")
        (copy / "certificates.csv").unlink()
        code, output = check(copy)
        self.assertEqual(code, 1, output)
        self.assertRegex(output, "3 HB wavelength[^\n]*: refused: it is that of label 2")

    def test_what_leads_lies_in_the_window(self):
        # the eigenvalue of the sector is at more than 1.2
        found = re.search(r"omega: \(\s*low: (-?[\d.]+)", (self.folders["counted"] / "certificate.ron").read_text(encoding="utf-8")[:])
        self.assertIsNotNone(found)
        self.refuses("counted", "leading", ("window: 1.5", "window: 0.001"))

    def test_numbers_are_numbers(self):
        self.refuses("counted", "fields", ("window: 1.5", 'window: "1.5"'))
        self.refuses("counted", "fields", (r"line: [^,]*,", "line: -inf,"))
        self.refuses("waves", "fields", (r"kind: (\w+)", r'kind: "\1"'))
        self.refuses("waves", "wave", ('"0.3"', '"a third"'))
        self.refuses("waves", "wave", ('"0.3"', '"1e9999999"'))
        self.refuses("waves", "wave", (r"low: ([^,]*),", r'low: "\1",'))

    def test_the_window_that_follows_from_the_model(self):
        folder = self.copied("counted")
        source = (folder / "source.ron").read_text(encoding="utf-8")
        (folder / "source.ron").write_text(source.replace("max_frequency: 1.5", ""), encoding="utf-8")
        code, output = check(folder)
        self.assertEqual(code, 1, output)
        self.assertRegex(output, "growing eigenvalues: refused: the window is not that of the problem")

    def test_a_reason_is_no_proof(self):
        growth = (r"growth: Some\(Proven\(.*?\n        \),\n", 'growth: Some(Open("stable for all delta")),\n        ),\n')
        code, output = self.forged("counted", growth)
        self.assertIn("growing eigenvalues: not covered: the certificate says in words", output)
        self.assertIn("why something is not proven: not checked", output)
        self.refuses("counted", "fields", ("growth: Some\\(Proven\\(", "growth: Some(Believed("))

    def test_words_beside_a_certificate(self):
        """They are not read, which is said, whatever version of the program has written them."""
        folder = self.copied("waves")
        told = check(folder)
        self.assertIn("theorem.md: not read", told[1])
        (folder / "theorem.md").write_text("It is stable for all delta.", encoding="utf-8")
        self.assertEqual(check(folder), told)
        (folder / "theorem.md").unlink()
        self.assertNotIn("theorem.md", check(folder)[1])

    def test_a_cell_of_any_length(self):
        self.refuses("waves", "row", ("yes,", "yes," + "x" * 200_000), file="certificates.csv")

    def test_other_fields(self):
        for place, change in [
            ("near: (", ("near: \\(", "near: (chaotic: true, ")),
            ("posed: (", ("posed: \\(", "posed: (tilt: 1.0, ")),
            ("statement: (", ("statement: \\(", "statement: (stable: true, ")),
            ("label: 1", ("label: 1,", "label: 1, best: true,")),
        ]:
            self.refuses("waves", "fields", change, after=place[:-1] if place.endswith("(") else place)

    def test_swapped_labels(self):
        labels = re.findall(r"label: (\d+),", (self.folders["waves"] / "certificate.ron").read_text(encoding="utf-8"))
        swap = (rf"label: {labels[1]},(.*?)label: {labels[2]},", rf"label: {labels[2]},\1label: {labels[1]},")
        self.refuses("waves", "labels", swap)
        self.refuses("waves", "row", swap)

    def test_forged_table(self):
        self.refuses("waves", "row", (r"GR,mismatch,5\.0228", "GR,mismatch,5.0229"), file="certificates.csv")
        self.refuses("counted", "row", (r"HB,(.*),2,no,", r"HB,\1,4,no,"), file="certificates.csv")
        self.refuses("counted", "row", (r"HB,(.*),2,no,", r"HB,\1,2,yes,"), file="certificates.csv")
        self.refuses("waves", "row", (r"(RV,mismatch(?:,[^,]*){4}),[^,]*", r"\1,1e-1"), file="certificates.csv")

    def test_forged_eigenvalues(self):
        for statement, *changes, after in [
            ("wave", (r"sector: (\d)", lambda found: f"sector: {(int(found[1]) + 1) % 3}"), "kind: HB"),
            ("eigenvalue", ("sector: 1", "sector: 2"), "eigenvalues: ["),
            ("eigenvalue", (r"growth: \(\s*low: 0\.00893151", "growth: (low: 0.00893152"), ""),
            ("growing", (r"counts: \[\s*0,\s*1", "counts: [0, 2"), ""),
            ("growing", (r"counts: \[\s*0,\s*1", "counts: [0, 0"), ""),
            ("growing", (r"counts: \[\s*0", "counts: [1"), "kind: HB,"),
            ("growing", ("window: 1.5", "window: 1.0"), ""),
            ("stability", ("verdict: Unstable", "verdict: HighFrequency"), ""),
            ("stability", ("verdict: Unstable", "verdict: Neutral"), "kind: HB,"),
            ("stability", ("verdict: Unstable", "verdict: Stable(beyond: 90.0)"), ""),
            ("leading", (r"sector: 1,\s*line: -?0\.0\d*", "sector: 1, line: 0.02"), ""),
            ("leading", (r"sector: 1,\s*line: -?0\.0\d*", "sector: 1, line: -2.5"), ""),
        ]:
            with self.subTest(statement=statement, changes=changes):
                self.refuses("counted", statement, *changes, after=after)

    def test_translation_does_not_lead(self):
        # λ = 0 is an eigenvalue of sector 0, but the one of the statement is what leads beside it
        nothing = "(low: -1e-12, high: 1e-12)"
        zero = rf"eigenvalues: [(sector: 0, near: (0.0, 0.0), growth: {nothing}, omega: {nothing}),"
        eigenvalue = (r"eigenvalues: \[\s*\(\s*sector: 0,.*?omega: \(.*?\),\s*\),", zero)
        self.refuses("counted", "leading", eigenvalue, (r"sector: 0,\s*line: -[\d.]*", "sector: 0, line: -0.0001"))

    def test_what_cannot_be_read(self):
        self.assertEqual(check(self.work / "nothing")[0], 2)
        for change in [(r"\(", "["), ("posed", "said"), ("label: 1", "label: x"), ("label: 1", "label: 1.5")]:
            code, output = self.forged("waves", change)
            self.assertEqual(code, 2, output)


if __name__ == "__main__":
    if BINARY is None:
        print("tests of python/check_certificate.py skipped: no binary; build one or set BRAKEWAVE")
        sys.exit(0)
    unittest.main()
