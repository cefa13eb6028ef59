"""Waves with material damping β > 0 that stay in contact, in balls of Arb, from "Material damping" of docs/theory.md.

Sliding is βã V⃛ = m V̈ + s V̇ + h(V − V*), ã = a/c², m = 1 − ã − βσfD/c, s = α + βh − σfD/c, hV* = σfgδ. With a root R of
βãr³ − mr² − sr − h = βã(r − R)(r² + Br + C) the number q = V̈ + BV̇ + C(V − V*) obeys q̇ = Rq, and v = V − q/(R² + BR + C)
v̈ + Bv̇ + C(v − V*) = 0. R is large: a zone is followed from its end, where V̇ = 1, back to its beginning.
"""

from collections import namedtuple

from flint import acb, arb

from .ball_waves import SLIDING, Signs, W, Wave, real
from .balls import Dual, NotCovered, apply, dual, exponential, must

Q = 0
"""Place of q in the state (q, 0, v, v̇, 1)."""
Sliding = namedtuple("Sliding", "rate matrix rows")
"""R, the matrix of x′ = Ax, and V, V̇, V̈ as rows."""
LayeredParts = namedtuple("LayeredParts", "m c zones sliding begins ends")
"""Model, speed, (V, V̈, T) at the ends of the zones, their equations, and (V, V̇, V̈) at their beginnings and ends."""


def root(numbers):
    """The largest root R of βãr³ − mr² − sr − h, for balls the only one in a ball: Newton's operator maps that into itself."""
    plain = [acb(dual(y).v) for y in numbers]
    cubic = lambda r, y: ((y[0] * r - y[1]) * r - y[2]) * r - y[3]
    slope = lambda r, y: (3 * y[0] * r - 2 * y[1]) * r - y[2]
    centre = [y.mid() for y in plain]
    r = centre[1] / centre[0]
    for _ in range(300):
        # from above a convex function is followed down to its largest root
        step = (cubic(r, centre) / slope(r, centre)).mid()
        r = (r - step).mid()
        if abs(step) < abs(r) * arb(2) ** -240:
            break
    spread = abs(cubic(r, plain) / slope(r, centre)).upper() * 2 + abs(r) * arb(2) ** -230
    ball = r + acb(arb(0, spread.upper()), arb(0, spread.upper()))
    image = r - cubic(r, plain) / slope(ball, plain)
    if not ball.contains_interior(image):
        raise NotCovered("the rate of the layer is not isolated")
    if not any(isinstance(y, Dual) for y in numbers):
        return image
    moved = [Dual(0, dual(y).d) for y in numbers]
    return Dual(image, -(cubic(Dual(image), moved).d) / slope(image, plain))


