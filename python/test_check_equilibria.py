"""Tests of brakewave.ball_equilibria against certificates of equilibria that the binary writes, as they are and forged.

    BRAKEWAVE=target/release/brakewave python3 python/test_check_equilibria.py

Where the binary or python-flint is not there the tests are skipped, and say so (see test_check.py).
"""

import re
import subprocess
import sys
import unittest

from test_check import BINARY, ROOT, Certified, check

try:
    from flint import acb, acb_mat, arb

    from brakewave.ball_equilibria import Degree, Formula, evaluated, right_of_axis
    from brakewave.balls import Dual, NotCovered, Refused
except ImportError as error:
    print(f"tests of python/brakewave/ball_equilibria.py skipped: {error}")
    sys.exit(0)

HARVEST, BRUSSELATOR, FOCI = ((ROOT / f"problems/{name}.ron").read_text(encoding="utf-8") for name in ("harvest", "brusselator", "two_foci"))
REACTION = """(
    system: (states: ["u1", "u2"], parameters: {"p1": 0.05, "p2": 14.0, "p3": 2.0},
        modes: {"flow": (rates: {"u1": "-u1 + p1*(1 - u1)*exp(u2)", "u2": "-u2 + p1*p2*(1 - u1)*exp(u2) - p3*u2"})}),
    equilibrium: (start: Given(mode: "flow", state: {"u1": 0.06, "u2": 0.3})),
    continuation: (parameter: "p1", range: (0.05, 0.15), toward: Up),
)"""
"""Two folds, between them a saddle whose eigenvalues have the sum zero, and a Hopf point."""
RELAY = """(
    system: (
        states: ["s", "x", "y"], parameters: {"mu": -0.3, "k": 0.4, "c0": 0.05, "M": 0.8, "p": 0.6, "r": 0.3},
        modes: {
            "plus": (rates: {"s": "p*x + r*y - M", "x": "mu*x - y - x*(x^2 + y^2) + k", "y": "x + mu*y - y*(x^2 + y^2) + c0"},
                until: [(zero: "s", to: "minus")]),
            "minus": (rates: {"s": "p*x + r*y + M", "x": "mu*x - y - x*(x^2 + y^2) - k", "y": "x + mu*y - y*(x^2 + y^2) + c0"},
                until: [(zero: "-s", to: "plus")]),
        },
        sliding: {"slide": ("plus", "minus")},
    ),
    equilibrium: (start: Given(mode: "slide", state: {"s": 0.0, "x": -0.05, "y": 0.0})),
    continuation: (parameter: "mu", range: (-0.3, 0.1), toward: Up, stop_after: [(event: HB, count: 1)]),
)"""
"""A Hopf point in a sliding mode."""
TWICE = HARVEST.replace("range: (0.3, 0.6)", "range: (0.3, 0.6), stop_at: [0.422499]").split("    certify: true")[0] + ")"
"""A value just below the fold, where two equilibria of the sliding mode are near one another."""
PIECES = """(
    system: (states: ["x", "y", "z"], parameters: {"alpha": 6.0, "beta": 14.28, "a0": -0.14285714285714285, "a1": 0.2857142857142857},
        modes: {
            "middle": (rates: {"x": "alpha*(y - a0*x)", "y": "x - y + z", "z": "-beta*y"}, until: [(zero: "1 - x", to: "right")]),
            "right": (rates: {"x": "alpha*(y - a1*x - (a0 - a1))", "y": "x - y + z", "z": "-beta*y"}, until: [(zero: "x - 1", to: "middle")]),
        }),
    equilibrium: (start: Given(mode: "right", state: {"x": 1.5, "y": 0.0, "z": -1.5})),
    continuation: (parameter: "alpha", range: (6.0, 8.0), toward: Up),
)"""
"""A Hopf point of an affine mode, whose cycles are a vertical family."""
STOPS = """(
    system: (
        states: ["x", "v", "y", "w"], parameters: {"F": 1.0, "d": 0.5, "k": 2.0, "c": 0.2, "g": 0.3},
        contacts: {"p": Stop(gap: "d - x", restitution: "0.5"), "s": Spring(gap: "g + y", stiffness: "k", damping: "c")},
        rates: {"x": "v", "v": "-x + k*(y - x) - c*v + F - p + 0.1*x^3", "y": "w", "w": "-y - k*(y - x) - c*w - F/2 + s"},
    ),
    equilibrium: (start: Given(mode: "open.open", state: {"x": 0.2, "v": 0.0, "y": -0.1, "w": 0.0})),
    continuation: (parameter: "F", range: (-5.0, 5.0), toward: Both),
)"""
"""A mass that comes to a stop, to a damped spring, and to a fold."""
PRESSED = """(
    system: (
        states: ["x", "v", "y", "w"], parameters: {"m": -0.5, "d": 0.5, "k": 2.0, "f": 0.3, "mu": 0.2, "e": 0.1, "vb": 1.0},
        contacts: {
            "p": Spring(gap: "x + d", stiffness: "k", damping: "e"), "s": Stop(gap: "1 - y", restitution: "0"),
            "q": Friction(slip: "v - vb", bound: "mu*s*exp(v - vb)"),
        },
        modes: {"all": (rates: {"x": "v", "v": "m*v - v^3 - x - x^2/3 - 3*d + p + q + 0.1*y", "y": "w", "w": "-y/2 + 2 + f*x - s - w"})},
    ),
    equilibrium: (start: Given(mode: "all.closed.closed.backward", state: {"x": -0.9, "v": 0.0, "y": 1, "w": 0.0})),
    continuation: (parameter: "m", range: (-1.0, 3.0), toward: Up),
)"""
"""A Hopf point beside a closed stop whose force is in the friction."""


