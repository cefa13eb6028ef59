"""Tests of brakewave.ball_orbits against certificates of systems that the binary writes, as they are and forged.

    BRAKEWAVE=target/release/brakewave python3 python/test_check_orbits.py

Where the binary or python-flint is not there the tests are skipped, and say so (see test_check.py).
"""

import re
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

from test_check import BINARY, Certified, check

try:
    from flint import acb, acb_mat, acb_poly, arb, fmpq_poly

    from brakewave.ball_orbits import Form, Ratio, Zeros, counted, evaluate, outside
    from brakewave.balls import Dual, NotCovered, Refused, determinant
    from brakewave.check import Tagged, read_ron
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
FREQUENCY = (Path(__file__).resolve().parent.parent / "problems/friction_oscillator.ron").read_text(encoding="utf-8")
"""An end, the onset of stick, a value, an end."""
TWICE = SYSTEM.replace("toward: Down", "toward: Down, stop_at: [0.099971]")
"""The same with a value just above the fold, where it is met on either side of it, and beyond the graze."""
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
NAMED = SYSTEM.replace('(zero: "d - x", ', '(zero: "d - x", name: "hit", ')
"""The same where the impact has a name."""
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
BESIDE = SYSTEM.replace('["x", "v"]', '["x", "v", "q"]').replace('"v": "A*cos(phase) - c*v - x"', '"v": "A*cos(phase) - c*v - x", "q": "0"')
BESIDE = BESIDE.replace('{"v": "-e*v"}', '{"v": "-e*v", "q": "0"}').replace('"v": -0.08}', '"v": -0.08, "q": 0.0}').replace("(0.05, 0.12)", "(0.11, 0.12)")
"""Two ends, and a state beside them that is zero after every impact, and so for ever."""
POLE = """(
    system: (
        states: ["a", "b"], parameters: {"p": 0.8},
        modes: {"m": (rates: {"a": "1", "b": "-1"}, until: [
            (zero: "(p - 1)*a + b", to: "m", reset: {"a": "0", "b": "2"}, if: ["b", "a"]),
            (zero: "(p - 1)*a + b", to: "m", reset: {"a": "0", "b": "2"}),
        ])},
    ),
    orbit: (start: Given(mode: "m", state: {"a": 0.0, "b": 2.0}, period: 1.6667)),
    continuation: (parameter: "p", range: (0.5, 1.3), toward: Up), stability: (),
)"""
"""An end, and where b at the switch, 2(1 - p)/(2 - p), is zero: the guard is b itself there, and a is 2."""
DIP = """(
    system: (
        states: ["t", "y", "z"], parameters: {"p": 1.0},
        modes: {"run": (rates: {"t": "1", "y": "z", "z": "2"},
            until: [(zero: "1 + p - t", to: "run", reset: {"t": "0", "y": "1.8 + 0.05*p", "z": "-2.7"})])},
    ),
    orbit: (start: Given(mode: "run", state: {"t": 0.0, "y": 1.85, "z": -2.7}, period: 2.0)),
    continuation: (parameter: "p", range: (0.0, 1.0), toward: Down), stability: (),
)"""
"""A clock beside a parabola, whose least value from p = 0.35 on, 1.8 + 0.05p - 1.8225, is negative up to p = 0.45."""
DOUBLED = SYSTEM.replace('"A": 0.12, "w": 1.0', '"A": 0.6, "w": 0.8').replace('"v": -0.08}, phase: 1.03', '"v": -0.5}, phase: 0.0')
DOUBLED = DOUBLED.replace("(0.05, 0.12)", "(0.5, 0.6)")
"""An end, a doubling at 0.518, an end."""
MARK = """(
    system: (
        states: ["x", "v"], parameters: {"w": 0.7, "F": 0.62, "z": 0.06}, forcing: "w",
        define: {"rest": "cos(phase) - 2*z*v - x"},
        modes: {
            "f1": (rates: {"x": "v", "v": "rest - F"}, until: [(zero: "v", to: "b2"), (zero: "-x", to: "f2")]),
            "f2": (rates: {"x": "v", "v": "rest - F"}, until: [(zero: "v", to: "b1")]),
            "b1": (rates: {"x": "v", "v": "rest + F"}, until: [(zero: "-v", to: "f2"), (zero: "x", to: "b2")]),
            "b2": (rates: {"x": "v", "v": "rest + F"}, until: [(zero: "-v", to: "f1")]),
        },
        sliding: {"sp": ("f2", "b1"), "sm": ("f1", "b2")},
    ),
    orbit: (start: Simulate(mode: "f1", state: {"x": -1.0, "v": 0.5}, settle: 200)),
    continuation: (parameter: "w", range: (0.695, 0.7), toward: Down), stability: (),
)"""
"""An end, the onset of stick at 0.698, an end; the modes change at x = 0 too."""
SHIFT = 1 + 1e-12
MAPS = "parameters define modes sliding rates reset".split()
OPTIONS = "system forcing way after changed angle outside arc".split()
WORDS = "kind condition watch arc".split()