class Layered(Wave):
    """The boundary-value problem of a wave with layers. Unknowns are V less that of a steady slip, V̈ and T at the end of every
    zone, where V̇ = 1, and those of the speed, the parameter and the event."""

    def prepare(self):
        """The unknowns of the ends of zones."""
        if any(regime == "Separation" for regime, _ in self.zones):
            raise NotCovered("separation with material damping")
        must(not self.static, "static friction with material damping")
        if self.kind == "Crossing":
            raise NotCovered("eigenvalues with material damping")
        must(self.watch != "UpperForce" or self.zones[self.zone][0] == "Reverse", "a margin of a landing")
        if self.vanishing is not None and self.zones[self.zone][0] != "Stick":
            raise NotCovered("a sliding zone that opens or closes with material damping")
        entries = self.guess[:]
        for i in range(self.count):
            self.guess[3 * i] = entries[3 * ((i + 1) % self.count)]
            self.guess[3 * i + 1] = acb(0)
        for i, (regime, _) in enumerate(self.zones):
            if regime != "Stick" and self.zones[(i + 1) % self.count][0] != "Stick":
                # V̇ at the beginning is linear in V̈ at the end
                starts = []
                for trial in (0, 1):
                    self.guess[3 * i + 1] = acb(trial)
                    starts.append(self.parts(self.guess).begins[i][1])
                self.guess[3 * i + 1] = ((entries[3 * i + 1] - starts[0]) / (starts[1] - starts[0])).mid()

    def is_condition(self, watch, zone):
        """P may be least in reverse slip, too, and Q < fP end at a release."""
        if watch == "Release":
            return self.zones[zone][1] == "Release"
        sliding = watch == "Pressure" and self.zones[zone][0] in SLIDING
        return sliding or super().is_condition(watch, zone)

    def legs(self, parts):
        """(regime, (V, V̇, V̈) at the beginning and at the end, duration) of the zones that have a length."""
        legs = []
        for i, (regime, _) in enumerate(self.zones):
            v, _, time = parts.zones[i]
            end = [v, 1, 0] if regime == "Stick" else apply(parts.sliding[i].rows, parts.ends[i])
            legs += [(regime, parts.begins[i], end, time)] if i != self.vanishing else []
        return legs

    @staticmethod
    def sliding(m, c, regime):
        """R, A and rows of a sliding zone."""
        drive = (m.friction if regime == "Slip" else -m.friction) * (m.d / c)
        share, sign = m.a / (c * c), 1 if regime == "Slip" else -1
        numbers = [m.material * share, 1 - share - m.material * drive, m.damping + m.material * m.h - drive, m.h]
        rate = root(numbers)
        first = numbers[0]
        # βã(r − R)(r² + Br + C): RC = h/βã, RB = C + s/βã
        c0 = m.h / (first * rate)
        b = (c0 + numbers[2] / first) / rate
        rest = sign * m.friction * m.g * m.mismatch / m.h
        unit = rate * rate + b * rate + c0
        rise, fall = [0, 0, 0, 1, 0], [0, 0, -c0, -b, c0 * rest]
        matrix = [[rate, 0, 0, 0, 0], [0] * 5, rise, fall, [0] * 5]
        rows = [[1 / unit, 0, 1, 0, 0], [rate / unit, 0, 0, 1, 0], [rate * rate / unit, 0, -c0, -b, c0 * rest]]
        return Sliding(rate, matrix, rows)

    @staticmethod
    def before(sliding, end, time):
        """The state a time before another, of a sliding zone."""
        rows = [row[2:] for row in sliding.matrix[2:]]
        smooth = apply(exponential(rows, -1 * time), end[2:])
        decay = dual(-1 * (sliding.rate * time)).exp()
        decay = decay if isinstance(sliding.rate, Dual) or isinstance(time, Dual) else decay.v
        return [end[Q] * decay, 0, *smooth]

    @staticmethod
    def at_end(sliding, v, acceleration):
        """The state where V, V̇ = 1 and V̈ are given."""
        fall = sliding.matrix[W]
        q = acceleration - fall[2] * v - fall[3] - fall[4]
        return [q, 0, v - q * sliding.rows[0][Q], 1 - q * sliding.rows[1][Q], 1]

    def parts(self, x):
        """What follows from the unknowns."""
        m, c, zones = self.unpack(x)
        sliding, begins, ends = [], [], []
        for (regime, _), (v, acceleration, time) in zip(self.zones, zones):
            if regime == "Stick":
                sliding.append(None)
                ends.append(None)
                begins.append([v - time, 1, 0])
                continue
            sliding.append(self.sliding(m, c, regime))
            ends.append(self.at_end(sliding[-1], v, acceleration))
            begins.append(apply(sliding[-1].rows, self.before(sliding[-1], ends[-1], time)))
        return LayeredParts(m, c, zones, sliding, begins, ends)

    def switches(self, x):
        """V, V̇ and V̈ are continuous; V̇ = 1 at all switches and V̈ = 0 in stick."""
        parts, out = self.parts(x), []
        for i, (regime, _) in enumerate(self.zones):
            v, acceleration, _ = parts.zones[i - 1]
            begin = parts.begins[i]
            out.append(begin[0] - v)
            if regime == "Stick":
                out += [acceleration, parts.zones[i][1]]
            else:
                out += [begin[1] - 1, begin[2] - acceleration]
        whole = sum(t for _, _, t in parts.zones) * parts.c * self.sign
        return out + [whole - 2 * arb.pi() / self.mode], parts

    def margin(self, x, parts):
        """The margin that vanishes, and where it is a minimum its derivative."""
        m, i, watch = parts.m, self.zone, self.watch
        front, (v, acceleration, t) = m.d / parts.c, parts.zones[i]
        if watch in ("Pressure", "Rate"):
            sliding = parts.sliding[i]
            state = self.before(sliding, parts.ends[i], t - x[self.base])
            row = self.row(parts, i, watch)
            return [apply([row], state)[0], apply([row], apply(sliding.matrix, state))[0]]
        force = m.h * (parts.begins[i][0] + m.material) + m.damping
        margins = {"Duration": t, "LowerForce": force + m.friction * (m.g * m.mismatch + front), "UpperForce": acceleration}
        if watch not in margins:
            raise NotCovered(f"the margin {watch} with material damping")
        return [margins[watch]]

    @staticmethod
    def row(parts, zone, watch):
        """V̇ − 1 or P as a row."""
        m, (_, rate, acceleration) = parts.m, parts.sliding[zone].rows
        front, last = m.d / parts.c, [0, 0, 0, 0, 1]
        if watch == "Rate":
            return [y - one for y, one in zip(rate, last)]
        return [front * (y + m.material * z) + m.g * m.mismatch * one for y, z, one in zip(rate, acceleration, last)]

    def unique(self, zero, distance):
        raise NotCovered("a box in other unknowns than these; the solution is regular")


