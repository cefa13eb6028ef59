"""Waves of brakewave in balls of Arb: their equations and inequalities.

Written from the equations of docs/theory.md, apart from the program. check.py says what it is for.
"""

from collections import namedtuple

from flint import acb, acb_mat, arb

from .balls import (
    PARTS,
    Dual,
    apply,
    bent,
    decimal,
    differences,
    double,
    dual,
    exact,
    exponential,
    injective,
    jacobian,
    lesser,
    must,
    parted,
    positive,
    size,
    tail,
    times,
    value_of,
    whole,
)

# ------------------------------------------------------------------------------------------------ the model
Model = namedtuple("Model", "a b d g h friction static mismatch damping material")
NAMES = ["Nu", "Xi", "Gamma"]


def model(posed, parameter):
    """The numbers of the model. `parameter` takes the place of the one that varies."""
    written, varies = posed["written"], posed["parameter"]
    must(varies in [*NAMES, "Friction", "Mismatch", "MassDamping", "StiffnessDamping"], f"{varies} is not in the equations")
    must(varies not in NAMES or written["origin"].name == "Geometry", f"{varies} is not in the equations")
    must(varies != "StiffnessDamping" or written.get("material") is not None, f"{varies} is not in the equations")
    number = lambda name, text: parameter if name == varies else decimal(text)
    origin = written["origin"]
    if origin.name == "Given":
        elastic = [decimal(text) for text in origin.value]
    else:
        nu, xi, gamma = (number(name, text) for name, text in zip(NAMES, origin.value))
        square, ln = xi * xi, xi.log()
        wall, fourth = square - 1, square * square
        shear, lame = 1 / (2 * (1 + nu)), nu / ((1 + nu) * (1 - 2 * nu))
        inner = (fourth * ln - square * wall + (fourth - 1) / 4) / (wall * wall)
        outer = ((fourth - 1) / 2 - 2 * square * ln) / (wall * wall)
        unit, stiff = gamma * inner, gamma * inner * (1 + nu) * wall
        elastic = [
            (lame + 2 * shear) * outer / unit,
            shear * outer / unit,
            (lame / 2 - shear * (outer + acb(0.5)) - (lame + 2 * shear) * outer) / unit,
            (square + 1 / (1 - 2 * nu)) / stiff,
            square / stiff,
        ]
    friction = number("Friction", written["friction"])
    static = friction * decimal(written["ratio"] or "1")
    others = number("Mismatch", written["mismatch"]), number("MassDamping", written["damping"])
    return Model(*elastic, friction, static, *others, number("StiffnessDamping", written.get("material") or "0"))


# ------------------------------------------------------------------------------------------------ the wave
U, DU, V, W = range(4)
"""Places in the state (U − δ, U̇, V, V̇, 1)."""
SLIDING = ("Slip", "Reverse")
ENTRIES = {
    "Release": (["Stick"], ["Slip"]),
    "Arrest": (SLIDING, ["Stick"]),
    "Reversal": (SLIDING, SLIDING),
    "TakeOff": (SLIDING, ["Separation"]),
    "Landing": (["Separation"], SLIDING),
    "ArrestedLanding": (["Separation"], [*SLIDING, "Stick"]),
    "Touch": (["Separation"], ["Separation"]),
}
"""Which regimes a switch joins."""
KNOWN_ZEROS = {W: {"Reversal": 1, "ArrestedLanding": 1}, U: {"TakeOff": 3, "Touch": 2}}
"""Order of the zero that V̇ − 1 or U − δ has where a zone begins."""
TOUCHES = ("Pressure", "Rate", "Gap")
"""Margins with a minimum at a time of its own."""
CONDITIONS = {
    "Duration": lambda regime, entry, goes, via: True,
    "Pressure": lambda regime, entry, goes, via: regime == "Slip",
    "Rate": lambda regime, entry, goes, via: regime in SLIDING,
    "Gap": lambda regime, entry, goes, via: regime == "Separation",
    "LandingSpeed": lambda regime, entry, goes, via: regime == "Separation",
    "LandingRate": lambda regime, entry, goes, via: regime in SLIDING and entry == "Landing",
    "LandingPressure": lambda regime, entry, goes, via: regime == "Slip" and entry == "Landing",
    "Tension": lambda regime, entry, goes, via: entry == "Touch",
    "LowerForce": lambda regime, entry, goes, via: regime == "Stick",
    "UpperForce": lambda regime, entry, goes, via: goes == "Slip" and via in ("Reversal", "ArrestedLanding"),
    "Impulse": lambda regime, entry, goes, via: via == "ArrestedLanding",
}
"""Of which zones a margin is a condition, by their regime, the switch before them, the regime after them and the switch to it:
P > 0 where V̇ < 1; what lands; Q > −fP where stick begins, Q > fP where slip begins that does not come from stick."""
Parts = namedtuple("Parts", "m c zones matrices begins ends rises falls")
"""Model, speed, (V, V̇, T) of the zones, and of every zone A, x at its beginning and end, and x′ there."""