class Mathematics(unittest.TestCase):
    """What is read and counted, against numbers by hand."""

    def test_expressions(self):
        names = {"x": acb(2), "y": acb(-3)}
        for text, expected in [
            ("-x^2 + 1", -3), ("x^-1", 0.5), ("y^3", -27), ("max(x, y)", 2), ("min(x, y)", -3), ("abs(y)", 3), ("x/y*3", -2), ("0.1*x", 0.2),
            ("sqrt(x)^2", 2), ("exp(ln(x))", 2), ("cosh(x)^2 - sinh(x)^2", 1), ("tan(atan(x))", 2), ("cos(acos(0.3)) - sin(asin(0.3))", 0),
        ]:  # fmt: skip
            self.assertAlmostEqual(float(evaluated(text, names).real), expected, places=14, msg=text)
        for text in ["q", "sine(x)", "(x", "x @ y", "x if x else y", "max(x)"]:
            with self.assertRaises(Refused, msg=text):
                evaluated(text, names)
        for text in ["ln(y)", "sqrt(y)", "asin(x)", "abs(x - 2)"]:
            with self.assertRaises(NotCovered, msg=text):
                evaluated(text, names)

    def test_derivatives(self):
        # d/dx of every function by a difference
        for name in "sin cos tan exp ln sqrt tanh asin acos atan sinh cosh abs".split():
            slope = evaluated(f"{name}(x)", {"x": Dual(acb(0.4), acb(1))}).d
            step = arb(2) ** -60
            moved = [evaluated(f"{name}(x)", {"x": acb(0.4) + sign * step}) for sign in (1, -1)]
            self.assertLess(abs(float((slope - (moved[0] - moved[1]) / (2 * step)).real)), 1e-30, name)

    def test_formulas(self):
        names = {name: Formula.named(name) for name in "xyp"}
        read = lambda text: evaluated(text, names, Formula.number)
        for one, other in [("(x + y)^2", "x^2 + 2*x*y + y*y"), ("x - p", "-(p - x)"), ("x/4", "0.25*x"), ("x*sin(y + p)", "sin(p + y)*x")]:
            self.assertFalse(read(one) - read(other), one)
        for one, other in [("x/y", "y/x"), ("sin(x)", "x"), ("0.1*x", "0.10000000000000001*x")]:
            self.assertTrue(read(one) - read(other), one)
        degree = lambda text: evaluated(text, {"x": Degree(1), "y": Degree(1), "p": Degree(0)}, Degree.number).degree
        self.assertEqual([degree(text) for text in ["p^2/3", "x/p - 2*y", "x*y", "sin(p)*x", "p/x", "exp(x)"]], [0, 1, 2, 1, 2, 2])

    def test_eigenvalues_right_of_the_axis(self):
        # Jordan blocks of −1 and of 2 beside 0, 0.1 ± 2i beside −3, 1e6 and −1e-6, 0 beside 1, and ± i beside 2
        one, zero, pair = [1], [0, 1], [1, 0, 1]
        for rows, critical, expected in [
            ([[-1, 1, 0], [0, -1, 1], [0, 0, -1]], one, 0), ([[2, 1, 5], [0, 2, 1], [0, 0, 0]], zero, 2), ([[0.1, -2, 5], [2, 0.1, -7], [0, 0, -3]], one, 2),
            ([[1e6, 0], [0, -1e-6]], one, 1), ([[0, 3], [0, 1]], zero, 1), ([[0, -1, 4], [1, 0, 1], [0, 0, 2]], pair, 1),
            ([[0, -1, 4, 0], [1, 0, 1, 0], [0, 0, 2, 1], [0, 0, 0, 2]], pair, 2),
        ]:  # fmt: skip
            self.assertEqual(right_of_axis(acb_mat(rows), critical), expected, rows)
        for rows in [[0, -1], [1, 0]], [[0, 1], [0, 0]]:
            with self.assertRaises(Refused):
                right_of_axis(acb_mat(rows), one)


