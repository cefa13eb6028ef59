"""What the checks of waves and of orbits share, in balls of Arb (python-flint): derivatives, flows of ẋ = Mx, zeros that are
proven, uniqueness over boxes, signs over whole zones.

Written from the mathematics that the functions state, apart from the program. check.py says what it is for.
"""

import re
from collections import namedtuple
from fractions import Fraction
from itertools import product
from math import inf

from flint import acb, acb_mat, arb, arb_mat, ctx, fmpq

ctx.prec = 256
SIGNS = 128
"""Bits in which signs are shown, and curves followed."""
POLYDISC = arb(2) ** -40
"""Radius of the polydisc over which the equations are bounded: far below the scale on which they change."""
STEP = arb(2) ** -120
"""Step of differences: their error is of order STEP/POLYDISC², and roundings of 2^-256 are far below it."""
CLOSE = arb(2) ** -170
"""Newton's method ends with a step below this: far above rounding, far below the interval of any statement."""
PARTS = ((1, 1), (2, 1), (4, 1))
"""Into how many parts the ranges of the speed and the parameter are divided where uniqueness is shown, and into how many cells
those of durations."""
TAYLOR = 12
"""Order of the Taylor polynomials by which signs are shown."""
DEPTH = 40
"""Bisections of a zone after which a sign counts as not shown."""
DEEPEST = (DEPTH, 12)
"""The same at a point, and along a curve, of which a shorter piece may do."""

QUOTIENT = re.compile(r"[-+]?(?:[0-9]+/0*[1-9][0-9]*|(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE]([-+]?[0-9]{1,9}))?)")
MOST_PLACES = 5000
"""Exponent of a decimal up to which it is read. Doubles end at 308, and a decimal may have some more zeros after its point."""


Tagged = namedtuple("Tagged", "name value")
"""A name of an enum and what it holds."""


class Number(float):
    """A double with the text that it was read from."""

    def __new__(cls, text):
        self = super().__new__(cls, text)
        self.text = text
        return self


class Named(str):
    """A name that stands for itself, which a text in quotes does not."""


class Refused(Exception):
    """A statement is false, or cannot be shown."""


class NotCovered(Exception):
    """A statement that is not treated."""


def must(holds, reason):
    """Refuses for a reason unless something holds."""
    if not holds:
        raise Refused(reason)


def whole(number, below=inf):
    """A whole number from 0 on, less than another."""
    found = isinstance(number, float) and 0 <= number < below and number == int(number)
    must(found, f"{number!r} is no whole number from 0 on" + (f" below {below}" if below < inf else ""))
    return int(number)


def double(number):
    """A number that stands there as one, not as a text, a name or a truth value."""
    must(isinstance(number, float), f"{number!r} is no number")
    return float(number)


def exact(text):
    """The quotient that a text is: a decimal, or a quotient of two whole numbers, as it was written."""
    found = isinstance(text, str) and QUOTIENT.fullmatch(text.replace("_", ""))
    must(found, f"{text!r} is no decimal")
    # powers of ten far beyond all doubles would take for ever
    must(abs(int(found[1] or 0)) <= MOST_PLACES, f"{text} is beyond all doubles")
    return Fraction(found[0])


def decimal(text):
    """A decimal as it was written."""
    ratio = exact(text)
    return acb(arb(fmpq(ratio.numerator, ratio.denominator)))