class LayeredSigns(Signs):
    """The inequalities of a wave with layers."""

    def matrix(self, zone):
        """A of x′ = Ax for the state (q, 0, v, v̇, 1)."""
        return self.parts.sliding[zone].matrix

    def state(self, zone, time):
        """The state at a time after the beginning of a zone."""
        return self.wave.before(self.parts.sliding[zone], self.parts.ends[zone], acb(self.zones[zone][2] - time))

    def all(self):
        """(what, whether it is shown) of every inequality but the one that vanishes at the event."""
        wave, m, event = self.wave, self.m, self.event
        contact = m.g * m.mismatch + m.d / self.c
        yield "β > 0", m.material > 0
        for i, (regime, entry) in enumerate(wave.zones):
            after = (i + 1) % wave.count
            (_, acceleration, t), switch = self.zones[i], wave.zones[after][1]
            first = real(self.parts.begins[i][0])
            if i == wave.vanishing:
                continue
            yield "a duration", t > 0
            if regime == "Stick":
                yield "P > 0 in stick", contact > 0
                if not event("LowerForce", i):
                    yield "Q > −fP in stick", m.h * (first + m.material) + m.damping > -m.friction * contact
                continue
            if entry == "Release":
                # Q at the end of stick: by as much as it is less than fP V⃛ is less than 0
                yield "Q < fP in stick", m.h * (first + m.material) + m.damping < m.friction * contact
            if switch == "Reversal" and regime == "Reverse" and not event("UpperForce", i):
                yield "V̈ < 0 where slip begins", acceleration < 0
            left = 2 if entry == "Release" else 1 + event("UpperForce", i - 1)
            right = 2 if switch == "Arrest" else 1 + event("UpperForce", i)
            rate, press = (wave.row(self.parts, i, watch) for watch in ("Rate", "Pressure"))
            lag = [-y for y in rate] if regime == "Slip" else rate
            yield "the sign of 1 − V̇", self.positive(i, lag, left, right, event("Rate", i))
            yield "P > 0 in sliding", self.positive(i, press, 0, 0, event("Pressure", i))
