"""Distances of uniqueness that are false: another solution of the same equations lies in the box that is said to have one.

check.py says what it is for. Both solutions are proven zeros, in balls. States between the steps of a zone are unknowns of the program,
which cuts zones as it likes; so the two motions are compared over whole zones. Events with a null vector are left out: how long that
is taken is not told by a certificate.
"""

from flint import acb, arb, ctx

from .balls import SIGNS, Refused, Tagged, acb_mat, differences, exact, positive, prove_zero, real, size, times

PLAIN = ("Value", "Margin", "Boundary")
"""What singles out points whose equations have no null vector."""

NEWTON, STEP = 8, arb(2) ** -44
"""Steps of Newton's method towards another solution; step of the differences of their Jacobian."""


def same_condition(one, other):
    """Whether the equations that single out two points are the same, and without a null vector."""
    if not (isinstance(one, Tagged) and isinstance(other, Tagged) and one.name == other.name and one.name in PLAIN):
        return False
    if one.name == "Value":
        return exact(one.value) == exact(other.value)
    # the time of a touch is an unknown
    known = lambda margin: {name: value for name, value in margin.items() if name != "time"}
    return known(one.value) == known(other.value)


def near(pairs):
    """Whether every difference is less than what is given with it, and one of them is not zero."""
    return all(abs(real(apart)) < bound for apart, bound in pairs) and any(not real(apart).contains(0) for apart, _ in pairs)


@ctx.workprec(SIGNS)
def near_between(flows, constant, bounds):
    """Whether states of two motions differ by less over a whole zone, at every share of its duration: of (matrix, state, duration) each,
    with the place of the constant 1 in a state. A bound is (place, what is less, what the difference is too much by)."""
    (first, one, time), (second, other, rest) = flows
    n, m = len(one), len(other)
    rows = [[y * time for y in row] + [0] * m for row in first] + [[0] * n + [y * rest for y in row] for row in second]
    begin = [*one, *other]
    end = [row[0] for row in (acb_mat([[acb(y) for y in row] for row in rows]).exp() * acb_mat([[acb(y)] for y in begin])).tolist()]
    for place, bound, shift in bounds:
        for sign in (1, -1):
            form = [arb(0)] * (n + m)
            form[constant] = bound + sign * shift
            form[place], form[n + place] = form[place] - sign, arb(sign)
            if not positive(rows, form, begin, end, arb(1), (0, 0)):
                return False
    return True


def turned(numbers, by):
    return numbers[by:] + numbers[:by]


def orbit_within(orbit, x, other, y, share):
    """Whether an orbit lies in the box about one of the same equations with this share of the units, whatever zone is the first."""
    units, n, count = orbit.posed["units"], orbit.n, len(orbit.stretches)
    states, time = [arb(unit) * share for unit in units["states"]], arb(units["time"]) * share
    tail = [(x[orbit.place] - y[other.place], arb(units["parameter"]) * share)]
    here, there = ((it.modes(at[it.place])[0].matrices, it.parts(at)[1]) for it, at in ((orbit, x), (other, y)))
    whole_turns = lambda angle: angle - 2 * arb.pi() * round(float(real(angle).mid() / (2 * arb.pi()).mid()))
    for by in range(count if orbit.kind == "Value" else 1):
        if turned(other.sequence, by) != orbit.sequence:
            continue
        legs = [*zip(orbit.stretches, here[1], turned(there[1], by))]
        entries = [pair for _, a, b in legs for pair in [(a[1] - b[1], time), *zip((u - v for u, v in zip(a[2], b[2])), states)]]
        phases = [(whole_turns(a[0] - b[0]), share) for _, a, b in legs if orbit.forced]
        bounds = [(place, bound, arb(0)) for place, bound in enumerate(states)]
        flows = lambda stretch, a, b: ((here[0][stretch.mode], a[2], a[1]), (there[0][stretch.mode], b[2], b[1]))
        if near(tail + entries + phases) and all(near_between(flows(*leg), n, bounds) for leg in legs):
            return True
    return False


def wave_within(wave, x, other, y, share):
    """The same of waves, with the least units that states between steps may have."""
    if len(wave.zones) != len(other.zones):
        return False
    here, there = wave.parts(x), other.parts(y)
    period = sum((abs(real(zone[2])) for zone in here.zones), arb(0))
    rate = size([1] + [zone[1] for zone in here.zones])
    steady = [real(m.friction * m.g * m.mismatch / m.h) for m in (here.m, there.m)]
    excess, place = wave.base - 2, wave.base - 1
    tail = [(x[excess] - y[excess], abs(real(x[excess])) * share), (x[place] - y[place], arb(wave.posed["unit"]) * share)]
    # the time of a touch
    tail += [(a - b, share) for a, b in zip(x[wave.base :], y[wave.base :])]
    for by in range(wave.count if wave.kind == "Value" else 1):
        if turned(other.zones, by) != wave.zones:
            continue
        of = lambda parts, k: [(parts.matrices[i], parts.begins[i], parts.zones[i][2]) for i in turned(list(range(wave.count)), k)]
        legs = [*zip(wave.zones, of(here, 0), of(there, by))]
        entries = [pair for _, a, b in legs for pair in [(a[2] - b[2], period * share), (a[1][3] - b[1][3], rate * share)]]
        # V is told less that of a steady slip
        bounds = [(2, period * share, steady[0] - steady[1]), (3, rate * share, arb(0))]
        flight = [(0, period * share, arb(0)), (1, rate * share, arb(0))]
        held = lambda regime: bounds + (flight if regime == "Separation" else [])
        if near(tail + entries) and all(near_between((a, b), 4, held(zone[0])) for zone, a, b in legs):
            return True
    return False


def rest_within(rest, x, other, y, share):
    """The same of equilibria, whose unknowns are told in units."""
    return rest.near["mode"] == other.near["mode"] and near([(a - b, share) for a, b in zip(x, y)])


def others(equations, middle, radii, shares):
    """Other zeros of equations, next to which there is one in the direction in which it is known least, from these shares of the radii
    on: solutions as `prove_zero` has them."""
    slope = differences(equations, middle)
    scaled = acb_mat([[y * r for y, r in zip(row, radii)] for row in slope.tolist()]).mid()
    try:
        inverse = scaled.inv().mid()
    except ZeroDivisionError:
        return
    soft = [acb(1)] * len(middle)
    for _ in range(3):
        for matrix in (inverse.transpose(), inverse):
            soft = times(matrix, soft)
            soft = [(y / size(soft)).mid() for y in soft]
    for share in shares:
        for sign in (1, -1):
            try:
                yield prove_zero(equations, followed(equations, [(m + sign * share * r * d).mid() for m, r, d in zip(middle, radii, soft)]))
            except (Refused, ZeroDivisionError):
                continue


@ctx.workprec(SIGNS)
def followed(equations, x):
    """Where Newton's method leads from a guess, with a Jacobian of every step: next to a fold an old one leads nowhere."""
    for _ in range(NEWTON):
        inverse = differences(equations, x, STEP).mid().inv().mid()
        x = [(y - step).mid() for y, step in zip(x, times(inverse, equations(x)))]
    return x