# ---------------------------------------------------------------------------- numbers with derivatives, matrices
class Dual:
    """v + dε with ε² = 0. Both may have derivatives in another direction themselves."""

    def __init__(self, v, d=0):
        self.v, self.d = v, d

    def __add__(self, other):
        if not isinstance(other, Dual):
            return Dual(self.v + other, self.d)
        return Dual(self.v + other.v, self.d + other.d)

    def __mul__(self, other):
        if not isinstance(other, Dual):
            return Dual(self.v * other, self.d * other)
        return Dual(self.v * other.v, self.v * other.d + self.d * other.v)

    def __truediv__(self, other):
        other = dual(other)
        value = self.v / other.v
        return Dual(value, (self.d - value * other.d) / other.v)

    __radd__, __rmul__ = __add__, __mul__
    __neg__ = lambda self: Dual(-self.v, -self.d)
    __sub__ = lambda self, other: self + -other
    __rsub__ = lambda self, other: -self + other
    __rtruediv__ = lambda self, other: dual(other) / self
    log = lambda self: Dual(self.v.log(), self.d / self.v)

    def sqrt(self):
        root = self.v.sqrt()
        return Dual(root, self.d / (2 * root))

    def exp(self):
        value = self.v.exp()
        return Dual(value, value * self.d)

    cos = lambda self: Dual(self.v.cos(), -self.d * self.v.sin())
    sin = lambda self: Dual(self.v.sin(), self.d * self.v.cos())


def dual(number):
    """A number as one with a derivative."""
    return number if isinstance(number, Dual) else Dual(number)


def value_of(number):
    """A number without its derivative."""
    return number.v if isinstance(number, Dual) else number


def bare(number):
    """A number without any of its derivatives."""
    while isinstance(number, Dual):
        number = number.v
    return number


def slope_of(number):
    """The derivative of a number."""
    return number.d if isinstance(number, Dual) else 0


def real(number):
    """The real part of a number."""
    return number.real if isinstance(number, (arb, acb)) else arb(number)


def as_matrix(rows):
    """A matrix of balls, real where all entries are."""
    rows = list(rows)
    try:
        return arb_mat(rows)
    except TypeError:
        return acb_mat(rows)


def nearly_inverse(matrix):
    """About the inverse of the middle of a matrix, without bounds of its errors."""
    middle = matrix.mid()
    n = middle.nrows()
    return middle.solve(type(middle)([[int(i == j) for j in range(n)] for i in range(n)]), algorithm="approx").mid()


def exponential(rows, time=1):
    """e^{At} of a square matrix, a list of rows of numbers or of numbers with derivatives."""
    n = len(rows)
    if not isinstance(time, Dual) and not any(isinstance(entry, Dual) for row in rows for entry in row):
        return as_matrix([[entry * time for entry in row] for row in rows]).exp().tolist()
    part = lambda of: [[of(entry) for entry in row] for row in rows]
    values, slopes, time = part(value_of), part(slope_of), dual(time)
    # columns of the derivative of A that are not zero, and all whose rates these have: the derivative depends on no others
    moves = lambda row: {j for j, entry in enumerate(row) if not entry == 0}
    held = set().union(*map(moves, slopes))
    while more := set().union(*(moves(values[j]) for j in held)) - held:
        held |= more
    held = sorted(held)
    block = [values[i] + [slopes[i][j] for j in held] for i in range(n)]
    block += [[0] * n + [values[i][j] for j in held] for i in held]
    both = exponential(block, time.v)
    still, moved = [row[:n] for row in both[:n]], [[0] * n for _ in range(n)]
    for i, row in enumerate(both[:n]):
        for j, entry in zip(held, row[n:]):
            moved[i][j] = entry
    if not time.d == 0:
        grown = [[y * time.d for y in apply(values, column)] for column in zip(*still)]
        moved = [[a + b for a, b in zip(*lines)] for lines in zip(moved, zip(*grown))]
    return [[Dual(*pair) for pair in zip(*lines)] for lines in zip(still, moved)]


def apply(rows, vector):
    """A matrix times a vector; entries that are the integer 0 are left out."""
    return [sum(a * x for a, x in zip(row, vector) if not (isinstance(a, int) and a == 0)) for row in rows]


def tail(matrix, time, state, order):
    """(x(t) − Σ_{j<order} (tA)ʲx(0)/j!)/t^order, which is analytic at t = 0 too: φ_order(tA)A^order x(0)."""
    n, vector = len(matrix), state
    for _ in range(order):
        vector = apply(matrix, vector)
    rows = [[entry * time for entry in row] + [x] + [0] * (order - 1) for row, x in zip(matrix, vector)]
    rows += [[0] * n + [int(j == i + 1) for j in range(order)] for i in range(order)]
    return [row[n + order - 1] for row in exponential(rows)[:n]]


