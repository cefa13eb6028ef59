"""Arcs of branches of orbits in balls of Arb (python-flint): that between two of them there is one curve without an event.

Written from docs/systems.md, apart from the program. check.py says what it is for. A curve is followed in pieces: in a tube about a
chord Krawczyk's operator has exactly one zero for every value of a coordinate. Zones are cut, so that no long products are formed.
"""

from contextlib import suppress
from math import ceil, inf

from flint import arb, arb_mat, ctx

from .ball_orbits import ALMOST, TURNED, Orbit, combine, listed
from .balls import Dual, NotCovered, Refused, apply, distance, double, dual, exponential, must, nearly_inverse, real, times, whole

ALONG, POINT, TUBE = 80, arb(2) ** -50, arb(2) ** -46
"""Bits in which curves are followed; the radii of points and of tubes at least, in units: far above rounding, and one after the other
far below what a piece of a curve bends. Steps of Newton's method end before."""
TURNS = 2.0
"""A part of a zone on a curve lasts no longer than this over the largest rate of its mode."""
PIECES, SHORTEST, BY_FAR = 2000, 1e-6, 8.0
"""Pieces of a curve; their least length in units; the parameter is their coordinate unless another moves so much more."""
TRIES, CALM = 4, 3
"""Tubes of growing width that are tried; pieces that hold before a longer one is tried."""


