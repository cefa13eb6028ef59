"""An independent check of what `brakewave certify` proves.

    python -m brakewave.check results/mode4_mismatch

It takes nothing from the program but the statements and, as a first guess, the waves in doubles. It poses the
equations of docs/theory.md again from the decimals of the problem, solves them in balls of Arb (python-flint) and
prints a line for every statement: `proven again`, `refused: reason` or `not covered: reason`. Exit code: 0, 1 if a
statement is refused, 2 if the certificate cannot be read. docs/certify.md says what is covered, and how.
"""

import csv
import re
import sys
from collections import namedtuple
from fractions import Fraction
from pathlib import Path

try:
    from flint import acb, acb_mat, arb, ctx

    from .ball_layers import Layered, LayeredSigns
    from .ball_orbits import Orbit, join, kind_of, listed, outside, zones_of
    from .ball_spectrum import Perturbed
    from .ball_waves import Signs
    from .balls import NotCovered, Refused, decimal, must, prove_zero
except ImportError as error:
    sys.exit(f"{error}: `pip install python-flint` gives the balls that this check needs")

COUNTING = 96
"""Bits in which eigenvalues are counted: their number is whole."""

# ---------------------------------------------------------------------------------------------------- RON
Tagged = namedtuple("Tagged", "name value")
"""A name of an enum and what it holds."""
BLANK = r"\s*(?:(?://[^\n]*|/\*.*?\*/)\s*)*"
TOKEN = re.compile(
    BLANK + r'(?:(?P<string>"(?:[^"\\]|\\.)*")|(?P<number>[-+]?(?:\d|\.\d)[\d._]*(?:[eE][-+]?\d+)?)'
    r"|(?P<name>[A-Za-z_]\w*)|(?P<mark>[()\[\]{}:,])|(?P<end>\Z))",
    re.S,
)
CLOSING = {"(": ")", "[": "]", "{": "}"}


class Number(float):
    """A double with the text that it was read from."""

    def __new__(cls, text):
        self = super().__new__(cls, text)
        self.text = text
        return self


def read_ron(text):
    """The value of a RON text: dict, tuple, list, str, Number, bool, None or Tagged."""
    tokens, place = [], 0
    while not tokens or tokens[-1][0] != "end":
        found = TOKEN.match(text, place)
        if not found:
            raise ValueError(f"no RON at character {place}")
        tokens.append((found.lastgroup, found[found.lastgroup]))
        place = found.end()
    tokens.reverse()

    def sequence(opening):
        """What follows a bracket: a dict where names or keys stand, else a list or a tuple."""
        items, pairs, close = [], [], CLOSING[opening]
        while tokens[-1][1] != close:
            item = value()
            if tokens[-1][1] == ":" and opening != "[":
                tokens.pop()
                pairs.append((item, value()))
            else:
                items.append(item)
            if tokens[-1][1] == ",":
                tokens.pop()
            elif tokens[-1][1] != close:
                raise ValueError(f"found {tokens[-1][1]!r}, not `,` or `{close}`")
        tokens.pop()
        if opening == "{" or pairs:
            if items or len(dict(pairs)) != len(pairs):
                raise ValueError("a field is there twice, or has no name")
            return dict(pairs)
        return items if opening == "[" else tuple(items)

    def value():
        kind, token = tokens.pop()
        if kind == "string":
            return re.sub(r"\\(.)", r"\1", token[1:-1])
        if kind == "number":
            return Number(token.replace("_", ""))
        if token in CLOSING:
            return sequence(token)
        if kind != "name":
            raise ValueError(f"found {token!r}, not a value")
        if tokens[-1][1] != "(":
            return {"true": True, "false": False, "None": None}.get(token, token)
        tokens.pop()
        held = sequence("(")
        if isinstance(held, tuple) and len(held) == 1:
            held = held[0]
        return held if token == "Some" else Tagged(token, held)

    result = value()
    if tokens[-1][0] != "end":
        raise ValueError("more than one value")
    return result


# ------------------------------------------------------------------------------------------------ statements
def inside(ball, low, high):
    """Whether a ball lies between two numbers, taken as they are."""
    return bool(arb(low) <= ball and ball <= arb(high))


