"""What check.py says of every point: its fields, its row of the table, the numbers of its problem.

check.py says what it is for.
"""

import re
from fractions import Fraction

from flint import acb, arb

from .ball_boxes import others, same_condition
from .ball_equilibria import evaluated
from .balls import Named, NotCovered, Number, Refused, Tagged, decimal, double, exact, must, whole

NUMBERS = "numbers of the problem"
"""The statement that needs no solution of the equations."""
WIDEST = 0.01
"""A distance of uniqueness is stated up to this share of the units."""
ROUNDINGS, CANCELLED = Fraction(1, 2**48), Fraction(1, 10**9)
"""How far a double may be from the value of an expression: by a few roundings, and where some digits cancel."""

SEARCHED = 6
"""Shares of a box, each half of the one before, from which another solution is searched for in it."""


NUMBER = re.compile(r"[-+]?(?:(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?|inf)")


def number(cell):
    """A cell of the table that is one number, and no ball or quotient."""
    must(isinstance(cell, str) and NUMBER.fullmatch(cell), f"{cell!r} is no number")
    return cell


def fields(record, needed, optional="", **enums):
    """Refuses a record with other fields than these, all of which but the optional ones it has. Those that are enums are read against
    their names."""
    must(isinstance(record, dict), "something else stands in the place of a record")
    needed, optional = needed.split(), optional.split()
    for name in needed:
        must(name in record, f"`{name}` is not there")
    for name in record:
        must(name in needed or name in optional, f"`{name}` is no field of it")
    for name, names in enums.items():
        if name in needed or record.get(name) is not None:
            variant(record[name], names)


def variant(value, names):
    """What stands in the place of an enum, as a name and what it holds. Refused is a name that is none of these, or that holds something
    of another kind."""
    name, held = value if isinstance(value, Tagged) else (value, None)
    must(isinstance(name, Named) and name in names, f"{name!r} is none of {', '.join(names)}")
    kind = names[name]
    must(isinstance(value, Tagged) == (kind is not None), f"{name} {'holds nothing' if kind is None else 'without what it holds'}")
    if kind is not None:
        kind(held)
    return name, held


# what a name of an enum may hold
def text(held):
    must(isinstance(held, str) and not isinstance(held, Named), f"{held!r} is no text in quotes")


def texts(count):
    def check(held):
        must(isinstance(held, tuple) and len(held) == count, f"there are not {count} numbers")
        for one in held:
            text(one)

    return check


def record(needed, **enums):
    return lambda held: fields(held, needed, **enums)


def something(held):
    """It is looked at where the statement is."""


def plain(names):
    """Names that hold nothing."""
    return dict.fromkeys(names.split())


OPEN = {"Open": text}
OUTCOMES, GROWTH, ARCS = {"Proven": something} | OPEN, {"Proven": something} | OPEN, {"Proven": None} | OPEN
TYPES = plain("EP MX UZ LP PD NS HB BP GR RV CO ST SL BE HC")
"""The names of every enum of a certificate: one that is none of them is no statement that is true and not treated here."""
WAVES = {
    "parameter": plain("Mismatch Friction MassDamping StiffnessDamping Gamma Nu Xi Smoothing"),
    "impact": plain("Frictionless Coulomb"),
    "origin": {"Geometry": texts(3), "Given": texts(5)},
    "regime": plain("Stick Slip Separation Reverse Contact"),
    "entry": plain("Release Arrest Reversal TakeOff Landing ArrestedLanding Section Touch"),
    "watch": plain("Duration Pressure LandingPressure Rate Tension LandingRate Impulse Gap LandingSpeed LowerForce UpperForce Release Coupling"),
    "verdict": {"Stable": record("beyond")} | plain("Unstable Neutral HighFrequency"),
}
WAVES["condition"] = {"Value": text, "Fold": None, "Crossing": record("sector omega"), "Margin": record("watch zone time", watch=WAVES["watch"])}
ORBITS = {"watch": plain("Duration Speed") | dict.fromkeys(("Onset", "Inside", "End", "Condition", "Before"), whole)}
ORBITS["condition"] = {"Value": text, "Torus": record("angle"), "Margin": record("watch zone time", watch=ORBITS["watch"])} | plain("Fold Doubling Branching")
EQUILIBRIA = {
    "condition": {"Value": text, "Fold": None, "Hopf": record("omega"), "Boundary": record("guard")},
    "lyapunov": {"Within": record("low high"), "Vertical": None},
}


def inside(ball, low, high):
    """Whether a ball lies between two numbers, taken as they are."""
    return bool(arb(low) <= ball and ball <= arb(high))


def between(ball, interval):
    """Whether a ball lies in an interval of doubles."""
    return inside(ball, double(interval["low"]), double(interval["high"]))


class Computed(Number):
    """The value of an expression: the shortest decimal that reads as the double next to it."""