class Wave:
    """The boundary-value problem of a wave. Its unknowns are those of the certificate: V less that of a steady
    slip, V̇ and T of every zone, |c|/√a − 1, the parameter and what belongs to the event."""

    def __init__(self, posed, near, condition):
        self.posed, self.condition, self.static = posed, condition, posed["written"]["ratio"] is not None
        must(len(near["signature"]) == 1, "a sequence of zones is one list")
        self.zones = [(zone["regime"], zone["entry"]) for zone in near["signature"][0]]
        self.mode = whole(posed["mode"])
        must(self.mode > 0, "there is no mode")
        self.count = len(self.zones)
        must(self.count and len(near["zones"]) == self.count, "zones without a state")
        for (before, _), (regime, entry) in zip(self.zones[-1:] + self.zones, self.zones):
            must(entry in ENTRIES, f"there is no switch {entry}")
            befores, afters = ENTRIES[entry]
            fits = before in befores and regime in afters and (entry != "Reversal" or before != regime)
            must(fits, f"{entry} does not lead from {before} to {regime}")
        self.coulomb = posed["impact"] == "Coulomb"
        arrests = any(entry == "ArrestedLanding" for _, entry in self.zones)
        must(self.coulomb or not arrests, "an impact without friction arrests")
        self.kind = condition if isinstance(condition, str) else condition.name
        margin = condition.value if self.kind == "Margin" else {}
        self.watch, self.zone = margin.get("watch"), -1
        if self.kind == "Margin":
            self.zone = whole(margin["zone"], self.count)
            must(self.is_condition(self.watch, self.zone), f"{self.watch} is no condition of zone {self.zone}")
        self.vanishing = self.zone if self.watch == "Duration" else None
        # zones in whose last condition the known zero is divided out, for they may have no length
        self.divided = {self.vanishing} - {None}
        # waves run in the direction of D
        self.sign = 1 if model(posed, decimal(repr(double(near["parameter"])))).d.real > 0 else -1
        self.guess = [acb(double(x)) for x in [*sum(near["zones"], ()), near["excess"], near["parameter"]]]
        self.base = len(self.guess)
        self.prepare()
        if self.watch in TOUCHES:
            self.guess.append(acb(double(margin["time"])))
        elif self.kind == "Crossing":
            self.sector, omega = whole(condition.value["sector"], self.mode), double(condition.value["omega"])
            self.at_zero = not omega
            must(not self.at_zero or self.is_real(self.sector), "0 is no eigenvalue of one sector alone")
            if not self.at_zero:
                self.guess.append(acb(omega))
        elif self.kind == "Fold":
            # F_x v = 0 with the largest entry of v put to 1; next to a fold F_x is nearly singular
            count = self.base - 1
            slope = differences(lambda x: self.switches(x + self.guess[count:])[0], self.guess[:count])
            null = [y.mid() for y in times(slope.mid().inv().mid(), [1] * count)]
            self.largest = max(range(count), key=lambda j: float(abs(null[j]).mid()))
            self.guess += [(y / null[self.largest]).mid() for y in null]

    def is_condition(self, watch, zone):
        """Whether a margin is a condition of a zone."""
        (regime, entry), (goes, via) = self.zones[zone], self.zones[(zone + 1) % self.count]
        # without material damping a release has no margin, and no zone has D/c for one
        return watch in CONDITIONS and CONDITIONS[watch](regime, entry, goes, via)

    def is_real(self, sector):
        """Whether e^{2πij/k} is real, so that eigenvalues of a sector come in conjugate pairs."""
        return 2 * sector in (0, self.mode)

    def primitive(self, x):
        """Whether 2π/k is the least period: where the zones repeat themselves, entries or durations differ."""
        zones = [[acb(y) for y in x[3 * i : 3 * i + 3]] for i in range(self.count)]
        like = lambda i, j: self.zones[i] == self.zones[j] and all(y.overlaps(z) for y, z in zip(zones[i], zones[j]))
        parts = [part for part in range(1, self.count) if self.count % part == 0]
        return not any(all(like(i, (i + part) % self.count) for i in range(self.count)) for part in parts)

    def legs(self, parts):
        """(regime, state at the beginning, at the end, duration) of the zones that have a length."""
        return [
            (regime, parts.begins[i], parts.ends[i], parts.zones[i][2])
            for i, (regime, _) in enumerate(self.zones)
            if i != self.vanishing
        ]

    def motion(self, parts):
        """The same as (regime, state at the beginning, duration), where what follows in the same regime and the same state is one."""
        legs = self.legs(parts)
        for k in range(len(legs) - 1, -1, -1):
            (regime, begin, state, time), (follows, start, end, rest) = legs[k - 1], legs[k]
            if len(legs) > 1 and regime == follows and all(acb(y).overlaps(acb(z)) for y, z in zip(state, start)):
                legs[k - 1] = (regime, begin, end, time + rest)
                del legs[k]
        return [(regime, begin, time) for regime, begin, _, time in legs]

    def prepare(self):
        """What another choice of unknowns makes of the first guess."""

    def unpack(self, x):
        """Model, c and (V, W, T) of the zones."""
        m = model(self.posed, x[self.base - 1])
        steady = m.friction * m.g * m.mismatch / m.h
        zones = [(x[3 * i] + steady, x[3 * i + 1], x[3 * i + 2]) for i in range(self.count)]
        return m, self.sign * (1 + x[self.base - 2]) * m.a.sqrt(), zones

    @staticmethod
    def matrix(m, c, regime):
        """A of x′ = Ax for the state (U − δ, U̇, V, V̇, 1)."""
        front, ma, mb = m.d / c, 1 - m.a / (c * c), 1 - m.b / (c * c)
        still, rise = [0] * 5, [0, 0, 0, 1, 0]
        if regime == "Stick":
            return [still, still, rise, still, still]
        if regime == "Separation":
            gap = [-m.g / mb, -m.damping / mb, 0, -front / mb, -m.g * m.mismatch / mb]
            return [[0, 1, 0, 0, 0], gap, rise, [0, front / ma, -m.h / ma, -m.damping / ma, 0], still]
        drive = m.friction if regime == "Slip" else -m.friction
        pull = [0, 0, -m.h / ma, (drive * front - m.damping) / ma, drive * m.g * m.mismatch / ma]
        return [still, still, rise, pull, still]

    def parts(self, x):
        """What follows from the unknowns."""
        m, c, zones = self.unpack(x)
        matrices = [self.matrix(m, c, regime) for regime, _ in self.zones]
        begins = [[0, 0, v, w, 1] for v, w, _ in zones]
        ends = [apply(exponential(a, t), z) for a, z, (_, _, t) in zip(matrices, begins, zones)]
        slopes = ([apply(a, z) for a, z in zip(matrices, states)] for states in (begins, ends))
        return Parts(m, c, zones, matrices, begins, ends, *slopes)

    @staticmethod
    def impulse(m, c, speed):
        """What a Coulomb impact can take from |1 − V̇|."""
        return -m.friction * (1 - m.b / (c * c)) * speed / (1 - m.a / (c * c))

    def equations(self, x):
        """Switches, the period and what singles out the point: as many equations as unknowns."""
        if self.kind == "Fold":
            count = self.base - 1
            both = self.switches([Dual(*pair) for pair in zip(x, x[self.base :])] + [Dual(x[count])])[0]
            return [y.v for y in both] + [y.d for y in both] + [x[self.base + self.largest] - 1]
        out, parts = self.switches(x)
        if self.kind == "Value":
            return out + [x[self.base - 1] - decimal(self.condition.value)]
        return out + (self.margin if self.kind == "Margin" else self.crossing)(x, parts)

    def switches(self, x):
        """The equations of the switches and of the period, and the parts of the wave."""
        parts = self.parts(x)
        return self.joined(parts), parts

    def joined(self, parts):
        """The equations of the switches and of the period."""
        m, c, zones, matrices, begins, ends, *_ = parts
        front, out = m.d / c, []
        for i, (regime, entry) in enumerate(self.zones):
            end, (v, w, _) = ends[i - 1], zones[i]
            place = W if entry in ("Arrest", "Reversal") else U
            stop, order = end[place] - int(place == W), KNOWN_ZEROS[place].get(self.zones[i - 1][1], 0)
            if (i - 1) % self.count in self.divided and order:
                stop = tail(matrices[i - 1], zones[i - 1][2], begins[i - 1], order)[place]
            if entry == "Release":
                moves = [w - 1, m.h * v + m.damping - m.static * (m.g * m.mismatch + front)]
            elif entry == "TakeOff":
                moves = [end[W] - w, m.g * m.mismatch + front * w]
            elif entry in ("Landing", "Touch"):
                # towards V̇ = 1
                lags = regime == "Slip" or regime == "Separation" and self.guess[3 * i + 1].real < 1
                jump = self.impulse(m, c, end[DU]) if self.coulomb else 0
                moves = [end[W] + (jump if lags else -jump) - w, stop]
            else:
                moves = [w - 1, stop]
            out += [end[V] - v, *moves]
        return out + [sum(t for _, _, t in zones) * c * self.sign - 2 * arb.pi() / self.mode]

    def margin(self, x, parts):
        """The margin that vanishes, and where it is a minimum its derivative."""
        m, c, zones, matrices, begins, ends, *_ = parts
        front, i, watch, (v, w, t) = m.d / c, self.zone, self.watch, zones[self.zone]
        contact, force = m.g * m.mismatch + front, m.h * v + m.damping
        if watch in TOUCHES:
            state = apply(exponential(matrices[i], x[self.base]), begins[i])
            if watch == "Gap":
                return [state[U], state[DU]]
            value = m.g * m.mismatch + front * state[W] if watch == "Pressure" else state[W] - 1
            return [value, apply(matrices[i], state)[W]]
        over = 1 - ends[i][W]
        margins = {
            "Duration": t,
            "LandingPressure": contact + front * (w - 1),
            "Tension": contact + front * (w - 1),
            "LandingRate": w - 1,
            "LowerForce": force + m.static * contact,
            "UpperForce": m.h * ends[i][V] + m.damping - m.static * contact,
            "LandingSpeed": ends[i][DU],
            "Impulse": self.impulse(m, c, ends[i][DU]) - (over if real(value_of(value_of(over))).mid() > 0 else -over),
        }
        return [margins[watch]]

    def enclosed(self, zero):
        """The unknowns in real balls; what an equation gives outright is exact."""
        must(all(abs(x.imag) <= zero.radius for x in zero.middle), "the zero of the equations is not real")
        x = [acb(arb(y.real, zero.radius)) for y in zero.middle]
        if self.vanishing is not None:
            x[3 * self.vanishing + 2] = acb(0)
        if self.kind == "Value":
            x[self.base - 1] = decimal(self.condition.value)
        return x

    def radii(self, zero, distance):
        """The box where the parameter is within a distance, and the other unknowns within the same share of their units."""
        middle = [y.real for y in zero.middle]
        zones = [middle[3 * i : 3 * i + 3] for i in range(self.count)]
        period, rate = sum(abs(t) for _, _, t in zones), size([1] + [w for _, w, _ in zones])
        units = [unit for y, _, t in zones for unit in (abs(y).max(period), rate, abs(t).max(period))]
        units += [middle[self.base - 2], arb(double(self.posed["unit"]))] + [abs(y).max(arb(1)) for y in middle[self.base :]]
        return [unit * (arb(double(distance)) / units[self.base - 1]) for unit in units]

    def unique(self, zero, distance):
        """Less than 1 if the equations are injective over the box of a distance about the zero."""
        middle, radii = [y.real for y in zero.middle], self.radii(zero, distance)
        found = lambda box, _: self.slope(box, radii)
        told = {"Value": [self.base - 1]}.get(self.kind, [] if self.vanishing is None else [3 * self.vanishing + 2])
        norm = injective(found, middle, radii, [self.base - 2, self.base - 1], PARTS[:1], told)
        # of eigenvalues there are no second derivatives
        if norm < 1 or self.kind != "Crossing" and (norm := lesser(norm, self.curved(middle, radii))) < 1:
            return norm
        return lesser(norm, injective(found, middle, radii, [self.base - 2, self.base - 1], PARTS[1:], told))

    def curved(self, middle, radii):
        """The same by second derivatives."""
        held, equations = self.kind == "Value", self.equations
        if held:
            value = middle[-1]
            equations, middle, radii = (lambda x: self.equations([*x, value])[:-1]), middle[:-1], radii[:-1]
        size = len(middle)
        # equations of a fold are linear in its direction
        linear = range(self.base, size) if self.kind == "Fold" else ()
        pairs = [(j, k) for j in range(size) for k in range(j, size) if j not in linear]
        return bent(equations, middle, list(parted(middle, radii, [], 1)), radii, pairs)

    def slope(self, box, units):
        """The Jacobian of the equations over a box, its columns times `units`."""
        if self.kind != "Fold":
            return jacobian(self.equations, box, units)
        # of F = 0, F_x v = 0 and an entry of v put to 1
        count, x, v = self.base - 1, [acb(y) for y in box[: self.base]], [acb(y) for y in box[self.base :]] + [0]
        columns = []
        for j, unit in enumerate(units[: self.base]):
            seeds = [Dual(Dual(y, unit if i == j else 0), Dual(z, 0)) for i, (y, z) in enumerate(zip(x, v))]
            found = [(dual(y.v).d, dual(y.d).d) for y in map(dual, self.switches(seeds)[0])]
            columns.append([one for one, _ in found] + [other for _, other in found] + [0])
        for j, unit in enumerate(units[self.base :]):
            share = unit / units[j]
            columns.append([0] * count + [y * share for y in columns[j][:count]] + [unit if j == self.largest else 0])
        return acb_mat(columns).transpose()


