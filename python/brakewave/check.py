"""An independent check of what `brakewave certify` proves.

    python -m brakewave.check results/mode4_mismatch

It takes nothing from the program but the statements and, as a first guess, the waves in doubles. It poses the
equations of docs/theory.md again from the decimals of the problem, solves them in balls of Arb (python-flint) and
prints a line for every statement: `proven again`, `refused: reason` or `not covered: reason`. Exit code: 0 if everything
that is stated was proven again, 1 if a statement is refused, 2 if the certificate cannot be read, 3 if none is refused but
something is not covered. What a folder says in words, theorem.md above all, is not looked at; the last lines say so and leave
the exit code as it is. docs/proofs.md says what is covered, and how.
"""

from __future__ import annotations

import csv
import re
import struct
import sys
from math import cos, inf, sin, sqrt
from pathlib import Path
from types import ModuleType
from typing import Any

try:
    from flint import acb, acb_mat, arb, ctx

    from .ball_arcs import join
    from .ball_boxes import orbit_within, same_condition, wave_within
    from .ball_cuts import is_refuted
    from .ball_layers import Layered, LayeredSigns
    from .ball_orbits import Orbit, agree, counted, kind_of, listed, zones_of
    from .ball_spectrum import Perturbed
    from .ball_walk import walk
    from .ball_waves import NAMES, Signs, Wave
    from .balls import Named, NotCovered, Number, Refused, Tagged, decimal, double, exact, must, prove_zero, whole
    from .check_equilibria import EquilibriumPoint
    from .statements import NUMBERS, ORBITS, OUTCOMES, WAVES, Statements, between, condition_of, fields, head_of, is_written, text, variant
except ImportError as error:
    sys.exit(f"{error}: `pip install python-flint` gives the balls that this check needs")

COUNTING = 96
"""Bits in which eigenvalues are counted: their number is whole."""

# ---------------------------------------------------------------------------------------------------- RON
BLANK = re.compile("[ \\t\\n\\v\\f\\r\\x85\\u200e\\u200f\\u2028\\u2029]+|//[^\\n]*")
TOKEN = re.compile(
    r'(?P<raw>r(?P<hashes>#*)".*?"(?P=hashes))|(?P<string>"(?:[^"\\]|\\.)*")'
    r"|(?P<byte>b'(?:[^'\\]|\\x..|\\.)')"
    r"|(?P<based>[-+]?0[box][0-9a-fA-F_]+(?:[iu][0-9]+)?\b)"
    r"|(?P<number>[-+]?(?:inf|NaN|(?:[0-9]|\.[0-9])[0-9._]*(?:[eE][-+]?[0-9_]+)?)(?:[fiu][0-9]+)?\b\.?)"
    r"|(?P<name>r#[\w.+-]+|[A-Za-z_]\w*)|(?P<mark>[()\[\]{}:,])|(?P<end>\Z)",
    re.S,
)
EXTENSIONS = re.compile(r"#\s*!\s*\[\s*enable\s*\(([\w\s,]*)\)\s*\]")
READ_ALIKE = {"implicit_some", "unwrap_newtypes", "unwrap_variant_newtypes"}
"""Extensions of RON with which a text is read here as it is without them."""
ESCAPE = re.compile(r"\\(?:x([0-9a-fA-F]{2})|u\{([0-9a-fA-F]{1,6})\}|(\r?\n[ \t\r\n]*)|(.))", re.S)
ESCAPED = {"n": "\n", "r": "\r", "t": "\t", "0": "\0", "\\": "\\", '"': '"', "'": "'"}
CLOSING = {"(": ")", "[": "]", "{": "}"}


def blank(text, place):
    """Where blanks and comments end, of which those in /* */ may hold others."""
    while True:
        found = BLANK.match(text, place)
        if found:
            place = found.end()
        elif text.startswith("/*", place):
            depth, place = 1, place + 2
            while depth:
                mark = re.compile(r"/\*|\*/").search(text, place)
                if not mark:
                    raise ValueError("a comment does not end")
                depth, place = depth + (1 if mark[0] == "/*" else -1), mark.end()
        else:
            return place


def unescaped(string):
    """What stands between the quotes of a string."""

    def character(found):
        code = found[1] or found[2]
        if found[3]:
            # the string goes on in the next line
            return ""
        if not code and found[4] not in ESCAPED:
            raise ValueError(f"no escape in RON: {found[0]!r}")
        return chr(int(code, 16)) if code else ESCAPED[found[4]]

    return ESCAPE.sub(character, string)


def number_of(token):
    """A number in decimals. Other spellings of one have the shortest decimal that reads as their value."""
    plain = token.replace("_", "")
    suffix = re.search(r"(?<=[0-9.fN])[fiu](?:8|16|32|64|128)$", plain)
    if suffix is None:
        return Number(plain)
    value = float(plain[: suffix.start()])
    return Number(repr(struct.unpack("f", struct.pack("f", value))[0] if suffix[0] == "f32" else value))


def after_extensions(text):
    """Where the value of a RON text begins."""
    place = blank(text, int(text.startswith("\ufeff")))
    while found := EXTENSIONS.match(text, place):
        unknown = {it.strip() for it in found[1].split(",")} - READ_ALIKE - {""}
        if unknown:
            raise ValueError(f"RON with {', '.join(sorted(unknown))} is not read")
        place = blank(text, found.end())
    return place


