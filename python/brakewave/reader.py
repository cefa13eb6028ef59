"""Result folders of brakewave as tables of pandas, and pictures of them.

It needs pandas, and matplotlib for the pictures. docs/files.md of brakewave describes every column, docs/systems.md
those of systems of one's own.

    import brakewave
    run = brakewave.Folder("results/mode4_mismatch")
    print(run.events[["type", "mismatch", "speed", "what"]])
    brakewave.draw_branch(run).figure.savefig("branch.png")
"""

import re
import warnings
from dataclasses import dataclass
from itertools import cycle
from math import inf, log, pi
from pathlib import Path

import numpy
import pandas

PARAMETERS = ["mismatch", "friction", "mass_damping", "stiffness_damping", "gamma", "nu", "xi", "smoothing"]
REGIMES = ["separation", "slip", "stick", "reverse"]
"""Regimes in the order of their codes in regimes.npy."""
COLOURS = dict(zip(REGIMES + ["contact"], ["#ccece3", "#e6f4fc", "#b3b3b3", "#efc29e", "#f0d7e5"]))
"""Colours of the zones of regimes, as in the pictures of the program itself."""
SEQUENCES = {
    "slip-stick": "#0072b2",
    "slip-reverse-stick": "#d55e00",
    "slip-separation-slip-reverse-stick": "#009e73",
    "slip-separation-reverse-stick": "#cc79a7",
    "slip-separation-slip-stick": "#e69f00",
    "slip-separation-stick": "#56b4e9",
}
"""Colours of the commonest sequences of regimes, as in the pictures of the program itself."""
RARE = ["#332288", "#882255", "#999933", "#117733", "#cc6677", "#8c564b", "#465a6e"]
"""Colours of other sequences, in the order of their appearance."""

_TEXT = (
    "type regimes regimes_before regimes_after regime switches stable why what start name method setting failure "
    "direction sliding full_direction lead_direction first lead_first proven parameter sweep from to mark"
).split()
_WHOLE = (
    "point label leg unstable lead_sector sector newton row column passage mode points events_found "
    "events_expected periods radial_order lead_family lead_hopf_family inequalities sample attractor"
).split()


_SYSTEMS = [
    # tables of a system: the columns before its own names, and those after them, or the first of these
    (["point", "label", "type", "regimes"], "period"),
    (["label", "type"], "period"),
    (["row", "column", "start", "passage", "found", "periods", "regimes"], "period"),
    (["row", "column", "start", "passage", "found", "attractor", "periods", "regimes"], "period"),
    (["attractor", "regimes", "period", "periods", "stable", "share"], []),
    (["value", "found", "attractor", "regimes", "period", "periods", "stable", "share"], []),
    (["point", "type"], "period"),
    (["time", "phase"], ["mode"]),
    (["sample", "time"], ["mode"]),
    (["time", "from", "to"], []),
    (["value", "sweep", "sample"], ["phase", "mode", "why"]),
    (["mode", "equilibrium"], ["stable", "re", "im", "why"]),
]
_EXPONENT = re.compile(r"lyapunov(_\d+)?(_error)?")
_SYSTEM_TEXT = ["mode", "found", "equilibrium", "sweep", "re", "im"]
"""Columns that are text in tables of a system, besides those of every table."""


def _own(names):
    """The places of the columns that a system has named itself, its parameters or its states, in a header; None in
    a table of a tube. `period` is no name of a parameter."""
    if names[-1:] == ["why"]:
        # exponents of a scan stand between its mode and why
        end = len(names) - 1
        while _EXPONENT.fullmatch(names[end - 1]):
            end -= 1
        names = names[:end] + ["why"]
    for before, after in _SYSTEMS:
        if names[: len(before)] != before:
            continue
        if after == "period":
            if after in names:
                return range(len(before), names.index(after))
        elif len(names) > len(before) + len(after) and names[len(names) - len(after) :] == after:
            return range(len(before), len(names) - len(after))
    return None


def _monitors(names, own):
    """The places of the columns of monitors, whose names are a problem's own, among others that are numbers: after the
    extrema of the states in branch.csv, after the period in events.csv."""
    names = names[own.stop :]
    for before, after in [(["period", "switches"], "stable"), (["period"], "multiplier_re")]:
        if names[: len(before)] == before and after in names:
            return range(own.stop + len(before), own.stop + names.index(after))
    return range(0)


