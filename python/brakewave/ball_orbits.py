"""Orbits of systems of one's own in balls of Arb (python-flint): their equations, zeros of them that are proven, signs.

Written from docs/systems.md, apart from the program. check.py says what it is for. An orbit is a cycle of
stretches: its zones, one of which is cut where a guard touches zero inside. Unknowns are the states at the entry of
every stretch, its duration, the phase of the first entry and the parameter. One matrix exponential leads through a
stretch. Multipliers are the eigenvalues of the linearised return to the first entry, in states and phase.
"""

import ast
import re
from collections import namedtuple
from copy import copy
from fractions import Fraction
from functools import reduce
from math import inf

from flint import acb, acb_mat, acb_poly, arb, arb_poly, ctx, fmpq, fmpq_poly

from .ball_contacts import Contacts
from .balls import SIGNS, Dual, NotCovered, Refused, Tagged, apply, as_matrix, bare, bent, decimal, distance, double, dual, exact, exponential, injective, lesser, must, parted, positive, prove_zero, real, second, tail, times, value_of, whole

NEAR = 1e-6
"""What is zero at a point is found for all values of the parameter so near, in its unit."""
ALMOST = 2.0**-54
"""A step in units of an unknown that is as good as none."""
SHUT = 1e-9
"""A zone that lasts no longer than this share of the unit of time may have no duration."""
FINER = ((1, 4), (4, 8))
"""Into how many parts the range of the parameter and into how many cells those of durations are divided where uniqueness is shown."""
TURNED = 40
"""Boxes of growing width that are tried about the solution of linear equations."""


# ---------------------------------------------------------------------------------------------------- expressions
class Ratio:
    """A quotient of polynomials in the parameter, with rational coefficients: it is zero or not."""

    def __init__(self, over, under=1):
        over, under = (fmpq_poly([it]) if isinstance(it, (int, fmpq)) else it for it in (over, under))
        must(under != 0, "a division by zero")
        common = over.gcd(under)
        self.over, self.under, self.balls, self.slope = over // common, under // common, None, None

    def __add__(self, other):
        other = ratio(other)
        return Ratio(self.over * other.under + other.over * self.under, self.under * other.under)

    def __mul__(self, other):
        other = ratio(other)
        return Ratio(self.over * other.over, self.under * other.under)

    def __truediv__(self, other):
        other = ratio(other)
        return Ratio(self.over * other.under, self.under * other.over)

    __radd__, __rmul__ = __add__, __mul__
    __neg__ = lambda self: Ratio(-self.over, self.under)
    __sub__ = lambda self, other: self + -ratio(other)
    __rsub__ = lambda self, other: ratio(other) - self
    __rtruediv__ = lambda self, other: ratio(other) / self
    __bool__ = lambda self: self.over != 0

    def __pow__(self, n):
        power = Ratio(1)
        for _ in range(abs(n)):
            power = power * self
        return power if n >= 0 else 1 / power

    def whole(self):
        """The whole number that it is, or None."""
        number = self.over[0] / self.under[0] if self.over.degree() <= 0 and self.under.degree() == 0 else None
        return int(number.p) if number is not None and number.q == 1 else None

    def clear(self, domain):
        """Whether it is not zero over an interval of the parameter."""
        over, under = (acb_poly(it)(acb(domain)) for it in (self.over, self.under))
        return not over.contains(0) and not under.contains(0)

    def rate(self):
        """Its derivative."""
        if self.slope is None:
            over, under = self.over, self.under
            self.slope = Ratio(over.derivative() * under - over * under.derivative(), under * under)
        return self.slope

    def at(self, parameter):
        """Its value at a number, with the derivative where that has one and it has one too."""
        if self.balls is None or self.balls[0] != ctx.prec:
            flat, polynomials = self.over.degree() <= 0 and self.under.degree() <= 0, [arb_poly(it) for it in (self.over, self.under)]
            whole = self.whole() if flat else None
            constant = None if not flat else polynomials[0][0] / polynomials[1][0] if whole is None else whole
            self.balls = ctx.prec, constant, *polynomials, *(it.derivative() for it in polynomials)
        _, constant, over, under, rise, fall = self.balls
        if constant is not None:
            return constant
        x = parameter.v if isinstance(parameter, Dual) else parameter
        if isinstance(x, Dual):
            return Dual(self.at(x), self.rate().at(x) * parameter.d)
        if under.degree() == 0:
            value, slope = over(x) / under[0], lambda: rise(x) / under[0]
        else:
            value = over(x) / under(x)
            slope = lambda: (rise(x) - value * fall(x)) / under(x)
        return Dual(value, slope() * parameter.d) if isinstance(parameter, Dual) else value


def ratio(number):
    """A number as a quotient."""
    if isinstance(number, (str, Fraction)):
        number = exact(number) if isinstance(number, str) else number
        return Ratio(fmpq(number.numerator, number.denominator))
    return number if isinstance(number, Ratio) else Ratio(number)


FUNCTIONS = {
    "sin": (0, lambda x, y, of: of("cos", x)),
    "cos": (1, lambda x, y, of: -of("sin", x)),
    "tan": (0, lambda x, y, of: 1 + y * y),
    "exp": (1, lambda x, y, of: y),
    "ln": (None, lambda x, y, of: 1 / x),
    "sqrt": (0, lambda x, y, of: 1 / (2 * y)),
    "abs": (0, None),
    "tanh": (0, lambda x, y, of: 1 - y * y),
    "asin": (0, lambda x, y, of: 1 / of("sqrt", 1 - x * x)),
    "acos": (None, lambda x, y, of: -1 / of("sqrt", 1 - x * x)),
    "atan": (0, lambda x, y, of: 1 / (1 + x * x)),
    "sinh": (0, lambda x, y, of: of("cosh", x)),
    "cosh": (1, lambda x, y, of: of("sinh", x)),
}
"""What f is at zero where that is a whole number, and f'(x), where f(x) is y."""


def function(name, x):
    """A function of a quotient, where that is one as well."""
    must(name in FUNCTIONS, f"`{name}` is no function")
    at_zero, _ = FUNCTIONS[name]
    if x or at_zero is None:
        raise NotCovered(f"coefficients with {name}")
    return Ratio(at_zero)


class Form:
    """Σ aᵢxᵢ + c + Σ (cₕ cos hφ + sₕ sin hφ), and a multiple of φ on its way into cos and sin."""

    def __init__(self, states=None, waves=None, phase=0):
        self.states, self.waves, self.phase = states or {}, waves or {}, phase

    @staticmethod
    def number(x):
        return Form(waves={(0, 0): ratio(x)})

    def over(self, change):
        apply = lambda terms: {key: change(value) for key, value in terms.items()}
        return Form(apply(self.states), apply(self.waves), self.phase)

    def __add__(self, other):
        join = lambda a, b: {key: a.get(key, 0) + b.get(key, 0) for key in {**a, **b}}
        return Form(join(self.states, other.states), join(self.waves, other.waves), self.phase + other.phase)

    def __neg__(self):
        form = self.over(lambda value: -value)
        return Form(form.states, form.waves, -form.phase)

    def __sub__(self, other):
        return self + -other

    def __truediv__(self, other):
        value = other.constant()
        must(value is not None, "a division by what moves")
        return self * Form.number(1 / value)

    def __pow__(self, other):
        base, exponent = self.constant(), other.constant()
        n = None if exponent is None else exponent.whole()
        must(exponent is not None and (base is not None or n is not None and n >= 0), "a power of what moves")
        if n is None:
            raise NotCovered("coefficients with powers that are not whole")
        if base is not None:
            return Form.number(base**n)
        power = Form.number(1)
        for _ in range(n):
            power = power * self
        return power

    def constant(self):
        """Its value where it has no state and no phase, else None."""
        plain = not self.states and not self.phase and set(self.waves) <= {(0, 0)}
        return ratio(self.waves.get((0, 0), 0)) if plain else None

    def __mul__(self, other):
        one, two = self.constant(), other.constant()
        if one is None and two is None:
            must(not (self.states or other.states or self.phase or other.phase), "a product of what moves")
            return self.mixed(other)
        form, factor = (self, two) if two is not None else (other, one)
        result = form.over(lambda value: value * factor)
        if form.phase:
            must(factor.whole() is not None, "the phase times what is no whole number")
            result.phase = form.phase * factor.whole()
        return result

    def mixed(self, other):
        """cos m cos n = (cos(m − n) + cos(m + n))/2, and so on; (h, 0) is cos hφ, (h, 1) is sin hφ."""
        result = Form()
        for (m, one), a in self.waves.items():
            for (n, two), b in other.waves.items():
                half, gap = a * b / 2, m - n
                if one == two:
                    terms = [((abs(gap), 0), half), ((m + n, 0), half if not one else -half)]
                else:
                    # sin m cos n = (sin(m + n) + sin(m − n))/2
                    turn = gap if one else -gap
                    terms = [((m + n, 1), half), ((abs(turn), 1), half if turn > 0 else -half)]
                for key, value in terms:
                    if key != (0, 1):
                        result = result + Form(waves={key: value})
        return result


OPERATORS = {
    ast.Add: Form.__add__, ast.Sub: Form.__sub__, ast.Mult: Form.__mul__, ast.Div: Form.__truediv__,
    ast.Pow: Form.__pow__, ast.USub: Form.__neg__, ast.UAdd: lambda form: form,
}  # fmt: skip


