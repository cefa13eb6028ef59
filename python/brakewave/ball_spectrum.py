"""Eigenvalues of brakewave's waves in balls of Arb: enclosed, and counted by the argument principle.

Written from the eigenfunction problem of docs/theory.md, apart from the program. check.py says what it
is for.
"""

from math import log

from flint import acb, acb_mat, acb_poly, arb

from .ball_waves import DU, W, Wave
from .balls import Dual, NotCovered, apply, distance, double, exponential, least_norm, must, prove_zero, size, whole

FIRST = 1e-2
"""Half the width of the strip around the imaginary axis that is tried first, by the inverse of the period."""
STRIPS = 6
"""Strips that are tried, each an eighth of the one before."""
LARGEST = 1e6
"""Growth, by the inverse of the period, beyond which it counts as not bounded."""
CELL = 0.65
"""Radius of the discs of polynomials, by the inverse of the period."""
CLOSENESS = 40
"""Bits to which polynomials agree with M."""
PIECE = 2.0**-40
"""Length of a piece of a contour, by the period, at which a zero counts as lying on it."""


def modulus(number):
    """|number|, from above."""
    return abs(acb(number)).upper()


class Perturbed(Wave):
    """A wave with its perturbations e^{λt}."""

    def start(self):
        """Where a period begins, and in how many dimensions: at a release, or where there is none in contact."""
        for i, (_, entry) in enumerate(self.zones):
            if entry == "Release":
                return i, 1
        return next(i for i, (regime, _) in enumerate(self.zones) if regime != "Separation"), 2

    def order(self):
        """The zones of a period in their order: number, whether the switch before it is passed, whether it is."""
        first, size = self.start()
        yield first, size == 1, True
        for step in range(1, self.count):
            yield (first + step) % self.count, True, True
        if size == 2:
            yield first, True, False

    def period(self, parts, growth):
        """What a period makes of a perturbation (η, η′), times e^{−λT}: 1 × 1 from a release and else 2 × 2."""
        m, c, zones = parts.m, parts.c, parts.zones
        if self.coulomb and any(regime == "Separation" for regime, _ in self.zones):
            raise NotCovered("eigenvalues of waves with Coulomb impacts")
        front, wa, wb, square = m.d / c, m.a / (c * c), m.b / (c * c), growth * growth
        columns = [[1]] if self.start()[1] == 1 else [[1, 0], [0, 1]]
        for i, switch, through in self.order():
            regime = self.zones[i][0]
            if switch:
                columns = [self.switch(i, column, parts, growth) for column in columns]
            if not through or regime == "Stick":
                continue
            along = 2 * wa * growth + m.damping
            if regime == "Separation":
                gap = [wb * square - m.g, -2 * wb * growth - m.damping, front * growth, -front]
                slip = [-front * growth, front, wa * square - m.h, -along]
                rows = [[0, 1, 0, 0], [y / (1 - wb) for y in gap], [0, 0, 0, 1], [y / (1 - wa) for y in slip]]
            else:
                drive = (m.friction if regime == "Slip" else -m.friction) * front
                slip = [wa * square - drive * growth - m.h, drive - along]
                rows = [[0, 1], [y / (1 - wa) for y in slip]]
            grown = exponential(rows, zones[i][2])
            columns = [apply(grown, column) for column in columns]
        decay = (-growth * sum(t for *_, t in zones)).exp()
        return [[column[row] * decay for column in columns] for row in range(len(columns))]

    def switch(self, i, column, parts, growth):
        """What the switch before a zone makes of (η), (η, η′) or (u, u′, η, η′)."""
        m, c, entry, after, before = parts.m, parts.c, self.zones[i][1], parts.rises[i], parts.falls[i - 1]
        if entry == "Release":
            reset = m.h + m.static * m.d / c * growth - m.a / (c * c) * growth * growth
            return [column[0], after[W] * reset * column[0] / m.h if self.static else 0]
        if entry == "Arrest":
            return column[:1]
        if entry == "Reversal":
            return [column[0], column[1] * after[W] / before[W]]
        if entry == "TakeOff":
            return [0, 0, *column]
        late = -column[0] / parts.ends[i - 1][DU]
        gap = [0, -after[DU] * late] if entry == "Touch" else []
        return [*gap, column[2], column[3] - (after[W] - before[W]) * late]

    def root(self, sector):
        """z = e^{2πij/k}."""
        return (acb(0, 2) * arb.pi() * sector / self.mode).exp()

    def crossing(self, x, parts):
        """F_j(iω) = 0, and the same for the conjugate: both are analytic in ω. At λ = 0 a real equation says as much."""
        root = self.root(self.sector)
        if self.at_zero:
            return [distance(self.period(parts, acb(0)), root)]
        growth = acb(0, 1) * x[self.base]
        pairs = (growth, root), (-growth, root.conjugate())
        return [distance(self.period(parts, at), z) for at, z in pairs]

    def is_simple(self, parts):
        """Whether the eigenvalue at λ = 0 of a crossing there is simple."""
        root = self.root(self.sector)
        return not distance(self.period(parts, Dual(acb(0), acb(1))), root).d.contains(0)

    def swings(self, parts, window):
        """How many of ±i√h are known to be eigenvalues of sector 0 with |Im λ| ≤ window. Without damping, stick and
        reversals V may swing as a whole, which neither P nor the gap feels."""
        holds = any(regime == "Stick" or entry == "Reversal" for regime, entry in self.zones)
        if holds or self.coulomb or not parts.m.damping.is_zero():
            return 0
        frequency = parts.m.h.sqrt().real
        must(frequency < window or frequency > window, "√h is the window")
        return 2 if frequency < window else 0

    def eigenvalue(self, parts, sector, near):
        """A regular zero of F_j as a complex ball."""
        root = self.root(whole(sector, self.mode))
        guess = acb(double(near[0]), double(near[1]))
        zero = prove_zero(lambda at: [distance(self.period(parts, at[0]), root)], [guess])
        return zero.middle[0] + acb(arb(0, zero.radius), arb(0, zero.radius))

    # counting
    def no_growth_from(self, parts, rate, window):
        """Whether Re λ ≥ rate and |Im λ| ≤ window has no eigenvalue.

        What a period makes of (η, η′/λ) is bounded by a product of matrices for switches and zones, which get smaller
        as Re λ grows.
        """
        size = self.start()[1]
        columns = [[arb(int(i == j)) for i in range(size)] for j in range(size)]
        for i, switch, through in self.order():
            if switch:
                columns = [self.switch_bound(i, column, parts, rate, window) for column in columns]
            if through and self.zones[i][0] == "Stick":
                columns = [[y * (-rate * parts.zones[i][2].real).exp() for y in column] for column in columns]
            elif through:
                bound = self.zone_bound(i, parts, rate)
                columns = [[modulus(y) for y in apply(bound, column)] for column in columns]
        return bool(least_norm([[column[row] for column in columns] for row in range(size)]) < 1)

    def switch_bound(self, i, column, parts, rate, window):
        """What the switch before a zone makes of bounds of (η), (η, η′/λ) or (u, u′/λ, η, η′/λ)."""
        m, c, entry, after, before = parts.m, parts.c, self.zones[i][1], parts.rises[i], parts.falls[i - 1]
        if entry == "Release":
            if not self.static:
                return [column[0], arb(0)]
            # |λ| ≤ (ρ + W)e^{(Re λ − ρ)/(ρ + W)}, which the stick zone before outweighs where it lasts 1/(ρ + W)
            must(parts.zones[i - 1][2].real * (rate + window) > 1, "stick is too short")
            reset = m.h / rate + m.static * m.d / c + m.a / (c * c) * (rate + window)
            return [column[0], column[0] * modulus(after[W] * reset / m.h)]
        if entry == "Arrest":
            return column[:1]
        if entry == "Reversal":
            return [column[0], column[1] * modulus(after[W] / before[W])]
        if entry == "TakeOff":
            return [arb(0), arb(0), *column]
        late = column[0] * modulus(1 / parts.ends[i - 1][DU]) / rate
        gap = [arb(0), modulus(after[DU]) * late] if entry == "Touch" else []
        return [*gap, column[2], column[3] + modulus(after[W] - before[W]) * late]

    def zone_bound(self, i, parts, rate):
        """A bound of what a sliding or separated zone makes of (η, η′/λ) or (u, u′/λ, η, η′/λ), times e^{−λT}.

        In the characteristic coordinates p, y = p₁ + p₂ and y′/λ = x₁p₁ + x₂p₂, p′ = (λX + B + Z/λ)p with X diagonal
        and less than 1: |p|e^{−Re λ s} grows at most like exp(s(ρ(X − 1) + |B| + |Z|/ρ)), whose entries fall
        as ρ grows.
        """
        m, c, regime = parts.m, parts.c, self.zones[i][0]
        front, wb, wa = m.d / c, m.b / (c * c), m.a / (c * c)
        # rows of y″/λ, times 1 less the square of the wave's speed by that of c: what multiplies 1 and 1/λ
        if regime == "Separation":
            waves, late = [wb, wa], [[-m.g, 0, 0, 0], [0, 0, -m.h, 0]]
            now = [[0, -m.damping, front, -front], [-front, front, 0, -m.damping]]
        else:
            drive = (m.friction if regime == "Slip" else -m.friction) * front
            waves, now, late = [wa], [[-drive, drive - m.damping]], [[-m.h, 0]]
        # x of e^{λxs}: (1 − w)x² + 2wx − w = 0
        x = [y for q in (w.sqrt() for w in waves) for y in (q / (1 + q), -q / (1 - q))]
        n = len(x)
        rows, into, out = ([[arb(0)] * n for _ in range(n)] for _ in range(3))
        for k in range(n):
            first, row = k - k % 2, k // 2
            gap = x[first + 1] - x[first]
            for j in range(n):
                pair = j - j % 2
                scale = gap * (1 - waves[row])
                entry = lambda terms: modulus((terms[row][pair] + terms[row][pair + 1] * x[j]) / scale)
                rows[k][j] = entry(now) + entry(late) / rate + int(j == k) * rate * (x[k].real - 1)
            # p = ±(x′y − y′/λ)/gap, where x′ is that of the other
            into[k][first], into[k][first + 1] = modulus(x[first + 1 - k % 2] / gap), modulus(1 / gap)
            out[first][k], out[first + 1][k] = arb(1), modulus(x[k])
        grown = exponential(rows, parts.zones[i][2].real)
        return (acb_mat(out) * acb_mat(grown) * acb_mat(into)).tolist()

    def disc(self, parts, middle, radius):
        """Polynomials in (λ − middle)/radius for the entries of M(λ)e^{−λT} on a disc, and a bound of their error.

        They interpolate at n roots of unity. With |M| ≤ S on a disc four times as large, a Taylor coefficient of order
        i is at most S/4ⁱ, so that what is left out and what it adds to the others are less than 3S/4ⁿ.
        """
        wide = middle + acb(arb(0, 1), arb(0, 1)) * (4 * radius)
        most = size([y for row in self.period(parts, wide) for y in row])
        must(most.is_finite(), "the perturbations cannot be enclosed")
        n = max(24, int((float(most.log()) / log(2) + CLOSENESS) / 2) + 2)
        unit = [(acb(0, 2) * arb.pi() * i / n).exp() for i in range(n)]
        samples = [self.period(parts, middle + radius * z) for z in unit]
        dimension = range(len(samples[0]))
        fit = lambda i, j: acb_poly([y / n for y in acb.dft([sample[i][j] for sample in samples])])
        return [[fit(i, j) for j in dimension] for i in dimension], (3 * most * arb(2) ** (-2 * n)).upper()

    def along(self, parts, begin, end, roots, discs):
        """F of every root at places along a segment: the segment is cut into pieces, one about each place, on which the
        argument of F differs by less than π/2 from that at the place. Short pieces use polynomials on discs,
        which are kept for other segments."""
        pieces, values = [(begin, end)], []
        length = sum(acb(t).real for *_, t in parts.zones)
        side = (arb(CELL) / length).mid()
        while pieces:
            begin, end = pieces.pop()
            middle, half = (begin + end) / 2, (end - begin) / 2
            over, error = middle + half * arb(0, 1), arb(0)
            if abs(half) < side / 4:
                # a piece is within side·(√½ + 1/4) of the middle of its cell
                cell = tuple(round(float((y / side).mid())) for y in (middle.real, middle.imag))
                center = acb(cell[0] * side, cell[1] * side)
                if cell not in discs:
                    discs[cell] = self.disc(parts, center, side)
                polynomials, error = discs[cell]
                at, around = (middle - center) / side, (over - center) / side
                exact = [[y(at) for y in row] for row in polynomials]
                balls = [[Dual(y(around), y.derivative()(around) / side) for y in row] for row in polynomials]
                n = len(exact)
                # det(M + E) − det M for |E| ≤ error
                error = error * (sum(abs(y.v) for row in balls for y in row) + 2 + 2 * error if n == 2 else 1)
            else:
                exact, balls = self.period(parts, middle), self.period(parts, Dual(over, acb(1)))
            exact, balls = ([distance(matrix, root) for root in roots] for matrix in (exact, balls))
            # on the piece F/F(middle) is 1 + tw with −1 ≤ t ≤ 1 and w in a ball, but for the error
            if all(abs((z.d * half / y).real) + error / abs(y) < 1 for y, z in zip(exact, balls)):
                values.append(exact)
                continue
            must(abs(half) * length > PIECE, "an eigenvalue on a contour")
            pieces += [(middle, end), (begin, middle)]
        return values

    def turns(self, chain, conjugates):
        """How often F turns round 0 on the contour made of a path in the upper half plane, from the right to the left
        on the real axis, and its mirror image. `conjugates` belongs to the conjugate of z."""
        mirrored = [y.conjugate() for y in reversed(conjugates)]
        closed = mirrored + chain
        total = sum((after / before).arg() for before, after in zip(closed, closed[1:] + closed[:1]))
        whole = (total / (2 * arb.pi())).unique_fmpz()
        must(whole is not None, "the argument is not enclosed")
        return int(whole)

    def right_of(self, parts, sectors, window, line, discs):
        """How many eigenvalues with |Im λ| ≤ window lie right of a line, in every sector."""
        unit = 1 / float(sum(acb(t).real for *_, t in parts.zones))
        rate = max(unit, line + unit)
        while not self.no_growth_from(parts, rate, window):
            rate *= 2
            must(rate < LARGEST * unit, "growth is not bounded")
        corners = [acb(rate, 0), acb(rate, window), acb(line, window), acb(line, 0)]
        roots = [z for root in map(self.root, sectors) for z in (root, root.conjugate())]
        chain = [at for ends in zip(corners, corners[1:]) for at in self.along(parts, *ends, roots, discs)]
        return [self.turns([at[i] for at in chain], [at[i + 1] for at in chain]) for i in range(0, len(roots), 2)]

    def growing(self, parts, sectors, window, known, discs):
        """How many eigenvalues with |Im λ| ≤ window have Re λ > 0, in every sector: as many as right of a narrow strip
        around the axis, which has none but those `known` to be on the axis."""
        width = FIRST / float(sum(acb(t).real for *_, t in parts.zones))
        for _ in range(STRIPS):
            right, left = (self.right_of(parts, sectors, window, line, discs) for line in (width, -width))
            if [x + y for x, y in zip(right, known)] == left:
                return right
            width /= 8
        raise NotCovered("counts with an eigenvalue next to the imaginary axis")
