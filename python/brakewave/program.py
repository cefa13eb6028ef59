"""The verbs of the program from Python.

A problem is the path of a problem file, or a dict of the same fields (see `brakewave.problem`):

    from brakewave import run, variant
    folder = run(dict(.., continuation=dict(parameter="A", range=(0.05, 1.0), toward=variant.Down)), name="impact")

Settings are the options of the program, which `brakewave VERB --help` explains. `out` is the result folder, without it
`results/` and the name of the problem file, or `name`, with the ending of the verb. Progress is shown on standard error
unless `quiet`.

What is refused raises `Refused` with the message of the program; of a dict it names the key. A computation that ends early
keeps what it found: its folder is returned with a warning, an `Incomplete`.
"""

from __future__ import annotations

import os
import re
import tempfile
import warnings
import xml.etree.ElementTree as xml
from collections.abc import Iterable, Mapping
from io import StringIO
from pathlib import Path
from typing import Any, Callable, Union

import pandas

from . import reader
from .process import Answer, call
from .reader import Folder, Pictures
from .problem import Text

PathLike = Union[str, "os.PathLike[str]"]
Problem = Union[PathLike, Mapping[str, Any]]
"""A problem file, or a dict of the same fields."""
Assignments = Union[str, Iterable[str], Mapping[str, float]]
"""Values of parameters: `{"mismatch": 0.045}`, or `"mismatch=0.045"` as on the command line."""

_ENDINGS = {"run": "", "simulate": "_simulation"}
"""What the name of a result folder ends with; of other verbs it is `_VERB`."""

_UNMET, _NUMERICAL = 1, 3
"""Exit codes: something is not as expected, or not proven; the computation failed, or ended early."""

_EXTRACT = re.compile(r"^ *\d* \| ", re.M)


class Refused(Exception):
    """What the program refuses, or cannot compute, with its message and its exit `code`."""

    def __init__(self, message: str, code: int) -> None:
        super().__init__(message)
        self.code = code


class Incomplete(UserWarning):
    """A computation ended before it was complete; its results so far are kept."""


class _Source:
    """A problem as a file, which of a dict is a temporary one that no message mentions."""

    def __init__(self, problem: Problem, name: str, folder: str) -> None:
        self.text: Text | None = None
        if isinstance(problem, Mapping):
            if Path(name).name != name:
                raise ValueError(f"`name` must be one of a file, without folders; found {name!r}")
            self.text, self.name = Text(problem), name
            self.file = Path(folder, f"{name}.ron")
            self.file.write_text(self.text.text, encoding="utf-8")
        else:
            self.file = Path(problem)
            self.name = str(self.file)

    def plain(self, message: str) -> str:
        """A message with the key of the dict in the place of file, line and column."""
        text = self.text
        if text is None:
            return message
        place = re.compile(re.escape(str(self.file)) + r":(\d+):(\d+): (.*)((?:\n *\d* \| .*)*)")

        def named(found: re.Match[str]) -> str:
            key, words = text.key(int(found[1]), int(found[2])), found[3]
            head = words if not key or _names(words, key) else f"{key}: {words}"
            return head + (_EXTRACT.sub("    ", _without_margin(found[4])) if key else "")

        message = place.sub(named, message)
        return message.replace(f"{self.file}: ", "").replace(str(self.file), self.name)


def _names(words: str, key: str) -> bool:
    """Whether a message names a key itself, in full or as a field of its section. An entry of a list is named by the list."""
    key = re.sub(r"(\[\d+\])+$", "", key)
    before, _, last = key.rpartition(".")
    return f"`{key}`" in words or f"`{last}` in `{before}`" in words or f"`{last}` in the problem" in words


def _without_margin(extract: str) -> str:
    """Lines of a problem file without the blanks that they have in common."""
    lines = extract.split("\n")
    margins = [len(one) - len(one.lstrip()) for one in (_EXTRACT.sub("", line) for line in lines[1:])]
    margin = " " * min(margins, default=0)
    return re.sub(rf"^( *\d* \| ){margin}", r"\1", extract, flags=re.M)


