"""Equilibria of systems of one's own in balls of Arb (python-flint): their equations, zeros of them that are proven, guards,
eigenvalues, first Lyapunov coefficients.

Written from docs/systems.md, docs/equilibria.md and docs/contacts.md, apart from the program. check.py says what it is for. Unknowns are
the states, in a sliding mode the share of its second field, the forces of contacts, the parameter and, at a Hopf point, the frequency, all in
their units. No eigenvector is among them: folds and Hopf points are zeros of a determinant.
"""

import ast
from fractions import Fraction

from flint import acb, acb_mat, acb_poly, arb

from .ball_contacts import FIELDS, STATES
from .ball_orbits import FUNCTIONS, counted, parsed
from .balls import Dual, NotCovered, Refused, Tagged, bare, decimal, determinant, double, dual, exact, injective, jacobian, must, prove_zero, real, whole

MOST_FACTORS = 64
"""Whole exponents up to this are products."""


# ---------------------------------------------------------------------------------------------------- expressions
class Formula:
    """A sum of products of names with rational factors; quotients and functions are names of their own. Two that are written as one
    sum are the same number."""

    def __init__(self, terms=None):
        self.terms = {key: factor for key, factor in (terms or {}).items() if factor}

    @staticmethod
    def named(name):
        return Formula({(name,): Fraction(1)})

    @staticmethod
    def number(text):
        return Formula({(): exact(text) if isinstance(text, str) else Fraction(text)})

    def __add__(self, other):
        terms = dict(self.terms)
        for key, factor in other.terms.items():
            terms[key] = terms.get(key, 0) + factor
        return Formula(terms)

    def __mul__(self, other):
        terms = {}
        for one, a in self.terms.items():
            for two, b in other.terms.items():
                key = tuple(sorted(one + two))
                terms[key] = terms.get(key, 0) + a * b
        return Formula(terms)

    __neg__ = lambda self: self * Formula.number(-1)
    __sub__ = lambda self, other: self + -other
    __bool__ = lambda self: bool(self.terms)
    __str__ = lambda self: "(" + "+".join(f"{factor}*{'*'.join(key)}" for key, factor in sorted(self.terms.items())) + ")"

    def constant(self):
        """The number that it is, or None."""
        return self.terms.get((), Fraction(0)) if set(self.terms) <= {()} else None

    def __truediv__(self, other):
        by = other.constant()
        return self * (Formula.number(1 / by) if by else Formula.named(f"1/{other}"))

    def __pow__(self, other):
        n = other.constant()
        if n is None or n != int(n) or not 0 <= n <= MOST_FACTORS:
            return Formula.named(f"{self}^{other}")
        power = Formula.number(1)
        for _ in range(int(n)):
            power = power * self
        return power


class Degree:
    """How an expression depends on the states as it is written: 0 not, 1 by an affine form, 2 in some other way."""

    def __init__(self, degree):
        self.degree = degree

    @staticmethod
    def number(_):
        return Degree(0)

    __add__ = __sub__ = lambda self, other: Degree(max(self.degree, other.degree))
    __mul__ = lambda self, other: Degree(min(self.degree + other.degree, 2))
    __neg__ = lambda self: self
    __truediv__ = lambda self, other: self if not other.degree else Degree(2)
    __pow__ = lambda self, other: Degree(2 if self.degree or other.degree else 0)


def applied(name, x):
    """A function of a ball, of a number with derivatives, of a formula or of a degree."""
    if isinstance(x, Degree):
        return Degree(2 if x.degree else 0)
    if isinstance(x, Formula):
        return Formula.named(f"{name}{x}")
    if name == "abs":
        value = bare(x)
        if not (real(value) > 0 or real(value) < 0):
            raise NotCovered("the modulus of what may be zero")
        return x if real(value) > 0 else -x
    if isinstance(x, Dual):
        value = applied(name, x.v)
        _, slope = FUNCTIONS[name]
        return Dual(value, x.d * slope(x.v, value, applied))
    if name in ("ln", "sqrt") and not (acb(x).real > 0):
        raise NotCovered(f"{name} of what may not be positive")
    if name in ("asin", "acos") and not (abs(acb(x)) < 1):
        raise NotCovered(f"{name} of what may not be less than 1")
    return getattr(acb(x), {"ln": "log"}.get(name, name))()