def parsed(text):
    """The tree of an expression, with the text that it was made from: its names begin with a sign. Operators bind as in Python, `^` as
    `**` there."""
    # the sign keeps those that are words of Python
    spelled = re.sub(r"(?<![\w.])(?=[^\W\d])", "_", " ".join(text.split())).replace("^", "**")
    try:
        return spelled, ast.parse(spelled, mode="eval").body
    except (SyntaxError, ValueError, MemoryError):
        raise Refused(f"`{text}` cannot be read") from None


def evaluate(text, names, divisors):
    """The form of an expression, where names stand for forms; what it divides by joins the divisors."""
    spelled, tree = parsed(text)

    def form(node):
        if isinstance(node, ast.Constant) and type(node.value) in (int, float):
            return Form.number(ast.get_source_segment(spelled, node).replace("_", ""))
        if isinstance(node, ast.Name):
            must(node.id[1:] in names, f"`{node.id[1:]}` stands for nothing that is covered")
            return names[node.id[1:]]
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and len(node.args) == 1 and not node.keywords:
            name, inner = node.func.id[1:], form(node.args[0])
            plain = Form(inner.states, inner.waves).constant()
            must(plain is not None, "a function of what moves")
            if not inner.phase:
                return Form.number(function(name, plain))
            must(name in ("sin", "cos"), "the phase outside of sin and cos")
            m, cosine, sine = inner.phase, function("cos", plain), function("sin", plain)
            first, second = (cosine, -sine) if name == "cos" else (sine, cosine)
            return Form(waves={(abs(m), 0): first, (abs(m), 1): second if m > 0 else -second})
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id[1:] in ("min", "max"):
            raise NotCovered("coefficients with min and max")
        parts = [node.left, node.right] if isinstance(node, ast.BinOp) else [getattr(node, "operand", None)]
        operator = OPERATORS.get(type(getattr(node, "op", None)))
        must(operator, f"`{text}` cannot be read")
        parts = [form(part) for part in parts]
        result = operator(*parts)
        inverse = operator is Form.__pow__ and not (parts[1].constant().whole() or 0) >= 0
        if operator is Form.__truediv__ or inverse:
            divisors.append(parts[0 if inverse else 1].constant())
        return result

    return form(tree)


# ---------------------------------------------------------------------------------------------------- systems
def zero(x):
    """Whether a coefficient is zero."""
    return not x


def combine(row, matrix):
    """Σ aᵢ·row i of a matrix."""
    return [sum((a * line[j] for a, line in zip(row, matrix) if a), 0) for j in range(len(matrix[0]))]


class Modes:
    """The modes of a system: ż = Mz, z = (x, 1, cos φ, sin φ, …), with guards, exits and resets as forms of z. Of those that contacts
    make these are the ones of some numbers, next to a value of the parameter."""

    def __init__(self, posed, near=0.0, numbers=()):
        system, given = posed["system"], list(posed["system"]["parameters"])
        self.made, contacts = (posed, near), system.get("contacts", {})
        parameter, self.divisors, self.signs = whole(posed["parameter"], len(given)), [], []
        must(len(given) == len(posed["values"]), "there is not a value for every parameter")
        names = {name: Form.number(text) for name, text in zip(given, posed["values"])}
        names[given[parameter]] = Form.number(Ratio(fmpq_poly([0, 1])))
        self.states, forced = list(system["states"]), system.get("forcing")
        n = self.count = len(self.states)
        self.omega = evaluate(forced, names, self.divisors).constant() if forced else ratio(0)
        must(self.omega is not None, "a frequency that moves")
        names |= {name: Form(states={index: Ratio(1)}) for index, name in enumerate(self.states)}
        names |= {"phase": Form(phase=1)} if forced else {}
        names |= {name: Form(states={n + index: Ratio(1)}) for index, name in enumerate(contacts)}
        form = lambda text: evaluate(text, names, self.divisors)
        for name, text in system.get("define", {}).items():
            names[name] = form(text)
        self.names, elements = list(system.get("modes", {})), {f"z_{name}" for name, law in contacts.items() if law.name == "Jenkins"}
        written = [
            (
                # that of a Jenkins element is in its law
                [form("0" if state in elements else mode["rates"][state]) for state in self.states],
                [
                    (
                        form(switch["zero"]),
                        self.names.index(switch["to"]),
                        {self.states.index(name): form(text) for name, text in switch.get("reset", {}).items()},
                        [form(text) for text in switch.get("if", [])],
                        switch.get("name"),
                    )
                    for switch in mode.get("until", [])
                ],
            )
            for mode in system.get("modes", {}).values() or [{"rates": system["rates"]}]
        ]
        if contacts:
            of = Contacts(system, form, written, (n, self.omega, near), self.divisors, self.signs)
            self.names = of.modes
            must(all(number < len(self.names) for number in numbers), "a mode that there is not")
            written = {number: of.mode(number) for number in sorted({*numbers})}
        else:
            written = {number: (rates, [(*it, None) for it in switches]) for number, (rates, switches) in enumerate(written)}
        every = [it for rates, _ in written.values() for it in rates]
        every += [it for _, switches in written.values() for zero, _, reset, held, *_ in switches for it in [zero, *reset.values(), *held]]
        must(not any(it.phase for it in every), "the phase outside of sin and cos")
        self.harmonics = max((h for it in every for h, _ in it.waves), default=0)
        self.size = n + 1 + 2 * self.harmonics
        self.matrices, self.guards, self.surfaces = {}, {}, {}
        for number, (rates, switches) in written.items():
            rows = [self.row(rate) for rate in rates] + [[0] * self.size for _ in range(n, self.size)]
            for h in range(1, self.harmonics + 1):
                cosine = n + 2 * h - 1
                rows[cosine][cosine + 1], rows[cosine + 1][cosine] = -h * self.omega, h * self.omega
            guards = []
            for form, to, reset, held, name, group in switches:
                row, new = self.row(form), [self.row(reset[i]) if i in reset else self.unit(i) for i in range(n)]
                # switches of one form are exits of one guard, but for those of contacts
                same = (exits for known, exits in guards if group is None and not any(x - y for x, y in zip(known, row)))
                exits = next(same, guards[group][1] if group is not None and group < len(guards) else None)
                if exits is None:
                    exits = []
                    guards.append((row, exits))
                exits.append((to, new, [self.row(it) for it in held], name))
            self.matrices[number], self.guards[number], self.surfaces[number] = rows, guards, None
        for sides in system.get("sliding", {}).values():
            self.slide(*(self.names.index(side) for side in sides))
        self.names = self.names if contacts else self.names + list(system.get("sliding", {}))

    def unit(self, index):
        return [int(index == j) for j in range(self.size)]

    def row(self, form):
        row = [form.states.get(i, 0) for i in range(self.count)] + [form.waves.get((0, 0), 0)]
        for h in range(1, self.harmonics + 1):
            row += [form.waves.get((h, 0), 0), form.waves.get((h, 1), 0)]
        return row

    def slide(self, first, second):
        """The sliding mode F₋ − d (n·F₋)/(n·d) of two modes, F₊ − F₋ keeping the direction d."""
        leads = lambda side, to: [k for k, (_, exits) in enumerate(self.guards[side]) if any(it[0] == to for it in exits)]
        ways = leads(first, second), leads(second, first)
        must([len(way) for way in ways] == [1, 1], "two modes do not meet in one surface")
        (one,), (other,) = ways
        (normal, out), (opposite, back) = self.guards[first][one], self.guards[second][other]
        must(not any(a + b for a, b in zip(normal, opposite)), "two modes do not meet in one surface")
        below, above = self.matrices[first], self.matrices[second]
        gaps = [[b - a for a, b in zip(low, high)] for low, high in zip(below, above)][: self.count]
        pivot = next((gap for gap in gaps if any(gap)), None)
        must(pivot, "two modes between which nothing slides are the same")
        j = next(j for j, x in enumerate(pivot) if x)
        parallel = not any(x * pivot[j] - gap[j] * y for gap in gaps for x, y in zip(gap, pivot))
        must(parallel, "the difference of two fields changes its direction")
        along = [ratio(gap[j]) / pivot[j] if gap[j] else 0 for gap in gaps]
        toward, away = combine(normal, below), combine(normal, above)
        across = sum((a * d for a, d in zip(normal, along)), ratio(0))
        self.divisors.append(across * pivot[j])
        rows = [[x - t * d / across for x, t in zip(line, toward)] for line, d in zip(below, along)]
        self.matrices[len(self.matrices)] = rows + below[self.count :]
        stay, own, ends = [self.unit(i) for i in range(self.count)], len(self.guards), [-x for x in toward]
        # the other guards of both modes end sliding, too: they have to be positive, and what follows is not covered
        multiple = lambda row: not any(x * b - a * y for x, a in zip(row, normal) for y, b in zip(row, normal))
        watched = []
        for row, _ in self.guards[first] + self.guards[second]:
            if not multiple(row) and not any(not any(x - y for x, y in zip(row, known)) for known in watched):
                watched.append(row)
        own_conditions = [(ends, [(first, stay, [], None)]), (away, [(second, stay, [], None)])]
        self.guards[own], self.surfaces[own] = own_conditions + [(row, []) for row in watched], normal
        out.insert(0, (own, stay, [away], None))
        back.insert(0, (own, stay, [ends], None))

    def including(self, numbers):
        """The same with modes of these numbers, too."""
        return self if isinstance(self.names, list) else Modes(*self.made, [*self.matrices, *numbers])

    def check_zone(self, zone):
        """That a zone has the name of its mode, and the label of the switch that ends it: the name of that, where a mode of the same name goes
        on."""
        mode, way = whole(zone["mode"], len(self.names)), zone["way"]
        must(zone["name"] == self.names[mode], "a mode has another name")
        guards = self.guards[mode][whole(way["guard"]) :][:1] if way else []
        exits = [it for _, exits in guards for it in exits[whole(way["exit"]) :][:1]]
        label = next((name for to, *_, name in exits if self.names[to] == self.names[mode]), None)
        must(zone.get("label") == label, "a switch has another name")

    def derivative(self, mode, row, order):
        for _ in range(order):
            row = combine(row, self.matrices[mode])
        return row

    def at(self, parameter):
        """The modes in numbers, at a value of the parameter: each when it is asked for."""
        there = copy(self)
        # a common factor may hide that something is divided by zero
        value = bare(parameter)
        must(all(ratio(it).clear(value) for it in self.divisors), "a division by what may be zero")
        for number, strict in self.signs:
            sign = real(ratio(number).at(acb(value)))
            must(sign > 0 if strict else sign >= 0, "a bound or the influence of a force may be negative")
        number = lambda x: x.at(parameter) if isinstance(x, Ratio) else x
        there.row_of = lambda row: [number(x) for x in row]
        rows = lambda lines: [there.row_of(line) for line in lines]
        exits = lambda ways: [(to, rows(reset), rows(held), name) for to, reset, held, name in ways]
        there.omega, there.matrices = number(self.omega), Later(lambda mode: rows(self.matrices[mode]))
        there.guards = Later(lambda mode: [(there.row_of(row), exits(ways)) for row, ways in self.guards[mode]])
        return there