def ron(value, name=""):
    """A value as RON, where it stands in the field of a name."""
    if isinstance(value, dict):
        pairs = [f'"{key}": {ron(it)}' if name in MAPS else f"{key}: {ron(it, key)}" for key, it in value.items()]
        text = f"{{{', '.join(pairs)}}}" if name in MAPS else f"({', '.join(pairs)})"
    elif isinstance(value, Tagged):
        inner = re.sub(r"Some\((.*?)\)", r"\1", ron(value.value)) if value.name == "Torus" else ron(value.value)
        # the fields of a variant stand in its own brackets
        text = value.name + (inner if value.name in ("Margin", "Torus") else f"({inner})")
    elif isinstance(value, str):
        text = value if name in WORDS else '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
    elif isinstance(value, (list, tuple)):
        items = ", ".join(ron(it) for it in value)
        text = f"[{items}]" if isinstance(value, list) else f"({items})"
    elif isinstance(value, (int, float)) and not isinstance(value, bool):
        text = getattr(value, "text", None) or (str(int(value)) if abs(value) < 1e15 and value == int(value) else repr(value))
    else:
        text = str(value).lower() if value is not None else "None"
    return f"Some({text})" if name in OPTIONS and value is not None else text


class Expressions(unittest.TestCase):
    """What is read and evaluated, against numbers by hand."""

    def value(self, text, phase=0.0):
        names = {"p": Form.number(3), "lambda": Form.number(2), "phase": Form(phase=1)}
        waves = evaluate(text, names, []).waves
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
        zeros = Zeros(arb(3, 0.5), [[p, Ratio(1), 0], [0, p - 1, Ratio(2)]])
        self.assertTrue(zeros.have([p * p - p, 0, Ratio(-2)]))
        self.assertFalse(zeros.have([p * p - p, 0, Ratio(2)]))

    def test_no_pivot_that_may_vanish(self):
        # (p - 1)x + y = 0 says that x = -y/(p - 1), but not at p = 1
        p = Ratio(fmpq_poly([0, 1]))
        row, wanted = [p - 1, Ratio(1), 0], [Ratio(1), 1 / (p - 1), 0]
        for middle, expected in [(3, True), (1, False)]:
            zeros = Zeros(arb(middle, 0.5), [row, [0, p - 1, 0], [0, Ratio(1), 0]])
            self.assertEqual(zeros.have([Ratio(1), 0, 0]), expected)
            self.assertEqual(Zeros(arb(middle, 0.5), [row]).have(wanted), True)
        divisors = []
        evaluate("(a^2 - 1)/(a - 1)", {"a": Form.number(p)}, divisors)
        self.assertEqual([it.clear(arb(1, 0.1)) for it in divisors], [False])

    def test_text(self):
        for text, expected in [
            ("/* /* */ 0.1 // */ 0.2", 0.2), ("// 1\n2", 2), (r'"\x63\n\u{e9}"', "c\nH".replace("H", "é")), ('r#"a"b"#', 'a"b'),
            ("(a: /**/ 1_000, b: [inf, -inf])", {"a": 1000, "b": [float("inf"), -float("inf")]}),
        ]:  # fmt: skip
            self.assertEqual(read_ron(text), expected)
        for text in ["/* /* */ 1", r'"\q"', "(a: 1, a: 2)", "1 2"]:
            with self.assertRaises(ValueError, msg=text):
                read_ron(text)

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
            counted(acb_mat([[0, 1], [-1, 0]]).charpoly().coeffs())
        # the product of two is 1
        self.assertEqual(counted([acb(1), acb(-2.5), acb(1)]), 1)


