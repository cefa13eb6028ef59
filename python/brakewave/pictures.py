"""Pictures of what is in result folders, with matplotlib.

Marks and colours are those of the pictures that the program draws itself.
"""

from __future__ import annotations

from itertools import cycle
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy
import pandas

from .reader import EXPONENT, REGIMES, Folder, columns, own_columns, parameters, varying

if TYPE_CHECKING:
    from matplotlib.axes import Axes

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


def _axes(axes: Axes | None) -> Axes:
    if axes is None:
        import matplotlib.pyplot

        axes = matplotlib.pyplot.subplots(layout="constrained")[1]
    return axes


class _Mark(NamedTuple):
    marker: str
    face: str = "black"
    size: float = 5.5


MARKS = {
    "EP": _Mark("o", "white", 4.5),
    "UZ": _Mark("o", "#828282", 4.0),
    "HB": _Mark("|", size=9.0),
    "LP": _Mark("s", "white"),
    "PD": _Mark("D", "white"),
    "NS": _Mark("+", size=8.0),
    "BP": _Mark("v", "white"),
    "GR": _Mark("^"),
    "RV": _Mark("D"),
    "CO": _Mark("o"),
    "ST": _Mark("s"),
    "SL": _Mark("*", size=8.0),
    "BE": _Mark("^"),
    "HC": _Mark("s"),
    "MX": _Mark("x", size=7.0),
}
"""Marks of special points, in the order in which they are drawn: those that must not hide others come first."""

_STYLES = {"yes": "-", "no": "--"}
"""Lines by stability; dotted where it is undecided or was not asked for."""

_OF_REGIMES = ("GR", "RV", "CO", "ST", "SL", "BE")
"""Events at which the sequence of regimes changes."""


def draw_branch(run: Folder, x: str | None = None, y: str | None = None, axes: Axes | None = None) -> Axes:
    """A branch diagram: solid where stable, dashed where unstable, dotted where undecided or not asked for, and
    a marker for every event. `x` is the parameter of the run unless given, `y` the speed of waves, the greatest
    value of the first state of orbits, or the first state of equilibria; if that stays the same along the branch, the first of
    the states that does not."""
    axes, table = _axes(axes), run.branch
    x = x or run.parameter or (varying(table) or parameters(table))[0]
    y = y or _ordinate(table, run.states)
    for style, rows in _lines(table):
        if len(rows) > 1:
            axes.plot(table[x].iloc[rows], table[y].iloc[rows], style, color="black", lw=1)
        else:
            axes.plot(table[x].iloc[rows], table[y].iloc[rows], ".", color="black")
    marked = _marked(table)
    for kind, mark in MARKS.items():
        points = table.loc[[row for row, one in marked if one == kind]]
        if len(points):
            axes.plot(points[x], points[y], mark.marker, ls="", color="black", mfc=mark.face, ms=mark.size, label=kind)
    axes.set(xlabel=x, ylabel=y)
    if marked:
        axes.legend()
    return axes


_STILL = 1e-9
"""Points differ by less than this share of the largest value where a column stays the same: far above rounding, far below
what a picture shows."""


def _ordinate(table: pandas.DataFrame, states: list[str]) -> str:
    """The column that a branch diagram shows."""
    if not states:
        return "speed"
    own = own_columns(columns(table)) or range(0)
    of_orbits = columns(table)[own.stop] == "period"
    names = [name for state in states for name in ([f"max_{state}", f"min_{state}"] if of_orbits else [state])]
    for name in names:
        values = table[name].to_numpy(float)
        still = abs(numpy.diff(values)) <= _STILL * abs(values).max(initial=0.0)
        if 2 * still.sum() < len(values):
            return name
    return names[0]


def _lines(table: pandas.DataFrame) -> list[tuple[str, list[int]]]:
    """The lines of a branch diagram: the style of each and its rows. A leg of one point is a line of one row."""
    legs, stable, kinds = ([str(cell) for cell in table[name]] for name in ("leg", "stable", "type"))
    lines: list[tuple[str, list[int]]] = []
    for row, leg in enumerate(legs):
        begins = row == 0 or legs[row - 1] != leg
        ends = row + 1 == len(legs) or legs[row + 1] != leg
        if ends:
            if begins:
                lines.append((_STYLES.get(stable[row], ":"), [row]))
            continue
        style = _STYLES.get(_stable_between(stable[row : row + 2], kinds[row : row + 2]), ":")
        if lines and not begins and lines[-1][0] == style:
            lines[-1][1].append(row + 1)
        else:
            lines.append((style, [row, row + 1]))
    return lines