class Later(dict):
    """Values that are computed when they are asked for."""

    def __init__(self, make):
        self.make = make

    def __missing__(self, key):
        self[key] = self.make(key)
        return self[key]


class Zeros:
    """Forms of z over the quotients that are zero together: in echelon form, pivot and row, where a pivot is known not to be zero
    over an interval of the parameter, and others."""

    def __init__(self, domain, rows=()):
        self.domain, self.solved, self.others = domain, [], []
        for row in rows:
            self.insert(row)

    def rows(self):
        return [row for _, row in self.solved] + self.others

    def rest(self, row):
        for pivot, known in self.solved:
            factor = row[pivot]
            if factor:
                row = [x - factor * y for x, y in zip(row, known)]
        return row

    def have(self, row):
        rest = self.rest(row)
        return not any(rest) or any(not any(x - sign * y for x, y in zip(rest, other)) for other in self.others for sign in (1, -1))

    def insert(self, row):
        row = self.rest(row)
        if self.have(row):
            return
        pivot = next((j for j, x in enumerate(row) if x and ratio(x).clear(self.domain)), None)
        if pivot is None:
            self.others.append(row)
            return
        row = [ratio(x) / row[pivot] if x else 0 for x in row]
        self.solved = [(k, [x - known[pivot] * y for x, y in zip(known, row)]) for k, known in self.solved]
        self.solved.append((pivot, row))
        again, self.others = self.others, []
        for other in again:
            self.insert(other)

    def along(self, matrix, surface):
        """Those that stay zero along a flow, row by row."""
        kept = self.rows()
        if surface is not None and self.have(surface):
            kept.append(surface)
        while True:
            known = Zeros(self.domain, kept)
            fewer = [row for row in kept if row is surface or known.have(combine(row, matrix))]
            if len(fewer) == len(kept):
                return known
            kept = fewer

    def after(self, reset, size):
        """Those that are zero after a reset."""
        unit = lambda j: [int(j == k) for k in range(size)]
        every = list(reset) + [unit(j) for j in range(len(reset), size)]
        new = [[a - b for a, b in zip(unit(i), row)] for i, row in enumerate(reset)]
        both = self.rows() + new
        return Zeros(self.domain, (row for row in both if self.have(combine(row, every))))


# ---------------------------------------------------------------------------------------------------- orbits
Stretch = namedtuple("Stretch", "zone mode end")
"""A zone, or a part of one: `end` is ("exit", guard, exit), ("touch", guard), ("cut",) before another part or ("never",)."""


def counted(polynomial):
    """How many zeros of a polynomial, from its constant term on, are outside the unit circle."""
    try:
        return outside(polynomial)
    except Refused:
        pass
    # where the product of some is on the circle, each of them may be off it
    try:
        moduli = [abs(root) for root in acb_poly(polynomial).roots(maxprec=ctx.prec)]
    except ValueError:
        moduli = [arb(1)]
    must(all(modulus < 1 or modulus > 1 for modulus in moduli), "a multiplier may be on the circle")
    return sum(bool(modulus > 1) for modulus in moduli)


def outside(polynomial):
    """The same by the recursion of Schur and Cohn."""
    first, last = polynomial[0], polynomial[-1]
    if len(polynomial) == 1:
        return 0
    if abs(first) > abs(last):
        # z → 1/z
        return len(polynomial) - 1 - outside(polynomial[::-1])
    must(abs(first) < abs(last), "a multiplier may be on the circle")
    # as many as before are inside, but one
    return outside([last * x - first * y for x, y in zip(polynomial[1:], polynomial[-2::-1])])


def part_of(time, index, count):
    """One of so many parts of an interval."""
    value = dual(time).v
    part = value if count == 1 else value.mid() + value.rad() * arb(2 * index + 1 - count, 1) / count
    return Dual(part, time.d) if isinstance(time, Dual) else part


def above(x):
    """Whether a number is positive, or its derivative is."""
    return dual(x).v.real > 0 or isinstance(x, Dual) and x.d.real > 0


def zones_of(sequence):
    """The zones of a sequence."""
    return sequence[0] if isinstance(sequence, tuple) else sequence


def listed(sequence):
    """Modes and ways of a sequence."""
    ways = lambda way: way and (whole(way["guard"]), whole(way["exit"]))
    return [(whole(zone["mode"]), ways(zone["way"])) for zone in zones_of(sequence)]