def raised(x, exponent):
    """A power: a product where the exponent is a whole number whatever else is."""
    if isinstance(x, (Formula, Degree)):
        return x**exponent
    n = None
    if not isinstance(exponent, Dual) and exponent.imag == 0 and exponent.real.is_integer():
        n = int(float(exponent.real))
    if n is None or abs(n) > MOST_FACTORS:
        return applied("exp", exponent * applied("ln", x))
    power = acb(1)
    for _ in range(abs(n)):
        power = power * x
    return power if n >= 0 else 1 / power


def evaluated(text, names, number=decimal):
    """An expression, where names stand for balls, numbers with derivatives, formulas or degrees."""
    spelled, tree = parsed(text)

    def value(node):
        if isinstance(node, ast.Constant) and type(node.value) in (int, float):
            return number(ast.get_source_segment(spelled, node).replace("_", ""))
        if isinstance(node, ast.Name):
            must(names.get(node.id[1:]) is not None, f"`{node.id[1:]}` stands for nothing that is covered")
            return names[node.id[1:]]
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and not node.keywords:
            name, inner = node.func.id[1:], [value(it) for it in node.args]
            if name in ("min", "max") and len(inner) == 2:
                one, other = inner
                gap = applied("abs", one - other)
                return (one + other + (gap if name == "max" else -gap)) * number("0.5")
            must(name in FUNCTIONS and len(inner) == 1, f"`{name}` is no function")
            return applied(name, *inner)
        if isinstance(node, ast.UnaryOp):
            return -value(node.operand) if isinstance(node.op, ast.USub) else value(node.operand)
        must(isinstance(node, ast.BinOp), f"`{text}` cannot be read")
        one, other = value(node.left), value(node.right)
        if isinstance(node.op, ast.Pow):
            return raised(one, other)
        operators = {ast.Add: lambda: one + other, ast.Sub: lambda: one - other, ast.Mult: lambda: one * other, ast.Div: lambda: one / other}
        must(type(node.op) in operators, f"`{text}` cannot be read")
        return operators[type(node.op)]()

    return value(tree)


