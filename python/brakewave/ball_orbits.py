"""Orbits of systems of one's own in balls of Arb (python-flint): their equations, zeros of them that are proven, signs.

Written from docs/systems.md, apart from the program. check.py says what it is for. An orbit is a cycle of
stretches: its zones, one of which is cut where a guard touches zero inside. Unknowns are the states at the entry of
every stretch, its duration, the phase of the first entry and the parameter. One matrix exponential leads through a
stretch. Multipliers are the eigenvalues of the linearised return to the first entry, in states and phase.
"""

import re
from fractions import Fraction
from math import comb

from flint import acb, acb_mat, arb, ctx, fmpq, fmpq_poly

from .ball_waves import NotCovered, decimal, must, prove_zero

SIGNS = 128
"""Bits in which signs are shown."""
TAYLOR = 12
"""Order of the Taylor polynomials by which signs are shown."""
DEPTH = 40
"""Bisections of a stretch after which a sign counts as not shown."""

# ---------------------------------------------------------------------------------------------------- expressions
TOKEN = re.compile(r"\s*(?:((?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)|([^\W\d]\w*)|([-+*/^()]))")
FUNCTIONS = ("sin", "cos", "tan", "exp", "ln", "sqrt", "abs", "tanh")


def read(text):
    """The tree of an expression: numbers as texts in ("number", ..), ("name", ..), ("neg", ..), (operator, a, b),
    ("call", function, a). `^` binds most closely and to the right, then a sign, then `*` and `/`."""
    tokens, place, text = [], 0, text.rstrip()
    while place < len(text):
        found = TOKEN.match(text, place)
        must(found, f"`{text}` cannot be read")
        tokens.append(found.groups())
        place = found.end()
    tokens.reverse()
    mark = lambda *wanted: bool(tokens) and tokens[-1][2] in wanted

    def operand():
        must(tokens, f"`{text}` ends too soon")
        number, name, sign = tokens.pop()
        if number:
            return "number", number
        if name and not mark("("):
            return "name", name
        if name:
            tokens.pop()
        must(name or sign == "(", f"`{text}` cannot be read")
        inner = level(0)
        must(mark(")"), f"a bracket of `{text}` is open")
        tokens.pop()
        return ("call", name, inner) if name else inner

    def power():
        if mark("-", "+"):
            sign = tokens.pop()[2]
            return ("neg", power()) if sign == "-" else power()
        base = operand()
        if mark("^"):
            tokens.pop()
            return "^", base, power()
        return base

    def level(index):
        if index == 2:
            return power()
        left = level(index + 1)
        while mark(*("+-", "*/")[index]):
            left = tokens.pop()[2], left, level(index + 1)
        return left

    tree = level(0)
    must(not tokens, f"`{text}` goes on where it should end")
    return tree