class Arc:
    """The orbits between two of one sequence: a curve in the unknowns of orbits without an event."""

    def __init__(self, ends, near):
        (self.first, one), (self.last, other) = ends
        domain = real(one[self.first.place]).union(real(other[self.last.place]))
        self.orbit = Orbit(self.first.posed, near, "Value", domain)
        self.orbit.divide_by({*self.first.closed, *self.last.closed})
        self.orbit.facts = self.orbit.lasting = self.orbit.known()
        whole = [self.uncut(*end) for end in ends]
        parts = self.parts(whole)
        self.ends = [self.divided(x, parts) for x in whole]
        self.orbit.divide(parts)
        self.place = self.orbit.place
        units = self.orbit.posed["units"]
        states, self.units = [*map(double, units["states"])], []
        for n in parts:
            self.units += states * n + [double(units["time"])]
        self.units += [1.0] * self.orbit.forced + [double(units["parameter"])]
        # where a zone that has no duration at an end stands, which is not cut
        self.closed = [[sum(parts[:zone]) for zone in orbit.closed] for orbit in (self.first, self.last)]
        self.opening = [self.orbit.times[k] for k in self.closed[0]]
        # a duration in which the parameter is stationary at an end is the coordinate there
        self.leads = [None, None]
        for which, orbit in enumerate((self.first, self.last)):
            if len(orbit.closed) == 1 and orbit.stationary(orbit.closed[0]):
                self.leads[which] = self.orbit.times[self.closed[which][0]]

    def uncut(self, orbit, x):
        """Unknowns with one duration for a zone that is cut."""
        found, width = [], orbit.n + 1
        for index, stretch in enumerate(orbit.stretches):
            part = x[index * width : (index + 1) * width]
            if index and orbit.stretches[index - 1].zone == stretch.zone:
                found[-1] = found[-1] + part[-1]
            else:
                found += part
        return [real(y) for y in found + x[len(orbit.stretches) * width : orbit.place + 1]]

    def parts(self, ends):
        """Into how many parts zones are cut: by what their largest rate makes of the longer of two durations."""
        longest, width = [0.0] * len(self.orbit.stretches), self.orbit.n + 1
        for x in ends:
            modes = self.orbit.exact.at(x[self.orbit.place].mid())
            for k, stretch in enumerate(self.orbit.stretches):
                rate = max(abs(float(real(entry).mid())) for line in modes.matrices[stretch.mode] for entry in line[: self.orbit.n])
                longest[k] = max(longest[k], rate * float(x[k * width + self.orbit.n].real.mid()))
        closed = {*self.first.closed, *self.last.closed}
        return [1 if k in closed else max(1, ceil(turns / TURNS)) for k, turns in enumerate(longest)]

    def divided(self, x, parts):
        """Unknowns with the states between the parts of zones."""
        found, (modes, whole), width = [], self.orbit.parts(x), self.orbit.n + 1
        for k, (n, (_, time, z, *_)) in enumerate(zip(parts, whole)):
            flow = exponential(modes.matrices[self.orbit.stretches[k].mode], time / n)
            for _ in range(n):
                found += z[: self.orbit.n]
                z = apply(flow, z)
            found.append(time / n)
        return found + x[len(parts) * width :]

    def values(self, x):
        """The equations of the orbit at numbers, as a column that ends with that of a coordinate, which holds."""
        return arb_mat([[y] for y in [*self.orbit.cycle(*self.orbit.parts(x)), 0]])

    def stack(self, rows, k):
        """A Jacobian with the row of coordinate k."""
        return arb_mat([*rows, [int(j == k) for j in range(self.place + 1)]])

    @staticmethod
    def inverse(stack):
        """About the inverse of a matrix of balls."""
        try:
            return nearly_inverse(stack)
        except ZeroDivisionError:
            raise NotCovered("the equations are singular on the way") from None

    def tube(self, middle, chord, reach, inverse, k, least):
        """Krawczyk's operator with coordinate k as a parameter maps a tube about middle + t·chord, |t| ≤ reach, into its
        interior, which so has one zero for each t: the tube, its radii, in units at least as large as `least`, and the Jacobian over
        it. A first guess of the inverse is replaced by that of the Jacobian."""
        values, better, along = self.values(middle), None, arb(0, 1) * reach
        error = (inverse * values).entries()
        # of a parabola the middle is a third as far from the chord as the operator reaches
        radii = [(6 * abs(e)).upper() + arb(u) * least for e, u in zip(error, self.units)]
        for turn in range(TRIES):
            tube = [m + t * along + arb(0, 1) * r for m, t, r in zip(middle, chord, radii)]
            rows = self.orbit.slope(tube).tolist()
            steep = self.stack(rows, k)
            if better is None:
                better = self.inverse(steep)
                error = better * values
            # the row of the coordinate holds along the chord
            drift = [*(steep * arb_mat([[t] for t in chord])).entries()[:-1], 0]
            defect = better * steep - self.one
            spread = defect * arb_mat([[arb(0, 1) * r] for r in radii])
            reached = error + better * arb_mat([[d * along] for d in drift]) + spread
            image = [abs(y).upper() for y in reached.entries()]
            left = max(float((abs(y) / r).upper()) for y, r in zip(spread.entries(), radii))
            if all(a < b for a, b in zip(image, radii)):
                return tube, radii, rows
            # a wider tube has a larger one, but for the proportions of the first
            if not left < 1 and turn or not max(map(float, image)) < inf:
                break
            more = 1.25 if turn == 0 else 1 / (1 - left)
            radii = [r.max(a * more).upper() for r, a in zip(radii, image)]
        raise NotCovered("no tube has exactly one curve")

    def point(self, guess, k, inverse):
        """The orbit next to a guess with its value of a coordinate, by Newton's method with an inverse from nearby, and the Jacobian
        there: a tube without length."""
        value, middle, before = guess[k].mid(), [y.mid() for y in guess], 1.0
        for _ in range(20):
            steps = (inverse * self.values(middle)).entries()
            middle = [(y - step).mid() for y, step in zip(middle, steps)]
            far = max(float(abs(step).mid()) / u for step, u in zip(steps, self.units))
            # the next would be smaller by as much as this one was
            if far * min(far / before, 1) < ALMOST:
                break
            if far > before / 30:
                inverse = self.inverse(self.stack(self.orbit.slope(middle).tolist(), k))
            before = far
        middle[k] = value
        box, _, rows = self.tube(middle, [arb(0)] * len(middle), arb(0), inverse, k, POINT)
        return [*box[:k], value, *box[k + 1 :]], rows

    def tangent(self, rows):
        """The tangent in units where the Jacobian is this, and the coordinate that moves most."""
        for coordinate in [self.place, *range(self.place)]:
            try:
                solved = self.stack(rows, coordinate).mid().solve(arb_mat([[0]] * self.place + [[1]]), algorithm="approx")
            except ZeroDivisionError:
                continue
            scaled = [float(solved[i, 0].mid()) / u for i, u in enumerate(self.units)]
            size = max(map(abs, scaled))
            most = self.place if abs(scaled[self.place]) * BY_FAR > size else max(range(len(scaled)), key=lambda i: abs(scaled[i]))
            return [y / size for y in scaled], most
        raise NotCovered("a curve whose tangent is not found")

    @ctx.workprec(ALONG)
    def follow(self, side):
        """Shows the curve from one end to the other. Returns the number of pieces."""
        (x, last), before, count = self.ends, None, 0
        self.one = arb_mat([[int(i == j) for j in range(self.place + 1)] for i in range(self.place + 1)])
        rows = self.orbit.slope([y.mid() for y in x]).tolist()
        longest, calm, left = inf, CALM, lambda x, k: float((last[k] - x[k]).mid())
        while count < PIECES:
            tangent, k = self.tangent(rows)
            k = k if count or self.leads[0] is None else self.leads[0]
            inverse = self.inverse(self.stack(rows, k))
            lead = k if self.first.kind == "Fold" else self.place
            away = tangent[self.opening[0]] if self.opening else tangent[lead] * left(x, lead)
            way = sum(a * b for a, b in zip(before, tangent)) if before else away * side
            before = tangent if way > 0 else [-y for y in tangent]
            direction, length = (1 if before[k] > 0 else -1), min(longest, self.units[k])
            rest = left(x, k) * direction
            # an orbit that is far from the end in other unknowns passes by
            # the parameter turns at the ends only: the curve does not come back to a value that it has passed
            apart = [x[self.place] - end[self.place] for end in self.ends]
            must(not count or not apart[0] * apart[1] > 0, "the curve does not lead to its last end")
            far = max(abs(left(x, i)) / unit for i, unit in enumerate(self.units))
            if rest > 0 and far < 1000 * rest / self.units[k]:
                length = min(length, rest / 2)
                if count and rest < 16 * length:
                    with suppress(Refused, NotCovered):
                        j = k if self.leads[1] is None else self.leads[1]
                        near = inverse if j == k else self.inverse(self.stack(rows, j))
                        self.piece(x, last, j, 1 if before[j] > 0 else -1, 1, near)
                        return count + 1
            while True:
                value = (x[k].mid() + direction * length).mid()
                step = float((value - x[k]).mid()) / (before[k] * self.units[k])
                guess = [y.mid() + step * b * u for y, b, u in zip(x, before, self.units)]
                guess[k] = value
                try:
                    there, new = self.point(guess, k, inverse)
                    self.piece(x, there, k, direction, None if count else 0, inverse)
                    break
                except (Refused, NotCovered):
                    # next to an end pieces are as short as it is near
                    near = [abs(float((x[k] - end[k]).mid())) / 64 for end in self.ends if count]
                    if length < min([SHORTEST * self.units[k], *near]):
                        raise
                length, calm = length / 2, 0
            # a longer one is tried after some that held
            x, rows, count, longest, calm = there, new, count + 1, length * (1.5 if calm >= CALM else 1), calm + 1
        raise NotCovered("more pieces than are tried")

    def piece(self, x, y, k, direction, next_to, inverse):
        """Shows a piece of the curve from one orbit to another, of which the first end of the arc is one at `next_to` = 0, its
        last at 1: that it is one curve without a fold, with all inequalities."""
        reach = (abs(y[k] - x[k]) / 2).upper() * (1 + arb(2) ** -40)
        middle = [((a + b) / 2).mid() for a, b in zip(x, y)]
        slope = [((b - a) / (y[k] - x[k])).mid() for a, b in zip(x, y)]
        slope[k] = arb(1)
        tube, radii, rows = self.tube(middle, slope, reach, inverse, k, TUBE)
        off = lambda z, i: abs(z[i] - middle[i] - (z[k] - middle[k]) * slope[i])
        if not all(off(z, i) < radii[i] for z in (x, y) for i in range(len(x)) if i != k):
            raise NotCovered("no tube has both ends")
        tangent = [t + arb(0, 1) * (r / reach) for t, r in zip(slope, radii)]
        tangent[k] = arb(1)
        # det(P − 1) vanishes at folds: at an end, and if it is monotone there only
        if k != self.place and tangent[self.place].contains(0):
            end = (self.first, self.last)[next_to or 0]
            along = [Dual(z, d) for z, d in zip(tube, tangent)]
            must(next_to is not None, "there may be a fold on the way")
            if k == self.leads[next_to]:
                bends = self.bend(along, self.closed[next_to][0], self.stack(rows, k))
            else:
                must(end.kind == "Fold", "there may be a fold on the way")
                bends = self.folds(along, rows)
            must(not bends.contains(0), "there may be a fold on the way")
        sign = 0 if next_to is None else direction if next_to == 0 else -direction
        moving = tube if not sign else [Dual(z, sign * d) for z, d in zip(tube, tangent)]
        self.orbit.settle(tube[self.place])
        closed = () if next_to is None else self.closed[next_to]
        wrong = [what for what, holds in self.orbit.all_signs(moving, closed) if not holds]
        must(not wrong, f"{', '.join(wrong)} is not shown on the way")

    def folds(self, along, rows):
        """The derivative along a curve, of which the Jacobian over a piece is given, of what is zero where the parameter is stationary:
        without products of matrices that lead through many parts of zones, unless a zone may have no duration."""
        orbit, radii = self.orbit, [arb(unit) for unit in self.units[: self.place]]
        if orbit.divisors:
            return distance(orbit.returned(*orbit.parts(along)), 1).d
        rows = orbit.closing(rows, 1)
        try:
            border = orbit.border([[a.mid() for a in map(real, row)] for row in rows], radii)
        except ZeroDivisionError:
            raise NotCovered("the equations are singular on the way") from None
        vectors = orbit.null_vectors(rows, border, radii)
        must(vectors, "there may be a fold on the way")
        right, left = vectors
        return -sum((dual(y).d for y in orbit.linear(along, right, 1, left, None)), arb(0))

    def bend(self, along, index, steep):
        """p′/T along a curve with T′ = 1 from T = 0 on, T the duration of a zone in which the parameter is stationary there. With v,
        which takes that time from the zone before, ∂F·v is zero at T = 0, so that with x′ = v + Tw it is ∂F·w = −∂F·v/T."""
        orbit, n = self.orbit, self.orbit.n
        last = (index - 1) % len(orbit.stretches)
        before, own = orbit.stretches[last], orbit.stretches[index]
        modes, parts = orbit.parts(along)
        row, exits = modes.guards[before.mode][before.end[1]]
        guard, ways = modes.guards[own.mode][own.end[1]]
        led = [combine(line, modes.matrices[before.mode]) for line in exits[before.end[2]][1]]
        # by the mean value theorem what is zero at T = 0 is T times a derivative along the curve
        grown = lambda forms, z: [dual(y).d for y in apply(forms, z)]
        still = lambda lines: [[dual(y).v for y in line] for line in lines]
        apart = [a - b for a, b in zip(grown(modes.matrices[own.mode][:n], parts[index][2]), grown(led, parts[last][4]))]
        ends = apply(still(parts[index][3]), apart + [0] * (orbit.exact.size - n))
        side = [arb(0)] * len(along)
        side[orbit.times[last]] += grown([combine(row, modes.matrices[before.mode])], parts[last][4])[0]
        for i, y in enumerate(apply(still([*ways[own.end[2]][1], guard]), ends)):
            side[orbit.firsts[index] + i] -= y
        inverse = self.inverse(steep)
        about, defect = times(inverse, side), (inverse * steep - self.one).tolist()
        sizes = [(abs(y) * 1.1).upper() + arb(2) ** -ALONG for y in about]
        for _ in range(TURNED):
            rest = [sum(abs(z) * size for z, size in zip(line, sizes)).upper() for line in defect]
            if all(abs(y) + r < size for y, r, size in zip(about, rest, sizes)):
                return about[self.place] + arb(0, 1) * rest[self.place]
            sizes = [size.max((abs(y) + r) * 1.5).upper() for y, r, size in zip(about, rest, sizes)]
        raise NotCovered("no bound of how a curve bends")


def join(ends, nears):
    """Shows that between two orbits there is no event."""
    (one, _), (two, _) = ends
    given = lambda orbit: [v for i, v in enumerate(orbit.posed["values"]) if i != whole(orbit.posed["parameter"])]
    same = one.posed["system"] == two.posed["system"] and given(one) == given(two)
    same = same and [one.posed[name] for name in ("parameter", "periods")] == [two.posed[name] for name in ("parameter", "periods")]
    must(same and listed(nears[0]["sequence"]) == listed(nears[1]["sequence"]), "its ends have not one sequence of zones")
    if one.half or two.half:
        raise NotCovered("arcs at a branch point")
    arc = Arc(ends, nears[0])
    try:
        return arc.follow(1)
    except (Refused, NotCovered):
        if one.kind not in ("Fold", "Margin") or one.closed:
            raise
        return arc.follow(-1)