def determinant(rows):
    """Of numbers, or of numbers with derivatives."""
    values, slopes = ([[of(x) for x in row] for row in rows] for of in (value_of, slope_of))
    value = as_matrix(values).det()
    if not any(isinstance(x, Dual) for row in rows for x in row):
        return value
    # row by row
    return Dual(value, sum(as_matrix(values[:k] + [row] + values[k + 1 :]).det() for k, row in enumerate(slopes)))


def distance(matrix, number):
    """det(M − μ)."""
    return determinant([[x - number if i == j else x for j, x in enumerate(row)] for i, row in enumerate(matrix)])


def times(matrix, vector):
    """A matrix of balls times a list."""
    return (matrix * as_matrix([[y] for y in vector])).entries()


def jacobian(equations, at, units=None):
    """The Jacobian of a map in balls, its columns times `units`."""
    at = [acb(x) for x in at]
    seeds = ([Dual(x, unit) if i == j else x for i, x in enumerate(at)] for j, unit in enumerate(units or [1] * len(at)))
    return acb_mat([[dual(y).d for y in equations(x)] for x in seeds]).transpose()


def least_norm(bounds):
    """A matrix without negative entries in about the least weighted maximum norm, to which the power iteration tends."""
    bounds, weight = arb_mat(bounds), arb_mat([[1]] * len(bounds))
    for _ in range(60):
        weight = (bounds * weight + weight).mid()
        weight = (weight / sum(weight.entries())).mid()
    return size(image / y for image, y in zip((bounds * weight).entries(), weight.entries()))


# ------------------------------------------------------------------------------------------------ zeros, proven
Zero = namedtuple("Zero", "middle radius")
"""A zero: its middle in exact complex numbers, and a bound of the distance of every unknown from it."""


def size(numbers):
    """The largest modulus, from above; not a number where one is not."""
    largest = arb(0)
    for x in numbers:
        largest = largest.max(abs(acb(x)).upper())
    return largest


def differences(equations, at, step=STEP):
    """The Jacobian by differences."""
    value = equations(at)
    moved = (equations([x + step if i == j else x for i, x in enumerate(at)]) for j in range(len(at)))
    return acb_mat([[(new - old) / step for new, old in zip(column, value)] for column in moved]).transpose()


def slopes(equations, at, step):
    """The rows of the Jacobian of real equations by differences, without bounds."""
    return [[y.real.mid() for y in row] for row in differences(equations, at, step).tolist()]


def prove_zero(equations, guess):
    """The zero of an analytic map next to `guess`, by Newton's method and the theorem of Newton and Kantorovich.

    The map takes complex numbers. Bounded by M over the polydisc |x − m| ≤ R it has, by Cauchy's estimate,
    a second derivative of at most 16M/R² in |x − m| ≤ R/2, and differences of step h err by Mh/R²/(1 − h/R).
    Its zero is regular.
    """
    middle = [acb(x) for x in guess]
    try:
        inverse = differences(equations, middle).mid().inv().mid()
        for _ in range(40):
            steps = times(inverse, equations(middle))
            middle = [(x - step).mid() for x, step in zip(middle, steps)]
            if size(steps) < CLOSE:
                break
        slope = differences(equations, middle)
        inverse = slope.mid().inv().mid()
    except ZeroDivisionError:
        raise Refused("the equations are singular next to the wave") from None
    disc = acb(arb(0, POLYDISC), arb(0, POLYDISC))
    bounds = [abs(acb(y)).upper() for y in equations([x + disc for x in middle])]
    must(all(bound.is_finite() for bound in bounds), "the equations cannot be enclosed next to the wave")
    error = STEP / POLYDISC**2 / (1 - STEP / POLYDISC)
    contraction = curvature = arb(0)
    for i, row in enumerate(inverse.tolist()):
        spread = sum(abs(y) * bound for y, bound in zip(row, bounds))
        defect = [sum(y * slope[k, j] for k, y in enumerate(row)) - int(i == j) for j in range(len(row))]
        contraction = contraction.max(sum(abs(y) for y in defect) + len(row) * spread * error)
        curvature = curvature.max(16 * spread / POLYDISC**2)
    radius = 2 * size(times(inverse, equations(middle))) + arb(2) ** -240
    # four times as far there is no other: a real map has a real zero, for its conjugate would be one too
    proven = contraction + 4 * curvature * radius < arb(0.5) and 4 * radius < POLYDISC / 2
    must(proven, "no zero of the equations is found next to the wave")
    return Zero(middle, radius.upper())


