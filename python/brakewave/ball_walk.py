"""Arcs of branches of waves, followed in points: what refutes that between two waves there is one curve without an event.

check.py says what it is for. A curve is followed by Newton's method from one end to the other, without bounds of what lies between its
points. So an event on the way is found, and that there is none is not shown.
"""

from flint import acb, acb_mat, arb, ctx

from .balls import NotCovered, Refused, Tagged, must, prove_zero, size, slopes

STEPS, SHORTEST, LONGEST = 400, 1e-5, 0.125
"""Steps of a curve; the least and the largest length of one in units of the unknowns, of which that of the parameter is the width of the
arc."""
ALONG, STEP = 96, arb(2) ** -36
"""Bits in which curves are followed; step of the differences of their equations, in units."""
TRIES, CLOSE = 24, arb(2) ** -44
"""Steps of Newton's method with the slope of the point before, which ends with one below this, in units: far below what tells an
inequality on the way, and what remains at its ends."""
STRAIGHT, BENT = 0.995, 0.95
"""Cosines of the angle between two tangents: above the first the next step is longer, below the second this one is taken again with a
half of its length."""
ARRIVED, STATIONARY = 1e-6, 1e-8
"""Waves agree whose unknowns differ by less, in units; the parameter is stationary where it moves by less along a unit of the curve."""

AWAY = "the curve does not lead to its last end"
"""What is said of a curve that leaves the values of the parameter between its ends, to which it does not come back without a fold."""


def dot(one, other):
    return sum(a * b for a, b in zip(one, other))