def _stable_between(stable: list[str], kinds: list[str]) -> str:
    """Stability between two points. On the boundary itself, at an event where it may change, the sign is chance."""
    starts, ends = (kind in ("LP", "HB", "BP", *_OF_REGIMES) for kind in kinds)
    return stable[0] if (ends or not stable[0]) and not starts else stable[1]


def _marked(table: pandas.DataFrame) -> list[tuple[Any, str]]:
    """The rows of special points with their types. Where a branch is left both ways it does not end: the first points of its
    legs are not marked as ends."""
    legs = [str(leg) for leg in table["leg"]]
    first = [row for row in range(len(legs)) if row == 0 or legs[row - 1] != legs[row]]
    begun = first if len(first) > 1 else []
    kinds = enumerate(zip(table.index, table["type"]))
    return [(index, kind) for row, (index, kind) in kinds if kind and not (kind == "EP" and row in begun)]


def draw_scan(folder: Folder, y: str | None = None, axes: Axes | None = None) -> Axes:
    """What motions settle on, a dot for every sample: `y` is the first state unless given."""
    axes, table = _axes(axes), folder.scan
    table = table[table["sample"].notna()]
    y = y or columns(table)[3]
    for (sweep, samples), colour in zip(table.groupby("sweep", sort=False), ["#0072b2", "#d55e00"]):
        axes.plot(samples["value"], samples[y], ".", ms=2.5, mew=0, color=colour, label=sweep)
    axes.set(xlabel="parameter", ylabel=y)
    if len(table):
        axes.legend(markerscale=3)
    return axes


def draw_exponents(folder: Folder, axes: Axes | None = None) -> Axes:
    """The Lyapunov exponents of a scan, a line for each sweep, with the line 0; those that are −∞ are left out."""
    axes, table = _axes(axes), folder.scan
    names = [name for name in columns(table) if EXPONENT.fullmatch(name) and not name.endswith("_error")]
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


def draw_profile(run: Folder, label: int, y: str = "P", axes: Axes | None = None) -> Axes:
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


def draw_spectrum(run: Folder, label: int, axes: Axes | None = None) -> Axes:
    """The eigenvalues of a label in the complex plane, a colour for each Bloch sector."""
    axes, table = _axes(axes), run.spectrum
    for sector, values in table[table["label"] == label].groupby("sector"):
        axes.plot(values["re"], values["im"], "o", ms=4, label=f"sector {sector}")
    axes.axvline(0, color="black", lw=0.5)
    axes.set(xlabel="Re λ", ylabel="Im λ")
    axes.legend()
    return axes


def draw_map(folder: Folder, start: str | int | None = None, axes: Axes | None = None) -> Axes:
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


def _draw_basin(table: pandas.DataFrame, axes: Axes) -> Axes:
    """The number of the attractor over rows, upwards, and columns."""
    rare = cycle(RARE)
    what = table["attractor"].astype(str).where(table["attractor"].notna(), table["found"])
    for name, cells in table.groupby(what):
        axes.plot(cells["column"], cells["row"], "s", ms=2, label=name, color=next(rare))
    axes.set(xlabel="column", ylabel="row")
    axes.legend(loc="upper left", bbox_to_anchor=(1, 1))
    return axes


def draw_curve(folder: Folder, axes: Axes | None = None) -> Axes:
    """The curve of an event in the plane of its two parameters, special points named."""
    axes, table = _axes(axes), folder.curve
    first, second = parameters(table)
    axes.plot(table[first], table[second], color="black")
    for kind, points in table[table["type"] != ""].groupby("type"):
        axes.plot(points[first], points[second], "o", label=kind)
    axes.set(xlabel=first, ylabel=second)
    axes.legend()
    return axes


def draw_regimes(simulation: Folder, axes: Axes | None = None) -> Axes:
    """Regimes over place and time."""
    from matplotlib.colors import ListedColormap

    axes, table = _axes(axes), simulation.regimes
    colours = ListedColormap([COLOURS[regime] for regime in REGIMES])
    image = axes.pcolormesh(table.columns, table.index, table, cmap=colours, vmin=-0.5, vmax=3.5, shading="nearest")
    axes.figure.colorbar(image, ticks=range(4)).ax.set_yticklabels(REGIMES)
    axes.set(xlabel="φ", ylabel="time")
    return axes