def between(ball, interval):
    """Whether a ball lies in an interval of doubles."""
    return inside(ball, float(interval["low"]), float(interval["high"]))


def type_of(wave, said):
    """Type of a point by what singles it out."""
    if wave.kind == "Value":
        return said if said in ("UZ", "EP") else "UZ or EP"
    if wave.kind != "Margin":
        return "LP" if wave.kind == "Fold" else "HB" if float(wave.condition.value["omega"]) else "BP"
    regime, entry = wave.zones[wave.zone]
    after = wave.zones[(wave.zone + 1) % wave.count][0]
    if wave.watch == "Duration":
        if regime == "Reverse" and after == "Stick" and entry in ("Reversal", "ArrestedLanding"):
            return "RV"
        return "ST" if regime == "Stick" else "GR" if entry == "TakeOff" else "CO"
    return {"Pressure": "GR", "LowerForce": "RV", "UpperForce": "ST", "Rate": "ST"}.get(wave.watch, "CO")


def snake(name):
    """MassDamping as mass_damping."""
    return re.sub(r"(?<!^)(?=[A-Z])", "_", name).lower()


class Statements:
    """A point that is said to be proven, with the problem and the row of the table that belong to it."""

    def __init__(self, point, source, row, before=None):
        self.point, self.source, self.row, self.before = point, source, row, before
        self.proof = point["outcome"].value
        self.posed, self.said = self.proof["posed"], self.proof["statement"]
        self.growth, self.discs = point.get("growth"), {}

    def common(self):
        """Names of statements on all points and what checks them."""
        yield "numbers of the problem", self.numbers
        yield "type", self.type
        yield "inequalities", self.inequalities
        yield f"no other within {float(self.said['unique']):.0e}", self.unique
        yield "row of certificates.csv", self.table
        if self.point.get("arc") is not None and self.point["arc"].name == "Proven":
            yield "arc", self.arc

    @staticmethod
    def compare(found):
        for what, ball, interval in found:
            must(between(ball, interval), f"{what} is {ball.str(20, radius=False)}")

    def type(self):
        found = self.kind()
        must(found == self.point["kind"], f"what vanishes there makes it {found}")

    def unique(self):
        distance = self.said["unique"]
        for _ in range(2):
            norm = self.solved.unique(self.zero, distance)
            if norm < 1:
                break
            # about in proportion to the distance
            distance *= 0.7 / float(norm) if norm < 1e6 else 1e-3
        else:
            raise NotCovered("not shown over a box that large; the solution is regular")
        if distance < self.said["unique"]:
            raise NotCovered(f"shown within {distance:.0e}; over a larger box balls overestimate the Jacobian")

    def arc(self):
        raise NotCovered("what lies between two points")

    def asked(self, text):
        """That a value is one of the problem."""
        continuation = self.source["continuation"]
        ends = [number for number in (*continuation["range"], text) if number is not None]
        values = continuation.get("stop_at", []) if self.point["kind"] == "UZ" else ends
        listed = Fraction(self.proof["condition"].value) in [Fraction(value.text) for value in values]
        must(listed or "stop_after" in continuation, "the value is not asked for in the problem")

    def compare_row(self, name, intervals, **stated):
        """That the row of the table is of this point, with these balls in their intervals, and says this."""
        if self.row is None:
            raise NotCovered("a certificate without its table")
        row, point, arc = self.row, self.point, self.point.get("arc")
        named = [str(int(point["label"])), point["kind"], name, "yes"]
        must([row[it] for it in ("label", "type", "parameter", "proven")] == named, "it is of another point")
        for what, (low, high), ball in intervals:
            must(inside(ball, row[low], row[high]), f"the {what} is not in its interval")
        must(float(row["unique"]) == self.said["unique"], "`unique` is not that of the certificate")
        stated |= {"inequalities": self.said["inequalities"], "arc": "" if arc is None else {"Proven": "yes"}.get(arc.name, "no")}
        for column, value in stated.items():
            told = value if isinstance(value, str) else "" if value is None else str(int(value))
            must(row[column] == told, f"`{column}` is not that of the certificate")