def computed_in_order(given):
    """The parameters of a system, of which some may be expressions in those before them, as numbers."""
    numbers, balls = {}, {"pi": acb(arb.pi())}
    for name, told in given.items():
        if isinstance(told, str):
            ball = evaluated(told, balls).real
            must(ball.is_finite(), f"`{told}` is no number")
            told = Computed(repr(float(ball.mid())))
        double(told)
        numbers[name], balls[name] = told, decimal(told.text)
    return numbers


def is_written(number, told):
    """Whether a decimal is that of a number of the problem. How the program has rounded on the way to the value of an expression does
    not follow from the expression."""
    there = exact(number.text)
    apart = abs(there - exact(told))
    if not isinstance(number, Computed):
        return not apart
    if ROUNDINGS * abs(there) < apart <= CANCELLED * abs(there):
        raise NotCovered("the value of an expression that is known to fewer digits in doubles")
    return apart <= ROUNDINGS * abs(there)


def head_of(point, parameter=None):
    """That a point has the fields of one, whether it is proven or not. The parameter is one of an enum, or has a name of its own."""
    growth = {} if parameter is None else {"growth": GROWTH, "parameter": parameter}
    fields(point, "label kind parameter leg outcome", "arc growth" if growth else "arc", kind=TYPES, outcome=OUTCOMES, arc=ARCS, **growth)


def condition_of(proof):
    """Name of what singles out a point."""
    return proof["condition"] if isinstance(proof["condition"], str) else proof["condition"].name