def _options(settings: Mapping[str, Any]) -> list[str]:
    """Settings as options of the command line. A list gives an option once for each of its values."""
    options = []
    for name, value in settings.items():
        option = "--" + name.replace("_", "-")
        for one in value if isinstance(value, (list, tuple)) else [value]:
            if one is True:
                options.append(option)
            elif one is not False and one is not None:
                # a value that begins with a minus sign is no option
                options.append(f"{option}={os.fspath(one) if isinstance(one, os.PathLike) else one}")
    return options


def _assignments(at: Assignments | None) -> list[str] | None:
    if at is None or isinstance(at, str):
        return at if at is None else [at]
    if isinstance(at, Mapping):
        return [f"{name}={float(value)!r}" for name, value in at.items()]
    return list(at)


def _pair(range: tuple[float, float] | None) -> str | None:
    if range is None:
        return None
    low, high = range
    return f"{float(low)!r},{float(high)!r}"


def _raise_or_warn(answer: Answer, *, kept: bool, level: int = 4) -> None:
    """Raises a refusal, and passes warnings on. Exit codes 1 and 3 are no refusal if results are `kept` and there is no error."""
    if answer.code and (answer.error or not kept or answer.code not in (_UNMET, _NUMERICAL)):
        said = answer.error or "\n".join(answer.warnings) or answer.said.strip() or answer.rest.strip()
        raise Refused(said, answer.code)
    _warn(answer, Incomplete if answer.code else UserWarning, level + 1)


def _warn(answer: Answer, category: type[Warning], level: int) -> None:
    for warning in answer.warnings:
        warnings.warn(warning, category, stacklevel=level)


def _compute(verb: str, problem: Problem, name: str, quiet: bool, out: PathLike | None, settings: Mapping[str, Any]) -> Folder:
    """Calls a verb that writes a result folder."""
    with tempfile.TemporaryDirectory() as temporary:
        source = _Source(problem, name, temporary)
        ending = _ENDINGS.get(verb, f"_{verb}")
        stem = source.file.stem
        folder = Path(out or Path("results", stem if stem.endswith(ending) else stem + ending))
        options = _options({"out": folder, **settings})
        answer = call([verb, *options, "--", str(source.file)], quiet, source.plain)
    _raise_or_warn(answer, kept=(folder / reader.MANIFEST).is_file())
    return Folder(folder, answer.said)


def run(
    problem: Problem,
    *,
    out: PathLike | None = None,
    name: str = "problem",
    resume: bool = False,
    force: bool = False,
    quiet: bool = False,
    threads: int | None = None,
) -> Folder:
    """Follows the branch of a problem."""
    return _compute("run", problem, name, quiet, out, dict(resume=resume, force=force, threads=threads))


def certify(
    problem: Problem,
    *,
    out: PathLike | None = None,
    name: str = "problem",
    resume: bool = False,
    force: bool = False,
    quiet: bool = False,
    arcs: bool = False,
    spectrum: bool = False,
) -> Folder:
    """Follows a branch and proves its special points in interval arithmetic. The table `certificates` says which points are not
    proven, and a warning that there are some."""
    settings = dict(resume=resume, force=force, arcs=arcs, spectrum=spectrum)
    folder = _compute("certify", problem, name, quiet, out, settings)
    if not (folder.certificates["proven"] == "yes").all():
        warnings.warn("not all points are proven: see `certificates` of the folder", Incomplete, stacklevel=2)
    return folder


def verify(certificate: Folder | PathLike, *, quiet: bool = False) -> str:
    """Checks a certificate, or the folder of one, without continuation, and returns the verdicts as text. A certificate that
    does not hold is `Refused`."""
    answer = call(["certify", "--verify", "--", os.fspath(certificate)], quiet, str)
    _raise_or_warn(answer, kept=False, level=3)
    return answer.said


def curve(
    problem: Problem,
    *,
    out: PathLike | None = None,
    name: str = "problem",
    resume: bool = False,
    force: bool = False,
    quiet: bool = False,
    format: str | None = None,
) -> Folder:
    """Follows an event of the branch in two parameters."""
    return _compute("curve", problem, name, quiet, out, dict(resume=resume, force=force, format=format))


