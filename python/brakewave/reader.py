"""Result folders of brakewave as tables of pandas.

docs/files.md of brakewave describes every column, docs/systems.md those of systems of one's own. A notebook shows a folder
with its table and its picture.

    import brakewave
    run = brakewave.Folder("results/mode4_mismatch")
    print(run.events[["type", "mismatch", "speed", "what"]])
    brakewave.draw_branch(run).figure.savefig("branch.png")
"""

from __future__ import annotations

import os
import re
import warnings
from base64 import b64encode
from collections.abc import Iterable
from dataclasses import dataclass
from html import escape
from io import BytesIO
from math import inf, log, pi
from pathlib import Path
from typing import IO, Any, List, Union

import numpy
import pandas

MANIFEST = "brakewave.manifest"
"""The file that makes a folder one of results."""
PARAMETERS = ["mismatch", "friction", "mass_damping", "stiffness_damping", "gamma", "nu", "xi", "smoothing"]
REGIMES = ["separation", "slip", "stick", "reverse"]
"""Regimes in the order of their codes in regimes.npy."""

_TEXT = (
    "type regimes regimes_before regimes_after regime switches stable why what start name method setting failure "
    "direction sliding full_direction lead_direction first lead_first proven parameter sweep mark"
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
    (["point", "label", "type", "regimes"], ["stable", "unstable", "re", "im", "newton", "residual", "leg"]),
    (["label", "type"], ["re", "im", "omega", "lyapunov", "regimes_before", "regimes_after", "uncertainty", "what"]),
    (["point", "type"], "period"),
    (["point", "type"], "regimes_before"),
    (["time", "phase"], ["mode"]),
    (["sample", "time"], ["mode"]),
    (["time", "from", "to"], []),
    (["value", "sweep", "sample"], ["phase", "mode", "why"]),
    (["mode", "equilibrium"], ["stable", "re", "im", "why"]),
]
EXPONENT = re.compile(r"lyapunov(_\d+)?(_error)?")
_SYSTEM_TEXT = ["mode", "found", "equilibrium", "sweep", "from", "to"]
"""Columns that are text in tables of a system, besides those of every table."""
_OF_STEADY = ["re", "im"]
"""Columns that are lists of numbers in the table of the equilibria of all modes."""
_OF_EQUILIBRIA = ["lyapunov", "newton", "residual", "what"]
"""How the header of a curve of events of equilibria ends."""


def own_columns(names: list[str]) -> range | None:
    """The places of the columns that a system has named itself in a header: its parameters or its states, of a branch of
    equilibria both, and monitors. None in a table of a tube. `period` is no name of a parameter."""
    if names[-1:] == ["why"]:
        # exponents of a scan stand between its mode and why
        end = len(names) - 1
        while EXPONENT.fullmatch(names[end - 1]):
            end -= 1
        names = names[:end] + ["why"]
    for before, after in _SYSTEMS:
        if names[: len(before)] != before:
            continue
        if after == "regimes_before" and names[-len(_OF_EQUILIBRIA) :] != _OF_EQUILIBRIA:
            continue
        if isinstance(after, str):
            if after in names:
                return range(len(before), names.index(after))
        elif len(names) > len(before) + len(after) and names[len(names) - len(after) :] == after:
            return range(len(before), len(names) - len(after))
    return None


_MORE = [
    # what follows upon a system's own columns, and what comes next
    (["period", "switches"], "stable"),
    (["period"], "multiplier_re"),
    (["regimes_before", "regimes_after", "omega"], "lyapunov"),
]


def _more_columns(names: list[str], own: range) -> range:
    """The places of other columns that a problem has named, all of them numbers: monitors, after the extrema of the states in
    branch.csv and after the period in events.csv, and the states along a curve of equilibria."""
    names = names[own.stop :]
    for before, after in _MORE:
        if names[: len(before)] == before and after in names:
            return range(own.stop + len(before), own.stop + names.index(after))
    return range(0)


