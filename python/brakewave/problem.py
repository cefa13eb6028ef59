"""Problems as dicts, and the problem file that says the same.

A dict has the fields of a problem file:

    from brakewave import variant
    problem = dict(
        system=dict(
            states=["x", "v"],
            parameters={"c": 0.1, "A": 1.0, "d": 1.0, "e": 0.8},
            forcing="1.5",
            modes={"free": dict(
                rates={"x": "v", "v": "A*cos(phase) - c*v - x"},
                until=[dict(zero="d - x", to="free", reset={"v": "-e*v"})],
            )},
        ),
        orbit=dict(start=variant.Simulate(mode="free", state={"x": 0.0, "v": 0.0}, settle=200)),
        continuation=dict(parameter="A", range=(0.05, 1.0), toward=variant.Down),
    )

A word in quotes in the file is a str. A bare word is a `variant` of that name: `toward: Down` is `toward=variant.Down`,
`Linear(0.9, 2.5, 100)` is `variant.Linear(0.9, 2.5, 100)`, and `Simulate(mode: "free", ..)` is
`variant.Simulate(mode="free", ..)`. Numbers are those of Python or numpy. A sequence is a list, a tuple or an array; its
brackets in the file follow from the name of its field. So does whether a dict has fields or is a map `{"name": value}`.
The field `if`, a keyword of Python, may be written `if_`. An entry that is None is left out.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from keyword import iskeyword
from math import isnan
from numbers import Integral, Real
from typing import Any, NamedTuple

import numpy

MAPS = frozenset("parameters define contacts modes sliding rates reset state within numbers monitor".split())
"""Fields that hold a map, whose keys are names of the user's own."""

TUPLES = frozenset("range parameters within sliding".split())
"""Fields whose sequences, and those in their maps, stand in round brackets; all others are lists."""

_WIDTH = 100
"""A group that is longer than this, its indentation included, has a line for each entry."""

_INDENT = 4


class Variant:
    """A bare word of a problem file, with what stands in its brackets."""

    def __init__(self, name: str, *values: Any, **fields: Any) -> None:
        if values and fields:
            raise TypeError(f"{name}: either values in order or named fields")
        self.name, self.values, self.fields = name, values, fields

    def __call__(self, *values: Any, **fields: Any) -> Variant:
        return Variant(self.name, *values, **fields)

    def __repr__(self) -> str:
        return ron(self)


class _Variants:
    def __getattr__(self, name: str) -> Variant:
        if name.startswith("_"):
            raise AttributeError(name)
        return Variant(name)


variant = _Variants()
"""Variants by their names: `variant.Down`, `variant.Linear(0.2, 2.0, 400)`."""


def ron(value: Any) -> str:
    """A value as RON, the language of problem files, on one line."""
    writer = _Writer(flat=True)
    writer.write(_Entry("", value, "", "tuple" if isinstance(value, tuple) else ""), 0)
    return "".join(writer.parts)


class Text:
    """The problem file of a dict, and which key of the dict stands where in it."""

    def __init__(self, problem: Mapping[str, Any]) -> None:
        writer = _Writer(flat=False)
        writer.write(_Entry("", problem, "", ""), 0)
        self.text = "".join(writer.parts) + "\n"
        self._places = writer.places

    def key(self, line: int, column: int) -> str:
        """The key of what stands at a line and a column, both counted from 1, with dots between the levels as in
        `continuation.range`; empty for the whole problem."""
        before = self.text.split("\n")[: line - 1]
        offset = sum(len(one) + 1 for one in before) + column - 1
        around = [place for place in self._places if place.begin <= offset < place.end]
        return min(around, key=lambda place: place.end - place.begin).key if around else ""


class _Place(NamedTuple):
    begin: int
    end: int
    key: str


class _Entry(NamedTuple):
    head: str
    """What stands before the value: `range: `, `"x": ` or nothing."""
    value: Any
    key: str
    """The keys that lead to the value, with dots between them."""
    field: str
    """The name of the field whose form it has: those of `MAPS` and `TUPLES` are told by it."""