def injective(jacobian, middle, radii, divided, finer=PARTS, told=()):
    """How far a Jacobian over the box of these radii, of which it is in units, times an inverse, is from 1: where by less than 1,
    equations have at most one zero there. The ranges of some unknowns are divided into parts, and others by the Jacobian into cells:
    less is lost to their repeated use. Unknowns that an equation tells outright have no range."""
    divided = [i for i in divided if i not in told]
    try:
        inverse = jacobian(middle, 1).mid().inv().mid()
    except (ZeroDivisionError, AttributeError):
        return arb("inf")
    for parts, cells in finer:
        bounds = [[arb(0)] * len(radii) for _ in radii]
        for ranges in product([arb(i, 1) / parts for i in range(1 - parts, parts, 2)], repeat=len(divided)):
            shares = dict(zip(divided, ranges)) | dict.fromkeys(told, arb(0))
            box = [y + radius * shares.get(i, arb(0, 1)) for i, (y, radius) in enumerate(zip(middle, radii))]
            found = jacobian(box, cells)
            if found is None:
                bounds = [[arb("inf")]]
                break
            defect = (inverse * found).tolist()
            for i, j in product(range(len(radii)), repeat=2):
                bounds[i][j] = bounds[i][j].max(abs(defect[i][j] - int(i == j)).upper())
        # it falls about in proportion to the box, or faster
        norm = least_norm(bounds)
        if norm < 1 or norm.is_finite() and not norm * parts < 1.5 * finer[-1][0]:
            break
    return norm


def lesser(norm, other):
    """The lesser of two norms, of which either may be no number."""
    return norm.min(other) if norm.is_finite() and other.is_finite() else other if other.is_finite() else norm


def second(equations, box, radii, j, k):
    """Second derivatives of a map over a box in two unknowns, in units of both."""
    x = list(box)
    if j == k:
        x[j] = Dual(Dual(x[j], radii[j]), Dual(radii[j], 0))
    else:
        x[j], x[k] = Dual(Dual(x[j], radii[j]), 0), Dual(x[k], radii[k])
    return [acb(dual(dual(y).d).d) for y in equations(x)]


def bent(equations, middle, boxes, radii, pairs):
    """The same by second derivatives: at the end of a way from the middle of a box to one of its places the Jacobian differs by their
    integral along it. So what an unknown loses by its repeated use counts with a square of the radii. Of the pairs of unknowns that are not
    given they are zero; boxes are parts of the one box."""
    try:
        slope = jacobian(equations, middle, radii)
        inverse = slope.mid().inv().mid()
    except (ZeroDivisionError, AttributeError):
        return arb("inf")
    bounds = [[abs(y - int(i == j)).upper() for j, y in enumerate(row)] for i, row in enumerate((inverse * slope).tolist())]
    for j, k in pairs:
        largest = [arb(0)] * len(radii)
        for box in boxes:
            moved = times(inverse, second(equations, box, radii, j, k))
            largest = [most.max(abs(y).upper()) for most, y in zip(largest, moved)]
        for row, y in zip(bounds, largest):
            row[k] += y
            row[j] += y if j != k else 0
    return least_norm(bounds)