class Point(Statements):
    """A point of a branch of waves."""

    def statements(self):
        """Names of the statements and what checks them."""
        yield "wave, in its intervals", self.wave
        yield from self.common()
        if self.proof["beyond"] is not None:
            yield "the same wave beyond", self.beyond
        for eigenvalue in self.proof.get("eigenvalues", []):
            yield f"eigenvalue in sector {int(eigenvalue['sector'])}", lambda it=eigenvalue: self.eigenvalue(it)
        if self.growth is not None and self.growth.name == "Proven":
            yield "growing eigenvalues", self.counts
            for leading in self.growth.value["leading"]:
                yield f"leading eigenvalue of sector {int(leading['sector'])}", lambda it=leading: self.leads(it)
            yield "stability", self.verdict

    def posing(self, of):
        """The equations of the point itself, or of it as the wave beyond."""
        layered = self.posed["written"].get("material") is not None
        return (Layered if layered else Perturbed)(self.posed, of["near"], of["condition"])

    def wave(self):
        wave = self.posing(self.proof)
        must(wave.posed["parameter"] == self.point["parameter"], "its equations vary another parameter")
        self.zero = prove_zero(wave.equations, wave.guess)
        self.x = wave.enclosed(self.zero)
        self.parts = wave.parts(self.x)
        lengths = [(t * self.parts.c * wave.sign).real for _, _, t in self.parts.zones]
        found = [("the parameter", self.x[wave.base - 1].real, self.said["parameter"])]
        found += [("the speed", self.parts.c.real, self.said["speed"])]
        must(len(lengths) == len(self.said["lengths"]), "there are not as many lengths as zones")
        found += [("the length of a zone", *both) for both in zip(lengths, self.said["lengths"])]
        if wave.kind == "Crossing":
            found += [("ω", self.x[wave.base].real, self.said["omega"])]
        self.compare(found)
        self.solved = wave

    def numbers(self):
        source, posed, written = self.source, self.posed, self.posed["written"]
        if source is None or "model" not in source or isinstance(source["wave"]["start"], Tagged):
            raise NotCovered("numbers that do not stand in a problem file: a tube in SI units, a restart")
        model, given = source["model"], {}
        law, damping = model.get("friction_law", "Coulomb"), model.get("damping", {})
        origin = model["coefficients"]
        must(origin.name == written["origin"].name, "the coefficients are given otherwise")
        names = {"Geometry": ["nu", "xi", "gamma"], "Given": ["a", "b", "D", "g", "h"]}[origin.name]
        text = lambda number: number.text if isinstance(number, Number) else "0"
        problem = {name: text(origin.value[name]) for name in names}
        problem |= {"friction": text(model["friction"]), "mismatch": text(model["mismatch"])}
        problem |= {"mass_damping": text(damping.get("mass")), "stiffness_damping": text(damping.get("stiffness"))}
        numbers = *written["origin"].value, written["friction"], written["mismatch"], written["damping"]
        numbers += (written.get("material") or "0",)
        given = dict(zip(problem, numbers))
        continuation, varies = source["continuation"], snake(posed["parameter"])
        for name, number in problem.items():
            # the branch from a Hopf point begins at a value that is computed
            computed = name == varies and source["wave"]["start"] == "Hopf"
            must(computed or Fraction(number) == Fraction(given[name]), f"{name} is {number} in the problem")
        must(law == "Coulomb" or law.name == "Static", "another law of friction in the problem")
        ratio = None if law == "Coulomb" else law.value["ratio"]
        ratios = [Fraction(text or 1) for text in (ratio and ratio.text, written["ratio"])]
        must(ratios[0] == ratios[1], "static friction is not that of the problem")
        must(model.get("impact", "Frictionless") == posed["impact"], "impacts are not those of the problem")
        must(int(source["wave"]["mode"]) == int(posed["mode"]), "the mode is not that of the problem")
        must(continuation["parameter"] == posed["parameter"], "the parameter is not that of the problem")
        low, high = continuation["range"]
        must(float(posed["unit"]) == high - low, "the unit of the parameter is not the width of its range")
        if self.point["kind"] in ("UZ", "EP") and self.solved.kind == "Value":
            self.asked(Number(problem[varies]) if varies in problem else None)

    def kind(self):
        return type_of(self.solved, self.point["kind"])

    def inequalities(self):
        signs = LayeredSigns if isinstance(self.solved, Layered) else Signs
        for what, holds in signs(self.solved, self.x).all():
            must(holds, f"{what} is not shown")

    def beyond(self):
        beyond = self.posing(self.proof["beyond"])
        x = beyond.enclosed(prove_zero(beyond.equations, beyond.guess))
        parts, shares = beyond.parts(x), (x[beyond.base - 1], self.x[self.solved.base - 1])
        must(shares[0].overlaps(shares[1]) and parts.c.overlaps(self.parts.c), "it is another wave")
        must(type_of(beyond, self.point["kind"]) == self.point["kind"], "it is an event of another type")

    def unique(self):
        if self.solved.kind == "Fold":
            raise NotCovered("the distance to other folds; the fold is regular")
        super().unique()

    def table(self):
        grows = any(it["growth"]["low"] > 0 for it in self.proof.get("eigenvalues", []))
        stable = growing = ""
        if self.growth is not None and self.growth.name == "Proven":
            verdict, mode = self.growth.value["verdict"], int(self.posed["mode"])
            name = verdict.name if isinstance(verdict, Tagged) else verdict
            stable = {"Stable": "yes", "Unstable": "no"}.get(name, "")
            # a sector between 0 and k/2 counts for its conjugate too
            counts = enumerate(self.growth.value["counts"])
            growing = str(sum(int(count) * (1 if 2 * sector in (0, mode) else 2) for sector, count in counts))
        self.compare_row(
            snake(self.point["parameter"]),
            [
                ("parameter", ("low", "high"), self.x[self.solved.base - 1].real),
                ("speed", ("speed_low", "speed_high"), self.parts.c.real),
            ],
            unstable="yes" if grows else "", stable=stable, growing=growing,
        )  # fmt: skip

    def eigenvalue(self, said):
        ball = self.solved.eigenvalue(self.parts, said["sector"], said["near"])
        holds = between(ball.real, said["growth"]) and between(ball.imag, said["omega"])
        must(holds, f"it is {ball.str(15, radius=False)}")

    def counts(self):
        growth, mode, crossing = self.growth.value, int(self.posed["mode"]), self.solved.kind == "Crossing"
        sectors, window = range(mode // 2 + 1), float(growth["window"])
        must(
            int(growth["mode"]) == mode and len(growth["counts"]) == len(sectors), "there are not as many as sectors"
        )
        known = [int(sector == 0) for sector in sectors]
        if crossing:
            sector = int(self.solved.condition.value["sector"])
            known[sector] += 2 if 2 * sector in (0, mode) else 1
        known[0] += self.solved.swings(self.parts, window)
        with ctx.workprec(COUNTING):
            found = self.solved.growing(self.parts, sectors, window, known, self.discs)
        must(found == [int(count) for count in growth["counts"]], f"they are {found}")
        if self.source is not None and "max_frequency" in (self.source.get("stability") or {}):
            asked = self.source["stability"]["max_frequency"]
            must(asked == window, "the window is not that of the problem")
        self.found = found

    def leads(self, said):
        sector, line, mode = int(said["sector"]), float(said["line"]), int(self.posed["mode"])
        window = float(self.growth.value["window"])
        near = [it["near"] for it in self.proof.get("eigenvalues", []) if it["sector"] == sector]
        must(len(near) == 1, "no eigenvalue of this sector is enclosed")
        ball = self.solved.eigenvalue(self.parts, sector, near[0])
        must(sector or not ball.contains(0), "it is the translation mode")
        must(ball.real > line, "the eigenvalue is left of the line")
        paired = 2 * sector in (0, mode) and not ball.imag.contains(0)
        expected = 1 + int(paired) + int(sector == 0 and line < 0)
        with ctx.workprec(COUNTING):
            (found,) = self.solved.right_of(self.parts, [sector], window, line, self.discs)
        must(found == expected, f"{found} eigenvalues are right of the line, not {expected}")

    def verdict(self):
        verdict = self.growth.value["verdict"]
        found = getattr(self, "found", None)
        if found is None:
            raise NotCovered("stability without a count")
        at_rest = "Neutral" if self.solved.kind == "Crossing" else "HighFrequency"
        follows = "Unstable" if any(found) else at_rest
        if isinstance(verdict, Tagged) and verdict.name == "Stable" and follows == "HighFrequency":
            raise NotCovered("eigenvalues of high frequency")
        must(verdict == follows, f"what is counted makes it {follows}")


class OrbitPoint(Statements):
    """A point of a branch of orbits of a system."""

    def arc(self):
        before = self.before
        must(before is not None and hasattr(before, "x"), "the point before it is not shown")
        must(before.point.get("leg") == self.point.get("leg"), "the branch does not lead from the point before to this")
        join(*zip(before.seen("after"), self.seen("before")))

    def seen(self, side):
        """The orbit in the sequence before a change or after it, where it may be proven in the other, with its data."""
        proof, changed = self.proof, self.proof.get("changed")
        sequence = changed[side] if changed else proof["near"]["sequence"]
        must(sequence is not None, "nothing is known beyond an event")
        there = (it for it in (proof, *proof.get("seen", [])) if listed(it["near"]["sequence"]) == listed(sequence))
        seen = next(there, None)
        must(seen, "its ends have not one sequence of zones")
        if seen is proof:
            return (self.solved, self.x), proof["near"]
        orbit, _, x, *found = self.solve(seen)
        self.signs(orbit, x)
        must(all(a.overlaps(b) for a, b in zip(found, (self.value, self.period))), "beyond its event is another orbit")
        return (orbit, x), seen["near"]

    def statements(self):
        """Names of the statements and what checks them."""
        yield "orbit, in its intervals", self.orbit
        yield from self.common()
        if self.said.get("outside") is not None:
            yield "multipliers outside the unit circle", self.outside

    def orbit(self):
        names = list(self.posed["system"]["parameters"])
        must(names[int(self.posed["parameter"])] == self.point["parameter"], "its equations vary another parameter")
        orbit, self.zero, self.x, self.value, self.period = self.solve(self.proof)
        self.solved = orbit
        found = [("the parameter", self.value, self.said["parameter"]), ("the period", self.period, self.said["period"])]
        if orbit.kind == "Torus":
            self.angle = self.x[orbit.place + 1].real
            found.append(("the angle", self.angle, self.said["angle"]))
        self.compare(found)

    def solve(self, of):
        """The equations of the orbit in a sequence, their zero with its unknowns, the parameter and the period."""
        orbit = Orbit(self.posed, of["near"], of["condition"])
        middle, radius = zero = prove_zero(orbit.equations, orbit.guess)
        # real equations and a real guess: the zero is real
        x = [acb(arb(y.real, radius)) for y in middle]
        times = [x[k * (orbit.n + 1) + orbit.n].real for k in range(len(orbit.stretches))]
        value = decimal(orbit.condition.value).real if orbit.kind == "Value" else x[orbit.place].real
        return orbit, zero, x, value, (1 + orbit.half) * sum(times, arb(0))

    def numbers(self):
        source, posed = self.source, self.posed
        if source is None or "system" not in source or "Restart" in str(source["orbit"]["start"]):
            raise NotCovered("numbers that do not stand in a problem file")
        written, system = dict(source["system"]), dict(posed["system"])
        given, held = written.pop("parameters", {}), system.pop("parameters")
        must(list(given) == list(held), "the parameters are not those of the problem")
        for (name, number), value, inner in zip(given.items(), posed["values"], held.values()):
            varies = name == self.point["parameter"]
            must(Fraction(number.text) == Fraction(value) or varies, f"{name} is {number.text} in the problem")
            must(float(inner) == float(value) or varies, f"{name} is there with two values")
        plain = lambda it: (
            {k: plain(v) for k, v in it.items() if v not in (None, [], {}, ())}
            if isinstance(it, dict)
            else [plain(v) for v in it]
            if isinstance(it, (list, tuple))
            else it
        )
        must(plain(written) == plain(system), "the system is not that of the problem")
        continuation = source["continuation"]
        must(continuation["parameter"] == self.point["parameter"], "the parameter is not that of the problem")
        low, high = continuation["range"]
        must(float(posed["units"]["parameter"]) == high - low, "the unit of the parameter is not the width of its range")
        if self.solved.kind == "Value":
            self.asked(given[self.point["parameter"]])

    def kind(self):
        names, changed = self.solved.exact.names, self.proof.get("changed") or {}
        for sequence in filter(None, (changed.get("before"), changed.get("after"))):
            fits = all(0 <= mode < len(names) and zone["name"] == names[mode] for zone, mode in ((zone, int(zone["mode"])) for zone in zones_of(sequence)))
            must(fits, "a mode has another name")
        return kind_of(self.point, self.proof)

    def inequalities(self):
        self.signs(*self.solved.whole(self.proof["near"], self.x))

    @staticmethod
    def signs(orbit, x):
        wrong = [what for what, holds in orbit.all_signs(x, orbit.closed) if not holds]
        if wrong and orbit.mirror(x):
            wrong = [what for what, holds in orbit.all_signs(x, orbit.closed) if not holds]
        must(not wrong, f"{', '.join(wrong)} is not shown")

    def outside(self):
        orbit = self.solved
        must(orbit.kind == "Value", "multipliers are counted at values of the parameter")
        found = outside(acb_mat(orbit.returned(*orbit.parts(self.x))).charpoly().coeffs())
        must(found == int(self.said["outside"]), f"{found} are outside")

    def table(self):
        intervals = [("parameter", ("low", "high"), self.value), ("period", ("period_low", "period_high"), self.period)]
        if self.solved.kind == "Torus":
            intervals.append(("angle", ("angle_low", "angle_high"), self.angle))
        self.compare_row(self.point["parameter"], intervals, outside=self.said.get("outside"))


def main(folder):
    """Prints a line for every statement of a certificate. Returns the exit code."""
    folder = Path(folder)
    path = folder / "certificate.ron" if folder.is_dir() else folder
    name = path
    try:
        points = read_ron(path.read_text(encoding="utf-8"))["points"]
        source, table = path.with_name("source.ron"), path.with_name("certificates.csv")
        source = read_ron(source.read_text(encoding="utf-8")) if source.is_file() else None
        rows = list(csv.DictReader(table.read_text(encoding="utf-8").splitlines())) if table.is_file() else None
        refused = 0
        labels = [int(point["label"]) for point in points]
        listed = list(map(str, labels)) if rows is None else [row["label"] for row in rows]
        if labels != sorted(set(labels)) or listed != list(map(str, labels)):
            print("labels: refused: they do not ascend as those of the table do")
            refused += 1
        by_label = None if rows is None else {int(row["label"]): row for row in rows}
        before = None
        for point in points:
            name = f"{int(point['label']):4} {point['kind']}"
            row = by_label and by_label.get(int(point["label"]))
            if point["outcome"].name != "Proven":
                if row is not None and row["proven"] != "no":
                    print(f"{name} row of certificates.csv: refused: it is not proven in the certificate")
                    refused += 1
                before = None
                continue
            of_system = "system" in point["outcome"].value["posed"]
            before = (OrbitPoint if of_system else Point)(point, source, row, before)
            for what, statement in before.statements():
                try:
                    statement()
                    outcome = "proven again"
                except NotCovered as reason:
                    outcome = f"not covered: {reason}"
                except Refused as reason:
                    outcome = f"refused: {reason}"
                    refused += 1
                print(f"{name} {what}: {outcome}", flush=True)
                if what.startswith(("wave", "orbit")) and outcome != "proven again":
                    break
    except (OSError, ValueError, LookupError, TypeError, AttributeError, ArithmeticError, RecursionError) as error:
        print(f"{name}: cannot be read: {error!r}", file=sys.stderr)
        return 2
    return 1 if refused else 0


def command(arguments):
    """What a command line ends with."""
    return main(arguments[1]) if len(arguments) == 2 else __doc__


if __name__ == "__main__":
    sys.exit(command(sys.argv))
