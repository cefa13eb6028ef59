"""Eigenvalues of brakewave's waves in balls of Arb: enclosed, and counted by the argument principle.

Written from the eigenfunction problem of docs/theory.md, apart from the program. check_certificate.py says what it
is for.
"""

from flint import acb, arb

from ball_waves import DU, W, Dual, NotCovered, Refused, Wave, apply, contracts, decimal, exponential, must, prove_zero

FIRST = 1e-2
"""Half the width of the strip around the imaginary axis that is tried first, by the inverse of the period."""
STRIPS = 6
"""Strips that are tried, each an eighth of the one before."""
LARGEST = 1e6
"""Growth beyond which it counts as not bounded."""
PIECE = 2.0 ** -40
"""Length of a piece of a contour, by the period, at which a zero counts as lying on it."""


class Perturbed(Wave):
    """A wave with its perturbations e^{λt}."""

    def start(self):
        """Where a period begins, and in how many dimensions: at a release, or where there is none in contact."""
        for i, (_, entry) in enumerate(self.zones):
            if entry == "Release":
                return i, 1
        return next(i for i, (regime, _) in enumerate(self.zones) if regime != "Separation"), 2

    def order(self):
        """The zones of a period in their order, each with whether its switch is passed and whether it is gone through."""
        first, size = self.start()
        yield first, size == 1, True
        for step in range(1, self.count):
            yield (first + step) % self.count, True, True
        if size == 2:
            yield first, True, False

    def period(self, parts, growth):
        """What a period makes of a perturbation (η, η′), times e^{−λT}: 1 × 1 from a release and else 2 × 2."""
        m, c, zones, ends = parts.m, parts.c, parts.zones, parts.ends
        if self.coulomb and any(regime == "Separation" for regime, _ in self.zones):
            raise NotCovered("eigenvalues of waves with Coulomb impacts")
        front, wa, wb, square = m.d / c, m.a / (c * c), m.b / (c * c), growth * growth
        columns = [[1]] if self.start()[1] == 1 else [[1, 0], [0, 1]]
        for i, switch, through in self.order():
            regime, entry = self.zones[i]
            if switch:
                end, after, before = ends[i - 1], parts.rises[i], parts.falls[i - 1]
                columns = [self.switch(entry, column, end, before, after, parts, growth) for column in columns]
            if not through or regime == "Stick":
                continue
            along = 2 * wa * growth + m.damping
            if regime == "Separation":
                gap = [wb * square - m.g, -2 * wb * growth - m.damping, front * growth, -front]
                slip = [-front * growth, front, wa * square - m.h, -along]
                rows = [[0, 1, 0, 0], [y / (1 - wb) for y in gap], [0, 0, 0, 1], [y / (1 - wa) for y in slip]]
            else:
                drive = (m.friction if regime == "Slip" else -m.friction) * front
                rows = [[0, 1], [y / (1 - wa) for y in (wa * square - drive * growth - m.h, drive - along)]]
            grown = exponential(rows, zones[i][2])
            columns = [apply(grown, column) for column in columns]
        decay = (-growth * sum(t for _, _, t in zones)).exp()
        return [[column[row] * decay for column in columns] for row in range(len(columns))]

    def switch(self, entry, column, end, before, after, parts, growth):
        """What a switch makes of (η), (η, η′) or (u, u′, η, η′), from the states on both sides and their slopes."""
        m, c = parts.m, parts.c
        if entry == "Release":
            reset = m.h + m.static * m.d / c * growth - m.a / (c * c) * growth * growth
            return [column[0], after[W] * reset * column[0] / m.h if self.static else 0]
        if entry == "Arrest":
            return column[:1]
        if entry == "Reversal":
            return [column[0], column[1] * after[W] / before[W]]
        if entry == "TakeOff":
            return [0, 0, *column]
        late = -column[0] / end[DU]
        gap = [0, -after[DU] * late] if entry == "Touch" else []
        return [*gap, column[2], column[3] - (after[W] - before[W]) * late]

    def determinant(self, matrix, root):
        """F_j(λ) = det(M(λ)e^{−λT} − z)."""
        if len(matrix) == 1:
            return matrix[0][0] - root
        return (matrix[0][0] - root) * (matrix[1][1] - root) - matrix[0][1] * matrix[1][0]

    def root(self, sector):
        """z = e^{2πij/k}."""
        return (acb(0, 2) * arb.pi() * int(sector) / int(self.posed["mode"])).exp()

    def crossing(self, x, parts):
        """F_j(iω) = 0, and the same for the conjugate: both are analytic in ω."""
        root, growth = self.root(self.condition.value["sector"]), acb(0, 1) * x[self.base]
        pairs = (growth, root), (-growth, root.conjugate())
        return [self.determinant(self.period(parts, at), z) for at, z in pairs]

    def eigenvalue(self, parts, sector, near):
        """A regular zero of F_j as a complex ball."""
        root = self.root(sector)
        guess = acb(float(near[0]), float(near[1]))
        zero = prove_zero(lambda at: [self.determinant(self.period(parts, at[0]), root)], [guess])
        return zero.middle[0] + acb(arb(0, zero.radius), arb(0, zero.radius))

    # counting
    def no_growth_from(self, parts, rate, window):
        """Whether Re λ ≥ rate and |Im λ| ≤ window has no eigenvalue.

        (η, η′/λ) and (u, u′/λ) in the characteristic coordinates p of a zone obey p′ = (λX + B + Z/λ)p with X
        diagonal and less than 1. So |p| e^{−Re λ s} grows at most like exp(s(ρ(X − 1) + |B| + |Z|/ρ)), ρ being the rate:
        beyond it every entry is smaller. At a release with static friction |λ| ≤ (ρ + W) e^{(Re λ − ρ)/(ρ + W)}
        enters, which the stick zone before it outweighs where it lasts 1/(ρ + W).
        """
        m, c, zones, ends = parts.m, parts.c, parts.zones, parts.ends
        real = lambda y: acb(y).real
        modulus = lambda y: abs(acb(y)).upper()
        front, rate = m.d / c, arb(rate)
        size = self.start()[1]
        columns = [[arb(int(i == j)) for i in range(size)] for j in range(size)]
        for i, switch, through in self.order():
            regime, entry = self.zones[i]
            if switch:
                end, after, before = ends[i - 1], parts.rises[i], parts.falls[i - 1]
                if entry == "Release":
                    far = m.h / rate + m.static * front + m.a / (c * c) * (rate + window)
                    slope = modulus(after[W] * far / m.h) if self.static else arb(0)
                    must(not self.static or real(zones[i - 1][2]) * (rate + window) > 1, "a short stick zone")
                    columns = [[column[0], column[0] * slope] for column in columns]
                elif entry == "Arrest":
                    columns = [column[:1] for column in columns]
                elif entry == "Reversal":
                    columns = [[column[0], column[1] * modulus(after[W] / before[W])] for column in columns]
                elif entry == "TakeOff":
                    columns = [[arb(0), arb(0), *column] for column in columns]
                else:
                    late, jump = modulus(1 / end[DU]) / rate, modulus(after[W] - before[W])
                    gap = [arb(0), modulus(after[DU]) * late] if entry == "Touch" else None
                    columns = [
                        ([gap[0], gap[1] * column[0]] if gap else []) + [column[2], column[3] + jump * late * column[0]]
                        for column in columns
                    ]
            if not through:
                continue
            length = real(zones[i][2])
            if regime == "Stick":
                columns = [[y * (-rate * length).exp() for y in column] for column in columns]
                continue
            # x of e^{λxs} for each wave speed: m x² + 2w x − w = 0 with m + w = 1
            waves = [m.b / (c * c), m.a / (c * c)] if regime == "Separation" else [m.a / (c * c)]
            roots = [w.sqrt() for w in waves]
            speeds = [x for q in roots for x in (q / (1 + q), -q / (1 - q))]
            drive = {"Slip": m.friction, "Reverse": -m.friction}.get(regime, 0) * front
            # rows of η″ or u″ over λ: what multiplies 1 and 1/λ
            if regime == "Separation":
                now = [[0, -m.damping, front, -front], [-front, front, 0, -m.damping]]
                late = [[-m.g, 0, 0, 0], [0, 0, -m.h, 0]]
            else:
                now, late = [[-drive, drive - m.damping]], [[-m.h, 0]]
            n = len(speeds)
            rows = [[arb(0)] * n for _ in range(n)]
            for k, w in enumerate(waves):
                # p of a pair from (y, y′/λ), and back: (x₂y − y′)/(x₂ − x₁), (y′ − x₁y)/(x₂ − x₁)
                gap = speeds[2 * k + 1] - speeds[2 * k]
                for into, sign in ((2 * k, -1), (2 * k + 1, 1)):
                    for j in range(n):
                        entry = lambda terms: terms[k][j - j % 2] + terms[k][j - j % 2 + 1] * speeds[j]
                        share = sign / (gap * (1 - w))
                        rows[into][j] += modulus(entry(now) * share) + modulus(entry(late) * share) / rate
            for j in range(n):
                rows[j][j] += rate * (real(speeds[j]) - 1)
            grown = exponential(rows, length)
            moved = []
            for column in columns:
                p = []
                for k in range(n // 2):
                    first, second = speeds[2 * k], speeds[2 * k + 1]
                    for x in (second, first):
                        p.append((modulus(x) * column[2 * k] + column[2 * k + 1]) / modulus(second - first).lower())
                p = [real(y).upper() for y in apply(grown, p)]
                for k in range(n // 2):
                    pair = p[2 * k : 2 * k + 2]
                    p[2 * k] = sum(pair)
                    p[2 * k + 1] = sum(modulus(x) * y for x, y in zip(speeds[2 * k : 2 * k + 2], pair))
                moved.append(p)
            columns = moved
        return contracts([[column[row].upper() for column in columns] for row in range(size)])

    def along(self, parts, begin, end, roots):
        """F of every root at places along a segment, so close that between two neighbours, and from the ends to the
        first and the last, its argument changes by less than π/2 from each of them."""
        pieces, values = [(begin, end)], []
        length = sum(acb(t).real for *_, t in parts.zones)
        while pieces:
            begin, end = pieces.pop()
            middle, half = (begin + end) / 2, (end - begin) / 2
            over = middle + half * arb(0, 1)
            exact, balls = (
                [self.determinant(matrix, root) for root in roots]
                for matrix in (self.period(parts, middle), self.period(parts, Dual(over, acb(1))))
            )
            # on the piece F/F(middle) = 1 + tw with −1 ≤ t ≤ 1 and w in a ball
            if all(not y.contains(0) and abs((z.d * half / y).real) < 1 for y, z in zip(exact, balls)):
                values.append(exact)
                continue
            must(abs(half) * length > PIECE, "an eigenvalue on a contour")
            pieces += [(middle, end), (begin, middle)]
        return values

    def turns(self, chain, conjugates):
        """How often F turns round 0 on the contour made of a path in the upper half plane, from the right to the left on
        the real axis, and its mirror image. `conjugates` belongs to the conjugate of z."""
        mirrored = [y.conjugate() for y in reversed(conjugates)]
        closed = mirrored + chain
        total = sum((after / before).arg() for before, after in zip(closed, closed[1:] + closed[:1]))
        whole = (total / (2 * arb.pi())).unique_fmpz()
        must(whole is not None, "the argument is not enclosed")
        return int(whole)

    def right_of(self, parts, sectors, window, line):
        """How many eigenvalues with |Im λ| ≤ window lie right of a line, in every sector."""
        rate = 1.0
        while not self.no_growth_from(parts, max(rate, line + 1), window):
            rate *= 2
            must(rate < LARGEST, "growth is not bounded")
        roots = [self.root(sector) for sector in sectors]
        corners = [acb(max(rate, line + 1), 0), acb(max(rate, line + 1), window), acb(line, window), acb(line, 0)]
        both = [z for root in roots for z in (root, root.conjugate())]
        chain = [at for ends in zip(corners, corners[1:]) for at in self.along(parts, *ends, both)]
        return [self.turns([at[2 * i] for at in chain], [at[2 * i + 1] for at in chain]) for i in range(len(roots))]

    def growing(self, parts, sectors, window, known):
        """How many eigenvalues with |Im λ| ≤ window have Re λ > 0, in every sector, if none but `known` of each sector
        are on the axis: a narrow strip around it has no others."""
        width = FIRST / float(sum(acb(t).real for *_, t in parts.zones))
        for _ in range(STRIPS):
            right = self.right_of(parts, sectors, window, width)
            left = self.right_of(parts, sectors, window, -width)
            if [x + y for x, y in zip(right, known)] == left:
                return right
            width /= 8
        raise NotCovered("counts with an eigenvalue next to the imaginary axis")
