"""The verbs of the program from Python.

A problem is the path of a problem file, or a dict of the same fields:

    from brakewave import scan, variant
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
        scan=dict(parameter="A", values=variant.Linear(0.9, 2.5, 100), sweep=variant.Up, settle=200, keep=50),
    )
    folder = scan(problem, name="impact")

In a dict a word in quotes in the file is a str, a bare word is a `variant` of that name: `toward: Down` is
`toward=variant.Down`, `Linear(0.9, 2.5, 100)` is `variant.Linear(0.9, 2.5, 100)`, `Simulate(mode: "free", ..)` is
`variant.Simulate(mode="free", ..)`. Tuples stay tuples, lists lists; True, False and numbers are what they are, and what
is None is left out. Whether a dict has fields or is a map `{"name": value}` is told by the name of its field.
"""

import os
import shutil
import subprocess
import sys
import tempfile
import warnings
from numbers import Integral, Real
from pathlib import Path
from threading import Thread

import numpy

MAPS = "parameters define modes sliding rates reset state within numbers monitor".split()
"""Fields that hold a map, whose keys are names of the user's own."""

_ENDINGS = {"run": "", "curve": "_curve", "map": "_map", "scan": "_scan", "simulate": "_simulation", "steady": "_steady"}


class Refused(Exception):
    """What the program refuses, or cannot compute, with its message and its exit `code`."""

    def __init__(self, message, code):
        super().__init__(message)
        self.code = code


class Variant:
    """A bare word of a problem file, with what stands in its brackets."""

    def __init__(self, name, *values, **fields):
        if values and fields:
            raise TypeError(f"{name}: either values in order or named fields")
        self.name, self.values, self.fields = name, values, fields

    def __call__(self, *values, **fields):
        return Variant(self.name, *values, **fields)

    def __repr__(self):
        return ron(self)


class _Variants:
    def __getattr__(self, name):
        if name.startswith("_"):
            raise AttributeError(name)
        return Variant(name)


variant = _Variants()
"""Variants by their names: `variant.Down`, `variant.Linear(0.2, 2.0, 400)`."""


def ron(value, is_map=False):
    """A value as RON, the language of problem files."""
    if isinstance(value, Variant):
        if value.fields:
            return value.name + ron(value.fields)
        return value.name + (f"({_joined(value.values)})" if value.values else "")
    if isinstance(value, dict):
        if is_map:
            return "{" + ", ".join(f"{ron(str(key))}: {ron(entry)}" for key, entry in value.items()) + "}"
        fields = ((key, entry) for key, entry in value.items() if entry is not None)
        return "(" + ", ".join(f"{key}: {ron(entry, key in MAPS)}" for key, entry in fields) + ")"
    if isinstance(value, (str, Path)):
        text = str(value).replace("\\", "\\\\").replace('"', '\\"')
        return '"' + text.replace("\n", "\\n").replace("\t", "\\t") + '"'
    if isinstance(value, (bool, numpy.bool_)):
        return "true" if value else "false"
    if isinstance(value, Integral):
        return str(int(value))
    if isinstance(value, Real):
        return repr(float(value))
    if isinstance(value, tuple):
        return "(" + _joined(value) + ("," if len(value) == 1 else "") + ")"
    if hasattr(value, "__iter__"):
        return "[" + _joined(value) + "]"
    raise TypeError(f"{value!r} has no place in a problem: take numbers, texts, lists, tuples, dicts and variants")


def _joined(values):
    return ", ".join(ron(one) for one in values)


def binary():
    """The program: the file that the variable BRAKEWAVE names, or `brakewave` on PATH."""
    found = os.environ.get("BRAKEWAVE") or shutil.which("brakewave")
    if not found:
        raise FileNotFoundError("no program `brakewave`: put it on PATH, or its path into the variable BRAKEWAVE")
    return found


def _compute(verb, problem, name="problem", quiet=False, **settings):
    from .reader import Folder

    with tempfile.TemporaryDirectory() as temporary:
        if isinstance(problem, dict):
            file = Path(temporary, f"{name}.ron")
            file.write_text(ron(problem) + "\n", encoding="utf-8")
        else:
            file = Path(problem)
        stem = file.stem if file.stem.endswith(_ENDINGS[verb]) else file.stem + _ENDINGS[verb]
        out = Path(settings.pop("out", None) or Path("results", stem))
        arguments = [binary(), verb, str(file), "--out", str(out)]
        for option, value in settings.items():
            option = "--" + option.replace("_", "-")
            for one in value if isinstance(value, (list, tuple)) else [value]:
                if one is True:
                    arguments.append(option)
                elif one is not False and one is not None:
                    arguments += [option, str(one)]
        code, said, told = _call(arguments, quiet)
    if code and (code != 3 or not (out / "brakewave.manifest").is_file()):
        raise Refused(told.strip() or said.strip(), code)
    if code:
        warnings.warn(told.strip(), stacklevel=3)
    folder = Folder(out)
    folder.said = said
    return folder


def _call(arguments, quiet):
    """Exit code, standard output, and standard error, of which progress is shown as it comes."""
    child = subprocess.Popen(
        arguments, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, encoding="utf-8"
    )
    with child:
        told = []

        def listen():
            for line in child.stderr:
                told.append(line)
                if not quiet:
                    sys.stderr.write(line)
                    sys.stderr.flush()

        listener = Thread(target=listen)
        listener.start()
        try:
            said = child.stdout.read()
        except BaseException:
            child.terminate()
            raise
        finally:
            listener.join()
    # an error is the last that is said; before it come lines of progress
    told = "".join(told)
    begin = max(told.rfind("\nerror: ") + 1, 0) if "\nerror: " in told else 0
    return child.returncode, said, told[begin:].removeprefix("error: ")


def _verb(verb, does):
    def compute(problem, **settings):
        return _compute(verb, problem, **settings)

    compute.__name__ = compute.__qualname__ = verb
    compute.__doc__ = f"""{does}; returns the `Folder`, whose `said` is what the program printed.

    `problem` is the path of a problem file or a dict (see `brakewave.program`). Settings are options of `brakewave
    {verb}` with `_` for `-`: out="results/x", force=True, resume=True, threads=2; what the dict is called by default is
    name="problem". Progress is shown on standard error unless quiet=True.

    What is refused raises `Refused` with the message of the program. A computation that ends early, exit code 3, keeps
    what it found: it is returned with a warning.
    """
    return compute


run = _verb("run", "Follows the branch of a problem")
curve = _verb("curve", "Follows an event of the branch in two parameters")
map = _verb("map", "Finds which waves exist where in a plane, or what motions of a system settle on there")
scan = _verb("scan", "Finds what motions of a system settle on, for many values of a parameter")
simulate = _verb("simulate", "Computes a motion in time")
steady = _verb("steady", "Finds the stability of steady sliding, or the equilibria of a system")
