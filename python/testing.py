"""What the tests of the package have in common: the folder of the source, and the binary to test with."""

from __future__ import annotations

import os
import shutil
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def binary() -> str | None:
    """The binary that BRAKEWAVE names, or one that was built here, or one on PATH."""
    built = (ROOT / "target" / profile / "brakewave" for profile in ["release", "debug"])
    found = [os.environ.get("BRAKEWAVE"), *map(str, filter(Path.is_file, built)), shutil.which("brakewave")]
    return next((str(Path(path).absolute()) for path in found if path), None)


def require_binary() -> None:
    """Makes the binary the one that the package calls, here and in other processes; skips all tests where there is none."""
    found = binary()
    if found is None:
        print("tests skipped: no binary; build one or set BRAKEWAVE")
        sys.exit(0)
    os.environ["BRAKEWAVE"] = found
    os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, [str(ROOT / "python"), os.environ.get("PYTHONPATH")]))