def columns(table: pandas.DataFrame) -> list[str]:
    """The names of the columns of a table."""
    return [str(name) for name in table]


def read(source: Union[str, "os.PathLike[str]", IO[str]], rows: int | None = None) -> pandas.DataFrame:
    """A table that brakewave has written, from a file or from an open stream: its first `rows`, or all of them.

    Numbers are those of the file to the last bit. An empty text is "", an empty number NaN or NA. Columns of a system's
    parameters, states and monitors are numbers, whatever their names are.
    """
    # read as text: whether read_csv rounds correctly depends on the version of pandas
    table = pandas.read_csv(source, dtype=str, keep_default_na=False, nrows=rows)
    names = columns(table)
    own = own_columns(names)
    more = range(0) if own is None else _more_columns(names, own)
    text = _TEXT if own is None else _TEXT + _SYSTEM_TEXT
    if names[:2] == ["mode", "equilibrium"]:
        text = text + _OF_STEADY
    typed = {}
    for place, name in enumerate(table):
        cells = table[name]
        if own is not None and (place in own or place in more):
            typed[name] = _numbers(cells)
            continue
        typed[name] = cells if name in text else _column(cells)
        if name in _WHOLE and typed[name].dtype == float:
            typed[name] = typed[name].astype("Int64")
    return pandas.DataFrame(typed, table.index)


def _numbers(cells: pandas.Series) -> pandas.Series:
    return pandas.Series([float(cell or "nan") for cell in cells], cells.index, float)


def _column(cells: pandas.Series) -> pandas.Series:
    try:
        return _numbers(cells)
    except ValueError:
        return cells


_IMAGES = {"svg": "svg+xml", "png": "png"}
"""Formats of pictures that a notebook shows, and their names in a web page."""

_TABLES = {"simulation": "series", "certificate": "certificates"}
"""The main table by the kind of folder, where it does not have the name of the kind."""

_MOST_SAVED = 1_000_000
"""Characters of a file of saved results in which its problem is looked for."""

_SHOWN = 20
"""Most rows of a table that a notebook shows of a folder."""


def shown(table: pandas.DataFrame) -> str:
    """A table as a notebook shows it, its middle left out where it is long."""
    return str(table.to_html(max_rows=_SHOWN, index=False, border=0, na_rep=""))


def _image(content: bytes, format: str) -> str:
    """A picture within a page. As an image of its own it shares no names with other pictures of the page."""
    return f'<img src="data:image/{_IMAGES[format]};base64,{b64encode(content).decode()}"/>'


class Pictures(List[Path]):
    """Paths of pictures, which a notebook shows."""

    def _repr_html_(self) -> str:
        pictures = (path for path in self if path.suffix[1:] in _IMAGES and path.is_file())
        return "".join(_image(path.read_bytes(), path.suffix[1:]) for path in pictures)


class _Table:
    """A table of a folder by the name of the attribute."""

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def __get__(self, folder: Folder, owner: type) -> pandas.DataFrame:
        return folder.table(self.name) if folder is not None else self