def read(source):
    """A table that brakewave has written, from a file or from an open stream.

    Numbers are those of the file to the last bit. An empty text is "", an empty number NaN or NA. Columns of a system's
    parameters, states and monitors are numbers, whatever their names are.
    """
    # read as text: whether read_csv rounds correctly depends on the version of pandas
    table = pandas.read_csv(source, dtype=str, keep_default_na=False)
    own = _own(list(table))
    monitors = range(0) if own is None else _monitors(list(table), own)
    text = _TEXT if own is None else _TEXT + _SYSTEM_TEXT
    typed = {}
    for place, name in enumerate(table):
        cells = table[name]
        if own is not None and (place in own or place in monitors):
            typed[name] = _numbers(cells)
            continue
        typed[name] = cells if name in text else _column(cells)
        if name in _WHOLE and typed[name].dtype == float:
            typed[name] = typed[name].astype("Int64")
    return pandas.DataFrame(typed, table.index)


def _numbers(cells):
    return pandas.Series([float(cell or "nan") for cell in cells], cells.index, float)


def _column(cells):
    try:
        return _numbers(cells)
    except ValueError:
        return cells


class Folder:
    """A result folder of `run`, `map`, `curve`, `scan`, `simulate`, `steady` or `accuracy`.

    Nothing is kept: every access reads the file, so that a computation that is still going on can be looked at.
    """

    def __init__(self, path):
        self.path = Path(path)
        manifest = self.path / "brakewave.manifest"
        if not manifest.is_file():
            raise FileNotFoundError(f"{self.path} is no result folder of brakewave: it has no {manifest.name}")
        self.version, kind = manifest.read_text(encoding="utf-8").splitlines()[:2]
        self.kind = kind.split()[0]
        """What the folder holds: run, map, curve, scan, simulation, steady, accuracy."""
        self.said = ""
        """What the program printed when it was called from here."""

    def table(self, name):
        """The table `name`.csv."""
        path = self.path / f"{name}.csv"
        if not path.is_file():
            raise FileNotFoundError(f"{self.path}, the folder of a {self.kind}, has no {path.name}")
        return read(path)

    # of a run
    branch = property(lambda self: self.table("branch"))
    events = property(lambda self: self.table("events"))
    spectrum = property(lambda self: self.table("spectrum"))
    multipliers = property(lambda self: self.table("multipliers"))
    eigenvalues = property(lambda self: self.table("eigenvalues"))
    # of a map, a curve, a comparison of methods, of proofs
    map = property(lambda self: self.table("map"))
    attractors = property(lambda self: self.table("attractors"))
    shares = property(lambda self: self.table("shares"))
    curve = property(lambda self: self.table("curve"))
    accuracy = property(lambda self: self.table("accuracy"))
    certificates = property(lambda self: self.table("certificates"))
    # of a scan, of what rests
    scan = property(lambda self: self.table("scan"))
    steady = property(lambda self: self.table("steady"))
    # of a simulation; switches and section of that of a system
    switches = property(lambda self: self.table("switches"))
    section = property(lambda self: self.table("section"))
    series = property(lambda self: self.table("series"))
    measures = property(lambda self: self.table("measures"))
    growth = property(lambda self: self.table("growth"))
    start = property(lambda self: self.table("start"))
    end = property(lambda self: self.table("end"))

    def profile(self, label):
        """The wave of a labelled point: theta, U, V, U_dot, V_dot, P, Q, regime."""
        return self.table(f"profiles/{label}")

    @property
    def profiles(self):
        """Labels of which there are profiles."""
        return sorted(int(path.stem) for path in self.path.glob("profiles/*.csv"))

    @property
    def zones(self):
        """The zones of every wave of a branch or a map, a row each: `regime`, `begin` and `end` in θ, and the
        index of the wave's row in its table as `wave`."""
        table = self.map if self.kind == "map" else self.branch
        return zones(table)

    @property
    def regimes(self):
        """Regime of each place (columns, φ) at each sample (rows, time) of a simulation, as codes of `REGIMES`."""
        codes = numpy.load(self.path / "regimes.npy")
        place, time = self.start["phi"].to_numpy(), self.series["time"].to_numpy()
        # every so many points one is kept, at most 512 of them
        place = place[:: max(1, -(-len(place) // 512))]
        # a simulation that is going on may have come further in one file than in the other
        count = min(len(time), len(codes))
        return pandas.DataFrame(
            codes[:count], pandas.Index(time[:count], name="time"), pandas.Index(place, name="phi")
        )

    def snapshot(self, number):
        """A snapshot of a ring, from 1: phi, U, V, U_dot, V_dot, P, Q. Those of a tube are for ParaView."""
        array = numpy.load(self.path / "snapshots" / f"{number:04}.npy")
        return pandas.DataFrame(array, columns=["phi", "U", "V", "U_dot", "V_dot", "P", "Q"])


def zones(table):
    """The zones of the waves of a table with the columns `regimes` and `switches`; see `Folder.zones`."""
    rows = []
    for wave, regimes, switches in zip(table.index, table["regimes"], table["switches"]):
        ends = [float(end) for end in switches.split()]
        for regime, begin, end in zip(regimes.split("-"), [0.0] + ends, ends):
            rows.append((wave, regime, begin, end))
    return pandas.DataFrame(rows, columns=["wave", "regime", "begin", "end"])


@dataclass
class Tube:
    """A tube on a shaft in SI units, and the dimensionless numbers of a problem file. docs/waves.md derives them."""

    young: float
    """Young's modulus E, Pa."""
    density: float
    """Density ρ, kg/m³."""
    poisson: float
    """Poisson's ratio ν."""
    inner: float
    """Inner radius R of the tube when it is not on the shaft, m."""
    outer: float
    """Outer radius R*, held, m."""
    oversize: float
    """Radius of the shaft less R, d, m."""
    rotation: float
    """Angular velocity Ω of the shaft, rad/s."""

    def __post_init__(self):
        positive = ["young", "density", "inner", "oversize", "rotation"]
        for name in positive:
            if not 0 < getattr(self, name) < inf:
                raise ValueError(f"`{name}` must be greater than 0 and finite, found {getattr(self, name)}")
        if not -1 < self.poisson < 0.5:
            raise ValueError(f"`poisson` must lie between -1 and 0.5, both excluded, found {self.poisson}")
        if not self.inner < self.outer < inf:
            raise ValueError(f"`outer` must be greater than `inner`, {self.inner}, found {self.outer}")
        bore = self.inner * self.rotation
        for odd, words in [
            (self.mismatch >= 0.2 - 1e-12, f"the shaft is {self.mismatch:.0%} thicker than the bore of the tube"),
            (self.gamma > 1, f"gamma = {self.gamma:.3g}: the surface of the shaft outruns sound"),
            (bore >= 50, f"the surface of the shaft runs at {bore:.0f} m/s; `rotation` is in rad/s, not rpm"),
        ]:
            if odd:
                warnings.warn(words, stacklevel=3)

    @property
    def gamma(self):
        return self.density * (self.inner * self.rotation) ** 2 / self.young

    @property
    def xi(self):
        return self.outer / self.inner

    @property
    def mismatch(self):
        return self.oversize / self.inner

    def model(self, friction):
        """The section `model` of a problem file."""
        geometry = f"nu: {self.poisson:.15g}, xi: {self.xi:.15g}, gamma: {self.gamma:.15g}"
        return (
            f"model: (coefficients: Geometry({geometry}), "
            f"friction: {friction:.15g}, mismatch: {self.mismatch:.15g}),"
        )

    def hertz(self, speed, mode):
        """Frequency that a point at rest hears from a wave of `mode` crests and the speed c of the tables, Hz."""
        return mode * abs(speed) * self.rotation / (2 * pi)

    def pascal(self, pressure):
        """Contact pressure or shear stress of P or Q of the tables, Pa."""
        return self.young * self.gamma * inertia(self.xi) * pressure


def inertia(xi):
    """I₀ = ∫X²r dr over the wall, X(r) = (ξ²/r − r)/(ξ² − 1)."""
    w = (xi - 1) * (xi + 1)
    if w < 0.5:
        # its Taylor series, for the closed form cancels like w³; the fortieth term is below 1e-17
        return sum((-1) ** (n + 1) * w ** (n - 2) / (n * (n - 1) * (n - 2)) for n in range(3, 43))
    return ((w + 1) ** 2 * log(xi) - (w + 1) * w + w * (w + 2) / 4) / w**2


def parameters(table):
    """The columns of a table that are parameters: of a system those before the period, as the file has them."""
    names = list(table)
    own = _own(names)
    if own is not None and "period" in names[own.stop :]:
        return [names[place] for place in own]
    return [name for name in PARAMETERS if name in names]


def varying(table):
    """The parameters that are not the same in all rows of a table."""
    return [name for name in parameters(table) if table[name].nunique() > 1]


def _axes(axes):
    if axes is None:
        import matplotlib.pyplot

        axes = matplotlib.pyplot.subplots(layout="constrained")[1]
    return axes


MARKS = {"LP": "s", "PD": "D", "NS": "*", "SL": "P", "HB": "|", "BP": "v", "GR": "^", "RV": "D", "CO": "o", "ST": "s", "UZ": ".", "EP": "o", "MX": "x"}
"""Marks of special points, as in the pictures of the program itself; those of LP, BP and EP are hollow."""


def draw_branch(run, x=None, y=None, axes=None):
    """A branch diagram: solid where stable, dashed where unstable, dotted where undecided or not asked for, and
    a marker for every event. `x` is the parameter of the run unless given, `y` the speed of waves, or the greatest
    value of the first state of orbits."""
    axes, table = _axes(axes), run.branch
    x = x or (varying(table) or parameters(table))[0]
    if y is None:
        # after the times of switches come the least and the greatest value of every state
        names = list(table)
        y = "speed" if _own(names) is None else names[names.index("switches") + 2]
    style = {"yes": "-", "no": "--"}
    # a piece ends where the leg or the answer changes; it goes on to the next point of its leg
    same = (table["leg"] == table["leg"].shift()) & (table["stable"] == table["stable"].shift())
    for _, piece in table.groupby((~same).cumsum()):
        first, last = piece.index[0], piece.index[-1]
        if last + 1 in table.index and table["leg"][last + 1] == table["leg"][last]:
            last += 1
        piece = table.loc[first:last]
        axes.plot(piece[x], piece[y], style.get(piece["stable"].iloc[0], ":"), color="black", lw=1)
    # where a branch is left both ways it does not end
    legs = table["leg"] != table["leg"].shift()
    marked = table[(table["type"] != "") & ~(legs & (legs.sum() > 1) & (table["type"] == "EP"))]
    for kind, points in marked.groupby("type"):
        face = "white" if kind in ("LP", "BP", "EP") else "black"
        axes.plot(points[x], points[y], MARKS[kind], color="black", mfc=face, ms=5, label=kind)
    axes.set(xlabel=x, ylabel=y)
    axes.legend()
    return axes


def draw_scan(folder, y=None, axes=None):
    """What motions settle on, a dot for every sample: `y` is the first state unless given."""
    axes, table = _axes(axes), folder.scan
    table = table[table["sample"].notna()]
    y = y or list(table)[3]
    for (sweep, samples), colour in zip(table.groupby("sweep", sort=False), ["#0072b2", "#d55e00"]):
        axes.plot(samples["value"], samples[y], ".", ms=2.5, mew=0, color=colour, label=sweep)
    axes.set(xlabel="parameter", ylabel=y)
    if len(table):
        axes.legend(markerscale=3)
    return axes


def draw_exponents(folder, axes=None):
    """The Lyapunov exponents of a scan, a line for each sweep, with the line 0; those that are −∞ are left out."""
    axes, table = _axes(axes), folder.scan
    names = [name for name in table if _EXPONENT.fullmatch(name) and not name.endswith("_error")]
    axes.axhline(0, color="grey", lw=0.6)
    for sweep, samples in table.drop_duplicates(["value", "sweep"]).groupby("sweep", sort=False):
        samples = samples.sort_values("value")
        for place, name in enumerate(names):
            finite = samples[numpy.isfinite(samples[name])]
            axes.plot(finite["value"], finite[name], color="black" if place == 0 else "grey", lw=0.8, label=f"{name}, {sweep}")
    axes.set(xlabel="parameter", ylabel="Lyapunov exponents")
    if axes.get_legend_handles_labels()[0]:
        axes.legend()
    return axes


def draw_profile(run, label, y="P", axes=None):
    """A column of the wave of a label over θ, its zones behind it."""
    axes, wave = _axes(axes), run.profile(label)
    for _, zone in wave.groupby((wave["regime"] != wave["regime"].shift()).cumsum()):
        regime, theta = zone["regime"].iloc[0], zone["theta"]
        axes.axvspan(theta.iloc[0], theta.iloc[-1], color=COLOURS[regime], lw=0, label=regime)
    axes.plot(wave["theta"], wave[y], color="black")
    axes.set(xlabel="θ", ylabel=y)
    handles = dict(zip(*reversed(axes.get_legend_handles_labels())))
    axes.legend(handles.values(), handles.keys())
    return axes


def draw_spectrum(run, label, axes=None):
    """The eigenvalues of a label in the complex plane, a colour for each Bloch sector."""
    axes, table = _axes(axes), run.spectrum
    for sector, values in table[table["label"] == label].groupby("sector"):
        axes.plot(values["re"], values["im"], "o", ms=4, label=f"sector {sector}")
    axes.axvline(0, color="black", lw=0.5)
    axes.set(xlabel="Re λ", ylabel="Im λ")
    axes.legend()
    return axes


def draw_map(folder, start=None, axes=None):
    """What is first found from a start over the plane of a map: the regimes of waves, from "fast" unless another start is
    named; of a system the modes of the orbit from start 1, with its number of periods, or what the motion does instead."""
    axes, table = _axes(axes), folder.map
    if "attractor" in table:
        return _draw_basin(table[table["start"].astype(str) == str(start or 1)], axes)
    x, y = (varying(table) + parameters(table))[:2]
    if "periods" in table:
        table = table[table["start"].astype(str) == str(start or 1)]
        many = table["periods"].fillna(1) > 1
        times = table["periods"].astype(str).where(many, "") + many.map({True: "T: ", False: ""})
        what = (times + table["regimes"]).where(table["found"].isin(["orbit", "equilibrium"]), table["found"])
    else:
        table = table[(table["start"] == (start or "fast")) & (table["passage"] == 1)]
        what = table["regimes"]
    rare = cycle(RARE)
    for regimes, waves in table.groupby(what):
        axes.plot(waves[x], waves[y], "s", ms=2, label=regimes, color=SEQUENCES.get(regimes) or next(rare))
    axes.set(xlabel=x, ylabel=y)
    axes.legend(loc="upper left", bbox_to_anchor=(1, 1))
    return axes


def _draw_basin(table, axes):
    """The number of the attractor over rows, upwards, and columns."""
    rare = cycle(RARE)
    what = table["attractor"].astype(str).where(table["attractor"].notna(), table["found"])
    for name, cells in table.groupby(what):
        axes.plot(cells["column"], cells["row"], "s", ms=2, label=name, color=next(rare))
    axes.set(xlabel="column", ylabel="row")
    axes.legend(loc="upper left", bbox_to_anchor=(1, 1))
    return axes


def draw_curve(folder, axes=None):
    """The curve of an event in the plane of its two parameters, special points named."""
    axes, table = _axes(axes), folder.curve
    first, second = parameters(table)
    axes.plot(table[first], table[second], color="black")
    for kind, points in table[table["type"] != ""].groupby("type"):
        axes.plot(points[first], points[second], "o", label=kind)
    axes.set(xlabel=first, ylabel=second)
    axes.legend()
    return axes


def draw_regimes(simulation, axes=None):
    """Regimes over place and time."""
    from matplotlib.colors import ListedColormap

    axes, table = _axes(axes), simulation.regimes
    colours = ListedColormap([COLOURS[regime] for regime in REGIMES])
    image = axes.pcolormesh(table.columns, table.index, table, cmap=colours, vmin=-0.5, vmax=3.5, shading="nearest")
    axes.figure.colorbar(image, ticks=range(4)).ax.set_yticklabels(REGIMES)
    axes.set(xlabel="φ", ylabel="time")
    return axes