def map(
    problem: Problem,
    *,
    out: PathLike | None = None,
    name: str = "problem",
    resume: bool = False,
    force: bool = False,
    quiet: bool = False,
    threads: int | None = None,
    shard: str | None = None,
    plot: PathLike | None = None,
) -> Folder:
    """Maps the waves that exist in a plane of two parameters, or the attractors that motions of a system reach there."""
    settings = dict(resume=resume, force=force, threads=threads, shard=shard, plot=plot)
    return _compute("map", problem, name, quiet, out, settings)


def scan(
    problem: Problem,
    *,
    out: PathLike | None = None,
    name: str = "problem",
    resume: bool = False,
    force: bool = False,
    quiet: bool = False,
    threads: int | None = None,
    shard: str | None = None,
    plot: PathLike | None = None,
) -> Folder:
    """Samples the attractors that motions of a system reach, for many values of a parameter."""
    settings = dict(resume=resume, force=force, threads=threads, shard=shard, plot=plot)
    return _compute("scan", problem, name, quiet, out, settings)


def merge(
    shards: Iterable[Folder | PathLike],
    *,
    out: PathLike,
    force: bool = False,
    quiet: bool = False,
    plot: PathLike | None = None,
) -> Folder:
    """Joins the shards of a map or of a scan to one table, the same as that of what is computed at once."""
    paths = [os.fspath(shard) for shard in shards]
    if not paths:
        raise ValueError("there is no shard to join")
    verb = "scan" if Folder(paths[0]).kind.startswith("scan") else "map"
    answer = call([verb, "merge", *_options(dict(out=out, force=force, plot=plot)), "--", *paths], quiet, str)
    _raise_or_warn(answer, kept=False, level=3)
    return Folder(out, answer.said)


def simulate(
    problem: Problem,
    *,
    out: PathLike | None = None,
    name: str = "problem",
    resume: bool = False,
    force: bool = False,
    quiet: bool = False,
    threads: int | None = None,
) -> Folder:
    """Computes a motion in time."""
    return _compute("simulate", problem, name, quiet, out, dict(resume=resume, force=force, threads=threads))


def steady(
    problem: Problem,
    *,
    out: PathLike | None = None,
    name: str = "problem",
    force: bool = False,
    quiet: bool = False,
    at: Assignments | None = None,
    modes: str | int | None = None,
    families: int | None = None,
    order: int | None = None,
    plot: PathLike | None = None,
) -> Folder:
    """Finds the stability of steady sliding, mode by mode, or the equilibria of a system."""
    settings = dict(force=force, at=_assignments(at), modes=modes, families=families, order=order, plot=plot)
    return _compute("steady", problem, name, quiet, out, settings)


def accuracy(
    problem: Problem,
    *,
    out: PathLike | None = None,
    name: str = "problem",
    resume: bool = False,
    force: bool = False,
    quiet: bool = False,
    budget: float | None = None,
    repeats: int | None = None,
    format: str | None = None,
) -> Folder:
    """Measures error against run time of every method."""
    settings = dict(resume=resume, force=force, budget=budget, repeats=repeats, format=format)
    return _compute("accuracy", problem, name, quiet, out, settings)


def spectrum(
    problem: Problem,
    *,
    name: str = "problem",
    quiet: bool = False,
    at: Assignments | None = None,
    sector: int | None = None,
    passage: int | None = None,
    discretised: int | None = None,
    epsilon: float | None = None,
    plot: PathLike | None = None,
    eigenfunctions: PathLike | None = None,
) -> pandas.DataFrame:
    """The wave at one value of the parameter and its eigenvalues, a row for each."""
    settings = dict(at=_assignments(at), sector=sector, passage=passage, discretised=discretised, epsilon=epsilon)
    options = _options({**settings, "plot": plot, "eigenfunctions": eigenfunctions, "csv": True})
    with tempfile.TemporaryDirectory() as temporary:
        source = _Source(problem, name, temporary)
        answer = call(["spectrum", *options, "--", str(source.file)], quiet, source.plain)
    _raise_or_warn(answer, kept=bool(answer.said), level=3)
    return reader.read(StringIO(answer.said))