class Folder:
    """A result folder of `run`, `certify`, `map`, `curve`, `scan`, `simulate`, `steady` or `accuracy`.

    Nothing is kept: every access reads the file, so that a computation that is still going on can be looked at.
    """

    def __init__(self, path: str | os.PathLike[str], said: str = "") -> None:
        self.path = Path(path)
        manifest = self.path / MANIFEST
        if not manifest.is_file():
            raise FileNotFoundError(f"{self.path} is no result folder of brakewave: it has no {manifest.name}")
        self.version, kind = manifest.read_text(encoding="utf-8").splitlines()[:2]
        self.kind = kind.split()[0]
        """What the folder holds: run, certificate, map, curve, scan, simulation, steady, accuracy."""
        self.said = said
        """What the program printed when it was called from here."""

    def __fspath__(self) -> str:
        return str(self.path)

    def __repr__(self) -> str:
        rows = ((path.stem, path.read_bytes().count(b"\n") - 1) for path in sorted(self.path.glob("*.csv")))
        tables = ", ".join(f"{name} ({max(count, 0)} rows)" for name, count in rows)
        return f"Folder({str(self.path)!r}) of a {self.kind}: {tables or 'no tables'}"

    def _repr_html_(self) -> str:
        """The main table and the main picture."""
        table = self._main_table()
        picture = Pictures(self.pictures[:1])._repr_html_() or self._drawn()
        return f"<p>{escape(repr(self))}</p>" + ("" if table is None else shown(table)) + picture

    def _main_table(self) -> pandas.DataFrame | None:
        """Of a run its events, without the parameters that do not change; of all else the first rows of the table named after
        the kind, which may be long. None where it is not there yet, or not whole."""
        try:
            if self.kind == "run":
                events = self.events
                return events.drop(columns=set(parameters(events)) - set(varying(self.branch)))
            name = _TABLES.get(self.kind, self.kind.split("-")[0])
            return read(self.path / f"{name}.csv", _SHOWN)
        except (OSError, ValueError):
            return None

    def _drawn(self) -> str:
        """A picture drawn by matplotlib, if it is installed, for a folder in which the program has drawn none."""
        try:
            from matplotlib.figure import Figure
        except ImportError:
            return ""
        from . import pictures

        draw: dict[str, Any] = {"run": pictures.draw_branch, "scan": pictures.draw_scan, "map": pictures.draw_map, "curve": pictures.draw_curve}
        if self.kind not in draw:
            return ""
        # a figure of pyplot would be shown a second time
        figure, file = Figure(layout="constrained"), BytesIO()
        try:
            draw[self.kind](self, axes=figure.subplots())
        except (OSError, ValueError, IndexError):
            return ""
        figure.savefig(file, format="svg", metadata={"Date": None})
        return _image(file.getvalue(), "svg")

    @property
    def pictures(self) -> Pictures:
        """The pictures in the folder that a notebook can show, the main one first."""
        files = sorted(path for path in self.path.iterdir() if path.suffix[1:] in _IMAGES)
        return Pictures(sorted(files, key=lambda path: path.stem not in ("diagram", self.kind)))

    def table(self, name: str) -> pandas.DataFrame:
        """The table `name`.csv."""
        path = self.path / f"{name}.csv"
        if not path.is_file():
            raise FileNotFoundError(f"{self.path}, the folder of a {self.kind}, has no {path.name}")
        table = read(path)
        table.attrs["states"] = self.states
        return table

    @property
    def states(self) -> list[str]:
        """Names of the states of a system; none of a tube, nor of a certificate."""
        return re.findall(r'"(\w+)"', self._saved(r",system:\(states:\[(.*?)\]"))

    @property
    def parameter(self) -> str | None:
        """The parameter along the branch of a run, by its column."""
        name = self._saved(r'continuation:Some\(\(parameter:"?(\w+)"?')
        # of a tube it is written as in a problem file
        return name if self.states or not name else re.sub(r"(?<!^)(?=[A-Z])", "_", name).lower()

    def _saved(self, pattern: str) -> str:
        """What stands in the problem as the program keeps it with its results, before them."""
        for name in ("branch.ron", "problem.ron", "map.ron", "scan.ron"):
            path = self.path / name
            if path.is_file():
                with open(path, encoding="utf-8") as file:
                    found = re.search(pattern, file.readline(_MOST_SAVED))
                return found[1] if found else ""
        return ""

    # of a run
    branch = _Table()
    events = _Table()
    spectrum = _Table()
    multipliers = _Table()
    eigenvalues = _Table()
    # of a map, a curve, a comparison of methods, of proofs
    map = _Table()
    attractors = _Table()
    shares = _Table()
    curve = _Table()
    accuracy = _Table()
    certificates = _Table()
    # of a scan, of what rests
    scan = _Table()
    steady = _Table()
    # of a simulation; switches and section of that of a system
    switches = _Table()
    section = _Table()
    series = _Table()
    measures = _Table()
    growth = _Table()
    start = _Table()
    end = _Table()

    def profile(self, label: int) -> pandas.DataFrame:
        """The wave of a labelled point: theta, U, V, U_dot, V_dot, P, Q, regime."""
        return self.table(f"profiles/{label}")

    @property
    def profiles(self) -> list[int]:
        """Labels of which there are profiles."""
        return sorted(int(path.stem) for path in self.path.glob("profiles/*.csv"))

    @property
    def zones(self) -> pandas.DataFrame:
        """The zones of every wave of a branch or a map, a row each: `regime`, `begin` and `end` in θ, and the
        index of the wave's row in its table as `wave`."""
        table = self.map if self.kind == "map" else self.branch
        return zones(table)

    @property
    def regimes(self) -> pandas.DataFrame:
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

    def snapshot(self, number: int) -> pandas.DataFrame:
        """A snapshot of a ring, from 1: phi, U, V, U_dot, V_dot, P, Q. Those of a tube are for ParaView."""
        array = numpy.load(self.path / "snapshots" / f"{number:04}.npy")
        return pandas.DataFrame(array, columns=["phi", "U", "V", "U_dot", "V_dot", "P", "Q"])