class Orbit:
    """The boundary-value problem of an orbit and what singles out a point."""

    def __init__(self, posed, near, condition, domain=None):
        self.posed, self.condition = posed, condition
        self.kind = condition if isinstance(condition, str) else condition.name
        margin = condition.value if self.kind == "Margin" else {}
        watch = margin.get("watch")
        self.watch = watch if watch is None or isinstance(watch, str) else watch.name
        self.which = None if isinstance(watch, str) or watch is None else whole(watch.value)
        sequence, zones, self.sequence = zones_of(near["sequence"]), near["zones"], listed(near["sequence"])
        must(sequence and len(sequence) == len(zones), "zones without a state")
        self.zone = whole(margin["zone"], len(zones)) if margin else None
        self.forced, self.periods = posed["system"].get("forcing") is not None, whole(posed["periods"])
        # what vanishes at the event is looked for next to it
        self.domain = domain or arb(double(near["parameter"]), NEAR * double(posed["units"]["parameter"]))
        self.exact = Modes(posed, near["parameter"], [mode for mode, _ in self.sequence])
        self.n, self.stretches, self.guess = self.exact.count, [], []
        middle = self.exact.at(decimal(repr(double(near["parameter"]))))
        for index, (zone, (mode, way), at) in enumerate(zip(sequence, self.sequence, zones)):
            self.exact.check_zone(zone)
            must(way is not None or len(zones) == 1 and self.forced, "a zone that does not end")
            end = ("never",) if way is None else ("exit", *way)
            state, time = [acb(double(x)) for x in at["state"]], double(at["duration"])
            must(len(state) == self.n, "a zone has not as many states as the system")
            if self.watch == "Inside" and index == self.zone:
                first = double(margin["time"])
                must(0 < first < time, "a guard is touched outside of its zone")
                self.stretches.append(Stretch(index, mode, ("touch", self.which)))
                self.guess += state + [acb(first)]
                z = self.lift(state, acb(double(at["phase"])))
                state = apply(exponential(middle.matrices[mode], acb(first)), z)[: self.n]
                time -= first
            self.stretches.append(Stretch(index, mode, end))
            self.guess += [x.mid() for x in state] + [acb(time)]
        for one, two in zip(self.stretches, self.stretches[1:] + self.stretches[:1]):
            leads = one.mode
            if one.end[0] == "exit":
                guards = middle.guards[one.mode]
                must(one.end[1] < len(guards) and one.end[2] < len(guards[one.end[1]][1]), "an exit that there is not")
                leads = guards[one.end[1]][1][one.end[2]][0]
            must(leads == two.mode, "a zone does not lead to the next")
        self.half = self.kind == "Branching"
        if self.half:
            must(self.put_centre(), "a branch point of an orbit without symmetry")
            self.stretches = self.stretches[: len(zones) // 2]
            self.guess = self.guess[: len(self.stretches) * (self.n + 1)]
        if self.forced:
            self.guess.append(acb(double(zones[0]["phase"])))
        self.guess.append(acb(double(near["parameter"])))
        self.arrange()
        if self.kind == "Torus":
            self.guess.append(acb(double(condition.value["angle"])))
        self.events, self.closed, self.kept, self.phases = [], [], None, None
        lengths = self.guess[self.n : self.place : self.n + 1][: len(self.stretches)]
        self.divide_by([k for k, time in enumerate(lengths) if float(real(time)) < SHUT * double(posed["units"]["time"])])
        # what is zero on the branch, and what is so at the event
        self.facts = self.lasting = self.known()
        if self.watch == "Duration":
            self.closed.append(self.zone)
        elif self.kind == "Margin":
            self.events.append(self.vanishing())
        if self.kind == "Margin":
            self.facts = self.known()

    def divide_by(self, zones):
        """Finds by which power of their duration the equations of these zones are divided: such as begin where the guard is zero that
        they end with end there at once, whatever the orbit is. Their own equations do not tell what is zero as they begin."""
        self.divisors = {k: inf for k in zones if self.stretches[k].end[0] == "exit"}
        if self.divisors:
            facts, at = self.known(), self.stretches.__getitem__
            orders = {k: self.order(facts[k][0], at(k).mode, self.exact.guards[at(k).mode][at(k).end[1]][0]) for k in self.divisors}
            self.divisors = {k: order for k, order in orders.items() if order}

    def stationary(self, index):
        """Whether the parameter is stationary in the duration of a zone that has none: by formulas the guard of the zone before is so at
        its end, and the states go on as they did."""
        before, last = self.stretches[index - 1], (index - 1) % len(self.stretches)
        if last == index or before.end[0] != "exit" or {index, last} & {*self.divisors}:
            return False
        exact, facts = self.exact, self.facts[last][1]
        row, exits = exact.guards[before.mode][before.end[1]]
        reset = exits[before.end[2]][1]
        every = [*reset, *map(exact.unit, range(self.n, exact.size))]
        led = [combine(line, exact.matrices[before.mode]) for line in reset]
        own = [combine(line, every) for line in exact.matrices[self.stretches[index].mode][: self.n]]
        goes_on = all(facts.have([a - b for a, b in zip(*lines)]) for lines in zip(led, own))
        return goes_on and facts.have(exact.derivative(before.mode, row, 1))

    def divide(self, parts):
        """Cuts every zone into so many parts of one duration: no long products are formed over wide balls."""
        cut = lambda stretch, n: [stretch._replace(end=("cut",))] * (n - 1) + [stretch]
        self.divisors = {sum(parts[:zone]): order for zone, order in self.divisors.items()}
        self.stretches = [part for stretch, n in zip(self.stretches, parts) for part in cut(stretch, n)]
        self.arrange()
        self.facts = self.lasting = self.known()

    def arrange(self):
        """Places of unknowns: the first state and the duration of every stretch, which is one for all parts of a zone that is cut,
        and the parameter."""
        self.firsts, self.times, place = [], [], 0
        for stretch in self.stretches:
            self.firsts.append(place)
            place += self.n
            if stretch.end[0] != "cut":
                self.times += [place] * (len(self.firsts) - len(self.times))
                place += 1
        self.place = place + self.forced

    def settle(self, domain):
        """Sees that what is zero is so over an interval of the parameter, on a curve without an event."""
        if not self.domain.contains(domain):
            both = self.domain.union(domain)
            self.domain = arb(both.mid(), 2 * both.rad())
            self.facts = self.lasting = self.known()

    def lift(self, state, phase):
        z = list(state) + [1]
        for h in range(1, self.exact.harmonics + 1):
            z += [(h * phase).cos(), (h * phase).sin()]
        return z

    def turned(self, z):
        turned = [0] * (self.n + 1)
        for h in range(1, self.exact.harmonics + 1):
            cosine, sine = z[self.n + 2 * h - 1], z[self.n + 2 * h]
            turned += [-h * sine, h * cosine]
        return turned

    def modes(self, parameter):
        """The modes at a value of the parameter, and exp(MT) by a mode, the place of T and T. What belongs to the last parameter and
        the last durations is kept: in a Jacobian they are the same objects in most columns."""
        if self.kept is None or self.kept[0] is not parameter or self.kept[1] != ctx.prec:
            self.kept = parameter, ctx.prec, self.exact.at(parameter), {}
        *_, modes, steps = self.kept

        def step(mode, place, time, cell=None):
            known = steps.get((mode, place, cell))
            if known is None or known[0] is not time:
                of = time if cell is None else part_of(time, *cell)
                known = steps[mode, place, cell] = time, exponential(modes.matrices[mode], of)
            return known[1]

        return modes, step

    def parts(self, x, cell=None, among=None):
        """Modes, and (phase, duration, z at the entry, exp(MT), z at the end) of every stretch; of a cell of all durations where such
        is given, and without z and exp(MT) but for a range where such is given."""
        modes, step = self.modes(x[self.place])
        phase, parts = x[self.place - 1] if self.forced else 0, []
        for index, (stretch, first, at) in enumerate(zip(self.stretches, self.firsts, self.times)):
            time, moving = x[at], (None, None, None)
            if among is None or index in among:
                z, flow = self.lift(x[first : first + self.n], self.limited(index, phase)), step(stretch.mode, at, time, cell)
                moving = z, flow, apply(flow, z)
            parts.append((phase, time, *moving))
            phase = phase + modes.omega * time
        return modes, parts

    def limited(self, index, phase):
        """The phase at an entry, where that is known to lie in an interval."""
        if self.phases is None:
            return phase
        known, value = self.phases[index], dual(phase).v
        value = value.intersection(known) if value.overlaps(known) else value
        return Dual(value, phase.d) if isinstance(phase, Dual) else value

    def equations(self, x):
        """Entries, ends, the period of the forcing and what singles out the point."""
        modes, parts = self.parts(x)
        out = self.cycle(modes, parts)
        if self.kind == "Value":
            out.append(x[self.place] - decimal(self.condition.value))
        elif self.closed:
            out.append(x[self.times[self.closed[0]]])
        elif self.kind == "Margin":
            index, at_end, row = self.events[0]
            out += apply([modes.row_of(row)], parts[index][4 if at_end else 2])
        elif self.kind == "Torus":
            back = self.returned(modes, parts)
            one, two = (distance(back, (acb(0, sign) * x[self.place + 1]).exp()) for sign in (1, -1))
            out += [(one + two) / 2, (one - two) / acb(0, 2)]
        else:
            out.append(distance(self.returned(modes, parts), acb(1 if self.kind == "Fold" else -1)))
        return out

    def cycle(self, modes, parts):
        """The equations of the orbit."""
        out, count = [], len(parts)
        for index, (stretch, (*_, end)) in enumerate(zip(self.stretches, parts)):
            kind, *where = stretch.end
            guards = modes.guards[stretch.mode]
            reset = guards[where[0]][1][where[1]][1] if kind == "exit" else [modes.unit(i) for i in range(self.n)]
            # half an orbit ends at 2c − x
            after = parts[(index + 1) % count][2]
            after = self.turned_back(after[: self.n]) if self.half and index + 1 == count else after
            out += [new - y for new, y in zip(apply(reset, end), after)]
            if kind == "exit":
                # a guard with a zero of order m at the entry, divided by Tᵐ
                _, time, z, *_ = parts[index]
                order = self.divisors.get(index)
                out += apply([guards[where[0]][0]], tail(modes.matrices[stretch.mode], time, z, order) if order else end)
            elif kind == "touch":
                out += apply([combine(guards[where[0]][0], modes.matrices[stretch.mode])], end)
            elif kind == "never":
                out.append(parts[0][0])
        if self.forced:
            out.append(modes.omega * sum(part[1] for part in parts) - (2 - self.half) * self.periods * arb.pi())
        return out

    def slope(self, x, cells=1, also=None):
        """The Jacobian of the equations of the orbit at real unknowns: perturbations of what a stretch begins with, carried to its
        end by its matrix exponential, of which the derivative in the parameter is known. Over durations it is found in cells.
        Also that of a form at the entry or the end of a stretch, (stretch, at_end, form), as its last row."""
        n, count = self.n, len(self.stretches)
        rows = [[0] * (self.place + 1) for _ in range(self.place + (also is not None))]
        moving, step = self.modes(Dual(x[self.place], 1))
        still = lambda numbers: [*map(value_of, numbers)]
        shift = lambda numbers, z: sum((a.d * y for a, y in zip(numbers, z) if isinstance(a, Dual)), arb(0))
        omega, turn = dual(moving.omega).v, dual(moving.omega).d
        row, phase, elapsed, passed, kept = 0, self.place - 1, arb(0), {}, {}

        def enter(into, line, first, at):
            """Puts derivatives by states, the duration, the parameter and the phase of a stretch into a row."""
            for i in range(n):
                into[first + i] += line[i]
            into[at] += line[n]
            into[self.place] += line[n + 1]
            if self.forced:
                # an instant is later by all durations before it
                into[phase] += line[n + 2]
                into[self.place] += line[n + 2] * turn * elapsed
                for place, often in passed.items():
                    into[place] += line[n + 2] * omega * often

        for index, (stretch, first, at) in enumerate(zip(self.stretches, self.firsts, self.times)):
            kind, *where = stretch.end
            after, time = self.firsts[(index + 1) % count], x[at]
            z = self.lift(x[first : first + n], self.limited(index, x[phase] + omega * elapsed) if self.forced else 0)
            swung = self.turned(z) if self.forced else None
            # what the ends of stretches have in their equations
            guards = moving.guards[stretch.mode]
            lines = list(guards[where[0]][1][where[1]][1]) if kind == "exit" else [moving.unit(i) for i in range(n)]
            order = self.divisors.get(index)
            if kind == "exit" and not order:
                lines.append(guards[where[0]][0])
            elif kind == "touch":
                lines.append(combine(guards[where[0]][0], moving.matrices[stretch.mode]))
            if also and also[:2] == (index, True):
                lines.append(moving.row_of(also[2]))
            made = None
            for cell in range(cells):
                if (stretch.mode, at, cell) not in kept:
                    way = step(stretch.mode, at, time, (cell, cells))
                    kept[stretch.mode, at, cell] = way, as_matrix(map(still, way)), as_matrix(map(still, moving.matrices[stretch.mode]))
                way, flow, matrix = kept[stretch.mode, at, cell]
                # perturbations of the end by states, the duration, the parameter and the phase
                end = times(flow, z)
                moved = [[flow[i, j] for j in range(n)] + [y, shift(way[i], z)] for i, y in enumerate(times(matrix, end))]
                if self.forced:
                    moved = [[*line, y] for line, y in zip(moved, times(flow, swung))]
                found = (as_matrix(map(still, lines)) * as_matrix(moved)).tolist()
                for k, line in enumerate(lines):
                    found[k][n + 1] += shift(line, end)
                made = found if made is None else [[a.union(b) for a, b in zip(*both)] for both in zip(made, found)]
            if also and also[:2] == (index, True):
                enter(rows[-1], made.pop(), first, at)
            elif also and also[:2] == (index, False):
                form = moving.row_of(also[2])
                slopes = still(form[:n]) + [0, shift(form, z)] + ([sum(a * y for a, y in zip(still(form), swung))] if self.forced else [])
                enter(rows[-1], slopes, first, at)
            for k, line in enumerate(made):
                enter(rows[row + k], line, first, at)
            if order:
                enter(rows[row + n], self.quotient(moving, index, order, time, z, swung), first, at)
            sign = -1 if self.half and index + 1 == count else 1
            for i in range(n):
                rows[row + i][after + i] -= sign
            if kind == "never":
                rows[row + n][phase] += 1
            row += n + (kind != "cut")
            elapsed += time
            passed[at] = passed.get(at, 0) + 1
        if self.forced:
            for place, often in passed.items():
                rows[row][place] += omega * often
            rows[row][self.place] += turn * elapsed
        return as_matrix(rows)

    def quotient(self, moving, index, order, time, z, swung):
        """The guard at the end of a zone, divided by a power of its duration: its derivatives by states, duration, parameter and phase."""
        stretch = self.stretches[index]
        form, matrix = moving.guards[stretch.mode][stretch.end[1]][0], moving.matrices[stretch.mode]
        still = lambda numbers: [dual(a).v for a in numbers]
        at = lambda form, matrix, time, z: dual(apply([form], tail(matrix, time, z, order))[0])
        there = lambda time, z: at(still(form), list(map(still, matrix)), time, z)
        units = [[int(i == j) for j in range(len(z))] for i in range(self.n)]
        line = [there(time, unit).v for unit in units] + [there(Dual(time, 1), z).d, at(form, matrix, time, z).d]
        return line + ([there(time, swung).v] if self.forced else [])

    def returned(self, modes, parts):
        """The linearised return P to the first entry, in the states and the phase."""
        n, width = self.n, self.n + int(self.forced)
        product = [[acb(int(i == j)) for j in range(width)] for i in range(width)]
        linear = lambda rows, z: [row[:n] + (apply([row], self.turned(z)) if self.forced else []) for row in rows]
        last = [[0] * n + [1]] if self.forced else []
        for stretch, (_, _, z, step, end) in zip(self.stretches, parts):
            rows = [combine(row, product) for row in linear(step[:n], z) + last]
            if stretch.end[0] == "exit":
                row, exits = modes.guards[stretch.mode][stretch.end[1]]
                rate = apply(modes.matrices[stretch.mode][:n], end) + ([modes.omega] if self.forced else [])
                # perturbations on the guard: I − ẏgᵀ/ġ
                (normal,) = linear([row], end)
                fall = combine(normal, [[x] for x in rate])[0]
                moved = [x / fall for x in combine(normal, rows)]
                rows = [[x - r * y for x, y in zip(line, moved)] for line, r in zip(rows, rate)]
                rows = [combine(row, rows) for row in linear(exits[stretch.end[2]][1], end) + last]
            product = rows
        if self.half:
            product = [[-x for x in row] for row in product[:n]] + product[n:]
        return [row[:n] for row in product[:n]] if self.stretches[-1].end[0] == "never" else product

    # ------------------------------------------------------------------------------------------------ what is zero
    def known(self):
        """What is zero at the entry and at the end of every stretch, whatever the parameter."""
        facts, shut = [[Zeros(self.domain), Zeros(self.domain)] for _ in self.stretches], {}

        def add(zeros, index, at_end):
            events = [row for *where, row in self.events if where == [index, at_end]]
            for row in events + shut.get((index, at_end), []):
                zeros.insert(row)

        while True:
            before = [len(zeros.rows()) for pair in facts for zeros in pair]
            for index, stretch in enumerate(self.stretches):
                exact, mode = self.exact, stretch.mode
                add(facts[index][0], index, False)
                # where no time passes all that is zero at the entry is so at the end
                still = index in self.closed
                end = Zeros(self.domain, facts[index][0].rows()) if still else facts[index][0].along(exact.matrices[mode], exact.surfaces[mode])
                follower = facts[(index + 1) % len(facts)]
                kind, *where = stretch.end
                if kind == "never":
                    facts[index][1] = end
                    continue
                if kind != "cut":
                    row, exits = exact.guards[mode][where[0]]
                    order = self.divisors.get(index, 0)
                    start = self.order(facts[index][0], mode, row) if order else None
                    if start is None or start >= order:
                        end.insert(row if kind == "exit" else exact.derivative(mode, row, 1))
                    if order and index in self.closed:
                        end.insert(exact.derivative(mode, row, order))
                add(end, index, True)
                facts[index][1] = end
                follower[0] = end.after(exits[where[1]][1], exact.size) if kind == "exit" else Zeros(self.domain, end.rows())
                add(follower[0], (index + 1) % len(facts), False)
                if index in self.closed:
                    # what is zero at the end is so at the entry, and at the end before
                    last, rows = (index - 1) % len(facts), end.rows()
                    _, guard, way = self.stretches[last].end
                    reset = exact.guards[self.stretches[last].mode][guard][1][way][1]
                    every = [*reset, *map(exact.unit, range(self.n, exact.size))]
                    shut[index, False], shut[last, True] = rows, [combine(row, every) for row in rows]
            if [len(zeros.rows()) for pair in facts for zeros in pair] == before:
                return facts

    def order(self, zeros, mode, row):
        """The least order of a derivative that is not known to be zero, or None."""
        for order in range(self.exact.size + 1):
            if not zeros.have(row):
                return order
            row = combine(row, self.exact.matrices[mode])
        return None

    def vanishing(self):
        """The stretch, whether at its end, and the form of the margin that vanishes."""
        index = next(i for i, stretch in enumerate(self.stretches) if stretch.zone == self.zone)
        stretch, which, facts = self.stretches[index], self.which, self.lasting[index]
        mode = stretch.mode
        guards = self.exact.guards[mode]
        guard = lambda k, order: self.exact.derivative(mode, guards[k][0], order)
        if self.watch == "Inside":
            must(which < len(guards), "a margin of no guard")
            return index, True, guard(which, 0)
        must(self.watch in ("Onset", "End", "Speed", "Condition", "Before"), "a margin that is not treated")
        must(stretch.end[0] == "exit", "a margin of a switch that there is not")
        own, exit = stretch.end[1:]
        if self.watch == "Speed":
            return index, True, guard(own, 1)
        if self.watch in ("Onset", "End"):
            at_end = self.watch == "End"
            must(which < len(guards), "a margin of no guard")
            order = self.order(facts[at_end], mode, guards[which][0])
            must(order is not None, "a guard that is zero all along vanishes")
            return index, at_end, guard(which, order)
        must(self.watch == "Condition" or which < exit, "an exit that is not before the one taken")
        held = guards[own][1][exit if self.watch == "Condition" else which][2]
        if self.watch == "Before":
            open_ones = [k for k, row in enumerate(held) if not facts[1].have(row)]
            must(len(open_ones) == 1, "an exit with several conditions")
            which = open_ones[0]
        must(which < len(held), "a margin of no condition")
        return index, True, held[which]

    def change(self):
        """The type of a change of the sequence, by all that is zero at the event and not on the branch."""
        new = set()
        for stretch, (_, facts), (_, lasting) in zip(self.stretches, self.facts, self.lasting):
            if stretch.end[0] == "touch":
                new.add("GR")
            if stretch.end[0] != "exit":
                continue
            row, exits = self.exact.guards[stretch.mode][stretch.end[1]]
            held = [it for _, _, rows, _ in exits[: stretch.end[2] + 1] for it in rows]
            for kind, forms in ("GR", [self.exact.derivative(stretch.mode, row, 1)]), ("SL", held):
                if any(facts.have(it) and not lasting.have(it) for it in forms):
                    new.add(kind)
        for index in self.closed:
            # a zone has none where what ends it is zero as it begins, and not on the branch
            row, _ = self.exact.guards[self.stretches[index].mode][self.stretches[index].end[1]]
            if self.facts[index][0].have(row) and not self.lasting[index][0].have(row):
                new.add("CO")
        must(new or not self.closed, "what vanishes where a zone has no duration is not known")
        return next((kind for kind in ("GR", "SL") if kind in new), "CO")

    def primitive(self, x):
        """Whether the orbit closes after its period and not after a part of it, where its sequence repeats itself."""
        count, parts = len(self.sequence), self.parts(x)[1]
        if self.sequence[0][1] is None:
            # without a switch every part obeys the same equations
            return self.periods == 1
        entries = {}
        for stretch, (_, _, z, *_) in zip(self.stretches, parts):
            entries.setdefault(stretch.zone, z[: self.n])
        if self.half:
            entries |= {zone + count // 2: self.turned_back(state) for zone, state in entries.items()}
        for times in range(2, count + 1):
            if count % times or self.forced and self.periods % times:
                continue
            later = lambda zone: (zone + count // times) % count
            apart = lambda zone: any(not a.overlaps(b) for a, b in zip(entries[zone], entries[later(zone)]))
            if not any(self.sequence[zone] != self.sequence[later(zone)] or apart(zone) for zone in range(count)):
                return False
        return True

    def legs(self, x):
        """Mode, entry and duration of what has one, in order; the phase is there by its cosine and sine."""
        found = []
        for index, (stretch, (phase, time, z, *_)) in enumerate(zip(self.stretches, self.parts(x)[1])):
            if index not in self.closed:
                turn = [phase.cos(), phase.sin()] if self.forced else []
                found.append((stretch.mode, z[: self.n] + turn, time))
        return found

    # ------------------------------------------------------------------------------------------------ uniqueness
    def linear(self, x, v, factor, w, cell, among=None):
        """What the equations of the orbit make of perturbations v of all unknowns but the parameter, where that of the first entry
        is `factor` times as large a period later, times w: a number for every stretch, or for those of a range, and for the period,
        with the flows of a cell of all durations."""
        modes, parts = self.parts(x, cell, among)
        n, count, out, row, later = self.n, len(self.stretches), [], 0, v[self.place - 1] if self.forced else 0
        among = range(count) if among is None else among
        for index, (stretch, (_, _, z, step, end)) in enumerate(zip(self.stretches, parts)):
            first, after, long = self.firsts[index], self.firsts[(index + 1) % count], v[self.times[index]]
            height = n + (stretch.end[0] != "cut")
            if index not in among:
                later, row = later + modes.omega * long, row + height
                continue
            moved = [*v[first : first + n], *[0] * (len(z) - n)]
            if self.forced:
                moved = [a + b * later for a, b in zip(moved, self.turned(z))]
            moved = [a + b * long for a, b in zip(apply(step, moved), apply(modes.matrices[stretch.mode], end))]
            kind, *where = stretch.end
            row_of, exits = modes.guards[stretch.mode][where[0]] if kind == "exit" else (None, None)
            reset = exits[where[1]][1] if kind == "exit" else [modes.unit(i) for i in range(n)]
            sign = (-1 if self.half else 1) * factor if index + 1 == count else 1
            made = [a - sign * b for a, b in zip(apply(reset, moved), v[after : after + n])]
            if kind != "cut":
                made += apply([row_of], moved) if kind == "exit" else [v[self.place - 1]]
            out.append(sum((a * b for a, b in zip(made, w[row : row + height])), arb(0)))
            later, row = later + modes.omega * long, row + height
        if self.forced:
            out.append((later - factor * v[self.place - 1]) * w[row])
        return out

    def closing(self, rows, factor):
        """The matrix of `linear` from the Jacobian."""
        rows = [row[: self.place] for row in rows]
        last = self.place - self.forced - self.n - 1
        for i in range(self.n):
            rows[last + i][i] -= (-1 if self.half else 1) * (factor - 1)
        if self.forced:
            rows[-1][self.place - 1] += 1 - factor
        return rows

    def factor(self, x):
        """The multiplier that singles out the point, or None."""
        if self.kind == "Torus":
            turn = x[self.place + 1]
            cosine, sine = turn.cos(), turn.sin()
            return cosine + sine * acb(0, 1) if not isinstance(turn, Dual) else Dual(acb(cosine.v, sine.v), acb(cosine.d, sine.d))
        return {"Fold": 1, "Doubling": -1, "Branching": -1}.get(self.kind)

    def null_vectors(self, rows, border, radii):
        """v and w with Av = −gb, ⟨l, v⟩ = 1 and wᵀA = −hlᵀ, ⟨w, b⟩ = 1 for all matrices A in a matrix of balls: A is singular where
        g = 0 only, and g′ = −wᵀA′v. None where that is not shown."""
        scale, below, beside = border
        size = self.place + 1
        rows = [[a * u * t for a, u in zip(row, radii)] for row, t in zip(rows, scale)]
        both = as_matrix([*([*row, b] for row, b in zip(rows, beside)), [*below, 0]])
        ends = []
        for whole in (both, both.transpose()):
            try:
                inverse = whole.mid().inv().mid()
            except ZeroDivisionError:
                return None
            away = inverse * whole - as_matrix([[int(i == j) for j in range(size)] for i in range(size)])
            first = [inverse[i, size - 1] for i in range(size)]
            # x = first − away·x
            bounds, middle = as_matrix([[abs(y).upper() for y in line] for line in away.tolist()]), [abs(y).upper() for y in first]
            spread, held = [arb(0)] * size, False
            for _ in range(TURNED):
                moved = [y.upper() for y in times(bounds, [a + b for a, b in zip(middle, spread)])]
                held = all(a < b for a, b in zip(moved, spread))
                if held:
                    break
                spread = [a * 1.1 + ALMOST for a in moved]
            if not held:
                return None
            ball = lambda r: acb(arb(0, 1) * r, arb(0, 1) * r) if isinstance(whole, acb_mat) else arb(0, 1) * r
            ends.append([a - b for a, b in zip(first, times(away, [a + ball(r) for a, r in zip(first, moved)]))][:-1])
        return [y * u for y, u in zip(ends[0], radii)], [y * t for y, t in zip(ends[1], scale)]

    def reached(self, unknown):
        """The stretches whose equations have an unknown in what multiplies perturbations: those that begin before it are not among them."""
        count = len(self.stretches)
        if unknown >= self.place - self.forced:
            return range(count)
        index = next(k for k, (first, at) in enumerate(zip(self.firsts, self.times)) if first <= unknown <= at)
        # a duration moves all later instants of the forcing
        return range(index, count if self.forced and unknown == self.times[index] else index + 1)

    def bordered(self, box, rows, border, radii, cells):
        """The rows of g′, see `null_vectors`, for the matrix of `linear` over a box, times radii. None where that is not shown."""
        vectors = self.null_vectors(self.closing(rows, self.factor(box)), border, radii)
        if vectors is None:
            return None
        (right, left), slopes = vectors, []
        for j, radius in enumerate(radii):
            seeded, among = [Dual(x, radius) if i == j else x for i, x in enumerate(box)], self.reached(j)
            flows = ((cell, cells) for cell in range(cells))
            every = [[acb(dual(a).d) for a in self.linear(seeded, right, self.factor(seeded), left, cell, among)] for cell in flows]
            slopes.append(-sum((reduce(acb.union, each) for each in zip(*every)), acb(0)))
        return [[y.real for y in slopes], [y.imag for y in slopes]][: 1 + (self.kind == "Torus")]

    def border(self, rows, radii):
        """Sizes of rows, and about the null vectors of a matrix that is nearly singular from the right and the left."""
        rows = [[a * u for a, u in zip(row, radii)] for row in rows]
        scale = [1 / max(abs(a).upper() for a in row).mid() for row in rows]
        inverse = as_matrix([[a * t for a in row] for row, t in zip(rows, scale)]).mid().inv().mid()
        vectors = []
        for whole in (inverse, inverse.transpose()):
            null = times(whole, [1] * self.place)
            largest = max(abs(y).mid() for y in null)
            # near the complex conjugate: that their product is not small
            vectors.append([(y.conjugate() if isinstance(y, acb) else y).mid() / largest for y in null])
        return scale, *vectors

    def radii(self, _, distance):
        """The box of a distance of the parameter, and of the other unknowns with the same share of their units."""
        units = self.posed["units"]
        each = [*map(double, units["states"]), double(units["time"])] * len(self.stretches)
        each += [1.0] * int(self.forced) + [double(units["parameter"])] + [1.0] * (self.kind == "Torus")
        share = arb(double(distance)) / arb(double(units["parameter"]))
        return [arb(unit) * share for unit in each]

    @ctx.workprec(SIGNS)
    def unique(self, zero, distance):
        """Less than 1 if there is no other orbit with its parameter within a distance, and its other unknowns within the same
        share of their units. States between the steps of the program are no unknowns here, so that more is shown."""
        radii, middle = self.radii(zero, distance), [real(y) for y in zero.middle]
        share = radii[self.place] / double(self.posed["units"]["parameter"])
        return self.apart([real(phase) + arb(0, 1) * share for phase, *_ in self.parts(middle)[1]]).alone(middle, radii)

    def apart(self, phases):
        """The same where phases at entries lie in intervals. Were they unknowns, each the one before and what it gains, the Jacobian
        would be the same, at phases that have these intervals."""
        same = copy(self)
        same.phases, same.kept = phases if self.forced else None, None
        return same

    def alone(self, middle, radii):
        """How far the Jacobian over a box is from that in its middle."""
        also = self.events[0] if self.kind == "Margin" and not self.closed else None
        try:
            near = [real(y) for y in self.guess]
            critical = self.factor(middle) is not None
            border = self.border(self.closing(self.slope(near).tolist(), self.factor(near)), radii) if critical else None
        except ZeroDivisionError:
            return arb("inf")

        def jacobian(box, cells):
            rows = self.slope(box, cells, also).tolist()
            unit = lambda place: [int(j == place) for j in range(self.place + 1)]
            if self.kind == "Value" or self.closed:
                rows.append(unit(self.times[self.closed[0]] if self.closed else self.place))
            scaled = [[a * u for a, u in zip(row, radii)] for row in rows]
            if border is None:
                return as_matrix(scaled)
            ends = self.bordered(box, rows, border, radii, cells)
            if ends is None:
                return None
            return as_matrix([row + [0] * (self.kind == "Torus") for row in scaled] + ends)

        told = [self.place] if self.kind == "Value" else [self.times[at] for at in self.closed[:1]]
        norm = injective(jacobian, middle, radii, [self.place], FINER, told)
        if norm < 1 or critical and (border is None or self.kind == "Torus"):
            return norm
        return lesser(norm, self.curved_critical(middle, radii, border) if critical else self.curved(middle, radii))

    def meeting(self):
        """The pairs of unknowns in which the equations of the orbit have second derivatives: a state enters by the flow of its own stretch,
        linearly, and a duration moves all later instants of the forcing."""
        first = {place + i: at for place, at in zip(self.firsts, self.times) for i in range(self.n)}
        size = self.place + 1
        for j in range(size):
            for k in range(j, size):
                states = [it for it in (j, k) if it in first]
                other = k if j in first else j
                if not states and (self.forced or j == k or self.place in (j, k)) or len(states) == 1 and other in (first[states[0]], self.place):
                    yield j, k

    def curved_critical(self, middle, radii, border):
        """The same where a multiplier is 1 or −1, with the null vector v of A, see `linear`, among the unknowns: Av = 0, ⟨l, v⟩ = 1. Where
        the bordered matrix is regular over the box, by second derivatives, every v is in a box that follows."""
        free, size, (scale, below, beside) = self.apart(None), self.place, border
        factor, last, sign = self.factor(middle), self.place - self.forced - self.n - 1, -1 if self.half else 1
        box = [y + radius * arb(0, 1) for y, radius in zip(middle, radii)]

        def orbit(x):
            return free.cycle(*free.parts(x))

        def extended(y):
            x, v = y[: size + 1], y[size + 1 :]
            parameter = Dual(x[size], 0) if isinstance(x[size], Dual) else x[size]
            both = [dual(z) for z in orbit([*(Dual(a, b * radius) for a, b, radius in zip(x, v, radii)), parameter])]
            turned = [z.d for z in both]
            for i in range(self.n):
                turned[last + i] = turned[last + i] - v[i] * radii[i] * (sign * (factor - 1))
            if self.forced:
                turned[-1] = turned[-1] + v[size - 1] * radii[size - 1] * (1 - factor)
            return [z.v for z in both] + turned + [sum(a * b for a, b in zip(v, below)) - 1]

        rows = [[a * u * t for a, u in zip(row, radii)] for row, t in zip(self.closing(free.slope(middle).tolist(), factor), scale)]
        both = as_matrix([*([*row, b] for row, b in zip(rows, beside)), [*below, 0]])
        try:
            inverse = both.mid().inv().mid()
        except ZeroDivisionError:
            return arb("inf")
        pairs = list(self.meeting())
        bounds = [[abs(y - int(i == j)).upper() for j, y in enumerate(row)] for i, row in enumerate((inverse * both).tolist())]
        for j, k in pairs:
            moved = [real(z) for z in second(orbit, box, radii, j, k)]
            sizes = [abs(y).upper() for y in times(inverse, [*(a * t for a, t in zip(moved, scale)), arb(0)])]
            for row, y in zip(bounds, sizes):
                for place in {j, k} - {size}:
                    row[place] += y
        middle_of_v = [inverse[i, size] for i in range(size + 1)]
        bounds, spread = as_matrix(bounds), [arb(0)] * (size + 1)
        for _ in range(TURNED):
            moved = [y.upper() for y in times(bounds, [abs(a) + b for a, b in zip(middle_of_v, spread)])]
            if all(a < b for a, b in zip(moved, spread)):
                break
            spread = [a * 1.1 + ALMOST for a in moved]
        else:
            return arb("inf")
        v, radius = [a.mid() for a in middle_of_v[:size]], [a.upper() for a in moved[:size]]
        later = lambda place: size + 1 + place
        mixed = sorted({(a, later(b)) for j, k in pairs for a, b in ((j, k), (k, j)) if b != size})
        whole = [*box, *(a + r * arb(0, 1) for a, r in zip(v, radius))]
        return bent(extended, [*middle, *v], [whole], [*radii, *radius], [*pairs, *mixed])

    def curved(self, middle, radii):
        """The same by second derivatives. Where there is a forcing, the phases at entries are unknowns in place of the durations, which
        are what they gain: an instant then depends on no duration before it."""
        n, count, period = self.n, len(self.stretches), self.place - 1
        if any(stretch.end[0] in ("cut", "never") for stretch in self.stretches):
            return arb("inf")
        phases = range(n, count * (n + 1), n + 1)
        held, value = {"Value": len(middle) - 1}.get(self.kind), middle[self.place]
        share, free, lasting = radii[period], self.apart(None), [middle[at] for at in self.times]

        def unknowns(y):
            """States, durations, the phase and the parameter."""
            parameter = value if held else y[-1]
            if not self.forced:
                return [*y[: self.place], parameter]
            at, omega = [y[k] for k in phases], free.modes(parameter)[0].omega
            later = [*at[1:], at[0] + (2 - self.half) * self.periods * arb.pi()]
            x = list(y[: count * (n + 1)])
            for k, begin, end in zip(phases, at, later):
                x[k] = (end - begin) / omega
            return [*x, at[0], parameter]

        def equations(y):
            # that of the period holds as it stands, and so does that of a value
            found = free.equations(unknowns(y))
            return [z for k, z in enumerate(found) if k != (period if self.forced else None) and not (held and k == held)]

        if self.forced:
            entries = [real(phase) for phase, *_ in self.parts(middle)[1]]
            middle, radii = list(middle), list(radii)
            for k, phase in zip(phases, entries):
                middle[k], radii[k] = phase, share
            middle, radii = ([*it[:period], it[self.place]] for it in (middle, radii))
        middle, radii = (it[:-1] if held else it for it in (middle, radii))
        size, own = len(middle), lambda k: k // (n + 1)
        is_state = lambda k: k < count * (n + 1) and k % (n + 1) < n
        # a state enters by the flow of its own stretch, linearly
        near = lambda k, m: not is_state(m) and (m >= count * (n + 1) or own(m) in (own(k), (own(k) + 1) % count))
        pairs = [(j, k) for j in range(size) for k in range(j, size) if (not is_state(j) or near(j, k)) and (not is_state(k) or near(k, j))]
        # most is lost in the parameter, or in the longest zone
        longest = max(range(count), key=lambda k: float(real(lasting[k]).mid()))
        worst = [size - 1] if not held else sorted({phases[longest], phases[(longest + 1) % count]} if self.forced else {phases[longest]})
        norm = arb("inf")
        for parts in (1, 4):
            norm = lesser(norm, bent(equations, middle, list(parted(middle, radii, worst, parts)), radii, pairs))
            if norm < 1 or not norm < 3:
                break
        return norm

    # ------------------------------------------------------------------------------------------------ symmetry
    def image(self, row, twice):
        """A form half a period later: 2c − x around a centre, with the phase half a turn on."""
        image = [u * flip for u, flip in zip(row, self.flips())]
        image[self.n] += sum(u * c for u, c in zip(row, twice) if u and c)
        return image

    def flips(self):
        return [-1] * self.n + [1] + [(-1) ** h for h in range(1, self.exact.harmonics + 1) for _ in range(2)]

    def pairs(self):
        """Guards, resets and rates of every stretch, each beside that of half a period later; None where there are none."""
        count, exact = len(self.stretches), self.exact
        if count % 2 or self.forced and self.periods % 2 == 0 or any(it.end[0] != "exit" for it in self.stretches):
            return None
        parts = []
        for mode, (_, guard, way) in ((it.mode, it.end) for it in self.stretches):
            row, exits = exact.guards[mode][guard]
            parts.append((row, exits[way][1], exact.matrices[mode]))
        return [tuple(zip(one, two)) for one, two in zip(parts, parts[count // 2 :] + parts[: count // 2])]

    def centre(self):
        """Twice the centre around which the equations of the second half are the image of those of the first, or None."""
        pairs, n, flips = self.pairs(), self.n, self.flips()
        if pairs is None:
            return None
        # what the constants of guards, rates and resets say of it; a state that they leave open is zero there
        equations, unit = Zeros(self.domain), lambda i: [int(i == j) for j in range(n)]
        for (one, two), resets, rates in pairs:
            equations.insert([*one[:n], one[n] - two[n]])
            for one, two in list(zip(*rates))[:n]:
                equations.insert([*one[:n], one[n] + two[n]])
            for i, (one, two) in enumerate(zip(*resets)):
                equations.insert([*(a - b for a, b in zip(one, unit(i))), one[n] + two[n]])
        for i in range(n):
            if i not in dict(equations.solved):
                equations.insert([*unit(i), 0])
        known = dict(equations.solved)
        twice = [-ratio(known[i][n]) if i in known and not any(known[i][:i] + known[i][i + 1 : n]) else None for i in range(n)]
        if any(c is None or c.over.degree() > 0 or c.under.degree() > 0 for c in twice):
            return None
        same = lambda one, two: not any(u - v for u, v in zip(one, two))
        shifted = lambda row, by: [row[i] + by if i == n else row[i] for i in range(len(row))]
        turned = lambda row, flip, by=0: shifted([u * flip for u in self.image(row, twice)], by)
        for (one, two), resets, rates in pairs:
            if not (
                same(self.image(one, twice), two)
                and all(same(turned(u, -1, c), v) for u, v, c in zip(*resets, twice))
                and all(same(turned(u, flip), v) for u, v, flip in zip(*rates, flips))
            ):
                return None
        return twice

    def turned_back(self, state):
        """The image of the numbers of a state."""
        return [c - x for c, x in zip(self.doubled, state)]

    def put_centre(self):
        """Finds the centre, and says whether there is one."""
        self.twice = self.centre()
        self.doubled = self.twice and [acb(c.over[0] / c.under[0]) for c in self.twice]
        return self.twice is not None

    def whole(self, near, x):
        """The whole of an orbit of which half is known, and its unknowns."""
        if not self.half:
            return self, x
        n, first = self.n, x[: len(self.stretches) * (self.n + 1)]
        rows = [first[i : i + n + 1] for i in range(0, len(first), n + 1)]
        image = [y for *state, time in rows for y in [*self.turned_back(state), time]]
        return Orbit(self.posed, near, "Value"), [*first, *image, *x[len(first) :]]

    def mirror(self, x):
        """Puts what vanishes in the other half of a symmetric orbit to the events: 2c − x half a period later, with the
        phase half a turn on. For every value of the parameter near the event there is one orbit only in a ball with this
        one and its image; so it is its image."""
        count, n, exact = len(self.stretches), self.n, self.exact
        if not (self.events or self.closed) or not self.put_centre():
            return False
        index, at_end, wanted = self.events[0] if self.events else (self.closed[0], None, None)
        other = (index + count // 2) % count
        held = [it for guard in exact.guards[self.stretches[other].mode] for way in guard[1] for it in way[2]]
        image = wanted and self.image(wanted, self.twice)
        found = [it for it in held if self.events and not any(u - v for u, v in zip(image, it))]
        if self.events and not found:
            return False
        fixed = acb(arb(x[self.place].real.mid(), arb(2) ** -200))
        alone = lambda y: self.cycle(*self.parts([*y, fixed]))
        zero_there, radius = prove_zero(alone, [y.mid() for y in x[: self.place]])
        image, half = list(x[: self.place]), n + 1
        for place in range(count):
            start = (place + count // 2) % count * half
            image[place * half : (place + 1) * half] = [*self.turned_back(x[start : start + n]), x[start + n]]
        if self.forced:
            image[self.place - 1] = self.parts(x)[1][count // 2][0] - self.periods * acb.pi()
        near = lambda orbit: all(abs(a - b) < 4 * radius for a, b in zip(orbit, zero_there))
        if not (near(x) and near(image)):
            return False
        if self.events:
            self.events.append((other, at_end, found[0]))
        else:
            self.closed.append(other)
        self.facts = self.known()
        return True

    # ------------------------------------------------------------------------------------------------ signs
    def all_signs(self, x, closed=()):
        """Every inequality with whether it holds. Along a curve, where unknowns have derivatives away from an end at which it
        holds or what it is of is zero, it holds where that grows as well; stretches that are `closed` there grow from nothing."""
        modes, parts = self.parts(x)
        for index, (stretch, (_, time, z, *_)) in enumerate(zip(self.stretches, parts)):
            mode, zone, end = stretch.mode, stretch.zone, self.handed_on(index, parts)
            (entry_facts, end_facts), lasting = self.facts[index], self.lasting[index]
            at = lambda row: apply([modes.row_of(row)], end)[0]
            yield f"the duration of zone {zone}", index in self.closed or above(time)
            for guard, (exact, _) in enumerate(self.exact.guards[mode]):
                start = self.order(entry_facts, mode, exact)
                if start is None:
                    # in a zone of no duration it may be so at the event only
                    once = index in self.closed and self.order(lasting[0], mode, exact) is not None
                    yield f"guard {guard}, zero all along zone {zone}, whether its switch is taken", once
                    continue
                stop, row = self.order(end_facts, mode, exact) or 0, modes.row_of(exact)
                if index in closed and index in self.divisors and stretch.end[1] == guard:
                    # zero at its end; and over the power of time that it has as a factor from its entry on it falls
                    for _ in range(self.divisors[index] + 1):
                        row = combine(row, modes.matrices[mode])
                    row, stop = [-y for y in row], 0
                # what is zero at the entry of every such zone grows from there
                at_entry = stretch.end[:2] != ("exit", guard) and bool(self.order(lasting[0], mode, exact))
                holds = positive(modes.matrices[mode], row, z, end, time, (start, stop), index in closed, at_entry)
                yield f"guard {guard} within zone {zone}", holds
            if stretch.end[0] != "exit":
                continue
            own, way = stretch.end[1:]
            exits, negative = self.exact.guards[mode][own][1], lambda row: dual(at(row)).v.real < 0
            for other, (row, ways) in enumerate(self.exact.guards[mode]):
                if other == own or not lasting[1].have(row):
                    continue
                # of guards that are zero at once none is the first
                to, reset, *_ = exits[way]
                same = lambda it: it[0] == to and all(end_facts.have([a - b for a, b in zip(*rows)]) for rows in zip(it[1], reset))
                agree = all(same(it) or any(map(negative, it[2])) for it in ways)
                yield f"that guard {other}, zero at the end of zone {zone} too, leads on like the one taken", agree
            for which, row in enumerate(exits[way][2]):
                if not end_facts.have(row):
                    yield f"condition {which} at the end of zone {zone}", above(at(row))
            for before in range(way):
                rows = exits[before][2]
                # what is about to lead there is zero at the event, and the rest does not say that it fails
                about = [row for place, at_end, row in self.events if at_end and place == index]
                beside = index in self.closed or (index + 1) % len(parts) in self.closed
                opens = beside and any(end_facts.have(row) and not lasting[1].have(row) for row in rows)
                if opens or any(row is it for it in about for row in rows):
                    continue
                rows = [row for row in rows if not end_facts.have(row)]
                # of several that may be what fails at the end of a curve none is known to grow from there
                fails = above(-at(rows[0])) if len(rows) == 1 else any(map(negative, rows))
                yield f"that exit {before} is not taken at the end of zone {zone}", fails

    def handed_on(self, index, parts):
        """The state at the end of a stretch, narrower by that at the next entry where no reset lies between."""
        end, after, stretch = parts[index][4], parts[(index + 1) % len(parts)][2], self.stretches[index]
        if stretch.end[0] == "exit":
            guard, way = stretch.end[1:3]
            reset = self.exact.guards[stretch.mode][guard][1][way][1]
            if any(ratio(a) - b for i, row in enumerate(reset) for a, b in zip(row, self.exact.unit(i))):
                return end
        if self.half and index + 1 == len(parts):
            return end
        meet = lambda a, b: real(a).intersection(real(b))
        both = ((dual(a), dual(b)) for a, b in zip(end[: self.n], after))
        return [Dual(meet(a.v, b.v), meet(a.d, b.d)) for a, b in both] + end[self.n :]


def kind_of(point, proof, orbit):
    """Type of a point by what singles it out."""
    changed = proof.get("changed")
    must((changed is not None) == (orbit.kind == "Margin"), "what changes is said where a margin vanishes, and only there")
    if orbit.kind == "Value":
        return point["kind"] if point["kind"] in ("UZ", "EP") else "UZ or EP"
    if orbit.kind != "Margin":
        return {"Fold": "LP", "Doubling": "PD", "Branching": "BP", "Torus": "NS"}[orbit.kind]
    sides = [listed(it) for it in (changed["before"], changed["after"]) if it is not None]
    before, *after = sides
    places = [(listed(it["near"]["sequence"]), it["condition"]) for it in (proof, *proof.get("seen", []))]
    must(places[0][0] in sides, "it changes between two others")
    must(all(any(place == side for place, _ in places) for side in sides), "in a sequence that is stated nothing is proven")
    vanishing = next(condition for place, condition in places if place == before)
    margin = vanishing.value if isinstance(vanishing, Tagged) and vanishing.name == "Margin" else {}
    must(all(margin.get(name) == changed[name] for name in ("watch", "zone")), "the change is another than what is proven")
    turned = [before[k:] + before[:k] for k in range(len(before))]
    must(not any(side in turned for side in after), "it is said that nothing changes")
    return orbit.change()


def agree(one, two):
    """Whether two orbits have the same modes, states, phases and durations, cut at the same instants or one at more of them."""
    few, many = sorted((one, two), key=len)
    overlap = lambda a, b: all(acb(x).overlaps(acb(y)) for x, y in zip(a, b))
    for shift in range(len(many)):
        rest = many[shift:] + many[:shift]
        for mode, entry, time in few:
            total, taken = acb(0), rest[:1]
            while rest and rest[0][0] == mode and not total.overlaps(acb(time)):
                total += rest.pop(0)[2]
            if not (taken and total.overlaps(acb(time)) and overlap(entry, taken[0][1])):
                break
        else:
            if not rest:
                return True
    return False