class Statements:
    """A point that is said to be proven, with the problem and the row of the table that belong to it."""

    def __init__(self, point, source, row, before=None):
        self.point, self.source, self.row, self.before = point, source, row, before
        self.proof = point["outcome"].value
        self.posed, self.said = self.proof["posed"], self.proof["statement"]
        self.growth, self.discs, self.others = point.get("growth"), {}, {}
        # the equations of the point, once they have a zero that is proven
        self.solved = None

    def common(self):
        """Names of statements on all points and what checks them."""
        yield NUMBERS, self.numbers
        yield "type", self.type
        yield "inequalities", self.inequalities
        yield f"no other within {double(self.said['unique']):.0e}", self.unique
        yield "row of certificates.csv", self.table
        if self.point.get("arc") == "Proven":
            yield "arc", self.arc

    def first(self):
        """That no point before it is of the same event."""
        for other in self.earlier:
            same = other.solved is not None and other.point["kind"] == self.point["kind"] and self.is_event_of(other)
            must(not same, f"it is that of label {whole(other.point['label'])}")

    def head(self, parameter=None):
        """That what every point has, whatever it is of, is of its kind."""
        point = self.point
        head_of(point, parameter)
        whole(point["label"]), whole(point.get("leg", 0.0)), whole(self.said["inequalities"])

    def values_are_texts(self):
        """That a system has a value for every parameter, as it is written."""
        values = self.posed["values"]
        must(isinstance(values, list) and len(values) == len(self.posed["system"]["parameters"]), "there is not a value for every parameter")
        for value in values:
            text(value)

    def distance_is_one(self, unit):
        told = double(self.said["unique"])
        must(0 <= told <= unit * WIDEST * (1 + 1e-9), "a distance is negative, or more than a hundredth of the range of the parameter")

    @staticmethod
    def compare(found):
        for what, ball, interval in found:
            must(between(ball, interval), f"{what} is {ball.str(20, radius=False)}")

    def type(self):
        found = self.kind()
        must(found == self.point["kind"], f"what vanishes there makes it {found}")

    def alike(self, other):
        """Whether the solution at another point is one of the same equations, with the same event."""
        fixed = lambda it: it.posed | {"values": [y for k, y in enumerate(it.posed["values"]) if k != it.posed["parameter"]]}
        same = other.solved is not None and same_condition(self.proof["condition"], other.proof["condition"])
        return same and fixed(self) == fixed(other)

    def contains(self, told, solution):
        """Whether the whole of another solution lies in the box of a distance about the solution of the point."""
        return self.within(*self.of_zero(self.zero), *solution, arb(told) / arb(double(self.unit())))

    def alone(self):
        """That no proven point of the certificate is another solution in the box, nor this one in the box of a point before."""
        for other in [*(it for it in self.earlier if self.alike(it)), *([self] if self.alike(self) else [])]:
            for one, two in ((self, other), (other, self)):
                there = one.contains(double(one.said["unique"]), two.of_zero(two.zero))
                must(not there, f"the solution of label {whole(two.point['label'])} lies in the box of label {whole(one.point['label'])}, too")

    def unsettled(self, told, shown):
        """That none is found in the box of a distance where it is searched for, beyond the distance that is shown."""
        if not self.alike(self):
            return
        shares = [2.0**-k for k in range(SEARCHED) if told * 2.0**-k > shown]
        for zero in others(self.solved.equations, self.zero.middle, self.solved.radii(self.zero, told), shares):
            try:
                there = self.contains(told, self.of_zero(zero))
            except Refused:
                # it leads out of where the equations are known
                continue
            must(not there, "another solution lies in the box")

    def unique(self):
        told = distance = double(self.said["unique"])
        self.alone()
        if not told:
            # the zero is regular
            return
        for _ in range(2):
            norm = self.solved.unique(self.zero, distance)
            if norm < 1:
                break
            # about in proportion to the distance
            distance *= 0.7 / float(norm) if norm < 1e6 else 1e-3
        else:
            self.unsettled(told, distance)
            raise NotCovered("not shown over a box that large; the solution is regular")
        if distance < told:
            self.unsettled(told, distance)
            raise NotCovered(f"shown within {distance:.0e}; over a larger box balls overestimate the Jacobian")

    def arc(self):
        raise NotCovered("what lies between two points")

    @staticmethod
    def units_are(known):
        """Whether something tells the units. What is proven in others is as true, but not the same statement."""
        if not known:
            raise NotCovered("the units, for what the branch begins with is not proven first")

    def begins(self, section):
        """Whether the branch of a section of the problem begins with an earlier run, whose numbers do not stand in the problem."""
        if self.source is None:
            raise NotCovered("a certificate without its problem")
        must(isinstance(self.source.get(section), dict) and "continuation" in self.source, "the problem is about something else")
        start = self.source[section]["start"]
        return isinstance(start, Tagged) and start.name in ("Restart", "Switch")

    def asked(self, text, restarted=False):
        """That a value is one of the problem. With what value a branch begins that goes on from an earlier run does not stand there."""
        if restarted and self.point["kind"] != "UZ":
            return
        continuation = self.source["continuation"]
        ends = [number for number in (*continuation["range"], text) if number is not None]
        # pairs are values of monitors, and a value may have the name of the parameter
        bare = lambda it: it.get(continuation["parameter"]) if isinstance(it, dict) else it
        values = continuation.get("stop_at", []) if self.point["kind"] == "UZ" else ends
        asked = (it for it in map(bare, values) if isinstance(it, float))
        must(any(is_written(it, self.proof["condition"].value) for it in asked), "the value is not asked for in the problem")

    def of_system(self, unit, restarted):
        """That system, numbers and parameter are those of the problem, but for numbers of an earlier run. Returns the parameters as they
        are written there."""
        source, posed = self.source, self.posed
        written, system = dict(source["system"]), dict(posed["system"])
        given, held = written.pop("parameters", {}), system.pop("parameters")
        must(list(given) == list(held), "the parameters are not those of the problem")
        given = computed_in_order(given)
        for (name, number), value in zip(given.items(), posed["values"]):
            # that of the parameter that varies is in no equation, and is where the branch begins
            must(restarted or is_written(number, value), f"{name} is {number.text} in the problem")
        plain = lambda it: (
            {k: plain(v) for k, v in it.items() if v not in (None, [], {}, ())}
            if isinstance(it, dict)
            else [plain(v) for v in it]
            if isinstance(it, (list, tuple))
            else it
        )
        elements = [f"z_{name}" for name, law in written.get("contacts", {}).items() if law.name == "Jenkins"]
        written["states"] = [*written["states"], *(name for name in elements if name not in written["states"])]
        must(plain(written) == plain(system), "the system is not that of the problem")
        continuation = source["continuation"]
        must(continuation["parameter"] == self.point["parameter"], "the parameter is not that of the problem")
        low, high = continuation["range"]
        must(unit == high - low, "the unit of the parameter is not the width of its range")
        return given

    def compare_row(self, name, intervals, **stated):
        """That the row of the table is of this point, with these balls in their intervals, and says this."""
        if self.row is None:
            raise NotCovered("a certificate without its table")
        row, point, arc = self.row, self.point, self.point.get("arc")
        named = [str(whole(point["label"])), point["kind"], name, "yes"]
        must([row[it] for it in ("label", "type", "parameter", "proven")] == named, "it is of another point")
        for what, (low, high), ball in intervals:
            must(inside(ball, number(row[low]), number(row[high])), f"the {what} is not in its interval")
        must(float(number(row["unique"])) == double(self.said["unique"]), "`unique` is not that of the certificate")
        opened = isinstance(arc, Tagged)
        stated |= {"inequalities": self.said["inequalities"], "arc": "" if arc is None else "no" if opened else "yes"}
        stated |= {"why": "", "arc_why": arc.value if opened else ""}
        for column, value in stated.items():
            told = value if isinstance(value, str) else "" if value is None else str(whole(value))
            must(row[column] == told, f"`{column}` is not that of the certificate")