@unittest.skipUnless(BINARY, "no binary of brakewave")
class Certificates(Certified):
    """Certificates as they are written hold; forged ones are refused by the checker and by `certify --verify`."""

    PROBLEMS = {
        "impact": SYSTEM, "named": NAMED, "pair": PAIR, "friction": FRICTION, "threshold": THRESHOLD, "loss": LOSS, "graze": SYSTEM,
        "beside": BESIDE, "pole": POLE, "dip": DIP, "doubled": DOUBLED, "mark": MARK, "twice": TWICE,
        "frequency": FREQUENCY, "chua": CHUA,
    }  # fmt: skip
    OPTIONS = {"graze": ["--arcs"], "dip": ["--arcs"]}

    def test_honest(self):
        for name, points, counts in [("impact", 4, 2), ("named", 4, 2), ("pair", 3, 2), ("friction", 4, 3), ("loss", 2, 1)]:
            code, told = check(self.folders[name])
            self.assertEqual(code, 3 if "not covered" in told else 0, told)
            self.assertNotIn("refused", told)
            for what in ["orbit, in its intervals", "numbers of the problem", "type", "inequalities", "row of"]:
                self.assertEqual(len(re.findall(f"{what}.*: proven again", told)), points, told)
            self.assertEqual(told.count("multipliers outside the unit circle: proven again"), counts, told)
            # as far as the certificate says, at folds, doublings and pairs too
            self.assertEqual(len(re.findall("no other within .*: proven again", told)), points, told)

    def refused(self, name, statement, change, files=("certificate.ron",), verify=True):
        """That what a function makes of texts is refused: by the checker for a statement, and by the program."""
        self.refused_by_both(name, change, statement, files, verify)

    def meant(self, name, statement, change, why, source=lambda text: text, table=lambda text: text):
        """That a certificate that a function changes is refused by both for the reason meant: names and values of fields."""
        # its words are those of another certificate
        forged = self.copied(name, "meant", ignore=shutil.ignore_patterns("theorem.md"))
        read = lambda file: (forged / file).read_text(encoding="utf-8")
        certificate = read_ron(read("certificate.ron"))
        change(certificate, [it["outcome"].value for it in certificate["points"]])
        (forged / "certificate.ron").write_text(ron(certificate), encoding="utf-8")
        for file, edit in ("source.ron", source), ("certificates.csv", table):
            (forged / file).write_text(edit(read(file)), encoding="utf-8")
        code, told = check(forged)
        self.assertEqual(code, 1 if statement else 0, told)
        self.assertRegex(told, statement or "proven again")
        told = self.program("certify", "--verify", "meant", code=1 if why else 0)
        self.assertRegex(told, why or "verified")

    def test_boxes_that_have_another_orbit(self):
        def wide(label, told):
            return lambda text: re.sub(rf"(label: {label},.*?unique: )[^,]*", rf"\g<1>{told}", text, count=1, flags=re.S)

        # two proven orbits of one value of the parameter, the one in the box of the other; seen at either of them
        self.refused("twice", "label 2 lies in the box of label 4, too", wide(4, 5e-4))
        self.refused("twice", "label 4 lies in the box of label 2, too", wide(2, 5e-4))
        # where the other is not told it is found
        self.refused("twice", "another solution lies in the box", wide(2, 5e-4))

        # the orbit of label 6 does without the impact, and is none of the same equations: what is shown holds beside it
        self.assertEqual(check(self.folders["twice"])[0], 0)

    def test_boxes_where_the_frequency_varies(self):
        """Where a parameter is the frequency of the forcing it is in every flow, and phases gain by all durations."""
        code, told = check(self.folders["frequency"])
        self.assertEqual((code, len(re.findall("no other within [^\n]*: proven again", told))), (0, 4), told)

    def test_boxes_of_a_doubling(self):
        told = check(self.folders["chua"])[1]
        self.assertRegex(told, "PD no other within [^\n]*: proven again")

    def test_values(self):
        """The value of a parameter is told in quotes, as in the problem, and so is that of the one that varies."""

        def other(_, proofs):
            proofs[0]["posed"]["values"][1] = "0.2"

        self.meant("impact", "A is 0.12 in the problem", other, "a number is not that of the problem file")
        for bare in "0.1", "None":
            code, told = check(self.edited("impact", lambda text, bare=bare: re.sub(r'(values: \[\s*)"0.1"', rf"\g<1>{bare}", text, count=1)))
            self.assertEqual(code, 1, told)
            self.assertIn("is no text in quotes", told)

    def test_the_first_zone_may_be_any(self):
        def later(_, proofs):
            near = proofs[0]["near"]
            near["zones"] = near["zones"][1:] + near["zones"][:1]
            near["sequence"] = (near["sequence"][0][1:] + near["sequence"][0][:1],)

        self.meant("friction", "", later, "")

    def test_a_box_without_a_size(self):
        """A distance of zero says no more than that the orbit is regular."""
        self.meant("twice", "", lambda _, proofs: proofs[1]["statement"].update(unique=0.0), "", table=self.no_distance)

    @staticmethod
    def no_distance(table):
        header, *rows = table.splitlines()
        place, cells = header.split(",").index("unique"), rows[1].split(",")
        rows[1] = ",".join([*cells[:place], "0.0", *cells[place + 1 :]])
        return "\n".join([header, *rows, ""])

    def test_as_it_is(self):
        # written by another hand it holds; and a certificate that says less than is proven
        self.meant("beside", "", lambda *_: None, "")

        def less(_, proofs):
            proofs[0]["statement"].pop("outside")

        self.meant("beside", "", less, "", table=lambda text: re.sub(r"(,yes,,)\d", r"\1", text, count=1))

    def test_a_pair_at_minus_one(self):
        def pair(certificate, proofs):
            certificate["points"][1]["kind"] = "NS"
            proofs[1]["condition"] = Tagged("Torus", {"angle": 3.141592653589793})
            proofs[1]["statement"]["angle"] = {"low": 3.14159, "high": 3.1416}

        ends = lambda text: re.sub(",PD,(.*?),,,,,,", r",NS,\1,,,3.14,3.15,,", text)
        self.meant("doubled", "the angle of a pair lies between 0 and π", pair, "not known to lie between 0 and π", table=ends)

    def test_switches_beside_the_one_taken(self):
        # zero at the same instants, with another impact; zero for ever
        for guard, reset, checked, why in [
            ("d - x + q", {"v": "-0.3*v", "q": "0"}, "that guard 1, zero at the end", "which is zero at the end of zone 0 too"),
            ("2*(d - x)", {"v": "-0.3*v", "q": "0"}, "that guard 1, zero at the end", "which is zero at the end of zone 0 too|guard 1 of zone 0"),
            ("q", {"v": "0"}, "guard 1, zero all along", "which is zero all along"),
        ]:
            switch = {"zero": guard, "to": "free", "reset": reset}
            text = "until: [" + ron([switch])[1:-1]

            def more(certificate, _):
                certificate["system"]["modes"]["free"]["until"].append(switch)

            problem = lambda old: old.replace('"q": "0"})]', '"q": "0"}), ' + text[8:] + "]")
            with self.subTest(guard=guard):
                self.meant("beside", checked, more, why, source=problem)

        # one that leads on alike does no harm
        switch = {"zero": "d - x + q", "to": "free", "reset": {"v": "-e*v + q", "q": "0"}}

        def alike(certificate, proofs):
            certificate["system"]["modes"]["free"]["until"].append(switch)
            for proof in proofs:
                proof["statement"]["inequalities"] += 2

        count = lambda text: re.sub(r",(\d),yes", lambda it: f",{int(it[1]) + 2},yes", text)
        problem = lambda old: old.replace('"q": "0"})]', '"q": "0"}), ' + ron([switch])[1:-1] + "]")
        self.meant("beside", "", alike, "", source=problem, table=count)

    def test_types_do_not_follow_from_what_is_invented(self):
        for name, kind, watch in [("impact", "SL", Tagged("Condition", 0)), ("impact", "CO", Tagged("Onset", 0)), ("friction", "CO", Tagged("End", 0))]:

            def thrice(certificate, proofs):
                at, proof = next((at, it) for at, it in zip(certificate["points"], proofs) if it.get("changed"))
                at["kind"], changed = kind, proof["changed"]
                changed["before"] = (changed["before"][0] * 3,)
                changed["watch"], changed["after"] = watch, proof["near"]["sequence"]

            table = lambda text: re.sub(",(GR|SL),", f",{kind},", text)
            with self.subTest(name=name, kind=kind):
                self.meant(name, "type: refused", thrice, "its type is|the change of the sequence", table=table)

    def test_an_exit_before_that_always_holds(self):
        # far from the zone of no duration f1 would leave for b1 at x = 0, whatever the condition is written as
        only = lambda text: "".join(line for line in text.splitlines(True) if line.startswith("label") or ",SL," in line)
        for condition in ["-x", "0", "x - x"]:

            def before(certificate, _):
                certificate["points"] = [it for it in certificate["points"] if it["kind"] == "SL"]
                proof = certificate["points"][0]["outcome"].value
                (seen,), near, changed = proof["seen"], proof["near"], proof["changed"]
                other = {"near": near, "condition": proof["condition"]}
                proof |= {"near": seen["near"], "condition": seen["condition"], "seen": [other]}
                margin = seen["condition"].value
                changed |= {"before": seen["near"]["sequence"], "after": near["sequence"], "watch": margin["watch"], "zone": margin["zone"]}
                certificate["system"]["modes"]["f1"]["until"].insert(1, {"zero": "-x", "to": "b1", "if": [condition]})
                for sequence in changed["before"], changed["after"]:
                    for zone in sequence[0]:
                        if zone["name"] == "f1" and zone["way"]["guard"] == 1:
                            zone["way"]["exit"] = 1

            source = lambda text: text.replace('(zero: "-x", to: "f2")', f'(zero: "-x", to: "b1", if: ["{condition}"]), (zero: "-x", to: "f2")')
            with self.subTest(condition=condition):
                self.meant("mark", "inequalities: refused: that exit 0 is not taken", before, "that exit 0 is not taken", source=source, table=only)

    def test_an_event_stated_twice(self):
        for name, kind in ("impact", "LP"), ("impact", "GR"), ("friction", "SL"):
            rows = []

            def again(certificate, _):
                points = certificate["points"]
                rows[:] = [[point["kind"] for point in points].index(kind), str(int(points[-1]["label"]) + 1)]
                points.append(points[rows[0]] | {"label": int(rows[1])})

            def table(text):
                row = text.splitlines()[1 + rows[0]]
                return text + rows[1] + row[row.index(",") :] + "\n"

            self.meant(name, "traversed once: refused: it is that of label", again, "not an earlier point", table=table)

    def test_an_orbit_traversed_twice(self):
        def twice(certificate, proofs):
            del certificate["points"][1:]
            near, said = proofs[0]["near"], proofs[0]["statement"]
            proofs[0]["posed"]["periods"] = 2
            proofs[0]["posed"]["units"]["time"] *= 2
            near["sequence"] = (near["sequence"][0] * 2,)
            turn = {"phase": near["zones"][0]["phase"] + 6.283185307179586}
            near["zones"] += [near["zones"][0] | turn]
            said["period"] = {end: 2 * value for end, value in said["period"].items()}
            said["inequalities"] *= 2

        def table(text):
            header, row = (line.split(",") for line in text.splitlines()[:2])
            for column in "period_low", "period_high", "inequalities":
                place = header.index(column)
                row[place] = repr(2 * float(row[place])) if "period" in column else str(2 * int(row[place]))
            return ",".join(header) + "\n" + ",".join(row) + "\n"

        source = lambda text: text.replace("phase: 1.03)", "phase: 1.03), periods: 2")
        self.meant("beside", "traversed once: refused", twice, "traversed several times", source=source, table=table)

    def test_no_division_by_what_vanishes(self):
        # at p = 1 the orbit goes on by an exit one of whose conditions, -a, is -2
        def condition(certificate, _):
            certificate["system"]["modes"]["m"]["until"][0]["if"][1] = "-a"
            certificate["points"] = [it for it in certificate["points"] if it["kind"] == "SL"]

        rows = lambda text: "".join(line for line in text.splitlines(True) if line.startswith("label") or ",SL," in line)
        source = lambda text: text.replace('["b", "a"]', '["b", "-a"]')
        # in the sequence beyond, what keeps that exit from being taken is -a, which does not vanish
        self.meant("pole", "condition 1 at the end of zone 0", condition, "no box is known to have exactly one solution", source=source, table=rows)

    def test_a_guard_that_dips_on_the_way(self):
        switch = {"zero": "y", "to": "run", "reset": {}}

        def more(certificate, proofs):
            certificate["system"]["modes"]["run"]["until"].append({k: v for k, v in switch.items() if v})
            for proof in proofs:
                proof["statement"]["inequalities"] += 1

        problem = lambda text: text.replace('"z": "-2.7"})]', '"z": "-2.7"}), (zero: "y", to: "run")]')
        count = lambda text: re.sub(r",(\d),yes", lambda it: f",{int(it[1]) + 1},yes", text)
        self.meant("dip", "EP arc: refused", more, "the arc before it", source=problem, table=count)

    def test_indices_and_fields(self):
        for what, change in {
            "guard": lambda proof: proof["near"]["sequence"][0][0]["way"].update(guard=-1),
            "exit": lambda proof: proof["near"]["sequence"][0][0]["way"].update(exit=-1),
            "mode": lambda proof: proof["near"]["sequence"][0][0].update(mode=-1),
            "unknown": lambda proof: proof["statement"].update(chaotic=True),
            "angle": lambda proof: proof["statement"].update(angle={"low": 1.0, "high": 1.1}),
            "distance": lambda proof: proof["statement"].update(unique=-0.001),
            "far": lambda proof: proof["statement"].update(unique=1e300),
            "count": lambda proof: proof["statement"].update(inequalities=99),
        }.items():
            forged = self.copied("beside")
            path = forged / "certificate.ron"
            certificate = read_ron(path.read_text(encoding="utf-8"))
            change(certificate["points"][0]["outcome"].value)
            path.write_text(ron(certificate), encoding="utf-8")
            with self.subTest(what=what):
                code, told = check(forged)
                self.assertEqual(code, 1, told)
                run = subprocess.run([BINARY, "certify", "--verify", forged], capture_output=True, text=True)
                self.assertNotEqual(run.returncode, 0)

    def test_the_table_and_the_problem(self):
        for what, file, old, new in [
            ("why", "certificates.csv", ",yes,,", ",yes,stable for all A,"),
            ("angle", "certificates.csv", ",0,,,,\n", ",0,1.0,1.1,,\n"),
            ("proven", "certificates.csv", ",yes,", ",no,"),
            ("interval", "certificates.csv", "1.1999999999999998e-1", "1.2000000000000000e-1"),
            ("comment", "source.ron", '"c": 0.1', '"c": /* /* */ 0.1, // */ 0.2'),
            ("value", "source.ron", '"c": 0.1', '"c": 0.10000000000000001'),
            ("mode", "source.ron", "-e*v", "-e*v/2"),
            ("range", "source.ron", "(0.11, 0.12)", "(0.1, 0.12)"),
        ]:
            forged = self.copied("beside")
            text = (forged / file).read_text(encoding="utf-8")
            self.assertIn(old, text, what)
            (forged / file).write_text(text.replace(old, new, 1), encoding="utf-8")
            with self.subTest(what=what):
                code, told = check(forged)
                self.assertEqual(code, 1, told)
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

    def test_names_of_switches(self):
        label = 'label: Some("hit"),'
        self.refused("named", "orbit", lambda text: text.replace(label, 'label: Some("miss"),', 1))
        self.refused("named", "orbit", lambda text: text.replace(label, "", 1))
        # of the sequence before the graze
        before = lambda text: re.sub(f'(before: .*?){re.escape(label)}', r'\1label: Some("miss"),', text, count=1, flags=re.S)
        self.refused("named", "type", before)
        # an impact without a name has no label
        self.refused("impact", "orbit", lambda text: text.replace('name: "free",', f'name: "free", {label}', 1))

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