# ---------------------------------------------------------------------------------------------------- systems
class Rest:
    """The equilibria of a mode of a system, and what singles one of them out."""

    def __init__(self, posed, near, condition):
        system = self.system = posed["system"]
        must(not system.get("forcing"), "a system with forcing")
        self.posed, self.near, self.states = posed, near, list(system["states"])
        self.parameters, self.n = list(system["parameters"]), len(system["states"])
        must(len(posed["values"]) == len(self.parameters), "there is not a value for every parameter")
        self.varied = whole(posed["parameter"], len(self.parameters))
        contacts = system.get("contacts", {})
        must(len(near["state"]) == self.n and len(posed["units"]) == self.n + len(contacts) + 1, "there is not a number for every state")
        must(all(0 < double(unit) < float("inf") for unit in posed["units"]), "a unit that is no length")
        self.kind, self.condition = (condition, None) if isinstance(condition, str) else condition
        self.modes, sliding = list(system.get("modes", {})), system.get("sliding", {})
        self.touching, self.own = None, near["mode"]
        if contacts:
            self.own, self.touching = touching(contacts, self.modes, near["mode"])
        else:
            must(near["mode"] in self.modes or near["mode"] in sliding, f"`{near['mode']}` is no mode")
        self.sides = sliding.get(near["mode"])
        self.size = self.n + (len(contacts) or self.sides is not None)
        self.surface = None if self.sides is None else self.meeting(*self.sides)
        self.twins, self.guards = 0, []
        self.guards += self.watched()
        if self.kind == "Boundary":
            self.vanishing = whole(self.condition["guard"], len(self.guards))
        *each, last = map(double, posed["units"])
        self.units = [arb(it) for it in each + [1.0] * (self.size - len(each)) + [last]]
        if self.kind == "Hopf":
            self.units.append(arb(double(self.condition["omega"])))

    def meaning(self, y, parameter, pi, number=decimal):
        """What names stand for; None of abbreviations without a value."""
        names = dict(zip(self.parameters, map(number, self.posed["values"])))
        names |= {self.parameters[self.varied]: parameter, "pi": pi} | dict(zip(self.states, y))
        names |= {contact.name: force for contact, force in zip(self.touching or [], y[self.n :])}
        for name, text in self.system.get("define", {}).items():
            try:
                names[name] = evaluated(text, names, number)
            except (Refused, NotCovered):
                names[name] = None
        return names

    def formulas(self, replaced=()):
        """Names that stand for themselves, but for some states."""
        forces = [contact.name for contact in self.touching or []]
        named = {name: Formula.named(name) for name in [*self.states, *forces]} | dict(replaced)
        parameters = {name: Formula.named(name) for name in self.parameters}
        names = {**parameters, **named, "pi": Formula.named("pi")}
        for name, text in self.system.get("define", {}).items():
            names[name] = evaluated(text, names, Formula.number)
        return names

    def zero(self, at):
        """The `zero` of a switch of a mode."""
        mode, switch = at
        return self.system["modes"][mode]["until"][switch]["zero"]

    def formula(self, at, names=None):
        return evaluated(self.zero(at), names or self.formulas(), Formula.number)

    def switches(self, mode, to=None):
        until = self.system["modes"][mode].get("until", []) if mode in self.modes else []
        return [(mode, k) for k, switch in enumerate(until) if to is None or switch["to"] == to]

    def meeting(self, first, second):
        """The switches by which two modes lead to one another, the `zero` of the one minus that of the other."""
        pairs = ((a, b) for a in self.switches(first, second) for b in self.switches(second, first))
        found = next(((a, b) for a, b in pairs if not self.formula(a) + self.formula(b)), None)
        must(found is not None, "two modes do not meet in one surface")
        return found

    def watched(self):
        """What is positive at an equilibrium: of one formula once."""
        known, surface = [], []
        if self.sides is not None:
            yield from ("first", "second")
            surface = [self.formula(at) for at in self.surface]
        for contact in self.touching or []:
            yield from ((contact, k) for k in range(contact.guards()))
        for mode in self.sides or [self.own]:
            for at in self.switches(mode):
                formula = self.formula(at)
                if not all(formula - one for one in surface):
                    continue
                if all(formula - one for one in known):
                    known.append(formula)
                    yield at
                else:
                    self.twins += 1

    def rates(self, mode, names, number=decimal):
        """The rates of a mode; with contacts those of the user's mode, and what stretches Jenkins elements."""
        rates = self.system["modes"][mode]["rates"] if mode in self.modes else self.system["rates"]
        found = {state: evaluated(rates[state], names, number) for state in self.states if state in rates}
        for contact in self.touching or []:
            if contact.kind == "Jenkins":
                sticks = contact.state == "stick"
                found[contact.element] = evaluated(contact.law["slip"], names, number) if sticks else 0 * number("0")
        return [found[state] for state in self.states]

    def field(self, y, parameter):
        """The rates of the states."""
        names = self.meaning(y, parameter, acb(arb.pi()))
        if self.sides is None:
            return self.rates(self.own, names)
        below, above = (self.rates(side, names) for side in self.sides)
        return [one + y[self.n] * (other - one) for one, other in zip(below, above)]

    def moving(self, function, y, parameter):
        """The rate of a function of the states along the motion."""
        moved = [Dual(x, rate) for x, rate in zip(y, self.field(y, parameter))] + [Dual(x, 0) for x in y[self.n :]]
        return dual(function(moved, Dual(parameter, 0))).d

    def form(self, text):
        """An expression as a function of the unknowns."""
        return lambda y, parameter: evaluated(text, self.meaning(y, parameter, acb(arb.pi())))

    def speed(self, contact):
        """The slip of a contact, or the rate of its gap, as such a function."""
        held = self.form(contact.held)
        return held if "slip" in contact.law else lambda y, parameter: self.moving(held, y, parameter)

    def beside_law(self, k, y, parameter):
        """What a force is beside that of its law."""
        contact, value = self.touching[k], lambda text: self.form(text)(y, parameter)
        force, law = y[self.n + k], contact.law
        if contact.state in ("forward", "backward"):
            return force + value(law["bound"]) if contact.state == "forward" else force - value(law["bound"])
        if contact.kind == "Jenkins":
            return force + value(law["stiffness"]) * y[self.states.index(contact.element)]
        if contact.state == "open":
            return force
        damped = value(law["damping"]) * self.speed(contact)(y, parameter) if law.get("damping") is not None else 0
        return force + value(law["stiffness"]) * value(law["gap"]) + damped

    def rest(self, y, parameter):
        """Zero at an equilibrium."""
        rows = self.field(y, parameter)
        if self.sides is not None:
            rows.append(self.form(self.zero(self.surface[0]))(y, parameter))
        for k, contact in enumerate(self.touching or []):
            rows.append(self.form(contact.held)(y, parameter) if contact.holds else self.beside_law(k, y, parameter))
        return rows

    def followed(self, y, parameter):
        """Zero where the forces of contacts are what they are at these states."""
        rows = []
        for k, contact in enumerate(self.touching):
            rows.append(self.moving(self.speed(contact), y, parameter) if contact.holds else self.beside_law(k, y, parameter))
        return rows

    def guard(self, guard, y, parameter):
        if guard in ("first", "second"):
            return y[self.n] if guard == "first" else 1 - y[self.n]
        if not isinstance(guard[0], Contact):
            return self.form(self.zero(guard))(y, parameter)
        contact, place = guard
        force, value = y[self.n + self.touching.index(contact)], lambda text: self.form(text)(y, parameter)
        if contact.state in ("forward", "backward"):
            slip = value(contact.law["slip"])
            return slip if contact.state == "forward" else -slip
        if contact.state == "stick":
            least = (place == 0) == (contact.kind == "Jenkins")
            return value(contact.most) + force if least else value(contact.most) - force
        if contact.state == "open":
            return value(contact.law["gap"])
        return -value(contact.law["gap"]) if contact.kind == "Spring" and contact.law.get("damping") is None else force

    def matrix(self, y, parameter):
        """The derivatives of `rest` in the states, and in the share, as rows."""
        return self.slopes(self.rest, y, parameter)

    def slopes(self, functions, y, parameter):
        """Derivatives in the states and what else is unknown beside them, as rows."""
        columns = []
        for k in range(self.size):
            seeds = [Dual(x, int(j == k)) for j, x in enumerate(y)]
            columns.append([dual(row).d for row in functions(seeds, Dual(parameter, 0))])
        return [list(row) for row in zip(*columns)]

    def unscaled(self, z):
        """States and share, and the parameter."""
        y = [x * unit for x, unit in zip(z, self.units)]
        return y[: self.size], y[self.size]

    def shifted(self, matrix, number):
        """The linearisation less a number in its rates."""
        return [[x - number if i == j and i < self.n else x for j, x in enumerate(row)] for i, row in enumerate(matrix)]

    def equations(self, z):
        y, parameter = self.unscaled(z)
        rows = self.rest(y, parameter)
        if self.kind == "Value":
            return rows + [parameter - decimal(self.condition)]
        if self.kind == "Boundary":
            return rows + [self.guard(self.guards[self.vanishing], y, parameter)]
        matrix = self.matrix(y, parameter)
        if self.kind == "Fold":
            return rows + [determinant(matrix)]
        # real for real numbers, and zero where ± iω are eigenvalues
        omega = z[self.size + 1] * self.units[self.size + 1]
        one, other = (determinant(self.shifted(matrix, acb(0, sign) * omega)) for sign in (1, -1))
        return rows + [one + other, (one - other) * acb(0, -1)]

    def guess(self):
        state = [acb(double(x)) for x in self.near["state"]]
        parameter = acb(double(self.near["parameter"]))
        if self.sides is not None:
            below, above = self.pushes(state, parameter)
            state = state + [(below / (below - above)).mid()]
        if self.touching is not None:
            state = state + self.forces(state, parameter)
        found = [x / unit for x, unit in zip(state + [parameter], self.units)]
        return found + [acb(1)] * (self.kind == "Hopf")

    def forces(self, state, parameter):
        """The forces of contacts next to those at these states: Newton's method, of what is linear one step."""
        y = state + [acb(0)] * len(self.touching)
        for _ in range(8):
            rows = acb_mat([row[self.n :] for row in self.slopes(self.followed, y, parameter)])
            side = acb_mat([[-acb(row)] for row in self.followed(y, parameter)])
            try:
                step = rows.solve(side).entries()
            except ZeroDivisionError:
                raise Refused("the forces are not determined") from None
            y = state + [(x + by).mid() for x, by in zip(y[self.n :], step)]
        return y[self.n :]

    def pushes(self, state, parameter):
        """The rates of the surface along the fields of both modes."""
        names, found = self.meaning(state, parameter, acb(arb.pi())), []
        for side in self.sides:
            moved = [Dual(x, rate) for x, rate in zip(state, self.rates(side, names))]
            there = self.meaning(moved, Dual(parameter, 0), acb(arb.pi()))
            found.append(acb(dual(evaluated(self.zero(self.surface[0]), there)).d))
        return found

    def solve(self):
        """The zero of the equations, with unknowns in balls: states and share, the parameter and, at a Hopf point, the frequency."""
        self.found = prove_zero(self.equations, self.guess())
        middle, radius = self.found
        # real equations and a real guess: the zero is real
        z = [acb(arb(x.real, radius)) for x in middle]
        self.y, self.parameter = self.unscaled(z)
        if self.kind == "Value":
            self.parameter = decimal(self.condition)
        self.omega = (z[-1] * self.units[-1]).real if self.kind == "Hopf" else None
        return self.found

    def radii(self, zero, distance):
        """The box of a distance, in units."""
        return [arb(double(distance)) / self.units[self.size]] * len(zero.middle)

    def unique(self, zero, distance):
        """Less than 1 if there is no other equilibrium of the kind with its parameter within a distance, and its other unknowns within
        the same share of their units; vectors are no unknowns here, so that more is shown."""
        middle, radii = [acb(x.real) for x in zero.middle], self.radii(zero, distance)
        of = lambda box, _: jacobian(self.equations, [acb(x) for x in box])
        try:
            return injective(of, middle, radii, [self.size], told=[self.size] if self.kind == "Value" else [])
        except NotCovered:
            return arb("inf")

    def signs(self):
        """Every inequality, and whether it is shown."""
        names = self.meaning(self.y, self.parameter, acb(arb.pi()))
        for at in [at for mode in self.sides or [self.own] for at in self.switches(mode)]:
            # also of those that are one with another
            must(acb(evaluated(self.zero(at), names)).is_finite(), f"`{self.zero(at)}` has no value")
        for k, guard in enumerate(self.guards):
            if self.kind != "Boundary" or k != self.vanishing:
                name = guard if isinstance(guard, str) else guard[0].name if isinstance(guard[0], Contact) else self.zero(guard)
                yield f"that `{name}` is positive", bool(acb(self.guard(guard, self.y, self.parameter)).real > 0)
        if self.sides is not None:
            below, above = self.pushes(self.y[: self.n], self.parameter)
            yield "that fields push to the surface", bool((above - below).real > 0)
        if self.touching is not None:
            yield from self.laws()

    def laws(self):
        """That what holds works against what it holds whatever the others do, and that laws make sense."""
        rows = self.slopes(self.followed, self.y, self.parameter)
        try:
            inverse = acb_mat([row[self.n :] for row in rows]).inv().tolist()
        except ZeroDivisionError:
            raise Refused("the forces are not determined") from None
        for k, contact in enumerate(self.touching):
            if contact.holds:
                yield f"that `{contact.name}` holds", bool(inverse[k][k].real > 0)
        for k, contact in enumerate(self.touching):
            speed = self.speed(contact)
            rates = lambda y, parameter: [self.moving(speed, y, parameter), speed(y, parameter)]
            accelerated, moved = self.slopes(rates, self.y, self.parameter)
            must("slip" in contact.law or not any(moved[self.n :]), "the rate of a gap depends on a force")
            yield f"that `{contact.name}` acts against what it is about", bool(acb(accelerated[self.n + k]).real > 0)
            value = lambda text: acb(self.form(text)(self.y, self.parameter)).real
            for number in contact.not_negative(value):
                yield f"that a number of `{contact.name}` is not negative", bool(number >= 0)

    # ------------------------------------------------------------------------------------------------ eigenvalues
    def growing(self):
        """How many eigenvalues have a positive real part; the critical ones are 0 or ± iω."""
        rows, normals = self.matrix(self.y, self.parameter), []
        if self.sides is not None:
            normal, along = rows[self.n][: self.n], [row[self.n] for row in rows[: self.n]]
            inner = [row[: self.n] for row in rows[: self.n]]
            across = sum(a * d for a, d in zip(normal, along))
            fall = [sum(a * row[j] for a, row in zip(normal, inner)) for j in range(self.n)]
            rows, normals = [[x - d * f / across for x, f in zip(row, fall)] for row, d in zip(inner, along)], [normal]
        if self.touching is not None:
            rows, normals = self.held()
        while normals:
            # in the surface one state follows from the others
            normal = normals.pop()
            k = max(range(len(normal)), key=lambda j: float(abs(acb(normal[j])).lower()))
            others = [j for j in range(len(normal)) if j != k]
            less = lambda row: [row[j] - row[k] * normal[j] / normal[k] for j in others]
            rows, normals = [less(rows[i]) for i in others], [less(row) for row in normals]
        return right_of_axis(acb_mat(rows), {"Fold": [0, 1], "Hopf": [self.omega and self.omega**2, 0, 1]}.get(self.kind, [1]))

    def held(self):
        """The linear motion of the states with contacts, and normals of the surfaces that it does not leave."""
        rates = [row for row in self.slopes(self.field, self.y, self.parameter)]
        followed = self.slopes(self.followed, self.y, self.parameter)
        inner, outer = acb_mat([row[self.n :] for row in followed]), acb_mat([row[: self.n] for row in followed])
        forces = inner.solve(outer).tolist()
        rows = [[row[j] - sum(by * force[j] for by, force in zip(row[self.n :], forces)) for j in range(self.n)] for row in rates]
        functions = []
        for contact in self.touching:
            if contact.holds:
                functions += [self.form(contact.held)] + [self.speed(contact)] * (contact.kind == "Stop")
        normals = self.slopes(lambda y, parameter: [of(y, parameter) for of in functions], self.y, self.parameter)
        return rows, [[acb(x) for x in row[: self.n]] for row in normals]

    def lyapunov(self):
        """The first Lyapunov coefficient, with |q| = 1 in the states and the factor 1/ω. The share of a sliding mode is no state: the
        equations with it are Mẏ = E(y), where M has 0 for it."""
        n, turn = self.size, acb(0, 1) * self.omega
        rows = self.matrix(self.y, self.parameter)
        matrix, unit = acb_mat(rows), acb_mat([[int(i == j < self.n) for j in range(n)] for i in range(n)])
        q = null_vector(matrix - unit * turn)
        p = null_vector(matrix.transpose() + unit * turn)
        scale = sum(x.conjugate() * y for x, y in zip(p[: self.n], q)).conjugate()
        p = [x / scale for x in p]
        bar, product = [x.conjugate() for x in q], lambda v: sum(x.conjugate() * y for x, y in zip(p, v))
        solve = lambda of, v: of.solve(acb_mat([[x] for x in v])).entries()
        second = lambda v, w: [dual(dual(x).d).d for x in self.along(v, w)]
        third = lambda u, v, w: [dual(dual(dual(x).d).d).d for x in self.along(u, v, w)]
        try:
            mean, twice = solve(matrix, second(q, bar)), solve(unit * (2 * turn) - matrix, second(q, q))
        except ZeroDivisionError:
            raise Refused("the linearisation is singular") from None
        total = product(third(q, q, bar)) - 2 * product(second(q, mean)) + product(second(bar, twice))
        return (total / (2 * self.omega * sum((x * y).real for x, y in zip(q[: self.n], bar)))).real

    def along(self, *directions):
        """The rates with derivatives along directions, one within another."""
        states, parameter = list(self.y), self.parameter
        for depth, direction in enumerate(directions):
            states = [Dual(x, lifted(v, depth)) for x, v in zip(states, direction)]
            parameter = Dual(parameter, 0)
        return self.rest(states, parameter)

    def is_affine(self):
        """Whether the rates of the mode are affine in the states, as they are written."""
        if self.sides is not None:
            return False
        zero = Degree(0)
        forces = [contact.name for contact in self.touching or []]
        names = {name: zero for name in [*self.parameters, "pi"]} | {name: Degree(1) for name in [*self.states, *forces]}
        for name, text in self.system.get("define", {}).items():
            names[name] = evaluated(text, names, Degree.number)
        parts = [part for contact in self.touching or [] for part in contact.law.items() if part[1] is not None]
        degrees = ((evaluated(text, names, Degree.number).degree, int(field not in ("stiffness", "damping"))) for field, text in parts)
        return all(rate.degree < 2 for rate in self.rates(self.own, names, Degree.number)) and all(degree <= most for degree, most in degrees)

    # ------------------------------------------------------------------------------------------------ beyond a boundary
    def slope(self, guard):
        """The derivative of a guard in the parameter, along the equilibria of the mode."""
        y, parameter = [Dual(x, 0) for x in self.y], Dual(self.parameter, 1)
        side = acb_mat([[-acb(dual(row).d)] for row in self.rest(y, parameter)])
        try:
            moved = acb_mat(self.matrix(self.y, self.parameter)).solve(side).entries()
        except ZeroDivisionError:
            raise Refused("the parameter is no coordinate there") from None
        y = [Dual(x, by) for x, by in zip(self.y, moved)]
        return acb(dual(self.guard(guard, y, parameter)).d).real

    def beyond(self, said):
        """Whether equilibria of the mode that is stated beyond lie on the other side of the parameter; refused where the point is
        none of that mode."""
        other = Rest(self.posed, self.near | {"mode": said["mode"]}, Tagged("Boundary", {"guard": said["guard"]}))
        own, there = self.guards[self.vanishing], other.guards[other.vanishing]
        must(joined(self, own, other, there), "what rests in the one mode does not rest in the other by its formulas")
        share = {"first": [acb(0)], "second": [acb(1)]}.get(there, []) if isinstance(there, str) else []
        other.y, other.parameter = self.y[: self.n] + (share or self.y[self.n :] * (self.touching is not None)), self.parameter
        wrong = [what for what, holds in other.signs() if not holds]
        must(not wrong, f"beyond it {', '.join(wrong)} is not shown")
        one, two = self.slope(own), other.slope(there)
        must(not (one * two).contains(0), "a guard has no slope along the equilibria")
        return bool(one * two < 0)