class Walk:
    """The way from one wave to another of the same sequence of zones, whose unknowns are given, in units."""

    def __init__(self, wave, ends, inequalities):
        self.wave, self.inequalities, self.place, self.bits = wave, inequalities, wave.base - 1, ctx.prec
        ends = [[y.real.mid() for y in x[: wave.base]] for x in ends]
        lengths, rates = zip(*(([x[3 * i + 2] for i in range(wave.count)], [x[3 * i + 1] for i in range(wave.count)]) for x in ends))
        period, rate = max(float(sum(map(abs, times))) for times in lengths), max([1.0, *(abs(float(w)) for ws in rates for w in ws)])
        excess = max(abs(float(x[wave.base - 2])) for x in ends)
        self.width = abs(float(ends[1][self.place] - ends[0][self.place]))
        must(self.width > 0, "its ends have one value of the parameter")
        self.units = [period, rate, period] * wave.count + [excess, self.width]
        self.ends = [self.scaled(x) for x in ends]

    def scaled(self, x):
        return [y / unit for y, unit in zip(x, self.units)]

    def unscaled(self, z):
        return [y * unit for y, unit in zip(z, self.units)]

    def equations(self, z):
        return self.wave.switches(self.unscaled(z))[0]

    def slope(self, z):
        """The Jacobian, by differences."""
        return slopes(self.equations, z, STEP)

    def solved(self, rows, side):
        """The solution of linear equations."""
        return [y.real.mid() for y in acb_mat(rows).solve(acb_mat([[y] for y in side]), algorithm="approx").entries()]

    def tangent(self, rows, along):
        """The unit vector along the curve whose product with another is positive."""
        found = self.solved([*rows, along], [0] * len(rows) + [1])
        length = dot(found, found).sqrt()
        return [(y / length).mid() for y in found]

    def point(self, guess, normal, rows):
        """The wave next to a guess in the plane through it with a normal, by the Jacobian of a wave nearby."""
        z, inverse = guess, acb_mat([*rows, normal]).inv().mid()
        for _ in range(TRIES):
            step = (inverse * acb_mat([[y] for y in [*self.equations(z), 0]])).entries()
            z = [(y - s.real).mid() for y, s in zip(z, step)]
            far = size(step)
            if far < CLOSE:
                return z
            if not far < LONGEST:
                break
        raise NotCovered("a curve that is not followed")

    def start(self, rows, side):
        """The first tangent: along the fold to one of its sides, into what opens, or towards the other end."""
        toward = self.ends[1][self.place] - self.ends[0][self.place]
        for k in [self.place, *range(self.place)]:
            try:
                tangent = self.tangent(rows, [int(j == k) for j in range(self.place + 1)])
            except ZeroDivisionError:
                continue
            largest = max(range(self.place), key=lambda j: abs(float(tangent[j])))
            opening = [3 * zone + 2 for zone in self.wave.divided if abs(float(self.ends[0][3 * zone + 2])) < ARRIVED]
            turns = abs(float(tangent[self.place])) < STATIONARY
            # a zone opens to a positive duration
            ahead = tangent[opening[0]] if opening else side * tangent[largest] if turns else tangent[self.place] * toward
            tangent = tangent if ahead > 0 else [-y for y in tangent]
            must(turns or tangent[self.place] * toward > 0, AWAY)
            return tangent
        raise NotCovered("a curve whose tangent is not found")

    def has_arrived(self, z, there):
        """Whether the curve between two points leads through its last end."""
        chord = [b - a for a, b in zip(z, there)]
        way = [b - a for a, b in zip(z, self.ends[1])]
        share = float(dot(way, chord) / dot(chord, chord))
        if not -0.01 <= share <= 1.01:
            return False
        at = [a + share * c for a, c in zip(z, chord)]
        apart = lambda one, other: max(abs(float(a - b)) for a, b in zip(one, other))
        if apart(at, self.ends[1]) > LONGEST:
            return False
        # the product of what remains with the chord is zero: the plane through the end
        found = self.point(at, chord, self.slope(at))
        return apart(found, self.ends[1]) < ARRIVED

    def look(self, z):
        """That a wave on the way has all inequalities. Where they are not shown in doubles, the wave with the nearest of these as its
        parameter is proven for it."""
        x = [acb(y) for y in self.unscaled(z)]
        try:
            self.inequalities(self.wave, x)
        except Refused:
            value = float(x[self.place].real)
            self.wave.condition = Tagged("Value", repr(value))
            with ctx.workprec(self.bits):
                try:
                    proven = self.wave.enclosed(prove_zero(self.wave.equations, x))
                except Refused:
                    raise NotCovered("a curve that is not followed") from None
                try:
                    self.inequalities(self.wave, proven)
                except Refused as reason:
                    raise Refused(f"at {value:.6g} on the way {reason}") from None

    @ctx.workprec(ALONG)
    def follow(self, side):
        """Follows the curve from the first end to the last."""
        z, rows = self.ends[0], self.slope(self.ends[0])
        before, length = self.start(rows, side), 1 / 32
        direction = self.ends[1][self.place] - self.ends[0][self.place]
        for _ in range(STEPS):
            try:
                there = self.point([y + length * t for y, t in zip(z, before)], before, rows)
                new = self.slope(there)
                after = self.tangent(new, before)
            except (NotCovered, ZeroDivisionError):
                after = None
            if after is None or dot(before, after) < BENT:
                length /= 2
                if length < SHORTEST:
                    break
                continue
            if self.has_arrived(z, there):
                return
            passed = (there[self.place] - self.ends[0][self.place]) * direction
            must(0 < passed < direction * direction, AWAY)
            must(after[self.place] * direction > 0, "there is a fold on the way")
            self.look(there)
            if dot(before, after) > STRAIGHT:
                length = min(2 * length, LONGEST)
            z, before, rows = there, after, new
        raise NotCovered("a curve that is not followed to its end")


def walk(wave, ends, inequalities, sides):
    """Refuses that between two waves there is no event where on every side from the first the curve does not lead to the other, or has a
    wave without all inequalities."""
    arc, found = Walk(wave, ends, inequalities), []
    for side in sides:
        try:
            return arc.follow(side)
        except (Refused, NotCovered) as reason:
            found.append(reason)
    raise next((reason for reason in found if isinstance(reason, NotCovered)), found[0])