def read_ron(text):
    """The value of a RON text: dict, tuple, list, str, Named, Number, bool, None or Tagged."""
    tokens, place = [], after_extensions(text)
    while not tokens or tokens[-1][0] != "end":
        place = blank(text, place)
        found = TOKEN.match(text, place)
        if not found:
            raise ValueError(f"no RON at character {place}")
        kind = "raw" if found["raw"] else found.lastgroup
        tokens.append((kind, found[kind]))
        place = found.end()
    tokens.reverse()

    def sequence(opening):
        """What follows a bracket: a dict where names or keys stand, else a list or a tuple."""
        items, pairs, close = [], [], CLOSING[opening]
        while tokens[-1][1] != close:
            item = value()
            if tokens[-1][1] == ":" and opening != "[":
                tokens.pop()
                pairs.append((item, value()))
            else:
                items.append(item)
            if tokens[-1][1] == ",":
                tokens.pop()
            elif tokens[-1][1] != close:
                raise ValueError(f"found {tokens[-1][1]!r}, not `,` or `{close}`")
        tokens.pop()
        if opening == "{" or pairs:
            if items or len(dict(pairs)) != len(pairs):
                raise ValueError("a field is there twice, or has no name")
            return dict(pairs)
        return items if opening == "[" else tuple(items)

    def value():
        kind, token = tokens.pop()
        if kind == "string":
            return unescaped(token[1:-1])
        if kind == "raw":
            return token[token.index('"') + 1 : token.rindex('"')]
        if kind == "number":
            return number_of(token)
        if kind == "based":
            return Number(repr(float(int(re.sub("[iu][0-9]+$", "", token), 0))))
        if kind == "byte":
            return Number(repr(float(ord(unescaped(token[2:-1])))))
        if token in CLOSING:
            return sequence(token)
        if kind != "name":
            raise ValueError(f"found {token!r}, not a value")
        token = Named(token.removeprefix("r#"))
        if tokens[-1][1] != "(":
            return {"true": True, "false": False, "None": None}.get(token, token)
        tokens.pop()
        held = sequence("(")
        if isinstance(held, tuple) and len(held) == 1:
            held = held[0]
        return held if token == "Some" else Tagged(token, held)

    result = value()
    if tokens[-1][0] != "end":
        raise ValueError("more than one value")
    return result


def type_of(wave, said):
    """Type of a point by what singles it out."""
    if wave.kind == "Value":
        return said if said in ("UZ", "EP") else "UZ or EP"
    if wave.kind != "Margin":
        return "LP" if wave.kind == "Fold" else "HB" if float(wave.condition.value["omega"]) else "BP"
    regime, entry = wave.zones[wave.zone]
    after = wave.zones[(wave.zone + 1) % wave.count][0]
    if wave.watch == "Duration":
        if regime == "Reverse" and after == "Stick" and entry in ("Reversal", "ArrestedLanding"):
            return "RV"
        return "ST" if regime == "Stick" else "GR" if entry == "TakeOff" else "CO"
    return {"Pressure": "GR", "LowerForce": "RV", "UpperForce": "ST", "Rate": "ST"}.get(wave.watch, "CO")


def snake(name):
    """MassDamping as mass_damping."""
    return re.sub(r"(?<!^)(?=[A-Z])", "_", name).lower()


UNDECIDED = {
    "Neutral": "undecided: an eigenvalue is on the imaginary axis",
    "HighFrequency": "undecided: growth beyond the window is not excluded",
}
"""Why a verdict does not say whether a wave is stable, in the table."""