class Contact:
    """A contact in its state, by the name of that."""

    def __init__(self, name, law, state):
        must(law.name in FIELDS and set(law.value) <= set(FIELDS[law.name].split()), f"`{name}` has no such law")
        self.name, self.kind, self.law, self.state = name, law.name, law.value, state
        self.held, self.element = self.law.get("slip", self.law.get("gap")), f"z_{name}"
        self.holds = (self.kind, state) in (("Friction", "stick"), ("Stop", "closed"))
        static = self.law.get("static")
        self.most = static if static is not None else self.law.get("bound")

    def guards(self):
        return 2 if self.state == "stick" else 1

    def not_negative(self, value):
        """Numbers of its law, and what its static bound is more than that of slip."""
        if self.kind == "Stop":
            restitution = value(self.law["restitution"])
            return [restitution, 1 - restitution]
        names = {"Friction": ["bound"], "Jenkins": ["bound", "stiffness"], "Spring": ["stiffness", "damping"]}[self.kind]
        found = [value(self.law[name]) for name in names if self.law.get(name) is not None]
        return found + ([value(self.law["static"]) - found[0]] if self.law.get("static") is not None else [])

    def leads(self, guard, to):
        """Whether its law has the same force in another state where a guard of this one is zero."""
        if self.kind in ("Stop", "Spring"):
            return to != self.state
        if self.state != "stick" or self.law.get("static") is not None:
            return False
        upper = (guard == 0) == (self.kind == "Friction")
        return to == ("backward" if upper else "forward")