class Ratio:
    """A quotient of polynomials in the parameter, with rational coefficients: it is zero or not."""

    def __init__(self, over, under=fmpq_poly([1])):
        self.over, self.under = fmpq_poly(over) if isinstance(over, int) else over, under

    def __add__(self, other):
        other = ratio(other)
        return Ratio(self.over * other.under + other.over * self.under, self.under * other.under).lowest()

    def __mul__(self, other):
        other = ratio(other)
        return Ratio(self.over * other.over, self.under * other.under).lowest()

    def __truediv__(self, other):
        other = ratio(other)
        must(other, "a division by zero")
        return Ratio(self.over * other.under, self.under * other.over).lowest()

    def lowest(self):
        common = self.over.gcd(self.under)
        return Ratio(self.over // common, self.under // common)

    __radd__, __rmul__ = __add__, __mul__
    __neg__ = lambda self: Ratio(-self.over, self.under)
    __sub__ = lambda self, other: self + -ratio(other)
    __rsub__ = lambda self, other: ratio(other) - self
    __rtruediv__ = lambda self, other: ratio(other) / self
    __bool__ = lambda self: self.over != 0

    def whole(self):
        constant = self.over / self.under[0] if self.under.degree() == 0 else None
        if constant is None or constant.degree() > 0 or constant[0].q != 1:
            return None
        return int(constant[0].p)


def ratio(number):
    """A number as a quotient."""
    return number if isinstance(number, Ratio) else Ratio(fmpq_poly([number]))


class Field:
    """Where coefficients come from: balls, or quotients of polynomials in the parameter."""

    def __init__(self, posed, parameter):
        self.exact = isinstance(parameter, Ratio)
        names, varies = list(posed["system"]["parameters"]), int(posed["parameter"])
        must(len(names) == len(posed["values"]) and varies < len(names), "there is not a value for every parameter")
        given = {name: self.number(text) for name, text in zip(names, posed["values"])}
        self.names = given | {names[varies]: parameter}
        if not self.exact:
            self.names["pi"] = acb.pi()

    def number(self, text):
        if not self.exact:
            return decimal(text)
        value = Fraction(text)
        return Ratio(fmpq_poly([fmpq(value.numerator, value.denominator)]))

    def function(self, name, x):
        must(name in FUNCTIONS, f"`{name}` is no function")
        if self.exact:
            if not x and name in ("sin", "tan", "sqrt", "abs", "tanh", "cos", "exp"):
                return Ratio(int(name in ("cos", "exp")))
            raise NotCovered(f"signs where coefficients have {name}")
        if name == "abs":
            must(not x.real.contains(0), "an absolute value of what may be zero")
            return x if x.real > 0 else -x
        return x.log() if name == "ln" else getattr(x, name)()

    def power(self, x, n):
        if isinstance(n, int):
            return x**n if not self.exact else self.whole_power(x, n)
        if self.exact:
            raise NotCovered("signs where coefficients have powers that are not whole")
        return (n * x.log()).exp()

    @staticmethod
    def whole_power(x, n):
        power = Ratio(1)
        for _ in range(abs(n)):
            power = power * x
        return power if n >= 0 else 1 / power

    def whole(self, x):
        """The whole number that it is, or None."""
        if self.exact:
            return x.whole()
        found = x.real.unique_fmpz() if x.imag == 0 and x.real.is_exact() else None
        return None if found is None else int(found)


class Form:
    """Σ aᵢxᵢ + c + Σ (cₕ cos hφ + sₕ sin hφ), and a multiple of φ on its way into cos and sin."""

    def __init__(self, states=None, waves=None, phase=0):
        self.states, self.waves, self.phase = states or {}, waves or {}, phase

    def over(self, change):
        apply = lambda terms: {key: change(value) for key, value in terms.items()}
        return Form(apply(self.states), apply(self.waves), self.phase)

    def plus(self, other):
        join = lambda a, b: {key: a.get(key, 0) + b.get(key, 0) for key in {**a, **b}}
        return Form(join(self.states, other.states), join(self.waves, other.waves), self.phase + other.phase)

    def constant(self):
        """Its value where it has no state and no phase, else None."""
        plain = not self.states and not self.phase and set(self.waves) <= {(0, 0)}
        return self.waves.get((0, 0), 0) if plain else None

    def times(self, other, field):
        one, two = self.constant(), other.constant()
        if one is None and two is None:
            must(not (self.states or other.states or self.phase or other.phase), "a product of what moves")
            return self.mixed(other)
        form, factor = (self, two) if two is not None else (other, one)
        result = form.over(lambda value: value * factor)
        if form.phase:
            whole = field.whole(factor) if not isinstance(factor, int) else factor
            must(whole is not None, "the phase times what is no whole number")
            result.phase = form.phase * whole
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
                        result = result.plus(Form(waves={key: value}))
        return result


def evaluate(tree, names, field):
    """The form of a tree, where names stand for forms."""
    kind, *parts = tree
    if kind == "number":
        return Form(waves={(0, 0): field.number(parts[0])})
    if kind == "name":
        must(parts[0] in names, f"`{parts[0]}` stands for nothing that is covered")
        return names[parts[0]]
    if kind == "neg":
        form = evaluate(parts[0], names, field).over(lambda value: -value)
        return Form(form.states, form.waves, -form.phase)
    if kind == "call":
        inner = evaluate(parts[1], names, field)
        plain = Form(inner.states, inner.waves).constant()
        must(plain is not None, "a function of what moves")
        at = lambda name: field.function(name, plain * 1 if not isinstance(plain, int) else field.number(str(plain)))
        if not inner.phase:
            return Form(waves={(0, 0): at(parts[0])})
        must(parts[0] in ("sin", "cos"), "the phase outside of sin and cos")
        m, cosine, sine = inner.phase, at("cos"), at("sin")
        first, second = (cosine, -sine) if parts[0] == "cos" else (sine, cosine)
        return Form(waves={(abs(m), 0): first, (abs(m), 1): second if m > 0 else -second})
    left, right = (evaluate(part, names, field) for part in parts)
    if kind in "+-":
        return left.plus(right if kind == "+" else evaluate(("neg", parts[1]), names, field))
    if kind == "*":
        return left.times(right, field)
    value = right.constant()
    must(value is not None, "a division by what moves, or its power")
    if kind == "/":
        return left.times(Form(waves={(0, 0): 1 / value}), field)
    base, n = left.constant(), field.whole(value)
    if base is not None:
        return Form(waves={(0, 0): field.power(base, n if n is not None else value)})
    must(n is not None and n >= 0, "a power of what moves")
    power = Form(waves={(0, 0): field.number("1")})
    for _ in range(n):
        power = power.times(left, field)
    return power


# ---------------------------------------------------------------------------------------------------- systems
def combine(row, matrix):
    """Σ aᵢ·row i of a matrix."""
    return [sum((a * line[j] for a, line in zip(row, matrix) if not is_nought(a)), 0) for j in range(len(matrix[0]))]


def is_nought(x):
    return isinstance(x, int) and x == 0


def zero(x):
    """Whether a number is exactly zero."""
    return x == 0 if isinstance(x, int) else not x


class Modes:
    """The modes of a system: ż = Mz, z = (x, 1, cos φ, sin φ, …), with guards, exits and resets as forms of z."""

    def __init__(self, posed, field, plan=None):
        system = posed["system"]
        self.states, self.field = list(system["states"]), field
        n = self.count = len(self.states)
        names = {name: Form(waves={(0, 0): value}) for name, value in field.names.items()}
        forced = system.get("forcing")
        self.omega = evaluate(read(forced), names, field).constant() if forced else 0
        names |= {name: Form(states={index: field.number("1")}) for index, name in enumerate(self.states)}
        if forced:
            names["phase"] = Form(phase=1)
        for name, text in system.get("define", {}).items():
            names[name] = evaluate(read(text), names, field)
        form = lambda text: evaluate(read(text), names, field)
        self.names = list(system["modes"])
        written = [
            (
                [form(mode["rates"][state]) for state in self.states],
                [
                    (
                        form(switch["zero"]),
                        self.names.index(switch["to"]),
                        {self.states.index(name): form(text) for name, text in switch.get("reset", {}).items()},
                        [form(text) for text in switch.get("if", [])],
                    )
                    for switch in mode.get("until", [])
                ],
            )
            for mode in system["modes"].values()
        ]
        every = [it for rates, switches in written for it in rates]
        every += [it for _, switches in written for zero, _, reset, held in switches for it in [zero, *reset.values(), *held]]
        must(not any(it.phase for it in every), "the phase outside of sin and cos")
        self.harmonics = max((h for it in every for h, _ in it.waves), default=0)
        self.size = n + 1 + 2 * self.harmonics
        self.matrices, self.guards, self.surfaces = [], [], []
        # which switches share a guard, and where sliding fields point: decided in exact numbers
        self.plan = plan if plan is not None else {"groups": [], "pivots": []}
        for index, (rates, switches) in enumerate(written):
            rows = [self.row(rate) for rate in rates] + [[0] * self.size for _ in range(n, self.size)]
            for h in range(1, self.harmonics + 1):
                cosine = n + 2 * h - 1
                rows[cosine][cosine + 1], rows[cosine + 1][cosine] = -h * self.omega, h * self.omega
            self.matrices.append(rows)
            self.surfaces.append(None)
            zeros = [self.row(it[0]) for it in switches]
            if plan is None:
                same = lambda a, b: all(zero(x - y) for x, y in zip(a, b))
                firsts = [next(j for j, other in enumerate(zeros) if same(row, other)) for row in zeros]
                self.plan["groups"].append([sorted(set(firsts)).index(first) for first in firsts])
            groups, guards = self.plan["groups"][index], []
            for group, row, (_, to, reset, held) in zip(groups, zeros, switches):
                if group == len(guards):
                    guards.append((row, []))
                new = [self.row(reset[i]) if i in reset else self.unit(i) for i in range(n)]
                guards[group][1].append((to, new, [self.row(it) for it in held]))
            self.guards.append(guards)
        for index, sides in enumerate(system.get("sliding", {}).values()):
            self.slide(*(self.names.index(side) for side in sides), index, plan is None)
        self.names += list(system.get("sliding", {}))

    def unit(self, index):
        return [int(index == j) for j in range(self.size)]

    def row(self, form):
        row = [form.states.get(i, 0) for i in range(self.count)] + [form.waves.get((0, 0), 0)]
        for h in range(1, self.harmonics + 1):
            row += [form.waves.get((h, 0), 0), form.waves.get((h, 1), 0)]
        return row

    def slide(self, first, second, index, decides):
        """The sliding mode F₋ − d (n·F₋)/(n·d) of two modes, F₊ − F₋ keeping the direction d."""
        leads = lambda side, to: [k for k, (_, exits) in enumerate(self.guards[side]) if any(it[0] == to for it in exits)]
        ways = leads(first, second), leads(second, first)
        must([len(way) for way in ways] == [1, 1], "two modes do not meet in one surface")
        (one,), (other,) = ways
        normal = self.guards[first][one][0]
        below, above = self.matrices[first], self.matrices[second]
        gaps = [[b - a for a, b in zip(low, high)] for low, high in zip(below, above)][: self.count]
        if decides:
            opposite = self.guards[second][other][0]
            must(all(zero(a + b) for a, b in zip(normal, opposite)), "two modes do not meet in one surface")
            pivot = next(((i, j) for i, gap in enumerate(gaps) for j, x in enumerate(gap) if not zero(x)), None)
            must(pivot, "two modes between which nothing slides are the same")
            i, j = pivot
            parallel = all(zero(x * gaps[i][j] - gap[j] * y) for gap in gaps for x, y in zip(gap, gaps[i]))
            must(parallel, "the difference of two fields changes its direction")
            self.plan["pivots"].append(pivot)
        i, j = self.plan["pivots"][index]
        along = [gap[j] / gaps[i][j] if not is_nought(gap[j]) else 0 for gap in gaps]
        toward, away = combine(normal, below), combine(normal, above)
        across = sum((a * d for a, d in zip(normal, along)), 0)
        rows = [[x - t * d / across for x, t in zip(line, toward)] for line, d in zip(below, along)]
        self.matrices.append(rows + below[self.count :])
        stay, own, ends = [self.unit(i) for i in range(self.count)], len(self.guards), [-x for x in toward]
        self.guards.append([(ends, [(first, stay, [])]), (away, [(second, stay, [])])])
        self.surfaces.append(normal)
        self.guards[first][one][1].insert(0, (own, stay, [away]))
        self.guards[second][other][1].insert(0, (own, stay, [ends]))

    def derivative(self, mode, row, order):
        for _ in range(order):
            row = combine(row, self.matrices[mode])
        return row


class Zeros:
    """Forms of z over the quotients that are zero together, in echelon form: pivot and row."""

    def __init__(self, rows=()):
        self.rows = []
        for row in rows:
            self.insert(row)

    def rest(self, row):
        for pivot, known in self.rows:
            factor = row[pivot]
            if not zero(factor):
                row = [x - factor * y for x, y in zip(row, known)]
        return row

    def have(self, row):
        return all(zero(x) for x in self.rest(row))

    def insert(self, row):
        row = self.rest(row)
        pivot = next((j for j, x in enumerate(row) if not zero(x)), None)
        if pivot is not None:
            row = [ratio(x) / row[pivot] if not zero(x) else 0 for x in row]
            self.rows = [(k, [x - known[pivot] * y for x, y in zip(known, row)]) for k, known in self.rows]
            self.rows.append((pivot, row))

    def along(self, matrix, surface):
        """Those that stay zero along a flow, row by row."""
        kept = [row for _, row in self.rows]
        while True:
            known = Zeros(kept)
            stays = lambda row: row is surface or known.have(combine(row, matrix))
            if surface is not None and known.have(surface) and surface not in kept:
                kept.append(surface)
            fewer = [row for row in kept if stays(row)]
            if len(fewer) == len(kept):
                return known
            kept = fewer

    def after(self, reset, size):
        """Those that are zero after a reset."""
        unit = lambda j: [int(j == k) for k in range(size)]
        whole = list(reset) + [unit(j) for j in range(len(reset), size)]
        new = [[a - b for a, b in zip(unit(i), row)] for i, row in enumerate(reset)]
        both = [row for _, row in self.rows] + new
        return Zeros(row for row in both if self.have(combine(row, whole)))


# ---------------------------------------------------------------------------------------------------- orbits
class Stretch:
    """A zone, or a part of one: `end` is ("exit", guard, exit), ("touch", guard) or ("never",)."""

    def __init__(self, zone, mode, end):
        self.zone, self.mode, self.end = zone, mode, end


class Orbit:
    """The boundary-value problem of an orbit and what singles out a point."""

    def __init__(self, posed, near, condition):
        self.posed, self.condition = posed, condition
        self.kind = condition if isinstance(condition, str) else condition.name
        margin = condition.value if self.kind == "Margin" else {}
        watch = margin.get("watch")
        self.watch = watch if watch is None or isinstance(watch, str) else watch.name
        self.which = None if isinstance(watch, str) or watch is None else int(watch.value)
        self.zone, sequence, zones = int(margin.get("zone", -1)), near["sequence"], near["zones"]
        sequence = sequence[0] if isinstance(sequence, tuple) else sequence
        must(sequence and len(sequence) == len(zones), "zones without a state")
        self.forced, self.periods = posed["system"].get("forcing") is not None, int(posed["periods"])
        exact = Field(posed, Ratio(fmpq_poly([0, 1])))
        self.exact = Modes(posed, exact)
        self.n, self.stretches, self.guess = self.exact.count, [], []
        middle = self.modes(decimal(repr(float(near["parameter"]))))
        for index, (zone, at) in enumerate(zip(sequence, zones)):
            mode, way = int(zone["mode"]), zone["way"]
            must(0 <= mode < len(middle.names) and zone["name"] == middle.names[mode], "a mode has another name")
            must(way is not None or len(zones) == 1 and self.forced, "a zone that does not end")
            end = ("never",) if way is None else ("exit", int(way["guard"]), int(way["exit"]))
            state, time = [acb(float(x)) for x in at["state"]], float(at["duration"])
            must(len(state) == self.n, "a zone has not as many states as the system")
            if self.watch == "Inside" and index == self.zone:
                first = float(margin["time"])
                must(0 < first < time, "a guard is touched outside of its zone")
                self.stretches.append(Stretch(index, mode, ("touch", self.which)))
                self.guess += state + [acb(first)]
                z = self.lift(middle, state, acb(float(at["phase"])))
                state = self.flow(middle, mode, acb(first), z)[: self.n]
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
        if self.forced:
            self.guess.append(acb(float(zones[0]["phase"])))
        self.guess.append(acb(float(near["parameter"])))
        self.place = len(self.guess) - 1
        if self.kind == "Torus":
            self.guess.append(acb(float(condition.value["angle"])))
        self.fixed, self.events = None, []
        if self.kind == "Margin":
            self.events.append(self.vanishing(near))
        self.facts = self.known()

    def modes(self, parameter):
        return Modes(self.posed, Field(self.posed, parameter), self.exact.plan)

    def lift(self, modes, state, phase):
        z = list(state) + [acb(1)]
        for h in range(1, modes.harmonics + 1):
            z += [(h * phase).cos(), (h * phase).sin()]
        return z

    def turned(self, modes, z):
        turned = [acb(0)] * (self.n + 1)
        for h in range(1, modes.harmonics + 1):
            cosine, sine = z[self.n + 2 * h - 1], z[self.n + 2 * h]
            turned += [-h * sine, h * cosine]
        return turned

    def exponential(self, modes, mode, time):
        return acb_mat([[acb(x) * time for x in row] for row in modes.matrices[mode]]).exp()

    def flow(self, modes, mode, time, z):
        return (self.exponential(modes, mode, time) * acb_mat([[x] for x in z])).entries()

    def parts(self, x):
        x = x if self.fixed is None else [*x, self.fixed]
        return self.parts_at(x)

    def parts_at(self, x):
        """Modes, and (phase, duration, z at the entry, exp(MT), z at the end) of every stretch."""
        modes, parts = self.modes(x[self.place]), []
        phase = x[self.place - 1] if self.forced else acb(0)
        for index, stretch in enumerate(self.stretches):
            first = index * (self.n + 1)
            state, time = x[first : first + self.n], x[first + self.n]
            z, step = self.lift(modes, state, phase), self.exponential(modes, stretch.mode, time)
            parts.append((phase, time, z, step, (step * acb_mat([[y] for y in z])).entries()))
            phase = phase + modes.omega * time
        return modes, parts

    def equations(self, x):
        """Entries, ends, the period of the forcing and what singles out the point."""
        modes, parts = self.parts(x)
        dot = lambda row, z: sum((a * y for a, y in zip(row, z) if not is_nought(a)), acb(0))
        out, count = [], len(parts)
        for index, (stretch, (*_, end)) in enumerate(zip(self.stretches, parts)):
            kind, *where = stretch.end
            guards = modes.guards[stretch.mode]
            reset = guards[where[0]][1][where[1]][1] if kind == "exit" else [modes.unit(i) for i in range(self.n)]
            out += [dot(row, end) - y for row, y in zip(reset, parts[(index + 1) % count][2])]
            if kind == "exit":
                out.append(dot(guards[where[0]][0], end))
            elif kind == "touch":
                out.append(dot(modes.derivative(stretch.mode, guards[where[0]][0], 1), end))
            else:
                out.append(parts[0][0])
        if self.forced:
            total = sum((part[1] for part in parts), acb(0))
            out.append(modes.omega * total - 2 * self.periods * acb.pi())
        if self.fixed is not None:
            return out
        if self.kind == "Value":
            out.append(x[self.place] - decimal(self.condition.value))
        elif self.kind == "Margin":
            index, at_end, row = self.events[0]
            out.append(dot(row(modes), parts[index][4 if at_end else 2]))
        elif self.kind == "Torus":
            back = self.returned(modes, parts)
            one, two = (self.distance(back, (acb(0, sign) * x[self.place + 1]).exp()) for sign in (1, -1))
            out += [(one + two) / 2, (one - two) / acb(0, 2)]
        else:
            out.append(self.distance(self.returned(modes, parts), acb(1 if self.kind == "Fold" else -1)))
        return out

    @staticmethod
    def distance(matrix, number):
        """det(P − μ)."""
        rows = matrix.tolist()
        return acb_mat([[x - number * int(i == j) for j, x in enumerate(row)] for i, row in enumerate(rows)]).det()

    def returned(self, modes, parts):
        """The linearised return P to the first entry, in the states and the phase."""
        n, width = self.n, self.n + int(self.forced)
        unit = lambda i, j: acb(int(i == j))
        product = acb_mat([[unit(i, j) for j in range(width)] for i in range(width)])
        linear = lambda rows, z: [
            [acb(x) for x in row[:n]]
            + ([sum((a * y for a, y in zip(row, self.turned(modes, z))), acb(0))] if self.forced else [])
            for row in rows
        ]
        last = [[acb(0)] * n + [acb(1)]] if self.forced else []
        for stretch, (_, _, z, step, end) in zip(self.stretches, parts):
            product = acb_mat(linear(step.tolist()[:n], z) + last) * product
            if stretch.end[0] != "exit":
                continue
            row, exits = modes.guards[stretch.mode][stretch.end[1]]
            (normal,) = linear([row], end)
            rate = [sum((a * y for a, y in zip(line, end)), acb(0)) for line in modes.matrices[stretch.mode][:n]]
            rate += [modes.omega] if self.forced else []
            fall = sum((a * y for a, y in zip(normal, rate)), acb(0))
            onto = acb_mat([[unit(i, j) - rate[i] * normal[j] / fall for j in range(width)] for i in range(width)])
            jump = acb_mat(linear(exits[stretch.end[2]][1], end) + last)
            product = jump * onto * product
        if self.stretches[-1].end[0] == "never":
            product = acb_mat([row[:n] for row in product.tolist()[:n]])
        return product

    # ------------------------------------------------------------------------------------------------ what is zero
    def known(self):
        """What is zero at the entry and at the end of every stretch, whatever the parameter."""
        facts = [[Zeros(), Zeros()] for _ in self.stretches]

        def add(zeros, index, at_end):
            for place, side, row in self.events:
                if (place, side) == (index, at_end):
                    zeros.insert(row(self.exact))

        while True:
            before = [len(zeros.rows) for pair in facts for zeros in pair]
            for index, stretch in enumerate(self.stretches):
                exact, mode = self.exact, stretch.mode
                add(facts[index][0], index, False)
                end = facts[index][0].along(exact.matrices[mode], exact.surfaces[mode])
                follower = facts[(index + 1) % len(facts)]
                kind, *where = stretch.end
                if kind == "never":
                    facts[index][1] = end
                    continue
                row, exits = exact.guards[mode][where[0]]
                end.insert(row if kind == "exit" else exact.derivative(mode, row, 1))
                add(end, index, True)
                facts[index][1] = end
                follower[0] = end.after(exits[where[1]][1], exact.size) if kind == "exit" else Zeros(r for _, r in end.rows)
                add(follower[0], (index + 1) % len(facts), False)
            if [len(zeros.rows) for pair in facts for zeros in pair] == before:
                return facts

    def order(self, zeros, mode, row):
        """The least order of a derivative that is not known to be zero, or None."""
        for order in range(self.exact.size + 1):
            if not zeros.have(row):
                return order
            row = combine(row, self.exact.matrices[mode])
        return None

    def vanishing(self, near):
        """The stretch, whether at its end, and the form of the margin that vanishes."""
        must(0 <= self.zone < len(near["zones"]), "a margin of no zone")
        index = next(i for i, stretch in enumerate(self.stretches) if stretch.zone == self.zone)
        stretch, which, facts = self.stretches[index], self.which, self.known()[index]
        mode = stretch.mode
        guard = lambda k, order: lambda modes: modes.derivative(mode, modes.guards[mode][k][0], order)
        if self.watch == "Inside":
            return index, True, guard(which, 0)
        must(self.watch in ("Onset", "End", "Speed", "Condition", "Before"), "a margin that is not treated")
        must(stretch.end[0] == "exit", "a margin of a switch that there is not")
        own, exit = stretch.end[1:]
        if self.watch == "Speed":
            return index, True, guard(own, 1)
        if self.watch in ("Onset", "End"):
            at_end = self.watch == "End"
            order = self.order(facts[at_end], mode, self.exact.guards[mode][which][0])
            must(order is not None, "a guard that is zero all along vanishes")
            return index, at_end, guard(which, order)
        taken = exit if self.watch == "Condition" else which
        held = self.exact.guards[mode][own][1][taken][2]
        if self.watch == "Before":
            must(which < exit, "an exit that is not before the one taken")
            open_ones = [k for k, row in enumerate(held) if not facts[1].have(row)]
            must(len(open_ones) == 1, "an exit with several conditions")
            which = open_ones[0]
        return index, True, lambda modes: modes.guards[mode][own][1][taken][2][which]

    # ------------------------------------------------------------------------------------------------ symmetry
    def mirror(self, x):
        """Puts what vanishes in the other half of a symmetric orbit to the events: −x half a period later, with the
        phase half a turn on. For every value of the parameter near the event there is one orbit only in a ball with this
        one and its image; so it is its image."""
        count, n, exact = len(self.stretches), self.n, self.exact
        if count % 2 or not self.events or self.forced and self.periods % 2 == 0:
            return False
        flips = [-1] * n + [1] + [(-1) ** h for h in range(1, exact.harmonics + 1) for _ in range(2)]
        same = lambda a, b: all(zero(u * flip - v) for u, v, flip in zip(a, b, flips))
        block = lambda a, b: all(same([u * flips[i] for u in one], two) for i, (one, two) in enumerate(zip(a, b)))
        for one, two in zip(self.stretches, self.stretches[count // 2 :] + self.stretches[: count // 2]):
            if one.end[0] != "exit" or two.end[0] != "exit":
                return False
            (row, exits), (image, ways) = exact.guards[one.mode][one.end[1]], exact.guards[two.mode][two.end[1]]
            matrices = exact.matrices[one.mode], exact.matrices[two.mode]
            if not (same(row, image) and block(exits[one.end[2]][1], ways[two.end[2]][1]) and block(*matrices)):
                return False
        index, at_end, row = self.events[0]
        other = (index + count // 2) % count
        wanted = row(exact)
        held = [it for guard in exact.guards[self.stretches[other].mode] for way in guard[1] for it in way[2]]
        found = [it for it in held if same(wanted, it)]
        if not found:
            return False
        self.fixed = acb(arb(x[self.place].real.mid(), arb(2) ** -200))
        try:
            zero_there, radius = prove_zero(self.equations, [y.mid() for y in x[: self.place]])
        finally:
            self.fixed = None
        image, half = list(x[: self.place]), n + 1
        for place in range(count):
            start = (place + count // 2) % count * half
            image[place * half : (place + 1) * half] = [-y for y in x[start : start + n]] + [x[start + n]]
        if self.forced:
            modes, parts = self.parts(x)
            image[self.place - 1] = parts[count // 2][0] - self.periods * acb.pi()
        near = lambda orbit: all(abs(a - b) < 4 * radius for a, b in zip(orbit, zero_there))
        if not (near(x) and near(image)):
            return False
        self.events.append((other, at_end, lambda modes: found[0]))
        self.facts = self.known()
        return True

    # ------------------------------------------------------------------------------------------------ signs
    def all_signs(self, x):
        """Every inequality with whether it holds."""
        modes, parts = self.parts(x)
        at = lambda row, z: sum((acb(a) * y for a, y in zip(row, z)), acb(0)).real
        for index, (stretch, (_, time, z, _, end)) in enumerate(zip(self.stretches, parts)):
            mode, zone = stretch.mode, stretch.zone
            entry_facts, end_facts = self.facts[index]
            yield f"the duration of zone {zone}", time.real > 0
            for guard, (row, _) in enumerate(modes.guards[mode]):
                exact = self.exact.guards[mode][guard][0]
                start = self.order(entry_facts, mode, exact)
                if start is None:
                    continue
                stop = self.order(end_facts, mode, exact) or 0
                holds = self.positive(modes, mode, row, z, start, time.real / 2, 1)
                holds = holds and self.positive(modes, mode, row, end, stop, time.real / 2, -1)
                yield f"guard {guard} within zone {zone}", holds
            if stretch.end[0] != "exit":
                continue
            exits = modes.guards[mode][stretch.end[1]][1]
            exact = self.exact.guards[mode][stretch.end[1]][1]
            for which, (row, formula) in enumerate(zip(exits[stretch.end[2]][2], exact[stretch.end[2]][2])):
                yield f"condition {which} at the end of zone {zone}", end_facts.have(formula) or at(row, end) > 0
            for before in range(stretch.end[2]):
                rows = list(zip(exits[before][2], exact[before][2]))
                # what is about to lead there is zero at the event, and the rest does not say that it fails
                about = [row(self.exact) for place, at_end, row in self.events if at_end and place == index]
                if any(formula is it for it in about for _, formula in rows):
                    continue
                fails = any(not end_facts.have(formula) and at(row, end) < 0 for row, formula in rows)
                yield f"that exit {before} is not taken at the end of zone {zone}", fails

    def positive(self, modes, mode, row, z, order, length, sign):
        """Whether a form is positive from a zero of this order, at z, to a time in one direction."""
        bits, ctx.prec = ctx.prec, SIGNS
        try:
            # backwards in time the flow is that of −M
            matrix = acb_mat([[sign * acb(x) for x in line] for line in modes.matrices[mode]])
            form, state = acb_mat([[acb(x) for x in row]]), acb_mat([[y] for y in z])
            end = float(length.upper()) * (1 + 2**-40)
            first = end
            for _ in range(DEPTH):
                if order == 0 or self.over(matrix, form, state, 0, first, order):
                    break
                first /= 2
            else:
                return False
            open_ones = [(first if order else 0.0, end, 0)]
            while open_ones:
                low, high, depth = open_ones.pop()
                if low >= high or self.over(matrix, form, state, low, high, 0):
                    continue
                if depth == DEPTH:
                    return False
                middle = (low + high) / 2
                open_ones += [(low, middle, depth + 1), (middle, high, depth + 1)]
            return True
        finally:
            ctx.prec = bits

    @staticmethod
    def over(matrix, form, state, low, high, order):
        """Whether f(t)/(t − low)^order is positive from low to high, f's Taylor polynomial from low with the rest of
        Lagrange over all of it."""
        span = arb(high) - arb(low)
        if span * max(float(abs(x).upper()) for x in matrix.entries()) > 4:
            return False
        start = (matrix * acb(low)).exp() * state if low else state
        every = (matrix * acb(arb(0).union(span))).exp() * start
        total, factor, step, power = arb(0), form, arb(0).union(span), arb(1)
        factorial = 1
        for k in range(TAYLOR + order + 1):
            factorial *= max(k, 1)
            last = k == TAYLOR + order
            if k >= order:
                value = (factor * (every if last else start)).entries()[0].real / factorial
                total, power = total + value * power, power * step
            factor = factor * matrix
        return bool(total > 0)


def kind_of(point, proof):
    """Type of a point by what singles it out."""
    condition, changed = proof["condition"], proof.get("changed")
    name = condition if isinstance(condition, str) else condition.name
    if name == "Value":
        return point["kind"] if point["kind"] in ("UZ", "EP") else "UZ or EP"
    if name != "Margin":
        return {"Fold": "LP", "Doubling": "PD", "Torus": "NS"}[name]
    must(changed is not None, "it is not said what changes")
    zones = lambda it: [(int(z["mode"]), z["way"] and (int(z["way"]["guard"]), int(z["way"]["exit"]))) for z in it]
    listed = lambda it: zones(it[0] if isinstance(it, tuple) else it)
    before, near = listed(changed["before"]), listed(proof["near"]["sequence"])
    after = changed["after"] and listed(changed["after"])
    watch = changed["watch"] if isinstance(changed["watch"], str) else changed["watch"].name
    seen, there = condition.value["watch"], changed["watch"]
    same = near == before and seen == there and condition.value["zone"] == changed["zone"]
    shorter = watch not in ("Inside", "Speed") and len(near) < len(before)
    must(same or shorter, "the change is another than what is proven")
    if watch in ("Inside", "Speed"):
        return "GR"
    if after is None:
        return "SL" if watch in ("Condition", "Before") else "CO"
    if splits(before, after) or splits(after, before):
        return "GR"
    keys = {(mode, way[0]) for mode, way in before if way}
    taken = lambda it, key: sorted(way[1] for mode, way in it if way and (mode, way[0]) == key)
    pairs = [(taken(before, key), taken(after, key)) for key in keys]
    return "SL" if any(len(a) == len(b) and a != b for a, b in pairs) else "CO"


def splits(short, long):
    """Whether one zone of a sequence is cut in two in another, with others between."""
    if len(short) == 1 and short[0][1] is None:
        return any(mode == short[0][0] for mode, _ in long)
    more = len(long) - len(short)
    if more <= 0:
        return False
    at = lambda it, k: it[k % len(it)]
    fits = lambda shift, start: (
        at(long, start)[0] == at(short, shift)[0]
        and at(long, start + more) == at(short, shift)
        and all(at(short, shift + k) == at(long, start + more + k) for k in range(1, len(short)))
    )
    return any(fits(shift, start) for shift in range(len(short)) for start in range(len(long)))


class OrbitPoint:
    """A point that is said to be proven, with the problem and the row of the table that belong to it."""

    def __init__(self, point, source, row, helpers):
        self.point, self.source, self.row, (self.between, self.inside) = point, source, row, helpers
        self.proof = point["outcome"].value
        self.posed, self.said = self.proof["posed"], self.proof["statement"]

    def statements(self):
        """Names of the statements and what checks them."""
        yield "orbit, in its intervals", self.orbit
        yield "numbers of the problem", self.numbers
        yield "type", self.type
        yield "inequalities", self.inequalities
        if self.said.get("outside") is not None:
            yield "multipliers outside the unit circle", self.outside
        yield f"no other within {float(self.said['unique']):.0e}", self.unique
        yield "row of certificates.csv", self.table

    def orbit(self):
        orbit = Orbit(self.posed, self.proof["near"], self.proof["condition"])
        names = list(self.posed["system"]["parameters"])
        must(names[int(self.posed["parameter"])] == self.point["parameter"], "its equations vary another parameter")
        middle, radius = prove_zero(orbit.equations, orbit.guess)
        # real equations and a real guess: the zero is real
        self.x = [acb(arb(y.real, radius)) for y in middle]
        self.solved = orbit
        times = [self.x[k * (orbit.n + 1) + orbit.n].real for k in range(len(orbit.stretches))]
        given = orbit.kind == "Value"
        self.value = decimal(orbit.condition.value).real if given else self.x[orbit.place].real
        self.period = sum(times, arb(0))
        found = [("the parameter", self.value, self.said["parameter"]), ("the period", self.period, self.said["period"])]
        if orbit.kind == "Torus":
            self.angle = self.x[orbit.place + 1].real
            found.append(("the angle", self.angle, self.said["angle"]))
        for what, ball, interval in found:
            must(self.between(ball, interval), f"{what} is {ball.str(20, radius=False)}")

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
            ends = [low, high, given[self.point["parameter"]]]
            asked = continuation.get("stop_at", []) if self.point["kind"] == "UZ" else ends
            listed = Fraction(self.proof["condition"].value) in [Fraction(value.text) for value in asked]
            must(listed or "stop_after" in continuation, "the value is not asked for in the problem")

    def type(self):
        found = kind_of(self.point, self.proof)
        must(found == self.point["kind"], f"what vanishes there makes it {found}")

    def inequalities(self):
        wrong = [what for what, holds in self.solved.all_signs(self.x) if not holds]
        if wrong and self.solved.mirror(self.x):
            wrong = [what for what, holds in self.solved.all_signs(self.x) if not holds]
        must(not wrong, f"{', '.join(wrong)} is not shown")

    def outside(self):
        orbit = self.solved
        must(orbit.kind == "Value", "multipliers are counted at values of the parameter")
        matrix = orbit.returned(*orbit.parts(self.x))
        try:
            values = matrix.eig(multiple=True)
        except ValueError:
            raise NotCovered("multipliers that cannot be told apart") from None
        sizes = [abs(value) for value in values]
        must(all(size < 1 or size > 1 for size in sizes), "a multiplier is on the circle")
        found = sum(bool(size > 1) for size in sizes)
        must(found == int(self.said["outside"]), f"{found} are outside")

    def unique(self):
        raise NotCovered("the distance to other orbits; the solution is regular")

    def table(self):
        if self.row is None:
            raise NotCovered("a certificate without its table")
        row, point = self.row, self.point
        named = [str(int(point["label"])), point["kind"], point["parameter"], "yes"]
        must([row[name] for name in ("label", "type", "parameter", "proven")] == named, "it is of another point")
        must(self.inside(self.value, row["low"], row["high"]), "the parameter is not in its interval")
        must(self.inside(self.period, row["period_low"], row["period_high"]), "the period is not in its interval")
        if self.solved.kind == "Torus":
            must(self.inside(self.angle, row["angle_low"], row["angle_high"]), "the angle is not in its interval")
        must(float(row["unique"]) == self.said["unique"], "`unique` is not that of the certificate")
        must(int(row["inequalities"]) == self.said["inequalities"], "`inequalities` is not that of the certificate")
        outside = self.said.get("outside")
        must(row["outside"] == ("" if outside is None else str(int(outside))), "`outside` is not that of the certificate")
