"""Statements on equilibria of systems, and what checks them. check.py says what it is for."""

from flint import acb, arb

from .ball_boxes import rest_within
from .ball_equilibria import Rest
from .balls import NotCovered, Tagged, double, must, whole
from .statements import EQUILIBRIA, Statements, condition_of, fields, is_written

NEAREST = 1e-7
"""An equilibrium in doubles is known to this share of its units."""


class EquilibriumPoint(Statements):
    """A point of a branch of equilibria of a system."""

    COLUMNS = "label type parameter low high unique inequalities proven why growing omega_low omega_high lyapunov_low lyapunov_high beyond persists arc arc_why"

    def statements(self):
        """Names of the statements and what checks them."""
        yield "fields", self.fields
        yield "equilibrium, in its intervals", self.equilibrium
        yield "not an earlier event", self.first
        yield from self.common()
        if self.said.get("lyapunov") is not None:
            yield "first Lyapunov coefficient", self.lyapunov
        if self.said.get("growing") is not None:
            yield "growing eigenvalues", self.growing
        if self.proof.get("beyond") is not None:
            yield "mode beyond", self.beyond

    def fields(self):
        """That nothing is stated but what is proven here, and that it is of its kind."""
        point, proof, said = self.point, self.proof, self.said
        self.head()
        fields(proof, "posed condition near statement", "beyond", condition=EQUILIBRIA["condition"])
        fields(self.posed, "system values parameter units")
        self.values_are_texts()
        fields(proof["near"], "mode state parameter")
        fields(said, "parameter states unique inequalities", "omega lyapunov growing", lyapunov=EQUILIBRIA["lyapunov"])
        must(point.get("arc") is None, "arcs of equilibria are not proven")
        name = condition_of(proof)
        must((said.get("omega") is not None) == (name == "Hopf"), "ω is stated where no pair is imaginary, or not where one is")
        must(said.get("lyapunov") is None or name == "Hopf", "a Lyapunov coefficient is stated where no pair is imaginary")
        must(proof.get("beyond") is None or name == "Boundary", "a mode beyond is stated where no guard is zero")
        if said.get("growing") is not None:
            whole(said["growing"])
        if proof.get("beyond") is not None:
            fields(proof["beyond"], "mode guard persists")
            must(isinstance(proof["beyond"]["persists"], bool), "`persists` is neither true nor false")
        lyapunov = said.get("lyapunov")
        within = [lyapunov.value] if isinstance(lyapunov, Tagged) else []
        frequencies = [said["omega"]] if said.get("omega") is not None else []
        for interval in [said["parameter"], *said["states"], *frequencies, *within]:
            fields(interval, "low high")

    def equilibrium(self):
        rest = Rest(self.posed, self.proof["near"], self.proof["condition"])
        must(rest.parameters[rest.varied] == self.point["parameter"], "its equations vary another parameter")
        self.distance_is_one(double(self.posed["units"][-1]))
        must(len(self.said["states"]) == rest.n, "there is not an interval for every state")
        self.zero = rest.solve()
        near, units = self.proof["near"], [*rest.units[: rest.n], rest.units[rest.size]]
        self.value, near = rest.parameter.real, zip([*rest.y[: rest.n], rest.parameter], [*near["state"], near["parameter"]], units)
        must(all(abs(x - double(there)) < unit * NEAREST for x, there, unit in near), "the numbers in doubles are those of another equilibrium")
        found = [("the parameter", self.value, self.said["parameter"])]
        found += [(name, x.real, interval) for name, x, interval in zip(rest.states, rest.y, self.said["states"])]
        if rest.kind == "Hopf":
            must(rest.omega > 0, "ω is not positive")
            found.append(("ω", rest.omega, self.said["omega"]))
        self.compare(found)
        self.solved = rest

    within = staticmethod(rest_within)

    def of_zero(self, zero):
        """A zero of the equations, as the mode and its unknowns in units."""
        return self.solved, [acb(arb(x.real, zero.radius)) for x in zero.middle]

    def unit(self):
        return self.posed["units"][-1]

    def is_event_of(self, other):
        """Whether the event of another point may be the same. Values of the parameter are none."""
        one, two = self.solved, other.solved
        if one.kind == "Value" or two.kind == "Value":
            return False
        same = self.value.overlaps(other.value) and all(a.overlaps(b) for a, b in zip(one.y[: one.n], two.y[: two.n]))
        return same and (one.omega is None or two.omega is None or one.omega.overlaps(two.omega))

    def numbers(self):
        restarted, units = self.begins("equilibrium"), self.posed["units"]
        given = self.of_system(double(units[-1]), restarted)
        begins = given[self.point["parameter"]]
        must(all(other.posed["units"] == units for other in self.earlier), "the units are not those of the points before")
        rest = self.solved
        known = bool(self.earlier)
        if condition_of(self.proof) == "Value":
            self.asked(begins, restarted)
            if rest is not None and not restarted and not self.earlier and not self.skipped and is_written(begins, rest.condition):
                known = True
                must(all(abs(x.real) <= 2 * unit for x, unit in zip(rest.y[: rest.n], rest.units)), "the unit of a state is less than it is at the first equilibrium")
        if restarted:
            raise NotCovered("numbers of an earlier run")
        self.units_are(known)

    def kind(self):
        said = self.point["kind"]
        return {"Fold": "LP", "Hopf": "HB", "Boundary": "BE"}.get(self.solved.kind) or (said if said in ("UZ", "EP") else "UZ or EP")

    def inequalities(self):
        signs = list(self.solved.signs())
        wrong = [what for what, holds in signs if not holds]
        must(not wrong, f"{', '.join(wrong)} is not shown")
        # another may take guards for several that are written in several ways
        told = len(signs) <= whole(self.said["inequalities"]) <= len(signs) + self.solved.twins
        must(told, f"there are {len(signs)} of them")

    def lyapunov(self):
        said = self.said["lyapunov"]
        if said == "Vertical":
            must(self.solved.is_affine(), "the rates of the mode are not affine as they are written")
        else:
            self.compare([("l₁", self.solved.lyapunov(), said.value)])

    def growing(self):
        found = self.solved.growing()
        must(found == whole(self.said["growing"]), f"{found} grow")

    def beyond(self):
        said = self.proof["beyond"]
        must(self.solved.beyond(said) == said["persists"], "the equilibria of both modes lie otherwise")

    def table(self):
        must(self.row is None or " ".join(map(str, self.row)) == self.COLUMNS, "the columns are others")
        intervals = [("parameter", ("low", "high"), self.value)]
        empty, lyapunov, beyond = {}, self.said.get("lyapunov"), self.proof.get("beyond")
        if self.solved.kind == "Hopf":
            intervals.append(("frequency", ("omega_low", "omega_high"), self.solved.omega))
        else:
            empty |= {"omega_low": "", "omega_high": ""}
        if lyapunov is None:
            empty |= {"lyapunov_low": "", "lyapunov_high": ""}
        else:
            ball = arb(0) if lyapunov == "Vertical" else self.solved.lyapunov()
            intervals.append(("Lyapunov coefficient", ("lyapunov_low", "lyapunov_high"), ball))
        told = {"beyond": beyond["mode"], "persists": "yes" if beyond["persists"] else "no"} if beyond else {"beyond": "", "persists": ""}
        self.compare_row(self.point["parameter"], intervals, growing=self.said.get("growing"), **told, **empty)
