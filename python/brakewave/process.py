"""Calls of the program: which file it is, what it says while it works, and how it ends."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import sysconfig
from dataclasses import dataclass, field
from pathlib import Path
from threading import Thread
from typing import IO, Callable

_GOES_ON = re.compile(r"help: | *\d* \| ")
"""How a line begins that belongs to the warning before it: with its cure, or with an extract of the problem file."""


@dataclass
class Answer:
    """What the program said, and its exit code."""

    code: int = 0
    said: str = ""
    """Standard output."""
    error: str = ""
    warnings: list[str] = field(default_factory=list)
    rest: str = ""
    """All else that it wrote on standard error: its progress, for the most part."""


def binary() -> str:
    """The program: the file that the variable BRAKEWAVE names, or else the one that was installed with this package, or
    else `brakewave` on PATH."""
    found = os.environ.get("BRAKEWAVE") or _installed() or shutil.which("brakewave")
    if not found:
        raise FileNotFoundError(
            "there is no program `brakewave`: install this package with pip, which builds it, or put it on PATH, or its path "
            "into the variable BRAKEWAVE"
        )
    return found


def _installed() -> str | None:
    """The program beside this package, where `pip install --target` has it, or among the scripts of this Python or of this
    user."""
    name = "brakewave" + (sysconfig.get_config_var("EXE") or "")
    folders = [Path(__file__).resolve().parent.parent / "bin", Path(sysconfig.get_path("scripts"))]
    user = f"{os.name}_user"
    if user in sysconfig.get_scheme_names():
        folders.append(Path(sysconfig.get_path("scripts", user)))
    found = (folder / name for folder in folders)
    return next((str(file) for file in found if file.is_file()), None)


def call(arguments: list[str], quiet: bool, plain: Callable[[str], str]) -> Answer:
    """Calls the program and waits for its end. Lines of progress are shown on standard error as they come, unless `quiet`;
    warnings and the error are left to the caller. `plain` puts a message into words for the caller's problem."""
    child = subprocess.Popen(
        [binary(), *arguments],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        encoding="utf-8",
        errors="replace",
    )
    assert child.stdout and child.stderr, "both are pipes"
    answer = Answer()
    with child:
        listener = Thread(target=_listen, args=(child.stderr, answer, None if quiet else plain))
        listener.start()
        try:
            answer.said = plain(child.stdout.read())
        except BaseException:
            child.terminate()
            raise
        finally:
            listener.join()
    answer.code = child.returncode
    answer.error = plain(answer.error.strip().removeprefix("error: "))
    answer.warnings = [plain(one.strip().removeprefix("warning: ")) for one in answer.warnings]
    if answer.code < 0 and not answer.error:
        answer.error = f"the program was ended by signal {-answer.code}"
    return answer


def _listen(lines: IO[str], answer: Answer, shown: Callable[[str], str] | None) -> None:
    """Sorts the lines of standard error. The error is the last that is said: all that follows is part of it."""
    in_warning = False
    for line in lines:
        if answer.error or line.startswith("error: "):
            answer.error += line
        elif line.startswith("warning: "):
            answer.warnings.append(line)
            in_warning = True
        elif in_warning and _GOES_ON.match(line):
            answer.warnings[-1] += line
        else:
            in_warning = False
            answer.rest += line
            if shown:
                sys.stderr.write(shown(line))
                sys.stderr.flush()