def touching(contacts, modes, name):
    """The user's mode and the contacts with their states, by the name of a mode that contacts make."""
    parts = name.split(".")
    own = parts.pop(0) if modes else None
    must(own is None or own in modes, f"`{name}` is no mode")
    fits = len(parts) == len(contacts) and all(state in STATES.get(law.name, ()) for law, state in zip(contacts.values(), parts))
    must(fits, f"`{name}` is no mode")
    return own, [Contact(name, law, state) for (name, law), state in zip(contacts.items(), parts)]


def lifted(x, depth):
    """A number that does not vary, with as many derivatives as others have."""
    for _ in range(depth):
        x = Dual(x, 0)
    return x


def null_vector(matrix):
    """The null vector of a matrix that has one: of a bordered matrix, which is regular."""
    n, border = matrix.nrows(), [acb(arb(7) / (7 + k), arb(k) / 11) for k in range(matrix.nrows())]
    rows = [row + [x] for row, x in zip(matrix.tolist(), border)] + [border + [acb(0)]]
    try:
        return acb_mat(rows).solve(acb_mat([[acb(0)]] * n + [[acb(1)]])).entries()[:n]
    except ZeroDivisionError:
        raise NotCovered("the critical vector") from None


def right_of_axis(matrix, critical):
    """How many eigenvalues have a positive real part, where the zeros of a polynomial, 1, λ or λ² + ω², are known to be the only ones
    with none."""
    try:
        eigenvalues = matrix.eig(multiple=True) if matrix.nrows() else []
        beside = sum(not (it.real > 0 or it.real < 0) for it in eigenvalues)
        must(beside == len(critical) - 1, "an eigenvalue may be on the axis")
        return sum(bool(it.real > 0) for it in eigenvalues)
    except ValueError:
        pass
    # of a defective one: the characteristic polynomial over the other, which divides it
    left, quotient = matrix.charpoly().coeffs(), []
    while len(left) >= len(critical):
        quotient.insert(0, left[-1])
        shift = len(left) - len(critical)
        left = [x - left[-1] * critical[k - shift] if k >= shift else x for k, x in enumerate(left)][:-1]
    # zeros of (z + 1)ⁿp((z − 1)/(z + 1)) outside the unit circle, in a unit in which those of p are of order one
    n, image = len(quotient) - 1, acb_poly([])
    sizes = [float(abs(x / quotient[-1]).mid()) ** (1 / (n - k)) for k, x in enumerate(quotient[:-1])]
    unit = arb(max(sizes, default=1.0) or 1.0)
    for k, coefficient in enumerate(quotient):
        image += acb_poly([-1, 1]) ** k * acb_poly([1, 1]) ** (n - k) * (coefficient * unit**k)
    return counted(image.coeffs())