def zones(table: pandas.DataFrame) -> pandas.DataFrame:
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

    def __post_init__(self) -> None:
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
    def gamma(self) -> float:
        return self.density * (self.inner * self.rotation) ** 2 / self.young

    @property
    def xi(self) -> float:
        return self.outer / self.inner

    @property
    def mismatch(self) -> float:
        return self.oversize / self.inner

    def model(self, friction: float) -> str:
        """The section `model` of a problem file."""
        geometry = f"nu: {self.poisson:.15g}, xi: {self.xi:.15g}, gamma: {self.gamma:.15g}"
        return (
            f"model: (coefficients: Geometry({geometry}), "
            f"friction: {friction:.15g}, mismatch: {self.mismatch:.15g}),"
        )

    def hertz(self, speed: Any, mode: int) -> Any:
        """Frequency that a point at rest hears from a wave of `mode` crests and the speed c of the tables, Hz."""
        return mode * abs(speed) * self.rotation / (2 * pi)

    def pascal(self, pressure: Any) -> Any:
        """Contact pressure or shear stress of P or Q of the tables, Pa."""
        return self.young * self.gamma * inertia(self.xi) * pressure


def inertia(xi: float) -> float:
    """I₀ = ∫X²r dr over the wall, X(r) = (ξ²/r − r)/(ξ² − 1)."""
    w = (xi - 1) * (xi + 1)
    if w < 0.5:
        # its Taylor series, for the closed form cancels like w³; the fortieth term is below 1e-17
        return sum((-1.0) ** (n + 1) * w ** (n - 2) / (n * (n - 1) * (n - 2)) for n in range(3, 43))
    return ((w + 1) ** 2 * log(xi) - (w + 1) * w + w * (w + 2) / 4) / w**2


def parameters(table: pandas.DataFrame) -> list[str]:
    """The columns of a table that are parameters. Of a system they stand before the period; of equilibria they stand before the
    states, which are not told apart in a table that was read without its folder."""
    names = columns(table)
    own = own_columns(names)
    if own is not None and not ({"mode", "equilibrium", "sample", "attractor"} & set(names[: own.start])):
        states = table.attrs.get("states", [])
        count = names.index(states[0], own.start, own.stop) if states and states[0] in names[own.start : own.stop] else own.stop
        return names[own.start : count]
    return [name for name in PARAMETERS if name in names]


def varying(table: pandas.DataFrame) -> list[str]:
    """The parameters that are not the same in all rows of a table."""
    return [name for name in parameters(table) if table[name].nunique() > 1]