class _Writer:
    """Writes values one after the other and notes their places."""

    def __init__(self, flat: bool) -> None:
        self.flat = flat
        self.parts: list[str] = []
        self.places: list[_Place] = []
        self.length = 0

    def write(self, entry: _Entry, indent: int) -> None:
        begin = self.length
        self._add(entry.head)
        value = entry.value
        if isinstance(value, numpy.ndarray) and value.ndim == 0:
            value = value.item()
        if isinstance(value, Variant):
            self._add(value.name)
            if value.fields:
                self._group("()", _fields(value.fields, entry.key), indent)
            elif value.values:
                self._group("()", _sequence(value.values, entry.key, ""), indent)
        elif isinstance(value, Mapping) and entry.field in MAPS:
            self._group("{}", _map(value, entry.key, entry.field), indent)
        elif isinstance(value, Mapping):
            self._group("()", _fields(value, entry.key), indent)
        elif (word := _word(value)) is not None:
            self._add(word)
        elif isinstance(value, Iterable) and not isinstance(value, (bytes, set, frozenset)):
            round_ = entry.field in TUPLES or entry.field == "tuple"
            self._group("()" if round_ else "[]", _sequence(value, entry.key, entry.field), indent, round_)
        else:
            where = f"{entry.key}: " if entry.key else ""
            raise TypeError(f"{where}{value!r} has no place in a problem: take numbers, texts, lists, tuples, dicts and variants")
        self.places.append(_Place(begin, self.length, entry.key))

    def _group(self, brackets: str, entries: list[_Entry], indent: int, is_tuple: bool = False) -> None:
        """Entries in brackets, on one line if they fit."""
        if self.flat or self._fits(entries, indent):
            self._add(brackets[0])
            for index, entry in enumerate(entries):
                self._add(", " if index else "")
                self.write(entry, indent)
            self._add("," if is_tuple and len(entries) == 1 else "")
        else:
            self._add(brackets[0])
            for entry in entries:
                self._add("\n" + " " * (indent + _INDENT))
                self.write(entry, indent + _INDENT)
                self._add(",")
            self._add("\n" + " " * indent)
        self._add(brackets[1])

    def _fits(self, entries: list[_Entry], indent: int) -> bool:
        trial = _Writer(flat=True)
        for entry in entries:
            trial.write(entry, indent)
        return indent + trial.length + 2 * len(entries) <= _WIDTH

    def _add(self, text: str) -> None:
        self.parts.append(text)
        self.length += len(text)


def _fields(fields: Mapping[Any, Any], key: str) -> list[_Entry]:
    given = ((_field(str(name)), value) for name, value in fields.items() if value is not None)
    return [_Entry(f"{name}: ", value, _joined(key, name), name) for name, value in given]


def _field(name: str) -> str:
    """A name without the underscore by which it is no word of Python, as `if_`: a parameter may have one of its own."""
    word = name.removesuffix("_")
    return word if iskeyword(word) else name


def _map(entries: Mapping[Any, Any], key: str, field: str) -> list[_Entry]:
    form = field if field in TUPLES else ""
    given = ((str(name), value) for name, value in entries.items() if value is not None)
    return [_Entry(f"{_quoted(name)}: ", value, _joined(key, name), form) for name, value in given]


def _sequence(values: Iterable[Any], key: str, field: str) -> list[_Entry]:
    form = field if field in TUPLES else ""
    return [_Entry("", value, f"{key}[{index}]", form) for index, value in enumerate(values)]


def _joined(key: str, name: str) -> str:
    return f"{key}.{name}" if key else name


def _word(value: Any) -> str | None:
    """A text, a truth value or a number; None for all else."""
    if isinstance(value, (str, os.PathLike)):
        return _quoted(os.fspath(value))
    if isinstance(value, (bool, numpy.bool_)):
        return "true" if value else "false"
    if isinstance(value, Integral):
        return str(int(value))
    if isinstance(value, Real):
        return "NaN" if isnan(value) else repr(float(value))
    return None


def _quoted(text: str) -> str:
    for special, escaped in [("\\", "\\\\"), ('"', '\\"'), ("\n", "\\n"), ("\r", "\\r"), ("\t", "\\t")]:
        text = text.replace(special, escaped)
    return f'"{text}"'
