"""Modes that contacts make, with coefficients that are quotients of polynomials in the parameter.

Written from docs/contacts.md and docs/proofs.md, apart from the program: every force follows from the rates and the law of its
contact, those that hold from one linear system. Guards stand in the order of the contacts, friction that sticks having B - q before
B + q; an end of a contact leads on by every way in which the others may follow in the same instant, each with what must not be
negative for it. What is decided by a sign is decided where the parameter is an interval.
"""

from flint import acb

from .balls import NotCovered, must, real

FORWARD, BACKWARD, STICK = range(3)
OPEN, CLOSED, PARTING = range(3)
HELD, GIVES_FORWARD, GIVES_BACKWARD = range(3)
STATES = {
    "Friction": ("forward", "backward", "stick"),
    "Stop": ("open", "closed"),
    "Spring": ("open", "closed"),
    "Jenkins": ("stick", "forward", "backward"),
}
FIELDS = {"Friction": "slip bound static", "Stop": "gap restitution", "Spring": "gap stiffness damping", "Jenkins": "slip stiffness bound"}
MOST_WAYS = 1000
"""Ways on that are followed at one instant."""


class ProductNames:
    """Names of modes: the user's, if there are any, and the states of the contacts, joined by points."""

    def __init__(self, own, kinds):
        self.own, self.kinds, self.count = own, kinds, max(len(own), 1)
        for kind in kinds:
            self.count *= len(kind)

    def __len__(self):
        return self.count

    def digits(self, number):
        digits = []
        for kind in reversed(self.kinds):
            number, digit = divmod(number, len(kind))
            digits.insert(0, digit)
        return number, digits

    def number(self, own, digits):
        for kind, digit in zip(self.kinds, digits):
            own = own * len(kind) + digit
        return own

    def __getitem__(self, number):
        own, digits = self.digits(number)
        return ".".join([*self.own[own : own + 1], *(kind[digit] for kind, digit in zip(self.kinds, digits))])


class Ending:
    """A guard of a contact: the state beyond it, and the restitution of an impact."""

    def __init__(self, guard, to, impact=None):
        self.guard, self.to, self.impact = guard, to, impact


class Instant:
    """The end of a mode by one contact, or by the user's (then no contact): states before, with their forces; states that jump."""

    def __init__(self, own, before, forces, contact, ending, jump):
        self.own, self.before, self.forces, self.contact, self.ending, self.jump = own, before, forces, contact, ending, jump
        self.is_impact = contact is not None and bool(jump)