class Checked:
    """The outcome of `check`. Its `table` has a row for each expectation: `problem`, `expectation`, `verdict` (passed, failed, error
    or skipped) and `what` is wrong."""

    def __init__(self, table: pandas.DataFrame, said: str) -> None:
        self.table = table
        self.said = said
        """What the program printed."""

    @property
    def passed(self) -> bool:
        """Whether all that is expected was found, and something is expected."""
        verdicts = self.table["verdict"]
        return bool(verdicts.isin(["passed", "skipped"]).all() and (verdicts == "passed").any())

    def __bool__(self) -> bool:
        return self.passed

    def __repr__(self) -> str:
        counts = self.table["verdict"].value_counts()
        return "Checked: " + (", ".join(f"{count} {verdict}" for verdict, count in counts.items()) or "nothing")

    def _repr_html_(self) -> str:
        return f"<p>{self!r}</p>" + reader.shown(self.table)


def check(*problems: Problem, quiet: bool = False, junit: PathLike | None = None) -> Checked:
    """Runs problems and compares with their `expect` lists. What cannot be read is `Refused`."""
    with tempfile.TemporaryDirectory() as temporary:
        several = sum(isinstance(one, Mapping) for one in problems) > 1
        names = (f"problem {index}" if several else "problem" for index in range(1, len(problems) + 1))
        sources = [_Source(one, name, temporary) for one, name in zip(problems, names)]

        def plain(message: str) -> str:
            for source in sources:
                message = source.plain(message)
            return message

        report = Path(junit or Path(temporary, "junit.xml"))
        answer = call(["check", f"--junit={report}", "--", *(str(one.file) for one in sources)], quiet, plain)
        if answer.code not in (0, _UNMET, _NUMERICAL):
            raise Refused(answer.error or answer.said.strip(), answer.code)
        _warn(answer, UserWarning, 3)
        suites = xml.parse(report).getroot().iter("testsuite")
        rows = [_row(plain(suite.get("name", "")), case, plain) for suite in suites for case in suite.iter("testcase")]
    return Checked(pandas.DataFrame(rows, columns=["problem", "expectation", "verdict", "what"]), answer.said)


def _row(problem: str, case: xml.Element, plain: Callable[[str], str]) -> tuple[str, str, str, str]:
    """A test case of JUnit as a row: the problem, the name, the verdict and the reason."""
    for tag, verdict in [("failure", "failed"), ("error", "error"), ("skipped", "skipped")]:
        found = case.find(tag)
        if found is not None:
            return problem, case.get("name", ""), verdict, plain(found.get("message", ""))
    return problem, case.get("name", ""), "passed", ""


def report(folder: Folder | PathLike, *, quiet: bool = False) -> Path:
    """Writes one page of HTML with everything of a result folder, and returns its path."""
    answer = call(["report", "--", os.fspath(folder)], quiet, str)
    _raise_or_warn(answer, kept=False, level=3)
    return Path(answer.said.strip())


def plot(
    folder: Folder | PathLike,
    *,
    quiet: bool = False,
    format: str | None = None,
    x: str | None = None,
    y: str | None = None,
    log: str | list[str] | None = None,
    range: tuple[float, float] | None = None,
    range_y: tuple[float, float] | None = None,
    over: Folder | PathLike | None = None,
    force: bool = False,
) -> Pictures:
    """Draws the pictures of a result folder again, or one view of a run, and returns their paths."""
    settings = dict(format=format, x=x, y=y, log=log, range=_pair(range), range_y=_pair(range_y), over=over, force=force)
    answer = call(["plot", *_options(settings), "--", os.fspath(folder)], quiet, str)
    _raise_or_warn(answer, kept=False, level=3)
    return Pictures(Path(line) for line in answer.said.splitlines())