# ------------------------------------------------------------------------------------------------ inequalities
def real(number):
    """A number that is known to be real."""
    return acb(number).real


class Signs:
    """The inequalities of a wave whose unknowns are enclosed."""

    def __init__(self, wave, x):
        self.wave, self.parts = wave, wave.parts(x)
        self.m, self.c = Model(*map(real, self.parts.m)), real(self.parts.c)
        self.zones = [[real(y) for y in zone] for zone in self.parts.zones]
        self.touch = real(x[wave.base]) if wave.watch in TOUCHES else None
        self.parameter = real(x[wave.base - 1])

    def matrix(self, zone):
        """A of x′ = Ax."""
        return self.parts.matrices[zone]

    def state(self, zone, time):
        """The state at a time after the beginning of a zone."""
        return apply(exponential(self.matrix(zone), time), self.parts.begins[zone])

    def positive(self, zone, row, left, right, touched=False):
        """Whether a row of the state is positive inside a zone, with zeros of known order at its ends and, where
        it is touched, one of order 2 at the time of the touch."""
        length = self.zones[zone][2]
        times, orders = ([arb(0), self.touch, length], [left, 2, right]) if touched else ([arb(0), length], [left, right])
        states, span = [self.state(zone, time) for time in times], range(len(times) - 1)
        between = lambda i: positive(self.matrix(zone), row, *states[i : i + 2], times[i + 1] - times[i], orders[i : i + 2])
        return all(map(between, span))

    def lands_still(self, zone):
        """Whether a flight that begins and ends at P = 0 lands without speed.

        Without damping U even, V odd about its middle is a symmetry. The odd U and even V of such a flight solve
        the equations without forces and have U = V̇ = 0 at both ends: they vanish unless a determinant does.
        """
        wave, after = self.wave, (zone + 1) % self.wave.count
        closes = wave.zones[after][1] == "Touch" and wave.vanishing == after or self.event("LandingPressure", after)
        # a Coulomb impact changes V̇
        closes = closes and not wave.coulomb
        free = wave.posed["parameter"] != "MassDamping" and not exact(wave.posed["written"]["damping"])
        if not (closes and free and wave.zones[zone][1] == "TakeOff"):
            return False
        half = exponential(self.matrix(zone), self.zones[zone][2] / 2)
        return not (half[U][DU] * half[W][V] - half[U][V] * half[W][DU]).contains(0)

    def event(self, watch, zone):
        """Whether this margin of a zone is the one that vanishes."""
        return self.wave.watch == watch and self.wave.zone == zone % self.wave.count

    def presumed(self):
        """What holds of the model, of the place of an event and, by other inequalities, of the forces."""
        m, wave, written = self.m, self.wave, self.wave.posed["written"]
        yield "b > 0, g > 0 and h > 0", m.b > 0 and m.g > 0 and m.h > 0
        yield "δ > 0, f > 0, α ≥ 0", m.mismatch > 0 and m.friction > 0 and (m.damping > 0 or m.damping.is_zero())
        yield "static friction is not less than kinetic friction", exact(written["ratio"] or "1") >= 1
        if written["origin"].name == "Geometry":
            of = lambda name, text: self.parameter if name == wave.posed["parameter"] else decimal(text).real
            nu, xi, gamma = (of(name, text) for name, text in zip(NAMES, written["origin"].value))
            yield "−1 < ν < ½, ξ > 1, γ > 0", nu > -1 and 2 * nu < 1 and xi > 1 and gamma > 0
        if self.touch is not None:
            yield "the time of the touch", self.touch > 0 and self.touch < self.zones[wave.zone][2]

    def model_signs(self):
        """What the speed is to be."""
        m, c = self.m, self.c
        yield "c² > a", c * c > m.a
        yield "c² > b", c * c > m.b
        yield "a > b", m.a > m.b
        yield "the direction of D", m.d / c > 0

    def all(self):
        """(what, whether it is shown) of every inequality but the one that vanishes at the event."""
        wave, m, c, none = self.wave, self.m, self.c, self.wave.vanishing
        front, steady = m.d / c, m.g * m.mismatch
        contact, pressure = steady + front, [0, 0, 0, front, steady]
        event = self.event
        for i, (regime, entry) in enumerate(wave.zones):
            before, after = (i - 1) % wave.count, (i + 1) % wave.count
            (v, _, t), (came, via), (goes, switch) = self.zones[i], wave.zones[before], wave.zones[after]
            force, limit = m.h * v + m.damping, m.static * contact
            landed = [real(y) for y in self.parts.ends[before]]
            if came == "Separation" and before != none and not event("LandingSpeed", before) and not self.lands_still(before):
                yield "U̇ < 0 at landing", landed[DU] < 0
            if entry == "ArrestedLanding" and not event("Impulse", before):
                yield "the impulse that arrests", wave.impulse(m, c, landed[DU]) > abs(1 - landed[W])
            if entry == "Touch" and wave.coulomb:
                yield "V̇ < 1 after the impulse of a touch", self.zones[i][1] < 1
            # without static friction the sign of V̈ says as much where a landing slides at once
            slides = entry == "Reversal" or entry == "ArrestedLanding" and wave.static
            if slides and i != none and regime == "Reverse" and wave.static:
                yield "Q < −rfP where reverse slip begins", -force > limit
            if slides and i != none and regime == "Slip" and not event("UpperForce", before):
                yield "Q > rfP where slip begins", force > limit
            if i == none:
                continue
            yield "a duration", t > 0
            touched = lambda watch, zone=i: event(watch, zone)
            if regime == "Stick":
                yield "P > 0 in stick", contact > 0
                if not (event("LowerForce", i) or before == none and came == "Reverse" and via in KNOWN_ZEROS[W]):
                    yield "Q > −fP in stick", force > -limit
            elif regime == "Separation":
                left, right = KNOWN_ZEROS[U][entry] + event("Tension", i), 1 + event("LandingSpeed", i)
                right = 3 if self.lands_still(i) else right
                yield "U > δ in separation", self.positive(i, [1, 0, 0, 0, 0], left, right, touched("Gap"))
            else:
                # with V̇ = 1 and Q = fP at an end V̈ vanishes there
                left = {"Release": 1 if wave.static else 2, "Landing": int(event("LandingRate", i))}.get(entry, 1)
                left += event("UpperForce", before) and not wave.static
                right = int(switch in ("Arrest", "Reversal"))
                right += switch == "Arrest" and after == none and regime == "Slip" and not wave.static
                lag = [0, 0, 0, -1, 1] if regime == "Slip" else [0, 0, 0, 1, -1]
                yield "the sign of 1 − V̇", self.positive(i, lag, left, right, touched("Rate"))
                left, right = int(event("LandingPressure", i)), int(switch == "TakeOff")
                right += goes == "Separation" and after == none
                if before == none and came == "Separation":
                    left = 1 if via == "Touch" else 2
                yield "P > 0 in sliding", self.positive(i, pressure, left, right, touched("Pressure"))