class Contacts:
    """What the modes are made of: the user's modes as (rates, switches) in which forces are states from `count` on; `form` reads an
    expression. Divisors and signs are what has to be so for all values of the parameter that are looked at."""

    def __init__(self, system, form, own, frame, divisors, signs):
        self.names, self.divisors, self.signs = list(system["contacts"]), divisors, signs
        self.count, self.omega, self.near = frame
        self.own, states, self.laws, self.elements = own, system["states"], [], []
        for name, law in system["contacts"].items():
            must(law.name in FIELDS and set(law.value) <= set(FIELDS[law.name].split()), f"`{name}` has no such law")
            self.laws.append((law.name, {field: form(text) for field, text in law.value.items() if text is not None}))
            element = f"z_{name}" if law.name == "Jenkins" else None
            must(element is None or element in states, f"`{element}` is no state")
            self.elements.append(None if element is None else list(states).index(element))
        kinds = [(*STATES[kind], "open") if kind == "Spring" and "damping" in law else STATES[kind] for kind, law in self.laws]
        self.modes = ProductNames(list(system.get("modes", {})), kinds)
        self.zero, self.one = form("0"), form("1")
        for kind, law in self.laws:
            self.check(kind, law)
        self.moving = [self.kinematics(rates) for rates, _ in own]

    # ------------------------------------------------------------------------------------------------ forms
    def is_zero(self, form):
        return not any(form.states.values()) and not any(form.waves.values())

    def number(self, x):
        return self.one.over(lambda value: value * x)

    def slope(self, form, state):
        return form.states.get(state, 0)

    def has_force(self, form):
        return any(value for state, value in form.states.items() if state >= self.count)

    def replaced(self, form, new):
        """A form with forms in the place of some states."""
        result = form.over(lambda value: value)
        for state in new:
            factor = result.states.pop(state, 0)
            if factor:
                result = result + new[state].over(lambda value, factor=factor: value * factor)
        return result

    def moved(self, form, rates, turning=True):
        """The rate of a form."""
        result = self.zero
        for state, factor in form.states.items():
            if factor:
                result = result + rates[state].over(lambda value, factor=factor: value * factor)
        turned = {}
        for (h, sine), value in form.waves.items():
            if h and turning:
                turned[h, 1 - sine] = value * self.omega * (h if sine else -h)
        return result + type(form)(waves=turned)

    def ratio(self, one, other):
        """The number that a form is times another that has a state, or None."""
        state = next((state for state, value in other.states.items() if value), None)
        if state is None:
            return None
        factor = one.states.get(state, 0) / other.states[state]
        return factor if self.is_zero(one - other.over(lambda value: value * factor)) else None

    def sign(self, number):
        """The sign of a number, which must be the same for all values of the parameter."""
        fixed = self.number(number).constant()
        sign = 1 if float(real(fixed.at(acb(float(self.near))))) > 0 else -1
        self.signs.append((fixed * sign, True))
        return sign

    def within(self, form, held):
        """A form where others are zero."""
        for row in held:
            state = next((state for state, value in row.states.items() if value), None)
            if state is not None and self.slope(form, state):
                factor = form.states[state] / row.states[state]
                form = form - row.over(lambda value, factor=factor: value * factor)
        return form

    # ------------------------------------------------------------------------------------------------ forces
    def kinematics(self, rates):
        """Rates without forces, what each force adds to them, and of every contact its velocity, the rate of that and what each
        force adds to this."""
        contacts, nothing = range(len(self.laws)), {self.count + k: self.zero for k in range(len(self.laws))}
        bare = [self.replaced(rate, nothing) for rate in rates]
        weights = [[self.slope(rate, self.count + k) for rate in rates] for k in contacts]
        speeds, drifts, by = [], [], []
        add = lambda form, k: sum((value * weights[k][state] for state, value in form.states.items() if state < self.count), 0)
        for contact, (kind, law) in enumerate(self.laws):
            speed = law.get("slip")
            if speed is None:
                must(not any(add(law["gap"], k) for k in contacts), "the velocity of a gap depends on a force")
                speed = self.moved(law["gap"], bare)
            speeds.append(speed)
            drifts.append(self.moved(speed, bare))
            by.append([add(speed, k) for k in contacts])
            must(by[-1][contact], f"`{self.names[contact]}` does not act on what it is about")
            self.signs.append((self.number(by[-1][contact]).constant(), True))
        return bare, weights, speeds, drifts, by

    def check(self, kind, law):
        """Refuses numbers that make no sense where they are negative, and forces where none may stand."""
        number = lambda field: law[field].constant() if field in law else None
        found = [number(field) for field in ("bound", "restitution")]
        if "static" in law:
            found.append((law["static"] - law["bound"]).constant())
        self.signs.extend((it, False) for it in found if it is not None)
        allowed = ("bound", "static") if kind == "Friction" else ()
        must(not any(self.has_force(form) for field, form in law.items() if field not in allowed), "a force stands where none may")
        must(kind == "Friction" or all(number(field) is not None for field in law if field not in ("slip", "gap")), "a law that changes")
        for k, (other, known) in enumerate(self.laws):
            impacts = other == "Stop" and not self.is_zero(known["restitution"])
            uses = any(self.slope(law[field], self.count + k) for field in allowed if field in law)
            must(not (impacts and uses), "the friction of a stop with impacts")

    def told(self, own, contact, digit):
        """The force that the law of a contact says; None where it is what holds."""
        kind, law = self.laws[contact]
        times = lambda form, factor: form * law[factor]
        if (kind, digit) in (("Friction", STICK), ("Stop", CLOSED)):
            return None
        if kind == "Friction":
            return -law["bound"] if digit == FORWARD else law["bound"]
        if kind == "Jenkins" and digit == HELD:
            stretch = type(self.one)(states={self.elements[contact]: self.number(1).constant()})
            return -times(stretch, "stiffness")
        if kind == "Jenkins":
            return -law["bound"] if digit == GIVES_FORWARD else law["bound"]
        if kind == "Spring" and digit == CLOSED:
            return self.elastic(own, contact)
        return self.zero

    def elastic(self, own, contact):
        """-kg - cġ."""
        _, law = self.laws[contact]
        force = law["gap"] * law["stiffness"]
        return -(force + self.moving[own][2][contact] * law["damping"] if "damping" in law else force)

    def forces(self, own, digits):
        """The forces of all contacts; None where they are not determined."""
        _, _, _, drifts, by = self.moving[own]
        told = [self.told(own, contact, digit) for contact, digit in enumerate(digits)]
        linked = [k for k, form in enumerate(told) if form is not None and self.has_force(form)]
        held = [k for k, form in enumerate(told) if form is None]
        known = {k: form for k, form in enumerate(told) if form is not None and k not in linked}
        unknown, rows = held + linked, []
        for k in held:
            rest = drifts[k]
            for other, form in known.items():
                rest = rest + form.over(lambda value, k=k, other=other: value * by[k][other])
            rows.append(([by[k][other] for other in unknown], -rest))
        for k in linked:
            given = {self.count + other: form for other, form in known.items()}
            given |= {self.count + other: self.zero for other in unknown}
            rows.append(([int(k == other) - self.slope(told[k], self.count + other) for other in unknown], self.replaced(told[k], given)))
        if linked:
            # a stop must not be pressed on by the friction that its force makes
            for place, k in enumerate(unknown):
                if self.laws[k][0] == "Stop":
                    unit = [(row, self.number(int(place == other))) for other, (row, _) in enumerate(rows)]
                    column = self.solved(unit)
                    must(column is not None and self.sign(column[place].constant()) > 0, "a force that would close its gap")
        found = self.solved(rows)
        if found is None:
            return None
        known |= dict(zip(unknown, found))
        return [known[k] for k in range(len(digits))]

    def solved(self, rows):
        """The solution of linear equations, row by row (coefficients, value), or None."""
        rows = [([self.number(x).constant() for x in row], value) for row, value in rows]
        for pivot in range(len(rows)):
            place = next((k for k in range(pivot, len(rows)) if rows[k][0][pivot]), None)
            if place is None:
                return None
            rows[pivot], rows[place] = rows[place], rows[pivot]
            own, value = rows[pivot]
            self.divisors.append(own[pivot])
            rows[pivot] = row, _ = [x / own[pivot] for x in own], value.over(lambda x, by=own[pivot]: x / by)
            for k, (other, rest) in enumerate(rows):
                factor = other[pivot]
                if k != pivot and factor:
                    taken = rows[pivot][1].over(lambda x, factor=factor: x * factor)
                    rows[k] = [x - factor * y for x, y in zip(other, row)], rest - taken
        return [value for _, value in rows]

    def hold(self, contact, forces):
        """The most that friction holds."""
        _, law = self.laws[contact]
        return self.replaced(law.get("static", law["bound"]), {self.count + k: force for k, force in enumerate(forces)})

    def acceleration(self, own, contact, forces):
        _, _, _, drifts, by = self.moving[own]
        rate = drifts[contact]
        for k, force in enumerate(forces):
            rate = rate + force.over(lambda value, k=k: value * by[contact][k])
        return rate

    # ------------------------------------------------------------------------------------------------ modes
    def mode(self, number):
        """Rates of a mode, and its switches as (guard, to, reset, conditions, name, group)."""
        own, digits = self.modes.digits(number)
        forces = self.forces(own, digits)
        must(forces is not None, f"the forces in `{self.modes[number]}` are not determined")
        bare, weights, *_ = self.moving[own]
        rates = list(bare)
        for force, weight in zip(forces, weights):
            rates = [rate + force.over(lambda value, w=w: value * w) if w else rate for rate, w in zip(rates, weight)]
        for contact, element in enumerate(self.elements):
            if element is not None:
                rates[element] = self.laws[contact][1]["slip"] if digits[contact] == HELD else self.zero
        endings = [(contact, it) for contact in range(len(digits)) for it in self.endings(own, digits, contact, forces)]
        self.apart(own, digits, endings)
        switches = []
        for group, (contact, ending) in enumerate(endings):
            instant = Instant(own, digits, forces, contact, ending, self.jump(own, contact, ending))
            for beyond, conditions in self.arrivals(instant):
                switches.append((ending.guard, self.modes.number(own, beyond), instant.jump, conditions, None, group))
        for guard, to, reset, conditions, name in self.own[own][1]:
            instant = Instant(to, digits, forces, None, Ending(guard, None), reset)
            for beyond, more in self.arrivals(instant):
                switches.append((guard, self.modes.number(to, beyond), reset, [*conditions, *more], name, None))
        return rates, switches

    def endings(self, own, digits, contact, forces):
        kind, law = self.laws[contact]
        digit, force, speed = digits[contact], forces[contact], self.moving[own][2][contact]
        if kind == "Friction":
            if digit != STICK:
                return [Ending(law["slip"] if digit == FORWARD else -law["slip"], STICK)]
            most = self.hold(contact, forces)
            return [Ending(most - force, BACKWARD), Ending(most + force, FORWARD)]
        if kind == "Stop":
            bounces = not self.is_zero(law["restitution"])
            return [Ending(force, OPEN) if digit == CLOSED else Ending(law["gap"], OPEN if bounces else CLOSED, law["restitution"])]
        if kind == "Spring":
            if digit == OPEN:
                return [Ending(law["gap"], CLOSED)]
            if "damping" not in law:
                return [Ending(-law["gap"], OPEN)]
            return [Ending(force, PARTING)] if digit == CLOSED else [Ending(-law["gap"], OPEN), Ending(-self.elastic(own, contact), CLOSED)]
        if digit == HELD:
            return [Ending(law["bound"] + force, GIVES_FORWARD), Ending(law["bound"] - force, GIVES_BACKWARD)]
        return [Ending(law["slip"] if digit == GIVES_FORWARD else -law["slip"], HELD)]

    def apart(self, own, digits, endings):
        """Sees that no two contacts end by one guard, not even where what they hold is zero: then they change together."""
        held = []
        for contact, digit in enumerate(digits):
            kind, law = self.laws[contact]
            rows = {("Friction", STICK): ["slip"], ("Stop", CLOSED): ["gap", "speed"]}.get((kind, digit), [])
            for row in rows:
                form = self.within(self.moving[own][2][contact] if row == "speed" else law[row], held)
                held = [self.within(it, [form]) for it in held] + [form]
        forms = [(contact, self.within(ending.guard, held)) for contact, ending in endings]
        for k, (contact, form) in enumerate(forms):
            if self.is_zero(form):
                raise NotCovered("a contact that ends by what another holds")
            for other, guard in forms[:k]:
                if other != contact and self.ratio(form, guard) is not None:
                    raise NotCovered("two contacts that end by one guard")

    def jump(self, own, contact, ending):
        """New states at an impact: x - (1 + e)ġ w/(∇ġ·w)."""
        if ending.impact is None:
            return {}
        _, weights, speeds, _, by = self.moving[own]
        impulse = speeds[contact] * (self.one + ending.impact)
        self.divisors.append(self.number(by[contact][contact]).constant())
        less = lambda w: impulse.over(lambda value: value * w / by[contact][contact])
        state = lambda k: type(self.one)(states={k: self.number(1).constant()})
        return {k: state(k) - less(w) for k, w in enumerate(weights[contact]) if w}

    # ------------------------------------------------------------------------------------------------ what follows
    def arrivals(self, at):
        """Every combination of states that may follow at an instant, with what is not negative for it."""
        digits, released = list(at.before), None
        if at.contact is not None:
            digits[at.contact] = at.ending.to
            # what is released leaves by the sign of what was too much, as long as nothing else changes
            if self.laws[at.contact][0] == "Friction" and at.before[at.contact] == STICK:
                released = at.contact
        ends, dead, count = [], [], 0
        for first in self.turned(at, (digits, [], released, {})):
            known, trials = set(), [first]
            while trials:
                trial = trials.pop()
                if tuple(trial[0]) in known:
                    continue
                count += 1
                if count > MOST_WAYS:
                    raise NotCovered("so many ways on at one instant")
                forces = self.forces(at.own, trial[0])
                if forces is None:
                    dead.append((trial[0], trial[1] + [it for k in self.others(at) for it in self.broken(at, trial, k)]))
                    continue
                known.add(tuple(trial[0]))
                conditions, beyond = list(trial[1]), []
                for contact in self.others(at):
                    limits = self.open_limits(at, trial, contact, forces)
                    beyond += [self.changed(trial, contact, *limit) for limit in limits]
                    # it holds in this state, or another state would not
                    holds = (self.laws[contact][0], trial[0][contact]) in (("Friction", STICK), ("Stop", CLOSED), ("Spring", CLOSED))
                    conditions += (not holds and self.broken(at, trial, contact)) or [limit for limit, _ in limits]
                ends.append((trial[0], conditions))
                trials.extend(reversed(beyond))
        # where no motion follows comes last
        return ends + dead

    def others(self, at):
        """All contacts, the one that ends first."""
        ended = [] if at.contact is None else [at.contact]
        return [*ended, *(k for k in range(len(at.before)) if k != at.contact)]

    def changed(self, trial, contact, limit, to):
        """A trial in which a contact has changed."""
        digits, conditions, _, left = trial
        return [*digits[:contact], to, *digits[contact + 1 :]], conditions, None, left | {contact: (digits[contact], limit)}

    def broken(self, at, trial, contact):
        """What is not negative where a contact does not stay in the state that it has left, with the others as they are."""
        digits, _, _, left = trial
        if contact not in left:
            return []
        digit, limit = left[contact]
        forces = self.forces(at.own, [*digits[:contact], digit, *digits[contact + 1 :]])
        limits = [(limit, digits[contact])] if forces is None else self.limits(at, contact, digit, forces)
        return [-limit for limit, to in limits if to == digits[contact] and not self.is_zero(limit)][:1]

    def after(self, at, form):
        return self.replaced_by(form, at.jump) if at.jump else form

    def replaced_by(self, form, jump):
        """A form after a jump: all states at once."""
        result = type(form)({state: value for state, value in form.states.items() if state not in jump}, form.waves)
        for state, new in jump.items():
            factor = form.states.get(state, 0)
            if factor:
                result = result + new.over(lambda value, factor=factor: value * factor)
        return result

    def turned(self, at, trial):
        """Trials after an impact, by the velocities of other contacts."""
        trials = [trial]
        if not at.is_impact:
            return trials
        speeds = self.moving[at.own][2]
        for contact, (kind, _) in enumerate(self.laws):
            after = self.after(at, speeds[contact])
            change = after - speeds[contact]
            if contact == at.contact or self.is_zero(change):
                continue
            # before an impact the velocity of the gap is negative
            part = self.ratio(change, speeds[at.contact])
            rises = None if part is None else self.sign(part) < 0
            trials = [new for one in trials for new in self.led(kind, contact, one, after, rises)]
        return trials

    def led(self, kind, contact, trial, after, rises):
        digits, conditions, *rest = trial
        digit = digits[contact]

        def to(new, *held):
            return [*digits[:contact], new, *digits[contact + 1 :]], [*conditions, *held], *rest

        if kind == "Friction" and digit == STICK:
            if rises is not None:
                return [to(FORWARD if rises else BACKWARD)]
            return [to(FORWARD, after), to(BACKWARD, -after)]
        if kind == "Stop" and digit == CLOSED:
            # one that is pressed on would have an impact of its own
            return [to(OPEN, after)] if rises is None else [to(OPEN)] if rises else []
        if kind == "Friction":
            ways = [to(FORWARD, after), to(BACKWARD, -after)]
            return ways if digit == FORWARD else ways[::-1]
        if kind == "Jenkins" and digit != HELD:
            goes_on = after if digit == GIVES_FORWARD else -after
            return [to(digit, goes_on), to(HELD, -goes_on)]
        return [trial]

    def open_limits(self, at, trial, contact, forces):
        """What is not negative where a contact stays in its state on trial, if that hangs on the instant, each with what follows."""
        digits, _, released, _ = trial
        is_same = lambda apart: self.is_zero(apart) or self.ratio(apart, at.ending.guard) is not None
        holds = self.laws[contact][0] == "Friction" and bool(at.jump)
        same_hold = lambda: not holds or is_same(self.after(at, self.hold(contact, forces)) - self.hold(contact, at.forces))
        same_force = lambda: is_same(self.after(at, forces[contact]) - at.forces[contact])
        same = digits[contact] == at.before[contact] and not at.is_impact and same_force() and same_hold()
        if contact == released or same:
            return []
        limits = self.limits(at, contact, digits[contact], forces)
        return [(limit, to) for limit, to in limits if not self.is_zero(limit)]

    def limits(self, at, contact, digit, forces):
        """What is not negative where a contact stays in a state, and the state where it is."""
        kind, law = self.laws[contact]
        force, ends = self.after(at, forces[contact]), contact == at.contact
        rests = not at.is_impact and (ends or at.before[contact] == STICK)
        if kind == "Friction" and digit == STICK:
            hold = self.after(at, self.hold(contact, forces))
            upper, lower = (hold - force, BACKWARD), (hold + force, FORWARD)
            # a slip that falls to zero is held by a force on its own side
            return {FORWARD: [upper], BACKWARD: [lower]}.get(at.before[contact] if ends else STICK, [upper, lower])
        if kind == "Friction" and rests:
            rate = self.after(at, self.acceleration(at.own, contact, forces))
            return [(rate if digit == FORWARD else -rate, STICK)]
        if kind == "Stop" and digit == CLOSED:
            return [(force, OPEN)]
        if kind == "Spring" and "damping" in law and digit == CLOSED and at.is_impact:
            return [(force, PARTING)]
        return []