@unittest.skipUnless(BINARY, "no binary of brakewave")
class Certificates(Certified):
    """Certificates as they are written hold; forged ones are refused by the checker and by `certify --verify`."""

    PROBLEMS = {"harvest": HARVEST, "brusselator": BRUSSELATOR, "foci": FOCI, "reaction": REACTION, "relay": RELAY, "pieces": PIECES, "twice": TWICE,
                "stops": STOPS, "pressed": PRESSED}  # fmt: skip
    # a value of a monitor is not covered
    CODES = {"foci": 1}

    def test_honest(self):
        for name, points, coefficients, beyond in [
            ("harvest", 7, 0, 2), ("brusselator", 5, 1, 0), ("foci", 5, 0, 1), ("reaction", 5, 1, 0), ("relay", 2, 1, 0), ("pieces", 3, 1, 0),
            ("stops", 8, 0, 3), ("pressed", 3, 1, 0),
        ]:  # fmt: skip
            code, told = check(self.folders[name])
            self.assertEqual(code, 3 if "not covered" in told else 0, told)
            self.assertNotIn("refused", told)
            for what in ["fields", "equilibrium, in its intervals", "not an earlier event", "numbers", "type", "inequalities", "row of", "growing"]:
                self.assertEqual(len(re.findall(f"{what}.*: proven again", told)), points, told)
            self.assertEqual(told.count("first Lyapunov coefficient: proven again"), coefficients, told)
            self.assertEqual(told.count("mode beyond: proven again"), beyond, told)

    def refused(self, name, change, why, files=("certificate.ron",)):
        """That what a function makes of texts is refused, by the checker for a reason, and by the program."""
        code, told = check(self.edited(name, change, files))
        self.assertEqual(code, 1, told)
        self.assertRegex(told, why)
        run = subprocess.run([BINARY, "certify", "--verify", "forged"], cwd=self.work, capture_output=True, text=True)
        self.assertIn(run.returncode, (1, 4), run.stdout)

    def replaced(self, name, old, new, why):
        self.refused(name, lambda text: text.replace(old, new), why)

    def test_types(self):
        self.replaced("harvest", "kind: LP", "kind: HB", "makes it LP")
        self.replaced("harvest", "kind: BE", "kind: LP", "makes it BE")
        self.replaced("brusselator", "kind: HB", "kind: LP", "makes it HB")
        self.replaced("brusselator", "kind: HB", "kind: BP", "makes it HB")
        self.replaced("harvest", "condition: Fold", "condition: Boundary(guard: 0)", "in its intervals: refused")

    def test_points_that_are_others(self):
        # a fold as a Hopf point, a Hopf point as a fold
        self.refused("reaction", self.as_hopf("1e-9", "0.3110177634953864, 1.4514162296451365", "0.10573897827165065"), "in its intervals: refused")
        fold = lambda text: re.sub(r"condition: Hopf\(\s*omega: [^)]*\)", "condition: Fold", re.sub(r"omega: Some\(\(.*?\)\),|lyapunov: Some.*?\)\)\),", "", text, flags=re.S))
        self.refused("brusselator", lambda text: fold(text).replace("kind: HB", "kind: LP"), "in its intervals: refused")
        # a saddle whose eigenvalues have the sum zero
        saddle = self.as_hopf("0.2495150261979219", "0.3192050804179089, 1.4896237086169084", "0.10571050120633914")
        self.refused("reaction", saddle, "in its intervals: refused")

    @staticmethod
    def as_hopf(omega, state, parameter):
        condition = f"condition: Hopf(omega: {omega}), near: (mode: \"flow\", state: [{state}], parameter: {parameter}), statement"
        return lambda text: re.sub(r"condition: Hopf\(.*?\bstatement", condition, text, flags=re.S)

    def test_boxes_that_have_another_equilibrium(self):
        for label, found in (4, "6 lies in the box of label 4"), (6, "4 lies in the box of label 6"), (4, "4 UZ [^\n]*: refused: another solution lies in the box"):
            wide = lambda text, label=label: re.sub(rf"(label: {label},.*?unique: )[^,]*", r"\g<1>0.003", text, count=1, flags=re.S)
            self.refused("twice", wide, found)
        self.assertEqual(check(self.folders["twice"])[0], 0)

    def test_modes_and_guards(self):
        self.replaced("harvest", 'mode: "low"', 'mode: "high"', "refused")
        self.replaced("harvest", 'mode: "slide"', 'mode: "low"', "refused")
        self.replaced("harvest", "guard: 1", "guard: 0", "refused")
        self.replaced("harvest", "guard: 0", "guard: 7", "no whole number from 0 on below")
        self.replaced("harvest", "persists: false", "persists: true", "mode beyond: refused: the equilibria of both modes lie otherwise")
        self.replaced("foci", "persists: true", "persists: false", "mode beyond: refused: the equilibria of both modes lie otherwise")
        self.replaced("harvest", "inequalities: 3", "inequalities: 4", "there are 3 of them")
        # the same point, where a guard that holds there is negative or zero, in the problem too
        both = ("certificate.ron", "source.ron")
        for guard, why in [("x - 0.9", "that `x - 0.9` is positive is not shown"), ("x - 0.35", "that `x - 0.35` is positive is not shown")]:
            rewritten = lambda text, guard=guard: re.sub(r'\(\s*zero: "y - al"', f'(zero: "{guard}", to: "low"), (zero: "y - al"', text)
            self.refused("harvest", rewritten, why, both)

    def test_contacts(self):
        self.replaced("stops", 'mode: "open.closed"', 'mode: "open.open"', "refused")
        self.replaced("stops", 'mode: "closed.open"', 'mode: "closed.closed"', "refused")
        self.replaced("stops", 'mode: "closed.closed"', 'mode: "closed.closed.open"', "is no mode")
        self.replaced("stops", "growing: Some(1)", "growing: Some(0)", "1 grow")
        self.replaced("stops", "inequalities: 8", "inequalities: 10", "there are 8 of them")
        self.replaced("stops", "persists: true", "persists: false", "mode beyond: refused: the equilibria of both modes lie otherwise")
        # what the program does not even read, in the certificate and in its problem
        damping = lambda text: re.sub(r'damping: (Some\()?"c"', r'damping: \1"-c"', text)
        for change, why in [
            (damping, "that a number of `s` is not negative is not shown"),
            (lambda text: text.replace("F - p + 0.1", "F + p + 0.1"), "that `p` acts against what it is about is not shown"),
            (lambda text: text.replace('"d - x"', '"d - x + 0.1*v"'), "the rate of a gap depends on a force"),
        ]:
            code, told = check(self.edited("stops", change, ("certificate.ron", "source.ron")))
            self.assertEqual(code, 1, told)
            self.assertIn(why, told)
        self.replaced("pressed", "low: -0.67256", "low: -0.57256", "first Lyapunov coefficient: refused")

    def test_numbers(self):
        self.replaced("brusselator", "low: -0.50000000", "low: -0.40000000", "first Lyapunov coefficient: refused")
        self.refused("brusselator", lambda text: re.sub(r"Within\(\(\s*low: -0.5(\d*),\s*high: -0.4(\d*)", r"Within((low: 0.4\2, high: 0.5\1", text), "first Lyapunov coefficient: refused")
        self.refused("brusselator", lambda text: re.sub(r"Within\(\(.*?\)\)", "Vertical", text, flags=re.S), "not affine")
        self.refused("pieces", lambda text: text.replace("Some(Vertical)", "Some(Within((low: -1.0, high: -0.5)))"), "l₁ is")
        self.replaced("brusselator", "growing: Some(0)", "growing: Some(1)", "0 grow")
        self.replaced("harvest", "low: 0.404875148632", "low: 0.404875148633", "the parameter is")
        self.replaced("harvest", "unique: 0.00", "unique: 0.1", "more than a hundredth")

    def test_fields_and_system(self):
        for name, opening in [("harvest", it) for it in ("posed: (", "near: (", "statement: (", "beyond: Some((", "parameter: (", "Boundary(")] + [("brusselator", "Hopf(")]:
            self.replaced(name, opening, f"{opening} stable: true,", "is no field of it")
        self.replaced("harvest", "label: 3,", "label: 3, stable: true,", "is no field of it")
        self.replaced("harvest", '"eaten - d*y"', '"eaten - 2*d*y"', "refused")
        self.replaced("harvest", '"al - y"', '"al - 2*y"', "refused")
        self.refused("harvest", lambda text: text.replace('"0.15"', '"0.16"'), "refused")
        self.replaced("harvest", "kind: LP", "arc: Some(Proven), kind: LP", "arcs of equilibria")
        # the value of the parameter that varies, and one that is no text
        self.refused("harvest", lambda text: text.replace('"0.45",', '"0.44",').replace('"0.45"\n', '"0.44"\n'), "al is 0.45 in the problem")
        self.refused("harvest", lambda text: re.sub(r'"0.3",(\s*"0.42")', r"0.3,\1", text), "is no text in quotes")
        # one event twice
        def twice(text):
            point = re.search(r"\(\s*label: 3,.*?(?=\(\s*label: 4)", text, re.S)[0]
            return text.replace(point, point + point.replace("label: 3", "label: 33"))

        self.refused("harvest", twice, "it is that of label 3")
        # the table says more
        self.refused("harvest", lambda text: text.replace(",yes,", ",yes,stable"), "row of certificates.csv: refused", ("certificates.csv",))


if __name__ == "__main__":
    unittest.main()