def joined(one, guard, other, there):
    """Whether the point of a mode at which a guard is zero rests in another, where a guard of that is zero, too."""
    if one.touching is not None:
        pairs = list(zip(one.touching, other.touching))
        changed = [(a, b) for a, b in pairs if a.state != b.state]
        if not changed and not isinstance(guard[0], Contact) and not isinstance(there[0], Contact):
            return joined_by_a_switch(one, guard, other, there)
        if not (isinstance(guard[0], Contact) and isinstance(there[0], Contact) and one.own == other.own and len(changed) == 1):
            return False
        (a, b), (own, k), (back, l) = changed[0], guard, there
        return own is a and back is b and (a.leads(k, b.state) or b.leads(l, a.state))
    if isinstance(there, str) and other.sides is not None and one.sides is None:
        k = ("first", "second").index(there)
        return other.sides[k] == one.near["mode"] and not one.formula(guard) - one.formula(other.surface[k])
    if isinstance(guard, str) and one.sides is not None and other.sides is None:
        return joined(other, there, one, guard)
    if isinstance(guard, str) or isinstance(there, str) or one.sides is not None or other.sides is not None:
        return False
    return joined_by_a_switch(one, guard, other, there)


def joined_by_a_switch(one, guard, other, there):
    """The same of two modes of the file, by a switch that leaves all states as they are."""
    here, to = one.own, other.own
    leads = lambda at: not any(one.system["modes"][at[0]]["until"][at[1]].get(it) for it in ("reset", "if"))
    if not any(leads(at) and not one.formula(at) - one.formula(guard) for at in one.switches(here, to)):
        return False
    whole_formula = one.formula(guard)
    for state in one.states:
        rest = one.formula(guard, one.formulas({state: Formula()}))
        alone = whole_formula - rest
        if not alone - Formula.named(state) or not alone + Formula.named(state):
            # ± the state is what has nothing to do with it
            value = -rest if not alone - Formula.named(state) else rest
            names = one.formulas({state: value})
            both = zip(*(one.rates(mode, names, Formula.number) for mode in (here, to)))
            return not any(a - b for a, b in both) and not one.formula(there, names)
    return False