class Point(Statements):
    """A point of a branch of waves."""

    there = None
    """The wave beyond a change of the sequence, once it is proven."""

    COLUMNS = "label type parameter low high speed_low speed_high unique inequalities proven why unstable arc arc_why growing stable stable_why"

    def statements(self):
        """Names of the statements and what checks them."""
        yield "fields", self.fields
        yield "wave, in its intervals", self.wave
        yield "wavelength, traversed once", self.once
        yield from self.common()
        if self.proof["beyond"] is not None:
            yield "the same wave beyond", self.beyond
        for eigenvalue in self.proof.get("eigenvalues", []):
            yield f"eigenvalue in sector {int(eigenvalue['sector'])}", lambda it=eigenvalue: self.eigenvalue(it)
        if self.growth is not None and self.growth.name == "Open":
            yield "growing eigenvalues", self.uncounted
        if self.growth is not None and self.growth.name == "Proven":
            yield "growing eigenvalues", self.counts
            for leading in self.growth.value["leading"]:
                yield f"leading eigenvalue of sector {int(leading['sector'])}", lambda it=leading: self.leads(it)
            yield "stability", self.verdict

    def fields(self):
        """That nothing is stated but what is proven here, and that it is of its kind."""
        proof, said = self.proof, self.said
        self.head(WAVES["parameter"])
        fields(proof, "posed condition beyond near statement", "eigenvalues", condition=WAVES["condition"])
        fields(self.posed, "written impact parameter mode unit", impact=WAVES["impact"], parameter=WAVES["parameter"])
        written = self.posed["written"]
        fields(written, "origin friction mismatch damping ratio", "material", origin=WAVES["origin"])
        for held in (written[name] for name in ("friction", "mismatch", "damping", "ratio", "material") if written.get(name) is not None):
            text(held)
        fields(said, "parameter speed lengths unique inequalities", "omega")
        unit = double(self.posed["unit"])
        must(0 < unit < inf, "the unit of the parameter is no length")
        self.distance_is_one(unit)
        crossing = condition_of(proof) == "Crossing"
        must((said.get("omega") is not None) == crossing, "ω is stated where nothing crosses, or not where it does")
        for interval in [said["parameter"], said["speed"], *said["lengths"], *filter(None, [said.get("omega")])]:
            fields(interval, "low high")
        for of in filter(None, (proof, proof["beyond"])):
            if of is not proof:
                fields(of, "condition near", condition=WAVES["condition"])
            self.near_fields(of["near"])
        for one in proof.get("eigenvalues", []):
            fields(one, "sector near growth omega")
            fields(one["growth"], "low high"), fields(one["omega"], "low high")
        fixed = condition_of(proof) == "Value"
        must(fixed or not proof.get("eigenvalues"), "eigenvalues are enclosed at values of the parameter")
        must(fixed or crossing or self.growth is None, "eigenvalues are counted at values of the parameter and crossings")
        if self.growth is not None and self.growth.name == "Proven":
            growth = self.growth.value
            fields(growth, "window mode counts leading verdict", verdict=WAVES["verdict"])
            must(0 < double(growth["window"]) < inf, "the window has no height, or no end")
            for one in growth["leading"]:
                fields(one, "sector line")
                must(-inf < double(one["line"]) < inf, "a line that is nowhere")
            leading = [whole(one["sector"]) for one in growth["leading"]]
            must(len(set(leading)) == len(leading), "two eigenvalues lead one sector")

    def near_fields(self, near):
        """That the wave in doubles has the numbers of one, and of layers where there are any."""
        fields(near, "signature zones excess parameter", "layers")
        for zone in near["signature"][0]:
            fields(zone, "regime entry", regime=WAVES["regime"], entry=WAVES["entry"])
        layers = [double(layer) for layer in near.get("layers", [])]
        layered = self.posed["written"].get("material") is not None
        must(len(layers) == (len(near["zones"]) if layered else 0), "β is given without the layers of the wave, or these without β")

    def posing(self, of):
        """The equations of the point itself, or of it as the wave beyond."""
        layered = self.posed["written"].get("material") is not None
        return (Layered if layered else Perturbed)(self.posed, of["near"], of["condition"])

    def wave(self):
        wave = self.posing(self.proof)
        must(wave.posed["parameter"] == self.point["parameter"], "its equations vary another parameter")
        self.zero = prove_zero(wave.equations, wave.guess)
        self.x = wave.enclosed(self.zero)
        self.parts = wave.parts(self.x)
        lengths = [(t * self.parts.c * wave.sign).real for _, _, t in self.parts.zones]
        found = [("the parameter", self.x[wave.base - 1].real, self.said["parameter"])]
        found += [("the speed", self.parts.c.real, self.said["speed"])]
        must(len(lengths) == len(self.said["lengths"]), "there are not as many lengths as zones")
        found += [("the length of a zone", *both) for both in zip(lengths, self.said["lengths"])]
        if wave.kind == "Crossing":
            self.omega = arb(0) if wave.at_zero else self.x[wave.base].real
            must(wave.at_zero or not self.omega.contains(0), "it may cross at λ = 0")
            must(not wave.at_zero or wave.is_simple(self.parts), "λ = 0 may be a double eigenvalue")
            found += [("ω", self.omega, self.said["omega"])]
        self.compare(found)
        self.which = [found[0][1], found[1][1]]
        self.solved = wave

    def once(self):
        must(self.solved.primitive(self.x), "it may be a wave of a part of the wavelength")
        self.first()

    within = staticmethod(wave_within)

    def of_zero(self, zero):
        """A zero of the equations, as the wave and its unknowns."""
        return self.solved, self.solved.enclosed(zero)

    def unit(self):
        return self.posed["unit"]

    def alike(self, other):
        layered = isinstance(self.solved, Layered)
        same = not layered and other.solved is not None and same_condition(self.proof["condition"], other.proof["condition"])
        return same and {**self.posed, "written": self.fixed()} == {**other.posed, "written": other.fixed()}

    def is_event_of(self, other):
        """Whether the event of another point may be the same. Values of the parameter are none."""
        one, two = self.solved, other.solved
        if one.kind != two.kind or one.kind == "Value":
            return False
        entries = [[[double(y) for y in zone[:2]] for zone in point.proof["near"]["zones"]] for point in (self, other)]
        meet = all(a.overlaps(b) for a, b in zip(self.which, other.which))
        same = meet and begin_alike(*entries)
        if one.kind != "Crossing":
            return same
        conjugate = (one.sector + two.sector) % one.mode == 0 and self.omega.overlaps(-other.omega)
        return same and (conjugate or one.sector == two.sector and self.omega.overlaps(other.omega))

    def numbers(self):
        restarted, source, posed, written = self.begins("wave"), self.source, self.posed, self.posed["written"]
        has_value = condition_of(self.proof) == "Value"
        continuation = source["continuation"]
        must(continuation["parameter"] == posed["parameter"], "the parameter is not that of the problem")
        low, high = continuation["range"]
        must(double(posed["unit"]) == high - low, "the unit of the parameter is not the width of its range")
        must(whole(source["wave"]["mode"]) == whole(posed["mode"]), "the mode is not that of the problem")
        if restarted and has_value:
            self.asked(None, restarted)
        if restarted or "model" not in source:
            raise NotCovered("numbers that do not stand in a problem file: a tube in SI units, a restart")
        model, given = source["model"], {}
        law, damping = model.get("friction_law", "Coulomb"), model.get("damping", {})
        origin = model["coefficients"]
        must(origin.name == written["origin"].name, "the coefficients are given otherwise")
        names = {"Geometry": ["nu", "xi", "gamma"], "Given": ["a", "b", "D", "g", "h"]}[origin.name]
        told = lambda number: number.text if isinstance(number, Number) else "0"
        problem = {name: told(origin.value[name]) for name in names}
        problem |= {"friction": told(model["friction"]), "mismatch": told(model["mismatch"])}
        problem |= {"mass_damping": told(damping.get("mass")), "stiffness_damping": told(damping.get("stiffness"))}
        numbers = *written["origin"].value, written["friction"], written["mismatch"], written["damping"]
        numbers += (written.get("material") or "0",)
        given = dict(zip(problem, numbers))
        varies = snake(posed["parameter"])
        for name, number in problem.items():
            # the branch from a Hopf point begins at a value that is computed
            computed = name == varies and source["wave"]["start"] == "Hopf"
            must(computed or exact(number) == exact(given[name]), f"{name} is {number} in the problem")
        must(law == "Coulomb" or law.name == "Static", "another law of friction in the problem")
        ratio = None if law == "Coulomb" else law.value["ratio"]
        ratios = [exact(number or "1") for number in (ratio and ratio.text, written["ratio"])]
        must(ratios[0] == ratios[1], "static friction is not that of the problem")
        must(model.get("impact", "Frictionless") == posed["impact"], "impacts are not those of the problem")
        material = any(exact(number) for number in [told(damping.get("stiffness"))]) or posed["parameter"] == "StiffnessDamping"
        must(material == (written.get("material") is not None), "β is in the equations of one, not of the other")
        if self.point["kind"] in ("UZ", "EP") and has_value:
            self.asked(Number(problem[varies]) if varies in problem else None)

    def kind(self):
        return type_of(self.solved, self.point["kind"])

    def inequalities(self):
        found = self.signs(self.solved, self.x)
        must(found == whole(self.said["inequalities"]), f"there are {found} of them")

    @staticmethod
    def signs(wave, x):
        """Shows every inequality of a wave. Returns how many there are, but for those of its model."""
        signs = (LayeredSigns if isinstance(wave, Layered) else Signs)(wave, x)
        count = 0
        for counted, inequalities in (0, signs.presumed()), (1, signs.model_signs()), (1, signs.all()):
            for what, holds in inequalities:
                must(holds, f"{what} is not shown")
                count += counted
        return count

    def beyond(self):
        """That the wave is one in another sequence of zones, in which an event of its type is at the same place."""
        solved, beyond = self.solved, self.posing(self.proof["beyond"])
        must(solved.watch, "the sequence of zones changes where a margin vanishes")
        turned = [beyond.zones[i:] + beyond.zones[:i] for i in range(beyond.count)]
        must(solved.zones not in turned, "the sequence of zones beyond is that before")
        x = beyond.enclosed(prove_zero(beyond.equations, beyond.guess))
        must(beyond.watch and type_of(beyond, self.point["kind"]) == self.point["kind"], "it is an event of another type")
        must(beyond.primitive(x), "it may be a wave of a part of the wavelength")
        self.signs(beyond, x)
        parts, pairs = beyond.parts(x), [(x[beyond.base - 1], self.x[solved.base - 1])]
        meet = lambda pairs: all(acb(one).overlaps(acb(other)) for one, other in pairs)
        must(meet([*pairs, (parts.c, self.parts.c)]), "it is another wave")
        here, there = solved.motion(self.parts), beyond.motion(parts)
        same = lambda one, other: one[0] == other[0] and meet([*zip(one[1], other[1]), (one[2], other[2])])
        turned = [there[i:] + there[:i] for i in range(len(there))]
        must(len(here) == len(there) and any(all(map(same, here, turn)) for turn in turned), "it is another wave")
        self.there = beyond, x

    def fixed(self):
        """The numbers of the model that do not change along the branch."""
        written, varies = dict(self.posed["written"]), self.posed["parameter"]
        if varies in NAMES:
            texts = zip(NAMES, written["origin"].value)
            written["origin"] = Tagged("Geometry", tuple("" if name == varies else text for name, text in texts))
        else:
            written[{"MassDamping": "damping", "StiffnessDamping": "material"}.get(varies, varies.lower())] = ""
        return written

    def seen(self):
        """The wave from which an arc leads on: that beyond a change of the sequence."""
        if condition_of(self.proof) != "Margin":
            return self.solved, self.x, self.proof["near"]
        must(self.there is not None, "nothing is known beyond an event")
        return *self.there, self.proof["beyond"]["near"]

    def arc(self):
        """That nothing is found which refutes it."""
        before = self.before
        must(before is not None and before.solved is not None, "the point before it is not shown")
        must(before.point.get("leg") == self.point.get("leg"), "the branch does not lead from the point before to this")
        fixed = ({**it.posed, "written": it.fixed()} for it in (before, self))
        must(next(fixed) == next(fixed), "its ends have not one model")
        (first, x, near), last = before.seen(), self.solved
        must(first.zones == last.zones, "its ends have not one sequence of zones")
        value = Tagged("Value", repr(double(near["parameter"])))
        wave = (Layered if isinstance(last, Layered) else Wave)(self.posed, near, value)
        wave.divided = first.divided | last.divided
        walk(wave, [x, self.x], self.signs, (1, -1) if first.kind == "Fold" else (1,))
        super().arc()

    def unique(self):
        try:
            super().unique()
        except NotCovered:
            refuted = not isinstance(self.solved, Layered) and is_refuted(self.solved, self.zero.middle, double(self.said["unique"]))
            must(not refuted, "Krawczyk's operator does not map so large a box into its interior")
            raise

    def table(self):
        must(self.row is None or " ".join(map(str, self.row)) == self.COLUMNS, "the columns are others")
        grows = any(double(it["growth"]["low"]) > 0 for it in self.proof.get("eigenvalues", []))
        stable = growing = why = ""
        if self.growth is not None and self.growth.name == "Open":
            why = self.growth.value
        if self.growth is not None and self.growth.name == "Proven":
            verdict, mode = self.growth.value["verdict"], whole(self.posed["mode"])
            name = verdict.name if isinstance(verdict, Tagged) else verdict
            stable = {"Stable": "yes", "Unstable": "no"}.get(name, "")
            # a sector between 0 and k/2 counts for its conjugate too
            counts = enumerate(self.growth.value["counts"])
            why = UNDECIDED.get(name, "")
            growing = str(sum(whole(count) * (1 if 2 * sector in (0, mode) else 2) for sector, count in counts))
        self.compare_row(
            snake(self.point["parameter"]),
            [
                ("parameter", ("low", "high"), self.x[self.solved.base - 1].real),
                ("speed", ("speed_low", "speed_high"), self.parts.c.real),
            ],
            unstable="yes" if grows else "", stable=stable, growing=growing, stable_why=why,
        )  # fmt: skip

    def perturbed(self):
        if not isinstance(self.solved, Perturbed):
            raise NotCovered("eigenvalues with material damping")
        return self.solved

    def eigenvalue(self, said):
        ball = self.perturbed().eigenvalue(self.parts, said["sector"], said["near"])
        holds = between(ball.real, said["growth"]) and between(ball.imag, said["omega"])
        must(holds, f"it is {ball.str(15, radius=False)}")

    def window(self):
        """The largest |Im λ| that the problem asks for, by itself or as what goes with γ; None where it does not stand there."""
        source = self.source or {}
        section = source.get("stability") or {}
        if "max_frequency" in section:
            return double(section["max_frequency"])
        if "model" not in source or self.begins("wave"):
            return None
        origin = source["model"]["coefficients"]
        return 12 / sqrt(double(origin.value["gamma"]) if origin.name == "Geometry" else 1.0)

    def uncounted(self):
        raise NotCovered("the certificate says in words why they are not counted, which proves nothing")

    def counts(self):
        growth, mode, crossing = self.growth.value, self.solved.mode, self.solved.kind == "Crossing"
        sectors, window = range(mode // 2 + 1), double(growth["window"])
        must(
            whole(growth["mode"]) == mode and len(growth["counts"]) == len(sectors), "there are not as many as sectors"
        )
        known = [int(sector == 0) for sector in sectors]
        if crossing:
            # of a sector above k/2 the conjugate
            sector = min(self.solved.sector, mode - self.solved.sector)
            must(abs(self.omega) < window, "what crosses lies beyond the window")
            known[sector] += 2 if self.solved.is_real(sector) and not self.solved.at_zero else 1
        known[0] += self.perturbed().swings(self.parts, window)
        with ctx.workprec(COUNTING):
            found = self.perturbed().growing(self.parts, sectors, window, known, self.discs)
        must(found == [whole(count) for count in growth["counts"]], f"they are {found}")
        must(self.window() in (None, window), "the window is not that of the problem")
        self.found = found

    def leads(self, said):
        mode = self.solved.mode
        sector, line = whole(said["sector"], mode // 2 + 1), double(said["line"])
        window = double(self.growth.value["window"])
        near = [it["near"] for it in self.proof.get("eigenvalues", []) if it["sector"] == sector]
        must(len(near) == 1, "no eigenvalue of this sector is enclosed")
        ball = self.perturbed().eigenvalue(self.parts, said["sector"], near[0])
        must(sector or not ball.contains(0), "it is the translation mode")
        must(ball.real > line, "the eigenvalue is left of the line")
        must(abs(ball.imag) < window, "the eigenvalue lies beyond the window")
        paired = 2 * sector in (0, mode) and not ball.imag.contains(0)
        expected = 1 + int(paired) + int(sector == 0 and line < 0)
        with ctx.workprec(COUNTING):
            (found,) = self.perturbed().right_of(self.parts, [sector], window, line, self.discs)
        must(found == expected, f"{found} eigenvalues are right of the line, not {expected}")

    def verdict(self):
        verdict = self.growth.value["verdict"]
        found = getattr(self, "found", None)
        if found is None:
            raise NotCovered("stability without a count")
        at_rest = "Neutral" if self.solved.kind == "Crossing" else "HighFrequency"
        follows = "Unstable" if any(found) else at_rest
        damped = self.parts.m.damping.real > 0
        must(damped or not isinstance(verdict, Tagged), "without damping no frequency is too high to grow")
        if isinstance(verdict, Tagged) and verdict.name == "Stable" and follows == "HighFrequency":
            raise NotCovered("eigenvalues of high frequency")
        must(verdict == follows, f"what is counted makes it {follows}")


def begin_alike(one, other):
    """Whether every zone of the one of two orbits that has fewer begins where one of the other does: whatever zone is the first, and
    from whatever side of an event either is seen."""
    sizes = [max(map(abs, numbers)) for numbers in zip(*one, *other)]
    alike = lambda a, b: all(abs(x - y) <= 1e-6 * size for x, y, size in zip(a, b, sizes))
    fewer, more = sorted((one, other), key=len)
    return all(any(alike(a, b) for b in more) for a in fewer)


class OrbitPoint(Statements):
    """A point of a branch of orbits of a system."""

    COLUMNS = "label type parameter low high period_low period_high unique inequalities proven why outside angle_low angle_high arc arc_why"

    def arc(self):
        before = self.before
        must(before is not None and before.solved is not None, "the point before it is not shown")
        must(before.point.get("leg") == self.point.get("leg"), "the branch does not lead from the point before to this")
        join(*zip(before.seen("after"), self.seen("before")))
        self.tally()

    def tally(self):
        """That the number of multipliers outside is that at the last point where it is stated, with what passes at the events
        between: one real multiplier, or a pair."""
        outside, possible, passing = self.said.get("outside"), None, []
        if outside is None:
            return
        point = self.before
        while point is not None and point.point.get("leg") == self.point.get("leg"):
            kind = condition_of(point.proof)
            if kind == "Margin":
                return
            if kind == "Value" and point.said.get("outside") is not None:
                possible = {whole(point.said["outside"])}
                break
            passing += {"Value": [], "Torus": [2]}.get(kind, [1])
            point = point.before
        if possible is None:
            return
        for several in passing:
            possible = {n + sign * several for n in possible for sign in (1, -1)}
        # an arc says nothing of where multipliers cross: what is left out may be one of these
        if whole(outside) not in possible:
            raise NotCovered("where the number of multipliers outside changes on the way is not stated")

    def seen(self, side):
        """The orbit in the sequence before a change or after it, where it may be proven in the other, with its data."""
        proof, changed = self.proof, self.proof.get("changed")
        sequence = changed[side] if changed else proof["near"]["sequence"]
        must(sequence is not None, "nothing is known beyond an event")
        there = (k for k, it in enumerate((proof, *proof.get("seen", []))) if listed(it["near"]["sequence"]) == listed(sequence))
        which = next(there, None)
        must(which is not None, "its ends have not one sequence of zones")
        return self.beyond(which - 1) if which else ((self.solved, self.x), proof["near"])

    def beyond(self, which):
        """That an orbit that is seen in another sequence is that of the event."""
        if which not in self.others:
            seen = self.proof["seen"][which]
            orbit, _, x, *_ = self.solve(seen)
            self.signs(orbit, x)
            must(self.value.overlaps(x[orbit.place].real), "beyond its event is another orbit")
            must(agree(self.solved.legs(self.x), orbit.legs(x)), "beyond its event is another orbit")
            self.others[which] = (orbit, x), seen["near"]
        return self.others[which]

    def statements(self):
        """Names of the statements and what checks them."""
        yield "fields", self.fields
        yield "orbit, in its intervals", self.orbit
        yield "period, traversed once", self.once
        yield from self.common()
        for which in range(len(self.proof.get("seen", []))):
            yield "the same orbit in another sequence", lambda which=which: self.beyond(which)
        if self.said.get("outside") is not None:
            yield "multipliers outside the unit circle", self.outside

    def fields(self):
        """That nothing is stated but what is proven here, and that it is of its kind."""
        proof, said = self.proof, self.said
        self.head()
        fields(proof, "posed condition near statement", "changed seen", condition=ORBITS["condition"])
        fields(self.posed, "system values parameter periods units")
        self.values_are_texts()
        fields(self.posed["units"], "states time parameter")
        fields(said, "parameter period unique inequalities", "angle outside")
        units = self.posed["units"]
        must(all(0 < double(unit) < inf for unit in (*units["states"], units["time"], units["parameter"])), "a unit that is no length")
        self.distance_is_one(double(units["parameter"]))
        angles = [said[name] for name in ["angle"] if said.get(name) is not None]
        for interval in [said["parameter"], said["period"], *angles]:
            fields(interval, "low high")
        changed, seen = proof.get("changed"), proof.get("seen", [])
        must(changed is not None or not seen, "an orbit is seen in another sequence where none changes")
        if changed is not None:
            fields(changed, "watch zone before after", watch=ORBITS["watch"])
        for one in seen:
            fields(one, "condition near", condition=ORBITS["condition"])
        must((said.get("angle") is not None) == (condition_of(proof) == "Torus"), "an angle is stated where no pair crosses, or none where one does")
        sequences = [it["near"]["sequence"] for it in (proof, *seen)]
        for near in [it["near"] for it in (proof, *seen)]:
            fields(near, "sequence zones parameter")
            for zone in near["zones"]:
                fields(zone, "state duration phase")
        for sequence in filter(None, sequences + [changed[side] for side in ("before", "after") if changed]):
            for zone in zones_of(sequence):
                fields(zone, "mode way name", "label")
                if zone["way"] is not None:
                    fields(zone["way"], "guard exit")

    def once(self):
        must(self.solved.primitive(self.x), "it may be an orbit of a part of it")
        self.first()

    within = staticmethod(orbit_within)

    def of_zero(self, zero):
        """A zero of the equations, as the orbit and its unknowns."""
        return self.solved, [acb(arb(y.real, zero.radius)) for y in zero.middle]

    def unit(self):
        return self.posed["units"]["parameter"]

    def is_event_of(self, other):
        """Whether the event of another point may be the same. Values of the parameter are none."""
        if self.solved.kind != other.solved.kind or self.solved.kind == "Value":
            return False
        if self.solved.kind == "Torus" and not self.angle.overlaps(other.angle):
            return False
        circle = lambda phase: [cos(phase), sin(phase)]
        entries = [[[*map(double, zone["state"]), *circle(double(zone["phase"]))] for zone in point.proof["near"]["zones"]] for point in (self, other)]
        return self.value.overlaps(other.value) and self.period.overlaps(other.period) and begin_alike(*entries)

    def orbit(self):
        names = list(self.posed["system"]["parameters"])
        must(names[whole(self.posed["parameter"], len(names))] == self.point["parameter"], "its equations vary another parameter")
        orbit, self.zero, self.x, self.value, self.period = self.solve(self.proof)
        self.solved = orbit
        found = [("the parameter", self.value, self.said["parameter"]), ("the period", self.period, self.said["period"])]
        if orbit.kind == "Torus":
            self.angle = self.x[orbit.place + 1].real
            must(0 < self.angle and self.angle < arb.pi(), "the angle of a pair lies between 0 and π")
            found.append(("the angle", self.angle, self.said["angle"]))
        self.compare(found)

    def solve(self, of):
        """The equations of the orbit in a sequence, their zero with its unknowns, the parameter and the period."""
        orbit = Orbit(self.posed, of["near"], of["condition"])
        middle, radius = zero = prove_zero(orbit.equations, orbit.guess)
        # real equations and a real guess: the zero is real
        x = [acb(arb(y.real, radius)) for y in middle]
        must(orbit.domain.contains(x[orbit.place].real), "the parameter in doubles is that of another orbit")
        times = [x[k * (orbit.n + 1) + orbit.n].real for k in range(len(orbit.stretches))]
        value = decimal(orbit.condition.value).real if orbit.kind == "Value" else x[orbit.place].real
        return orbit, zero, x, value, (1 + orbit.half) * sum(times, arb(0))

    def numbers(self):
        restarted = self.begins("orbit")
        orbit, given = self.source["orbit"], self.of_system(double(self.posed["units"]["parameter"]), restarted)
        must("period" not in orbit, "the period is prescribed in the problem")
        begins = given[self.point["parameter"]]
        known = self.units(None if restarted else begins)
        if condition_of(self.proof) == "Value":
            self.asked(begins, restarted)
        if restarted:
            raise NotCovered("numbers of an earlier run")
        asked = whole(orbit.get("periods", Number("1")))
        periods, simulated = whole(self.posed["periods"]), orbit["start"].name == "Simulate"
        # a doubling on the branch of the doubled orbit is one of the shorter orbit
        part = condition_of(self.proof) == "Doubling" and periods and asked % periods == 0
        forced = self.posed["system"].get("forcing") is not None
        must(not forced or periods == asked or part or simulated and 0 < periods < asked, "the problem asks for another number of periods")
        self.units_are(known)

    def units(self, start):
        """That units of states and time are those of all points, and about the size of the orbit with which the branch begins: twice,
        for that may be given roughly. Returns whether that orbit, or a point before with these units, is there to tell."""
        units = self.posed["units"]
        must(all(other.posed["units"] == units for other in self.earlier), "the units are not those of the points before")
        orbit = self.solved
        if self.earlier:
            return True
        if start is None or self.skipped or orbit is None or orbit.kind != "Value" or not is_written(start, orbit.condition.value):
            return False
        period = abs(float(self.period.mid()))
        must(period <= 2 * units["time"] and units["time"] <= 2 * period, "the unit of time is not the period of the first orbit")
        width = orbit.n + 1
        for k in range(len(orbit.stretches)):
            sizes = (abs(float(y.real.mid())) for y in self.x[k * width : k * width + orbit.n])
            must(all(size <= 2 * unit for size, unit in zip(sizes, units["states"])), "the unit of a state is less than it is on the first orbit")
        return True

    def kind(self):
        changed = self.proof.get("changed") or {}
        zones = [zone for sequence in filter(None, (changed.get("before"), changed.get("after"))) for zone in zones_of(sequence)]
        modes = self.solved.exact.including([whole(zone["mode"]) for zone in zones])
        for zone in zones:
            modes.check_zone(zone)
        return kind_of(self.point, self.proof, self.solved)

    def inequalities(self):
        found = self.signs(*self.solved.whole(self.proof["near"], self.x))
        must(found == whole(self.said["inequalities"]), f"there are {found} of them")

    @staticmethod
    def signs(orbit, x):
        """Shows every inequality. Returns how many there are."""
        signs = list(orbit.all_signs(x, orbit.closed))
        if not all(holds for _, holds in signs) and orbit.mirror(x):
            signs = list(orbit.all_signs(x, orbit.closed))
        wrong = [what for what, holds in signs if not holds]
        must(not wrong, f"{', '.join(wrong)} is not shown")
        return len(signs)

    def outside(self):
        orbit = self.solved
        must(orbit.kind == "Value", "multipliers are counted at values of the parameter")
        found = counted(acb_mat(orbit.returned(*orbit.parts(self.x))).charpoly().coeffs())
        must(found == whole(self.said["outside"]), f"{found} are outside")

    def table(self):
        must(self.row is None or " ".join(map(str, self.row)) == self.COLUMNS, "the columns are others")
        intervals = [("parameter", ("low", "high"), self.value), ("period", ("period_low", "period_high"), self.period)]
        angles = {} if self.solved.kind == "Torus" else {"angle_low": "", "angle_high": ""}
        if self.solved.kind == "Torus":
            intervals.append(("angle", ("angle_low", "angle_high"), self.angle))
        self.compare_row(self.point["parameter"], intervals, outside=self.said.get("outside"), **angles)


EMPTY = "low high speed_low speed_high period_low period_high unique inequalities unstable growing stable outside angle_low angle_high omega_low omega_high lyapunov_low lyapunov_high beyond persists".split()
"""Columns of which a point that is not proven has none."""


def rows_of(table):
    """The rows of a table, whatever the length of a cell: what is no cell of it is refused where cells are compared."""
    csv.field_size_limit(max(csv.field_size_limit(), len(table)))
    return list(csv.DictReader(table.splitlines()))


def told_in_words(path, points):
    """Says what a reader may take for proven, and what nothing here looks at. This is the same of every folder, and no refusal."""
    if path.with_name("theorem.md").exists():
        print("theorem.md: not read: nothing here says whether its words are those of what is proven")
    if any(getattr(point.get(it), "name", "") == "Open" for point in points for it in ("outcome", "arc", "growth")):
        print("why something is not proven: not checked: the certificate says it in words")


def main(folder):
    """Prints a line for every statement of a certificate. Returns the exit code."""
    folder = Path(folder)
    path = folder / "certificate.ron" if folder.is_dir() else folder
    name = path
    try:
        certificate = read_ron(path.read_text(encoding="utf-8"))
        points = certificate["points"]
        if set(certificate) - {"version", "points", "system"}:
            print("certificate: refused: it has fields that there are not")
            return 1
        for point in points:
            # the system stands once
            if "system" in certificate and point["outcome"].name == "Proven":
                point["outcome"].value["posed"].setdefault("system", certificate["system"])
        source, table = path.with_name("source.ron"), path.with_name("certificates.csv")
        source = read_ron(source.read_text(encoding="utf-8")) if source.is_file() else None
        rows = rows_of(table.read_text(encoding="utf-8")) if table.is_file() else None
        refused = uncovered = 0
        if not points:
            print("points: refused: nothing is stated")
            refused += 1
        labels = [whole(point["label"]) for point in points]
        listed = list(map(str, labels)) if rows is None else [row["label"] for row in rows]
        if labels != sorted(set(labels)) or listed != list(map(str, labels)):
            print("labels: refused: they do not ascend as those of the table do")
            refused += 1
        by_label = None if rows is None else {row["label"]: row for row in rows}
        before, shown, skipped = None, [], False
        for point in points:
            name = f"{whole(point['label']):4} {point['kind']}"
            row = by_label and by_label.get(str(whole(point["label"])))
            name_of_outcome, _ = variant(point["outcome"], OUTCOMES)
            if name_of_outcome != "Proven":
                head_of(point, WAVES["parameter"] if isinstance(point["parameter"], Named) else None)
                claims = point.get("growth") is not None or point.get("arc") == "Proven"
                filled = row is not None and any(row.get(it) for it in EMPTY)
                if claims or filled or row is not None and [row["proven"], row["why"]] != ["no", point["outcome"].value]:
                    print(f"{name} row of certificates.csv: refused: it is not proven in the certificate")
                    refused += 1
                before, skipped = None, True
                continue
            held = point["outcome"].value
            of_system = OrbitPoint if "zones" in held["near"] else EquilibriumPoint
            before = (of_system if "system" in held["posed"] else Point)(point, source, row, before)
            before.earlier, before.skipped = list(shown), skipped
            shown += [before]
            is_unsolved = False
            for what, statement in before.statements():
                if is_unsolved and what != NUMBERS:
                    continue
                try:
                    statement()
                    outcome = "proven again"
                except NotCovered as reason:
                    outcome = f"not covered: {reason}"
                    uncovered += 1
                except Refused as reason:
                    outcome = f"refused: {reason}"
                    refused += 1
                print(f"{name} {what}: {outcome}", flush=True)
                # without what solves the equations there is nothing to look at but the numbers of the problem
                if what.startswith(("wave,", "orbit", "equilibrium,", "fields")) and outcome != "proven again":
                    is_unsolved = outcome.startswith("not covered")
                    if not is_unsolved:
                        break
        told_in_words(path, points)
    except Refused as reason:
        # outside of a statement it is about what tells statements apart
        print(f"{name}: cannot be read: {reason}", file=sys.stderr)
        return 2
    except (csv.Error, OSError, ValueError, LookupError, TypeError, AttributeError, ArithmeticError, RecursionError) as error:
        print(f"{name}: cannot be read: {error!r}", file=sys.stderr)
        return 2
    return 1 if refused else 3 if uncovered else 0


def command(arguments: list[str]) -> int | str:
    """What a command line ends with."""
    return main(arguments[1]) if len(arguments) == 2 else str(__doc__)


class _Verb(ModuleType):
    """`brakewave.check` is the name of this module and of a verb of the program: called, it is the verb."""

    def __call__(self, *problems: Any, **settings: Any) -> Any:
        from .program import check

        return check(*problems, **settings)


sys.modules[__name__].__class__ = _Verb

if __name__ == "__main__":
    sys.exit(command(sys.argv))
