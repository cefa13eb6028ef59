"""Distances of uniqueness of waves that are not proven: over boxes of this size Krawczyk's operator does not map into the interior.

check.py says what it is for. `unique` is the radius of a box that this operator maps into its interior, in units of all unknowns; states
between the steps of a zone are among them (docs/proofs.md). Then |C(F′(x) − F′(m))| has row sums below 1, in units, at every x of the box,
C being the inverse of F′ at its middle m. One corner at which a row sum is larger refutes it.
"""

from math import ceil, sqrt

from flint import acb, acb_mat, arb, ctx

from .ball_waves import DU, TOUCHES, U, V, W, Parts, real
from .balls import Dual, apply, double, dual, exponential, slopes

BITS, STEP = 128, arb(2) ** -44
"""Bits of the equations; step of the differences of their Jacobian, in units."""
CORNERS = 6
"""Corners that are tried, each from the signs of the one before."""
CLEARLY = 1.5
"""Row sums from which the operator is said not to map: the program may cut zones into some steps more or less."""


class Cut:
    """The equations of a wave whose zones are cut into steps of about a radian, in unknowns divided by their units: V less that of a
    steady slip, V̇ and T of a zone, the same states between its steps, with U − δ and U̇ in flight; the excess of the speed over its value;
    the parameter; at a fold the direction of the branch, of length 1."""

    def __init__(self, wave, x):
        self.wave, x = wave, [acb(y).real.mid() for y in x]
        parts = wave.parts(x[: wave.base])
        m, steady = parts.m, real(parts.zones[0][0] - x[0]).mid()
        weights = [sqrt(abs(float(real(y)))) for y in (m.g, 1 - m.b / (parts.c * parts.c), m.h, 1 - m.a / (parts.c * parts.c))]
        period, rate = float(sum(abs(x[3 * i + 2]) for i in range(wave.count))), max([1.0, *(abs(float(x[3 * i + 1])) for i in range(wave.count))])
        self.steps, self.guess, self.units, long = [], [], [], lambda y: max(abs(float(y)), period)
        for i, (regime, _) in enumerate(wave.zones):
            matrix, time, moves = parts.matrices[i], x[3 * i + 2], self.moves(regime)
            rows = ([abs(float(real(matrix[a][b]))) * weights[a] / weights[b] for b in range(W + 1)] for a in range(W + 1))
            self.steps.append(1 if regime == "Stick" else max(1, ceil(max(map(sum, rows)) * abs(float(time)))))
            self.guess += x[3 * i : 3 * i + 3]
            self.units += [long(x[3 * i]), rate, long(time)]
            for k in range(1, self.steps[-1]):
                z = [real(y).mid() for y in apply(exponential(matrix, time * k / self.steps[-1]), parts.begins[i])]
                z[V] -= steady
                self.guess += [z[place] for place in moves]
                self.units += [rate if place in (W, DU) else long(z[place]) for place in moves]
        self.excess, self.place = x[wave.base - 2], len(self.guess) + 1
        self.guess += [arb(1), x[wave.base - 1]]
        self.units += [1.0, double(wave.posed["unit"])]
        self.guess = [y / unit for y, unit in zip(self.guess, self.units)]
        self.normal = None
        if wave.kind == "Fold":
            # v in the unknowns themselves, of which the last entry is that of the parameter
            slope = slopes(self.plain, self.guess, STEP)
            about = acb_mat([[y / unit for y, unit in zip(row[: self.place], self.units)] for row in slope]).mid()
            null = [y.real for y in about.solve(acb_mat([[1]] * self.place), algorithm="approx").entries()]
            length = sum(y * y for y in null).sqrt()
            self.normal = [(y / length).mid() for y in null]
            self.guess += self.normal

    @staticmethod
    def moves(regime):
        """Places of the states that a regime moves."""
        return (V, W, U, DU) if regime == "Separation" else (V, W)

    def parts(self, y):
        """What follows from the unknowns, and by how much states between steps differ from those to which the steps lead."""
        wave, place, entries, starts, defects = self.wave, 0, [], [], []
        for (regime, _), steps in zip(wave.zones, self.steps):
            entries += y[place : place + 3]
            place, width = place + 3, len(self.moves(regime))
            starts.append([y[place + k * width : place + (k + 1) * width] for k in range(steps - 1)])
            place += (steps - 1) * width
        m, c, zones = wave.unpack([*entries, y[place] * self.excess, y[place + 1]])
        matrices = [wave.matrix(m, c, regime) for regime, _ in wave.zones]
        begins, ends, steady = [[0, 0, v, w, 1] for v, w, _ in zones], [], m.friction * m.g * m.mismatch / m.h
        for (regime, _), steps, matrix, z, (*_, time), between in zip(wave.zones, self.steps, matrices, begins, zones, starts):
            flow = exponential(matrix, time * (arb(1) / steps))
            for start in between:
                z, moves = apply(flow, z), self.moves(regime)
                there = [0, 0, 0, 0, 1]
                for where, state in zip(moves, start):
                    there[where] = state + steady if where == V else state
                defects += [z[where] - there[where] for where in moves]
                z = there
            ends.append(apply(flow, z))
        return Parts(m, c, zones, matrices, begins, ends, None, None), defects

    def plain(self, z):
        """The equations of a wave."""
        parts, defects = self.parts([y * unit for y, unit in zip(z, self.units)])
        return self.wave.joined(parts) + defects + self.singled(parts, z)

    def singled(self, parts, z):
        """The equation of the event, where it is one of the wave itself."""
        if self.wave.kind == "Fold":
            return []
        return [z[self.place]] if self.wave.kind == "Value" else self.wave.margin(None, parts)

    def slope(self, z):
        """The Jacobian, in units."""
        if self.normal is None:
            return acb_mat(slopes(self.plain, z, STEP))
        count, v = self.place, z[self.place + 1 :]

        def both(x):
            found = self.plain([Dual(y, w / unit) for y, w, unit in zip(x, [*v, 0], self.units)])
            return [dual(y).v for y in found] + [dual(y).d for y in found]

        rows = slopes(both, z[: count + 1], STEP)
        # F_x v is linear in v
        rows = [row + [0] * count if i < count else row + [y / unit for y, unit in zip(rows[i - count][:count], self.units)] for i, row in enumerate(rows)]
        return acb_mat([*rows, [0] * (count + 1) + self.normal])

    @ctx.workprec(BITS)
    def row_sum(self, share):
        """The largest row sum of |C(F′(x) − F′(m))| at a corner of the box that has this share of the units."""
        here = self.slope(self.guess)
        inverse, signs, most = here.inv().mid(), [1] * len(self.guess), 0.0
        for _ in range(CORNERS):
            there = self.slope([y + share * sign for y, sign in zip(self.guess, signs)])
            moved = [[float(y.real.mid()) for y in row] for row in (inverse * (there - here)).tolist()]
            sums = [sum(map(abs, row)) for row in moved]
            largest = max(range(len(sums)), key=sums.__getitem__)
            most = max(most, sums[largest])
            new = [1 if y > 0 else -1 for y in moved[largest]]
            if new == signs:
                break
            signs = new
        return most


def is_refuted(wave, x, distance):
    """Whether Krawczyk's operator does not map the box of a distance into its interior. Events with unknowns of their own are left out."""
    if wave.kind == "Crossing" or wave.watch in TOUCHES:
        return False
    return Cut(wave, x).row_sum(distance / double(wave.posed["unit"])) > CLEARLY