def parted(middle, radii, places, parts):
    """A box, parted along some of its unknowns."""
    for ranges in product([arb(i, 1) / parts for i in range(1 - parts, parts, 2)], repeat=len(places)):
        shares = dict(zip(places, ranges))
        yield [y + radius * shares.get(i, arb(0, 1)) for i, (y, radius) in enumerate(zip(middle, radii))]


# ---------------------------------------------------------------------------------------------------- signs
def flows(matrix, row, state):
    """(M, r, z, largest entry of M off the diagonal) for f(t) = r e^{Mt} z, and where numbers have derivatives for that of f as well."""
    part = lambda numbers, which: [real(getattr(dual(x), which)) for x in numbers]
    still, moved = ([part(line, which) for line in matrix] for which in "vd")
    found = [(still, part(row, "v"), part(state, "v"))]
    if not all(y == 0 for y in part(state, "d")):
        both = [line + [0] * len(line) for line in still] + [a + b for a, b in zip(moved, still)]
        found.append((both, part(row, "d") + part(row, "v"), part(state, "v") + part(state, "d")))
    # the diagonal may have the large rate of a layer that decays
    largest = max(float(abs(y).upper()) for i, line in enumerate(still) for j, y in enumerate(line) if i != j)
    return [(arb_mat(rows), arb_mat([form]), arb_mat([[y] for y in z]), largest) for rows, form, z in found]


def over(matrix, form, state, largest, low, high, order):
    """Whether f(t)/(t − low)^order is positive from low to high, f's Taylor polynomial from low with the rest of
    Lagrange over all of it."""
    span = arb(high) - arb(low)
    if span * largest > 4:
        return False
    start = (matrix * arb(low)).exp() * state if low else state
    step = arb(0).union(span)
    every = (matrix * step).exp() * start
    total, power, factorial = arb(0), arb(1), 1
    for k in range(TAYLOR + order + 1):
        factorial *= max(k, 1)
        if k >= order:
            total += (form * (every if k == TAYLOR + order else start))[0, 0] / factorial * power
            power *= step
        form = form * matrix
    return bool(total > 0)


@ctx.workprec(SIGNS)
def positive(matrix, row, begin, end, time, orders, closed=False, at_entry=False):
    """Whether a form is positive over a zone of ẋ = Mx, from one state to another, with zeros of these orders there, or grows
    along a curve. Between the pieces at the ends it is followed from either of them; where the zone may be closed, from
    its end alone, or from its entry."""
    # backwards in time the flow is that of −M
    ways = flows(matrix, row, begin), flows([[-x for x in line] for line in matrix], row, end)
    time, firsts = real(dual(time).v), []
    length, shortest = (float(end) * (1 + sign * 2**-40) for end, sign in ((time.upper(), 1), (time.lower(), -1)))
    # an instant that the shortest zone does not have has nothing to grow from at the end of the curve
    shown = lambda way, low, high, order: any(over(*flow, low, high, order) for k, flow in enumerate(way) if not k or high <= shortest)
    if closed:
        side = 0 if at_entry else 1
        return over(*ways[side][0], 0, length, orders[side])
    for way, order in zip(ways, orders):
        first = length / 2 if order else 0.0
        while order and not shown(way, 0, first, order):
            first /= 2
            if not first > length / 2**DEPTH:
                return False
        firsts.append(first)
    from_end = lambda t: time - arb(t)
    pieces = [(firsts[0], (length - firsts[1]) * (1 + 2**-40), 0)]
    while pieces:
        low, high, depth = pieces.pop()
        middle = (low + high) / 2
        back = max(float(from_end(high).lower()) * (1 - 2**-40), 0.0), float(from_end(low).upper()) * (1 + 2**-40)
        if low >= high or shown(ways[0], low, high, 0) or shown(ways[1], *back, 0):
            continue
        if depth == DEEPEST[len(ways[0]) - 1]:
            return False
        pieces += [(low, middle, depth + 1), (middle, high, depth + 1)]
    return True
